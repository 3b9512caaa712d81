//! Closest point over all facets: tree descent by boxes, iteration on a facet, and the proof that nothing nearer was missed.

use super::local::{ALL, Local, Problem};
use super::prove::{Verdict, judge, judge_rational};
use super::topology::{corner_xi, on_edge};
use super::{MovingFacets, MovingFoot, MovingPlace, net};
use crate::project::ball::outside_ball;
use crate::project::{Hint, Status};
use crate::surface::Vec3;

/// Parts into which facets may be cut within one query before the search gives up proving.
const MOST_PARTS: usize = 20_000;
/// Most cuts of a part: each halves it.
const DEEPEST: usize = 56;
/// Sine of the angle between the normal and a distance that leans over a border.
const ASIDE: f64 = 1e-3;
/// Most facets that the winner of a search is moved through at the end.
const HOPS: usize = 8;

impl MovingFacets {
    /// The closest point of all facets that `accept` takes (by number), the others do not exist for this query: a common edge
    /// with one of them is a free border. `hint` makes it faster and never changes which point is found; facets farther
    /// away than `reach` are of no interest. `None` where nothing is within reach, before the first
    /// [`update`](Self::update), and for a query that is not finite.
    pub fn project(
        &self,
        q: &Vec3,
        hint: Option<Hint>,
        reach: f64,
        accept: impl Fn(u32) -> bool,
    ) -> Option<MovingFoot> {
        self.project_among(q, hint, reach, &accept)
    }

    /// [`project`](Self::project) compiled once, not once for each caller's closure: an indirect call per facet is nothing
    /// beside the iteration on it, and copies made the larger half of what callers compiled.
    fn project_among(
        &self,
        q: &Vec3,
        hint: Option<Hint>,
        reach: f64,
        accept: &dyn Fn(u32) -> bool,
    ) -> Option<MovingFoot> {
        match self.degree {
            1 => self.project_in::<2, 3>(q, hint, reach, accept),
            2 => self.project_in::<3, 5>(q, hint, reach, accept),
            _ => self.project_in::<4, 7>(q, hint, reach, accept),
        }
    }

    fn project_in<const M: usize, const L: usize>(
        &self,
        q: &Vec3,
        hint: Option<Hint>,
        reach: f64,
        accept: &dyn Fn(u32) -> bool,
    ) -> Option<MovingFoot> {
        let tree = self.tree.as_ref()?;
        if !(q.iter().all(|x| x.is_finite()) && reach >= 0.0) {
            return None;
        }
        let mut search = Search::<M, L> {
            set: self,
            q,
            reach,
            best: None,
            distance: reach,
            cut: reach,
            parts: 0,
            complete: true,
        };
        let mut hinted = None;
        if let Some(hint) = hint
            && (hint.patch as usize) < self.len()
            && hint.xi.iter().all(|x| x.is_finite())
            && self.is_finite(hint.patch)
            && accept(hint.patch)
        {
            let local = search.problem(hint.patch, ALL).solve::<M>(hint.xi);
            search.offer(hint.patch, &local);
            hinted = Some((hint.patch, local));
        }
        tree.visit(q, search.limit2(), |facet| {
            if self.is_finite(facet) && accept(facet) {
                match &hinted {
                    Some((hinted, local)) if *hinted == facet => search.again(facet, local),
                    _ => search.facet(facet),
                }
            }
            search.limit2()
        });
        let complete = search.complete;
        let (facet, local) = search.best?;
        let (facet, local) = self.settle::<M>(q, facet, &local, accept);
        let (place, normal) = self.place::<M>(facet, &local, accept);
        if place == MovingPlace::Face && self.trims.any() && held_aside(&local) {
            return None;
        }
        let distance = local.d2.sqrt();
        let status = if !complete {
            Status::NotConverged
        } else if local.focal() {
            Status::NonUnique
        } else if !local.converged {
            Status::NotConverged
        } else {
            Status::Unique
        };
        Some(MovingFoot {
            facet,
            xi: local.xi,
            jet: local.jet,
            normal,
            signed_distance: if local.d.dot(&normal) < 0.0 {
                -distance
            } else {
                distance
            },
            distance,
            place,
            status,
        })
    }

    pub(super) fn is_finite(&self, facet: u32) -> bool {
        let [low, high] = &self.boxes[facet as usize];
        low.x <= high.x
    }

    #[inline]
    pub(super) fn net<const M: usize>(&self, facet: u32) -> &[[f64; 4]] {
        &self.nets[facet as usize * M * M..][..M * M]
    }

    /// The winner of the search to the last digit; from a border also looks whether a facet behind it holds a nearer point: the
    /// proofs leave out 1e-11 of the size, which is little as a distance and 1e-6 as a place.
    fn settle<const M: usize>(
        &self,
        q: &Vec3,
        facet: u32,
        found: &Local,
        accept: &dyn Fn(u32) -> bool,
    ) -> (u32, Local) {
        let problem = |facet: u32| Problem {
            net: self.net::<M>(facet),
            q,
            range: ALL,
            size: self.size,
            rational: self.rational,
        };
        let mut best = (facet, *found);
        if !found.converged || !found.whole {
            best.1 = problem(facet).solve::<M>(found.xi);
        }
        problem(facet).refine::<M>(&mut best.1);
        for _ in 0..HOPS {
            let (facet, s) = best;
            if s.at == [0, 0] {
                break;
            }
            let mut nearer: Option<(u32, Local)> = None;
            let mut consider = |facet: u32, xi: [f64; 2]| {
                if !(accept(facet) && self.is_finite(facet)) {
                    return;
                }
                let mut t = problem(facet).solve::<M>(xi);
                problem(facet).refine::<M>(&mut t);
                if !self.trims.holds(facet, t.xi) {
                    return;
                }
                let now = nearer.as_ref().map_or(s.d2, |n| n.1.d2);
                // Equally near but not held by its border is better.
                let free = s.active != [false; 2] && t.active == [false; 2] && t.converged;
                if t.d2 < now * (1.0 - 1e-15) || free && t.d2 <= now * (1.0 + 1e-15) {
                    nearer = Some((facet, t));
                }
            };
            if s.at[0] != 0 && s.at[1] != 0 {
                let corner = usize::from(s.at[0] > 0) | usize::from(s.at[1] > 0) << 1;
                for &(other, at) in self.topology.at_corner(facet, corner) {
                    if other != facet {
                        consider(other, corner_xi(at as usize));
                    }
                }
            } else {
                let k = usize::from(s.at[0] == 0);
                let edge = 2 * k + usize::from(s.at[k] > 0);
                for (other, xi) in self.behind(facet, edge, s.xi[1 - k]) {
                    consider(other, xi);
                }
            }
            match nearer {
                Some(t) => best = t,
                None => break,
            }
        }
        best
    }

    /// The same point of an edge on the other facets there: facet and parameters.
    pub(super) fn behind(
        &self,
        facet: u32,
        edge: usize,
        s: f64,
    ) -> impl Iterator<Item = (u32, [f64; 2])> + '_ {
        let own = (facet, edge as u8);
        let others = self.topology.at_edge(facet, edge).iter();
        others.filter(move |o| **o != own).map(move |&other| {
            let reversed = self.topology.reversed(own, other);
            (
                other.0,
                on_edge(other.1 as usize, if reversed { -s } else { s }),
            )
        })
    }
}

/// The nearest point so far.
struct Search<'a, const M: usize, const L: usize> {
    set: &'a MovingFacets,
    q: &'a Vec3,
    /// Points farther away than this are of no interest.
    reach: f64,
    best: Option<(u32, Local)>,
    /// Distance of the best point, or the reach.
    distance: f64,
    /// Radius of the ball that facets must be proved to lie outside of: the best distance less a tolerance well above
    /// rounding and far below any tolerance of the result. Negative where nothing can be better.
    cut: f64,
    parts: usize,
    /// False where the number of parts ran out before the proof was complete.
    complete: bool,
}

impl<'a, const M: usize, const L: usize> Search<'a, M, L> {
    #[inline]
    fn problem(&self, facet: u32, range: [[f64; 2]; 2]) -> Problem<'a> {
        Problem {
            net: self.set.net::<M>(facet),
            q: self.q,
            range,
            size: self.set.size,
            rational: self.set.rational,
        }
    }

    /// Takes a point if it is nearer than the best one.
    #[inline]
    fn offer(&mut self, facet: u32, local: &Local) {
        let distance = local.d2.sqrt();
        if !self.set.trims.holds(facet, local.xi) {
            return;
        }
        if distance < self.distance || self.best.is_none() && distance <= self.reach {
            let tolerance = 1e-11 * self.set.size + 1e-14 * distance;
            self.distance = distance;
            self.cut = if distance > tolerance {
                distance - tolerance
            } else {
                -1.0
            };
            self.best = Some((facet, *local));
        }
    }

    #[inline]
    fn limit2(&self) -> f64 {
        if self.cut < 0.0 {
            -1.0
        } else {
            self.cut * self.cut
        }
    }

    /// Whether a net is proved to hold nothing nearer.
    #[inline]
    fn excluded(&self, net: &[[f64; 4]]) -> bool {
        self.cut < 0.0 || self.cut.is_finite() && outside_ball(net, [M - 1; 2], self.q, self.cut)
    }

    /// Looks at a facet.
    fn facet(&mut self, facet: u32) {
        let net = self.set.net::<M>(facet);
        if self.excluded(net) {
            return;
        }
        let local = self
            .problem(facet, ALL)
            .solve::<M>(seed::<M>(net, self.q, self.set.rational));
        self.offer(facet, &local);
        self.prove(facet, &local);
    }

    /// Looks at the facet of the hint, whose stationary point is known.
    fn again(&mut self, facet: u32, local: &Local) {
        let best = self.best.as_ref().is_some_and(|best| best.0 == facet);
        if best || !self.excluded(self.set.net::<M>(facet)) {
            self.prove(facet, local);
        }
    }

    /// Makes sure that nothing on a facet is nearer than its stationary point and the best of all.
    #[inline]
    fn prove(&mut self, facet: u32, known: &Local) {
        if self.cut < 0.0 {
            return;
        }
        let net = self.set.net::<M>(facet);
        if !self.judged(facet, net, ALL, known) {
            let mut points = [[[0.0; 4]; 4]; 4];
            points.as_flattened_mut()[..M * M].copy_from_slice(net);
            self.halves(facet, points.as_flattened_mut(), ALL, known, 0);
        }
    }

    /// Whether the coefficients say where the nearest point of a part is; it is offered then.
    fn judged(
        &mut self,
        facet: u32,
        net: &[[f64; 4]],
        range: [[f64; 2]; 2],
        known: &Local,
    ) -> bool {
        let within = |k: usize| known.xi[k] >= range[k][0] && known.xi[k] <= range[k][1];
        if self.set.rational {
            let local = match known.converged && within(0) && within(1) {
                true => *known,
                false => self.problem(facet, range).solve::<M>(known.xi),
            };
            self.offer(facet, &local);
            return local.converged
                && match judge_rational::<M, L>(net, self.q, local.d2.sqrt()) {
                    Verdict::Unknown => false,
                    Verdict::Convex => true,
                    Verdict::ConvexEdge { dir, end } => local.xi[dir] == range[dir][end],
                };
        }
        let mut range = range;
        match judge::<M, L>(net, self.q) {
            Verdict::Unknown => return false,
            // Stationary on the facet, so on the part.
            Verdict::Convex if known.converged && within(0) && within(1) => return true,
            Verdict::Convex => {}
            Verdict::ConvexEdge { dir, end } => {
                let on = known.xi[dir] == range[dir][end];
                if known.converged && on && within(1 - dir) {
                    return true;
                }
                range[dir] = [range[dir][end]; 2];
            }
        }
        let local = self.problem(facet, range).solve::<M>(known.xi);
        self.offer(facet, &local);
        true
    }

    /// Cuts a part in two and looks at both halves.
    #[cold]
    #[inline(never)]
    fn halves(
        &mut self,
        facet: u32,
        net: &mut [[f64; 4]],
        range: [[f64; 2]; 2],
        known: &Local,
        depth: usize,
    ) {
        let own = &mut net[..M * M];
        let extent = extents::<M>(own, self.set.rational);
        if extent[0].max(extent[1]) < 1e-8 * self.set.size || self.parts >= MOST_PARTS {
            self.complete &= self.parts < MOST_PARTS;
            return;
        }
        if depth > DEEPEST {
            self.complete = false;
            return;
        }
        self.parts += 1;
        let dir = usize::from(extent[1] > extent[0]);
        let mut right = [[[0.0; 4]; 4]; 4];
        let right = right.as_flattened_mut();
        net::halve::<M>(own, &mut right[..M * M], dir);
        let [a, b] = range[dir];
        let middle = 0.5 * (a + b);
        // The half with the known point first.
        let mut order = [(own, [a, middle]), (&mut right[..M * M], [middle, b])];
        if known.xi[dir] > middle {
            order.reverse();
        }
        for (half, part) in order {
            let mut range = range;
            range[dir] = part;
            if !self.excluded(half) && !self.judged(facet, half, range, known) {
                self.halves(facet, half, range, known, depth + 1);
            }
        }
    }
}

/// Whether a border holds a foot for a point that lies beside it. Where the surface runs on smoothly, what a trim cuts away behind the
/// border holds the true foot: there is none.
fn held_aside(local: &Local) -> bool {
    (0..2).any(|k| {
        let size = local.metric[2 * k].sqrt() * local.d2.sqrt();
        local.active[k] && local.gradient[k].abs() > ASIDE * size
    })
}

/// Where the mean plane of a facet is nearest.
#[inline]
fn seed<const M: usize>(net: &[[f64; 4]], q: &Vec3, rational: bool) -> [f64; 2] {
    let point = |k: usize| net::point(&net[k], rational);
    let c = [0, M - 1, M * (M - 1), M * M - 1].map(point);
    let middle = (c[0] + c[1] + c[2] + c[3]) * 0.25;
    let one = (c[1] - c[0] + c[3] - c[2]) * 0.25;
    let two = (c[2] - c[0] + c[3] - c[1]) * 0.25;
    let d = q - middle;
    let (a, b) = (
        [one.dot(&one), one.dot(&two), two.dot(&two)],
        [one.dot(&d), two.dot(&d)],
    );
    let det = a[0] * a[2] - a[1] * a[1];
    if det.is_nan() || det <= 1e-12 * a[0] * a[2] {
        return [0.0; 2];
    }
    [
        ((b[0] * a[2] - b[1] * a[1]) / det).clamp(-1.0, 1.0),
        ((b[1] * a[0] - b[0] * a[1]) / det).clamp(-1.0, 1.0),
    ]
}

/// Longest control polygon in each direction.
fn extents<const M: usize>(net: &[[f64; 4]], rational: bool) -> [f64; 2] {
    let point = |k: usize| net::point(&net[k], rational);
    let step = |k: usize, l: usize| (point(k) - point(l)).norm_squared().sqrt();
    let mut out = [0.0f64; 2];
    for line in 0..M {
        let (mut row, mut column) = (0.0, 0.0);
        for k in 1..M {
            row += step(M * line + k, M * line + k - 1);
            column += step(M * k + line, M * (k - 1) + line);
        }
        out = [out[0].max(row), out[1].max(column)];
    }
    out
}
