//! Laws of normal contact: gap in, traction and stiffness out. Chosen outside every loop.
use super::kernel::Normal;

/// A law between the normal coordinate `xi3` (negative = penetration) and the normal traction.
pub trait NormalLaw: Sync {
    /// Traction at a penetrating point, `xi3 < 0`.
    fn normal(&self, xi3: f64) -> Normal;
}

/// Penalty: `N = eps_n xi3`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penalty {
    /// Pressure per penetration (force / length^3).
    pub eps_n: f64,
}

impl NormalLaw for Penalty {
    #[inline]
    fn normal(&self, xi3: f64) -> Normal {
        Normal {
            n: self.eps_n * xi3,
            dn: self.eps_n,
        }
    }
}
