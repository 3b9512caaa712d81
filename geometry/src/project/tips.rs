//! Sharp tips of a set: points at which faces meet that face far apart, though no edge there is sharp.

use super::EdgeKind;
use super::set::PatchSet;
use super::topology::{CornerGroup, Edge, edge_point, edges_at};
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
        let mut normals = Vec::with_capacity(group.corners.len());
        for &(patch, corner) in &group.corners {
            self.normals_at(patch, corner, &mut normals);
        }
        let sum: Vec3 = normals.iter().sum();
        let farthest = |from: &Vec3| {
            let by = |a: &&Vec3, b: &&Vec3| a.dot(from).total_cmp(&b.dot(from));
            normals.iter().min_by(by).copied()
        };
        let first = farthest(&sum)?;
        let mut tip = Tip {
            x: Vec3::zeros(),
            normals: [first, farthest(&first)?],
            patches: group.corners.iter().map(|c| c.0).collect(),
        };
        // Most corners of a set that is smooth end here.
        if tip.angle() <= 2.0 * angle || self.on_an_edge(group, angle) {
            return None;
        }
        tip.patches.sort_unstable();
        tip.patches.dedup();
        let mut away = Vec::new();
        for &(patch, corner) in &group.corners {
            let edges = self.topology.of(patch);
            let ends = edges_at(edges, corner as usize).into_iter();
            for (local, end) in ends.filter(|(local, _)| edges[*local].kind.is_some()) {
                let [x, inside] = [0.0, INTO].map(|part| self.along_edge(&edges[local], end, part));
                tip.x = x;
                away.push(inside - x);
            }
        }
        let outward = !away.is_empty() && away.iter().all(|d| d.dot(&sum) < 0.0);
        outward.then_some(tip)
    }

    /// Adds the outward unit normals of a patch at one of its corners: those around it at a pole.
    fn normals_at(&self, patch: u32, corner: u32, normals: &mut Vec<Vec3>) {
        let side = self.sides[patch as usize];
        let edges = self.topology.of(patch);
        let ends = edges_at(edges, corner as usize);
        let normal = |edge: &Edge, t: f64| {
            let at = edge_point(self, edge, t);
            self.normal_near(patch, at.span, at.xi) * side
        };
        let poles = ends
            .iter()
            .filter(|(local, _)| edges[*local].kind.is_none());
        for (local, _) in poles.clone() {
            let [start, stop] = edges[*local].interval;
            let places = (0..=PLACES).map(|k| k as f64 / PLACES as f64);
            normals
                .extend(places.map(|part| normal(&edges[*local], start + part * (stop - start))));
        }
        if poles.count() == 0 {
            let (local, end) = ends[0];
            normals.push(normal(&edges[local], edges[local].interval[end]));
        }
    }

    /// The point of an edge at a part of its length in parameters from one of its ends.
    fn along_edge(&self, edge: &Edge, end: usize, part: f64) -> Vec3 {
        let [start, stop] = edge.interval;
        let part = if end == 0 { part } else { 1.0 - part };
        edge_point(self, edge, start + part * (stop - start))
            .jet
            .rho
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
