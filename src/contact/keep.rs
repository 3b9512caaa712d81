//! Points that keep the facet that they were on.
//!
//! Where two facets meet at a small angle, a point below their common edge has its foot on one, on the other or, in a valley,
//! on the edge itself, in a zone that is as narrow as the penetration times the angle. Newton's method steps across that zone
//! and back without end. A point that was on a facet in the iteration before therefore stays there, on the facet continued
//! past its border by a little, as long as this changes its gap by less than contact gives way anyhow. A point in the zone of a
//! valley of a deforming master is left alone: the edge holds it from both sides.
//!
//! At a free border of a body the same holds: a point of which Poisson's ratio makes the last digit hang over would lose all of
//! its pressure at once, come back, and lose it again.
use super::law::NormalLaw;
use covact_geometry::{Hint, Vec3};

/// How far past its border a facet is continued, as a share of its width.
pub(super) const BEYOND: f64 = 0.01;
/// Cosine of the largest angle between the two directions of the force, 20 degrees: sharper edges are edges.
const FLAT: f64 = 0.939_692_620_785_908_4;
/// Largest change of the gap, in terms of the penetration that the traction stands for.
const SHARE: f64 = 0.1;

/// Whether a foot with normal coordinate `kept` and normal `n` on the facet of the iteration before may stand for the
/// closest point, with normal coordinate `xi3` and direction `normal`.
#[inline]
pub(super) fn may_stand<L: NormalLaw>(
    law: &L,
    (kept, n): (f64, &Vec3),
    (xi3, normal): (f64, &Vec3),
) -> bool {
    let response = law.response(xi3);
    law.closes(kept)
        && (kept - xi3).abs() * response.dn <= SHARE * response.n.abs()
        && n.dot(normal) >= FLAT
}

/// The same of a point whose traction is that of its nodes: `sunk` is the penetration that it stands for (length).
#[inline]
pub(super) fn may_stand_in(
    sunk: f64,
    (kept, n): (f64, &Vec3),
    (xi3, normal): (f64, &Vec3),
) -> bool {
    (kept - xi3).abs() <= SHARE * sunk && n.dot(normal) >= FLAT
}

/// The hint of a point in contact: one that a border holds is told from one outside, whose foot lies on the border as well, by
/// the last digit of its parameters.
#[inline]
pub(super) fn held(hint: Hint) -> Hint {
    Hint {
        xi: hint.xi.map(|xi| match xi.abs() {
            1.0 => xi * (1.0 - f64::EPSILON),
            _ => xi,
        }),
        ..hint
    }
}
