//! Points that are open without a search, because they have not moved far enough to close.
use super::law::NormalLaw;
use super::rigid::free;
use covact_geometry::{Foot, Status, Vec3};

/// How far a slave point was from a rigid surface where it was last looked for, in the surface's own coordinates. The distance
/// from a surface changes by no more than a point moves, so that the point stays open as long as it has moved by less.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clearance {
    at: Vec3,
    /// Lower bound of the distance with its sign; 0 where nothing is known.
    xi3: f64,
}

impl Default for Clearance {
    fn default() -> Self {
        Clearance {
            at: Vec3::zeros(),
            xi3: 0.0,
        }
    }
}

/// Part of a distance that the bound leaves out: far more than the tolerance of the search.
const MARGIN: f64 = 1e-3;

impl Clearance {
    /// What the foot of a point at `local` tells of the points around it. Beside a free border nothing: there, who goes round the
    /// border comes to the other side of the surface without touching it.
    #[inline(always)]
    pub(super) fn of(local: &Vec3, foot: &Foot) -> Self {
        if foot.status != Status::Unique || free(foot) {
            return Clearance::default();
        }
        Clearance {
            at: *local,
            xi3: foot.signed_distance * (1.0 - MARGIN),
        }
    }

    /// Whether a point at `local` cannot be in contact under a law that asks for points down to `depth` below the surface.
    #[inline(always)]
    pub(super) fn proves_open<L: NormalLaw>(&self, local: &Vec3, law: &L, depth: f64) -> bool {
        if self.xi3 == 0.0 {
            return false;
        }
        let left = self.xi3.abs() - (local - self.at).norm();
        match self.xi3 > 0.0 {
            true => left > 0.0 && !law.closes(left),
            false => left > depth,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::law::{Penalty, Shifted};
    use crate::contact::rigid::{Exact, Overhang, RigidMaster};
    use covact_geometry::PatchSet;
    use covact_geometry::primitives::{plane, sphere};
    use nalgebra::{Isometry3, UnitQuaternion};

    /// A walk of many small steps around a sphere that turns and moves: what is left out is open, and much is left out.
    #[test]
    fn points_that_are_not_looked_for_are_open() {
        let ball = sphere(2.0, Vec3::zeros(), Vec3::z()).unwrap();
        let set = PatchSet::new(vec![ball], None).unwrap();
        let (depth, law) = (
            0.5,
            Shifted {
                law: Penalty { eps_n: 5.0 },
                z0: 0.1,
            },
        );
        let mut random = fastrand::Rng::with_seed(7);
        let mut draw = || Vec3::from_fn(|_, _| random.f64() - 0.5);
        let mut x = Vec3::new(0.0, 0.0, 2.6);
        let (mut clear, mut hint) = (Clearance::default(), None);
        let (mut left_out, mut closed) = (0, 0);
        for step in 0..4000 {
            x += draw() * 0.12 - (x - x.normalize() * 2.2) * 0.02;
            let turn =
                UnitQuaternion::from_scaled_axis(Vec3::new(0.0, 0.0, 1e-4 * f64::from(step)));
            let master = RigidMaster {
                surface: &set,
                pose: Isometry3::from_parts(
                    Vec3::new(0.0, 1e-5 * f64::from(step), 0.0).into(),
                    turn,
                ),
                depth,
                keep: false,
            };
            let placed = master.placed();
            let known = placed.proves_open(&x, &clear, &law);
            let fresh = master
                .touch(&x, (&mut None, Overhang::default()), &law, &Exact)
                .unwrap();
            left_out += u32::from(known);
            closed += u32::from(fresh.is_some());
            assert!(!(known && fresh.is_some()), "step {step}");
            let mut out = Ok(None);
            placed.touch_into(
                &x,
                (&mut hint, &mut clear, Overhang::default()),
                &law,
                &Exact,
                &mut out,
            );
            assert_eq!(out.unwrap().is_some(), fresh.is_some(), "step {step}");
        }
        assert!(left_out > 500 && closed > 500, "{left_out} {closed}");
    }

    #[test]
    fn nothing_is_known_beside_a_free_border_and_before_the_first_search() {
        let law = Penalty { eps_n: 1.0 };
        assert!(!Clearance::default().proves_open(&Vec3::zeros(), &law, 0.0));
        let plane = plane(Vec3::zeros(), Vec3::z(), [1.0, 1.0]).unwrap();
        let set = PatchSet::new(vec![plane], None).unwrap();
        let of = |x: Vec3| Clearance::of(&x, &set.project(&x, None, f64::INFINITY).unwrap());
        let above = of(Vec3::new(0.1, 0.2, 0.3));
        assert!(above.proves_open(&Vec3::new(0.1, 0.2, 0.1), &law, 0.0));
        assert!(!above.proves_open(&Vec3::new(0.1, 0.2, 0.0), &law, 0.0));
        assert_eq!(of(Vec3::new(3.0, 0.0, 0.1)), Clearance::default());
    }
}
