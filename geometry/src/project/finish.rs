//! From the winner of the search to a foot: last Newton steps, location, normal and sign.

use super::local::{Local, Region, TrimPlace};
use super::location::HELD;
use super::set::PatchSet;
use super::topology::{EdgeCurve, EdgePoint, Link, corner_at, edges_at, nearest_on_edge};
use super::{Foot, Location, Status};
use crate::surface::{Surface, Vec3};

/// Most patches that the winner of a search is moved through at the end.
pub(super) const HOPS: usize = 4;

impl<S: Surface> PatchSet<S> {
    /// The foot that a rough point leads to. `complete` says whether the search has come to its end, `tied` whether
    /// other points are known to be as near.
    pub(super) fn finish(&self, q: &Vec3, rough: Local, complete: bool, tied: bool) -> Foot {
        let best = self.settled_foot(q, rough, HOPS);
        self.as_foot(q, &best, complete, tied)
    }

    /// The foot at a point that [`settled_foot`](Self::settled_foot) gave.
    #[inline]
    pub(super) fn as_foot(&self, q: &Vec3, best: &Local, complete: bool, tied: bool) -> Foot {
        let patch = best.region.patch;
        let side = self.sides[patch as usize];
        let location = self.locate(best);
        let d = q - best.jet.rho;
        let normal = match location {
            _ if side == 0.0 => {
                let normal = self.face_normal(best);
                normal * if normal.dot(&d) < 0.0 { -1.0 } else { 1.0 }
            }
            Location::Face => self.face_normal(best) * side,
            _ => self.pseudo_normal(best, location),
        };
        let distance = best.d2.sqrt();
        let along = d.dot(&normal);
        let held = best.at != [0, 0] || best.trim.is_some();
        let signed_distance = if location == Location::Face && held {
            // The gap of a joint through which the surface goes on smoothly may hold the point aside: it is none of the
            // surface's, nor of the distance from it.
            along
        } else if side != 0.0 && along < 0.0 {
            -distance
        } else {
            distance
        };
        let pole = matches!(location, Location::Pole { .. });
        // At a centre of curvature the equations are singular and their residual says little.
        let status = if !complete {
            Status::NotConverged
        } else if tied || !pole && focal(best) {
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

    /// The last Newton steps from a rough point, on over at most `hops` borders behind which the surface is nearer.
    #[inline]
    pub(super) fn settled_foot(&self, q: &Vec3, rough: Local, hops: usize) -> Local {
        // The search may have stopped at the border of a piece, which is none of the surface's.
        let region = self.region(rough.region.patch, rough.span);
        let mut best = rough;
        if best.trim.is_none() && best.region != region {
            best = self.state(q, &region, best.xi, best.span);
        }
        self.polish_in_place(q, &mut best);
        if best.at != [0, 0] || best.trim.is_some() {
            best = self.cross(q, best, hops);
        }
        if let Some(turn) = self.near_pole(&best) {
            best = self.snap_to_pole(q, best, turn);
        } else if self.is_on_surface(&best) {
            best = self.snap_to_border(q, best);
        }
        best
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

    /// Moves a foot that is the query itself onto the border of its region or of the trim if it lies there up to rounding.
    #[cold]
    #[inline(never)]
    fn snap_to_border(&self, q: &Vec3, s: Local) -> Local {
        let limit = HELD * self.size;
        let xi = [0, 1].map(|k| {
            let near = |border: &f64| {
                let off = border - s.xi[k];
                off * off * s.metric[2 * k] <= limit * limit
            };
            let border = s.region.domain[k].into_iter().find(near);
            border.unwrap_or(s.xi[k])
        });
        let mut out = s;
        if s.trim.is_none() && xi != s.xi {
            out = self.state(q, &s.region, xi, s.span);
        }
        let patch = s.region.patch;
        if out.trim.is_none()
            && self
                .trimmed
                .is_cut(self.piece_number(patch, out.span, out.xi))
            && let Some(on_trim) = self.slide_on_trim(q, patch, out.xi)
            && self.is_on_surface(&on_trim)
        {
            out = on_trim;
        }
        out.converged = s.converged;
        if self.is_on_surface(&out) { out } else { s }
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
    pub(super) fn beside(
        &self,
        s: &Local,
    ) -> impl Iterator<Item = (Region, [f64; 2], [usize; 2])> + '_ {
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
    pub(super) fn behind<'a>(
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
    pub(super) fn edges_under(&self, s: &Local) -> [Option<(usize, f64)>; 2] {
        let patch = s.region.patch;
        let first = self.topology.first[patch as usize];
        let edges = self.topology.of(patch);
        if self.patches[patch as usize].trim().is_none() {
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
        let limit = 1e-9 * self.size;
        let near = near.filter(|n| n.0 <= limit * limit);
        // A pole is a pole whatever meets there.
        let pole = |k: usize| edges[k].kind.is_none();
        let nearest = near.min_by(|a, b| (pole(b.1).cmp(&pole(a.1))).then(a.0.total_cmp(&b.0)));
        [nearest.map(|(_, k, t)| (first + k, t)), None]
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NurbsPatch;

    /// Parts of the plane z = 0, x from -1 to `a` and from `b` to 1.
    fn two_parts(a: f64, b: f64) -> PatchSet {
        let part = |a: f64, b: f64| {
            let points = [[a, -1.0], [b, -1.0], [a, 1.0], [b, 1.0]];
            let points = points.map(|[x, y]| Vec3::new(x, y, 0.0));
            let knots = || vec![0.0, 0.0, 1.0, 1.0];
            NurbsPatch::new([1, 1], [knots(), knots()], [2, 2], &points, None).unwrap()
        };
        PatchSet::new(vec![part(-1.0, a), part(b, 1.0)], None).unwrap()
    }

    #[test]
    fn a_gap_that_is_joined_does_not_count_as_distance() {
        for gap in [1e-7, 1e-5, 2e-4] {
            let set = two_parts(-0.5 * gap, 0.5 * gap);
            assert_eq!(set.edges().smooth, 1);
            for (x, height) in [
                (0.0, 1e-4),
                (0.2 * gap, -1e-4),
                (-0.4 * gap, 1e-6),
                (0.3, -0.1),
            ] {
                let q = Vec3::new(x, 0.3, height);
                let foot = set.project(&q, None, 1.0).unwrap();
                assert_eq!(foot.location, Location::Face);
                assert!((foot.signed_distance - height).abs() < 1e-16, "{foot:?}");
                let aside = (0.5 * gap - x.abs()).max(0.0);
                assert!((foot.distance - height.hypot(aside)).abs() < 1e-15);
            }
            // Points of the plane have no side, over the gap either.
            let mut set = set;
            let points = [[0.0, 0.1], [0.1, 0.1]].map(|[x, y]| Vec3::new(x, y, 0.0));
            let found = set.orient_towards(&points).unwrap();
            let undecided = crate::project::SideOutcome::Undecided { ignored: 2 };
            assert_eq!(found[0].outcome, undecided);
        }
    }

    #[test]
    fn patches_that_run_over_each_other_are_no_fold() {
        for overlap in [1e-7, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 1e-2, 0.3] {
            let set = two_parts(0.5 * overlap, -0.5 * overlap);
            assert_eq!(set.sides(), [1.0, 1.0]);
            for x in [-0.7, -0.1 * overlap, 0.0, 0.4 * overlap, 0.7] {
                let foot = set.project(&Vec3::new(x, 0.3, -1e-3), None, 1.0).unwrap();
                assert_eq!(foot.location, Location::Face, "{overlap} {x}");
                assert!((foot.signed_distance + 1e-3).abs() < 1e-15);
            }
        }
    }
}
