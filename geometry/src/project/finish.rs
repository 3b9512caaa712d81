//! From the winner of the search to a foot: last Newton steps, location, normal and sign.

use std::f64::consts::PI;

use super::local::{Local, Region, TrimPlace};
use super::set::{PatchSet, SHARP_ANGLE};
use super::topology::{
    Edge, EdgeCurve, EdgePoint, Link, corner_at, edge_point, edges_at, nearest_on_edge,
};
use super::{EdgeKind, Foot, Location, Status};
use crate::frame::Frame;
use crate::surface::{Surface, Vec3};

/// Most patches that the winner of a search is moved through at the end.
const HOPS: usize = 4;
/// A foot that its edge holds by less than this (relative) counts as lying on the face.
const HELD: f64 = 1e-10;

impl<S: Surface> PatchSet<S> {
    pub(super) fn finish(&self, q: &Vec3, rough: Local, complete: bool) -> Foot {
        self.finish_within(q, rough, complete, HOPS)
    }

    /// [`finish`](Self::finish) that moves on over at most `hops` borders.
    pub(super) fn finish_within(
        &self,
        q: &Vec3,
        rough: Local,
        complete: bool,
        hops: usize,
    ) -> Foot {
        // The search may have stopped at the border of a piece, which is none of the surface's.
        let region = self.region(rough.region.patch, rough.span);
        let start = if rough.trim.is_some() || rough.region == region {
            rough
        } else {
            self.state(q, &region, rough.xi, rough.span)
        };
        let mut best = self.polish(q, start);
        if best.at != [0, 0] || best.trim.is_some() {
            best = self.cross(q, best, hops);
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
    fn cross(&self, q: &Vec3, mut best: Local, hops: usize) -> Local {
        for _ in 0..hops {
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
            if best.trim.is_some() {
                let region = self.region(best.region.patch, best.span);
                consider(self.polish(q, self.state(q, &region, best.xi, best.span)));
            }
            for (region, xi, span) in self.beside(&best) {
                consider(self.polish(q, self.state(q, &region, xi, span)));
            }
            for (edge, t) in self.edges_under(&best).into_iter().flatten() {
                for (link, start) in self.behind(edge, t, &best.jet.rho) {
                    let patch = self.topology.edges[link.edge].patch;
                    let region = self.region(patch, start.span);
                    let entry = self.state(q, &region, start.xi, start.span);
                    let inside = self.polish(q, entry);
                    consider(inside);
                    // What the trim stopped may have gone far astray: along the edge is safe.
                    if let (Some(place), true) =
                        (self.place(link.edge, start.t), inside.trim.is_some())
                    {
                        let trim = Some(place);
                        consider(self.polish(q, Local { trim, ..entry }));
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

    /// A parameter of a trim curve as a place on the trim.
    fn place(&self, edge: usize, t: f64) -> Option<TrimPlace> {
        let edge = &self.topology.edges[edge];
        let [start, last] = edge.interval;
        matches!(edge.curve, EdgeCurve::Trim { .. }).then(|| TrimPlace {
            curve: edge.number - 4,
            t,
            end: i8::from(t >= last) - i8::from(t <= start),
            focal: false,
        })
    }

    /// The points on the other side of an edge at its parameter `t`, which is the space point `rho`.
    fn behind<'a>(
        &'a self,
        edge: usize,
        t: f64,
        rho: &'a Vec3,
    ) -> impl Iterator<Item = (&'a Link, EdgePoint)> + 'a {
        let links = self.topology.edges[edge].links_at(t);
        links.filter_map(move |link| {
            let at = nearest_on_edge(self, rho, &self.topology.edges[link.edge]);
            ((at.jet.rho - rho).norm() <= link.reach).then_some((link, at))
        })
    }

    /// Indices and parameters of the edges that a point lies on: of an untrimmed patch one for each direction, of a trimmed
    /// one the trim curve and, at its end, the one that meets it there.
    fn edges_under(&self, s: &Local) -> [Option<(usize, f64)>; 2] {
        let patch = s.region.patch;
        let first = self.topology.first[patch as usize];
        let edges = self.topology.of(patch);
        if !is_trimmed(edges) {
            return [0, 1].map(|k| Some((first + self.edge_of(s, k)?, s.xi[1 - k])));
        }
        if let Some(place) = s.trim {
            let local = place.curve as usize;
            let Some(edge) = edges.get(local) else {
                return [None; 2];
            };
            let meets = match place.end {
                0 => None,
                end => {
                    let corner = corner_at(edges, local, usize::from(end > 0));
                    let ends = edges_at(edges, corner);
                    let other = ends
                        .into_iter()
                        .find(|e| *e != (local, usize::from(end > 0)));
                    other.map(|(k, end)| (first + k, edges[k].interval[end]))
                }
            };
            let t = place.t.clamp(edge.interval[0], edge.interval[1]);
            return [Some((first + local, t)), meets];
        }
        // On the border of the domain, which a trim curve follows if the point belongs to the surface.
        if (0..2).all(|k| self.edge_of(s, k).is_none()) {
            return [None; 2];
        }
        let near = edges.iter().enumerate().map(|(k, e)| {
            let at = nearest_on_edge(self, &s.jet.rho, e);
            ((at.jet.rho - s.jet.rho).norm_squared(), k, at.t)
        });
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
        let limit = 1e-9 * self.size;
        [
            nearest
                .filter(|n| n.0 <= limit * limit)
                .map(|(_, k, t)| (first + k, t)),
            None,
        ]
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
        if is_trimmed(self.topology.of(s.region.patch)) && on[0].is_some() {
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
                let index = self.topology.index(patch, edge);
                let on = self.edges_under(s).into_iter().flatten();
                if let Some((index, t)) = on.into_iter().find(|on| Some(on.0) == index) {
                    let edge = &self.topology.edges[index];
                    // Where corners of other patches lie on the edge, their angles count.
                    let margin = edge.margin(2.0 * self.tolerance);
                    let vertex = edge.vertices.iter().find(|v| (v.0 - t).abs() <= margin);
                    if let Some((_, group)) = vertex {
                        sum = self.group_normal(*group);
                    } else {
                        for (link, at) in self.behind(index, t, &s.jet.rho) {
                            let patch = self.topology.edges[link.edge].patch;
                            let n = self.normal_near(patch, at.span, at.xi);
                            sum += n * self.sides[patch as usize];
                        }
                    }
                }
            }
            Location::Corner { corner, .. } => {
                let start = self.topology.of(patch).first().map_or(0, |e| e.number);
                let corner = corner.saturating_sub(start) as usize;
                let index = self.topology.first[patch as usize] + corner;
                sum = self.group_normal(self.topology.corners[index]);
            }
            Location::Crease { .. } => {
                sum = self.face_normal(s) * side;
                for (_, xi, span) in self.beside(s) {
                    sum += self.normal_near(patch, span, xi) * side;
                }
            }
            Location::Pole { edge } => {
                if let Some(index) = self.topology.index(patch, edge) {
                    let edge = &self.topology.edges[index];
                    let [a, b] = edge.interval;
                    for k in 0..4 * edge.samples.len() {
                        let t = (k as f64 + 0.5) / (4 * edge.samples.len()) as f64;
                        let at = edge_point(self, edge, a + (b - a) * t);
                        sum += self.normal_near(patch, at.span, at.xi) * side;
                    }
                }
            }
        }
        sum.try_normalize(1e-12)
            .unwrap_or_else(|| self.face_normal(s) * side)
    }

    /// Outward normal of a point where corners meet, not normalised.
    fn group_normal(&self, group: u32) -> Vec3 {
        let mut sum = Vec3::zeros();
        let group = &self.topology.groups[group as usize];
        for &(patch, corner) in &group.corners {
            sum += self.corner_normal(patch, corner as usize) * self.sides[patch as usize];
        }
        for &(index, t) in &group.through {
            let edge = &self.topology.edges[index];
            let at = edge_point(self, edge, t);
            let n = self.normal_near(edge.patch, at.span, at.xi);
            sum += n * (self.sides[edge.patch as usize] * PI);
        }
        sum
    }

    /// Normal of a patch at its corner, times the angle of the patch there.
    fn corner_normal(&self, patch: u32, corner: usize) -> Vec3 {
        let edges = self.topology.of(patch);
        let ends = edges_at(edges, corner);
        let at = ends.map(|(k, end)| edge_point(self, &edges[k], edges[k].interval[end]));
        let n = self.normal_near(patch, at[0].span, at[0].xi);
        let [a, b] = [0, 1].map(|k| departure(&at[k], &edges[ends[k].0], ends[k].1));
        // With the surface on the left of the first edge, the angle goes from it counterclockwise to the other.
        let (first, end) = ends[0];
        let left = edges[first].sense * if end == 0 { 1.0 } else { -1.0 };
        let angle = (a.cross(&b).dot(&n) * left).atan2(a.dot(&b));
        n * if angle < -1e-9 {
            angle + 2.0 * PI
        } else {
            angle.max(0.0)
        }
    }
}

/// Whether edges are trim curves.
fn is_trimmed(edges: &[Edge]) -> bool {
    matches!(
        edges.first(),
        Some(Edge {
            curve: EdgeCurve::Trim { .. },
            ..
        })
    )
}

/// Unit direction in which an edge leaves one of its ends; zero where the edge is a point.
fn departure(at: &EdgePoint, edge: &Edge, end: usize) -> Vec3 {
    let along = if end == 0 { at.d1 } else { -at.d1 };
    let span = edge.interval[1] - edge.interval[0];
    if along.norm() * span > 1e-6 * edge.length {
        return along.normalize();
    }
    // A tangent of no length: the first chord of the polyline that has some.
    let samples = &edge.samples;
    let far = |p: &Vec3| (p - at.jet.rho).norm() > 1e-6 * edge.length;
    let next = if end == 0 {
        samples.iter().map(|s| s.point).find(|p| far(p))
    } else {
        samples.iter().rev().map(|s| s.point).find(|p| far(p))
    };
    next.and_then(|p| (p - at.jet.rho).try_normalize(0.0))
        .unwrap_or_else(Vec3::zeros)
}

/// Whether the Hessian over the metric has an eigenvalue of (nearly) zero in the free directions: `1 - xi3 kappa` of
/// one of the principal curvatures.
fn focal(s: &Local) -> bool {
    if let Some(place) = s.trim {
        return place.focal;
    }
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
