//! Stresses and tangents of material laws.
use super::*;

/// Errors of the derivatives at a strain, at the beginning and after a step that is accepted at `before`.
pub(super) fn check_law<L: MaterialLaw>(
    law: &L,
    metric: &Metric,
    strain: &[f64; 6],
    before: &[f64; 6],
) -> (f64, f64) {
    let later = law.advance(metric, before, &L::State::UNUSED).unwrap();
    let first = check_step(law, metric, strain, &L::State::UNUSED);
    let second = check_step(law, metric, strain, &later);
    (first.0.max(second.0), first.1.max(second.1))
}

pub(super) fn check_step<L: MaterialLaw>(
    law: &L,
    metric: &Metric,
    strain: &[f64; 6],
    old: &L::State,
) -> (f64, f64) {
    let response = law.response(metric, strain, old).unwrap();
    let (mut stress, mut tangent) = ([0.0; 6], [[0.0; 6]; 6]);
    for v in 0..6 {
        let mut e = strain.map(Dual64::from);
        e[v] = e[v].derivative();
        stress[v] = law.energy(metric, &e, old).unwrap().eps;
        let (energy, s) = law.stress(metric, &e, old).unwrap();
        assert!((energy.re - response.energy).abs() <= 1e-14 * response.energy.abs());
        tangent[v] = s.map(|s| s.eps);
    }
    (
        relative(&response.stress, &stress),
        relative(response.tangent.as_flattened(), tangent.as_flattened()),
    )
}

#[test]
pub(super) fn energy_gives_stress_gives_tangent() {
    let skew = Metric::new([1.3, 0.8, 0.05, 0.2, -0.03, 0.04]);
    let strains = [
        [0.1, -0.15, 0.2, 0.12, -0.1, 0.08],
        [0.02, 0.3, -0.01, -0.05, 0.02, 0.01],
    ];
    for law in laws() {
        for metric in [Metric::CARTESIAN, skew] {
            for strain in &strains {
                let errors = with_law!(&law, law => check_law(law, &metric, strain, &BEFORE));
                println!("{law:?}: {errors:?}");
                assert!(errors.0 < 1e-12 && errors.1 < 1e-12, "{law:?} {errors:?}");
            }
        }
    }
}

/// Neo-Hooke in uniaxial stretch along x without lateral strain: S_xx = mu (1 - 1/s^2) + lambda ln s / s^2.
#[test]
pub(super) fn neo_hooke_keeps_its_digits_at_small_strain() {
    let Law::NeoHooke(law) = laws()[1] else {
        unreachable!()
    };
    for strain in [1e-12, 1e-3, 0.5] {
        let mut e = [0.0; 6];
        e[0] = strain;
        let s2: f64 = 1.0 + 2.0 * strain;
        // mu (1 - 1/s^2) = mu 2 e / s^2.
        let exact = (law.mu * 2.0 * strain + law.lambda * 0.5 * (2.0 * strain).ln_1p()) / s2;
        let found = law.response(&Metric::CARTESIAN, &e, &()).unwrap().stress[0];
        assert!(
            (found / exact - 1.0).abs() < 1e-14,
            "{strain}: {found} {exact}"
        );
    }
}
