//! Points that hang over a free border of a rigid surface; over one of a body, see [`hanging`](super::hanging).
//!
//! A slave point stands for a piece of the slave's surface. If it were in contact or not by the place of its foot alone, it would
//! lose all of its force at once where it slides past the border of its master, and Newton's method would take the force away and
//! give it back without end. Beyond the border the master therefore goes on as if the border were rounded off: along its tangent plane
//! for a little ([`FLAT`]), then down around a circle of radius `R`, which ends a point's contact by geometry. With the foot `rho`
//! and the normal `n` on the border and
//!
//! ```text
//! x = rho + s c + xi3 n          a = xi3 + R     b = max(s - s0, 0)
//! gap = |(a, b)| - R             n' = (a n + b c) / |(a, b)|
//! ```
//!
//! where `c` points out of the surface, a point past a border is one with the gap and the normal `n'` of that rounding. The force
//! is that of the energy of the gap, and the tangent symmetric, but for what a border that twists adds.
use super::corner::{self, Steady};
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// How far the tangent plane goes on, as a share of the radius: patches whose gap was not closed meet as one surface.
const FLAT: f64 = 0.05;
/// Deepest penetration of a point that was open, as a share of the radius: what is deeper has come from beside the surface.
const SHALLOW: f64 = 0.5;
/// Distance from the foot on a border up to which the rounding may be touched, in terms of the radius, beside what contact begins in
/// front of it: that is `|(R, (1 + FLAT) R + reach)|` at most, and over a hole that goes on flat `|(R, 2 R)|`.
const BEYOND: f64 = 2.5;
/// Smallest part of its own length that is left of a border's derivative: nearer to the centre of its curvature, where the foot
/// runs along it ever faster, the foot counts as fixed.
const FOCAL: f64 = 0.1;

/// What is asked of a slave point where it hangs over a free border.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Overhang {
    /// Radius by which borders are rounded off for the point ([`SlavePoint::rounding`](super::points::SlavePoint::rounding)); with 0
    /// they are sharp, and the point is open past them.
    pub rounding: f64,
    /// Whether it was in contact in the iteration before.
    pub closed: bool,
}

/// The rounding of a free border next to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rounded {
    /// Normal coordinate over the rounding (length).
    pub xi3: f64,
    /// Its direction, and both derivatives with respect to the slave point.
    pub at: Steady,
}

impl Overhang {
    /// The rounding next to a point at `d` from its foot on a border with outward normal `n`; none where it lies below all of it.
    /// `border`: first and second derivative of the border and derivative of the normal along it; none at its corners.
    pub(super) fn rounded(&self, d: &Vec3, n: &Vec3, border: Option<[Vec3; 3]>) -> Option<Rounded> {
        let radius = self.rounding;
        let xi3 = d.dot(n);
        let (mut xi3_x, mut n_x, mut d_x) = (*n, Matrix3::zeros(), Matrix3::identity());
        let beside = d - n * xi3;
        let s = beside.norm();
        let mut over = self.past(s);
        if let Some([rho_s, rho_ss, n_s]) = border {
            let length = rho_s.norm_squared();
            let left = corner::curvature(d, &rho_s, &rho_ss);
            if left > FOCAL * length {
                let foot = rho_s.transpose() / left;
                xi3_x += foot.transpose() * d.dot(&n_s);
                n_x = n_s * foot;
                d_x -= rho_s * foot;
            }
            // A hole that is so small that roundings would meet at its centre, and push points to and fro there, goes on flat.
            let bend = (rho_ss - n * n.dot(&rho_ss)).dot(&beside) / length;
            if bend * 2.0 * radius > s {
                over = 0.0;
            }
        }
        let a = xi3 + radius;
        if a <= 0.0 {
            return None;
        }
        let mut along = *n * a;
        let mut gap_x = xi3_x * a;
        let mut along_x = n * xi3_x.transpose() + n_x * a;
        if over > 0.0 {
            let c = beside / s;
            let beside_x = d_x - n * xi3_x.transpose() - n_x * xi3;
            let s_x = beside_x.transpose() * c;
            let c_x = (beside_x - c * s_x.transpose()) / s;
            along += c * over;
            gap_x += s_x * over;
            along_x += c * s_x.transpose() + c_x * over;
        }
        let distance = a.hypot(over);
        let (normal, gradient) = (along / distance, gap_x / distance);
        Some(Rounded {
            xi3: distance - radius,
            at: Steady {
                n: normal,
                turn: (along_x - normal * gradient.transpose()) / distance,
                gradient,
            },
        })
    }

    /// How far a point that hangs over by `s` is past where the rounding begins (length).
    pub(super) fn past(&self, s: f64) -> f64 {
        (s - FLAT * self.rounding).max(0.0)
    }

    /// Distance from the foot on a border up to which a point may be in contact that begins at `reach` in front of the surface.
    #[inline]
    pub(super) fn within(&self, reach: f64) -> f64 {
        reach.max(0.0) + BEYOND * self.rounding
    }

    /// Whether a point may hang over with a gap: anyhow where it was in contact.
    pub(super) fn allows(&self, gap: f64) -> bool {
        self.closed || gap >= -SHALLOW * self.rounding
    }
}

#[cfg(test)]
mod tests {
    use super::Overhang;
    use crate::contact::friction::history::PointHistory;
    use crate::contact::friction::law::Coulomb;
    use crate::contact::friction::rigid::Friction;
    use crate::contact::law::{NormalLaw, Penalty, Shifted};
    use crate::contact::rigid::{Exact, RigidMaster};
    use covact_geometry::{NurbsPatch, PatchSet, Vec3};
    use nalgebra::{Isometry3, Matrix3};

    const LAW: Penalty = Penalty { eps_n: 5.0 };
    const RADIUS: f64 = 0.2;
    const MAY: Overhang = Overhang {
        rounding: RADIUS,
        closed: true,
    };

    /// `z = bow x^2 + twist x y` over `0 <= x <= 1`, `-1 <= y <= 1`, hence with borders that are straight (`bow = 0`), bend and twist.
    fn sheet([bow, twist]: [f64; 2]) -> PatchSet {
        let knots = |degree: usize| [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat();
        // Bezier points of x^2 on [0, 1] are 0, 0, 1.
        let points: Vec<Vec3> = (0..6)
            .map(|k| {
                (
                    [0.0, 0.5, 1.0][k % 3],
                    [0.0, 0.0, 1.0][k % 3],
                    [-1.0, 1.0][k / 3],
                )
            })
            .map(|(x, xx, y)| Vec3::new(x, y, bow * xx + twist * x * y))
            .collect();
        let patch = NurbsPatch::new([2, 1], [knots(2), knots(1)], [3, 2], &points, None);
        PatchSet::new(vec![patch.unwrap()], None).unwrap()
    }

    fn master(set: &PatchSet) -> RigidMaster<'_, PatchSet> {
        RigidMaster {
            surface: set,
            pose: Isometry3::new(Vec3::new(0.3, -0.1, 0.2), Vec3::new(0.2, 0.1, -0.3)),
            depth: 1.0,
            keep: true,
        }
    }

    /// Derivative of a vector at `x` by central differences.
    fn slope(of: impl Fn(&Vec3) -> Vec3, x: &Vec3) -> Matrix3<f64> {
        Matrix3::from_columns(&[0, 1, 2].map(|c| {
            let mut step = Vec3::zeros();
            step[c] = 1e-6;
            (of(&(x + step)) - of(&(x - step))) / 2e-6
        }))
    }

    /// Points below the tangent plane past the border x = 1, past y = 1, and past the corner of both; the last one lies deep.
    fn beside([bow, twist]: [f64; 2]) -> impl Iterator<Item = Vec3> {
        let set = sheet([bow, twist]);
        let pose = master(&set).pose;
        let at = [
            [1.06, 0.3, -0.04],
            [1.12, -0.4, -0.08],
            [0.4, 1.06, -0.04],
            [1.05, 1.08, -0.06],
            [1.12, 0.3, -0.14],
        ];
        at.into_iter().map(move |[x, y, gap]: [f64; 3]| {
            let (cx, cy) = (x.min(1.0), y.min(1.0));
            let (slope_x, slope_y) = (2.0 * bow * cx + twist * cy, twist * cx);
            let plane = bow * cx * cx + twist * cx * cy + slope_x * (x - cx) + slope_y * (y - cy);
            (pose * nalgebra::Point3::new(x, y, plane + gap)).coords
        })
    }

    #[test]
    fn with_friction_the_derivative_past_a_border_is_exact() {
        for shape in [[0.0, 0.0], [0.2, 0.0], [0.2, 0.3]] {
            let set = sheet(shape);
            let master = master(&set);
            for x in beside(shape) {
                let history = PointHistory::default();
                let law = history.law(LAW, 0.0);
                for (eps_t, mu) in [(0.02, 0.9), (3.0, 0.2)] {
                    let friction = Friction {
                        law: Coulomb { mu },
                        eps_t,
                    };
                    let slides = |x: &Vec3| {
                        let known = (&mut None, MAY);
                        let touch = master.touch_with_friction(x, known, &law, &friction, &history);
                        touch.unwrap().expect("in contact")
                    };
                    let at = slides(&x);
                    assert!(at.traction.slip.t.norm() > 1e-3 && at.touch.tangent.norm() > 0.5);
                    let error = (slope(|x| slides(x).touch.residual, &x) - at.touch.tangent).norm();
                    assert!(error < 1e-6, "{shape:?}, {x:?}, {mu}: {error:e}");
                }
            }
        }
    }

    /// Without friction force and tangent are those of an energy, but for what a border that twists adds.
    #[test]
    fn without_friction_forces_past_a_border_are_those_of_an_energy() {
        for (shape, symmetry) in [([0.0, 0.0], 1e-6), ([0.2, 0.0], 1e-6), ([0.2, 0.3], 5e-2)] {
            let set = sheet(shape);
            let master = master(&set);
            for x in beside(shape) {
                let touch = |x: &Vec3| {
                    let touch = master.touch(x, (&mut None, MAY), &LAW, &Exact);
                    touch.unwrap().expect("in contact")
                };
                let energy = |x: &Vec3| LAW.energy(touch(x).gap);
                let force = Vec3::from_fn(|c, _| {
                    let mut step = Vec3::zeros();
                    step[c] = 1e-5;
                    (energy(&(x + step)) - energy(&(x - step))) / 2e-5
                });
                let at = touch(&x);
                let error = (force - at.residual).norm() / at.residual.norm();
                assert!(
                    at.residual.norm() > 1e-3 && error < symmetry,
                    "{shape:?}, {x:?}: {error:e}"
                );
                let error =
                    (slope(|x| touch(x).residual, &x) - at.tangent).norm() / at.tangent.norm();
                assert!(
                    at.tangent.norm() > 0.5 && error < symmetry,
                    "{shape:?}, {x:?}: {error:e}"
                );
            }
        }
    }

    /// Over a small hole the surface goes on as if it were none: roundings would push a point at its centre to and fro.
    #[test]
    fn a_small_hole_is_none() {
        let radius = 0.1;
        // Between two circles of nine points each.
        let mut points = Vec::new();
        let mut weights = Vec::new();
        for k in 0..18 {
            let turn = f64::from(k / 2 % 8) * std::f64::consts::FRAC_PI_4;
            let weight = if k / 2 % 2 == 1 { 0.5f64.sqrt() } else { 1.0 };
            let r = [radius, 1.0][k as usize % 2] / weight;
            points.push(Vec3::new(r * turn.cos(), r * turn.sin(), 0.0));
            weights.push(weight);
        }
        let around = [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0];
        let knots = [vec![0.0, 0.0, 1.0, 1.0], around.to_vec()];
        let ring = NurbsPatch::new([1, 2], knots, [2, 9], &points, Some(&weights)).unwrap();
        let set = PatchSet::new(vec![ring], None).unwrap();
        let master = RigidMaster {
            pose: Isometry3::identity(),
            ..master(&set)
        };
        for beside in [0.0, 1e-12, 1e-6, 1e-3, 0.05] {
            let x = Vec3::new(beside, 0.0, -0.01);
            let touch = master.touch(&x, (&mut None, MAY), &LAW, &Exact).unwrap();
            let touch = touch.expect("in contact");
            assert!(
                (touch.residual + Vec3::z() * 0.05).norm() < 1e-12,
                "{beside}"
            );
            let stiff = Matrix3::from_diagonal(&Vec3::new(0.0, 0.0, 5.0));
            assert!((touch.tangent - stiff).norm() < 1e-9, "{}", touch.tangent);
        }
    }

    /// Past a straight border contact goes on along the plane for a little, and then round a quarter of a circle.
    #[test]
    fn a_border_is_rounded_off() {
        let set = sheet([0.0, 0.0]);
        let master = RigidMaster {
            pose: Isometry3::identity(),
            ..master(&set)
        };
        let touch = |over: f64, height: f64, overhang: Overhang| {
            let x = Vec3::new(1.0 + over, 0.2, height);
            master
                .touch(&x, (&mut None, overhang), &LAW, &Exact)
                .unwrap()
        };
        let center = Vec3::new(1.0 + 0.05 * RADIUS, 0.2, -RADIUS);
        for (over, height) in [(-1e-9, -0.01), (0.0, -0.01), (1e-9, -0.01), (0.01, -0.01)] {
            let at = touch(over, height, MAY).expect("in contact");
            assert!((at.residual - Vec3::z() * -0.05).norm() < 1e-12, "{over}");
        }
        for (over, height) in [(0.02, -0.01), (0.1, -0.1), (0.2, -0.18)] {
            let at = touch(over, height, MAY).expect("in contact");
            let arm = Vec3::new(1.0 + over, 0.2, height) - center;
            let force = arm.normalize() * (5.0 * (arm.norm() - RADIUS));
            assert!(
                force.norm() > 1e-3 && (at.residual - force).norm() < 1e-12,
                "{over}"
            );
        }
        // Beside it, above it, and deeper than it reaches; deep within where the point was open.
        assert!(touch(0.1, -0.02, MAY).is_none() && touch(0.22, -0.1, MAY).is_none());
        assert!(touch(0.01, -0.21, MAY).is_none());
        let open = Overhang {
            closed: false,
            ..MAY
        };
        assert!(touch(0.01, -0.09, open).is_some() && touch(0.01, -0.11, open).is_none());
        // Without a rounding the point is open.
        assert!(touch(1e-9, -0.01, Overhang::default()).is_none());
        // An offset begins in front of the rounding as it does in front of the plane.
        let offset = Shifted { law: LAW, z0: 0.5 };
        for x in [Vec3::new(1.1, 0.2, 0.4), Vec3::new(1.56, 0.2, 0.0)] {
            let at = master.touch(&x, (&mut None, MAY), &offset, &Exact).unwrap();
            let gap = (x - center).norm() - RADIUS - 0.5;
            assert!(gap < -0.05 && (at.expect("in contact").gap - gap).abs() < 1e-12);
        }
    }
}
