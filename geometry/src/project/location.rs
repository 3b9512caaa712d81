//! Where a foot lies: on a face, an edge, a corner, a crease or a pole.

use super::local::Local;
use super::normals::departure;
use super::set::{PatchSet, SHARP_ANGLE};
use super::topology::{corner_at, edge_point, edges_at};
use super::{EdgeKind, Location};
use crate::frame::Frame;
use crate::surface::{Surface, Vec3};

/// A foot that its edge holds by less than this (relative) counts as lying on the face.
const HELD: f64 = 1e-10;

impl<S: Surface> PatchSet<S> {
    /// Location of a finished point.
    pub(super) fn locate(&self, s: &Local) -> Location {
        if s.at == [0, 0] && s.trim.is_none() {
            return Location::Face;
        }
        let on = self.edges_under(s);
        if s.at == [0, 0] && on[0].is_none() {
            return Location::Face;
        }
        let edges = &self.topology.edges;
        let pole = |on: &&(usize, f64)| edges[on.0].kind.is_none();
        if let Some((edge, _)) = on.iter().flatten().find(pole) {
            let edge = edges[*edge].number;
            return Location::Pole { edge };
        }
        if self.patches[s.region.patch as usize].trim().is_some() && on[0].is_some() {
            return self.locate_on_trim(s, on);
        }
        // Held from how many directions, and by what.
        let limit = HELD * HELD * s.d2.max(self.size * self.size);
        let held = |k: usize| s.gradient[k] * s.gradient[k] > limit * s.metric[2 * k];
        match on {
            [Some(a), Some(b)] => {
                let corner = (u32::from(s.at[0] > 0)) | (u32::from(s.at[1] > 0) << 1);
                // Along an edge that does not hold it, a corner is a point of the other edge.
                match (held(0), held(1)) {
                    (false, false) => Location::Face,
                    (true, false) => self.edge_location(s, a),
                    (false, true) => self.edge_location(s, b),
                    (true, true) => self.corner_location(s.region.patch, corner as usize, corner),
                }
            }
            [Some(a), None] if held(0) => self.edge_location(s, a),
            [None, Some(b)] if held(1) => self.edge_location(s, b),
            _ => {
                let grid = &self.grids[s.region.patch as usize];
                let crease = |k: usize| {
                    let border = match s.at[k] {
                        -1 => s.region.spans[k][0],
                        1 => s.region.spans[k][1],
                        _ => return false,
                    };
                    on[k].is_none() && held(k) && grid.kinks[k][border] == 2
                };
                match (crease(0), crease(1)) {
                    (true, _) => Location::Crease { dir: 0 },
                    (_, true) => Location::Crease { dir: 1 },
                    _ => Location::Face,
                }
            }
        }
    }

    /// Location of a point on a trim curve. The curve holds it where the distance would fall across it.
    fn locate_on_trim(&self, s: &Local, on: [Option<(usize, f64)>; 2]) -> Location {
        let edges = &self.topology.edges;
        let n = self.face_normal(s);
        // q - rho without its part along the normal; the gradient is its product with the tangents.
        let d = match Frame::new(&s.jet, 1.0) {
            Some(frame) => {
                let up = frame.rho_up();
                -(up[0] * s.gradient[0] + up[1] * s.gradient[1])
            }
            None => Vec3::zeros(),
        };
        let limit = HELD * s.d2.sqrt().max(self.size);
        if d.norm() <= limit {
            return Location::Face;
        }
        let [Some(one), other] = on else {
            return Location::Face;
        };
        let Some(other) = other else {
            return self.edge_location(s, one);
        };
        // Directions in which the two edges leave the corner.
        let away = [one, other].map(|(k, t)| {
            let edge = &edges[k];
            let at_end = usize::from(t == edge.interval[1]);
            departure(&edge_point(self, edge, t), edge, at_end)
        });
        let turn = away[0].cross(&away[1]).norm().atan2(-away[0].dot(&away[1]));
        let pulls = [0, 1].map(|k| d.dot(&away[k]).abs() > limit);
        // Where the border runs on smoothly, or only one edge holds the point, it is a point of an edge.
        match pulls {
            _ if turn <= SHARP_ANGLE => self.edge_location(s, one),
            [false, true] => self.edge_location(s, one),
            [true, false] => self.edge_location(s, other),
            _ if n == Vec3::zeros() => self.edge_location(s, one),
            _ => {
                let patch = s.region.patch;
                let of = self.topology.of(patch);
                let first = self.topology.first[patch as usize];
                let (k, t) = one;
                let end = usize::from(t == edges[k].interval[1]);
                let corner = corner_at(of, k - first, end);
                self.corner_location(patch, corner, of[corner].number)
            }
        }
    }

    /// Location of a point that an edge holds; where the surface runs on smoothly it lies on the face.
    fn edge_location(&self, s: &Local, (index, t): (usize, f64)) -> Location {
        let edge = &self.topology.edges[index];
        let kind = match edge.kind_at(t) {
            None => return Location::Pole { edge: edge.number },
            Some(EdgeKind::Sharp) => self.kind_here(s, index, t),
            Some(kind) => kind,
        };
        match kind {
            EdgeKind::Smooth => Location::Face,
            kind => Location::Edge {
                edge: edge.number,
                kind,
            },
        }
    }

    /// Smooth or sharp by the normals at the very point: a joint may be sharp in a part of it only.
    fn kind_here(&self, s: &Local, index: usize, t: f64) -> EdgeKind {
        let n = self.face_normal(s);
        for (link, at) in self.behind(index, t, &s.jet.rho) {
            let patch = self.topology.edges[link.edge].patch;
            let m = self.normal_near(patch, at.span, at.xi) * link.relation;
            if m.cross(&n).norm().atan2(m.dot(&n)) > SHARP_ANGLE {
                return EdgeKind::Sharp;
            }
        }
        EdgeKind::Smooth
    }

    /// Location at a corner, `corner` counted from zero on the patch.
    fn corner_location(&self, patch: u32, corner: usize, number: u32) -> Location {
        match self.corner_kind(patch, corner) {
            EdgeKind::Smooth => Location::Face,
            kind => Location::Corner {
                corner: number,
                kind,
            },
        }
    }

    /// What meets at a corner.
    fn corner_kind(&self, patch: u32, corner: usize) -> EdgeKind {
        let group = self.topology.corners[self.topology.first[patch as usize] + corner];
        let mut worst = EdgeKind::Smooth;
        for &(patch, corner) in &self.topology.groups[group as usize].corners {
            let edges = self.topology.of(patch);
            for (edge, end) in edges_at(edges, corner as usize) {
                match edges[edge].kind_at(edges[edge].interval[end]) {
                    Some(EdgeKind::Free) => return EdgeKind::Free,
                    Some(EdgeKind::Sharp) => worst = EdgeKind::Sharp,
                    _ => {}
                }
            }
        }
        worst
    }
}
