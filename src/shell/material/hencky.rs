//! Hencky's law: linear between logarithmic strain and its conjugate stress.
use super::logarithm::Logarithm;
use super::tensor::{invariants, isotropic, raise};
use super::{Collapsed, MaterialLaw, Metric, Response};
use num_dual::DualNum;

/// `W = lambda/2 tr(H)^2 + mu H:H` with the logarithmic strain `H = ln(C)/2`. In tension and compression alike up to
/// moderate strains; beyond a stretch of e = 2.72 the force of a bar falls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hencky {
    /// First constant of Lamé (force / length^2).
    pub lambda: f64,
    /// Shear modulus (force / length^2).
    pub mu: f64,
}

impl Hencky {
    /// Energy and conjugate stress `T^ij` at a logarithmic strain.
    #[inline(always)]
    fn conjugate<D: DualNum<f64> + Copy>(&self, metric: &Metric, h: &[[D; 3]; 3]) -> (D, [D; 6]) {
        let (i1, i2, _) = invariants(h);
        // tr(H^2) = I1^2 - 2 I2.
        let energy = i1 * i1 * (0.5 * self.lambda + self.mu) - i2 * (2.0 * self.mu);
        let mut t = raise(h, &metric.upper.map(D::from));
        for (t, g) in t.iter_mut().zip(metric.upper) {
            *t = *t * (2.0 * self.mu) + i1 * (self.lambda * g);
        }
        (energy, t)
    }
}

impl MaterialLaw for Hencky {
    type State = ();

    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        (): &(),
    ) -> Result<D, Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        Ok(self.conjugate(metric, &h.mixed).0)
    }

    fn stress<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        (): &(),
    ) -> Result<(D, [D; 6]), Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        let (energy, t) = self.conjugate(metric, &h.mixed);
        Ok((energy, h.stress(metric, &t)))
    }

    #[inline]
    fn response(&self, metric: &Metric, strain: &[f64; 6], (): &()) -> Result<Response, Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        let (energy, t) = self.conjugate(metric, &h.mixed);
        let moduli = isotropic(&metric.upper, self.lambda, self.mu);
        Ok(Response {
            energy,
            stress: h.stress(metric, &t),
            tangent: h.tangent(metric, &t, &moduli),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    const LAW: Hencky = Hencky {
        lambda: 500.0,
        mu: 400.0,
    };

    fn voigt(m: &Matrix3<f64>, shear: f64) -> [f64; 6] {
        [
            m[(0, 0)],
            m[(1, 1)],
            m[(2, 2)],
            shear * m[(0, 1)],
            shear * m[(1, 2)],
            shear * m[(0, 2)],
        ]
    }

    /// Kirchhoff stress `F S F^T` of a deformation, with strain and stress in the convected frame of `frame`.
    fn kirchhoff(f: &Matrix3<f64>, frame: &Matrix3<f64>) -> (f64, Matrix3<f64>) {
        let e = frame.transpose() * (f.transpose() * f - Matrix3::identity()) * frame * 0.5;
        let metric = Metric::new(voigt(&(frame.transpose() * frame), 1.0));
        let response = LAW.response(&metric, &voigt(&e, 2.0), &()).unwrap();
        let [a, b, c, d, g, h] = response.stress;
        let s = Matrix3::new(a, d, h, d, b, g, h, g, c);
        let now = f * frame;
        (response.energy, now * s * now.transpose())
    }

    fn frames() -> [Matrix3<f64>; 2] {
        [
            Matrix3::identity(),
            Matrix3::new(1.1, 0.2, -0.1, 0.3, 0.9, 0.05, 0.1, -0.15, 0.4),
        ]
    }

    fn rotation() -> Matrix3<f64> {
        *nalgebra::Rotation3::from_euler_angles(0.7, -1.2, 2.1).matrix()
    }

    /// `(found - expected)` over the largest expected entry, which must not be zero.
    fn error(found: &Matrix3<f64>, expected: &Matrix3<f64>) -> f64 {
        assert!(expected.amax() > 1.0);
        (found - expected).amax() / expected.amax()
    }

    /// A bar that is free sideways: lateral stretch l^-nu, axial Kirchhoff stress E ln l, energy E ln^2 l / 2; rotated
    /// afterwards, the stress turns with it.
    #[test]
    fn uniaxial_stretch() {
        let nu = 0.5 * LAW.lambda / (LAW.lambda + LAW.mu);
        let e = 2.0 * LAW.mu * (1.0 + nu);
        for l in [0.5f64, 0.8, 1.25, 1.5, 2.0] {
            let tolerance = if (0.7..1.5).contains(&l) { 2e-14 } else { 2e-8 };
            let across = l.powf(-nu);
            let stretch = Matrix3::from_diagonal(&[l, across, across].into());
            let exact = Matrix3::from_diagonal(&[e * l.ln(), 0.0, 0.0].into());
            let q = rotation();
            for frame in frames() {
                let (energy, found) = kirchhoff(&stretch, &frame);
                let off = error(&found, &exact);
                println!("{l}: {off:e}");
                assert!(off < tolerance, "{l}: {off:e}");
                assert!((energy / (0.5 * e * l.ln().powi(2)) - 1.0).abs() < tolerance);
                let (_, turned) = kirchhoff(&(q * stretch), &frame);
                assert!(error(&turned, &(q * found * q.transpose())) < 1e-13);
            }
        }
    }

    /// Simple shear gamma: b = F F^T has the principal stretches exp(+-a), a = asinh(gamma/2), hence
    /// tau = 2 mu a (b - (1 + gamma^2/2) 1) / sinh(2a) in the plane: tau_12 and normal stresses +-.
    #[test]
    fn simple_shear() {
        for gamma in [0.1f64, 0.5, 1.0, 1.5] {
            let f = Matrix3::new(1.0, gamma, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
            let a = (0.5 * gamma).asinh();
            let k = 2.0 * LAW.mu * a / (2.0 * a).sinh();
            let normal = 0.5 * k * gamma * gamma;
            let shear = k * gamma;
            let exact = Matrix3::new(normal, shear, 0.0, shear, -normal, 0.0, 0.0, 0.0, 0.0);
            let tolerance = if gamma < 0.6 { 2e-13 } else { 2e-8 };
            for frame in frames() {
                let (energy, found) = kirchhoff(&f, &frame);
                let off = error(&found, &exact);
                println!("{gamma}: {off:e}");
                assert!(off < tolerance, "{gamma}: {off:e}");
                assert!((energy / (2.0 * LAW.mu * a * a) - 1.0).abs() < tolerance);
            }
        }
    }
}
