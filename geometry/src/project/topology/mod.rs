//! Common edges of patches: geometric matching, components and consistent orientation.
//!
//! A patch is bounded by its edges: the four sides of its domain or, where it is trimmed, its trim curves. Every edge is
//! sampled by a polyline that follows its turns; edges whose boxes meet are compared point by point, and the parts of
//! their parameter intervals that coincide become links. From the links follow joints, T-joints, free borders, connected
//! components, sides, and what meets at corners.

mod borders;
mod contact;
mod corners;
mod edge;
mod matching;
mod nearest;
mod orient;
mod overlap;
mod report;
mod senses;

pub(crate) use corners::{CornerGroup, corner_at, edges_at};
pub(crate) use edge::{Edge, EdgeCurve, EdgePoint, Link, edge_point};
pub(crate) use nearest::nearest_on_edge;
pub use report::{Border, EdgeReport, Gap, Joint, Overlap, PartialJoint};

use super::set::{Joining, PatchSet};
use crate::surface::Surface;

/// Edges shorter than this share of the size are one point.
const POLE: f64 = 1e-7;
/// Gaps up to this share of the size are rounding: that of the file's digits, and of boundary curves fitted to 1e-7 of their
/// surface.
const ROUNDING: f64 = 1e-6;
/// Default tolerance as a share of the size.
const TOLERANCE: f64 = 1e-5;

/// What was found about the edges of a set.
#[derive(Debug, Clone, Default)]
pub(crate) struct Topology {
    /// Edges of all patches, one patch after the other, those of a patch by number.
    pub edges: Vec<Edge>,
    /// Index of the first edge of every patch, and one past the last.
    pub first: Vec<usize>,
    /// Corners that meet.
    pub groups: Vec<CornerGroup>,
    /// Group of every corner: a patch has as many corners as edges, so they are numbered alike.
    pub corners: Vec<u32>,
    /// Patches that hang together.
    pub components: Vec<Vec<usize>>,
    pub component_of: Vec<usize>,
    /// For each component with one side only: two patches that cannot be oriented alike.
    pub one_sided: Vec<Option<[usize; 2]>>,
    /// Volume enclosed by each component where it is closed, negative where its sides point inward.
    pub volumes: Vec<Option<f64>>,
    pub report: EdgeReport,
}

impl Topology {
    /// The edges of a patch.
    pub fn of(&self, patch: u32) -> &[Edge] {
        &self.edges[self.first[patch as usize]..self.first[patch as usize + 1]]
    }

    /// Index of an edge by the number that [`Location`](super::Location) gives it; `None` where the patch has none such.
    pub fn index(&self, patch: u32, number: u32) -> Option<usize> {
        let edges = self.of(patch);
        let start = edges.first()?.number;
        let local = number.checked_sub(start)? as usize;
        (local < edges.len()).then(|| self.first[patch as usize] + local)
    }
}

/// Finds edges, joints, components and sides of a set whose patches and tree are complete.
pub(super) fn build<S: Surface>(set: &mut PatchSet<S>, joining: Joining) {
    let Joining {
        tolerance,
        resolution,
    } = joining;
    let mut topology = Topology {
        first: vec![0],
        ..Topology::default()
    };
    for patch in 0..set.patches.len() {
        topology.edges.extend(edge::edges_of(set, patch as u32));
        topology.first.push(topology.edges.len());
    }
    let edges = &mut topology.edges;
    let pole_limit = (POLE * set.size).max(tolerance.unwrap_or(0.0));
    let poles: Vec<bool> = edges
        .iter()
        .map(|e| {
            let first = e.samples[0].point;
            e.samples
                .iter()
                .all(|s| (s.point - first).norm() <= pole_limit)
        })
        .collect();
    set.tolerance = tolerance.unwrap_or(TOLERANCE * set.size);
    topology.report.tolerance = set.tolerance;
    topology.report.resolution = resolution.unwrap_or(0.0).max(ROUNDING * set.size);
    let chosen: Vec<usize> = (0..edges.len()).filter(|&k| !poles[k]).collect();
    let pairs = matching::pairs(set, edges, &chosen, set.tolerance, tolerance.is_none());
    let touches = matching::link(edges, &poles, pairs, &mut topology.report);
    matching::open_gaps(set, edges, &mut topology.report);
    topology.report.borders = borders::borders(set, edges);
    let components = orient::orient(edges, &topology.first, &mut set.sides);
    topology.volumes = orient::volumes(set, edges, &topology.first, &components);
    for (members, volume) in components.members.iter().zip(&mut topology.volumes) {
        if let Some(volume) = volume
            && *volume < 0.0
        {
            *volume = -*volume;
            members.iter().for_each(|&patch| set.sides[patch] *= -1.0);
        }
    }
    (topology.components, topology.component_of) = (components.members, components.of);
    topology.one_sided = components.one_sided;
    corners::group(set, &mut topology, &touches);
    topology.report.overlaps = overlap::overlaps(set, &topology);
    set.topology = topology;
}
