//! St. Venant-Kirchhoff's law.
use super::tensor::{cauchy_green, invariants, isotropic, mixed, raise};
use super::{Collapsed, MaterialLaw, Metric, Response};
use num_dual::DualNum;

/// `W = lambda/2 tr(E)^2 + mu E:E`: linear between E and S. For large rotations and small strains; in strong
/// compression it softens, which is not physical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StVenantKirchhoff {
    /// First constant of Lamé (force / length^2).
    pub lambda: f64,
    /// Shear modulus (force / length^2).
    pub mu: f64,
}

impl MaterialLaw for StVenantKirchhoff {
    type State = ();

    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        (): &(),
    ) -> Result<D, Collapsed> {
        let m = mixed(metric, strain);
        let (i1, i2, i3) = invariants(&m);
        cauchy_green(metric, strain, (i1, i2, i3))?;
        // tr(E^2) = I1^2 - 2 I2.
        Ok(i1 * i1 * (0.5 * self.lambda + self.mu) - i2 * (2.0 * self.mu))
    }

    fn stress<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        (): &(),
    ) -> Result<(D, [D; 6]), Collapsed> {
        let m = mixed(metric, strain);
        let (i1, i2, i3) = invariants(&m);
        cauchy_green(metric, strain, (i1, i2, i3))?;
        let energy = i1 * i1 * (0.5 * self.lambda + self.mu) - i2 * (2.0 * self.mu);
        let upper = metric.upper.map(D::from);
        let mut s = raise(&m, &upper);
        for (s, g) in s.iter_mut().zip(metric.upper) {
            *s = *s * (2.0 * self.mu) + i1 * (self.lambda * g);
        }
        Ok((energy, s))
    }

    #[inline]
    fn response(&self, metric: &Metric, strain: &[f64; 6], (): &()) -> Result<Response, Collapsed> {
        let (energy, stress) = self.stress(metric, strain, &())?;
        let tangent = isotropic(&metric.upper, self.lambda, self.mu);
        Ok(Response {
            energy,
            stress,
            tangent,
        })
    }
}
