//! From the winner of the search to a foot: last Newton steps, location, normal and sign.

use super::local::{Local, Region};
use super::set::PatchSet;
use super::topology::{Link, nearest_on_edge};
use super::{EdgeKind, Foot, Location, Status};
use crate::frame::Frame;
use crate::surface::{Surface, Vec3};

/// A foot that its edge holds by less than this (relative) counts as lying on the face.
const HELD: f64 = 1e-10;

impl<S: Surface> PatchSet<S> {
    pub(super) fn finish(&self, q: &Vec3, rough: Local, complete: bool) -> Foot {
        // The search may have stopped at the border of a piece, which is none of the surface's.
        let region = self.region(rough.region.patch, rough.span);
        let start = if rough.region == region {
            rough
        } else {
            self.state(q, &region, rough.xi, rough.span)
        };
        let mut best = self.polish(q, start);
        if best.at != [0, 0] {
            best = self.cross(q, best);
        }
        if let Some(turn) = self.near_pole(&best) {
            best = self.snap_to_pole(q, best, turn);
        }
        let patch = best.region.patch;
        let side = self.sides[patch as usize];
        let location = self.locate(&best);
        let d = q - best.jet.rho;
        let normal = match location {
            Location::Face => self.face_normal(&best) * side,
            _ => self.pseudo_normal(&best, location),
        };
        let distance = best.d2.sqrt();
        let signed_distance = if d.dot(&normal) < 0.0 {
            -distance
        } else {
            distance
        };
        let pole = matches!(location, Location::Pole { .. });
        // At a centre of curvature the equations are singular and their residual says little.
        let status = if !complete {
            Status::NotConverged
        } else if !pole && focal(&best) {
            Status::NonUnique
        } else if !best.converged {
            Status::NotConverged
        } else {
            Status::Unique
        };
        Foot {
            patch,
            xi: best.xi,
            location,
            status,
            jet: best.jet,
            side,
            distance,
            signed_distance,
            normal,
        }
    }

    /// Moves a point next to a pole, where the turning parameter is lost in rounding, onto it if that is no farther from
    /// `q` by more than 1e-12 of the size.
    #[cold]
    #[inline(never)]
    fn snap_to_pole(&self, q: &Vec3, s: Local, turn: usize) -> Local {
        let out = 1 - turn;
        let mut xi = s.xi;
        let [a, b] = s.region.domain[out];
        xi[out] = if xi[out] - a < b - xi[out] { a } else { b };
        let mut t = self.state(q, &s.region, xi, s.span);
        if t.metric[2 * turn] <= s.metric[2 * turn]
            && t.d2.sqrt() <= s.d2.sqrt() + 1e-12 * self.size
        {
            t.converged = true;
            t
        } else {
            s
        }
    }

    /// From a point on a border of its region, looks whether the regions behind the border hold a nearer point: the
    /// proofs of the search leave out 1e-11 of the size, which is little as a distance and 1e-6 as a place.
    #[cold]
    #[inline(never)]
    fn cross(&self, q: &Vec3, mut best: Local) -> Local {
        for _ in 0..4 {
            let mut nearer: Option<Local> = None;
            let mut consider = |t: Local| {
                let now = nearer.as_ref().map_or(best.d2, |n| n.d2);
                // Equally near but not held by its border is better: next to a pole the distance hardly tells how far
                // round the foot lies.
                let free = best.active != [false; 2] && t.active == [false; 2] && t.converged;
                if t.d2 < now * (1.0 - 1e-15) || free && t.d2 <= now * (1.0 + 1e-15) {
                    nearer = Some(t);
                }
            };
            for (region, xi, span) in self.beside(&best) {
                consider(self.polish(q, self.state(q, &region, xi, span)));
            }
            for k in 0..2 {
                for link in self.links(&best, k) {
                    let start = nearest_on_edge(self, &best.jet.rho, link.patch, link.edge);
                    if (start.jet.rho - best.jet.rho).norm() <= 2.0 * self.tolerance {
                        let region = self.region(link.patch, start.span);
                        let start = self.state(q, &region, start.xi, start.span);
                        consider(self.polish(q, start));
                    }
                }
            }
            match nearer {
                Some(t) => best = t,
                None => break,
            }
        }
        best
    }

    /// Regions of the same patch behind the inner borders that a point lies on, with the point's parameters there.
    fn beside(&self, s: &Local) -> impl Iterator<Item = (Region, [f64; 2], [usize; 2])> + '_ {
        let patch = s.region.patch;
        let grid = &self.grids[patch as usize];
        let (at, xi, home) = (s.at, s.xi, s.region.spans);
        let own = s.span;
        [[true, false], [false, true], [true, true]]
            .into_iter()
            .filter_map(move |go| {
                let mut span = own;
                for k in 0..2 {
                    if !go[k] {
                        continue;
                    }
                    span[k] = match at[k] {
                        -1 if home[k][0] > 0 => home[k][0] - 1,
                        1 if home[k][1] < grid.spans[k] => home[k][1],
                        _ => return None,
                    };
                }
                Some((self.region(patch, span), xi, span))
            })
    }

    /// Links of the patch edge that a point lies on in direction `dir`.
    fn links(&self, s: &Local, dir: usize) -> &[Link] {
        match self.edge_of(s, dir) {
            Some(edge) => &self.topology.edges[s.region.patch as usize][edge].links,
            None => &[],
        }
    }

    /// Number of the patch edge that a point lies on in direction `dir`.
    fn edge_of(&self, s: &Local, dir: usize) -> Option<usize> {
        let grid = &self.grids[s.region.patch as usize];
        match s.at[dir] {
            -1 if s.region.spans[dir][0] == 0 => Some(2 * dir),
            1 if s.region.spans[dir][1] == grid.spans[dir] => Some(2 * dir + 1),
            _ => None,
        }
    }

    fn locate(&self, s: &Local) -> Location {
        if s.at == [0, 0] {
            return Location::Face;
        }
        let edges = &self.topology.edges[s.region.patch as usize];
        let on = [self.edge_of(s, 0), self.edge_of(s, 1)];
        if let Some(edge) = on.iter().flatten().find(|&&e| edges[e].kind.is_none()) {
            return Location::Pole { edge: *edge as u32 };
        }
        // Held from how many directions, and by what.
        let limit = HELD * HELD * s.d2.max(self.size * self.size);
        let held = |k: usize| s.gradient[k] * s.gradient[k] > limit * s.metric[2 * k];
        let kind = |k: usize| on[k].and_then(|e| edges[e].kind);
        match (kind(0), kind(1)) {
            (Some(a), Some(b)) => {
                let corner = (u32::from(s.at[0] > 0)) | (u32::from(s.at[1] > 0) << 1);
                // Along an edge that does not hold it, a corner is a point of the other edge.
                match (held(0), held(1)) {
                    (false, false) => Location::Face,
                    (true, false) => edge_location(on[0], a),
                    (false, true) => edge_location(on[1], b),
                    (true, true) => match self.corner_kind(s.region.patch, corner) {
                        EdgeKind::Smooth => Location::Face,
                        kind => Location::Corner { corner, kind },
                    },
                }
            }
            (Some(a), None) if held(0) => edge_location(on[0], a),
            (None, Some(b)) if held(1) => edge_location(on[1], b),
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

    /// What meets at a corner.
    fn corner_kind(&self, patch: u32, corner: u32) -> EdgeKind {
        let group = self.topology.corners[patch as usize][corner as usize];
        let mut worst = EdgeKind::Smooth;
        for &(patch, corner) in &self.topology.corner_groups[group as usize] {
            let edges = &self.topology.edges[patch as usize];
            for edge in [(corner & 1) as usize, 2 + (corner >> 1) as usize] {
                match edges[edge].kind {
                    Some(EdgeKind::Free) => return EdgeKind::Free,
                    Some(EdgeKind::Sharp) => worst = EdgeKind::Sharp,
                    _ => {}
                }
            }
        }
        worst
    }

    /// Unit normal `rho_1 x rho_2` of the patch, from a little inside where the tangents do not span a plane.
    fn face_normal(&self, s: &Local) -> Vec3 {
        match Frame::new(&s.jet, 1.0) {
            Some(frame) => frame.n,
            None => self.normal_near(s.region.patch, s.span, s.xi),
        }
    }

    /// Unit normal of a patch at `xi` or, where it does not exist there, a little towards the middle of the span. Zero
    /// where the patch has none anywhere near.
    fn normal_near(&self, patch: u32, span: [usize; 2], xi: [f64; 2]) -> Vec3 {
        let grid = &self.grids[patch as usize];
        for step in [0.0, 1e-7, 1e-5, 1e-3, 0.1] {
            let x = [0, 1].map(|k| {
                let middle = 0.5 * (grid.breaks[k][span[k]] + grid.breaks[k][span[k] + 1]);
                xi[k] + step * (middle - xi[k])
            });
            let jet = self.patches[patch as usize].jet_in_span(span, x);
            if let Some(frame) = Frame::new(&jet, 1.0) {
                return frame.n;
            }
        }
        Vec3::zeros()
    }

    /// Outward pseudo-normal off the faces: at edges and creases the mean of the faces' normals, at corners weighted with
    /// the faces' angles (J. A. Baerentzen and H. Aanaes, "Signed distance computation using the angle weighted
    /// pseudonormal", IEEE TVCG 11, 2005), at poles the mean around the point.
    #[cold]
    #[inline(never)]
    fn pseudo_normal(&self, s: &Local, location: Location) -> Vec3 {
        let patch = s.region.patch;
        let side = self.sides[patch as usize];
        let mut sum = Vec3::zeros();
        match location {
            Location::Face => sum = self.face_normal(s) * side,
            Location::Edge { edge, .. } => {
                sum = self.face_normal(s) * side;
                for link in &self.topology.edges[patch as usize][edge as usize].links {
                    let t = nearest_on_edge(self, &s.jet.rho, link.patch, link.edge);
                    if (t.jet.rho - s.jet.rho).norm() <= 2.0 * self.tolerance {
                        sum += self.face_normal(&t) * self.sides[link.patch as usize];
                    }
                }
            }
            Location::Corner { corner, .. } => {
                let group = self.topology.corners[patch as usize][corner as usize];
                for &(patch, corner) in &self.topology.corner_groups[group as usize] {
                    sum += self.corner_normal(patch, corner) * self.sides[patch as usize];
                }
            }
            Location::Crease { .. } => {
                sum = self.face_normal(s) * side;
                for (_, xi, span) in self.beside(s) {
                    sum += self.normal_near(patch, span, xi) * side;
                }
            }
            Location::Pole { edge } => {
                let group = (edge % 2) as usize;
                let dir = (edge / 2) as usize;
                let along = 1 - dir;
                let grid = &self.grids[patch as usize];
                for span in 0..grid.spans[along] {
                    let (a, b) = (grid.breaks[along][span], grid.breaks[along][span + 1]);
                    for k in 0..4 {
                        let mut spans = [0; 2];
                        spans[along] = span;
                        spans[dir] = if group == 0 { 0 } else { grid.spans[dir] - 1 };
                        let mut xi = s.xi;
                        xi[along] = a + (b - a) * (f64::from(k) + 0.5) / 4.0;
                        sum += self.normal_near(patch, spans, xi) * (side * (b - a));
                    }
                }
            }
        }
        sum.try_normalize(1e-12)
            .unwrap_or_else(|| self.face_normal(s) * side)
    }

    /// Normal of a patch at its corner, times the angle of the patch there.
    fn corner_normal(&self, patch: u32, corner: u32) -> Vec3 {
        let grid = &self.grids[patch as usize];
        let end = [corner & 1, corner >> 1].map(|b| b == 1);
        let span = [0, 1].map(|k| if end[k] { grid.spans[k] - 1 } else { 0 });
        let xi = [0, 1].map(|k| grid.breaks[k][if end[k] { grid.spans[k] } else { 0 }]);
        let jet = self.patches[patch as usize].jet_in_span(span, xi);
        let inward = |k: usize| jet.rho_i[k] * if end[k] { -1.0 } else { 1.0 };
        let (a, b) = (inward(0), inward(1));
        let angle = a.cross(&b).norm().atan2(a.dot(&b));
        self.normal_near(patch, span, xi) * angle
    }
}

fn edge_location(edge: Option<usize>, kind: EdgeKind) -> Location {
    match (edge, kind) {
        (Some(edge), EdgeKind::Sharp | EdgeKind::Free) => Location::Edge {
            edge: edge as u32,
            kind,
        },
        _ => Location::Face,
    }
}

/// Whether the Hessian over the metric has an eigenvalue of (nearly) zero in the free directions: `1 - xi3 kappa` of
/// one of the principal curvatures.
fn focal(s: &Local) -> bool {
    let (f, a) = (&s.hessian, &s.metric);
    let flat = |value: f64, largest: f64| value <= 1e-7 * largest.max(1.0);
    match s.active {
        [true, true] => false,
        [false, true] => a[0] > 0.0 && flat(f[0] / a[0], 0.0),
        [true, false] => a[2] > 0.0 && flat(f[2] / a[2], 0.0),
        [false, false] => {
            let det = a[0] * a[2] - a[1] * a[1];
            if det <= 1e-20 * a[0] * a[2] {
                return false;
            }
            let mean = 0.5 * (f[0] * a[2] - 2.0 * f[1] * a[1] + f[2] * a[0]) / det;
            let product = (f[0] * f[2] - f[1] * f[1]) / det;
            let half = (mean * mean - product).max(0.0).sqrt();
            flat(mean - half, mean + half)
        }
    }
}
