//! Elements of Hencky's law: uniform stretch and rotation.
use super::support::{Grid, Model, grid_of};
use covact::mesh::ElementKind;
use covact::scene::{Elastic, Material};
use covact::shell::{Formulation, Law};
use nalgebra::{Matrix3, Rotation3, Vector3};

const E: f64 = 1000.0;
const NU: f64 = 0.3;

fn law() -> Law {
    Law::new(&Material::Hencky(Elastic {
        e: E,
        nu: NU,
        density: None,
    }))
    .unwrap()
}

/// Two unequal elements along x, of this skewness in plane, in the box 3 x 2 x 0.5.
fn strip(kind: ElementKind, skew: f64) -> Grid {
    grid_of(kind, 2, 1, |a, b, c| {
        let bent = skew * a * (1.0 - a) * b;
        [3.0 * a + bent, 2.0 * b + bent, 0.25 * c]
    })
}

fn models(grid: impl Fn(ElementKind) -> Grid) -> Vec<(Grid, Model)> {
    let formulations = [
        Formulation::Eas7,
        Formulation::Eas3,
        Formulation::Eas0,
        Formulation::Displacement,
    ];
    let mut models: Vec<_> = (formulations.into_iter())
        .map(|formulation| {
            let grid = grid(ElementKind::H8);
            let model = Model::new(&grid.mesh, formulation, law());
            (grid, model)
        })
        .collect();
    let grid = grid(ElementKind::Q18);
    let model = Model::q18(&grid.mesh, law());
    models.push((grid, model));
    models
}

/// Displacements of `x -> f x`.
fn moved(grid: &Grid, f: &Matrix3<f64>) -> Vec<f64> {
    (grid.mesh.nodes.iter())
        .flat_map(|x| {
            let x = Vector3::from(x.data.0[0]);
            <[f64; 3]>::from(f * x - x)
        })
        .collect()
}

/// A bar that is free sideways carries `E ln l / l` per undeformed area at its ends and nothing at its sides.
#[test]
fn uniaxial_stretch() {
    for stretch in [0.5f64, 0.8, 1.3, 2.0] {
        let across = stretch.powf(-NU);
        let f = Matrix3::from_diagonal(&[stretch, across, across].into());
        let exact = E * stretch.ln() / stretch * (2.0 * 0.5);
        for (grid, mut model) in models(|kind| strip(kind, 0.0)) {
            let (forces, _) = model.assemble(&moved(&grid, &f));
            let mut ends = [0.0; 2];
            for (x, f) in grid.mesh.nodes.iter().zip(forces.chunks_exact(3)) {
                match x.x {
                    0.0 => ends[0] += f[0],
                    3.0 => ends[1] += f[0],
                    _ => assert!(f[0].abs() < 1e-8 * exact.abs(), "inside: {f:?}"),
                }
                let sideways = f[1].abs().max(f[2].abs());
                assert!(sideways < 2e-8 * exact.abs(), "{stretch}: {f:?}");
            }
            for (found, sign) in ends.into_iter().zip([-1.0, 1.0]) {
                let error = (sign * found / exact - 1.0).abs();
                assert!(error < 2e-8, "{stretch}: {found} for {exact}");
            }
        }
    }
}

/// Forces turn with a deformed body, and a turned body that is not deformed has none.
#[test]
fn forces_turn_with_the_body() {
    let q = *Rotation3::from_euler_angles(0.9, -0.4, 2.0).matrix();
    let f = Matrix3::new(1.3, 0.4, 0.0, -0.1, 0.8, 0.1, 0.05, 0.0, 1.1);
    for (grid, mut model) in models(|kind| strip(kind, 0.6)) {
        let (still, _) = model.assemble(&moved(&grid, &f));
        let scale = still.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        assert!(scale > 10.0, "{scale}");
        let (turned, _) = model.assemble(&moved(&grid, &(q * f)));
        for (a, b) in still.chunks_exact(3).zip(turned.chunks_exact(3)) {
            let expected = q * Vector3::from_column_slice(a);
            let off = (expected - Vector3::from_column_slice(b)).amax();
            assert!(off < 1e-12 * scale, "{off:e} of {scale}");
        }
        let (rigid, _) = model.assemble(&moved(&grid, &q));
        assert!(rigid.iter().all(|f| f.abs() < 1e-11 * scale));
    }
}
