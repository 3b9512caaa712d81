//! Normals of feet: of faces, and pseudo-normals at edges, corners, creases and poles.

use std::f64::consts::PI;

use super::Location;
use super::local::Local;
use super::set::PatchSet;
use super::topology::{Edge, EdgeCurve, EdgePoint, corner_at, edge_point, edges_at};
use crate::frame::DEGENERATE;
use crate::surface::{Jet, Surface, Vec3};

impl<S: Surface> PatchSet<S> {
    /// Unit normal `rho_1 x rho_2` of the patch, from a little inside where the tangents do not span a plane.
    pub(super) fn face_normal(&self, s: &Local) -> Vec3 {
        unit_normal(&s.jet).unwrap_or_else(|| self.normal_near(s.region.patch, s.span, s.xi))
    }

    /// Unit normal of a patch at `xi` or, where it does not exist there, a little towards the middle of the span. Zero
    /// where the patch has none anywhere near.
    pub(super) fn normal_near(&self, patch: u32, span: [usize; 2], xi: [f64; 2]) -> Vec3 {
        let grid = &self.grids[patch as usize];
        for step in [0.0, 1e-7, 1e-5, 1e-3, 0.1] {
            let x = [0, 1].map(|k| {
                let middle = 0.5 * (grid.breaks[k][span[k]] + grid.breaks[k][span[k] + 1]);
                xi[k] + step * (middle - xi[k])
            });
            let jet = self.patches[patch as usize].jet_in_span(span, x);
            if let Some(n) = unit_normal(&jet) {
                return n;
            }
        }
        Vec3::zeros()
    }

    /// Outward pseudo-normal off the faces: at edges and creases the mean of the faces' normals, at corners weighted with
    /// the faces' angles (J. A. Baerentzen and H. Aanaes, "Signed distance computation using the angle weighted
    /// pseudonormal", IEEE TVCG 11, 2005), at poles by the angle around the point.
    #[cold]
    #[inline(never)]
    pub(super) fn pseudo_normal(&self, s: &Local, location: Location) -> Vec3 {
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
                // What else meets there counts as well: the other half of a cone, or the plane that halves it.
                let corner = self.topology.index(patch, edge).map(|index| {
                    let first = self.topology.first[patch as usize];
                    let edges = self.topology.of(patch);
                    first + corner_at(edges, index - first, 0)
                });
                if let Some(corner) = corner {
                    sum = self.group_normal(self.topology.corners[corner]);
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
            let edges = self.topology.of(patch);
            let ends = edges_at(edges, corner as usize);
            let side = self.sides[patch as usize];
            if ends.iter().all(|e| edges[e.0].kind.is_some()) {
                sum += self.corner_normal(patch, corner as usize) * side;
            }
            // A pole has two corners, of which one is where it starts.
            for (edge, _) in ends
                .into_iter()
                .filter(|e| edges[e.0].kind.is_none() && e.1 == 0)
            {
                sum += self.pole_normal(&edges[edge]) * side;
            }
        }
        for &(index, t) in &group.through {
            let edge = &self.topology.edges[index];
            let at = edge_point(self, edge, t);
            let n = self.normal_near(edge.patch, at.span, at.xi);
            sum += n * (self.sides[edge.patch as usize] * PI);
        }
        sum
    }

    /// The normals of a patch around its pole, times the angles between the directions in which it leaves it.
    fn pole_normal(&self, edge: &Edge) -> Vec3 {
        let surface = &self.patches[edge.patch as usize];
        let grid = &self.grids[edge.patch as usize];
        let [a, b] = edge.interval;
        let count = (4 * edge.samples.len()).min(32);
        let at = |s: f64| edge_point(self, edge, a + (b - a) * s);
        let leaves = |s: f64| {
            let at = at(s);
            let inside = [0, 1].map(|k| {
                let [from, to] = [0, 1].map(|end| grid.breaks[k][at.span[k] + end]);
                let middle = 0.5 * (from + to);
                // Along the pole the direction is that of `s`.
                match edge.curve {
                    EdgeCurve::Side { dir, .. } if k != dir => at.xi[k],
                    _ => at.xi[k] + 1e-4 * (middle - at.xi[k]),
                }
            });
            let x = surface.jet_in_span(at.span, inside).rho;
            (x - at.jet.rho).try_normalize(0.0).unwrap_or_default()
        };
        let mut sum = Vec3::zeros();
        let mut before = leaves(0.0);
        for k in 0..count {
            let after = leaves((k + 1) as f64 / count as f64);
            let angle = before.cross(&after).norm().atan2(before.dot(&after));
            let middle = at((k as f64 + 0.5) / count as f64);
            sum += self.normal_near(edge.patch, middle.span, middle.xi) * angle;
            before = after;
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

/// The normal alone of [`Frame::new`](crate::Frame::new), where that gives a frame.
#[inline]
fn unit_normal(jet: &Jet) -> Option<Vec3> {
    let [r1, r2] = &jet.rho_i;
    let cross = r1.cross(r2);
    let area = cross.norm_squared().sqrt();
    let largest = r1.norm_squared().max(r2.norm_squared());
    (area > DEGENERATE * largest && area.is_finite() && largest.is_finite())
        .then(|| cross * area.recip())
}

/// Unit direction in which an edge leaves one of its ends; zero where the edge is a point.
pub(super) fn departure(at: &EdgePoint, edge: &Edge, end: usize) -> Vec3 {
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
