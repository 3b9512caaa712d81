//! Where a foot lies: on a face, an edge, a corner, a crease or a pole.

use super::local::Local;
use super::normals::departure;
use super::set::{PatchSet, SHARP_ANGLE};
use super::topology::{corner_at, edge_point, edges_at};
use super::{EdgeKind, Location};
use crate::frame::Frame;
use crate::surface::{Surface, Vec3};

/// A foot that its edge holds by less than this (relative) counts as lying on the face.
pub(super) const HELD: f64 = 1e-10;

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
        if self.is_on_surface(s) {
            return self.locate_on_surface(s, on);
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
                let crease = |k: usize| on[k].is_none() && held(k) && self.is_at_crease(s, k);
                match (crease(0), crease(1)) {
                    (true, _) => Location::Crease { dir: 0 },
                    (_, true) => Location::Crease { dir: 1 },
                    _ => Location::Face,
                }
            }
        }
    }

    /// Whether a foot is the query itself: then nothing holds it, and no slope tells an edge from the face beside it.
    #[inline]
    pub(super) fn is_on_surface(&self, s: &Local) -> bool {
        s.d2 <= HELD * HELD * self.size * self.size
    }

    /// Location of a query that lies on the border of a face: on the edge or the corner if that is sharp. A free border
    /// belongs to its face.
    fn locate_on_surface(&self, s: &Local, on: [Option<(usize, f64)>; 2]) -> Location {
        let edges = &self.topology.edges;
        let patch = s.region.patch;
        if let [Some((k, t)), Some(_)] = on {
            let first = self.topology.first[patch as usize];
            let end = usize::from(t == edges[k].interval[1]);
            let of = self.topology.of(patch);
            let corner = corner_at(of, k - first, end);
            let location = self.corner_location(patch, corner, of[corner].number);
            let sharp = EdgeKind::Sharp;
            if matches!(location, Location::Corner { kind, .. } if kind == sharp) {
                return location;
            }
        }
        let sharp = |at: (usize, f64)| match self.edge_location(s, at) {
            Location::Edge { kind, .. } if kind != EdgeKind::Sharp => None,
            Location::Face => None,
            location => Some(location),
        };
        let edge = on.into_iter().flatten().find_map(sharp);
        let crease = || (0..2).find(|&k| on[k].is_none() && self.is_at_crease(s, k));
        edge.or_else(|| crease().map(|dir| Location::Crease { dir: dir as u8 }))
            .unwrap_or(Location::Face)
    }

    /// Whether a point lies on an inner knot line that breaks the tangent plane.
    fn is_at_crease(&self, s: &Local, dir: usize) -> bool {
        let border = match s.at[dir] {
            -1 => s.region.spans[dir][0],
            1 => s.region.spans[dir][1],
            _ => return false,
        };
        self.grids[s.region.patch as usize].kinks[dir][border] == 2
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
