//! Friction on edges, vertices, creases and poles of rigid masters: tangents against dual numbers, the closest point re-solved,
//! and the direction of a traction that does not vanish with the distance.
use crate::friction_support::*;
use crate::support::V;
use covact::contact::corner;
use covact::contact::friction::law::Coulomb;
use covact::contact::law::NormalLaw;
use covact_geometry::{Location, NurbsPatch, PatchSet, Vec3};
use nalgebra::{Matrix3, Vector3};
use num_dual::{Dual64, DualNum};

/// The two sides of a valley bent along its bottom, as nets of biquadratic patches: `x` outward, `y` along the bottom.
fn valley_nets() -> [Vec<Vec3>; 2] {
    let side = |sign: f64| -> Vec<Vec3> {
        (0..9)
            .map(|k| (f64::from(k % 3) * 0.5, f64::from(k / 3) * 0.5 - 0.5))
            .map(|(x, y)| {
                let z = 0.3 * y * y + 0.2 * x * x + 0.6 * x + 0.1 * x * y * (1.0 + sign);
                Vec3::new(sign * x + 0.2 * y * y, y, z)
            })
            .collect()
    };
    [side(1.0), side(-1.0)]
}

fn biquadratic(points: &[Vec3]) -> NurbsPatch {
    NurbsPatch::new([2, 2], [bezier(2), bezier(2)], [3, 3], points, None).unwrap()
}

/// The valley as two patches with a sharp edge.
fn edged() -> PatchSet {
    let mut set = PatchSet::new(valley_nets().map(|n| biquadratic(&n)).to_vec(), None).unwrap();
    set.orient_towards(&[Vec3::new(0.0, 0.0, 0.5)]).unwrap();
    set
}

/// The valley as one patch with a crease.
fn creased() -> PatchSet {
    let [right, left] = valley_nets();
    let row = |j: usize| {
        [
            left[3 * j + 2],
            left[3 * j + 1],
            right[3 * j],
            right[3 * j + 1],
            right[3 * j + 2],
        ]
    };
    let points: Vec<Vec3> = (0..3).flat_map(row).collect();
    let kink = vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0];
    let patch = NurbsPatch::new([2, 2], [kink, bezier(2)], [5, 3], &points, None).unwrap();
    set(vec![patch])
}

/// The bottom of the valley: point and two derivatives at `t`.
fn bottom(t: Dual64) -> [V<Dual64>; 3] {
    let net = &valley_nets()[0];
    let p = [net[0], net[3], net[6]].map(|p| p.map(Dual64::from));
    let s = -t + 1.0;
    [
        p[0] * (s * s) + p[1] * (s * t * 2.0) + p[2] * (t * t),
        (p[1] - p[0]) * (s * 2.0) + (p[2] - p[1]) * (t * 2.0),
        (p[0] - p[1] * Dual64::from(2.0) + p[2]) * Dual64::from(2.0),
    ]
}

/// Parameter of the point of the bottom that is nearest to `x`.
fn nearest(x: &V<Dual64>) -> Dual64 {
    let mut t = Dual64::from(0.4);
    for _ in 0..14 {
        let [p, d1, d2] = bottom(t);
        let d = x - p;
        t += d1.dot(&d) / (d1.dot(&d1) - d2.dot(&d));
    }
    t
}

/// Pseudo-normal of the valley at the parameter `t` of its bottom.
fn pseudo_normal(t: Dual64) -> V<Dual64> {
    let sum = valley_nets()
        .into_iter()
        .fold(V::from_element(Dual64::from(0.0)), |sum, net| {
            let patch = biquadratic(&net);
            let points: Vec<_> = net.iter().map(|p| p.map(Dual64::from)).collect();
            let jet = patch
                .jet_generic(&points, [Dual64::from(0.0), t], None)
                .unwrap()
                .jet;
            let n = jet.rho_i[0].cross(&jet.rho_i[1]);
            sum + n * (n.dot(&n).sqrt().recip() * n.z.re.signum())
        });
    sum * sum.dot(&sum).sqrt().recip()
}

/// A point at `distance` below the bottom, within the wedge of those that are nearest to it.
fn below(t: f64, lean: f64, distance: f64) -> V<f64> {
    let [p, d1, _] = bottom(Dual64::from(t));
    let (p, along) = (p.map(|x| x.re), d1.map(|x| x.re).normalize());
    let m = pseudo_normal(Dual64::from(t)).map(|x| x.re);
    let across = along.cross(&m);
    p - (m + across * lean).normalize() * distance
}

#[test]
fn exact_tangent_on_edges_and_creases() {
    for (what, set) in [("edge", edged()), ("crease", creased())] {
        for (distance, lean) in [(0.2, 0.1), (0.03, -0.25), (1e-3, 0.3)] {
            let x = below(0.4, lean, distance);
            let foot = set.project(&x, None, 1.0).unwrap();
            assert!(
                matches!(
                    foot.location,
                    Location::Edge { .. } | Location::Crease { .. }
                ),
                "{:?}",
                foot.location
            );
            for (name, case) in Case::all(0.0) {
                let history = case.history(&x);
                for (mu, slides) in [(100.0, false), (0.02, true)] {
                    let what = format!("{what} at {distance}, {name}, mu {mu}");
                    let at = touch(&set, &case, Coulomb { mu }, &x, &history);
                    assert_eq!(at.traction.slip.slides, slides, "{what}");
                    let reference = derivative(&x, |x| {
                        let [p, ..] = bottom(nearest(x));
                        let d = x - p;
                        let xi3 = -d.dot(&d).sqrt();
                        case.residual(&history.base, x, &(d / xi3), xi3, coulomb(mu))
                    });
                    // The direction of a short distance has fewer digits.
                    compare(&what, &at, &reference, 1e-11f64.max(1e-14 / distance));
                }
            }
        }
    }
}

/// Two creases that cross: `z = |x| + |y|`.
fn crossing() -> PatchSet {
    let knots = || vec![0.0, 0.0, 0.5, 1.0, 1.0];
    let at = |i: usize| i as f64 - 1.0;
    let points: Vec<Vec3> = (0..9)
        .map(|k| (at(k % 3), at(k / 3)))
        .map(|(x, y)| Vec3::new(x, y, x.abs() + y.abs()))
        .collect();
    set(vec![
        NurbsPatch::new([1, 1], [knots(), knots()], [3, 3], &points, None).unwrap(),
    ])
}

/// Three plane faces that meet in a point, a pit.
fn pit() -> PatchSet {
    let ray = |k: usize| {
        let angle = k as f64 * std::f64::consts::TAU / 3.0;
        Vec3::new(angle.cos(), angle.sin(), 0.6)
    };
    let face = |k: usize| {
        let (a, b) = (ray(k), ray(k + 1));
        let knots = [bezier(1), bezier(1)];
        NurbsPatch::new([1, 1], knots, [2, 2], &[Vec3::zeros(), a, b, a + b], None).unwrap()
    };
    let mut set = PatchSet::new((0..3).map(face).collect(), None).unwrap();
    set.orient_towards(&[Vec3::new(0.0, 0.0, 0.5)]).unwrap();
    set
}

#[test]
fn exact_tangent_at_vertices() {
    let corner = pit()
        .project(&V::new(0.01, -0.02, -0.1), None, 1.0)
        .unwrap();
    assert!(
        matches!(corner.location, Location::Corner { .. }),
        "{:?}",
        corner.location
    );
    assert!((corner.normal - Vec3::z()).norm() < 1e-12);
    for (set, x) in [
        (crossing(), V::new(0.01, -0.02, -0.1)),
        (crossing(), V::new(1e-4, 2e-4, -1e-3)),
        (pit(), V::new(0.01, -0.02, -0.1)),
    ] {
        for (name, case) in Case::all(0.0) {
            let history = case.history(&x);
            for (mu, slides) in [(100.0, false), (0.02, true)] {
                let what = format!("vertex, {name}, mu {mu}");
                let at = touch(&set, &case, Coulomb { mu }, &x, &history);
                assert_eq!(at.traction.slip.slides, slides, "{what}");
                let reference = derivative(&x, |x| {
                    let xi3 = -x.dot(x).sqrt();
                    case.residual(&history.base, x, &(x / xi3), xi3, coulomb(mu))
                });
                compare(&what, &at, &reference, 1e-11);
            }
        }
    }
}

/// The direction within and about the radius, at a radius large enough for all digits: from the kernel, whose radius is an argument.
#[test]
fn exact_tangent_where_the_pseudo_normal_stands_in() {
    const RADIUS: f64 = 0.02;
    let case = Case {
        z0: 0.0,
        lambda_n: -0.4,
        lambda: V::new(0.05, 0.09, -0.02),
        ..Case::PLAIN
    };
    let m = V::new(0.1, -0.2, 1.0).normalize();
    for at_edge in [true, false] {
        for share in [0.0, 1e-3, 0.1, 0.5, 0.999, 1.0] {
            // A vertex at the origin, or the valley's bottom.
            let x = match at_edge {
                true => below(0.4, 0.3, share * RADIUS),
                false => V::new(0.02, 0.03, -0.1).normalize() * (share * RADIUS),
            };
            let foot = |x: &V<Dual64>| {
                if !at_edge {
                    return (*x, m.map(Dual64::from));
                }
                let t = nearest(x);
                (x - bottom(t)[0], pseudo_normal(t))
            };
            // d and m carry derivatives; e is blended from its definition.
            let direction = |x: &V<Dual64>| {
                let (d, m) = foot(x);
                if share == 0.0 {
                    return (m, m.dot(&d));
                }
                let xi3 = -d.dot(&d).sqrt();
                let q = -xi3 / RADIUS;
                let w = match q.re < 1.0 {
                    true => q * q * (-q * 2.0 + 3.0),
                    false => Dual64::from(1.0),
                };
                let v = m * (-w + 1.0) + d / xi3 * w;
                (v * v.dot(&v).sqrt().recip(), xi3)
            };
            let value = x.map(Dual64::from);
            let (d, xi3) = (foot(&value).0.map(|x| x.re), direction(&value).1.re);
            let (m0, m_turn) = derivative(&x, |x| foot(x).1);
            let [_, d1, d2] = bottom(nearest(&value)).map(|v| v.map(|x| x.re));
            let line = at_edge.then_some((&d1, &d2));
            let steady = corner::steady(&d, xi3, line, &m0, &m_turn, RADIUS);
            let (n, turn) = derivative(&x, |x| direction(x).0);
            let what = format!("edge {at_edge}, {share} of the radius");
            assert!((steady.n - n).norm() < 1e-14, "{what}");
            if share > 0.0 || at_edge {
                assert!(turn.norm() > 1e-2, "{what}: nothing to compare");
            }
            let error = (steady.turn - turn).norm() / turn.norm().max(1.0);
            assert!(error < 1e-11, "{what}: turning {error:e}");
            let normal = case.law().response(xi3);
            for (mu, slides) in [(100.0, false), (0.2, true)] {
                let attraction = case.history(&x).attraction(EPS_T);
                let law = Coulomb { mu };
                let traction = attraction.traction_towards(
                    &law,
                    &x,
                    &steady.n,
                    &steady.gradient,
                    &steady.turn,
                    xi3,
                    &normal,
                );
                assert_eq!(traction.slip.slides, slides, "{what}");
                let k = steady.n * steady.gradient.transpose() * normal.dn
                    + steady.turn * normal.n
                    + traction.tangent;
                let base = attraction.base;
                let (r, reference) = derivative(&x, |x| {
                    let (n, xi3) = direction(x);
                    case.residual(&base, x, &n, xi3, coulomb(mu))
                });
                assert!(
                    (steady.n * normal.n + traction.slip.t - r).norm() < 1e-13,
                    "{what}"
                );
                let error = (k - reference).norm() / reference.norm();
                assert!(error < 1e-11, "{what}, mu {mu}: {error:e}");
            }
        }
    }
}

/// On the real surface the direction goes over into the pseudo-normal continuously, and the tangent is the slope of the residual
/// all the way; a penalty, whose force vanishes with the distance, is left as it is.
#[test]
fn forces_next_to_edges_creases_and_vertices_are_continuous() {
    let case = Case {
        z0: 0.0,
        lambda_n: -0.4,
        lambda: V::new(0.05, 0.09, -0.02),
        ..Case::PLAIN
    };
    for (what, set, at) in [
        ("edge", edged(), None),
        ("crease", creased(), None),
        (
            "vertex",
            crossing(),
            Some(V::new(0.3, 0.2, -1.0).normalize()),
        ),
        ("corner", pit(), Some(V::new(0.3, 0.1, -1.0).normalize())),
    ] {
        let radius = 1e-6 * set.size();
        let place = |share: f64| match at {
            None => below(0.4, 0.3, share * radius),
            Some(direction) => direction * (share * radius),
        };
        let history = case.history(&place(0.0));
        for mu in [100.0, 0.2] {
            let evaluate = |x: &V<f64>| touch(&set, &case, Coulomb { mu }, x, &history);
            // Towards the line: from the direction of the distance to the pseudo-normal, without a jump on the way.
            let far = evaluate(&place(5.0)).touch.residual;
            let near = evaluate(&place(1e-3)).touch.residual;
            assert!((far - near).norm() > 0.05, "{what}: the direction matters");
            let mut last = evaluate(&place(1.3)).touch.residual;
            for k in (0..130).rev() {
                let now = evaluate(&place(0.01 * f64::from(k) + 1e-3)).touch.residual;
                assert!((now - last).norm() < 0.03, "{what}: a jump at {k}");
                last = now;
            }
            let step = 1e-8 * radius;
            let [inside, outside] = [1.0 - 1e-8, 1.0 + 1e-8].map(|s| evaluate(&place(s)).touch);
            let jump = (inside.residual - outside.residual).norm();
            assert!(jump < 1e-7, "{what}: {jump:e} over {step:e}");
            let jump = (inside.tangent - outside.tangent).norm() / outside.tangent.norm();
            assert!(jump < 1e-6, "{what}: {jump:e}");
            for share in [0.2, 0.7, 1.2, 3.0] {
                let x = place(share);
                let k = evaluate(&x).touch.tangent;
                // Differences are off by (h / r)^2, and by rounding over h.
                let h = 2e-4 * radius;
                let r = pose().rotation.to_rotation_matrix();
                let slopes = Matrix3::from_columns(&[0, 1, 2].map(|c| {
                    let step = Vector3::ith(c, h);
                    let [a, b] = [1.0, -1.0].map(|s| evaluate(&(x + step * s)).touch.residual);
                    (a - b) / (2.0 * h)
                }));
                let slopes = slopes * r.transpose();
                let error = (k - slopes).norm() / k.norm();
                assert!(error < 1e-5, "{what} at {share}, mu {mu}: {error:e}");
            }
        }
        let x = place(0.3);
        let plain = touch(
            &set,
            &Case::PLAIN,
            Coulomb { mu: 0.0 },
            &x,
            &Case::PLAIN.history(&x),
        );
        let normal = Case::PLAIN.law().response(-0.3 * radius);
        assert!((plain.touch.residual.norm() - normal.n.abs()).abs() < 1e-9 * normal.n.abs());
        assert_eq!(Case::PLAIN.law().steady_radius(1.0), 0.0);
    }
}

/// Pole of an ellipsoid: the parameters say nothing there, the ways out of it do.
#[test]
fn exact_tangent_at_a_pole() {
    let (a, b, c) = (1.3, 0.8, 0.6);
    let ball = covact_geometry::primitives::sphere(1.0, Vec3::zeros(), Vec3::z()).unwrap();
    let patch = ball
        .transformed(&|x| Vec3::new(a * x.x, b * x.y, c * x.z))
        .unwrap();
    let set = PatchSet::new(vec![patch], None).unwrap();
    let x = V::new(0.0, 0.0, c - 0.1);
    assert!(matches!(
        set.project(&x, None, 1.0).unwrap().location,
        Location::Pole { .. }
    ));
    for (name, case) in Case::all(0.0) {
        let history = case.history(&x);
        for (mu, slides) in [(100.0, false), (0.1, true)] {
            let what = format!("pole, {name}, mu {mu}");
            let at = touch(&set, &case, Coulomb { mu }, &x, &history);
            assert_eq!(at.traction.slip.slides, slides, "{what}");
            // The top of the ellipsoid as a graph, whose closest point is found by Newton's method.
            let reference = derivative(&x, |x| {
                let graph = |u: [Dual64; 2]| {
                    let (p, q) = (u[0] / a, u[1] / b);
                    let s = (-p * p - q * q + 1.0).sqrt();
                    let z = s * c;
                    let z1 = -p / s * (c / a);
                    let z2 = -q / s * (c / b);
                    let s3 = s * s * s;
                    let z11 = -(-q * q + 1.0) / s3 * (c / (a * a));
                    let z22 = -(-p * p + 1.0) / s3 * (c / (b * b));
                    let z12 = -p * q / s3 * (c / (a * b));
                    (z, [z1, z2], [z11, z12, z22])
                };
                let mut u = [Dual64::from(0.0); 2];
                for _ in 0..8 {
                    let (z, d, h) = graph(u);
                    let up = x.z - z;
                    let g = [0, 1].map(|i| (x[i] - u[i]) + d[i] * up);
                    let f11 = d[0] * d[0] + 1.0 - h[0] * up;
                    let f12 = d[0] * d[1] - h[1] * up;
                    let f22 = d[1] * d[1] + 1.0 - h[2] * up;
                    let det = f11 * f22 - f12 * f12;
                    u[0] += (f22 * g[0] - f12 * g[1]) / det;
                    u[1] += (f11 * g[1] - f12 * g[0]) / det;
                }
                let (z, d, _) = graph(u);
                let n = V::new(-d[0], -d[1], Dual64::from(1.0));
                let n = n * n.dot(&n).sqrt().recip();
                let xi3 = (x - V::new(u[0], u[1], z)).dot(&n);
                case.residual(&history.base, x, &n, xi3, coulomb(mu))
            });
            compare(&what, &at, &reference, 1e-11);
        }
    }
}
