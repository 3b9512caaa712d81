//! Sharp tips of a set: points at which faces meet that face far apart, though no edge there is sharp.

use super::EdgeKind;
use super::set::PatchSet;
use super::topology::{CornerGroup, edge_point, edges_at};
use crate::surface::{Surface, Vec3};

/// Places of a pole at which its normals are taken, as parts of its length.
const PLACES: usize = 8;
/// How far into the patches their direction at a tip is measured, as part of their edges.
const INTO: f64 = 0.1;

/// A sharp tip.
#[derive(Debug, Clone, PartialEq)]
pub struct Tip {
    /// Where it is.
    pub x: Vec3,
    /// Patches that meet there, each once.
    pub patches: Vec<u32>,
    /// Outward unit normals there that are farthest apart.
    pub normals: [Vec3; 2],
}

impl Tip {
    /// Angle between the normals that are farthest apart (radians).
    pub fn angle(&self) -> f64 {
        let [a, b] = &self.normals;
        a.cross(b).norm().atan2(a.dot(b))
    }
}

impl<S: Surface> PatchSet<S> {
    /// Points at which patches meet, or one of them comes to a pole, whose normals are more than twice `angle` apart there (radians) and
    /// that bulge outwards with the present sides: the tip of a cone. Ends of edges at which the normal turns by more than `angle`, and
    /// points on free borders, are not among them, nor is what lies inside a patch.
    pub fn tips(&self, angle: f64) -> Vec<Tip> {
        (0..self.topology.groups.len())
            .filter_map(|group| self.tip(group, angle))
            .collect()
    }

    fn tip(&self, group: usize, angle: f64) -> Option<Tip> {
        let group = &self.topology.groups[group];
        if !group.through.is_empty() {
            return None;
        }
        let mut normals = Vec::new();
        let mut away = Vec::new();
        let mut patches = Vec::new();
        let mut x = None;
        for &(patch, corner) in &group.corners {
            let side = self.sides[patch as usize];
            let edges = self.topology.of(patch);
            for (local, end) in edges_at(edges, corner as usize) {
                let edge = &edges[local];
                let [start, stop] = edge.interval;
                if edge.kind.is_none() {
                    let places = (0..=PLACES).map(|k| k as f64 / PLACES as f64);
                    normals.extend(places.map(|part| {
                        let at = edge_point(self, edge, start + part * (stop - start));
                        self.normal_near(patch, at.span, at.xi) * side
                    }));
                    continue;
                }
                let at = |part: f64| {
                    let part = if end == 0 { part } else { 1.0 - part };
                    edge_point(self, edge, start + part * (stop - start))
                };
                let tip = at(0.0);
                normals.push(self.normal_near(patch, tip.span, tip.xi) * side);
                away.push(at(INTO).jet.rho - tip.jet.rho);
                x.get_or_insert(tip.jet.rho);
            }
            if !patches.contains(&patch) {
                patches.push(patch);
            }
        }
        let sum: Vec3 = normals.iter().sum();
        let farthest = |from: &Vec3| {
            let by = |a: &&Vec3, b: &&Vec3| a.dot(from).total_cmp(&b.dot(from));
            normals.iter().min_by(by).copied()
        };
        let first = farthest(&sum)?;
        let tip = Tip {
            x: x?,
            normals: [first, farthest(&first)?],
            patches,
        };
        let outward = away.iter().all(|d| d.dot(&sum) < 0.0);
        (outward && tip.angle() > 2.0 * angle && !self.on_an_edge(group, angle)).then_some(tip)
    }

    /// Whether an edge that ends at a group of corners is a free border or turns by more than `angle`.
    fn on_an_edge(&self, group: &CornerGroup, angle: f64) -> bool {
        group.corners.iter().any(|&(patch, corner)| {
            let first = self.topology.first[patch as usize];
            let ends = edges_at(self.topology.of(patch), corner as usize);
            ends.into_iter().any(|(local, end)| {
                let edge = &self.topology.edges[first + local];
                let t = edge.interval[end];
                match edge.kind_at(t) {
                    Some(EdgeKind::Free) => true,
                    Some(EdgeKind::Sharp) => edge
                        .links_at(t)
                        .any(|link| self.turn(first + local, link).angle > angle),
                    _ => false,
                }
            })
        })
    }
}
