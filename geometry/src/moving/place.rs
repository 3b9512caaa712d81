//! Where a foot lies, and the normal there.

use super::local::Local;
use super::net;
use super::topology::{EDGES_AT, ENDS, corner_xi, on_edge};
use super::{MovingFacets, MovingPlace};
use crate::frame::DEGENERATE;
use crate::project::EdgeKind;
use crate::project::set::SHARP_ANGLE;
use crate::surface::{Jet, Vec3};

/// A foot that its edge holds by less than this (relative) counts as lying on the face.
const HELD: f64 = 1e-10;

impl MovingFacets {
    /// Place of a finished foot and the outward unit normal there: at edges the mean of the facets' normals, at corners
    /// weighted with the facets' angles (J. A. Baerentzen and H. Aanaes, "Signed distance computation using the angle
    /// weighted pseudonormal", IEEE TVCG 11, 2005).
    pub(super) fn place<const M: usize>(
        &self,
        facet: u32,
        s: &Local,
        accept: &dyn Fn(u32) -> bool,
    ) -> (MovingPlace, Vec3) {
        let own = || unit_normal(&s.jet).unwrap_or_else(|| self.normal_near::<M>(facet, s.xi));
        if s.at == [0, 0] {
            return (MovingPlace::Face, own());
        }
        let limit = HELD * HELD * s.d2.max(self.size * self.size);
        let held =
            |k: usize| s.at[k] != 0 && s.gradient[k] * s.gradient[k] > limit * s.metric[2 * k];
        let edge = |k: usize| 2 * k + usize::from(s.at[k] > 0);
        let point = |k: usize| s.at[k] != 0 && self.topology.is_point(facet, edge(k));
        let corner = usize::from(s.at[0] > 0) | usize::from(s.at[1] > 0) << 1;
        let found = match [held(0), held(1)] {
            // An edge that is one node.
            _ if point(0) || point(1) => {
                let k = usize::from(!point(0));
                self.corner::<M>(facet, ENDS[edge(k)][0], accept)
            }
            [false, false] => None,
            [true, true] => self.corner::<M>(facet, corner, accept),
            [true, false] => self.edge::<M>(facet, edge(0), s.xi[1], accept),
            [false, true] => self.edge::<M>(facet, edge(1), s.xi[0], accept),
        };
        match found {
            None => (MovingPlace::Face, own()),
            Some((place, normal)) => (place, normal.try_normalize(1e-12).unwrap_or_else(own)),
        }
    }

    /// An edge that holds a foot at `s` along it: place and sum of normals, `None` where the surface runs on smoothly.
    fn edge<const M: usize>(
        &self,
        facet: u32,
        edge: usize,
        s: f64,
        accept: &dyn Fn(u32) -> bool,
    ) -> Option<(MovingPlace, Vec3)> {
        let n = self.normal_near::<M>(facet, on_edge(edge, s));
        let mut kind = match self.topology.is_joined(facet, edge) {
            true => EdgeKind::Sharp,
            false => EdgeKind::Free,
        };
        let mut sum = n;
        for (other, xi) in self.behind(facet, edge, s).filter(|o| accept(o.0)) {
            let m = self.normal_near::<M>(other, xi);
            sum += m;
            if turns(&n, &m) {
                kind = EdgeKind::Sharp;
            } else if kind == EdgeKind::Free {
                kind = EdgeKind::Smooth;
            }
        }
        let direction = if edge < 2 { [0.0, 1.0] } else { [1.0, 0.0] };
        (kind != EdgeKind::Smooth).then_some((MovingPlace::Edge { direction, kind }, sum))
    }

    /// A corner that holds a foot: place and sum of the normals times angles, `None` where the surface runs on smoothly.
    fn corner<const M: usize>(
        &self,
        facet: u32,
        corner: usize,
        accept: &dyn Fn(u32) -> bool,
    ) -> Option<(MovingPlace, Vec3)> {
        let mut kind = EdgeKind::Smooth;
        let mut sum = Vec3::zeros();
        for &(own, at) in self.topology.at_corner(facet, corner) {
            if !accept(own) {
                continue;
            }
            let at = at as usize;
            let n = self.normal_near::<M>(own, corner_xi(at));
            sum += n * self.angle::<M>(own, at);
            for edge in EDGES_AT[at] {
                if self.topology.is_point(own, edge) || kind == EdgeKind::Free {
                    continue;
                }
                let end = usize::from(ENDS[edge][1] == at);
                let s = 2.0 * end as f64 - 1.0;
                let mut joined = false;
                for (other, xi) in self.behind(own, edge, s).filter(|o| accept(o.0)) {
                    joined = true;
                    if turns(&n, &self.normal_near::<M>(other, xi)) {
                        kind = EdgeKind::Sharp;
                    }
                }
                if !joined {
                    kind = match self.topology.is_joined(own, edge) {
                        true => EdgeKind::Sharp,
                        false => EdgeKind::Free,
                    };
                }
            }
        }
        (kind != EdgeKind::Smooth).then_some((MovingPlace::Corner { kind }, sum))
    }

    /// Angle of a facet at one of its corners.
    fn angle<const M: usize>(&self, facet: u32, corner: usize) -> f64 {
        let net = self.net::<M>(facet);
        let [i, j] = [corner & 1, corner >> 1];
        let point = |i: usize, j: usize| net::point(&net[i + M * j], self.rational);
        // Direction of the first control point that is elsewhere, along the edge `fixed` from its end `end`.
        let leaves = |dir: usize, fixed: usize, end: usize| {
            let at = |k: usize| {
                let k = if end == 0 { k } else { M - 1 - k };
                let fixed = fixed * (M - 1);
                if dir == 0 {
                    point(k, fixed)
                } else {
                    point(fixed, k)
                }
            };
            (1..M).find_map(|k| (at(k) - at(0)).try_normalize(1e-12 * self.size))
        };
        let between = |a: Option<Vec3>, b: Option<Vec3>| match (a, b) {
            (Some(a), Some(b)) => a.cross(&b).norm().atan2(a.dot(&b)),
            _ => 0.0,
        };
        let [along2, along1] = EDGES_AT[corner].map(|edge| self.topology.is_point(facet, edge));
        match (along1, along2) {
            // A triangle has this corner twice: half of its angle each time.
            (true, false) => 0.5 * between(leaves(1, 0, j), leaves(1, 1, j)),
            (false, true) => 0.5 * between(leaves(0, 0, i), leaves(0, 1, i)),
            _ => between(leaves(0, j, i), leaves(1, i, j)),
        }
    }

    /// Unit normal of a facet at `xi` or, where it does not exist there, a little towards the middle. Zero where the facet
    /// has none anywhere near.
    fn normal_near<const M: usize>(&self, facet: u32, xi: [f64; 2]) -> Vec3 {
        let net = self.net::<M>(facet);
        let near = |step: f64| {
            let xi = xi.map(|x| x * (1.0 - step));
            unit_normal(&net::jet::<M>(net, xi, self.rational))
        };
        [0.0, 1e-7, 1e-5, 1e-3, 0.1]
            .into_iter()
            .find_map(near)
            .unwrap_or_else(Vec3::zeros)
    }
}

/// Whether the surface has an edge between two normals.
fn turns(n: &Vec3, m: &Vec3) -> bool {
    n.cross(m).norm().atan2(n.dot(m)) > SHARP_ANGLE
}

/// The normal alone of [`Frame::new`](crate::Frame::new), where that gives a frame.
#[inline]
pub(super) fn unit_normal(jet: &Jet) -> Option<Vec3> {
    let [r1, r2] = &jet.rho_i;
    let cross = r1.cross(r2);
    let area = cross.norm_squared().sqrt();
    let largest = r1.norm_squared().max(r2.norm_squared());
    (area > DEGENERATE * largest && area.is_finite() && largest.is_finite())
        .then(|| cross * area.recip())
}
