//! Metal plasticity after von Mises with isotropic hardening, in logarithmic strains.
//!
//! The logarithmic strain is the sum of an elastic and a plastic one, `H = He + Ep`; the conjugate stress
//! `T = lambda tr(He) 1 + 2 mu He` flows along its deviator, `dEp = dp N` with `N = 3/2 s / q`, where its equivalent
//! stress `q` would pass the yield stress. Over a step the flow is backward Euler's, which at constant old state makes
//! the stress the gradient of `W = lambda/2 tr(He)^2 + mu He:He + int sigma_y dp`; this sum of stored energy and plastic
//! work is what the law gives as its energy. Along loading without turning axes it is exact; in simple shear the stress
//! is 0.25 % too low at gamma = 0.5 and 2.6 % at gamma = 1.
//!
//! Source: C. Miehe, N. Apel and M. Lambrecht, *Computer Methods in Applied Mechanics and Engineering* 191 (2002)
//! 5383-5425; return mapping after J. C. Simo and T. J. R. Hughes, *Computational Inelasticity*, 1998, chapter 3.
use super::hardening::Hardening;
use super::logarithm::{Logarithm, sandwich};
use super::tensor::{isotropic, raise};
use super::{AT_YIELD, Collapsed, LawState, MaterialLaw, Metric, Response, YIELDS};
use crate::shell::{Flow, PlasticWork};
use num_dual::DualNum;

/// Elastic constants and hardening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct J2 {
    /// First constant of Lamé (force / length^2).
    pub lambda: f64,
    /// Shear modulus (force / length^2).
    pub mu: f64,
    /// Yield stress over the plastic strain.
    pub hardening: Hardening,
}

/// Plastic strain, stress and plastic work at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct J2State {
    /// Logarithmic plastic strain, contravariant components `Ep^ij`.
    pub strain: [f64; 6],
    /// Equivalent plastic strain.
    pub p: f64,
    /// Stress `T^ij`.
    pub stress: [f64; 6],
    /// Plastic work per undeformed volume.
    pub work: f64,
}

impl LawState for J2State {
    const LEN: usize = 14;
    const UNUSED: J2State = J2State {
        strain: [0.0; 6],
        p: 0.0,
        stress: [0.0; 6],
        work: 0.0,
    };

    #[inline]
    fn read(from: &[f64]) -> J2State {
        let (mut strain, mut stress) = ([0.0; 6], [0.0; 6]);
        strain.copy_from_slice(&from[..6]);
        stress.copy_from_slice(&from[7..13]);
        J2State {
            strain,
            p: from[6],
            stress,
            work: from[13],
        }
    }

    #[inline]
    fn write(&self, to: &mut [f64]) {
        to[..6].copy_from_slice(&self.strain);
        to[6] = self.p;
        to[7..13].copy_from_slice(&self.stress);
        to[13] = self.work;
    }
}

/// The end of a step.
struct Returned<D> {
    energy: D,
    stress: [D; 6],
    /// Flow direction `N^ij`.
    direction: [D; 6],
    /// Equivalent stress that the step would have without flow.
    trial: D,
    /// Equivalent plastic strain of the step.
    flow: D,
}

/// `a_ij b^ij` of contravariant components.
pub(super) fn contract<D: DualNum<f64> + Copy>(metric: &Metric, a: &[D; 6], b: &[D; 6]) -> D {
    let lower = sandwich(&metric.lower.map(D::from), a);
    let normal = lower[0] * b[0] + lower[1] * b[1] + lower[2] * b[2];
    normal + (lower[3] * b[3] + lower[4] * b[4] + lower[5] * b[5]) * 2.0
}

impl J2State {
    /// Deviator of the stress.
    fn deviator(&self, metric: &Metric) -> [f64; 6] {
        let trace = lowered_trace(metric, &self.stress);
        std::array::from_fn(|v| self.stress[v] - trace / 3.0 * metric.upper[v])
    }

    /// Equivalent stress (von Mises).
    fn equivalent(&self, metric: &Metric) -> f64 {
        equivalent(metric, &self.deviator(metric))
    }
}

/// Equivalent (von Mises) of a deviator.
pub(super) fn equivalent(metric: &Metric, s: &[f64; 6]) -> f64 {
    (1.5 * contract(metric, s, s)).sqrt()
}

/// `G_ij a^ij`.
pub(super) fn lowered_trace(metric: &Metric, a: &[f64; 6]) -> f64 {
    let g = &metric.lower;
    g[0] * a[0] + g[1] * a[1] + g[2] * a[2] + 2.0 * (g[3] * a[3] + g[4] * a[4] + g[5] * a[5])
}

impl J2 {
    /// Return mapping from the old state at a logarithmic strain, mixed components.
    fn returned<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        h: &[[D; 3]; 3],
        old: &J2State,
    ) -> Returned<D> {
        // The trace of the plastic strain is zero but for rounding, which must not become pressure.
        let trace = h[0][0] + h[1][1] + h[2][2];
        let mut s = raise(h, &metric.upper.map(D::from));
        for ((s, old), g) in s.iter_mut().zip(old.strain).zip(metric.upper) {
            *s = (*s - old - trace * (g / 3.0)) * (2.0 * self.mu);
        }
        let square = contract(metric, &s, &s) * 1.5;
        let trial = square.sqrt();
        let flow = self.flow(trial, old.p);
        // s / q has no direction at no stress, where nothing flows.
        let flows = flow.re() > 0.0;
        let direction = s.map(|s| if flows { s * 1.5 / trial } else { D::zero() });
        let mut stress = s;
        let bulk = self.lambda + 2.0 / 3.0 * self.mu;
        for ((t, n), g) in stress.iter_mut().zip(direction).zip(metric.upper) {
            *t = *t - n * flow * (2.0 * self.mu) + trace * (bulk * g);
        }
        let kept = trial - flow * (3.0 * self.mu);
        let squared = if flows { kept * kept } else { square };
        let (_, work) = self.hardening.at(flow + old.p);
        let energy = trace * trace * (0.5 * bulk) + squared / (6.0 * self.mu) + work;
        Returned {
            energy,
            stress,
            direction,
            trial,
            flow,
        }
    }

    /// Equivalent plastic strain of a step: the root of `q - 3 mu dp - sigma_y(p + dp)`, which falls, by Newton's method. Where
    /// the yield stress is concave it converges monotonically; where a table is not, the interval of the root is halved
    /// instead of left.
    fn flow<D: DualNum<f64> + Copy>(&self, trial: D, old: f64) -> D {
        let q = trial.re();
        if q <= self.hardening.at(old).0 * (1.0 + AT_YIELD) {
            return D::zero();
        }
        let mut dp = 0.0;
        let (mut low, mut high) = (0.0, q / (3.0 * self.mu));
        for _ in 0..60 {
            let excess = q - 3.0 * self.mu * dp - self.hardening.at(old + dp).0;
            if excess >= 0.0 {
                low = dp;
            } else {
                high = dp;
            }
            let step = excess / (3.0 * self.mu + self.hardening.slope(old + dp));
            if step.abs() <= 1e-15 * dp {
                dp += step;
                break;
            }
            let next = dp + step;
            dp = if (low..=high).contains(&next) {
                next
            } else {
                0.5 * (low + high)
            };
        }
        // A further step with the scalar's own derivatives.
        let root = D::from(dp);
        let stiffness = 3.0 * self.mu + self.hardening.slope(old + dp);
        root + (trial - 3.0 * self.mu * dp - self.hardening.at(old + dp).0) / stiffness
    }
}

impl MaterialLaw for J2 {
    type State = J2State;

    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &J2State,
    ) -> Result<D, Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        Ok(self.returned(metric, &h.mixed, old).energy)
    }

    fn stress<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &J2State,
    ) -> Result<(D, [D; 6]), Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        let end = self.returned(metric, &h.mixed, old);
        Ok((end.energy, h.stress(metric, &end.stress)))
    }

    fn response(
        &self,
        metric: &Metric,
        strain: &[f64; 6],
        old: &J2State,
    ) -> Result<Response, Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        let end = self.returned(metric, &h.mixed, old);
        let mut moduli = isotropic(&metric.upper, self.lambda, self.mu);
        if end.flow > 0.0 {
            let (mu, share) = (self.mu, end.flow / end.trial);
            let lost = 3.0 * mu * share;
            let lambda = self.lambda + 2.0 / 3.0 * mu * lost;
            moduli = isotropic(&metric.upper, lambda, mu * (1.0 - lost));
            let slope = self.hardening.slope(old.p + end.flow);
            let along = 4.0 * mu * mu * (1.0 / (3.0 * mu + slope) - share);
            for (row, a) in moduli.iter_mut().zip(end.direction) {
                for (c, b) in row.iter_mut().zip(end.direction) {
                    *c -= along * a * b;
                }
            }
        }
        Ok(Response {
            energy: end.energy,
            stress: h.stress(metric, &end.stress),
            tangent: h.tangent(metric, &end.stress, &moduli),
        })
    }

    fn advance(
        &self,
        metric: &Metric,
        strain: &[f64; 6],
        old: &J2State,
    ) -> Result<J2State, Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        let end = self.returned(metric, &h.mixed, old);
        let mut new = *old;
        for (e, n) in new.strain.iter_mut().zip(end.direction) {
            *e += end.flow * n;
        }
        new.p += end.flow;
        new.stress = end.stress;
        let mean: [f64; 6] = std::array::from_fn(|v| 0.5 * (old.stress[v] + end.stress[v]));
        new.work += end.flow * contract(metric, &mean, &end.direction);
        Ok(new)
    }

    fn flow(&self, metric: &Metric, old: &J2State, new: &J2State) -> Flow {
        let most = new.p - old.p;
        if most <= 0.0 {
            return Flow::default();
        }
        let (yields, done) = self.hardening.at(old.p);
        let work = self.hardening.at(new.p).1 - done;
        let [q, end] = [old, new].map(|s| s.equivalent(metric));
        // From an elastic state flow starts along the direction it is found to have.
        let lag = if q < YIELDS * yields {
            0.0
        } else {
            let [from, to] = [old, new].map(|s| s.deviator(metric));
            let cosine = 1.5 * contract(metric, &from, &to) / (q * end);
            0.5 * (2.0 - 2.0 * cosine).max(0.0).sqrt() * work
        };
        Flow { most, work, lag }
    }

    fn flow_measures(&self, metric: &Metric, state: &J2State) -> [f64; 2] {
        [
            state.p,
            state.equivalent(metric) / self.hardening.at(state.p).0,
        ]
    }

    fn plastic_work(&self, state: &J2State) -> PlasticWork {
        PlasticWork {
            done: state.work,
            in_energy: self.hardening.at(state.p).1,
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use nalgebra::Matrix3;

    const E: f64 = 200e3;
    const NU: f64 = 0.3;

    fn law(hardening: Hardening) -> J2 {
        J2 {
            lambda: E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)),
            mu: 0.5 * E / (1.0 + NU),
            hardening,
        }
    }

    pub(in super::super) const CASES: [Hardening; 3] = [
        Hardening::Linear {
            initial: 200.0,
            slope: 500.0,
        },
        Hardening::Swift {
            factor: 500.0,
            offset: 0.01,
            exponent: 0.2,
        },
        Hardening::Voce {
            initial: 200.0,
            rise: 150.0,
            rate: 15.0,
        },
    ];

    /// A bar pulled to the logarithmic strain 0.7 and free sideways: with the axial Kirchhoff stress tau, the equivalent
    /// plastic strain is `ln l - tau / E` and tau its yield stress. Plastic flow keeps the volume, and the energy is what
    /// the force has done.
    #[test]
    fn uniaxial_tension() {
        for hardening in CASES {
            let law = law(hardening);
            let (mut old, mut across) = (J2State::UNUSED, 0.0);
            for step in 1..=35 {
                let log = 0.02 * f64::from(step);
                let l2 = (2.0 * log).exp();
                let strain = |across: f64| [0.5 * (l2 - 1.0), across, across, 0.0, 0.0, 0.0];
                let at = |across: f64| {
                    (law.response(&Metric::CARTESIAN, &strain(across), &old)).unwrap()
                };
                // A start that keeps the volume.
                across += 0.5 * ((-log).exp() - (0.02 - log).exp());
                for _ in 0..12 {
                    let r = at(across);
                    across -= r.stress[1] / (r.tangent[1][1] + r.tangent[1][2]);
                }
                let r = at(across);
                let tau = r.stress[0] * l2;
                assert!(r.stress[1].abs() < 1e-9 * tau, "{hardening:?} {log}");
                let p = log - tau / E;
                let tolerance = if log < 0.3 { 1e-11 } else { 2e-8 };
                let (expected, work) = hardening.at(p);
                let off = (tau / expected - 1.0).abs();
                assert!(off < tolerance, "{hardening:?} {log}: {off:e}");
                let energy = 0.5 * tau * tau / E + work;
                assert!((r.energy / energy - 1.0).abs() < tolerance);
                old = (law.advance(&Metric::CARTESIAN, &strain(across), &old)).unwrap();
                assert!((old.p / p - 1.0).abs() < tolerance);
                let trace = old.strain[0] + old.strain[1] + old.strain[2];
                assert!(trace.abs() < 1e-15, "{trace:e}");
            }
        }
    }

    /// Simple shear without hardening and nearly rigid: stress along the change of the logarithmic strain, hence
    /// `tau_12 sqrt(3) / sigma_y = 2/sqrt(4 + g^2) sqrt(1 + 4 asinh^2(g/2) / (4 + g^2))`.
    #[test]
    fn simple_shear_softens_as_the_logarithm_does() {
        let law = law(Hardening::Linear {
            initial: 0.02,
            slope: 0.0,
        });
        let steps = 2000;
        let mut old = J2State::UNUSED;
        let mut compared = 0;
        for step in 1..=steps {
            let g = f64::from(step) / f64::from(steps);
            let e = [0.0, 0.5 * g * g, 0.0, g, 0.0, 0.0];
            let r = law.response(&Metric::CARTESIAN, &e, &old).unwrap();
            old = law.advance(&Metric::CARTESIAN, &e, &old).unwrap();
            if step % 500 == 0 {
                let [a, b, c, d, h, i] = r.stress;
                let s = Matrix3::new(a, d, i, d, b, h, i, h, c);
                let f = Matrix3::new(1.0, g, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
                let tau = (f * s * f.transpose())[(0, 1)] * 3f64.sqrt() / 0.02;
                let square = 4.0 + g * g;
                let a = (0.5 * g).asinh();
                let exact = 2.0 / square.sqrt() * (1.0 + 4.0 * a * a / square).sqrt();
                println!("{g}: {tau} {exact}");
                assert!((tau - exact).abs() < 2e-4, "{g}: {tau} {exact}");
                compared += 1;
            }
        }
        assert_eq!(compared, 4);
    }

    /// A strain that is taken back far enough to flow the other way, and one that is not: nothing flows before the stress
    /// has changed by twice the yield stress.
    #[test]
    fn unloading_is_elastic() {
        let law = law(CASES[0]);
        let sheared = |g: f64| [0.0, 0.0, 0.0, g, 0.0, 0.0];
        let advance =
            |g: f64, old: &J2State| (law.advance(&Metric::CARTESIAN, &sheared(g), old)).unwrap();
        let loaded = advance(0.02, &J2State::UNUSED);
        assert!(loaded.p > 5e-3);
        let width = 2.0 * law.hardening.at(loaded.p).0 / 3f64.sqrt() / law.mu;
        // The stress is kept for the work of the next step only.
        let unloaded = advance(0.02 - 0.95 * width, &loaded);
        let flowed = |s: &J2State| (s.strain, s.p, s.work);
        assert_eq!(flowed(&unloaded), flowed(&loaded));
        assert_ne!(unloaded.stress, loaded.stress);
        assert!(advance(0.02 - 1.05 * width, &loaded).p > loaded.p);
    }

    /// What a step leaves out where flow turns in it: nothing along one direction and from an elastic state, half of the chord of
    /// the turn times the work else.
    #[test]
    fn flow_that_turns_lags() {
        let law = law(CASES[0]);
        let advance = |strain: [f64; 6], old: &J2State| {
            let new = law.advance(&Metric::CARTESIAN, &strain, old).unwrap();
            (new, MaterialLaw::flow(&law, &Metric::CARTESIAN, old, &new))
        };
        let (first, flow) = advance([0.0, 0.0, 0.0, 0.02, 0.0, 0.0], &J2State::UNUSED);
        assert!(flow.work > 1.0 && flow.lag == 0.0, "{flow:?}");
        // The axes of large shears turn a little, and so does flow.
        let (_, on) = advance([0.0, 0.0, 0.0, 0.03, 0.0, 0.0], &first);
        assert!(on.work > 0.5 && on.lag < 0.01 * on.work, "{on:?}");
        let (_, across) = advance([0.0, 0.0, 0.0, 0.02, 0.2, 0.0], &first);
        let right = 0.5 * 2f64.sqrt() * across.work;
        assert!((across.lag / right - 1.0).abs() < 0.05, "{across:?}");
        let (_, back) = advance([0.0, 0.0, 0.0, -0.02, 0.0, 0.0], &first);
        assert!(
            back.work > 1.0 && (back.lag / back.work - 1.0).abs() < 1e-3,
            "{back:?}"
        );
    }
}
