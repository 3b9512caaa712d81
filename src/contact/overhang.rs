//! Points that hang over a free border of a rigid surface.
//!
//! A slave point stands for a piece of the slave's surface. Where that slides over the border of its master, the part that the
//! master carries becomes smaller little by little; a point that was in contact or not by the place of its foot alone would lose
//! all of its force at once, and Newton's method would take it away and give it back without end. Beyond the border the
//! traction of a point therefore fades: the master is continued past its border along its tangent plane,
//! `x = rho + s c + xi3 n`, where `c` points out of the surface and `s` is how far the point hangs over, and the force per area is
//!
//! ```text
//! f = w N n,    w = 1 - p^3 (10 - 15 p + 6 p^2),   p = (q - q0) / (1 - q0),   q = s / width
//! ```
//!
//! with the law's traction `N` and a small `q0` ([`WHOLE`]). It ends at the `width` of the point
//! ([`SlavePoint::width`](super::points::SlavePoint::width)), which moves a border by less than what nodes resolve. What comes from
//! beside the surface, deep below it, does not lie on it and is open.
//!
//! The derivative of that force is not symmetric. Without friction, where the system is, the force is the one of the energy
//! `w psi` of the law's `psi`, with `w_s psi c` beside `w N n`: less than `N` by the penetration over the width. It would push
//! points to and fro at the centre of a hole, so that past borders that are hollow it is left out, and the symmetric part of
//! what is left stands for the derivative.
use super::corner;
use super::kernel::Normal;
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// Deepest penetration of a point that was open, as a share of its width.
const SHALLOW: f64 = 0.5;
/// Overhang up to which the whole traction is left, as a share of the width: between patches whose gap was not closed.
const WHOLE: f64 = 0.05;
/// Part of its own length that is left of the derivative of a border that is not hollow, but for rounding.
const STRAIGHT: f64 = 1.0 - 1e-6;
/// Smallest such part: nearer to the centre of its curvature, where the foot runs along it ever faster, the foot counts as fixed.
const FOCAL: f64 = 0.1;

/// What is asked of a slave point where it hangs over a free border.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Hanging {
    /// How far it may ([`SlavePoint::width`](super::points::SlavePoint::width)): not at all where it is 0.
    pub width: f64,
    /// Whether it was in contact in the iteration before, wherever it is now.
    pub closed: bool,
}

/// A point that hangs over a free border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Overhang {
    /// Normal of the surface at the border, outward.
    pub n: Vec3,
    /// Normal coordinate over the tangent plane there (length).
    pub xi3: f64,
    /// How far it hangs over (length, `>= 0`), and along which unit vector; zero where it does not.
    s: f64,
    c: Vec3,
    /// Derivatives with respect to the slave point.
    pub xi3_x: Vec3,
    s_x: Vec3,
    pub n_x: Matrix3<f64>,
    c_x: Matrix3<f64>,
    hollow: bool,
}

/// What is left of the law at such a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Faded {
    /// `w`, from 0 to 1.
    pub weight: f64,
    /// `w N` and its derivative with respect to the slave point.
    pub n: f64,
    pub n_x: Vec3,
    /// Force per area, and its derivative.
    pub residual: Vec3,
    pub tangent: Matrix3<f64>,
}

impl Overhang {
    /// A point at `d` from its foot on a border with outward normal `n`. `border`: first and second derivative of the border and
    /// derivative of the normal along it; none at its corners.
    pub fn new(d: &Vec3, n: Vec3, border: Option<[Vec3; 3]>) -> Self {
        let xi3 = d.dot(&n);
        let (mut xi3_x, mut n_x, mut d_x) = (n, Matrix3::zeros(), Matrix3::identity());
        let mut hollow = false;
        if let Some([rho_s, rho_ss, n_s]) = border {
            let left = corner::curvature(d, &rho_s, &rho_ss);
            hollow = left < STRAIGHT * rho_s.norm_squared();
            if left > FOCAL * rho_s.norm_squared() {
                let foot = rho_s.transpose() / left;
                xi3_x += foot.transpose() * d.dot(&n_s);
                n_x = n_s * foot;
                d_x -= rho_s * foot;
            }
        }
        let beside = d - n * xi3;
        let beside_x = d_x - n * xi3_x.transpose() - n_x * xi3;
        let s = beside.norm();
        let c = beside.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        let s_x = beside_x.transpose() * c;
        let c_x = match s > 0.0 {
            true => (beside_x - c * s_x.transpose()) / s,
            false => Matrix3::zeros(),
        };
        Overhang {
            n,
            xi3,
            s,
            c,
            xi3_x,
            s_x,
            n_x,
            c_x,
            hollow,
        }
    }

    /// What is left of a law with traction and slope `normal` at a gap; `None` where the point is open.
    pub fn fade(&self, may: Hanging, gap: f64, normal: &Normal) -> Option<Faded> {
        let w = self.left(may, gap)?;
        let n = w.w * normal.n;
        let n_x = self.xi3_x * (w.w * normal.dn) + self.s_x * (w.s * normal.n);
        Some(Faded {
            weight: w.w,
            n,
            n_x,
            residual: self.n * n,
            tangent: self.n * n_x.transpose() + self.n_x * n,
        })
    }

    /// The part of a law that is left at a gap; `None` where the point is open.
    pub fn weight(&self, may: Hanging, gap: f64) -> Option<f64> {
        self.left(may, gap).map(|w| w.w)
    }

    fn left(&self, may: Hanging, gap: f64) -> Option<Weight> {
        match may.closed || gap >= -SHALLOW * may.width {
            true => Weight::at(self.s, may.width),
            false => None,
        }
    }

    /// [`Self::fade`] of a law with energy `psi` where the tangent has to be symmetric.
    pub fn fade_by_energy(
        &self,
        may: Hanging,
        gap: f64,
        normal: &Normal,
        psi: f64,
    ) -> Option<Faded> {
        let mut faded = self.fade(may, gap, normal)?;
        let w = Weight::at(self.s, may.width)?;
        if self.hollow {
            faded.tangent -= self.n * self.s_x.transpose() * (w.s * normal.n);
        } else {
            let out_x = self.xi3_x * (w.s * normal.n) + self.s_x * (w.s_s * psi);
            faded.residual += self.c * (w.s * psi);
            faded.tangent += self.c * out_x.transpose() + self.c_x * (w.s * psi);
        }
        faded.tangent = (faded.tangent + faded.tangent.transpose()) * 0.5;
        Some(faded)
    }
}

/// The part `w` of a law that is left, and its derivatives with respect to the overhang.
struct Weight {
    w: f64,
    s: f64,
    s_s: f64,
}

impl Weight {
    fn at(s: f64, width: f64) -> Option<Self> {
        // Also where there is no width at all.
        if s >= width {
            return None;
        }
        let p = (s / width - WHOLE) / (1.0 - WHOLE);
        let (w, slope, bend) = fall(p.max(0.0));
        let p_s = 1.0 / (width * (1.0 - WHOLE));
        Some(Weight {
            w,
            s: slope * p_s,
            s_s: bend * p_s * p_s,
        })
    }
}

/// `1 - p^3 (10 - 15 p + 6 p^2)`, which falls from 1 to 0 as `p` goes from 0 to 1, its first and its second derivative, both of
/// them nothing at either end.
fn fall(p: f64) -> (f64, f64, f64) {
    let left = 1.0 - p;
    (
        1.0 - p * p * p * (10.0 - p * (15.0 - 6.0 * p)),
        -30.0 * (p * left).powi(2),
        -60.0 * p * left * (left - p),
    )
}

#[cfg(test)]
mod tests {
    use super::Hanging;
    use crate::contact::friction::history::PointHistory;
    use crate::contact::friction::law::Coulomb;
    use crate::contact::friction::rigid::Friction;
    use crate::contact::law::{NormalLaw, Penalty};
    use crate::contact::rigid::{Exact, RigidMaster};
    use covact_geometry::{NurbsPatch, PatchSet, Vec3};
    use nalgebra::{Isometry3, Matrix3};

    const LAW: Penalty = Penalty { eps_n: 5.0 };
    const WIDTH: f64 = 0.2;
    const MAY: Hanging = Hanging {
        width: WIDTH,
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
            [1.06, 0.3, -0.01],
            [1.12, -0.4, -0.02],
            [0.4, 1.06, -0.01],
            [1.05, 1.08, -0.01],
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
                    assert!(
                        at.touch.weight > 0.02 && at.touch.weight < 0.98,
                        "{shape:?}, {x:?}: {}",
                        at.touch.weight
                    );
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
                let energy = |x: &Vec3| touch(x).weight * LAW.energy(touch(x).gap);
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

    /// A point over the centre of a hole, which is as far from all of its border, is pressed as those beside it.
    #[test]
    fn a_point_over_the_centre_of_a_small_hole_is_pressed_straight() {
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
        for beside in [0.0, 1e-12, 1e-6, 1e-3] {
            let touch = master.touch(
                &Vec3::new(beside, 0.0, -0.01),
                (&mut None, MAY),
                &LAW,
                &Exact,
            );
            let touch = touch.unwrap().expect("in contact");
            assert!(touch.weight > 0.4 && touch.weight < 0.6, "{}", touch.weight);
            let straight = Vec3::z() * touch.weight;
            assert!(
                (touch.residual / touch.n - straight).norm() < 1e-12,
                "{beside}"
            );
            assert!(touch.tangent.iter().all(|k| k.is_finite()));
        }
    }

    /// The force goes on from inside across the border, and ends at the width with nothing; what lies deep beside the surface is
    /// open.
    #[test]
    fn a_point_that_slides_over_a_border_loses_its_force_little_by_little() {
        let set = sheet([0.0, 0.0]);
        let master = RigidMaster {
            pose: Isometry3::identity(),
            ..master(&set)
        };
        let force = |over: f64, gap: f64| {
            let x = Vec3::new(1.0 + over, 0.2, gap);
            let touch = master.touch(&x, (&mut None, MAY), &LAW, &Exact).unwrap();
            touch.map_or(0.0, |t| t.residual.z)
        };
        let inside = force(-1e-9, -0.01);
        assert!((inside + 0.05).abs() < 1e-12);
        for (over, share) in [
            (0.0, 1.0),
            (0.05, 1.0),
            (0.2875, 0.896484375),
            (0.525, 0.5),
            (0.7625, 0.103515625),
            (1.0 - 1e-9, 0.0),
            (1.1, 0.0),
        ] {
            let left = force(over * WIDTH, -0.01) / inside;
            assert!((left - share).abs() < 1e-9, "{over}: {left}");
        }
        assert_eq!(force(0.01, 0.001), 0.0);
        // Deep below: in contact where it was.
        assert!(force(0.001, -0.51 * WIDTH) < 0.0);
        let new = Hanging {
            closed: false,
            ..MAY
        };
        for (gap, closes) in [(-0.49, true), (-0.51, false)] {
            let x = Vec3::new(1.001, 0.2, gap * WIDTH);
            let touch = master.touch(&x, (&mut None, new), &LAW, &Exact);
            assert_eq!(touch.unwrap().is_some(), closes, "{gap}");
        }
    }
}
