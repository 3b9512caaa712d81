use super::super::h8::{Formulation, H8Block, H8System};
use super::super::material::{Law, LawState, with_law};
use super::super::tests::{deformed, laws, mesh, nodes, relative};
use super::*;
use crate::scene::{Elastic, Material};
use covact_geometry::Vec3;
use nalgebra::{SMatrix, SymmetricEigen};
use num_dual::Dual64;

/// Errors of the tangent against derivatives of the forces, and of the forces against those of the energy.
fn errors<L: MaterialLaw>(law: &L) -> [f64; 2] {
    let (re, _) = Reference::new(nodes().map(|x| x.data.0[0]));
    let u = deformed(0.1).map(|u| u.data.0[0]);
    let states = vec![0.0; 8 * L::State::LEN];
    let mut out = H8System::default();
    evaluate(law, &re, &u, &states, &mut out).unwrap();
    let (mut gradient, mut tangent) = (Vec::new(), Vec::new());
    for column in 0..24 {
        let mut dual = u.map(|u| u.map(Dual64::from));
        dual[column / 3][column % 3] = dual[column / 3][column % 3].derivative();
        let (energy, f) = forces(law, &re, &dual, &states).unwrap();
        assert!((energy.re / out.energy - 1.0).abs() < 1e-13);
        gradient.push(energy.eps);
        tangent.extend(f.map(|f| f.eps));
    }
    [relative(&out.k, &tangent), relative(&out.f, &gradient)]
}

#[test]
fn tangent_and_forces_are_derivatives() {
    for law in laws() {
        let found = with_law!(&law, law => errors(law));
        println!("{law:?}: {found:?}");
        assert!(found[0] < 1e-12 && found[1] < 1e-12, "{law:?}: {found:?}");
    }
}

fn rubber(nu: f64) -> Law {
    let (e, density) = (5.0, None);
    Law::new(&Material::NeoHooke(Elastic { e, nu, density })).unwrap()
}

fn system(block: &H8Block, u: &[Vec3; 8]) -> H8System {
    let mut out = H8System::default();
    block.evaluate(0, u, &mut [], &mut out).unwrap();
    out
}

fn eigenvalues(system: &H8System) -> Vec<f64> {
    let k = SMatrix::<f64, 24, 24>::from_column_slice(&system.k);
    let mut values: Vec<f64> = SymmetricEigen::new(k).eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

#[test]
fn only_rigid_motions_are_free_and_only_one_shape_changes_the_volume() {
    for (formulation, stiff) in [
        (Formulation::MeanDilatation, 1),
        (Formulation::Displacement, 7),
    ] {
        let block = H8Block::new(&mesh(&nodes()), formulation, rubber(0.499_999_9)).unwrap();
        let values = eigenvalues(&system(&block, &[Vec3::zeros(); 8]));
        let largest = values[23];
        assert!(values[5] < 1e-9 * largest, "{values:?}");
        assert!(values[6] > 1e-3, "{values:?}");
        // Those that grow as the bulk modulus, 8e6; shears have 1.7.
        let found = values.iter().filter(|v| **v > 1e3).count();
        assert!(
            found == stiff || formulation == Formulation::Displacement && found > stiff,
            "{found}: {values:?}"
        );
    }
}

#[test]
fn homogeneous_deformations_are_those_of_the_plain_brick() {
    let x = nodes();
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.8, 1.1);
    let stretch = nalgebra::Matrix3::new(0.7, 0.2, -0.1, 0.0, 1.2, 0.3, 0.1, 0.0, 0.9);
    let u = x.map(|x| turn * (stretch * x) - x);
    for law in laws().into_iter().take(3) {
        let both = [Formulation::MeanDilatation, Formulation::Displacement]
            .map(|formulation| system(&H8Block::new(&mesh(&x), formulation, law).unwrap(), &u));
        assert!((both[0].energy / both[1].energy - 1.0).abs() < 1e-13);
        assert!(relative(&both[0].f, &both[1].f) < 1e-12);
    }
}

/// Bricks of several heights on a unit square, shortened along z by a part of their height and otherwise free to widen; `h8` gives way
/// at 4 % where flat and at 13 % as a cube ([`super::super::hold`]).
#[test]
fn it_holds_in_strong_compression() {
    for nu in [0.3, 0.45, 0.495] {
        for height in [0.25, 0.5, 1.0, 2.0] {
            let corner = |a: usize, [x, y, z]: [f64; 3]| {
                let bit = |k: usize| f64::from(u8::from(a >> k & 1 == 1));
                Vec3::new(x * bit(0), y * bit(1), z * bit(2))
            };
            let x: [Vec3; 8] = std::array::from_fn(|a| corner(a, [1.0, 1.0, height]));
            let block = H8Block::new(&mesh(&x), Formulation::MeanDilatation, rubber(nu)).unwrap();
            for part in [0.1, 0.25, 0.4, 0.6] {
                let wide = free_width(nu, 1.0 - part);
                let u =
                    std::array::from_fn(|a| corner(a, [wide, wide, height * (1.0 - part)]) - x[a]);
                let loses = block.loses_hold(0, &u, &[]).unwrap();
                println!("nu {nu}, height {height}, shortened by {part}: loses hold {loses}");
                // Slender ones give way at last, as columns do.
                assert!(
                    !loses || height > 1.0 && part > 0.5,
                    "nu {nu}, height {height}, shortened by {part}"
                );
            }
        }
    }
}

/// The stretch sideways at which a neo-Hookean bar shortened to `s` of its length has no stress sideways.
fn free_width(nu: f64, s: f64) -> f64 {
    let lambda_over_mu = 2.0 * nu / (1.0 - 2.0 * nu);
    let (mut low, mut high) = (1.0, 3.0);
    for _ in 0..60 {
        let w: f64 = 0.5 * (low + high);
        let stress = w * w - 1.0 + lambda_over_mu * (w * w * s).ln();
        if stress > 0.0 { high = w } else { low = w }
    }
    low
}
