//! Dashpots beside an elastic material: the stress of a step is that of the moduli for the change of strain since its start.
//!
//! Times viscosity over step it is the stress of a Kelvin-Voigt material at the middle of the step, `eta D : (E_1 - E_0) / dt`. Green-
//! Lagrange strains do not change in rigid motions, so that these are not resisted; the stress is the gradient of an energy, half of
//! what the dashpots take.
use super::tensor::{invariants, isotropic, mixed, raise};
use super::{Collapsed, LawState, MaterialLaw, Metric, Response};
use num_dual::DualNum;

/// Moduli of an elastic material at small strain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dashpot {
    /// First constant of Lamé (force / length^2).
    pub lambda: f64,
    /// Shear modulus (force / length^2).
    pub mu: f64,
}

/// Strain at the start of the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DashpotState(pub [f64; 6]);

impl LawState for DashpotState {
    const LEN: usize = 6;
    const UNUSED: DashpotState = DashpotState([0.0; 6]);

    #[inline(always)]
    fn read(from: &[f64]) -> DashpotState {
        let mut strain = [0.0; 6];
        strain.copy_from_slice(&from[..6]);
        DashpotState(strain)
    }

    #[inline(always)]
    fn write(&self, to: &mut [f64]) {
        to[..6].copy_from_slice(&self.0);
    }
}

impl Dashpot {
    /// Energy and stress of a change of strain, of any size: it need not be a strain that a deformation has.
    #[inline(always)]
    fn answer<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &DashpotState,
    ) -> (D, [D; 6]) {
        let change: [D; 6] = std::array::from_fn(|v| strain[v] - old.0[v]);
        let m = mixed(metric, &change);
        let (i1, i2, _) = invariants(&m);
        // tr(E^2) = I1^2 - 2 I2.
        let energy = i1 * i1 * (0.5 * self.lambda + self.mu) - i2 * (2.0 * self.mu);
        let mut s = raise(&m, &metric.upper.map(D::from));
        for (s, g) in s.iter_mut().zip(metric.upper) {
            *s = *s * (2.0 * self.mu) + i1 * (self.lambda * g);
        }
        (energy, s)
    }
}

impl MaterialLaw for Dashpot {
    type State = DashpotState;

    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &DashpotState,
    ) -> Result<D, Collapsed> {
        Ok(self.answer(metric, strain, old).0)
    }

    fn stress<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &DashpotState,
    ) -> Result<(D, [D; 6]), Collapsed> {
        Ok(self.answer(metric, strain, old))
    }

    #[inline]
    fn response(
        &self,
        metric: &Metric,
        strain: &[f64; 6],
        old: &DashpotState,
    ) -> Result<Response, Collapsed> {
        let (energy, stress) = self.answer(metric, strain, old);
        Ok(Response {
            energy,
            stress,
            tangent: isotropic(&metric.upper, self.lambda, self.mu),
        })
    }

    fn advance(
        &self,
        _: &Metric,
        strain: &[f64; 6],
        _: &DashpotState,
    ) -> Result<DashpotState, Collapsed> {
        Ok(DashpotState(*strain))
    }
}
