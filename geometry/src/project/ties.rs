//! Feet that are as near as each other.

use super::finish::HOPS;
use super::local::Local;
use super::set::PatchSet;
use crate::surface::{Surface, Vec3};

/// Points nearer to each other than this (relative to the size of the set) are the same.
const SAME: f64 = 1e-7;

impl<S: Surface> PatchSet<S> {
    /// Whether two points of the set are the same, up to what local iterations may miss them by.
    #[inline]
    pub(super) fn is_same(&self, a: &Vec3, b: &Vec3) -> bool {
        let limit = SAME * self.size;
        (a - b).norm_squared() <= limit * limit
    }

    /// The foot that another stationary point leads to, with its distance, if it is not the foot that `best` leads to. Both
    /// are brought to machine precision and moved on over borders, so that what is found twice is known again. Two
    /// points on the two sides of a joint are the same.
    pub(super) fn other_foot(&self, q: &Vec3, best: &Local, other: &Local) -> Option<(Vec3, f64)> {
        if self.is_same(&best.jet.rho, &other.jet.rho) {
            return None;
        }
        let [a, b] = [best, other].map(|s| self.settled_foot(q, *s, HOPS));
        let gap = (a.jet.rho - b.jet.rho).norm();
        if !b.converged || self.is_same(&a.jet.rho, &b.jet.rho) || gap <= self.joint_at(&a) {
            return None;
        }
        Some((b.jet.rho, b.d2.sqrt()))
    }

    /// How far apart the two sides of the joints may be that a point lies on; zero where it lies on none.
    fn joint_at(&self, s: &Local) -> f64 {
        let edges = self.edges_under(s).into_iter().flatten();
        let reaches = edges.flat_map(|(edge, t)| {
            let links = self.topology.edges[edge].links_at(t);
            links.map(|link| link.reach)
        });
        reaches.fold(0.0, f64::max)
    }
}
