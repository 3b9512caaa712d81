//! Jets: a surface point with its parametric derivatives.

/// A point or vector of three-dimensional space.
pub type Vec3<D = f64> = nalgebra::Vector3<D>;

/// Surface point with first and second parametric derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet<D = f64> {
    /// Surface point rho.
    pub rho: Vec3<D>,
    /// Tangents rho_1, rho_2.
    pub rho_i: [Vec3<D>; 2],
    /// Second derivatives in the order 11, 12, 22.
    pub rho_ij: [Vec3<D>; 3],
}

/// A [`Jet`] with third derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet3<D = f64> {
    pub jet: Jet<D>,
    /// Third derivatives in the order 111, 112, 122, 222.
    pub rho_ijk: [Vec3<D>; 4],
}
