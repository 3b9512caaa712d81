//! Coulomb friction up to a traction that the softer surface bears.
use super::law::{Coulomb, FrictionLaw, Slip, diagonal};
use nalgebra::{Matrix3, Vector3};
use num_dual::DualNum;

/// Coulomb's law as long as it asks for no more than a limit: `|T| <= min(mu p, limit)`. Under high pressure the asperities of
/// two surfaces are flat against each other, and what slides is the softer material in shear, whose strength does not depend on
/// the pressure (E. Orowan, Proceedings of the Institution of Mechanical Engineers 150 (1943); in metal forming the limit is a
/// part of `sigma_y / sqrt 3`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShearLimited {
    /// Coefficient of friction below the limit.
    pub mu: f64,
    /// Largest traction (force / length^2).
    pub limit: f64,
}

impl FrictionLaw for ShearLimited {
    #[inline]
    fn slip<D: DualNum<f64> + Copy>(
        &self,
        trial: &Vector3<D>,
        normal: &Vector3<D>,
        pressure: D,
    ) -> Slip<D> {
        if self.mu * pressure.re() <= self.limit {
            return Coulomb { mu: self.mu }.slip(trial, normal, pressure);
        }
        let square = trial.dot(trial);
        if square.re() <= self.limit * self.limit {
            return Slip::stick(trial);
        }
        let norm = square.sqrt();
        let direction = trial * norm.recip();
        let scale = norm.recip() * self.limit;
        let zero = D::zero();
        Slip {
            t: direction * D::from(self.limit),
            d_trial: diagonal(scale) - direction * direction.transpose() * scale,
            d_pressure: Vector3::from_element(zero),
            d_normal: Matrix3::from_element(zero),
            slides: true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::Dual64;

    const LAW: ShearLimited = ShearLimited {
        mu: 0.25,
        limit: 2.0,
    };

    /// Below the limit the law is Coulomb's; above it the traction is the limit, as the trial traction directs.
    #[test]
    fn the_traction_is_the_smaller_of_both() {
        let (n, trial) = (Vector3::z(), Vector3::new(3.0, 4.0, 0.0));
        let coulomb = Coulomb { mu: 0.25 };
        for p in [1.0, 7.9] {
            assert_eq!(LAW.slip(&trial, &n, p), coulomb.slip(&trial, &n, p));
        }
        let slip = LAW.slip(&trial, &n, 80.0);
        assert!(slip.slides && (slip.t - Vector3::new(1.2, 1.6, 0.0)).norm() < 1e-15);
        assert_eq!(slip.d_pressure, Vector3::zeros());
        assert!(!LAW.slip(&(trial * 0.39), &n, 80.0).slides);
        assert!(coulomb.slip(&trial, &n, 80.0).t.norm() > 4.9);
    }

    /// Derivatives by dual numbers on both sides of the limit.
    #[test]
    fn derivatives_are_exact() {
        let n = Vector3::z();
        let trial = Vector3::new(3.0, 4.0, 0.0);
        for p in [6.0, 80.0] {
            let exact = LAW.slip(&trial, &n, p);
            assert!(exact.slides && exact.d_trial.norm() > 0.1);
            for k in 0..2 {
                let mut x = trial.map(Dual64::from_re);
                x[k].eps = 1.0;
                let t = LAW.slip(&x, &n.map(Dual64::from_re), Dual64::from_re(p)).t;
                let column = t.map(|t| t.eps);
                assert!((column - exact.d_trial.column(k)).norm() < 1e-14, "{p} {k}");
            }
            let t = LAW
                .slip(
                    &trial.map(Dual64::from_re),
                    &n.map(Dual64::from_re),
                    Dual64::new(p, 1.0),
                )
                .t;
            assert!((t.map(|t| t.eps) - exact.d_pressure).norm() < 1e-14, "{p}");
        }
        assert!((LAW.slip(&trial, &n, 6.0).d_pressure.norm() - 0.25).abs() < 1e-15);
    }
}
