//! Sharp edges of a set, and its borders, as points along them.

use super::EdgeKind;
use super::set::PatchSet;
use super::topology::{Link, edge_point};
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

/// A line along which a surface ends, or turns away from what it faces: a free border or a sharp convex edge. A sharp tip is one of no
/// length.
#[derive(Debug, Clone, PartialEq)]
pub struct Rim {
    /// Number of the patch; of an edge that two patches share that of one of them.
    pub patch: u32,
    /// Points on the line, in the middle of pieces of equal length; at least one.
    pub points: Vec<RimPoint>,
    /// Length of a piece; of a tip that which was asked for.
    pub piece: f64,
    /// Whether the surface ends here.
    pub free: bool,
}

/// A point of a [`Rim`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimPoint {
    /// Where it lies.
    pub x: Vec3,
    /// A tangent of the line; zero at a tip.
    pub along: Vec3,
    /// Outward unit normals on both sides; twice the same on a free border, those farthest apart at a tip.
    pub normals: [Vec3; 2],
}

/// How far the normal turns from one side of a joint to the other.
pub(super) struct Turn {
    /// Largest angle at the places measured (radians).
    pub angle: f64,
    convex: bool,
}

impl<S: Surface> PatchSet<S> {
    /// Edges at which the normal turns by more than `angle` (radians), with the present sides. Creases inside a patch are not
    /// among them.
    pub fn sharp_edges(&self, angle: f64) -> Vec<SharpEdge> {
        let mut out = Vec::new();
        for (index, edge) in self.topology.edges.iter().enumerate() {
            for link in edge.links.iter().filter(|l| l.kind == EdgeKind::Sharp) {
                let turn = self.turn(index, link);
                if turn.angle <= angle {
                    continue;
                }
                out.push(SharpEdge {
                    patch: edge.patch,
                    points: self.polyline(index, link.own),
                    angle: turn.angle,
                    convex: turn.convex,
                });
            }
        }
        out
    }

    /// Free borders: the patch of each, and the ends of straight lines that follow it.
    pub fn free_borders(&self) -> Vec<(u32, Vec<Vec3>)> {
        let edges = self.topology.edges.iter().enumerate();
        let open = edges.filter(|(_, edge)| edge.kind.is_some());
        open.flat_map(|(index, edge)| {
            let parts = edge.free_parts().into_iter();
            parts.map(move |part| (edge.patch, self.polyline(index, part)))
        })
        .collect()
    }

    /// Points along a part of the edge `index`, with its ends.
    fn polyline(&self, index: usize, [start, end]: [f64; 2]) -> Vec<Vec3> {
        let edge = &self.topology.edges[index];
        let at = |t: f64| edge_point(self, edge, t).jet.rho;
        let inner = edge.samples.iter().filter(|s| s.t > start && s.t < end);
        ([at(start)].into_iter())
            .chain(inner.map(|s| s.point))
            .chain([at(end)])
            .collect()
    }

    /// Free borders, and convex edges at which the normal turns by more than `angle` (radians) with the present sides, each once,
    /// as pieces no longer than `spacing` (length), and [`tips`](Self::tips). Creases inside a patch are not among them.
    pub fn rims(&self, angle: f64, spacing: f64) -> Vec<Rim> {
        let mut out = Vec::new();
        for (index, edge) in self.topology.edges.iter().enumerate() {
            if edge.kind.is_none() {
                continue;
            }
            let sharp = edge.links.iter().filter(|l| {
                // The other patch has it as well.
                let first = l.kind == EdgeKind::Sharp && index <= l.edge;
                let sharp = |turn: Turn| turn.convex && turn.angle > angle;
                first && sharp(self.turn(index, l))
            });
            let sharp = sharp.map(|l| (l.own, false));
            let free = edge.free_parts().into_iter().map(|part| (part, true));
            for (part, free) in sharp.chain(free) {
                let length = edge.length_between(part);
                // What joints leave at their ends.
                if length > 1e-3 * edge.length {
                    let pieces = (length / spacing).ceil().max(1.0);
                    out.push(Rim {
                        patch: edge.patch,
                        points: self.along(index, part, pieces as usize),
                        piece: length / pieces,
                        free,
                    });
                }
            }
        }
        out.extend(self.tips(angle).into_iter().map(|tip| Rim {
            patch: tip.patches[0],
            points: vec![RimPoint {
                x: tip.x,
                along: Vec3::zeros(),
                normals: tip.normals,
            }],
            piece: spacing,
            free: false,
        }));
        out
    }

    /// The middles of so many pieces of a part of the edge `index`, all of about the same length.
    fn along(&self, index: usize, part: [f64; 2], pieces: usize) -> Vec<RimPoint> {
        let edge = &self.topology.edges[index];
        let [start, end] = part;
        let each = edge.length_between(part) / pieces as f64;
        let side = self.sides[edge.patch as usize];
        let at = |t: f64| {
            let point = edge_point(self, edge, t);
            let own = self.normal_near(edge.patch, point.span, point.xi);
            let behind = self.behind(index, t, &point.jet.rho).next();
            let other = behind.map_or(own, |(link, foot)| {
                let patch = self.topology.edges[link.edge].patch;
                self.normal_near(patch, foot.span, foot.xi) * link.relation
            });
            RimPoint {
                x: point.jet.rho,
                along: point.d1,
                normals: [own, other].map(|n| n * side),
            }
        };
        let mut out: Vec<RimPoint> = Vec::with_capacity(pieces);
        let mut walked = 0.0;
        for chord in edge.samples.windows(2) {
            let [from, to] = [chord[0].t.max(start), chord[1].t.min(end)];
            if to <= from {
                continue;
            }
            let length = edge.length_between([from, to]);
            let next = |out: &Vec<RimPoint>| (out.len() as f64 + 0.5) * each;
            while out.len() < pieces && next(&out) <= walked + length {
                let part = (next(&out) - walked) / length;
                out.push(at(from + part * (to - from)));
            }
            walked += length;
        }
        out
    }

    /// How far the normal turns at a joint of the edge `index`.
    pub(super) fn turn(&self, index: usize, link: &Link) -> Turn {
        let edge = &self.topology.edges[index];
        let [start, end] = link.own;
        let at = |part: f64| edge_point(self, edge, start + (end - start) * part);
        let mut turn = Turn {
            angle: 0.0,
            convex: false,
        };
        for point in PLACES.map(at) {
            let own = self.normal_near(edge.patch, point.span, point.xi);
            // Into the patch, along its tangent plane.
            let inward = own.cross(&point.d1) * edge.sense;
            for (other, foot) in self.behind(index, point.t, &point.jet.rho) {
                let patch = self.topology.edges[other.edge].patch;
                let behind = self.normal_near(patch, foot.span, foot.xi) * other.relation;
                let angle = own.cross(&behind).norm().atan2(own.dot(&behind));
                if angle > turn.angle {
                    let side = self.sides[edge.patch as usize];
                    turn = Turn {
                        angle,
                        convex: side * behind.dot(&inward) < 0.0,
                    };
                }
            }
        }
        turn
    }
}
