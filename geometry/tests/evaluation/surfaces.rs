//! Primitive surfaces against their analytic forms: jets to third order, frames, curvatures, the equations of Gauss and
//! Weingarten.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_8};

use crate::common::{Knots, derivatives, list, patch, samples, worst};
use covact_geometry::primitives::{
    PrimitiveError, cylinder, plane, sphere, sphere_without_poles, torus,
};
use covact_geometry::{Frame, NurbsPatch, Vec3};
use num_dual::{Dual64, DualNum, HyperHyperDual64 as H};

/// Angle at the parameter `t` of a quarter arc in rational quadratic form. By symmetry the tangent of half the angle
/// from the middle of the arc is linear in the parameter.
fn angle<D: DualNum<f64> + Copy>(t: D) -> D {
    let middle = (t.re() / FRAC_PI_2).floor() * FRAC_PI_2 + FRAC_PI_4;
    ((t - middle) * (FRAC_PI_8.tan() / FRAC_PI_4)).atan() * 2.0 + middle
}

const CENTER: [f64; 3] = [0.3, -1.2, 0.7];

fn center() -> Vec3 {
    Vec3::from(CENTER)
}

/// The axis is z, so the first direction of the primitives is x.
fn axis() -> Vec3 {
    Vec3::new(0.0, 0.0, 3.0)
}

fn place(x: [H; 3]) -> [H; 3] {
    [x[0] + CENTER[0], x[1] + CENTER[1], x[2] + CENTER[2]]
}

/// Jets to third order against `exact`, written with trigonometric functions and differentiated by dual numbers. Rounding
/// in both: a few hundred eps for third derivatives.
fn jets(patch: &NurbsPatch, exact: impl Fn([H; 2]) -> [H; 3]) {
    let pairs: Vec<_> = samples(patch, 60, 17)
        .into_iter()
        .map(|xi| (list(&patch.jet3(xi)), derivatives(|x| place(exact(x)), xi)))
        .collect();
    let error = worst(&pairs);
    println!("{error:?}");
    assert!(error.iter().all(|&e| e < 1e-12), "{error:?}");
}

#[test]
fn jets_of_the_sphere() {
    let r = 2.5;
    jets(&sphere(r, center(), axis()).unwrap(), |[t, s]| {
        let (theta, phi) = (angle(t), angle(s));
        [
            phi.cos() * theta.cos() * r,
            phi.cos() * theta.sin() * r,
            phi.sin() * r,
        ]
    });
}

#[test]
fn jets_of_the_cylinder() {
    let (r, length) = (0.4, 3.0);
    jets(&cylinder(r, length, center(), axis()).unwrap(), |[t, s]| {
        [angle(t).cos() * r, angle(t).sin() * r, s - 0.5 * length]
    });
}

#[test]
fn jets_of_the_torus() {
    let (major, minor) = (3.0, 0.8);
    jets(&torus(major, minor, center(), axis()).unwrap(), |[t, s]| {
        let (theta, phi) = (angle(t), angle(s));
        let r = phi.cos() * minor + major;
        [r * theta.cos(), r * theta.sin(), phi.sin() * minor]
    });
}

fn frames(patch: &NurbsPatch) -> impl Iterator<Item = ([f64; 2], Frame)> + '_ {
    samples(patch, 200, 23)
        .into_iter()
        .map(|xi| (xi, Frame::new(&patch.jet(xi), 1.0).unwrap()))
}

/// Sphere of radius R, any parametrisation: n = (rho - c)/R, h_ij = -a_ij/R, both principal curvatures -1/R.
#[test]
fn frames_of_spheres() {
    let r = 1.7;
    let axis = Vec3::new(0.2, -1.0, 0.5);
    let mut patches = vec![sphere(r, center(), axis).unwrap()];
    patches.extend(sphere_without_poles(r, center(), axis).unwrap());
    for patch in &patches {
        for (_, frame) in frames(patch) {
            assert!((frame.n - (frame.rho - center()) / r).norm() < 1e-13);
            let size = frame.a[0] + frame.a[2];
            for k in 0..3 {
                assert!((frame.h[k] + frame.a[k] / r).abs() < 1e-12 * size);
            }
            // Near the poles rho_1 is small, and the digits that it loses are lost to the curvatures too.
            let lost = size / frame.area;
            for kappa in frame.principal_curvatures() {
                assert!((kappa + 1.0 / r).abs() < 1e-13 * lost, "{kappa}, {lost}");
            }
        }
    }
}

/// Six patches cover the sphere once: their areas sum to that of the sphere (8-point Gauss rule).
#[test]
fn patches_without_poles_cover_the_sphere_once() {
    let r = 2.0;
    let gauss = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];
    let rule: Vec<(f64, f64)> = gauss
        .into_iter()
        .flat_map(|(x, w)| [(x, w), (-x, w)])
        .collect();
    let mut area = 0.0;
    for patch in sphere_without_poles(r, center(), axis()).unwrap() {
        assert_eq!(patch.degenerate_edges(1e-9), [false; 4]);
        assert!(patch.weights().iter().all(|&w| w > 0.0));
        for (x, wx) in &rule {
            for (y, wy) in &rule {
                let xi = [x, y].map(|s| FRAC_PI_4 * (1.0 + s));
                let frame = Frame::new(&patch.jet(xi), 1.0).unwrap();
                area += wx * wy * FRAC_PI_4.powi(2) * frame.area;
            }
        }
    }
    let exact = 4.0 * std::f64::consts::PI * r * r;
    println!("area off by {:e}", area / exact - 1.0);
    assert!((area / exact - 1.0).abs() < 1e-8);
}

#[test]
fn curvatures_of_cylinder_torus_and_plane() {
    let r = 0.4;
    for (_, frame) in frames(&cylinder(r, 3.0, center(), axis()).unwrap()) {
        let radial = (frame.rho - center()).component_mul(&Vec3::new(1.0, 1.0, 0.0));
        assert!((frame.n - radial / r).norm() < 1e-13);
        let [low, high] = frame.principal_curvatures();
        assert!(
            (low + 1.0 / r).abs() < 1e-12 && high.abs() < 1e-12,
            "{low} {high}"
        );
    }
    let (major, minor) = (3.0, 0.8);
    for ([_, s], frame) in frames(&torus(major, minor, center(), axis()).unwrap()) {
        let phi = angle(s);
        let across = -phi.cos() / (major + minor * phi.cos());
        let [low, high] = frame.principal_curvatures();
        assert!((low + 1.0 / minor).abs() < 1e-12 && (high - across).abs() < 1e-12);
    }
    let normal = Vec3::new(1.0, 2.0, -2.0);
    for (_, frame) in frames(&plane(center(), normal, [2.0, 5.0]).unwrap()) {
        assert!((frame.n - normal / 3.0).norm() < 1e-14);
        assert!((frame.area - 1.0).abs() < 1e-14, "parameters are lengths");
        assert_eq!(frame.h.map(|h| h.abs() < 1e-15), [true; 3]);
    }
}

/// On a general rational patch: Gauss' equation rho_ij = Gamma^k_ij rho_k + h_ij n; Weingarten's n_,i and the metric's
/// derivatives against dual numbers; Christoffel symbols against those of the metric, Gamma^k_ij = a^kl (a_jl,i + a_il,j
/// - a_ij,l) / 2; raised and mixed forms against matrix products; turning the side over.
#[test]
fn equations_of_gauss_and_weingarten() {
    for (degree, kind) in [([3, 2], Knots::Clamped), ([2, 5], Knots::Unclamped)] {
        let patch = patch(degree, [kind; 2], 0.8, 77);
        let points: Vec<Vec3<Dual64>> =
            patch.points().iter().map(|x| x.map(Dual64::from)).collect();
        let (mut bent, mut tested) = (0.0, 0);
        for xi in samples(&patch, 40, 5) {
            let jet = patch.jet(xi);
            let Some(frame) = Frame::new(&jet, 1.0) else {
                continue;
            };
            // Elsewhere digits are lost to nearly parallel tangents.
            let size = frame.a[0].max(frame.a[2]);
            if size > 10.0 * frame.area {
                continue;
            }
            tested += 1;
            let tol = 1e-11 * (1.0 + frame.h.iter().map(|h| h.abs()).fold(0.0, f64::max));
            let gamma = frame.christoffel();
            let [up1, up2] = frame.rho_up();
            let eye = [
                up1.dot(&frame.rho_i[0]),
                up1.dot(&frame.rho_i[1]),
                up2.dot(&frame.rho_i[1]),
            ];
            for (x, y) in eye.into_iter().zip([1.0, 0.0, 1.0]) {
                assert!((x - y).abs() < tol);
            }
            let [gamma_1, gamma_2] = gamma;
            for (k, rho_k) in jet.rho_ij.iter().enumerate() {
                let tangential = jet.rho_i[0] * gamma_1[k] + jet.rho_i[1] * gamma_2[k];
                let sum = tangential + frame.n * frame.h[k];
                assert!((sum - rho_k).norm() < tol * rho_k.norm().max(1.0));
            }
            let moved = [0, 1].map(|dir| {
                let mut x = xi.map(Dual64::from);
                x[dir].eps = 1.0;
                let jet = patch.jet_generic(&points, x, None).unwrap().jet;
                Frame::new(&jet, 1.0).unwrap()
            });
            for (moved, n_i) in moved.iter().zip(frame.n_i()) {
                let exact = moved.n.map(|x| x.eps);
                assert!(exact.norm() > 0.0);
                assert!((n_i - exact).norm() < tol * exact.norm().max(1.0));
            }
            let index = |i: usize, j: usize| i + j;
            let a = |i: usize, j: usize, l: usize| moved[l].a[index(i, j)].eps;
            for (i, j) in [(0, 0), (0, 1), (1, 1)] {
                for (k, gamma) in gamma.iter().enumerate() {
                    let mut sum = 0.0;
                    for l in 0..2 {
                        let bracket = a(j, l, i) + a(i, l, j) - a(i, j, l);
                        sum += 0.5 * frame.a_inv[index(k, l)] * bracket;
                    }
                    assert!((sum - gamma[index(i, j)]).abs() < tol * sum.abs().max(1.0));
                }
            }
            let symmetric = |m: [f64; 3]| nalgebra::Matrix2::new(m[0], m[1], m[1], m[2]);
            let (inverse, h) = (symmetric(frame.a_inv), symmetric(frame.h));
            let raised = inverse * h * inverse;
            let scale = raised.norm().max(1.0);
            assert!((symmetric(frame.h_inv()) - raised).norm() < tol * scale);
            let [[m11, m12], [m21, m22]] = frame.h_mixed();
            let mixed = nalgebra::Matrix2::new(m11, m12, m21, m22);
            assert!((mixed - h * inverse).norm() < tol * scale);
            let [low, high] = frame.principal_curvatures();
            assert!(low <= high);
            assert!((low + high - mixed.trace()).abs() < tol * scale);
            assert!((low * high - mixed.determinant()).abs() < tol * scale * scale);
            bent += (high - low).abs();
            let turned = Frame::new(&jet, -1.0).unwrap();
            assert_eq!((turned.n, turned.a), (-frame.n, frame.a));
            assert_eq!(turned.h, frame.h.map(|h| -h));
            assert_eq!(turned.principal_curvatures(), [-high, -low]);
        }
        assert!(
            bent > 1.0 && tested > 20,
            "curvature {bent}, {tested} points"
        );
    }
}

/// No frame at a pole, nor with parallel or undefined tangents; one close to the pole.
#[test]
fn degenerate_points_have_no_frame() {
    let patch = sphere(1.0, center(), axis()).unwrap();
    for s in [-FRAC_PI_2, FRAC_PI_2] {
        assert!(Frame::new(&patch.jet([1.0, s]), 1.0).is_none());
    }
    let near = Frame::new(&patch.jet([1.0, FRAC_PI_2 - 1e-6]), 1.0).unwrap();
    assert!((near.n - Vec3::z()).norm() < 2e-6);
    let mut jet = patch.jet([1.0, 0.0]);
    jet.rho_i[1] = jet.rho_i[0] * 2.0;
    assert!(Frame::new(&jet, 1.0).is_none());
    jet.rho_i[1] = Vec3::new(f64::NAN, 0.0, 0.0);
    assert!(Frame::new(&jet, 1.0).is_none());
    assert_eq!(patch.degenerate_edges(1e-12), [false, false, true, true]);
}

/// Inner double knots of circles are creases of the parametrisation but not of the surface.
#[test]
fn circles_have_no_sharp_knots() {
    let patch = torus(3.0, 1.0, center(), axis()).unwrap();
    for dir in 0..2 {
        assert_eq!(
            patch.crease_knots(dir),
            [1.0, 2.0, 3.0].map(|k| k * FRAC_PI_2)
        );
        assert!(patch.sharp_knots(dir, 1e-9).is_empty());
    }
}

#[test]
fn primitives_refuse_what_is_no_surface() {
    let (c, z) = (center(), Vec3::z());
    assert_eq!(
        sphere(-1.0, c, z),
        Err(PrimitiveError::Length {
            name: "radius",
            value: -1.0
        })
    );
    assert!(matches!(
        sphere(f64::NAN, c, z),
        Err(PrimitiveError::Length { .. })
    ));
    assert_eq!(
        sphere_without_poles(1.0, c, Vec3::zeros()),
        Err(PrimitiveError::Direction { name: "axis" })
    );
    assert_eq!(
        cylinder(1.0, 0.0, c, z),
        Err(PrimitiveError::Length {
            name: "length",
            value: 0.0
        })
    );
    assert_eq!(
        plane(c, Vec3::new(0.0, f64::INFINITY, 0.0), [1.0; 2]),
        Err(PrimitiveError::Direction { name: "normal" })
    );
    assert_eq!(
        torus(1.0, 1.5, c, z),
        Err(PrimitiveError::Torus {
            major: 1.0,
            minor: 1.5
        })
    );
    assert!(matches!(
        sphere(1.0, Vec3::new(f64::NAN, 0.0, 0.0), z),
        Err(PrimitiveError::Patch(_))
    ));
    assert!(sphere(1.0, c, z * 1e-200).is_ok());
}
