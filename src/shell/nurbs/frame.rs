//! The local frame of a mid-surface point, generic over the scalar.
use super::super::kinematics::{V, dot};
use num_dual::DualNum;

/// Control points that act on a knot span of a cubic patch.
pub const NODES: usize = 16;

/// Degrees of freedom of a knot span.
pub const DOFS: usize = 3 * NODES;

/// Order of the components of surface tensors: 11, 22, 12; strains with engineering shear.
pub(super) type Components<D> = [D; 3];

/// Derivatives of the shape functions at a point: along xi1, xi2, and twice (11, 22, 12).
pub(super) type Second = [[f64; NODES]; 5];

/// `sum_a n_a x_a`.
#[inline(always)]
pub(super) fn combine<D: DualNum<f64> + Copy>(n: &[f64; NODES], x: &[V<D>; NODES]) -> V<D> {
    let mut sum = [D::zero(); 3];
    for (n, x) in n.iter().zip(x) {
        for c in 0..3 {
            sum[c] += x[c] * *n;
        }
    }
    sum
}

#[inline(always)]
pub(super) fn cross<D: DualNum<f64> + Copy>(a: &V<D>, b: &V<D>) -> V<D> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// `a + b` of an undeformed vector and a change.
#[inline(always)]
pub(super) fn moved<D: DualNum<f64> + Copy>(a: &V<f64>, b: &V<D>) -> V<D> {
    [0, 1, 2].map(|c| b[c] + a[c])
}

/// `a . b` of an undeformed vector.
#[inline(always)]
pub(super) fn along<D: DualNum<f64> + Copy>(a: &V<f64>, b: &V<D>) -> D {
    b[0] * a[0] + b[1] * a[1] + b[2] * a[2]
}

/// Metric `rho_i . rho_j` of two tangents.
#[inline(always)]
pub(super) fn metric<D: DualNum<f64> + Copy>(r: &[V<D>; 2]) -> Components<D> {
    [dot(&r[0], &r[0]), dot(&r[1], &r[1]), dot(&r[0], &r[1])]
}

/// Tangents, unit normal and dual tangents of a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Normal<D> {
    /// `rho_1, rho_2`.
    pub r: [V<D>; 2],
    /// `rho_1 x rho_2 / |..|`.
    pub n: V<D>,
    /// `rho^1, rho^2`.
    pub up: [V<D>; 2],
    /// `|rho_1 x rho_2|`.
    pub area: D,
}

impl<D: DualNum<f64> + Copy> Normal<D> {
    /// Not finite where the tangents are parallel.
    #[inline(always)]
    pub fn new(r: [V<D>; 2]) -> Self {
        let c = cross(&r[0], &r[1]);
        let det = dot(&c, &c);
        let area = det.sqrt();
        let n = c.map(|c| c / area);
        let a = metric(&r);
        let up = [0, 1].map(|i| {
            let (own, other) = (a[1 - i] / det, a[2] / det);
            [0, 1, 2].map(|c| r[i][c] * own - r[1 - i][c] * other)
        });
        Normal { r, n, up, area }
    }

    /// `beta_a = N_a,k rho^k`: the unit normal changes by `-sum_a beta_a (n . dx_a)`.
    #[inline(always)]
    pub fn beta(&self, n1: f64, n2: f64) -> V<D> {
        [0, 1, 2].map(|c| self.up[0][c] * n1 + self.up[1][c] * n2)
    }
}

/// Membrane strains `eps_ij = (P_i . u_j + P_j . u_i + u_i . u_j) / 2` of undeformed tangents `P_i` and derivatives `u_i` of the
/// displacement, the shear twice. A difference of metrics would leave the rounding of positions, as large as the forces of a sheet
/// that is moved along by its edge.
#[inline(always)]
pub(super) fn membrane<D: DualNum<f64> + Copy>(
    rest: [&V<f64>; 2],
    [u1, u2]: &[V<D>; 2],
) -> Components<D> {
    [
        along(rest[0], u1) + dot(u1, u1) * 0.5,
        along(rest[1], u2) + dot(u2, u2) * 0.5,
        along(rest[0], u2) + along(rest[1], u1) + dot(u1, u2),
    ]
}

/// An undeformed point of the surface: derivatives of the position as in [`Second`], unit normal, and `|P_1 x P_2|`.
#[derive(Debug, Clone)]
pub(super) struct Rest {
    pub p: [V<f64>; 5],
    pub n: V<f64>,
    pub area: f64,
}

impl Rest {
    /// Changes of curvature `kap_ij = H_ij - h_ij = - u_ij . n - P_ij . (n - N)` of a frame at derivatives `u` of the displacement, the
    /// last twice. The change of the normal is that of `c = rho_1 x rho_2` over its length `a`, which changes by
    /// `(c - C) . (c + C) / (a + A)`: no difference of positions, as in [`membrane`].
    #[inline(always)]
    pub fn bending<D: DualNum<f64> + Copy>(
        &self,
        frame: &Frame<D>,
        u: &[V<D>; 5],
    ) -> Components<D> {
        let rest = [0, 1].map(|i| self.p[i].map(D::from));
        let parts = [cross(&u[0], &frame.at.r[1]), cross(&rest[0], &u[1])];
        let change = [0, 1, 2].map(|c| parts[0][c] + parts[1][c]);
        let area = frame.at.area;
        let both = [0, 1, 2].map(|c| frame.at.n[c] * area + self.n[c] * self.area);
        let longer = dot(&change, &both) / (area + self.area);
        let turned = [0, 1, 2].map(|c| (change[c] - longer * self.n[c]) / area);
        [(2, 1.0), (3, 1.0), (4, 2.0)]
            .map(|(k, times)| -(dot(&u[k], &frame.at.n) + along(&self.p[k], &turned)) * times)
    }
}

/// [`Normal`] with curvatures.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame<D> {
    pub at: Normal<D>,
    /// `h_ij = rho_ij . n`.
    pub h: Components<D>,
    /// Christoffel symbols `rho_ij . rho^k`, `[k][ij]`.
    pub gamma: [Components<D>; 2],
}

impl<D: DualNum<f64> + Copy> Frame<D> {
    /// Of derivatives of the position (11, 22, 12 the last ones).
    #[inline(always)]
    pub fn new([r1, r2, second @ ..]: [V<D>; 5]) -> Self {
        let at = Normal::new([r1, r2]);
        Frame {
            h: second.map(|r| dot(&r, &at.n)),
            gamma: at.up.map(|up| second.map(|r| dot(&r, &up))),
            at,
        }
    }

    /// `N_a,ij - Gamma^k_ij N_a,k`, the covariant second derivatives of shape function `a`.
    #[inline(always)]
    pub fn covariant(&self, n: &Second, a: usize) -> Components<D> {
        [0, 1, 2].map(|ij| {
            D::from(n[2 + ij][a]) - self.gamma[0][ij] * n[0][a] - self.gamma[1][ij] * n[1][a]
        })
    }
}
