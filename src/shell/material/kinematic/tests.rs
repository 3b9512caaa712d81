use super::super::j2::tests::CASES;
use super::super::{J2, J2State};
use super::*;
use crate::shell::tests::relative;
use nalgebra::{DMatrix, DVector, Matrix3};
use num_dual::Dual64;

const E: f64 = 200.0;
const NU: f64 = 0.3;

fn law(hardening: Hardening, modulus: f64, recovery: f64) -> ArmstrongFrederick {
    ArmstrongFrederick {
        lambda: E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)),
        mu: 0.5 * E / (1.0 + NU),
        hardening,
        modulus,
        recovery,
    }
}

const VOCE: Hardening = Hardening::Voce {
    initial: 0.3,
    rise: 0.1,
    rate: 15.0,
};

/// A bar free sideways at a logarithmic strain: axial Kirchhoff stress, strain, and the state at the end.
fn pulled(
    law: &ArmstrongFrederick,
    log: f64,
    across: &mut f64,
    old: &ArmstrongFrederickState,
) -> (f64, ArmstrongFrederickState) {
    let l2 = (2.0 * log).exp();
    let strain = |across: f64| [0.5 * (l2 - 1.0), across, across, 0.0, 0.0, 0.0];
    let at = |across: f64| {
        law.response(&Metric::CARTESIAN, &strain(across), old)
            .unwrap()
    };
    for _ in 0..20 {
        let r = at(*across);
        *across -= r.stress[1] / (r.tangent[1][1] + r.tangent[1][2]);
    }
    let r = at(*across);
    assert!(r.stress[1].abs() < 1e-12, "{}", r.stress[1]);
    let new = (law.advance(&Metric::CARTESIAN, &strain(*across), old)).unwrap();
    (r.stress[0] * l2, new)
}

/// Strains between +-.01 of a metal of yield stress .3 with C = 20, gamma = 100: the stress settles at
/// `sigma_y + C/gamma tanh(gamma dp / 2)` with the plastic strain `dp` of half a cycle, .431.
#[test]
fn a_loop_settles_at_its_closed_form() {
    let law = law(
        Hardening::Linear {
            initial: 0.3,
            slope: 0.0,
        },
        20.0,
        100.0,
    );
    for steps in [5, 20] {
        let (mut old, mut across) = (ArmstrongFrederickState::UNUSED, 0.0);
        let mut turned = [[0.0; 2]; 2];
        for half in 0..20 {
            let (from, to) = match half {
                0 => (0.0, 0.01),
                h if h % 2 == 1 => (0.01, -0.01),
                _ => (-0.01, 0.01),
            };
            for step in 1..=steps {
                let log = from + (to - from) * f64::from(step) / f64::from(steps);
                let (tau, new) = pulled(&law, log, &mut across, &old);
                old = new;
                turned[half % 2] = [tau, old.strain[0]];
            }
        }
        let [[top, above], [bottom, below]] = turned;
        let exact = 0.3 + 0.2 * (50.0 * (above - below)).tanh();
        println!("{steps}: {top} {bottom} {exact}");
        assert!((exact - 0.431).abs() < 2e-4, "{exact}");
        // In steps of any size.
        assert!((top / exact - 1.0).abs() < 1e-10, "{top} {exact}");
        assert!((top / bottom + 1.0).abs() < 1e-10, "{top} {bottom}");
    }
}

/// Tension: `tau = sigma_y(p) + C/gamma (1 - exp(-gamma p))` with `p = ln l - tau / E`, in steps of any size.
#[test]
fn tension_follows_the_back_stress() {
    for (modulus, recovery) in [(8.0, 40.0), (8.0, 0.0), (20.0, 100.0)] {
        let law = law(VOCE, modulus, recovery);
        for steps in [1, 7] {
            let (mut old, mut across) = (ArmstrongFrederickState::UNUSED, 0.0);
            let mut tau = 0.0;
            for step in 1..=steps {
                let log = 0.05 * f64::from(step) / f64::from(steps);
                (tau, old) = pulled(&law, log, &mut across, &old);
            }
            let p = 0.05 - tau / E;
            let back = match recovery > 0.0 {
                true => modulus / recovery * (1.0 - (-recovery * p).exp()),
                false => modulus * p,
            };
            let exact = 0.4 - 0.1 * (-15.0 * p).exp() + back;
            println!("{modulus} {recovery} {steps}: {tau} {exact}");
            assert!(back > 0.1 && (tau / exact - 1.0).abs() < 1e-11);
            assert!((old.p / p - 1.0).abs() < 1e-11);
        }
    }
}

/// A way of strains that turns, in a skew frame.
fn way() -> (Metric, [[f64; 6]; 4]) {
    let metric = Metric::new([1.3, 0.8, 0.05, 0.2, -0.03, 0.04]);
    let strains = [
        [0.01, -0.004, 0.0, 0.012, -0.002, 0.001],
        [0.03, 0.01, -0.001, 0.002, 0.004, 0.001],
        [-0.02, 0.02, 0.0005, -0.02, 0.001, -0.003],
        [-0.025, 0.022, 0.0006, -0.015, 0.0, -0.002],
    ];
    (metric, strains)
}

/// Tangents against dual numbers through the whole law, after steps that left a back stress; with recovery they are not symmetric.
#[test]
fn the_tangent_is_the_derivative_of_the_stress() {
    for (modulus, recovery) in [(8.0, 40.0), (8.0, 0.0), (0.0, 40.0)] {
        let law = law(VOCE, modulus, recovery);
        let (metric, strains) = way();
        let mut old = ArmstrongFrederickState::UNUSED;
        let (mut uneven, mut flowed) = (0.0f64, 0);
        for strain in &strains {
            let response = law.response(&metric, strain, &old).unwrap();
            let mut exact = [[0.0; 6]; 6];
            for w in 0..6 {
                let mut e = strain.map(Dual64::from);
                e[w] = e[w].derivative();
                let (_, s) = law.stress(&metric, &e, &old).unwrap();
                for v in 0..6 {
                    exact[v][w] = s[v].eps;
                }
            }
            let error = relative(response.tangent.as_flattened(), exact.as_flattened());
            assert!(error < 1e-12, "{error:e}");
            let largest = exact
                .as_flattened()
                .iter()
                .fold(0.0f64, |m, k| m.max(k.abs()));
            for v in 0..6 {
                for w in 0..v {
                    let off = (response.tangent[v][w] - response.tangent[w][v]).abs() / largest;
                    uneven = uneven.max(off);
                }
            }
            let new = law.advance(&metric, strain, &old).unwrap();
            flowed += u32::from(new.p > old.p);
            old = new;
        }
        println!("{modulus} {recovery}: {uneven:e}");
        assert_eq!(flowed, 4);
        match law.symmetric() {
            true => assert_eq!(uneven, 0.0),
            false => assert!(uneven > 1e-4, "{uneven:e}"),
        }
    }
}

/// Without recovery the stress is the gradient of the energy.
#[test]
fn without_recovery_the_energy_gives_the_stress() {
    let law = law(VOCE, 8.0, 0.0);
    let (metric, strains) = way();
    let mut old = ArmstrongFrederickState::UNUSED;
    for strain in &strains {
        let response = law.response(&metric, strain, &old).unwrap();
        let gradient: [f64; 6] = std::array::from_fn(|v| {
            let mut e = strain.map(Dual64::from);
            e[v] = e[v].derivative();
            law.energy(&metric, &e, &old).unwrap().eps
        });
        let error = relative(&response.stress, &gradient);
        assert!(error < 1e-12, "{error:e}");
        old = law.advance(&metric, strain, &old).unwrap();
    }
    assert!(old.held > 1e-5);
}

/// No back stress: the law of von Mises, to rounding.
#[test]
fn without_a_back_stress_it_is_the_law_of_von_mises() {
    for hardening in CASES {
        for recovery in [0.0, 50.0] {
            let own = ArmstrongFrederick {
                lambda: 1000.0 * E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)),
                mu: 500.0 * E / (1.0 + NU),
                ..law(hardening, 0.0, recovery)
            };
            let plain = J2 {
                lambda: own.lambda,
                mu: own.mu,
                hardening,
            };
            let (metric, strains) = way();
            let (mut a, mut b) = (ArmstrongFrederickState::UNUSED, J2State::UNUSED);
            for strain in &strains {
                let (r, s) = (
                    own.response(&metric, strain, &a).unwrap(),
                    plain.response(&metric, strain, &b).unwrap(),
                );
                assert!(relative(&r.stress, &s.stress) < 1e-13);
                let tangents = (r.tangent.as_flattened(), s.tangent.as_flattened());
                assert!(relative(tangents.0, tangents.1) < 1e-13);
                assert!((r.energy / s.energy - 1.0).abs() < 1e-13);
                a = own.advance(&metric, strain, &a).unwrap();
                b = plain.advance(&metric, strain, &b).unwrap();
                assert!(b.p > 0.0 && (a.p / b.p - 1.0).abs() < 1e-13);
                assert!((a.work / b.work - 1.0).abs() < 1e-12);
            }
        }
    }
}

/// The trapezoidal work of the stress over logarithmic strains is what is stored elastically and the plastic work, to rounding, over
/// steps of any size.
#[test]
fn the_energies_of_a_step_close() {
    let law = law(VOCE, 8.0, 40.0);
    let (metric, strains) = way();
    let mut old = ArmstrongFrederickState::UNUSED;
    let mut before = [0.0; 6];
    let (mut done, mut energy) = (0.0, 0.0);
    for strain in &strains {
        let h = Logarithm::new(&metric, strain).unwrap();
        let h = raise(&h.mixed, &metric.upper);
        let new = law.advance(&metric, strain, &old).unwrap();
        let mean: [f64; 6] = std::array::from_fn(|v| 0.5 * (old.stress[v] + new.stress[v]));
        let change: [f64; 6] = std::array::from_fn(|v| h[v] - before[v]);
        done += contract(&metric, &mean, &change);
        (before, old) = (h, new);
        let PlasticWork { done, in_energy } = law.plastic_work(&old);
        // At the state that is taken over nothing flows.
        energy = law.response(&metric, strain, &old).unwrap().energy - in_energy + done;
    }
    println!("{done} {energy}");
    assert!(old.work > 1e-2 && (energy / done - 1.0).abs() < 1e-12);
}

/// Strains of the same deformations in a skew frame give the same stresses.
#[test]
fn no_frame_is_preferred() {
    let law = law(VOCE, 8.0, 40.0);
    let (_, strains) = way();
    let frame = Matrix3::new(1.1, 0.2, -0.1, 0.3, 0.9, 0.05, 0.1, -0.15, 0.4);
    let full = |e: &[f64; 6], s: f64| {
        Matrix3::new(
            e[0],
            s * e[3],
            s * e[5],
            s * e[3],
            e[1],
            s * e[4],
            s * e[5],
            s * e[4],
            e[2],
        )
    };
    let voigt = |m: &Matrix3<f64>, s: f64| {
        [
            m[(0, 0)],
            m[(1, 1)],
            m[(2, 2)],
            s * m[(0, 1)],
            s * m[(1, 2)],
            s * m[(0, 2)],
        ]
    };
    let skew = Metric::new(voigt(&(frame.transpose() * frame), 1.0));
    let mut states = [ArmstrongFrederickState::UNUSED; 2];
    for strain in &strains {
        let there = voigt(&(frame.transpose() * full(strain, 0.5) * frame), 2.0);
        let at = [(Metric::CARTESIAN, *strain), (skew, there)];
        let stress = [0, 1].map(|k| {
            let (metric, e) = &at[k];
            let s = law.response(metric, e, &states[k]).unwrap().stress;
            states[k] = law.advance(metric, e, &states[k]).unwrap();
            full(&s, 1.0)
        });
        let turned = frame * stress[1] * frame.transpose();
        assert!(relative(turned.as_slice(), stress[0].as_slice()) < 1e-12);
    }
    assert!((states[0].p / states[1].p - 1.0).abs() < 1e-12);
}

mod elements {
    use super::*;
    use crate::shell::tests::{deformed, mesh, nodes};
    use crate::shell::{Formulation, H8Block, H8System, Law, Q18Block, ShellError};
    use covact_geometry::Vec3;

    const KINDS: [Formulation; 3] = [
        Formulation::Layered,
        Formulation::Displacement,
        Formulation::MeanDilatation,
    ];

    fn cyclic() -> Law {
        Law::ArmstrongFrederick(ArmstrongFrederick {
            lambda: 577.0,
            mu: 385.0,
            hardening: Hardening::Voce {
                initial: 20.0,
                rise: 30.0,
                rate: 15.0,
            },
            modulus: 800.0,
            recovery: 25.0,
        })
    }

    /// Enhanced strains such that nothing acts on them.
    fn relax(block: &H8Block, u: &[Vec3; 8], state: &mut [f64], out: &mut H8System) {
        for _ in 0..20 {
            block.evaluate(0, u, state, out).unwrap();
            let alpha = state[..block.alpha_len()].to_vec();
            block.update_alpha(state, &[Vec3::zeros(); 8], 1.0, &alpha);
        }
        block.evaluate(0, u, state, out).unwrap();
    }

    /// Condensed tangents against differences of the forces of relaxed elements, which have flowed one way and flow another; forces
    /// without a tangent repeat them.
    #[test]
    fn element_tangents_are_the_derivatives_of_their_forces() {
        for formulation in KINDS {
            let block = H8Block::new(&mesh(&nodes()), formulation, cyclic()).unwrap();
            let mut out = H8System::default();
            let mut state = vec![0.0; block.state_len()];
            let first = deformed(0.1);
            relax(&block, &first, &mut state, &mut out);
            block.remember(0, &first, &mut state).unwrap();
            let mut u = deformed(-0.04);
            u[3] += Vec3::new(0.05, -0.02, 0.01);
            relax(&block, &u, &mut state, &mut out);
            let start = state.clone();
            let forces = |u: &[Vec3; 8]| {
                let (mut state, mut out) = (start.clone(), H8System::default());
                relax(&block, u, &mut state, &mut out);
                out.f
            };
            let step = 1e-5;
            let mut exact = vec![];
            for column in 0..24 {
                let at = |way: f64| {
                    let mut u = u;
                    u[column / 3][column % 3] += way * step;
                    forces(&u)
                };
                let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(at);
                for r in 0..24 {
                    exact.push((8.0 * (a[r] - b[r]) - c[r] + d[r]) / (12.0 * step));
                }
            }
            let error = relative(&out.k, &exact);
            let k = DMatrix::from_column_slice(24, 24, &out.k);
            let uneven = (&k - k.transpose()).amax() / k.amax();
            println!("{formulation:?}: {error:e}, uneven {uneven:e}");
            assert!(error < 1e-8, "{formulation:?} {error:e}");
            assert!(uneven > 1e-5, "{formulation:?} {uneven:e}");
            let mut f = [0.0; 24];
            let energy = block.residual(0, &u, &state, &mut f).unwrap();
            assert!(relative(&f, &out.f) < 1e-12);
            assert!((energy / out.energy - 1.0).abs() < 1e-12);
            // Rigid motions do no work, whichever side they are on.
            let shift = DVector::from_fn(24, |r, _| f64::from(u8::from(r % 3 == 1)));
            assert!((&k * &shift).amax() < 1e-10 * k.amax());
            assert!((k.transpose() * shift).amax() < 1e-10 * k.amax());
        }
    }

    /// At displacements that are not relaxed, forces without a tangent and the change of the enhanced strains follow the linear system
    /// to second order.
    #[test]
    fn forces_and_enhanced_strains_follow_the_linear_system() {
        let block = H8Block::new(&mesh(&nodes()), Formulation::Layered, cyclic()).unwrap();
        let mut out = H8System::default();
        let mut state = vec![0.0; block.state_len()];
        let first = deformed(0.1);
        relax(&block, &first, &mut state, &mut out);
        block.remember(0, &first, &mut state).unwrap();
        let u = deformed(-0.04);
        relax(&block, &u, &mut state, &mut out);
        let mut errors = vec![];
        for size in [1e-3, 5e-4] {
            let du = deformed(size);
            let mut next = state.clone();
            block.update_alpha(&mut next, &du, 1.0, &state);
            assert_ne!(next[..8], state[..8]);
            let moved = std::array::from_fn(|a| u[a] + du[a]);
            let mut f = [0.0; 24];
            block.residual(0, &moved, &next, &mut f).unwrap();
            let linear: Vec<f64> = (0..24)
                .map(|r| {
                    let more = (0..24).map(|c| out.k[24 * c + r] * du[c / 3][c % 3]);
                    out.f[r] + more.sum::<f64>()
                })
                .collect();
            errors.push(relative(&f, &linear));
        }
        println!("{errors:?}");
        assert!(errors[1] > 0.0 && errors[0] / errors[1] > 3.5, "{errors:?}");
    }

    /// Elements whose tangents are made of one half refuse the law.
    #[test]
    fn symmetric_elements_refuse_the_law() {
        for formulation in [Formulation::Eas7, Formulation::Eas3, Formulation::Eas0] {
            let found = H8Block::new(&mesh(&nodes()), formulation, cyclic());
            assert!(
                matches!(found, Err(ShellError::Unsymmetric)),
                "{formulation:?}"
            );
        }
        let mut q18 = mesh(&nodes());
        q18.kind = crate::mesh::ElementKind::Q18;
        let found = Q18Block::new(&q18, cyclic());
        assert!(matches!(found, Err(ShellError::Unsymmetric)));
    }
}
