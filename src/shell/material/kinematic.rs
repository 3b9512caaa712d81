//! Metal plasticity after von Mises with isotropic and kinematic hardening after Armstrong and Frederick, in logarithmic strains.
//!
//! Flow is governed by the stress relative to a back stress, `q = sqrt(3/2) |dev T - X|`, and the back stress follows the flow and
//! recovers:
//!
//! ```text
//! X = 2/3 C a,   a' = Ep' - gamma a p'
//! ```
//!
//! Over one direction of flow it tends to `C / gamma`; loaded back and forth by equal plastic strains `dp`, the stress settles at the
//! amplitude `sigma_y + C/gamma tanh(gamma dp / 2)`. A step flows along the direction of its end, as backward Euler's does, and its
//! back stress follows that exactly: with `theta = exp(-gamma dp)`, `phi = (1 - theta) / gamma`, `xi = dev T_trial - theta X_n` and
//! `N = 3/2 xi / q` it is one scalar equation for `dp`,
//!
//! ```text
//! q(dp) - 3 mu dp - C phi = sigma_y(p_n + dp),   T = T_trial - 2 mu dp N,   a = theta a_n + phi N
//! ```
//!
//! Backward Euler's `theta = 1 / (1 + gamma dp)`, `phi = theta dp` would be off by `gamma dp / 2` of the back stress in every step;
//! flow along one direction has no error here.
//!
//! With recovery the stress is not the gradient of an energy, and the tangent is not symmetric. The energy that the law gives is the
//! stored one, `C/3 a:a` of the back stress and the integral of the yield stress; without recovery the stress is its gradient.
//!
//! Sources: P. J. Armstrong and C. O. Frederick, CEGB report RD/B/N 731 (1966), reprinted in *Materials at High Temperatures* 24 (2007)
//! 1-26; logarithmic strains as in [`J2`](super::J2).
use super::hardening::Hardening;
use super::j2::{contract, equivalent, lowered_trace};
use super::logarithm::Logarithm;
use super::tensor::{isotropic, raise};
use super::{AT_YIELD, Collapsed, LawState, MaterialLaw, Metric, Response, YIELDS};
use crate::shell::{Flow, PlasticWork};
use num_dual::DualNum;

/// Elastic constants, isotropic and kinematic hardening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmstrongFrederick {
    /// First constant of Lamé (force / length^2).
    pub lambda: f64,
    /// Shear modulus (force / length^2).
    pub mu: f64,
    /// Yield stress over the plastic strain.
    pub hardening: Hardening,
    /// Slope of the back stress over plastic strain where it begins, C (force / length^2).
    pub modulus: f64,
    /// Its recovery, gamma: a back stress of `C / gamma` does not grow.
    pub recovery: f64,
}

/// What a point remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmstrongFrederickState {
    /// Logarithmic plastic strain, contravariant components `Ep^ij`.
    pub strain: [f64; 6],
    /// Equivalent plastic strain.
    pub p: f64,
    /// Stress `T^ij` at the end of the step.
    pub stress: [f64; 6],
    /// Plastic work per undeformed volume.
    pub work: f64,
    /// Strain `a^ij` of the back stress.
    pub back: [f64; 6],
    /// Energy of the back stress per undeformed volume.
    pub held: f64,
}

impl LawState for ArmstrongFrederickState {
    const LEN: usize = 21;
    const UNUSED: ArmstrongFrederickState = ArmstrongFrederickState {
        strain: [0.0; 6],
        p: 0.0,
        stress: [0.0; 6],
        work: 0.0,
        back: [0.0; 6],
        held: 0.0,
    };

    #[inline]
    fn read(from: &[f64]) -> ArmstrongFrederickState {
        let mut state = ArmstrongFrederickState::UNUSED;
        state.strain.copy_from_slice(&from[..6]);
        state.p = from[6];
        state.stress.copy_from_slice(&from[7..13]);
        state.work = from[13];
        state.back.copy_from_slice(&from[14..20]);
        state.held = from[20];
        state
    }

    #[inline]
    fn write(&self, to: &mut [f64]) {
        to[..6].copy_from_slice(&self.strain);
        to[6] = self.p;
        to[7..13].copy_from_slice(&self.stress);
        to[13] = self.work;
        to[14..20].copy_from_slice(&self.back);
        to[20] = self.held;
    }
}

/// The end of a step.
struct Returned<D> {
    energy: D,
    stress: [D; 6],
    /// Flow direction `N^ij`.
    direction: [D; 6],
    /// Equivalent of the trial stress relative to the recovered back stress.
    trial: D,
    /// Equivalent plastic strain of the step.
    flow: D,
    /// Strain of the back stress, and its energy.
    back: [D; 6],
    held: D,
}

/// What the return mapping of a step starts from.
struct Trial<'a, D> {
    metric: &'a Metric,
    /// Deviator of the stress without flow.
    s: [D; 6],
    /// Equivalent plastic strain, and strain of the back stress, at the start.
    p: f64,
    back: &'a [f64; 6],
}

/// The scalar equation of a step at one `dp`.
struct Excess<D> {
    /// Its excess of stress.
    over: D,
    /// Minus its slope.
    slope: f64,
    /// Relative stress `xi` and its equivalent `q`.
    xi: [D; 6],
    q: D,
}

impl ArmstrongFrederick {
    /// `theta` and `phi` of a step.
    fn follows<D: DualNum<f64> + Copy>(&self, dp: D) -> (D, D) {
        if self.recovery == 0.0 {
            return (D::one(), dp);
        }
        let lost = -(dp * (-self.recovery)).exp_m1();
        (-lost + 1.0, lost / self.recovery)
    }

    /// Stress relative to the back stress, at the end of a step, and its equivalent.
    fn relative(&self, metric: &Metric, state: &ArmstrongFrederickState) -> ([f64; 6], f64) {
        let trace = lowered_trace(metric, &state.stress);
        let c = 2.0 / 3.0 * self.modulus;
        let xi = std::array::from_fn(|v| {
            state.stress[v] - trace / 3.0 * metric.upper[v] - c * state.back[v]
        });
        (xi, equivalent(metric, &xi))
    }

    fn excess<D: DualNum<f64> + Copy>(&self, trial: &Trial<D>, dp: D) -> Excess<D> {
        let (theta, phi) = self.follows(dp);
        let back = 2.0 / 3.0 * self.modulus;
        let mut xi = trial.s;
        for (xi, a) in xi.iter_mut().zip(trial.back) {
            *xi -= theta * (back * a);
        }
        let q = (contract(trial.metric, &xi, &xi) * 1.5).sqrt();
        let end = dp + trial.p;
        let over = q - dp * (3.0 * self.mu) - phi * self.modulus - self.hardening.at(end).0;
        // N : X_n, of which the back stress has no more than C / gamma: the equation falls.
        let now = xi.map(|x| x.re());
        let along = 1.5 * back * contract(trial.metric, &now, trial.back) / q.re();
        Excess {
            over,
            slope: 3.0 * self.mu
                + self.hardening.slope(end.re())
                + theta.re() * (self.modulus - self.recovery * along),
            xi,
            q,
        }
    }

    /// Equivalent plastic strain of a step, by Newton's method, which halves the interval of the root instead of leaving it.
    fn flow<D: DualNum<f64> + Copy>(&self, trial: &Trial<D>) -> D {
        let at = Trial {
            metric: trial.metric,
            s: trial.s.map(|s| s.re()),
            p: trial.p,
            back: trial.back,
        };
        let first = self.excess(&at, 0.0);
        let yields = self.hardening.at(trial.p).0;
        if first.q <= yields * (1.0 + AT_YIELD) {
            return D::zero();
        }
        let most = equivalent(trial.metric, &at.s)
            + 2.0 / 3.0 * self.modulus * equivalent(trial.metric, trial.back);
        let (mut dp, mut low, mut high) = (0.0, 0.0, most / (3.0 * self.mu));
        for _ in 0..60 {
            let Excess { over, slope, .. } = self.excess(&at, dp);
            if over >= 0.0 {
                low = dp;
            } else {
                high = dp;
            }
            let step = over / slope;
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
        let Excess { over, slope, .. } = self.excess(trial, D::from(dp));
        D::from(dp) + over / slope
    }

    /// Return mapping from the old state at a logarithmic strain, mixed components.
    fn returned<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        h: &[[D; 3]; 3],
        old: &ArmstrongFrederickState,
    ) -> Returned<D> {
        // The trace of the plastic strain is zero but for rounding, which must not become pressure.
        let trace = h[0][0] + h[1][1] + h[2][2];
        let mut s = raise(h, &metric.upper.map(D::from));
        for ((s, old), g) in s.iter_mut().zip(old.strain).zip(metric.upper) {
            *s = (*s - old - trace * (g / 3.0)) * (2.0 * self.mu);
        }
        let trial = Trial {
            metric,
            s,
            p: old.p,
            back: &old.back,
        };
        let flow = self.flow(&trial);
        let flows = flow.re() > 0.0;
        let mut back = old.back.map(D::from);
        let mut direction = [D::zero(); 6];
        let mut q = D::zero();
        if flows {
            let (theta, phi) = self.follows(flow);
            let end = self.excess(&trial, flow);
            q = end.q;
            direction = end.xi.map(|x| x * 1.5 / q);
            for ((a, n), s) in back.iter_mut().zip(direction).zip(&mut s) {
                *a = *a * theta + n * phi;
                *s -= n * flow * (2.0 * self.mu);
            }
        }
        let bulk = self.lambda + 2.0 / 3.0 * self.mu;
        let mut stress = s;
        for (t, g) in stress.iter_mut().zip(metric.upper) {
            *t += trace * (bulk * g);
        }
        let (_, work) = self.hardening.at(flow + old.p);
        let elastic = trace * trace * (0.5 * bulk) + contract(metric, &s, &s) / (4.0 * self.mu);
        let held = contract(metric, &back, &back) * (self.modulus / 3.0);
        Returned {
            energy: elastic + held + work,
            stress,
            direction,
            trial: q,
            flow,
            back,
            held,
        }
    }

    /// Derivative of the conjugate stress by the logarithmic strain.
    fn moduli(
        &self,
        metric: &Metric,
        end: &Returned<f64>,
        old: &ArmstrongFrederickState,
    ) -> [[f64; 6]; 6] {
        if end.flow <= 0.0 {
            return isotropic(&metric.upper, self.lambda, self.mu);
        }
        let (mu, share, n) = (self.mu, end.flow / end.trial, &end.direction);
        let lost = 3.0 * mu * share;
        let lambda = self.lambda + 2.0 / 3.0 * mu * lost;
        let mut moduli = isotropic(&metric.upper, lambda, mu * (1.0 - lost));
        let x: [f64; 6] = old.back.map(|a| 2.0 / 3.0 * self.modulus * a);
        let nx = contract(metric, n, &x);
        let (theta, _) = self.follows(end.flow);
        let slope = 3.0 * mu
            + self.hardening.slope(old.p + end.flow)
            + theta * (self.modulus - self.recovery * nx);
        let along = 4.0 * mu * mu * (1.0 / slope - share);
        // The direction turns as the back stress recovers: not the transpose of anything.
        let turn = 4.0 * mu * mu * share * self.recovery * theta / slope;
        for (v, row) in moduli.iter_mut().enumerate() {
            let by = along * n[v] + turn * (1.5 * x[v] - nx * n[v]);
            for (c, n) in row.iter_mut().zip(n) {
                *c -= by * n;
            }
        }
        moduli
    }
}

impl MaterialLaw for ArmstrongFrederick {
    type State = ArmstrongFrederickState;

    fn symmetric(&self) -> bool {
        self.recovery == 0.0 || self.modulus == 0.0
    }

    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &ArmstrongFrederickState,
    ) -> Result<D, Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        Ok(self.returned(metric, &h.mixed, old).energy)
    }

    fn stress<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &ArmstrongFrederickState,
    ) -> Result<(D, [D; 6]), Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        let end = self.returned(metric, &h.mixed, old);
        Ok((end.energy, h.stress(metric, &end.stress)))
    }

    fn response(
        &self,
        metric: &Metric,
        strain: &[f64; 6],
        old: &ArmstrongFrederickState,
    ) -> Result<Response, Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        let end = self.returned(metric, &h.mixed, old);
        let moduli = self.moduli(metric, &end, old);
        let tangent = match self.symmetric() || end.flow <= 0.0 {
            true => h.tangent(metric, &end.stress, &moduli),
            false => h.unsymmetric_tangent(metric, &end.stress, &moduli),
        };
        Ok(Response {
            energy: end.energy,
            stress: h.stress(metric, &end.stress),
            tangent,
        })
    }

    fn advance(
        &self,
        metric: &Metric,
        strain: &[f64; 6],
        old: &ArmstrongFrederickState,
    ) -> Result<ArmstrongFrederickState, Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        let end = self.returned(metric, &h.mixed, old);
        let mut new = *old;
        for (e, n) in new.strain.iter_mut().zip(end.direction) {
            *e += end.flow * n;
        }
        new.p += end.flow;
        new.stress = end.stress;
        (new.back, new.held) = (end.back, end.held);
        let mean: [f64; 6] = std::array::from_fn(|v| 0.5 * (old.stress[v] + end.stress[v]));
        new.work += end.flow * contract(metric, &mean, &end.direction);
        Ok(new)
    }

    fn flow(
        &self,
        metric: &Metric,
        old: &ArmstrongFrederickState,
        new: &ArmstrongFrederickState,
    ) -> Flow {
        let most = new.p - old.p;
        if most <= 0.0 {
            return Flow::default();
        }
        let (yields, done) = self.hardening.at(old.p);
        let work = self.hardening.at(new.p).1 - done;
        let [(from, q), (to, end)] = [old, new].map(|s| self.relative(metric, s));
        // From an elastic state flow starts along the direction it is found to have.
        let lag = if q < YIELDS * yields {
            0.0
        } else {
            let cosine = 1.5 * contract(metric, &from, &to) / (q * end);
            0.5 * (2.0 - 2.0 * cosine).max(0.0).sqrt() * work
        };
        Flow { most, work, lag }
    }

    fn flow_measures(&self, metric: &Metric, state: &ArmstrongFrederickState) -> [f64; 2] {
        let (_, q) = self.relative(metric, state);
        [state.p, q / self.hardening.at(state.p).0]
    }

    fn plastic_work(&self, state: &ArmstrongFrederickState) -> PlasticWork {
        PlasticWork {
            done: state.work,
            in_energy: self.hardening.at(state.p).1 + state.held,
        }
    }
}

#[cfg(test)]
mod tests;
