//! Closest point on a set of patches.
//!
//! [`PatchSet`] joins patches over their common edges, orients them, and finds the closest point of any query point.
//! The search is global: a tree over the exact Bezier pieces of all patches is descended by lower bounds, a safeguarded
//! Newton iteration with active bounds gives stationary points (on faces, edges, creases, corners), and every piece is
//! either proved to hold nothing nearer or cut and searched further. See Konyukhov and Schweizerhof, "On the solvability
//! of closest point projection procedures in contact analysis", CMAME 197 (2008), for the mechanics of faces, edges and
//! vertices.

pub(crate) mod ball;
mod batch;
pub(crate) mod cells;
mod convex;
pub(crate) mod downhill;
mod finish;
mod integrate;
mod keep;
mod local;
mod location;
mod neighbour;
mod normals;
pub(crate) mod piece;
mod query;
mod ray;
mod report;
mod round;
mod search;
mod separation;
pub(crate) mod set;
mod sharp;
mod sides;
mod subdivide;
mod ties;
mod tips;
pub(crate) mod topology;
pub(crate) mod tree;
mod trimmed;
mod trimmed_search;
mod turn;

pub use batch::BatchError;
pub use neighbour::Neighbour;
pub use query::QueryError;
pub use ray::{Hit, RayError};
pub use report::{CurvatureExtreme, CurvatureRange};
pub use separation::{Separation, SeparationError};
pub use set::{Joining, PatchSet, PatchSetError};
pub use sharp::{Rim, RimPoint, SharpEdge};
pub use sides::{ComponentSide, SideError, SideOutcome};
pub use tips::Tip;
pub use topology::{Border, EdgeReport, Gap, Joint, Overlap, PartialJoint};

use crate::surface::{Jet, Vec3};

/// How a patch edge continues.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeKind {
    /// Another patch continues with the same tangent plane.
    Smooth,
    /// Another patch continues at an angle.
    Sharp,
    /// Nothing continues: a free border.
    Free,
}

/// Where on the set of patches a foot point lies.
///
/// Edge numbers: 0 is xi1 = min, 1 is xi1 = max, 2 is xi2 = min, 3 is xi2 = max; `4 + k` is curve `k` of the patch's trim,
/// counted over its loops. Corner numbers: below 4 a corner of the domain, bit 0 set at xi1 = max, bit 1 set at
/// xi2 = max; `4 + k` is the start of trim curve `k`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Location {
    /// Inside of a patch.
    Face,
    /// On an edge of a patch, or on a curve of its trim.
    Edge {
        /// Number of the edge.
        edge: u32,
        /// What lies beyond it.
        kind: EdgeKind,
    },
    /// On a corner of a patch, or at the start of a curve of its trim.
    Corner {
        /// Number of the corner.
        corner: u32,
        /// What lies around it.
        kind: EdgeKind,
    },
    /// On a line inside a patch where an inner knot of full multiplicity breaks the tangent; `dir` is the
    /// direction (0 or 1) whose knot it is.
    Crease {
        /// 0 or 1.
        dir: u8,
    },
    /// On an edge that is one point in space.
    Pole {
        /// Number of the edge.
        edge: u32,
    },
}

/// How sure a foot point is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Converged, and no other point of the set is as near up to the tolerance of the search.
    Unique,
    /// Other points are as near: the query lies at a centre of curvature, or as far from another foot elsewhere (halfway
    /// between two sheets, inside of a box, on an axis of revolution). The one found is given.
    NonUnique,
    /// The iteration did not reach its tolerance; the best point found is given.
    NotConverged,
}

/// Where a search may start: the foot found before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hint {
    /// Number of the patch.
    pub patch: u32,
    /// Parameters on it.
    pub xi: [f64; 2],
}

/// The closest point of a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Number of the patch.
    pub patch: u32,
    /// Parameters of the foot.
    pub xi: [f64; 2],
    /// Face, edge, corner, crease or pole.
    pub location: Location,
    /// How sure it is.
    pub status: Status,
    /// Jet of the patch at `xi`; on a crease, of the side the iteration came from.
    pub jet: Jet,
    /// +1 or -1: `side * (rho_1 x rho_2)` points out of the master on this patch. 0 on a component with one side only.
    pub side: f64,
    /// Euclidean distance, >= 0.
    pub distance: f64,
    /// Distance with sign: positive outside, decided by the pseudo-normal at edges and corners. Over the gap between patches
    /// that join smoothly its part along the normal. Never negative on a component with one side only.
    pub signed_distance: f64,
    /// Outward unit normal; the angle-weighted pseudo-normal at sharp edges and corners. On a component with one side only
    /// the normal of the patch that points to the query's side.
    pub normal: Vec3,
}

impl Foot {
    /// Where to start when the query has moved a little.
    pub fn hint(&self) -> Hint {
        Hint {
            patch: self.patch,
            xi: self.xi,
        }
    }
}
