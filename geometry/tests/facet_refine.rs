//! Facets of smooth surfaces: distance, normals, areas, shared nodes.

use covact_geometry::facet::{
    FacetError, Faceted, Refinement, bilinear_facets, biquadratic_facets, facet_patch,
};
use covact_geometry::primitives::{cylinder, plane, sphere, sphere_without_poles, torus};
use covact_geometry::{Frame, Location, NurbsPatch, PatchSet, Surface, Vec3};
use std::collections::HashMap;

const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// Largest value of `f` at `n` by `n` points inside of every facet.
fn largest<S: Surface>(facets: &[S], n: usize, f: impl Fn(&covact_geometry::Jet) -> f64) -> f64 {
    let mut out = 0.0f64;
    for facet in facets {
        for k in 0..n * n {
            let xi = [k % n, k / n].map(|i| (2 * i + 1) as f64 / n as f64 - 1.0);
            out = out.max(f(&facet.jet(xi)));
        }
    }
    out
}

fn area<S: Surface>(facets: &[S]) -> f64 {
    let mut sum = 0.0;
    for facet in facets {
        for (s, v) in GAUSS {
            for (r, w) in GAUSS {
                let [a, b] = facet.jet([r, s]).rho_i;
                sum += v * w * a.cross(&b).norm();
            }
        }
    }
    sum
}

/// Distance from a torus about the z axis, and its normal there.
fn from_torus(x: &Vec3, major: f64, minor: f64) -> (f64, Vec3) {
    let ring = Vec3::new(x.x, x.y, 0.0).normalize() * major;
    let out = x - ring;
    ((out.norm() - minor).abs(), out.normalize())
}

/// `[distance, angle of normals, area error, curvature error]` for `n` facets per span.
fn torus_errors<S: Surface>(facets: &[S], h: impl Fn(&covact_geometry::Jet) -> f64) -> [f64; 4] {
    let exact = 4.0 * std::f64::consts::PI.powi(2) * 3.0;
    [
        largest(facets, 4, |j| from_torus(&j.rho, 3.0, 1.0).0),
        largest(facets, 4, |j| {
            let n = Frame::new(j, 1.0).unwrap().n;
            let m = from_torus(&j.rho, 3.0, 1.0).1;
            n.cross(&m).norm().atan2(n.dot(&m))
        }),
        (area(facets) - exact).abs() / exact,
        largest(facets, 4, h),
    ]
}

fn rates(errors: &[[f64; 4]]) -> Vec<[f64; 4]> {
    errors
        .windows(2)
        .map(|w| std::array::from_fn(|k| (w[0][k] / w[1][k]).log2()))
        .collect()
}

/// A torus of radii 3 and 1, exact distance, normal and area (4 pi^2 3). Interpolation of degree p: distance p + 1, normals
/// p, areas 2 and 4 (the error of the area is of the order of the distance squared over the size of a facet squared, and of
/// the mean of the distance, whose leading odd part cancels). Curvature of biquadratic facets about that of the torus, the
/// smaller principal one of which is -1: rate p - 1; a bilinear facet has none along its lines.
#[test]
fn rates_on_a_torus() {
    let set = facet_patch(torus(3.0, 1.0, Vec3::zeros(), Vec3::z()).unwrap()).unwrap();
    let (mut four, mut nine) = (Vec::new(), Vec::new());
    for n in [2, 4, 8, 16] {
        let facets = bilinear_facets(&set, Refinement::PerSpan(n)).unwrap();
        let facets = facets.mesh.surfaces().unwrap();
        four.push(torus_errors(&facets, |j| {
            let h = Frame::new(j, 1.0).unwrap().h;
            assert!(h[0] == 0.0 && h[2] == 0.0);
            // Over the size of the facet, to see that it vanishes faster than the metric.
            let a = Frame::new(j, 1.0).unwrap().a;
            h[1].abs() / (a[0] * a[2]).sqrt()
        }));
        let facets = biquadratic_facets(&set, Refinement::PerSpan(n)).unwrap();
        let facets = facets.mesh.surfaces().unwrap();
        nine.push(torus_errors(&facets, |j| {
            let f = Frame::new(j, 1.0).unwrap();
            (f.principal_curvatures()[0] + 1.0).abs()
        }));
    }
    println!("bilinear {four:?}\n{:?}", rates(&four));
    println!("biquadratic {nine:?}\n{:?}", rates(&nine));
}
