//! Derivatives of Q18 against dual numbers, and its rank.
use super::super::material::{Hardening, J2, Law, with_law};
use super::reference::{MODES, Reference};
use super::strain::forces;
use super::{DOFS, Q18Block, Q18System};
use crate::mesh::{ElementKind, Mesh};
use crate::scene::{Elastic, Material};
use covact_geometry::Vec3;
use num_dual::Dual64;

fn random(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A distorted, curved element.
fn nodes() -> [Vec3; 18] {
    let mut seed = 1;
    std::array::from_fn(|a| {
        let (i, j, k) = (
            (a % 3) as f64 / 2.0,
            (a / 3 % 3) as f64 / 2.0,
            (a / 9) as f64,
        );
        let mut noise = || random(&mut seed);
        Vec3::new(
            2.0 * i + 0.3 * i * j + 0.02 * noise(),
            1.5 * j + 0.2 * i + 0.02 * noise(),
            0.2 * k + 0.15 * i * i + 0.1 * i * j + 0.005 * noise(),
        )
    })
}

fn block(law: Law) -> Q18Block {
    let mesh = Mesh {
        kind: ElementKind::Q18,
        nodes: nodes().to_vec(),
        connectivity: (0..18).collect(),
        node_sets: Default::default(),
        face_sets: Default::default(),
    };
    Q18Block::new(&mesh, law).unwrap()
}

fn laws() -> [Law; 4] {
    let elastic = Elastic {
        e: 1000.0,
        nu: 0.3,
        density: None,
    };
    let [a, b, c] = [
        Material::StVenantKirchhoff(elastic),
        Material::NeoHooke(elastic),
        Material::Hencky(elastic),
    ]
    .map(|m| Law::new(&m).unwrap());
    // Most points flow.
    let metal = Law::J2(J2 {
        lambda: 577.0,
        mu: 385.0,
        hardening: Hardening::Linear {
            initial: 5.0,
            slope: 50.0,
        },
    });
    [a, b, c, metal]
}

fn displacement() -> [Vec3; 18] {
    let mut seed = 7;
    std::array::from_fn(|_| {
        let mut noise = || random(&mut seed);
        Vec3::new(0.02 * noise(), 0.02 * noise(), 0.008 * noise())
    })
}

/// Forces on nodes and enhanced strains for dual numbers, `dof` being varied (54 and above: alpha).
fn dual(
    law: &Law,
    re: &Reference,
    u: &[Vec3; 18],
    alpha: &[f64; MODES],
    dof: usize,
) -> Vec<Dual64> {
    let mut x = u.map(|u| u.data.0[0].map(Dual64::from));
    let mut a = alpha.map(Dual64::from);
    match dof.checked_sub(DOFS) {
        None => x[dof / 3][dof % 3] = x[dof / 3][dof % 3].derivative(),
        Some(m) => a[m] = a[m].derivative(),
    }
    let y: [[Dual64; 3]; 18] = std::array::from_fn(|b| {
        let (low, high) = (x[b % 9], x[b % 9 + 9]);
        std::array::from_fn(|k| {
            if b < 9 {
                (high[k] + low[k]) * 0.5
            } else {
                (high[k] - low[k]) * 0.5
            }
        })
    });
    let law_len = law.state_len();
    let (energy, f, h) =
        with_law!(law, law => forces(law, re, &y, &a, &vec![0.0; 18 * law_len])).unwrap();
    let mut out = vec![energy];
    for node in 0..18 {
        for k in 0..3 {
            let (m, d) = (f[node % 9][k], f[node % 9 + 9][k]);
            out.push(if node < 9 { m - d } else { m + d } * 0.5);
        }
    }
    out.extend(h);
    out
}

/// Energy gives forces and forces give the tangent, all enhanced strains included; the condensed system is
/// `K - L^T D^-1 L` of those.
#[test]
fn derivatives_are_those_of_dual_numbers() {
    for law in laws() {
        let block = block(law);
        let re = &block.reference[0];
        let u = displacement();
        let alpha = [0.001, -0.002, 0.0015, 0.0005];
        let mut state = vec![0.0; block.state_len()];
        state[..MODES].copy_from_slice(&alpha);
        let mut system = Q18System::default();
        block.evaluate(0, &u, &mut state, &mut system).unwrap();

        let n = DOFS + MODES;
        let columns: Vec<Vec<Dual64>> = (0..n).map(|c| dual(&law, re, &u, &alpha, c)).collect();
        let force: Vec<f64> = columns[0][1..].iter().map(|f| f.re).collect();
        let slope: Vec<f64> = columns.iter().map(|c| c[0].eps).collect();
        let largest = force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        assert!(largest > 1.0, "nothing to compare");
        for (f, s) in force.iter().zip(&slope) {
            assert!((f - s).abs() < 1e-12 * largest, "{f} {s}");
        }
        let full = nalgebra::DMatrix::from_fn(n, n, |r, c| columns[c][1 + r].eps);
        let d = full.view((DOFS, DOFS), (MODES, MODES)).into_owned();
        let l = full.view((DOFS, 0), (MODES, DOFS)).into_owned();
        let inverse = d.try_inverse().unwrap();
        let condensed = full.view((0, 0), (DOFS, DOFS)) - l.transpose() * &inverse * &l;
        let h = nalgebra::DVector::from_column_slice(&force[DOFS..]);
        let f = nalgebra::DVector::from_column_slice(&force[..DOFS]) - l.transpose() * inverse * h;
        let scale = condensed.amax();
        assert!(scale > 1.0);
        for c in 0..DOFS {
            assert!((f[c] - system.f[c]).abs() < 1e-12 * largest);
            for r in 0..DOFS {
                let found = system.k[c * DOFS + r];
                assert!((found - condensed[(r, c)]).abs() < 2e-12 * scale, "{r} {c}");
                assert_eq!(found, system.k[r * DOFS + c]);
            }
        }
        let mut again = [0.0; DOFS];
        let energy = block.residual(0, &u, &state, &mut again).unwrap();
        assert!((energy / system.energy - 1.0).abs() < 1e-13);
        for (a, b) in again.iter().zip(&system.f) {
            assert!((a - b).abs() < 1e-12 * largest);
        }
    }
}

/// Only rigid motions cost no energy: six zero eigenvalues of 54, the next ones well above.
#[test]
fn six_rigid_motions() {
    for law in laws() {
        let block = block(law);
        let mut state = vec![0.0; block.state_len()];
        let mut system = Q18System::default();
        let zero = [Vec3::zeros(); 18];
        block.evaluate(0, &zero, &mut state, &mut system).unwrap();
        let k = nalgebra::DMatrix::from_column_slice(DOFS, DOFS, &system.k[..]);
        let mut values: Vec<f64> = k.symmetric_eigenvalues().iter().copied().collect();
        values.sort_by(f64::total_cmp);
        let largest = values[DOFS - 1];
        assert!(
            values[..6].iter().all(|v| v.abs() < 1e-11 * largest),
            "{values:?}"
        );
        assert!(values[6] > 1e-7 * largest, "{values:?}");
    }
}

/// A finite rotation leaves no forces.
#[test]
fn rigid_rotation_is_free() {
    let block = block(laws()[0]);
    let rotation = nalgebra::Rotation3::from_euler_angles(0.7, -1.1, 2.0);
    let u = nodes().map(|x| rotation * x - x);
    let mut state = vec![0.0; block.state_len()];
    let mut system = Q18System::default();
    block.evaluate(0, &u, &mut state, &mut system).unwrap();
    let stiffness = system.k.iter().fold(0.0f64, |m, k| m.max(k.abs()));
    assert!(stiffness > 1.0);
    let largest = system.f.iter().fold(0.0f64, |m, f| m.max(f.abs()));
    assert!(largest < 1e-13 * stiffness, "{largest} {stiffness}");
}

/// What a mesh measures by corners (positions, faces) takes those of the quadratic element.
#[test]
fn corners_of_the_mesh_are_those_of_the_element() {
    let x = nodes();
    let mesh = Mesh {
        kind: ElementKind::Q18,
        nodes: x.to_vec(),
        connectivity: (0..18).collect(),
        node_sets: Default::default(),
        face_sets: Default::default(),
    };
    let corners = [0, 2, 6, 8, 9, 11, 15, 17];
    assert_eq!(mesh.element_positions(0), corners.map(|a: usize| x[a]));
    let top = crate::mesh::Face {
        element: 0,
        face: 5,
    };
    assert_eq!(mesh.face_corners(top), [9, 11, 15, 17]);
    assert_eq!(
        mesh.face_nodes(top).nodes(),
        [9, 10, 11, 12, 13, 14, 15, 16, 17]
    );
}
