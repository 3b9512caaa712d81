//! Patch tests on the distorted plate of R. H. MacNeal and R. L. Harder, Finite Elem. Anal. Des. 1 (1985) 3-20,
//! figure 2: 0.24 x 0.12 x 0.001, E = 1e6, nu = 0.25.
use super::support::{Model, plain, st_venant};
use covact::shell::Formulation;
use covact_geometry::Vec3;
use std::collections::BTreeMap;

const T: f64 = 1e-3;
const NU: f64 = 0.25;
pub const POINTS: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [0.24, 0.0],
    [0.24, 0.12],
    [0.0, 0.12],
    [0.04, 0.02],
    [0.18, 0.03],
    [0.16, 0.08],
    [0.08, 0.08],
];
pub const QUADS: [[u32; 4]; 5] = [
    [0, 1, 4, 5],
    [1, 2, 5, 6],
    [2, 3, 6, 7],
    [3, 0, 7, 4],
    [4, 5, 7, 6],
];

/// Errors of the inner nodes relative to the largest exact value: in-plane displacements, w.
fn run(formulation: Formulation, bending: bool) -> [f64; 2] {
    let mut nodes = vec![];
    for z in [-0.5 * T, 0.5 * T] {
        nodes.extend(POINTS.iter().map(|p| Vec3::new(p[0], p[1], z)));
    }
    let connectivity = QUADS
        .iter()
        .flat_map(|q| (0..8).map(|a| q[a & 3] + 8 * (a as u32 >> 2)))
        .collect();
    let mesh = plain(nodes, connectivity);
    let exact: Vec<f64> = mesh
        .nodes
        .iter()
        .flat_map(|p| {
            let (x, y, z) = (p.x, p.y, p.z);
            let w = if bending {
                0.5 * (x * x + x * y + y * y)
            } else {
                -2.0 * NU / (1.0 - NU) * z
            };
            let f = if bending { -z } else { 1.0 };
            [1e-3 * f * (x + 0.5 * y), 1e-3 * f * (y + 0.5 * x), 1e-3 * w]
        })
        .collect();
    let mut fixed = BTreeMap::new();
    for node in 0..16 {
        if node % 8 < 4 {
            for axis in 0..3 {
                // Membrane: the thickness is free, three corners of the bottom hold the plate.
                if axis < 2 || bending || [0, 1, 3].contains(&node) {
                    fixed.insert(3 * node + axis, exact[3 * node + axis]);
                }
            }
        }
    }
    if !bending {
        // The bottom stays in its own plane, displaced by Poisson's effect about the mid-surface.
        for node in [0, 1, 3] {
            fixed.insert(3 * node + 2, exact[3 * node + 2]);
        }
    }
    let mut model = Model::new(&mesh, formulation, st_venant(1e6, NU));
    let u = model.linear(&[0.0; 48], &fixed);
    let error = |axes: &[usize]| {
        let largest = (0..16)
            .flat_map(|n| axes.iter().map(move |x| 3 * n + x))
            .fold(0.0, |m: f64, d| m.max(exact[d].abs()));
        let inner = (0..16)
            .filter(|n| n % 8 >= 4)
            .flat_map(|n| axes.iter().map(move |x| 3 * n + x));
        inner.fold(0.0, |m: f64, d| m.max((u[d] - exact[d]).abs())) / largest
    };
    [error(&[0, 1]), error(&[2])]
}

/// Constant membrane strain is exact for every formulation.
#[test]
fn membrane() {
    for formulation in [
        Formulation::Eas7,
        Formulation::Eas3,
        Formulation::Eas0,
        Formulation::Displacement,
    ] {
        let errors = run(formulation, false);
        println!("membrane {formulation:?}: {errors:?}");
        assert!(
            errors.iter().all(|e| *e < 1e-8),
            "{formulation:?} {errors:?}"
        );
    }
}

/// Constant curvature is exact with the enhanced thickness strain {t, rt, st}; without it the thickness cannot follow,
/// and the displacement brick locks by orders of magnitude.
#[test]
fn bending() {
    for formulation in [Formulation::Eas7, Formulation::Eas3] {
        let errors = run(formulation, true);
        println!("bending {formulation:?}: {errors:?}");
        assert!(
            errors.iter().all(|e| *e < 1e-8),
            "{formulation:?} {errors:?}"
        );
    }
    let locked = run(Formulation::Displacement, true);
    println!("bending, displacement brick: {locked:?}");
    assert!(locked[1] > 0.1);
}
