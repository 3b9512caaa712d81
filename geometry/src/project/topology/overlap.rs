//! Patches that run over each other.

use std::collections::BTreeMap;

use super::super::EdgeKind;
use super::super::piece::box_distance2;
use super::super::search::region_of;
use super::super::set::PatchSet;
use super::Topology;
use super::edge::edge_point;
use super::matching::name;
use super::nearest::nearest_on_edge;
use super::report::Overlap;
use crate::surface::{Surface, Vec3};

/// Most points of a free part that are looked at.
const POINTS: usize = 24;

/// Looks where the free parts of edges lie inside another patch, away from its border by more than four tolerances.
pub(super) fn overlaps<S: Surface>(set: &PatchSet<S>, topology: &Topology) -> Vec<Overlap> {
    let mut out = Vec::new();
    for edge in &topology.edges {
        if edge.kind != Some(EdgeKind::Free) {
            continue;
        }
        let mut looked = 0;
        // By patch: number of points inside, the deepest.
        let mut found: BTreeMap<u32, (usize, f64, Vec3)> = BTreeMap::new();
        for [a, b] in edge.free_parts() {
            let inner = edge.samples.iter().filter(|s| s.t > a && s.t < b).count();
            let n = (2 * (inner + 1)).clamp(4, POINTS);
            let own = &set.patches[edge.patch as usize];
            for k in (0..n).take_while(|_| own.may_go_on()) {
                let t = a + (b - a) * (k as f64 + 0.5) / n as f64;
                let p = edge_point(set, edge, t).jet.rho;
                looked += 1;
                for (patch, depth) in inside_of(set, topology, &p, edge.patch) {
                    let entry = found.entry(patch).or_insert((0, 0.0, p));
                    entry.0 += 1;
                    if depth > entry.1 {
                        (entry.1, entry.2) = (depth, p);
                    }
                }
            }
        }
        out.extend(found.into_iter().map(|(patch, (n, depth, at))| Overlap {
            edge: name(edge),
            patch,
            share: n as f64 / looked as f64,
            depth,
            at,
        }));
    }
    out
}

/// The patches other than `own` that a point lies inside of, with its distance from their borders.
fn inside_of<S: Surface>(
    set: &PatchSet<S>,
    topology: &Topology,
    p: &Vec3,
    own: u32,
) -> Vec<(u32, f64)> {
    let limit2 = set.tolerance * set.tolerance;
    let mut out: Vec<(u32, f64)> = Vec::new();
    set.tree.visit(p, limit2, |id| {
        if id as usize >= set.pieces.count() {
            return limit2;
        }
        let piece = set.piece_place(id);
        if piece.patch != own && out.iter().all(|o| o.0 != piece.patch) {
            let region = region_of(&piece);
            let middle = piece.domain.map(|[a, b]| 0.5 * (a + b));
            let local = set.descend(p, &region, middle, piece.span, 1e-10);
            if local.d2 <= limit2 && !set.trimmed_away(piece.patch, local.xi) {
                let mut depth = f64::INFINITY;
                for e in topology.of(piece.patch) {
                    if box_distance2(p, &e.bounds[0], &e.bounds[1]) < depth * depth {
                        depth = depth.min((nearest_on_edge(set, p, e).jet.rho - p).norm());
                    }
                }
                if depth > 4.0 * set.tolerance {
                    out.push((piece.patch, depth));
                }
            }
        }
        limit2
    });
    out
}
