//! Contact where the foot point lies on an edge or a vertex of the master instead of on a face.
//!
//! With `d = r_s - rho`, signed distance `xi3 = -|d|` (penetration) and the law's traction `N`, the force is `e d` with
//! the secant `e = N / xi3`. For a penalty `e` is the penalty itself, and the force is smooth as the distance vanishes,
//! where the direction `d / |d|` alone would not be. The second variation of the distance (generalised closest point,
//! Konyukhov & Schweizerhof, CMAME 197 (2008)) gives, in the slots of [`super::kernel`],
//!
//! ```text
//! R = e (d, 0, 0)
//! K = e ( P - E x E / (|rho'|^2 - rho'' . d) ) + (N' - e) n x n      P = I in slot 0, n = (d, 0, 0) / xi3
//! E = (rho', t_1 d, t_2 d)       ds = E . slots / (|rho'|^2 - rho'' . d)
//! ```
//!
//! for an edge that runs along `t` in the parameters of its face, `rho' = t_i rho_i`. The slots 1 and 2 of the residual
//! are zero because `d . rho' = 0` at the foot; their rows in the tangent come from the point of application, which
//! moves over the master's shape functions by `t_i ds`. A vertex moves with its node: `E = 0`. On a rigid master the
//! first 3 x 3 block remains.
use super::kernel::{Normal, SlotMatrix, Slots};
use nalgebra::{Matrix3, Vector3};
use num_dual::DualNum;

/// Force on the slave point per unit area: `-eps d` pushes it back to the edge or vertex. Returned as the residual
/// `eps d` (internal forces positive), like the normal residual.
pub fn residual<D: DualNum<f64> + Copy>(d: &Vector3<D>, eps: D) -> Vector3<D> {
    d * eps
}

/// Tangent at a rigid vertex: `eps I`.
pub fn vertex_tangent<D: DualNum<f64> + Copy>(eps: D) -> Matrix3<D> {
    let z = D::zero();
    Matrix3::new(eps, z, z, z, eps, z, z, z, eps)
}

/// `|rho'|^2 - rho'' . d`, positive where the closest point of the edge is a strict minimum (length^2).
pub fn curvature<D: DualNum<f64> + Copy>(
    d: &Vector3<D>,
    rho_s: &Vector3<D>,
    rho_ss: &Vector3<D>,
) -> D {
    rho_s.dot(rho_s) - rho_ss.dot(d)
}

/// Tangent at a rigid edge with derivative `rho'` and second derivative `rho''` along it:
/// `eps (I - rho' x rho' / (|rho'|^2 - rho'' . d))`.
pub fn edge_tangent<D: DualNum<f64> + Copy>(
    d: &Vector3<D>,
    rho_s: &Vector3<D>,
    rho_ss: &Vector3<D>,
    eps: D,
) -> Matrix3<D> {
    let denominator = curvature(d, rho_s, rho_ss);
    vertex_tangent(eps) - rho_s * rho_s.transpose() * (eps / denominator)
}

/// What a law that is not proportional to the distance adds to the tangent of an edge or a vertex:
/// `(N' - N / xi3) n x n`.
pub fn law_part<D: DualNum<f64> + Copy>(d: &Vector3<D>, xi3: D, normal: &Normal<D>) -> Matrix3<D> {
    let n = d * xi3.recip();
    n * n.transpose() * (normal.dn - normal.n / xi3)
}

/// A direction of traction next to an edge or a vertex, on a master that stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steady<D = f64> {
    /// Unit vector along which the normal traction acts.
    pub n: Vector3<D>,
    /// `dn/dr_s` (1 / length).
    pub turn: Matrix3<D>,
    /// `dxi3/dr_s`, the direction of the distance itself.
    pub gradient: Vector3<D>,
}

/// The direction of a traction that does not vanish with the distance (a multiplier, an offset), within `radius` of an edge
/// or a vertex, where `e = d / xi3` turns ever faster as the distance vanishes and is nothing at last:
///
/// ```text
/// n = v / |v|     v = (1 - w) m + w e     w = q^2 (3 - 2 q),  q = |xi3| / radius
/// ```
///
/// with the pseudo-normal `m`. At `radius` it goes over into `e` with its derivative; at the line itself it is `m`. `e` and
/// `m` never oppose each other, for the side of `e` is that of `m`. `m_turn` is `dm/dr_s`, zero at a vertex, and
/// `line` the first and second derivative of the edge, none at a vertex.
pub fn steady<D: DualNum<f64> + Copy>(
    d: &Vector3<D>,
    xi3: D,
    line: Option<(&Vector3<D>, &Vector3<D>)>,
    m: &Vector3<D>,
    m_turn: &Matrix3<D>,
    radius: f64,
) -> Steady<D> {
    if xi3.re() == 0.0 {
        return Steady {
            n: *m,
            turn: *m_turn,
            gradient: *m,
        };
    }
    let e = d * xi3.recip();
    let mut across = vertex_tangent(D::one()) - e * e.transpose();
    if let Some((rho_s, rho_ss)) = line {
        across -= rho_s * rho_s.transpose() * curvature(d, rho_s, rho_ss).recip();
    }
    let q = xi3 * (xi3.re().signum() / radius);
    let w = q * q * (-q * 2.0 + 3.0);
    let v = m * (-w + 1.0) + e * w;
    let shorter = v.dot(&v).sqrt().recip();
    let n = v * shorter;
    // dv = (1 - w) dm + w / xi3 (I - e x e - ..) + w' (e - m) x e
    let slope = q * (-q + 1.0) * (6.0 * xi3.re().signum() / radius);
    let dv = m_turn * (-w + 1.0) + across * (w / xi3) + (e - m) * e.transpose() * slope;
    Steady {
        n,
        turn: (dv - n * (n.transpose() * dv)) * shorter,
        gradient: e,
    }
}

/// Residual `N d / xi3` of an edge or vertex point of unit weight in the nine slots.
pub(super) fn slots_residual<D: DualNum<f64> + Copy>(
    d: &Vector3<D>,
    xi3: D,
    normal: &Normal<D>,
) -> Slots<D> {
    let mut r = Slots::from_element(D::zero());
    r.fixed_rows_mut::<3>(0)
        .copy_from(&residual(d, normal.n / xi3));
    r
}

/// Tangent at a vertex that moves, in the nine slots.
pub(super) fn vertex_slots<D: DualNum<f64> + Copy>(
    d: &Vector3<D>,
    xi3: D,
    normal: &Normal<D>,
) -> SlotMatrix<D> {
    let block = vertex_tangent(normal.n / xi3) + law_part(d, xi3, normal);
    let mut k = SlotMatrix::from_element(D::zero());
    k.fixed_view_mut::<3, 3>(0, 0).copy_from(&block);
    k
}

/// `E` of an edge that moves: `ds = E . slots / (|rho'|^2 - rho'' . d)`.
pub(super) fn along_edge<D: DualNum<f64> + Copy>(
    d: &Vector3<D>,
    direction: &[D; 2],
    rho_s: &Vector3<D>,
) -> Slots<D> {
    let mut e = Slots::from_element(D::zero());
    for k in 0..3 {
        e[k] = rho_s[k];
        e[3 + k] = d[k] * direction[0];
        e[6 + k] = d[k] * direction[1];
    }
    e
}

/// Tangent at an edge that moves, in the nine slots.
pub(super) fn edge_slots<D: DualNum<f64> + Copy>(
    d: &Vector3<D>,
    xi3: D,
    direction: &[D; 2],
    rho_s: &Vector3<D>,
    rho_ss: &Vector3<D>,
    normal: &Normal<D>,
) -> SlotMatrix<D> {
    let e = along_edge(d, direction, rho_s);
    let scale = normal.n / (xi3 * curvature(d, rho_s, rho_ss));
    vertex_slots(d, xi3, normal) - e * e.transpose() * scale
}
