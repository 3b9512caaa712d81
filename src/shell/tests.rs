//! Derivatives of laws and elements against dual numbers, and the rank of the element.
mod laws;
mod refused;
use super::h8::{Formulation, H8Block, H8System};
use super::kinematics::{self, V};
use super::material::{
    Collapsed, Dashpot, Hardening, Hill48, J2, Law, LawState, MaterialLaw, Metric, with_law,
};
use super::reference::Reference;
use super::tangent::{self, factors};
use super::{ElementFault, FaultCause, ShellError, brick, layered};
use crate::mesh::{ElementKind, Mesh};
use crate::scene::{Elastic, Material};
use covact_geometry::Vec3;
use num_dual::Dual64;

/// Numbers in [-1, 1], the same in every run.
fn random(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A distorted, warped element.
pub(super) fn nodes() -> [Vec3; 8] {
    let mut seed = 1;
    std::array::from_fn(|a| {
        let (i, j, k) = ((a & 1) as f64, ((a >> 1) & 1) as f64, (a >> 2) as f64);
        let mut noise = || random(&mut seed);
        Vec3::new(
            2.0 * i + 0.3 * i * j + 0.05 * noise(),
            1.5 * j + 0.2 * i + 0.05 * noise(),
            0.3 * k + 0.15 * i + 0.1 * i * j + 0.02 * noise(),
        )
    })
}

pub(super) fn mesh(nodes: &[Vec3; 8]) -> Mesh {
    Mesh {
        kind: ElementKind::H8,
        nodes: nodes.to_vec(),
        connectivity: (0..8).collect(),
        node_sets: Default::default(),
        face_sets: Default::default(),
    }
}

pub(super) fn laws() -> [Law; 6] {
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
        hardening: Hardening::Voce {
            initial: 20.0,
            rise: 30.0,
            rate: 15.0,
        },
    });
    let sheet = Law::Hill48(Hill48::new(
        (577.0, 385.0),
        Hardening::Swift {
            factor: 60.0,
            offset: 0.01,
            exponent: 0.2,
        },
        [1.8, 1.4, 2.2],
        [1.0, 0.3, 0.0],
    ));
    let dashpot = Law::Dashpot(Dashpot {
        lambda: 577.0,
        mu: 385.0,
    });
    [a, b, c, metal, sheet, dashpot]
}

const FORMULATIONS: [Formulation; 5] = [
    Formulation::Eas7,
    Formulation::Layered,
    Formulation::Eas3,
    Formulation::Eas0,
    Formulation::Displacement,
];

/// Largest difference relative to the largest expected value, which must not be zero.
pub(super) fn relative(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let scale = expected.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    assert!(scale > 1e-3, "nothing to compare");
    found
        .iter()
        .zip(expected)
        .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()))
        / scale
}

/// States of the law at the points of an element that nothing has happened to.
fn unused<L: MaterialLaw>(_: &L, points: usize) -> Vec<f64> {
    vec![0.0; points * L::State::LEN]
}

/// A strain at which a step ends before the one that is looked at.
const BEFORE: [f64; 6] = [0.05, -0.02, 0.03, 0.2, 0.1, -0.05];

/// Energy, forces and forces on the enhanced strains; eight of these are those of the layered element.
fn forces<D: num_dual::DualNum<f64> + Copy, L: MaterialLaw, const NE: usize>(
    law: &L,
    re: &Reference,
    (u, shares): (&[V<D>; 8], [f64; 2]),
    alpha: &[D; NE],
) -> (D, [D; 24], [D; NE]) {
    if NE < layered::MODES {
        return kinematics::forces(law, re, u, alpha, (&unused(law, 8), shares)).unwrap();
    }
    let all = std::array::from_fn(|m| alpha[m]);
    let states = unused(law, layered::POINTS);
    let (energy, f, h) = layered::forces(law, &re.nodes, u, &all, &states).unwrap();
    (energy, f, std::array::from_fn(|m| h[m]))
}

/// Full tangent of (u, alpha) by dual numbers, columns first.
fn dual_tangent<L: MaterialLaw, const NE: usize>(
    law: &L,
    re: &Reference,
    (u, shares): (&[V<f64>; 8], [f64; 2]),
    alpha: &[f64; NE],
    displacement: bool,
) -> Vec<Vec<f64>> {
    (0..24 + NE)
        .map(|column| {
            let mut ud = u.map(|u| u.map(Dual64::from));
            let mut ad = alpha.map(Dual64::from);
            if column < 24 {
                ud[column / 3][column % 3] = ud[column / 3][column % 3].derivative();
            } else {
                ad[column - 24] = ad[column - 24].derivative();
            }
            if displacement {
                let (_, f) = brick::forces(law, re, &ud, &unused(law, 8)).unwrap();
                f.map(|f| f.eps).to_vec()
            } else {
                let (_, f, h) = forces(law, re, (&ud, shares), &ad);
                f.iter().chain(&h).map(|f| f.eps).collect()
            }
        })
        .collect()
}

/// Forces by differentiating the energy.
fn energy_gradient<L: MaterialLaw, const NE: usize>(
    law: &L,
    re: &Reference,
    (u, shares): (&[V<f64>; 8], [f64; 2]),
    alpha: &[f64; NE],
) -> (Vec<f64>, Vec<f64>) {
    let mut gradient = vec![];
    for column in 0..24 + NE {
        let mut ud = u.map(|u| u.map(Dual64::from));
        let mut ad = alpha.map(Dual64::from);
        if column < 24 {
            ud[column / 3][column % 3] = ud[column / 3][column % 3].derivative();
        } else {
            ad[column - 24] = ad[column - 24].derivative();
        }
        gradient.push(forces(law, re, (&ud, shares), &ad).0.eps);
    }
    let (_, f, h) = forces(law, re, (u, shares), alpha);
    (gradient, f.iter().chain(&h).copied().collect())
}

pub(super) fn deformed(size: f64) -> [Vec3; 8] {
    let mut seed = 7;
    std::array::from_fn(|_| {
        let mut noise = || size * random(&mut seed);
        Vec3::new(noise(), noise(), 0.3 * noise())
    })
}

fn check_element<L: MaterialLaw, const NE: usize>(
    law: &L,
    formulation: Formulation,
    shares: [f64; 2],
) -> [f64; 3] {
    let displacement = formulation == Formulation::Displacement;
    let x = nodes();
    let (re, _) = Reference::new(x.map(|x| x.data.0[0]));
    let u = deformed(0.1);
    let ua = u.map(|u| u.data.0[0]);
    let mut seed = 3;
    let alpha: [f64; NE] = std::array::from_fn(|_| 0.002 * random(&mut seed));
    let mut state = vec![0.0; tangent::state_len(NE)];
    state.extend(unused(law, layered::POINTS));
    state[..NE].copy_from_slice(&alpha);
    let mut out = H8System::default();
    if displacement {
        brick::evaluate(law, &re, &ua, &unused(law, 8), &mut out).unwrap();
    } else if NE == layered::MODES {
        layered::evaluate(law, &re.nodes, &ua, &mut state, &mut out).unwrap();
    } else {
        tangent::evaluate::<_, NE>(law, &re, &ua, (None, shares), &mut state, &mut out).unwrap();
    }
    let exact = dual_tangent(law, &re, (&ua, shares), &alpha, displacement);

    // Undo the condensation with the cache: K + L^T D^-1 L, L, D and f + L^T D^-1 h.
    let l = |m: usize, r: usize| state[2 * NE + 24 * m + r];
    let factor = |i: usize, j: usize| match i.cmp(&j) {
        std::cmp::Ordering::Less => 0.0,
        std::cmp::Ordering::Equal => 1.0,
        std::cmp::Ordering::Greater => state[factors(NE) + i * (i + 1) / 2 + j],
    };
    let pivot = |i: usize| state[factors(NE) + i * (i + 1) / 2 + i];
    let d = nalgebra::DMatrix::from_fn(NE, NE, |i, j| {
        (0..NE)
            .map(|k| factor(i, k) * pivot(k) * factor(j, k))
            .sum::<f64>()
    });
    let lm = nalgebra::DMatrix::from_fn(NE, 24, l);
    let h = nalgebra::DVector::from_fn(NE, |m, _| state[NE + m]);
    let lu = d.clone().lu();
    let (dl, dh) = if NE > 0 {
        (lu.solve(&lm).unwrap(), lu.solve(&h).unwrap())
    } else {
        (lm.clone(), h.clone())
    };
    let k = nalgebra::DMatrix::from_column_slice(24, 24, &out.k) + lm.transpose() * dl;
    let f = nalgebra::DVector::from_column_slice(&out.f) + lm.transpose() * dh;
    // Block by block, because enhanced strains have other units than displacements.
    let mut tangent_error: f64 = 0.0;
    for (rows, columns) in [
        (0..24, 0..24),
        (0..24, 24..24 + NE),
        (24..24 + NE, 0..24),
        (24..24 + NE, 24..24 + NE),
    ] {
        let (mut found, mut expected) = (vec![], vec![]);
        for column in columns.clone() {
            for row in rows.clone() {
                found.push(match (row < 24, column < 24) {
                    (true, true) => k[(row, column)],
                    (true, false) => lm[(column - 24, row)],
                    (false, true) => lm[(row - 24, column)],
                    (false, false) => d[(row - 24, column - 24)],
                });
                expected.push(exact[column][row]);
            }
        }
        if !found.is_empty() {
            tangent_error = tangent_error.max(relative(&found, &expected));
        }
    }
    if displacement {
        let (_, exact) = brick::forces(law, &re, &ua, &unused(law, 8)).unwrap();
        return [tangent_error, relative(&out.f, &exact), 0.0];
    }
    let (gradient, forces) = energy_gradient(law, &re, (&ua, shares), &alpha);
    let found: Vec<f64> = f.iter().chain(h.iter()).copied().collect();
    [
        tangent_error,
        relative(&found, &forces),
        relative(&forces, &gradient),
    ]
}

#[test]
fn element_tangent_is_the_derivative_of_its_forces() {
    for law in laws() {
        for formulation in FORMULATIONS {
            macro_rules! all {
                ($law:expr, $shares:expr) => {
                    match formulation {
                        Formulation::Eas7 => check_element::<_, 7>($law, formulation, $shares),
                        Formulation::Layered => check_element::<_, 8>($law, formulation, $shares),
                        Formulation::Eas3 => check_element::<_, 3>($law, formulation, $shares),
                        _ => check_element::<_, 0>($law, formulation, $shares),
                    }
                };
            }
            for shares in &[[0.0; 2], [0.4, 0.7]][..1 + usize::from(formulation.may_share())] {
                let errors = with_law!(&law, law => all!(law, *shares));
                assert!(
                    errors.iter().all(|e| *e < 1e-12),
                    "{law:?} {formulation:?} {shares:?} {errors:?}"
                );
            }
        }
    }
}

/// With alpha solved so that h(u, alpha) = 0, the condensed tangent is the derivative of the remaining forces f(u).
/// Two Newton steps for alpha carried out in dual numbers give its exact derivative.
#[test]
fn condensed_tangent_is_the_derivative_of_condensed_forces() {
    for law in laws() {
        let block = H8Block::new(&mesh(&nodes()), Formulation::Eas7, law).unwrap();
        let u = deformed(0.08);
        let mut state = vec![0.0; block.state_len()];
        let mut out = H8System::default();
        let still = [Vec3::zeros(); 8];
        for _ in 0..12 {
            block.evaluate(0, &u, &mut state, &mut out).unwrap();
            let alpha: Vec<f64> = state[..7].to_vec();
            block.update_alpha(&mut state, &still, 1.0, &alpha);
        }
        block.evaluate(0, &u, &mut state, &mut out).unwrap();
        assert!(
            state[7..14].iter().all(|h| h.abs() < 1e-10),
            "{:?}",
            &state[7..14]
        );
        assert!(state[..7].iter().any(|a| a.abs() > 1e-4));

        let (re, _) = Reference::new(nodes().map(|x| x.data.0[0]));
        let mut exact = vec![];
        for column in 0..24 {
            let mut ud = u.map(|u| u.data.0[0].map(Dual64::from));
            ud[column / 3][column % 3] = ud[column / 3][column % 3].derivative();
            let mut alpha: [Dual64; 7] = std::array::from_fn(|m| Dual64::from(state[m]));
            let forces = |alpha: &[Dual64; 7]| with_law!(&law, law => kinematics::forces(law, &re, &ud, alpha, (&unused(law, 8), [0.0; 2])).unwrap());
            for _ in 0..2 {
                let (_, _, h) = forces(&alpha);
                // D from duals in alpha alone.
                let d = nalgebra::DMatrix::from_fn(7, 7, |i, j| {
                    let mut a = alpha.map(|a| Dual64::from(a.re));
                    a[j] = a[j].derivative();
                    let uf = ud.map(|u| u.map(|u| Dual64::from(u.re)));
                    with_law!(&law, law => kinematics::forces(law, &re, &uf, &a, (&unused(law, 8), [0.0; 2])).unwrap().2[i].eps)
                });
                let inverse = d.try_inverse().unwrap();
                for m in 0..7 {
                    for n in 0..7 {
                        alpha[m] -= h[n] * inverse[(m, n)];
                    }
                }
            }
            exact.extend(forces(&alpha).1.map(|f| f.eps));
        }
        let error = relative(&out.k, &exact);
        println!("condensed tangent {error:e}");
        assert!(error < 1e-12, "{error:e}");
    }
}

#[test]
fn rank_is_eighteen() {
    for formulation in FORMULATIONS {
        for law in laws() {
            let block = H8Block::new(&mesh(&nodes()), formulation, law).unwrap();
            let mut state = vec![0.0; block.state_len()];
            let mut out = H8System::default();
            block
                .evaluate(0, &[Vec3::zeros(); 8], &mut state, &mut out)
                .unwrap();
            assert!(out.f.iter().all(|f| *f == 0.0) && out.negative_pivots == 0);
            let k = nalgebra::DMatrix::from_column_slice(24, 24, &out.k);
            assert_eq!(k, k.transpose());
            let mut values: Vec<f64> = k.symmetric_eigenvalues().iter().copied().collect();
            values.sort_by(f64::total_cmp);
            assert!(values[0] > -1e-11 * values[23]);
            let zero = values
                .iter()
                .filter(|v| v.abs() < 1e-9 * values[23])
                .count();
            assert_eq!(zero, 6, "{formulation:?} {values:?}");
        }
    }
}

/// A rigid motion with a finite rotation strains nothing, and forces turn with the body.
#[test]
fn rigid_motion_is_free_and_forces_are_objective() {
    let x = nodes();
    let r = nalgebra::Rotation3::from_euler_angles(0.7, -1.1, 2.0);
    let law = laws()[1];
    for formulation in FORMULATIONS {
        let block = H8Block::new(&mesh(&x), formulation, law).unwrap();
        let mut state = vec![0.0; block.state_len()];
        let mut out = H8System::default();
        let shift = Vec3::new(3.0, -2.0, 5.0);
        let rigid = x.map(|x| r * x + shift - x);
        block.evaluate(0, &rigid, &mut state, &mut out).unwrap();
        let k = out.k.iter().fold(0.0f64, |m, k| m.max(k.abs()));
        assert!(out.f.iter().all(|f| f.abs() < 1e-13 * k), "{:?}", out.f);

        let u = deformed(0.1);
        block.evaluate(0, &u, &mut state, &mut out).unwrap();
        let mut turned = H8System::default();
        let ru: [Vec3; 8] = std::array::from_fn(|a| r * (x[a] + u[a]) - x[a]);
        block.evaluate(0, &ru, &mut state, &mut turned).unwrap();
        let expected: Vec<f64> = (0..8)
            .flat_map(|a| (r * Vec3::from_row_slice(&out.f[3 * a..3 * a + 3])).data.0[0])
            .collect();
        assert!(relative(&turned.f, &expected) < 1e-12);

        // The stress of the turned element is the turned stress, and a pure stretch gives the closed form.
        let (mut plain, mut rotated) = ([[0.0; 6]; 8], [[0.0; 6]; 8]);
        block.stresses(0, &u, &state, &mut plain).unwrap();
        block.stresses(0, &ru, &state, &mut rotated).unwrap();
        for g in 0..8 {
            let t = |v: &[f64; 6]| {
                nalgebra::Matrix3::new(v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2])
            };
            let expected = r.matrix() * t(&plain[g]) * r.matrix().transpose();
            assert!(relative(t(&rotated[g]).as_slice(), expected.as_slice()) < 1e-12);
        }
    }
}

/// Uniaxial stretch s without lateral strain: sigma_xx = (mu (s^2 - 1) + lambda ln s) / s, sigma_yy = lambda ln s / s.
#[test]
fn cauchy_stress_of_a_stretch() {
    let x = nodes();
    let Law::NeoHooke(law) = laws()[1] else {
        unreachable!()
    };
    let s: f64 = 1.4;
    let u = x.map(|x| Vec3::new((s - 1.0) * x.x, 0.0, 0.0));
    let lateral = law.lambda * s.ln() / s;
    let expected = [
        (law.mu * (s * s - 1.0) + law.lambda * s.ln()) / s,
        lateral,
        lateral,
        0.0,
        0.0,
        0.0,
    ];
    let block = H8Block::new(&mesh(&x), Formulation::Displacement, Law::NeoHooke(law)).unwrap();
    let mut points = [[0.0; 6]; 8];
    block.stresses(0, &u, &[], &mut points).unwrap();
    for point in points.iter().chain(&super::extrapolate(&points)) {
        assert!(relative(point, &expected) < 1e-12, "{point:?}");
    }
}

#[test]
fn residual_repeats_the_assembly_and_alpha_follows_it() {
    for formulation in FORMULATIONS {
        let block = H8Block::new(&mesh(&nodes()), formulation, laws()[1]).unwrap();
        let u = deformed(0.05);
        let mut state = vec![0.0; block.state_len()];
        let mut out = H8System::default();
        // Solve for alpha first: with h = 0 the change of alpha vanishes with du.
        for _ in 0..12 {
            block.evaluate(0, &u, &mut state, &mut out).unwrap();
            let alpha = state.clone();
            block.update_alpha(&mut state, &[Vec3::zeros(); 8], 1.0, &alpha);
        }
        block.evaluate(0, &u, &mut state, &mut out).unwrap();
        let mut f = [0.0; 24];
        let energy = block.residual(0, &u, &state, &mut f).unwrap();
        assert!(relative(&f, &out.f) < 1e-13 && (energy / out.energy - 1.0).abs() < 1e-13);
        // A small step: f* + K* du is matched to second order by f*(u + du, alpha + dalpha).
        let mut errors = vec![];
        for size in [1e-3, 5e-4] {
            let du = deformed(size);
            let mut next = state.clone();
            block.update_alpha(&mut next, &du, 1.0, &state);
            let moved = std::array::from_fn(|a| u[a] + du[a]);
            block.residual(0, &moved, &next, &mut f).unwrap();
            let linear: Vec<f64> = (0..24)
                .map(|r| {
                    out.f[r]
                        + (0..24)
                            .map(|c| out.k[24 * c + r] * du[c / 3][c % 3])
                            .sum::<f64>()
                })
                .collect();
            errors.push(relative(&f, &linear));
        }
        assert!(errors[1] > 0.0 && errors[0] / errors[1] > 3.5, "{errors:?}");
    }
}

/// Neo-Hooke loses its shear stiffness mu - lambda ln J where J > exp(mu / lambda), here 1.95: in an element blown up to
/// J = 3.4 the enhanced strains are unstable, and it says so; at J = 1.3 it does not.
#[test]
fn instability_of_enhanced_strains_is_counted() {
    let x = nodes();
    let block = H8Block::new(&mesh(&x), Formulation::Eas7, laws()[1]).unwrap();
    let mut state = vec![0.0; block.state_len()];
    let mut out = H8System::default();
    let mut count = |stretch: f64| {
        block
            .evaluate(0, &x.map(|x| (stretch - 1.0) * x), &mut state, &mut out)
            .unwrap();
        out.negative_pivots
    };
    assert_eq!(count(1.09), 0);
    assert!(count(1.5) > 0);
}
