//! What contact asks of a rigid surface, whatever its patches are made of.
use covact_geometry::{Foot, Hint, PatchSet, Surface, Vec3};

/// A surface on which closest points can be found. Batches of contact points are compiled for each implementation, so
/// that nothing is chosen inside their loop.
pub trait ClosestPoint: Sync {
    /// Closest point to `q` within `reach`; see [`PatchSet::project`].
    fn project(&self, q: &Vec3, hint: Option<Hint>, reach: f64) -> Option<Foot>;

    /// First and second derivative along an edge; see [`PatchSet::edge_derivatives`].
    fn edge_derivatives(&self, patch: u32, edge: u32, xi: [f64; 2]) -> Option<[Vec3; 2]>;

    /// Length of the diagonal of a box around the surface.
    fn size(&self) -> f64;
}

impl<S: Surface> ClosestPoint for PatchSet<S> {
    #[inline]
    fn project(&self, q: &Vec3, hint: Option<Hint>, reach: f64) -> Option<Foot> {
        self.project(q, hint, reach)
    }

    #[inline]
    fn edge_derivatives(&self, patch: u32, edge: u32, xi: [f64; 2]) -> Option<[Vec3; 2]> {
        self.edge_derivatives(patch, edge, xi)
    }

    #[inline]
    fn size(&self) -> f64 {
        self.size()
    }
}
