//! Boxes that touch the surface.
use covact_geometry::{PatchSet, Status, Vec3};

/// Distance of the eye, in sizes of the surface. The closest point to an eye so far away along an axis is the outermost one in
/// that direction up to size^2 / (8 FAR), and the search's own error of 1e-14 of the distance is smaller.
const FAR: f64 = 3e6;

/// Lowest and highest corner of a box around what belongs to the surface, within 1e-7 of its size. The box that the set itself
/// knows holds control points, and what is trimmed away.
pub(super) fn extent(set: &PatchSet) -> [[f64; 3]; 2] {
    let hull = set.bounds();
    let centre = (hull[0] + hull[1]) / 2.0;
    let mut out = hull.map(|x| [x.x, x.y, x.z]);
    for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
        for (k, out) in out[side].iter_mut().enumerate() {
            let mut eye = centre;
            eye[k] += sign * FAR * set.size();
            match set.project(&eye, None, f64::INFINITY) {
                Some(foot) if foot.status != Status::NotConverged => *out = foot.jet.rho[k],
                _ => {}
            }
        }
    }
    out
}

/// The box around two boxes.
pub(super) fn join(a: [[f64; 3]; 2], b: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let (low, high) = (
        Vec3::from(a[0]).inf(&b[0].into()),
        Vec3::from(a[1]).sup(&b[1].into()),
    );
    [low.into(), high.into()]
}
