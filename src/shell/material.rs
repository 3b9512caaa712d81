//! Isotropic hyperelastic laws between Green-Lagrange strain and second Piola-Kirchhoff stress.
//!
//! A law is evaluated in any frame: strain in covariant components `E_ij` (Voigt order 11, 22, 33, 12, 23, 13, shears
//! `2 E_ij`), stress in contravariant components `S^ij`, and the metric of the undeformed frame ties them together. In
//! Cartesian axes ([`Metric::CARTESIAN`]) these are the usual components.
//!
//! Source of the formulas: J. Bonet and R. D. Wood, *Nonlinear Continuum Mechanics for Finite Element Analysis*, 2008,
//! chapter 6, here in convected components.
use super::error::ShellError;
use crate::scene::{Elastic, Material};
use num_dual::DualNum;

/// Metric of the undeformed frame: covariant `G_ij` and contravariant `G^ij`, in Voigt order without factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metric {
    pub lower: [f64; 6],
    pub upper: [f64; 6],
}

impl Metric {
    /// Cartesian axes.
    pub const CARTESIAN: Metric = Metric {
        lower: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
        upper: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
    };

    /// From the covariant metric; it must be positive definite.
    pub fn new(lower: [f64; 6]) -> Metric {
        let (upper, _) = inverse(&lower);
        Metric { lower, upper }
    }
}

/// The strain is one that no deformation has: C = G + 2E is not positive definite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collapsed {
    /// det C / det G.
    pub ratio: f64,
}

/// Energy density, stress and tangent at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Energy per undeformed volume.
    pub energy: f64,
    /// `S^ij` (force per undeformed area).
    pub stress: [f64; 6],
    /// `dS^ij / dE_kl` against Voigt strains; symmetric.
    pub tangent: [[f64; 6]; 6],
}

/// A hyperelastic law. Energy and stress are generic over the scalar, so that dual numbers can check derivatives.
pub trait MaterialLaw: Copy + Send + Sync {
    /// Energy per undeformed volume.
    ///
    /// # Errors
    /// [`Collapsed`] where C is not positive definite.
    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
    ) -> Result<D, Collapsed>;

    /// Energy density and stress.
    ///
    /// # Errors
    /// [`Collapsed`] where C is not positive definite.
    fn stress<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
    ) -> Result<(D, [D; 6]), Collapsed>;

    /// Energy density, stress and tangent.
    ///
    /// # Errors
    /// [`Collapsed`] where C is not positive definite.
    fn response(&self, metric: &Metric, strain: &[f64; 6]) -> Result<Response, Collapsed>;
}

/// `W = lambda/2 tr(E)^2 + mu E:E`: linear between E and S. For large rotations and small strains; in strong
/// compression it softens, which is not physical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StVenantKirchhoff {
    pub lambda: f64,
    pub mu: f64,
}

/// `W = mu/2 (tr C - 3) - mu ln J + lambda/2 ln^2 J`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeoHooke {
    pub lambda: f64,
    pub mu: f64,
}

/// A law chosen at run time; elements branch on it once and run monomorphised loops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    StVenantKirchhoff(StVenantKirchhoff),
    NeoHooke(NeoHooke),
}

impl Law {
    /// From the scene's constants.
    ///
    /// # Errors
    /// [`ShellError::Material`] unless E > 0 and -1 < nu < 0.5.
    pub fn new(material: &Material) -> Result<Law, ShellError> {
        Ok(match material {
            Material::StVenantKirchhoff(elastic) => {
                let (lambda, mu) = lame(elastic)?;
                Law::StVenantKirchhoff(StVenantKirchhoff { lambda, mu })
            }
            Material::NeoHooke(elastic) => {
                let (lambda, mu) = lame(elastic)?;
                Law::NeoHooke(NeoHooke { lambda, mu })
            }
        })
    }

    /// Poisson's ratio of the linearised law.
    pub fn nu(&self) -> f64 {
        let (lambda, mu) = self.lame();
        0.5 * lambda / (lambda + mu)
    }

    /// Young's modulus of the linearised law.
    pub fn young(&self) -> f64 {
        let (lambda, mu) = self.lame();
        mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu)
    }

    fn lame(&self) -> (f64, f64) {
        match self {
            Law::StVenantKirchhoff(law) => (law.lambda, law.mu),
            Law::NeoHooke(law) => (law.lambda, law.mu),
        }
    }
}

/// Lamé's constants.
fn lame(elastic: &Elastic) -> Result<(f64, f64), ShellError> {
    let Elastic { e, nu } = *elastic;
    if !(e > 0.0 && e.is_finite()) {
        return Err(ShellError::Material {
            name: "E",
            value: e,
            range: "positive",
        });
    }
    if !(nu > -1.0 && nu < 0.5) {
        return Err(ShellError::Material {
            name: "nu",
            value: nu,
            range: "between -1 and 0.5",
        });
    }
    Ok((
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        0.5 * e / (1.0 + nu),
    ))
}

/// Adjugate of a symmetric 3 x 3 matrix over its determinant, and the determinant.
pub(super) fn inverse<D: DualNum<f64> + Copy>(m: &[D; 6]) -> ([D; 6], D) {
    let [m11, m22, m33, m12, m23, m13] = *m;
    let c11 = m22 * m33 - m23 * m23;
    let c12 = m13 * m23 - m12 * m33;
    let c13 = m12 * m23 - m13 * m22;
    let det = m11 * c11 + m12 * c12 + m13 * c13;
    let f = det.recip();
    let upper = [
        c11 * f,
        (m11 * m33 - m13 * m13) * f,
        (m11 * m22 - m12 * m12) * f,
        c12 * f,
        (m12 * m13 - m11 * m23) * f,
        c13 * f,
    ];
    (upper, det)
}

/// Mixed components `G^ik E_kj` of the strain, row i, column j.
#[inline(always)]
fn mixed<D: DualNum<f64> + Copy>(metric: &Metric, e: &[D; 6]) -> [[D; 3]; 3] {
    let [a, b, c, d, f, g] = metric.upper;
    let (e12, e23, e13) = (e[3] * 0.5, e[4] * 0.5, e[5] * 0.5);
    let columns = [[e[0], e12, e13], [e12, e[1], e23], [e13, e23, e[2]]];
    let row = |x: f64, y: f64, z: f64| columns.map(|v| v[0] * x + v[1] * y + v[2] * z);
    [row(a, d, g), row(d, b, f), row(g, f, c)]
}

/// Trace, second invariant and determinant of the mixed strain.
#[inline(always)]
fn invariants<D: DualNum<f64> + Copy>(m: &[[D; 3]; 3]) -> (D, D, D) {
    let minor = |i: usize, j: usize| m[i][i] * m[j][j] - m[i][j] * m[j][i];
    let second = minor(0, 1) + minor(1, 2) + minor(0, 2);
    let third = m[0][0] * minor(1, 2) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    (m[0][0] + m[1][1] + m[2][2], second, third)
}

/// `C = G + 2E`, checked to be positive definite, with `det C / det G - 1` from the invariants of E (no cancellation
/// at small strain).
#[inline(always)]
fn cauchy_green<D: DualNum<f64> + Copy>(
    metric: &Metric,
    e: &[D; 6],
    (i1, i2, i3): (D, D, D),
) -> Result<([D; 6], D), Collapsed> {
    let g = &metric.lower;
    let c = [
        e[0] * 2.0 + g[0],
        e[1] * 2.0 + g[1],
        e[2] * 2.0 + g[2],
        e[3] + g[3],
        e[4] + g[4],
        e[5] + g[5],
    ];
    let change = i1 * 2.0 + i2 * 4.0 + i3 * 8.0;
    let ratio = 1.0 + change.re();
    let (c11, c22, c12) = (c[0].re(), c[1].re(), c[3].re());
    if ratio > 0.0 && c11 > 0.0 && c11 * c22 - c12 * c12 > 0.0 && ratio.is_finite() {
        Ok((c, change))
    } else {
        Err(Collapsed { ratio })
    }
}

/// Product of mixed and contravariant components, known to be symmetric.
#[inline(always)]
fn raise<D: DualNum<f64> + Copy>(m: &[[D; 3]; 3], upper: &[D; 6]) -> [D; 6] {
    let [a, b, c, d, f, g] = *upper;
    [
        m[0][0] * a + m[0][1] * d + m[0][2] * g,
        m[1][0] * d + m[1][1] * b + m[1][2] * f,
        m[2][0] * g + m[2][1] * f + m[2][2] * c,
        m[0][0] * d + m[0][1] * b + m[0][2] * f,
        m[1][0] * g + m[1][1] * f + m[1][2] * c,
        m[0][0] * g + m[0][1] * f + m[0][2] * c,
    ]
}

/// `lambda A^ij A^kl + kappa (A^ik A^jl + A^il A^jk)`.
#[inline(always)]
fn isotropic(a: &[f64; 6], lambda: f64, kappa: f64) -> [[f64; 6]; 6] {
    let [a11, a22, a33, a12, a23, a13] = *a;
    let full = [[a11, a12, a13], [a12, a22, a23], [a13, a23, a33]];
    let entry = |v: usize, w: usize| {
        let ((i, j), (k, l)) = (super::VOIGT[v], super::VOIGT[w]);
        lambda * a[v] * a[w] + kappa * (full[i][k] * full[j][l] + full[i][l] * full[j][k])
    };
    // Unrolled, so that every index above is a constant; the lower triangle is the upper one.
    let mut c = [[0.0; 6]; 6];
    macro_rules! fill {
        ($($v:literal $w:literal,)*) => { $( c[$v][$w] = entry($v, $w); )* };
    }
    fill! {
        0 0, 0 1, 0 2, 0 3, 0 4, 0 5, 1 1, 1 2, 1 3, 1 4, 1 5,
        2 2, 2 3, 2 4, 2 5, 3 3, 3 4, 3 5, 4 4, 4 5, 5 5,
    }
    for v in 1..6 {
        for w in 0..v {
            c[v][w] = c[w][v];
        }
    }
    c
}

impl MaterialLaw for StVenantKirchhoff {
    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
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
    fn response(&self, metric: &Metric, strain: &[f64; 6]) -> Result<Response, Collapsed> {
        let (energy, stress) = self.stress(metric, strain)?;
        let tangent = isotropic(&metric.upper, self.lambda, self.mu);
        Ok(Response {
            energy,
            stress,
            tangent,
        })
    }
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
    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
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
    ) -> Result<(D, [D; 6]), Collapsed> {
        let (energy, s, _, _) = self.all(metric, strain)?;
        Ok((energy, s))
    }

    #[inline]
    fn response(&self, metric: &Metric, strain: &[f64; 6]) -> Result<Response, Collapsed> {
        let (energy, stress, ci, ln_j) = self.all(metric, strain)?;
        let tangent = isotropic(&ci, self.lambda, self.mu - self.lambda * ln_j);
        Ok(Response {
            energy,
            stress,
            tangent,
        })
    }
}
