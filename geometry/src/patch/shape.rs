//! Rational shape functions of the active control points.

use super::{NurbsPatch, eval::orders};
use crate::basis::WIDTH;
use crate::surface::Vec3;

/// The control points that act on a point, with their rational shape functions. Buffers are reused: after the first use
/// with a patch of the same degree nothing is allocated.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PatchShape {
    /// Indices of the active control points, xi1 fastest: `(p + 1) (q + 1)` of them.
    pub indices: Vec<u32>,
    /// Shape functions N_k, one per active point.
    pub n: Vec<f64>,
    /// Derivatives N_k,1 and N_k,2.
    pub n_i: Vec<[f64; 2]>,
    /// Second derivatives N_k,11, N_k,12, N_k,22.
    pub n_ij: Vec<[f64; 3]>,
}

impl PatchShape {
    /// `sum_k N_k x_k` and its derivatives for any nodal values, given per control point of the patch.
    pub fn interpolate(&self, values: &[Vec3]) -> Option<crate::Jet> {
        let zero = Vec3::zeros();
        let mut jet = crate::Jet {
            rho: zero,
            rho_i: [zero; 2],
            rho_ij: [zero; 3],
        };
        for (slot, &k) in self.indices.iter().enumerate() {
            let x = values.get(k as usize)?;
            jet.rho += x * self.n[slot];
            for (sum, n) in jet.rho_i.iter_mut().zip(self.n_i[slot]) {
                *sum += x * n;
            }
            for (sum, n) in jet.rho_ij.iter_mut().zip(self.n_ij[slot]) {
                *sum += x * n;
            }
        }
        Some(jet)
    }
}

impl NurbsPatch {
    /// Fills `shape` with the rational shape functions at `xi` (inner knots and the domain's ends as in
    /// [`jet`](Self::jet)).
    pub fn shape(&self, xi: [f64; 2], shape: &mut PatchShape) {
        let xi = self.snap(xi);
        self.shape_in_span(self.find_span(xi), xi, shape);
    }

    /// [`shape`](Self::shape) of the polynomial piece of span `span`.
    pub fn shape_in_span(&self, span: [usize; 2], xi: [f64; 2], shape: &mut PatchShape) {
        let mut n = [[[0.0; WIDTH]; 3]; 2];
        for (dir, n) in n.iter_mut().enumerate() {
            self.basis[dir].evaluate(span[dir], xi[dir], n);
        }
        // w_k N_k with derivatives, and their sums.
        let mut total = [0.0; 6];
        shape.indices.clear();
        shape.n.clear();
        shape.n_i.clear();
        shape.n_ij.clear();
        self.for_each_active(span, |r, s, k| {
            let weight = self.points[k][3];
            let mut f = [0.0; 6];
            for (slot, (m1, m2)) in orders(3).enumerate() {
                f[slot] = n[0][m1][r] * n[1][m2][s] * weight;
                total[slot] += f[slot];
            }
            shape.indices.push(k as u32);
            shape.n.push(f[0]);
            shape.n_i.push([f[1], f[2]]);
            shape.n_ij.push([f[3], f[4], f[5]]);
        });
        // The quotient rule, as for the surface itself.
        let [w, w1, w2, w11, w12, w22] = total;
        let inv = 1.0 / w;
        for ((n, n_i), n_ij) in shape.n.iter_mut().zip(&mut shape.n_i).zip(&mut shape.n_ij) {
            *n *= inv;
            *n_i = [(n_i[0] - w1 * *n) * inv, (n_i[1] - w2 * *n) * inv];
            *n_ij = [
                (n_ij[0] - 2.0 * w1 * n_i[0] - w11 * *n) * inv,
                (n_ij[1] - w1 * n_i[1] - w2 * n_i[0] - w12 * *n) * inv,
                (n_ij[2] - 2.0 * w2 * n_i[1] - w22 * *n) * inv,
            ];
        }
    }
}
