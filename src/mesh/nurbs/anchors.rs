//! Nodes on curves of trims, where no control points lie: supports hold them, and springs hold the sheet to them.
use super::{Border, BorderPoint, DEGREE, NurbsSheet, TrimEdge, sorted};
use crate::mesh::Mesh;

/// Distance of the anchors of a curve, in elements. Along a curve that runs with the knots the sheet has one number an element, which is
/// what one anchor an element holds; those of every cut element are more than all of them have, and lock the thinner it is.
const SPACING: f64 = 1.0;

/// Number of them up to which there are two an element: a curve that ends has more numbers than elements, and a short one needs them.
const SHORT: f64 = 4.0;

/// Least number of them: one would not keep a curve from turning.
const LEAST: usize = DEGREE - 1;

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

impl NurbsSheet {
    /// Nodes of the anchors on a curve, if it has any.
    pub fn anchored(&self, trim: TrimEdge) -> Option<Vec<u32>> {
        let own = self.anchors.iter().filter(|a| a.trim == trim);
        let nodes: Vec<u32> = own.map(|a| a.node).collect();
        (!nodes.is_empty()).then_some(nodes)
    }

    /// Parts of a border that are equally long in elements, of about [`SPACING`].
    fn evenly(&self, border: Border) -> Vec<[f64; 2]> {
        let part = &self.patches[border.patch()];
        let line = part.line(border);
        let pieces = line.pieces(line.whole());
        let length = |[a, b]: [f64; 2]| -> f64 {
            let span = line.span(0.5 * (a + b));
            let [from, to] = [a, b].map(|s| line.xi(s));
            let along = [0, 1].map(|dir| {
                let [a, b] = part.patch.basis(dir).span_range(span[dir]);
                (to[dir] - from[dir]) / (b - a)
            });
            along[0].hypot(along[1])
        };
        let whole = line.whole();
        let gap = 1e-9 * (whole[1] - whole[0]).abs();
        let runs: Vec<_> = pieces.chunk_by(|p, q| q[0] - p[1] <= gap).collect();
        let least = if runs.len() == 1 { LEAST } else { 1 };
        let mut out = Vec::new();
        for run in runs {
            // Where each piece begins, and the end.
            let mut starts = vec![0.0];
            for piece in run {
                starts.push(starts[starts.len() - 1] + length(*piece));
            }
            let total = starts[run.len()];
            let short = (2.0 * total / SPACING).min(SHORT);
            let count = ((total / SPACING).max(short).ceil() as usize).max(least);
            let at = |way: f64| -> f64 {
                let k = starts.partition_point(|s| *s <= way).clamp(1, run.len()) - 1;
                let [a, b] = run[k];
                let part = (way - starts[k]) / (starts[k + 1] - starts[k]).max(f64::MIN_POSITIVE);
                a + (b - a) * part.clamp(0.0, 1.0)
            };
            let step = total / count as f64;
            out.extend((0..count).map(|k| [k as f64 * step, (k + 1) as f64 * step].map(at)));
        }
        out
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
            let curve = Border::Trim(trim);
            let points = self.points_along(curve, &self.evenly(curve), 1);
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
