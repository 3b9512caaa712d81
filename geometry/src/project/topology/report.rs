//! What was found about edges, for users.

use super::super::EdgeKind;
use crate::surface::Vec3;

/// A whole edge of one patch that coincides with a whole edge of another patch (or of the same patch: a seam). Edges carry
/// their numbers in [`Location`](crate::Location).
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Patch and edge number of both sides.
    pub edges: [(u32, u32); 2],
    /// Smooth or sharp.
    pub kind: EdgeKind,
    /// Largest angle between the normals at the points compared (radians).
    pub angle: f64,
    /// Largest distance at the points compared.
    pub gap: f64,
    /// Where that is.
    pub gap_at: Vec3,
    /// Whether the parameters of the two edges run against each other.
    pub reversed: bool,
    /// Whether the file gives both edges the same number, too.
    pub same_entity: bool,
}

/// An edge of which only a part coincides with an edge of another patch, or with several edges (a T-joint).
#[derive(Debug, Clone, PartialEq)]
pub struct PartialJoint {
    /// Patch and number of the edge.
    pub edge: (u32, u32),
    /// Patches and edges that parts of it coincide with.
    pub others: Vec<(u32, u32)>,
    /// Share of its length that lies on other edges. Where it is 1 the edge counts as joined, else as free in part.
    pub share: f64,
}

/// Two edges that nearly coincide.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// Patch and edge number of both sides.
    pub edges: [(u32, u32); 2],
    /// Largest distance at the points compared.
    pub gap: f64,
    /// Where that is, in the middle.
    pub at: Vec3,
}

/// A free edge that lies inside another patch: the patches run over each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlap {
    /// Patch and number of the edge.
    pub edge: (u32, u32),
    /// The patch that it lies in.
    pub patch: u32,
    /// Share of the points of the edge looked at that lie in that patch.
    pub share: f64,
    /// How far inside: the largest distance of these points from the border of that patch.
    pub depth: f64,
    /// Where that is.
    pub at: Vec3,
}

/// Free edges, or free parts of edges, that follow each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Border {
    /// Patches and numbers of the edges, in the order in which they are walked.
    pub edges: Vec<(u32, u32)>,
    /// Length of the free parts.
    pub length: f64,
    /// Whether the walk comes back to where it started: the rim of a sheet or of a hole.
    pub closed: bool,
}

/// What was found about edges. All numbers of edges are those of [`Location`](crate::Location): below 4 a side of the
/// domain, `4 + k` trim curve `k`.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct EdgeReport {
    /// Whole edges joined in pairs.
    pub joints: Vec<Joint>,
    /// Edges that coincide with others in part.
    pub partial: Vec<PartialJoint>,
    /// Edges that are free in whole or in part: patch and number.
    pub free: Vec<(u32, u32)>,
    /// The free edges chained to rims.
    pub borders: Vec<Border>,
    /// Edges that are one point in space.
    pub poles: Vec<(u32, u32)>,
    /// Edges at which more than two patches meet; the nearest pair is joined and orients the surface.
    pub branching: Vec<(u32, u32)>,
    /// Edges of joints at which the surface folds back onto itself, so that both patches leave them in the same direction.
    pub folded: Vec<(u32, u32)>,
    /// Joints across which the surface is smooth.
    pub smooth: usize,
    /// Joints at an angle.
    pub sharp: usize,
    /// Largest gap over all joints, those of parts included.
    pub largest_gap: f64,
    /// Where the largest gap is; `None` where nothing is joined.
    pub largest_gap_at: Option<Gap>,
    /// Joints over gaps wider than [`resolution`](Self::resolution), those of parts included.
    pub bridged: Vec<Gap>,
    /// Pairs of free edges too far from each other to be joined, but within a hundred times the tolerance: likely gaps.
    pub open_gaps: Vec<Gap>,
    /// Pairs of free edges within a hundred times the tolerance that were not joined because both patches leave the edge in
    /// the same direction: the borders of sheets on top of each other.
    pub stacked: Vec<Gap>,
    /// Free edges that lie inside another patch.
    pub overlaps: Vec<Overlap>,
    /// The tolerance that edges were joined with.
    pub tolerance: f64,
    /// Gaps up to this are no gaps: the resolution of the source, at least 1e-6 of the size.
    pub resolution: f64,
}
