//! Material laws in plane stress: energy, resultants and tangent per undeformed area of the mid-surface.
//!
//! Strains vary linearly through the thickness, `E_ij = eps_ij + zeta kap_ij`, in covariant components of the frame
//! `G_ij = A_ij - 2 zeta H_ij` (J. Kiendl, M.-C. Hsu, M. C. H. Wu and A. Reali, CMAME 291 (2015), without the terms in `zeta^2`).
use super::super::error::FaultCause;
use super::super::material::{Law, NeoHooke, StVenantKirchhoff};
use super::frame::Components;
use crate::fem::quadrature::GAUSS_3;
use num_dual::DualNum;

/// The undeformed mid-surface at a point, components 11, 22, 12.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// `A_ij`.
    pub metric: Components<f64>,
    /// `H_ij`.
    pub curvature: Components<f64>,
}

/// Membrane forces `n^ij` and moments `m^ij`, each 11, 22, 12.
pub(super) type Resultants<D> = [D; 6];

/// What a law answers at a point, per undeformed area.
#[derive(Debug, Clone, Copy)]
pub(super) struct Answer {
    pub energy: f64,
    pub resultants: Resultants<f64>,
    /// Derivative of the resultants by (eps, kap), symmetric.
    pub tangent: [[f64; 6]; 6],
}

/// A law in plane stress over a thickness.
pub(super) trait PlaneStress: Copy + Send + Sync {
    /// Energy and resultants; `point` names the place in a fault.
    fn resultants<D: DualNum<f64> + Copy>(
        &self,
        point: usize,
        place: &Place,
        strain: &[D; 6],
    ) -> Result<(D, Resultants<D>), FaultCause>;

    /// Current thickness of the mid-surface over the undeformed one.
    fn thinning(&self, place: &Place, strain: &[f64; 6]) -> f64;

    /// The same with the tangent.
    fn answer(&self, point: usize, place: &Place, strain: &[f64; 6]) -> Result<Answer, FaultCause>;
}

/// St. Venant-Kirchhoff, integrated through the thickness in closed form with the metric of the mid-surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Linear {
    /// `E / (1 - nu^2)`.
    modulus: f64,
    nu: f64,
    /// `t` and `t^3 / 12`.
    thickness: [f64; 2],
}

impl Linear {
    /// `C^ijkl`, force per area.
    #[inline(always)]
    fn moduli(&self, place: &Place) -> [[f64; 3]; 3] {
        let [a11, a22, a12] = inverse(&place.metric).0;
        let (nu, shear) = (self.nu, 0.5 * (1.0 - self.nu));
        let of = |p: f64, q: f64, r: f64| self.modulus * (nu * p * q + 2.0 * shear * r);
        let (c12, c13, c23) = (
            of(a11, a22, a12 * a12),
            of(a11, a12, a11 * a12),
            of(a22, a12, a22 * a12),
        );
        [
            [of(a11, a11, a11 * a11), c12, c13],
            [c12, of(a22, a22, a22 * a22), c23],
            [
                c13,
                c23,
                self.modulus * (nu * a12 * a12 + shear * (a11 * a22 + a12 * a12)),
            ],
        ]
    }
}

impl PlaneStress for Linear {
    #[inline(always)]
    fn resultants<D: DualNum<f64> + Copy>(
        &self,
        _: usize,
        place: &Place,
        strain: &[D; 6],
    ) -> Result<(D, Resultants<D>), FaultCause> {
        let c = self.moduli(place);
        let mut out = [D::zero(); 6];
        let mut energy = D::zero();
        for (part, t) in self.thickness.iter().enumerate() {
            for i in 0..3 {
                let mut s = D::zero();
                for j in 0..3 {
                    s += strain[3 * part + j] * (c[i][j] * t);
                }
                out[3 * part + i] = s;
                energy += s * strain[3 * part + i] * 0.5;
            }
        }
        Ok((energy, out))
    }

    /// The law has no thickness strain at large strain; to first order.
    fn thinning(&self, place: &Place, strain: &[f64; 6]) -> f64 {
        let [a11, a22, a12] = inverse(&place.metric).0;
        let trace = strain[0] * a11 + strain[1] * a22 + strain[2] * a12;
        (1.0 - 2.0 * self.nu / (1.0 - self.nu) * trace)
            .max(0.0)
            .sqrt()
    }

    #[inline(always)]
    fn answer(&self, point: usize, place: &Place, strain: &[f64; 6]) -> Result<Answer, FaultCause> {
        let (energy, resultants) = self.resultants(point, place, strain)?;
        let c = self.moduli(place);
        let mut tangent = [[0.0; 6]; 6];
        for (part, t) in self.thickness.iter().enumerate() {
            for i in 0..3 {
                for j in 0..3 {
                    tangent[3 * part + i][3 * part + j] = t * c[i][j];
                }
            }
        }
        Ok(Answer {
            energy,
            resultants,
            tangent,
        })
    }
}

/// Compressible neo-Hooke, at three Gauss points through the thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rubber {
    law: NeoHooke,
    thickness: f64,
}

/// A point through the thickness.
struct Layer<D> {
    energy: D,
    stress: Components<D>,
    /// `g^ij` of the deformed layer.
    upper: Components<D>,
    /// `C_33`, from `S^33 = 0`.
    c: D,
}

impl Rubber {
    /// With `g = G + 2 E` and `c = C_33` of `mu (c - 1) + lambda / 2 ln(det g / det G c) = 0`:
    /// `S^ij = mu (G^ij - c g^ij) = mu (2 G^ik E_kl g^lj - (c - 1) g^ij)`, which keeps all digits at small strain.
    #[inline(always)]
    fn layer<D: DualNum<f64> + Copy>(
        &self,
        point: usize,
        lower: &Components<f64>,
        e: &Components<D>,
    ) -> Result<Layer<D>, FaultCause> {
        let NeoHooke { lambda, mu } = self.law;
        let (up, _) = inverse(lower);
        // Mixed components G^ik E_kj; the shear of `e` is twice E_12.
        let e12 = e[2] * 0.5;
        let m = [
            [e[0] * up[0] + e12 * up[2], e12 * up[0] + e[1] * up[2]],
            [e[0] * up[2] + e12 * up[1], e12 * up[2] + e[1] * up[1]],
        ];
        let (trace, det) = (m[0][0] + m[1][1], m[0][0] * m[1][1] - m[0][1] * m[1][0]);
        let change = trace * 2.0 + det * 4.0;
        // Both stretches are positive where the determinant and the trace of I + 2 G^-1 E are.
        if !(change.re() > -1.0 && trace.re() > -1.0) {
            return Err(FaultCause::Collapsed {
                point: point as u8,
                ratio: 1.0 + change.re(),
            });
        }
        let ln = change.ln_1p();
        let miss = |y: D| y.exp_m1() * mu + (ln + y) * (0.5 * lambda);
        let mut y = -ln * (lambda / (2.0 * mu + lambda));
        // Convex in y: from the left every step but the first stays on one side. The last step carries the derivatives.
        for _ in 0..40 {
            let step = miss(y) / (y.exp() * mu + 0.5 * lambda);
            y -= step;
            if step.re().abs() <= 1e-15 * (1.0 + y.re().abs()) {
                break;
            }
        }
        y -= miss(y) / (y.exp() * mu + 0.5 * lambda);
        let (more, log_j) = (y.exp_m1(), (ln + y) * 0.5);
        let g = [
            e[0] * 2.0 + lower[0],
            e[1] * 2.0 + lower[1],
            e[2] + lower[2],
        ];
        let det_g = g[0] * g[1] - g[2] * g[2];
        let upper = [g[1] / det_g, g[0] / det_g, -g[2] / det_g];
        let stress = [
            (m[0][0] * upper[0] + m[0][1] * upper[2]) * 2.0 - more * upper[0],
            (m[1][0] * upper[2] + m[1][1] * upper[1]) * 2.0 - more * upper[1],
            (m[0][0] * upper[2] + m[0][1] * upper[1]) * 2.0 - more * upper[2],
        ]
        .map(|s| s * mu);
        Ok(Layer {
            energy: (trace * 2.0 + more) * (0.5 * mu) - log_j * mu + log_j * log_j * (0.5 * lambda),
            stress,
            upper,
            c: more + 1.0,
        })
    }

    /// Every layer with its place and weight.
    #[inline(always)]
    fn layers<D: DualNum<f64> + Copy>(
        &self,
        point: usize,
        place: &Place,
        strain: &[D; 6],
        mut take: impl FnMut(f64, f64, &Layer<D>),
    ) -> Result<(), FaultCause> {
        let half = 0.5 * self.thickness;
        for (zeta, w) in GAUSS_3.iter() {
            let z = half * zeta;
            let lower = [0, 1, 2].map(|i| place.metric[i] - 2.0 * z * place.curvature[i]);
            let e = [0, 1, 2].map(|i| strain[i] + strain[3 + i] * z);
            take(z, half * w, &self.layer(point, &lower, &e)?);
        }
        Ok(())
    }
}

impl PlaneStress for Rubber {
    #[inline(always)]
    fn resultants<D: DualNum<f64> + Copy>(
        &self,
        point: usize,
        place: &Place,
        strain: &[D; 6],
    ) -> Result<(D, Resultants<D>), FaultCause> {
        let (mut energy, mut out) = (D::zero(), [D::zero(); 6]);
        self.layers(point, place, strain, |z, w, layer| {
            energy += layer.energy * w;
            for i in 0..3 {
                out[i] += layer.stress[i] * w;
                out[3 + i] += layer.stress[i] * (w * z);
            }
        })?;
        Ok((energy, out))
    }

    fn thinning(&self, place: &Place, strain: &[f64; 6]) -> f64 {
        let [e1, e2, e3, ..] = *strain;
        (self.layer(0, &place.metric, &[e1, e2, e3])).map_or(f64::NAN, |layer| layer.c.sqrt())
    }

    /// `C^ijkl = 2 mu c ((g^ik g^jl + g^il g^jk) / 2 + b g^ij g^kl)`, `b = lambda / (lambda + 2 mu c)`.
    #[inline(always)]
    fn answer(&self, point: usize, place: &Place, strain: &[f64; 6]) -> Result<Answer, FaultCause> {
        let NeoHooke { lambda, mu } = self.law;
        let mut out = Answer {
            energy: 0.0,
            resultants: [0.0; 6],
            tangent: [[0.0; 6]; 6],
        };
        self.layers(point, place, strain, |z, w, layer: &Layer<f64>| {
            out.energy += layer.energy * w;
            let [g1, g2, g3] = layer.upper;
            let (b, k) = (lambda / (lambda + 2.0 * mu * layer.c), 2.0 * mu * layer.c);
            let (c12, c13, c23) = (
                g3 * g3 + b * g1 * g2,
                (1.0 + b) * g1 * g3,
                (1.0 + b) * g2 * g3,
            );
            let c = [
                [(1.0 + b) * g1 * g1, c12, c13],
                [c12, (1.0 + b) * g2 * g2, c23],
                [c13, c23, 0.5 * (g1 * g2 + g3 * g3) + b * g3 * g3],
            ];
            for i in 0..3 {
                out.resultants[i] += layer.stress[i] * w;
                out.resultants[3 + i] += layer.stress[i] * (w * z);
                for j in 0..3 {
                    let c = k * c[i][j] * w;
                    out.tangent[i][j] += c;
                    out.tangent[i][3 + j] += z * c;
                    out.tangent[3 + i][j] += z * c;
                    out.tangent[3 + i][3 + j] += z * z * c;
                }
            }
        })?;
        Ok(out)
    }
}

/// A law chosen at run time; elements branch on it once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sheet {
    Linear(Linear),
    Rubber(Rubber),
}

impl Sheet {
    /// The law over a thickness; none where it has no form in plane stress here.
    pub fn new(law: &Law, thickness: f64) -> Option<Sheet> {
        match law {
            Law::StVenantKirchhoff(StVenantKirchhoff { .. }) => {
                let nu = law.nu();
                Some(Sheet::Linear(Linear {
                    modulus: law.young() / (1.0 - nu * nu),
                    nu,
                    thickness: [thickness, thickness.powi(3) / 12.0],
                }))
            }
            Law::NeoHooke(law) => Some(Sheet::Rubber(Rubber {
                law: *law,
                thickness,
            })),
            Law::Hencky(_)
            | Law::J2(_)
            | Law::Hill48(_)
            | Law::ArmstrongFrederick(_)
            | Law::Dashpot(_) => None,
        }
    }
}

/// Inverse and determinant of a symmetric 2 x 2 matrix.
#[inline(always)]
pub(super) fn inverse(a: &Components<f64>) -> (Components<f64>, f64) {
    let det = a[0] * a[1] - a[2] * a[2];
    ([a[1] / det, a[0] / det, -a[2] / det], det)
}
