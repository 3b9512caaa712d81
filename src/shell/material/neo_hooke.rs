//! Compressible neo-Hooke.
use super::tensor::{cauchy_green, invariants, inverse, isotropic, mixed, raise};
use super::{Collapsed, MaterialLaw, Metric, Response};
use num_dual::DualNum;

/// `W = mu/2 (tr C - 3) - mu ln J + lambda/2 ln^2 J`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeoHooke {
    /// First constant of Lamé (force / length^2).
    pub lambda: f64,
    /// Shear modulus (force / length^2).
    pub mu: f64,
}

impl NeoHooke {
    /// Energy, stress, inverse of C and ln J.
    #[inline(always)]
    #[allow(clippy::type_complexity)]
    fn all<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
    ) -> Result<(D, [D; 6], [D; 6], D), Collapsed> {
        let m = mixed(metric, strain);
        let (i1, i2, i3) = invariants(&m);
        let (c, change) = cauchy_green(metric, strain, (i1, i2, i3))?;
        let ln_j = change.ln_1p() * 0.5;
        let energy = (i1 - ln_j) * self.mu + ln_j * ln_j * (0.5 * self.lambda);
        let (ci, _) = inverse(&c);
        // mu (G^-1 - C^-1) = 2 mu G^-1 E C^-1, which keeps all digits at small strain.
        let mut s = raise(&m, &ci);
        for (s, ci) in s.iter_mut().zip(ci) {
            *s = *s * (2.0 * self.mu) + ci * ln_j * self.lambda;
        }
        Ok((energy, s, ci, ln_j))
    }
}

impl MaterialLaw for NeoHooke {
    type State = ();

    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        (): &(),
    ) -> Result<D, Collapsed> {
        let (i1, i2, i3) = invariants(&mixed(metric, strain));
        let (_, change) = cauchy_green(metric, strain, (i1, i2, i3))?;
        let ln_j = change.ln_1p() * 0.5;
        Ok((i1 - ln_j) * self.mu + ln_j * ln_j * (0.5 * self.lambda))
    }

    fn stress<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        (): &(),
    ) -> Result<(D, [D; 6]), Collapsed> {
        let (energy, s, _, _) = self.all(metric, strain)?;
        Ok((energy, s))
    }

    #[inline]
    fn response(&self, metric: &Metric, strain: &[f64; 6], (): &()) -> Result<Response, Collapsed> {
        let (energy, stress, ci, ln_j) = self.all(metric, strain)?;
        let tangent = isotropic(&ci, self.lambda, self.mu - self.lambda * ln_j);
        Ok(Response {
            energy,
            stress,
            tangent,
        })
    }
}
