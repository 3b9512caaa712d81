//! What contact asks of a rigid surface, whatever its patches are made of.
use covact_geometry::{Foot, Hint, Jet, PatchSet, Surface, Vec3};

/// A surface on which closest points can be found. Batches of contact points are compiled for each implementation, so
/// that nothing is chosen inside their loop.
pub trait ClosestPoint: Sync {
    /// Closest point to `q` within `reach`; see [`PatchSet::project`].
    fn project(&self, q: &Vec3, hint: Option<Hint>, reach: f64) -> Option<Foot>;

    /// Closest point to `q` within `reach`, which need not be certain where `q` lies outside and farther away than
    /// `above`; see [`PatchSet::project_above`].
    fn project_above(&self, q: &Vec3, hint: Option<Hint>, reach: f64, above: f64) -> Option<Foot>;

    /// Closest point on one patch, continued past its border; see [`PatchSet::project_on`].
    fn project_on(&self, q: &Vec3, on: Hint, beyond: f64) -> Option<Foot>;

    /// First and second derivative along an edge; see [`PatchSet::edge_derivatives`].
    fn edge_derivatives(&self, patch: u32, edge: u32, xi: [f64; 2]) -> Option<[Vec3; 2]>;

    /// How the pseudo-normal of a foot turns along its edge; see [`PatchSet::normal_along`].
    fn normal_along(&self, foot: &Foot, along: &Vec3) -> Vec3;

    /// The surface around the foot of `q` on a pole or next to one; see [`PatchSet::pole_jet`].
    fn pole_jet(&self, foot: &Foot, q: &Vec3) -> Option<Jet>;

    /// Length of the diagonal of a box around the surface.
    fn size(&self) -> f64;
}

impl<S: Surface> ClosestPoint for PatchSet<S> {
    #[inline]
    fn project(&self, q: &Vec3, hint: Option<Hint>, reach: f64) -> Option<Foot> {
        self.project(q, hint, reach)
    }

    #[inline]
    fn project_above(&self, q: &Vec3, hint: Option<Hint>, reach: f64, above: f64) -> Option<Foot> {
        self.project_above(q, hint, reach, above)
    }

    fn project_on(&self, q: &Vec3, on: Hint, beyond: f64) -> Option<Foot> {
        self.project_on(q, on, beyond)
    }

    #[inline]
    fn edge_derivatives(&self, patch: u32, edge: u32, xi: [f64; 2]) -> Option<[Vec3; 2]> {
        self.edge_derivatives(patch, edge, xi)
    }

    fn normal_along(&self, foot: &Foot, along: &Vec3) -> Vec3 {
        self.normal_along(foot, along)
    }

    fn pole_jet(&self, foot: &Foot, q: &Vec3) -> Option<Jet> {
        self.pole_jet(foot, q)
    }

    #[inline]
    fn size(&self) -> f64 {
        self.size()
    }
}
