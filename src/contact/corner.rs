//! Contact where the foot point lies on an edge or a vertex of the master instead of on a face.
//!
//! With `d = r_s - rho`, signed distance `s = -|d|` (penetration) and penalty `N = eps s`, the force is `eps d`: smooth
//! as the distance vanishes, where the direction `d / |d|` alone would not be. The second variation of the distance
//! (generalised closest point, Konyukhov & Schweizerhof, CMAME 197 (2008)) gives the tangents below without any
//! division by `s`.
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

/// Tangent at a rigid edge with derivative `rho'` and second derivative `rho''` along it:
/// `eps (I - rho' x rho' / (|rho'|^2 - rho'' . d))`.
pub fn edge_tangent<D: DualNum<f64> + Copy>(
    d: &Vector3<D>,
    rho_s: &Vector3<D>,
    rho_ss: &Vector3<D>,
    eps: D,
) -> Matrix3<D> {
    let denominator = rho_s.dot(rho_s) - rho_ss.dot(d);
    vertex_tangent(eps) - rho_s * rho_s.transpose() * (eps / denominator)
}
