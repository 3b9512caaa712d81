//! Free edges chained to rims.

use super::super::EdgeKind;
use super::super::set::PatchSet;
use super::edge::{Edge, edge_point};
use super::matching::name;
use super::report::Border;
use crate::surface::{Surface, Vec3};

/// A free part of an edge.
struct Arc {
    edge: usize,
    length: f64,
    ends: [Vec3; 2],
}

/// Chains the free parts of all edges by their ends.
pub(super) fn borders<S: Surface>(set: &PatchSet<S>, edges: &[Edge]) -> Vec<Border> {
    let mut arcs = Vec::new();
    for (number, edge) in edges.iter().enumerate() {
        if edge.kind != Some(EdgeKind::Free) {
            continue;
        }
        for part in edge.free_parts() {
            let length = edge.length_between(part);
            if length > (4.0 * set.tolerance).min(0.05 * edge.length) {
                let ends = part.map(|t| edge_point(set, edge, t).jet.rho);
                arcs.push(Arc {
                    edge: number,
                    length,
                    ends,
                });
            }
        }
    }
    // Ends sorted along x, to find the neighbours of each.
    let mut ends: Vec<(f64, usize, usize)> = Vec::with_capacity(2 * arcs.len());
    for (k, arc) in arcs.iter().enumerate() {
        ends.extend([(arc.ends[0].x, k, 0), (arc.ends[1].x, k, 1)]);
    }
    ends.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut used = vec![false; arcs.len()];
    let follow = |used: &[bool], at: &Vec3, limit: f64| {
        let from = ends.partition_point(|e| e.0 < at.x - limit);
        let near = ends[from..].iter().take_while(|e| e.0 <= at.x + limit);
        near.filter(|e| !used[e.1])
            .map(|&(_, arc, end)| ((arcs[arc].ends[end] - at).norm(), arc, end))
            .filter(|(distance, arc, _)| *distance <= limit.min(0.4 * arcs[*arc].length))
            .min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mut out = Vec::new();
    for seed in 0..arcs.len() {
        if used[seed] {
            continue;
        }
        used[seed] = true;
        let mut chain = std::collections::VecDeque::from([seed]);
        let mut length = arcs[seed].length;
        let [mut tail, mut head] = arcs[seed].ends;
        let limit = 4.0 * set.tolerance;
        let mut closed = false;
        for forward in [true, false] {
            loop {
                let meets = (tail - head).norm() <= limit.min(0.4 * length);
                if meets {
                    closed = true;
                    break;
                }
                let Some((_, arc, end)) = follow(&used, if forward { &head } else { &tail }, limit)
                else {
                    break;
                };
                used[arc] = true;
                length += arcs[arc].length;
                let next = arcs[arc].ends[1 - end];
                if forward {
                    chain.push_back(arc);
                    head = next;
                } else {
                    chain.push_front(arc);
                    tail = next;
                }
            }
        }
        out.push(Border {
            edges: chain
                .iter()
                .map(|&arc| name(&edges[arcs[arc].edge]))
                .collect(),
            length,
            closed,
        });
    }
    out
}
