//! Corners that meet in space.

use std::collections::HashSet;

use super::super::piece::box_distance2;
use super::super::set::PatchSet;
use super::super::tree::Tree;
use super::Topology;
use super::edge::{Edge, EdgeCurve};
use super::matching::Touch;
use crate::surface::{Surface, Vec3};

/// What meets at a point.
#[derive(Debug, Clone, Default)]
pub(crate) struct CornerGroup {
    /// Patches with a corner there: patch and corner, counted from zero on its patch.
    pub corners: Vec<(u32, u32)>,
    /// Edges that pass through: index and parameter.
    pub through: Vec<(usize, f64)>,
}

/// Corner (counted from zero on its patch) at an end of an edge. `edges` are those of the patch.
pub(crate) fn corner_at(edges: &[Edge], local: usize, end: usize) -> usize {
    match edges[local].curve {
        EdgeCurve::Side { dir, end: side } => (side << dir) | (end << (1 - dir)),
        EdgeCurve::Trim { .. } if end == 0 => local,
        EdgeCurve::Trim { a_loop, curve } => {
            if local + 1 < loop_end(edges, a_loop) {
                local + 1
            } else {
                local - curve.min(local)
            }
        }
    }
}

/// One past the last curve of a loop; curves are sorted by loop.
fn loop_end(edges: &[Edge], a_loop: usize) -> usize {
    edges.partition_point(|e| matches!(e.curve, EdgeCurve::Trim { a_loop: l, .. } if l <= a_loop))
}

/// The two edges of a corner, counted from zero on the patch, each with the end that lies at the corner: on a trimmed patch
/// the curve that begins there, then the one that ends there.
pub(crate) fn edges_at(edges: &[Edge], corner: usize) -> [(usize, usize); 2] {
    match edges[corner].curve {
        EdgeCurve::Side { .. } => {
            let end = [corner & 1, corner >> 1];
            [(end[0], end[1]), (2 + end[1], end[0])]
        }
        EdgeCurve::Trim { a_loop, curve } => {
            let before = if curve > 0 {
                corner - 1
            } else {
                loop_end(edges, a_loop).max(1) - 1
            };
            [(corner, 0), (before, 1)]
        }
    }
}

/// Groups the corners of all patches, and adds to the edges which groups lie on them.
pub(super) fn group<S: Surface>(set: &PatchSet<S>, topology: &mut Topology, touches: &[Touch]) {
    let count = topology.edges.len();
    let mut all: Vec<(Vec3, f64, usize, usize)> = Vec::with_capacity(count);
    for patch in 0..topology.first.len() - 1 {
        let edges = topology.of(patch as u32);
        for corner in 0..edges.len() {
            let ends = edges_at(edges, corner);
            let (edge, end) = ends[0];
            let samples = &edges[edge].samples;
            let point = samples[end * (samples.len() - 1)].point;
            // No short edge has both ends in the same group, poles apart.
            let lengths = ends.map(|(e, _)| edges[e].length);
            let links = ends.iter().flat_map(|(e, _)| &edges[*e].links);
            let reach = links.fold(2.0 * set.tolerance, |reach, link| reach.max(link.reach));
            let shorter = lengths.into_iter().filter(|l| *l > 1e-7 * set.size);
            let limit = shorter.fold(reach, |limit, l| limit.min(0.2 * l));
            all.push((point, limit, patch, corner));
        }
    }
    all.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then((a.2, a.3).cmp(&(b.2, b.3))));
    let boxes: Vec<[Vec3; 2]> = all.iter().map(|c| [c.0; 2]).collect();
    let tree = Tree::new(&boxes);
    let mut group = vec![u32::MAX; all.len()];
    let mut groups: Vec<CornerGroup> = Vec::new();
    topology.corners = vec![0; count];
    for k in 0..all.len() {
        let (point, limit, patch, corner) = all[k];
        if group[k] == u32::MAX {
            group[k] = groups.len() as u32;
            groups.push(CornerGroup::default());
        }
        let own = group[k];
        groups[own as usize]
            .corners
            .push((patch as u32, corner as u32));
        topology.corners[topology.first[patch] + corner] = own;
        let measure = |low: &Vec3, high: &Vec3| box_distance2(&point, low, high);
        let limit2 = limit * limit * (1.0 + 1e-12) + f64::MIN_POSITIVE;
        tree.scan(measure, limit2, |later| {
            let (later, other) = (later as usize, &all[later as usize]);
            if later > k
                && group[later] == u32::MAX
                && (other.0 - point).norm() <= limit.min(other.1)
            {
                group[later] = own;
            }
            limit2
        });
    }
    let mut seen = HashSet::new();
    for &((edge, end), (on, t)) in touches {
        let patch = topology.edges[edge].patch;
        let first = topology.first[patch as usize];
        let corner = corner_at(topology.of(patch), edge - first, end);
        let own = topology.corners[first + corner];
        if seen.insert((own, on)) {
            groups[own as usize].through.push((on, t));
            topology.edges[on].vertices.push((t, own));
        }
    }
    topology.groups = groups;
}
