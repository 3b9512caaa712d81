//! Friction on faces of rigid masters: the tangent against dual numbers, the projection re-solved.
use crate::friction_support::*;
use crate::support::{self, Shape, V};
use covact::contact::friction::law::{Coulomb, FrictionLaw, Slip};
use covact::contact::friction::orthotropic::Orthotropic;
use covact_geometry::Frame;
use nalgebra::{Point3, Unit, Vector3};
use num_dual::{Dual64, DualNum};

/// At most `mu p`, and never more than `most`: the law of two limits of metal forming. Here to show that a new law
/// is one type.
#[derive(Clone, Copy)]
struct Limited {
    mu: f64,
    most: f64,
}

impl FrictionLaw for Limited {
    fn slip<D: DualNum<f64> + Copy>(&self, trial: &V<D>, normal: &V<D>, pressure: D) -> Slip<D> {
        if pressure.re() * self.mu < self.most {
            return Coulomb { mu: self.mu }.slip(trial, normal, pressure);
        }
        let constant = Coulomb { mu: 1.0 }.slip(trial, normal, D::from(self.most));
        Slip {
            d_pressure: Vector3::from_element(D::zero()),
            ..constant
        }
    }
}

/// Runs `check(name, patch, case, slave point, normal and xi3 of a dual point)` over shapes, penetrations and cases.
fn over_all(check: impl Fn(&str, &support::Patch, &Case, &V<f64>, &Foot)) {
    for shape in SHAPES {
        for ratio in [-0.2, -0.05, -0.01, -1e-3, 0.0, 0.04] {
            let p = support::patch(shape);
            let x = support::slave_at(&p, XI, ratio * p.radius);
            let foot = |x: &V<Dual64>| {
                let points = p.points.map(|q| q.map(Dual64::from));
                let xi = support::project(&points, &p.weights, x, XI);
                let frame = Frame::new(&support::jet(&points, &p.weights, xi), 1.0).unwrap();
                (frame.n, (x - frame.rho).dot(&frame.n))
            };
            // Above the surface the gap is measured from farther out still.
            let offsets: &[f64] = if ratio < -1e-3 { &[0.0, 0.1] } else { &[0.1] };
            for &z0 in offsets {
                for (name, case) in Case::all(z0) {
                    let name = format!("{shape:?} at {ratio} R, offset {z0}, {name}");
                    check(&name, &p, &case, &x, &foot);
                }
            }
        }
    }
}

type Foot<'a> = dyn Fn(&V<Dual64>) -> (V<Dual64>, Dual64) + 'a;

fn check_law<F: FrictionLaw>(
    what: &str,
    law: F,
    slides: bool,
    (p, case, x, foot): (&support::Patch, &Case, &V<f64>, &Foot),
    slip: impl Fn(&V<Dual64>, &V<Dual64>, Dual64) -> V<Dual64>,
) {
    let history = case.history(x);
    let at = touch(&set(vec![nurbs(p)]), case, law, x, &history);
    assert_eq!(at.traction.slip.slides, slides, "{what}");
    let reference = derivative(x, |x| {
        let (n, xi3) = foot(x);
        case.residual(&history.base, x, &n, xi3, &slip)
    });
    compare(what, &at, &reference, 1e-11);
}

#[test]
fn exact_tangent_of_stick_and_slip() {
    over_all(|name, p, case, x, foot| {
        // The same point under a coefficient that holds it and under one that does not.
        for (mu, slides) in [(10.0, false), (0.05, true), (0.1, true)] {
            let what = format!("{name}, mu {mu}");
            check_law(
                &what,
                Coulomb { mu },
                slides,
                (p, case, x, foot),
                coulomb(mu),
            );
        }
    });
}

#[test]
fn exact_tangent_of_other_laws() {
    over_all(|name, p, case, x, foot| {
        for direction in [[1.0, 0.4, 0.1], [0.05, -0.06, 1.0]] {
            let law = Orthotropic::new([0.03, 0.12], Unit::new_normalize(Vector3::from(direction)));
            check_law(
                &format!("{name}, orthotropic along {direction:?}"),
                law,
                true,
                (p, case, x, foot),
                |t, n, pressure| law.slip(t, n, pressure).t,
            );
        }
        let law = Limited {
            mu: 0.1,
            most: 0.02,
        };
        let slip = |t: &V<Dual64>, _: &V<Dual64>, pressure: Dual64| {
            let limit = pressure * law.mu;
            let limit = if limit.re < law.most {
                limit
            } else {
                Dual64::from(law.most)
            };
            t * (limit / t.dot(t).sqrt())
        };
        check_law(
            &format!("{name}, limited"),
            law,
            true,
            (p, case, x, foot),
            slip,
        );
    });
}

/// Swapping and turning round the parameters, more knots and the pose itself change nothing.
#[test]
fn neither_the_parametrisation_nor_the_pose_matters() {
    for shape in SHAPES {
        let p = support::patch(shape);
        let patch = nurbs(&p);
        let others = [
            patch.swapped().unwrap(),
            patch.reversed(0).unwrap(),
            patch.reversed(1).unwrap().swapped().unwrap(),
            patch.insert_knots(0, &[0.3, 0.43, 0.7]).unwrap(),
            patch.elevated(1, 1).unwrap(),
        ];
        let x = support::slave_at(&p, XI, -0.05 * p.radius);
        for (name, case) in Case::all(0.0) {
            let history = case.history(&x);
            for mu in [10.0, 0.1] {
                let one = set(vec![patch.clone()]);
                let reference = touch(&one, &case, Coulomb { mu }, &x, &history);
                assert!(reference.traction.slip.t.norm() > 1e-3);
                for (k, other) in others.iter().enumerate() {
                    let mut other = set(vec![other.clone()]);
                    // Swapped and reversed patches have their outward side below.
                    let above = support::slave_at(&p, XI, 0.1);
                    other.orient_towards(&[above]).unwrap();
                    let at = touch(&other, &case, Coulomb { mu }, &x, &history);
                    let what = format!("{shape:?}, {name}, mu {mu}, patch {k}");
                    let error = (at.touch.residual - reference.touch.residual).norm();
                    assert!(error < 1e-12, "{what}: residual {error:e}");
                    let error = (at.touch.tangent - reference.touch.tangent).norm();
                    assert!(error < 1e-11, "{what}: tangent {error:e}");
                }
            }
        }
    }
}

/// A rigid motion of the pair turns residual and tangent, and `K (omega x x)` of the master's and the slave's motion together is
/// `omega x R`: with the master held, `R(exp(-omega) x)` is what its own turning does.
#[test]
fn rigid_motions_of_the_pair_turn_residual_and_tangent() {
    use covact::contact::friction::rigid::Friction;
    use covact::contact::rigid::{Overhang, RigidMaster};
    let p = support::patch(Shape::Saddle);
    let set = set(vec![nurbs(&p)]);
    let x = support::slave_at(&p, XI, -0.05 * p.radius);
    let omega = Vector3::new(0.3, -0.7, 0.5);
    for (name, case) in Case::all(0.0) {
        let history = case.history(&x);
        for mu in [10.0, 0.1] {
            let friction = Friction {
                law: Coulomb { mu },
                eps_t: EPS_T,
            };
            let at = |pose: nalgebra::Isometry3<f64>, x: &V<f64>| {
                let master = RigidMaster {
                    surface: &set,
                    pose,
                    depth: 3.0,
                    keep: false,
                };
                (master.touch_with_friction(
                    x,
                    (&mut None, Overhang::default()),
                    &case.law(),
                    &friction,
                    &history,
                ))
                .unwrap()
                .unwrap()
                .touch
            };
            let still = at(nalgebra::Isometry3::identity(), &x);
            let moved = at(pose(), &(pose() * Point3::from(x)).coords);
            let r = pose().rotation.to_rotation_matrix();
            let error = (moved.residual - r * still.residual).norm();
            assert!(error < 1e-13, "{name}, mu {mu}: {error:e}");
            let error = (moved.tangent - r * still.tangent * r.transpose()).norm();
            assert!(error < 1e-12, "{name}, mu {mu}: {error:e}");
            // By differences of the pose: what the master's turning adds to K (omega x x) makes omega x R.
            let h = 1e-5;
            let turned = |s: f64| at(nalgebra::Isometry3::rotation(omega * s), &x).residual;
            let by_master = (turned(h) - turned(-h)) / (2.0 * h);
            let sum = still.tangent * omega.cross(&x) + by_master;
            let expected = omega.cross(&still.residual);
            assert!(expected.norm() > 1e-2);
            let error = (sum - expected).norm();
            assert!(error < 1e-8, "{name}, mu {mu}: {error:e}");
        }
    }
}
