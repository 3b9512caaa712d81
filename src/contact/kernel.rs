//! The covariant core of normal contact: frame, gap and law in; generalised forces and tangent out.
//!
//! A contact point meets its surroundings in nine slots: the relative displacement `dr_s - drho` (slots 0 to 2), the
//! change of the first tangent `drho_,1` (3 to 5) and of the second `drho_,2` (6 to 8). With the row vectors
//!
//! ```text
//! g3  = (n, 0, 0)            dxi3 = g3 . slots, exact at every xi3
//! b_i = (rho_i, 0, 0)
//! c_1 = (0, n, 0)   c_2 = (0, 0, n)
//! X^j = A^ji (b_i + xi3 c_i)  dxi^j = X^j . slots,  A_ij = a_ij - xi3 h_ij
//! q_i = c_i + h_ik X^k
//! ```
//!
//! residual and exact tangent of `N dxi3` are
//!
//! ```text
//! R = N g3
//! K = dN/dxi3 g3 x g3 + N ( -c_j x X^j - X^j x c_j - h_ij X^i x X^j + xi3 a^ij q_i x q_j )
//! ```
//!
//! Nothing here knows shape functions: a node enters through three scalars per point (`-N_k` or `+N_s`, `N_k,1`,
//! `N_k,2`), see [`assemble_block`]. A rigid master has no rows, which leaves the first 3 x 3 block.
//!
//! Konyukhov & Schweizerhof, Comput. Mech. 35 (2005), give the form that is exact at `xi3 = 0`: see
//! [`super::published`].
use covact_geometry::Frame;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use num_dual::DualNum;

/// Vector in the nine slots of a contact point.
pub type Slots<D = f64> = SVector<D, 9>;
/// Tangent in the nine slots of a contact point.
pub type SlotMatrix<D = f64> = SMatrix<D, 9, 9>;

/// Normal traction of a contact point and its derivative, as a law returns them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normal<D = f64> {
    /// Traction `N`, negative where the surfaces press (force / length^2).
    pub n: D,
    /// `dN/dxi3` (force / length^3).
    pub dn: D,
}

/// The row vectors of a contact point, exact at its `xi3`.
pub(super) struct Rows<D> {
    pub g3: Slots<D>,
    pub c: [Slots<D>; 2],
    pub x: [Slots<D>; 2],
    pub q: [Slots<D>; 2],
}

pub(super) fn in_slot<D: DualNum<f64> + Copy>(slot: usize, v: &Vector3<D>) -> Slots<D> {
    let mut s = Slots::from_element(D::zero());
    for k in 0..3 {
        s[3 * slot + k] = v[k];
    }
    s
}

/// `A^{ij}`, inverse of `a_ij - xi3 h_ij`, as 11, 12, 22.
#[inline(always)]
pub fn inverse_at_point<D: DualNum<f64> + Copy>(frame: &Frame<D>, xi3: D) -> [D; 3] {
    let m = |i: usize| frame.a[i] - frame.h[i] * xi3;
    let [m11, m12, m22] = [m(0), m(1), m(2)];
    let inverse_det = (m11 * m22 - m12 * m12).recip();
    [m22 * inverse_det, -m12 * inverse_det, m11 * inverse_det]
}

pub(super) fn rows<D: DualNum<f64> + Copy>(frame: &Frame<D>, xi3: D) -> Rows<D> {
    let inv = inverse_at_point(frame, xi3);
    let c = [in_slot(1, &frame.n), in_slot(2, &frame.n)];
    let full = [0, 1].map(|i| in_slot(0, &frame.rho_i[i]) + c[i] * xi3);
    let x = [
        full[0] * inv[0] + full[1] * inv[1],
        full[0] * inv[1] + full[1] * inv[2],
    ];
    let h = &frame.h;
    let q = [
        c[0] + x[0] * h[0] + x[1] * h[1],
        c[1] + x[0] * h[1] + x[1] * h[2],
    ];
    Rows {
        g3: in_slot(0, &frame.n),
        c,
        x,
        q,
    }
}

/// Generalised forces `N g3` of a contact point with unit weight.
pub fn normal_residual<D: DualNum<f64> + Copy>(frame: &Frame<D>, normal: &Normal<D>) -> Slots<D> {
    in_slot(0, &frame.n) * normal.n
}

/// Exact tangent of a contact point with unit weight, on a master that moves or deforms. Symmetric.
pub fn normal_tangent<D: DualNum<f64> + Copy>(
    frame: &Frame<D>,
    xi3: D,
    normal: &Normal<D>,
) -> SlotMatrix<D> {
    let Rows { g3, c, x, q } = rows(frame, xi3);
    let outer = |u: &Slots<D>, v: &Slots<D>| u * v.transpose();
    let sym = |u: &Slots<D>, v: &Slots<D>| outer(u, v) + outer(v, u);
    let h = &frame.h;
    let a_inv = &frame.a_inv;
    let geometric = -(sym(&c[0], &x[0]) + sym(&c[1], &x[1]))
        - outer(&x[0], &x[0]) * h[0]
        - sym(&x[0], &x[1]) * h[1]
        - outer(&x[1], &x[1]) * h[2]
        + (outer(&q[0], &q[0]) * a_inv[0]
            + sym(&q[0], &q[1]) * a_inv[1]
            + outer(&q[1], &q[1]) * a_inv[2])
            * xi3;
    outer(&g3, &g3) * normal.dn + geometric * normal.n
}

/// Exact tangent of a contact point with unit weight on a rigid master: the first 3 x 3 block of
/// [`normal_tangent`]. With `c_i = 0` its geometric part collapses, by `A = a - xi3 h`, to
/// `-N (A^-1 h a^-1)^ij rho_i x rho_j`.
#[inline(always)]
pub fn normal_tangent_rigid<D: DualNum<f64> + Copy>(
    frame: &Frame<D>,
    xi3: D,
    normal: &Normal<D>,
) -> Matrix3<D> {
    let inv = inverse_at_point(frame, xi3);
    let shape = triple(&inv, &frame.h, &frame.a_inv);
    main_and_curvature(frame, &shape, normal)
}

/// Product `l h r` of three symmetric 2 x 2 matrices (11, 12, 22) whose product is symmetric.
#[inline(always)]
fn triple<D: DualNum<f64> + Copy>(l: &[D; 3], h: &[D; 3], r: &[D; 3]) -> [D; 3] {
    let lh = [
        l[0] * h[0] + l[1] * h[1],
        l[0] * h[1] + l[1] * h[2],
        l[1] * h[0] + l[2] * h[1],
        l[1] * h[1] + l[2] * h[2],
    ];
    [
        lh[0] * r[0] + lh[1] * r[1],
        lh[0] * r[1] + lh[1] * r[2],
        lh[2] * r[1] + lh[3] * r[2],
    ]
}

/// `dN n x n - N s^ij rho_i x rho_j`, symmetric to the last bit: the half that is formed is mirrored.
#[inline(always)]
pub(super) fn main_and_curvature<D: DualNum<f64> + Copy>(
    frame: &Frame<D>,
    s: &[D; 3],
    normal: &Normal<D>,
) -> Matrix3<D> {
    let [r1, r2] = &frame.rho_i;
    let s = [s[0] * normal.n, s[1] * normal.n, s[2] * normal.n];
    let n = frame.n * normal.dn;
    let t1 = r1 * s[0] + r2 * s[1];
    let t2 = r1 * s[1] + r2 * s[2];
    let entry = |i: usize, j: usize| n[i] * frame.n[j] - t1[i] * r1[j] - t2[i] * r2[j];
    let [k21, k31, k32] = [entry(1, 0), entry(2, 0), entry(2, 1)];
    Matrix3::new(
        entry(0, 0),
        k21,
        k31,
        k21,
        entry(1, 1),
        k32,
        k31,
        k32,
        entry(2, 2),
    )
}

/// A node's place in the slots of a point: slave node `{N_s, 0, 0}`, master node `{-N_k, N_k,1, N_k,2}`.
///
/// These are the node's columns of `A`, which gives the relative displacement `dr_s - drho = A du` (7), and of `B_j`, which
/// gives the change of the tangents `drho_,j = B_j du` (8). `B_j` is not the derivative of `A`: its sign on the master's nodes
/// is the opposite.
#[doc(alias = "A")]
#[doc(alias = "B_j")]
pub type NodeRow = [f64; 3];

/// 3 x 3 block of a pair of nodes from the point's 9 x 9 tangent: `sum_ab row_a col_b K_ab`.
pub fn assemble_block(k: &SlotMatrix, row: &NodeRow, column: &NodeRow) -> Matrix3<f64> {
    let mut block = Matrix3::zeros();
    for (a, wa) in row.iter().enumerate() {
        for (b, wb) in column.iter().enumerate() {
            block += k.fixed_view::<3, 3>(3 * a, 3 * b) * (wa * wb);
        }
    }
    block
}

/// Force on a node from the point's generalised forces.
pub fn assemble_force(r: &Slots, row: &NodeRow) -> Vector3<f64> {
    (0..3).fold(Vector3::zeros(), |f, a| {
        f + r.fixed_rows::<3>(3 * a) * row[a]
    })
}
