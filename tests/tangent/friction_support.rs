//! What tests of friction share: a contact point with history, its residual written down from the definitions in dual
//! numbers, and surfaces to touch.
use crate::support::{self, Shape, V};
use covact::contact::friction::history::PointHistory;
use covact::contact::friction::law::FrictionLaw;
use covact::contact::friction::rigid::{Friction, FrictionTouch};
use covact::contact::law::{Augmented, Penalty};
use covact::contact::rigid::{Overhang, RigidMaster};
use covact_geometry::{NurbsPatch, PatchSet};
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector3};
use num_dual::{Dual64, DualNum};

pub const EPS_N: f64 = 3.0;
pub const EPS_T: f64 = 2.0;
pub const XI: [f64; 2] = [0.43, 0.58];
pub const SHAPES: [Shape; 3] = [Shape::Dome, Shape::Bowl, Shape::Saddle];

/// A point under friction.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub z0: f64,
    pub lambda_n: f64,
    pub lambda: V<f64>,
    pub approach: f64,
    /// From the attraction point to the slave point, in the coordinates of the surface.
    pub chord: V<f64>,
}

impl Case {
    pub const PLAIN: Case = Case {
        z0: 0.0,
        lambda_n: 0.0,
        lambda: V::new(0.0, 0.0, 0.0),
        approach: 0.0,
        chord: V::new(0.11, -0.07, 0.05),
    };

    /// Penalty alone, newly closed, with multipliers, and with an offset, alone and together. `z0 > 0` keeps points above the
    /// surface in contact.
    pub fn all(z0: f64) -> Vec<(&'static str, Case)> {
        let offset = Case { z0, ..Case::PLAIN };
        let multiplied = Case {
            lambda_n: -0.4,
            lambda: V::new(0.05, 0.09, -0.02),
            ..offset
        };
        vec![
            ("penalty", offset),
            (
                "newly closed",
                Case {
                    approach: 0.13,
                    ..offset
                },
            ),
            ("multipliers", multiplied),
            (
                "newly closed, multipliers",
                Case {
                    approach: 0.13,
                    ..multiplied
                },
            ),
        ]
    }

    pub fn law(&self) -> Augmented {
        Augmented {
            law: Penalty { eps_n: EPS_N },
            z0: self.z0,
            lambda_n: self.lambda_n,
            held: false,
        }
    }

    /// History of a point that is at `x` in the coordinates of the surface.
    pub fn history(&self, x: &V<f64>) -> PointHistory {
        PointHistory {
            base: x - self.chord,
            lambda: self.lambda,
            lambda_n: self.lambda_n,
            approach: self.approach,
            ..PointHistory::default()
        }
    }

    /// Residual at `x` where the traction acts along `n` and the normal coordinate is `xi3`; `slip` makes the traction of a
    /// trial traction, normal and pressure.
    pub fn residual(
        &self,
        base: &V<f64>,
        x: &V<Dual64>,
        n: &V<Dual64>,
        xi3: Dual64,
        slip: impl Fn(&V<Dual64>, &V<Dual64>, Dual64) -> V<Dual64>,
    ) -> V<Dual64> {
        let gap = xi3 - self.z0;
        let traction = gap * EPS_N + self.lambda_n;
        let part = match self.approach > 0.0 {
            true => gap / (gap - self.approach),
            false => Dual64::from(1.0),
        };
        let v = (x - base.map(Dual64::from)) * (part * EPS_T) + self.lambda.map(Dual64::from);
        n * traction + slip(&(v - n * n.dot(&v)), n, -traction)
    }
}

/// Coulomb's law from its definition.
pub fn coulomb(mu: f64) -> impl Fn(&V<Dual64>, &V<Dual64>, Dual64) -> V<Dual64> {
    move |trial, _, pressure| {
        let norm = trial.dot(trial).sqrt();
        match norm.re > mu * pressure.re {
            true => trial * (pressure * mu / norm),
            false => *trial,
        }
    }
}

/// Values and derivatives of a function of a point.
pub fn derivative(x: &V<f64>, f: impl Fn(&V<Dual64>) -> V<Dual64>) -> (V<f64>, Matrix3<f64>) {
    let mut out = (V::zeros(), Matrix3::zeros());
    for dof in 0..3 {
        let at = V::from_fn(|i, _| Dual64::new(x[i], f64::from(u8::from(i == dof))));
        let r = f(&at);
        out.0 = r.map(|r| r.re);
        (0..3).for_each(|i| out.1[(i, dof)] = r[i].eps);
    }
    out
}

/// A place that is neither the origin nor upright.
pub fn pose() -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(0.3, -1.2, 0.7),
        UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -0.9, 1.3)),
    )
}

pub fn bezier(degree: usize) -> Vec<f64> {
    [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat()
}

/// The bicubic rational patch of the tests of normal contact.
pub fn nurbs(p: &support::Patch) -> NurbsPatch {
    let knots = [bezier(3), bezier(3)];
    NurbsPatch::new([3, 3], knots, [4, 4], &p.points, Some(&p.weights)).unwrap()
}

/// A set with the sides that the parameters of its patches say.
pub fn set(patches: Vec<NurbsPatch>) -> PatchSet {
    let mut set = PatchSet::new(patches, None).unwrap();
    set.set_side_as_given(false);
    set
}

/// Evaluates a point of the surface's coordinates on the set at [`pose`].
pub fn touch<F: FrictionLaw>(
    set: &PatchSet,
    case: &Case,
    law: F,
    x: &V<f64>,
    history: &PointHistory,
) -> FrictionTouch {
    let master = RigidMaster {
        surface: set,
        pose: pose(),
        depth: 3.0,
        keep: false,
    };
    let friction = Friction { law, eps_t: EPS_T };
    let at = (master.pose * Point3::from(*x)).coords;
    (master.touch_with_friction(
        &at,
        (&mut None, Overhang::default()),
        &case.law(),
        &friction,
        history,
    ))
    .expect("a reliable foot")
    .expect("contact")
}

/// Compares a touch with a reference in the coordinates of the surface.
pub fn compare(
    what: &str,
    touch: &FrictionTouch,
    (residual, tangent): &(V<f64>, Matrix3<f64>),
    limit: f64,
) {
    let r = pose().rotation.to_rotation_matrix();
    let t = touch.traction.slip.t.norm();
    assert!(t > 1e-2 * residual.norm(), "{what}: no friction to compare");
    assert!(
        touch.traction.tangent.norm() > 1e-2,
        "{what}: no tangent to compare"
    );
    let error = (touch.touch.residual - r * residual).norm() / residual.norm();
    assert!(error < limit, "{what}: residual {error:e}");
    let reference = r * tangent * r.transpose();
    let error = (touch.touch.tangent - reference).norm() / reference.norm();
    assert!(error < limit, "{what}: tangent {error:e}");
}
