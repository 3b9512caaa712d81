//! Local frame of a surface point.
use crate::surface::Vec3;

/// The local frame of a surface point: everything the covariant contact formulas ask of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<D = f64> {
    pub rho: Vec3<D>,
    /// Tangents rho_1, rho_2.
    pub rho_i: [Vec3<D>; 2],
    /// Second derivatives rho_11, rho_12, rho_22.
    pub rho_ij: [Vec3<D>; 3],
    /// Outward unit normal `side * (rho_1 x rho_2) / |..|`.
    pub n: Vec3<D>,
    /// Metric a_11, a_12, a_22.
    pub a: [D; 3],
    /// Inverse metric a^11, a^12, a^22.
    pub a_inv: [D; 3],
    /// Curvature h_ij = rho_ij . n: h_11, h_12, h_22 (negative on a convex master with outward normal).
    pub h: [D; 3],
    /// `sqrt(det a)`.
    pub area: D,
}
