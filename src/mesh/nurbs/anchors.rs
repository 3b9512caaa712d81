//! Nodes on curves of trims, where no control points lie: supports hold them, and springs hold the sheet to them.
use super::{Border, BorderPoint, DEGREE, NurbsSheet, TrimEdge, sorted};
use crate::mesh::Mesh;

/// Anchors on every piece of a curve within an element. Full rules would lock where an element holds several pieces.
const POINTS: usize = DEGREE - 1;

/// A point of a curve of a trim with a node of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Anchor {
    /// The curve.
    pub trim: TrimEdge,
    /// Number of its node in the body.
    pub node: u32,
    /// The point.
    pub at: BorderPoint,
}

impl Anchor {
    /// Whether another one is the next of the same line: their lengths touch, of one curve or two.
    pub fn precedes(&self, next: &Anchor) -> bool {
        let apart = (next.at.at.position - self.at.at.position).norm();
        let same = Border::Trim(self.trim).patch() == Border::Trim(next.trim).patch();
        same && apart < 2.0 * (self.at.length + next.at.length)
    }
}

impl NurbsSheet {
    /// Nodes of the anchors on a curve, if it has any.
    pub fn anchored(&self, trim: TrimEdge) -> Option<Vec<u32>> {
        let own = self.anchors.iter().filter(|a| a.trim == trim);
        let nodes: Vec<u32> = own.map(|a| a.node).collect();
        (!nodes.is_empty()).then_some(nodes)
    }

    /// Gives the curves of these sets anchors, with nodes behind all others, of which the sets consist from then on.
    pub fn anchor<'a>(&mut self, mesh: &mut Mesh, sets: impl Iterator<Item = &'a str>) {
        let borders = sets.filter_map(|set| self.edge_sets.get(set)).flatten();
        let mut trims: Vec<TrimEdge> = borders
            .filter_map(|b| match b {
                Border::Trim(trim) => Some(*trim),
                Border::Edge(_) => None,
            })
            .collect();
        trims.sort_unstable();
        trims.dedup();
        for trim in trims {
            let points = self.border_points(Border::Trim(trim), POINTS);
            for at in points.into_iter().flatten() {
                let node = mesh.nodes.len() as u32;
                mesh.nodes.push(at.at.position);
                self.anchors.push(Anchor { trim, node, at });
            }
        }
        if self.anchors.is_empty() {
            return;
        }
        for (name, borders) in &self.edge_sets {
            if borders.iter().any(|b| matches!(b, Border::Trim(_))) {
                let nodes = self.border_nodes(borders);
                mesh.node_sets.insert(name.clone(), sorted(nodes));
            }
        }
    }
}
