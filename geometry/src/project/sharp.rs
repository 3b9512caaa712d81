//! Sharp edges of a set as polylines.

use super::EdgeKind;
use super::set::PatchSet;
use super::topology::edge_point;
use crate::surface::{Surface, Vec3};

/// Places of a joint at which its angle is measured, as parts of its length.
const PLACES: [f64; 3] = [0.1, 0.5, 0.9];

/// A sharp edge of one patch. A joint of two patches gives two of these, one for each patch.
#[derive(Debug, Clone, PartialEq)]
pub struct SharpEdge {
    /// Number of the patch.
    pub patch: u32,
    /// Points along the edge, at least two: the ends of straight lines that follow it.
    pub points: Vec<Vec3>,
    /// Largest angle between the normals of both sides at the places measured (radians).
    pub angle: f64,
    /// Whether the surface bulges outwards here: material fills less than half of the space around the edge.
    pub convex: bool,
}

impl<S: Surface> PatchSet<S> {
    /// Edges at which the normal turns by more than `angle` (radians), with the present sides. Creases inside a patch are not
    /// among them.
    pub fn sharp_edges(&self, angle: f64) -> Vec<SharpEdge> {
        let mut out = Vec::new();
        for (index, edge) in self.topology.edges.iter().enumerate() {
            for link in edge.links.iter().filter(|l| l.kind == EdgeKind::Sharp) {
                let [start, end] = link.own;
                let at = |part: f64| edge_point(self, edge, start + (end - start) * part);
                let (mut largest, mut convex) = (0.0, false);
                for point in PLACES.map(at) {
                    let own = self.normal_near(edge.patch, point.span, point.xi);
                    // Into the patch, along its tangent plane.
                    let inward = own.cross(&point.d1) * edge.sense;
                    for (other, foot) in self.behind(index, point.t, &point.jet.rho) {
                        let patch = self.topology.edges[other.edge].patch;
                        let behind = self.normal_near(patch, foot.span, foot.xi) * other.relation;
                        let turn = own.cross(&behind).norm().atan2(own.dot(&behind));
                        if turn > largest {
                            largest = turn;
                            let side = self.sides[edge.patch as usize];
                            convex = side * behind.dot(&inward) < 0.0;
                        }
                    }
                }
                if largest <= angle {
                    continue;
                }
                let inner = edge.samples.iter().filter(|s| s.t > start && s.t < end);
                let ends = [at(0.0), at(1.0)].map(|p| p.jet.rho);
                let points = ([ends[0]].into_iter())
                    .chain(inner.map(|s| s.point))
                    .chain([ends[1]])
                    .collect();
                out.push(SharpEdge {
                    patch: edge.patch,
                    points,
                    angle: largest,
                    convex,
                });
            }
        }
        out
    }
}
