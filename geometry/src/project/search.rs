//! Global search: tree descent, local iteration, and proofs that nothing nearer was missed.

mod spheres;

use super::PatchSet;
use super::ball::outside_ball;
use super::local::{Local, Region};
use super::piece::{Piece, Place};
use super::subdivide::covered;
use crate::surface::{Surface, Vec3};
use spheres::Beyond;
use std::cell::Cell;

/// Tolerance of local iterations during the search; the winner is polished afterwards.
pub(super) const ROUGH: f64 = 1e-10;
/// Parts into which pieces may be cut within one query before the search gives up proving.
pub(super) const MOST_PARTS: usize = 100_000;

/// Pieces that are kept to be looked at for a point as near as the best one.
const MOST_KEPT: usize = 16;
/// Parts after which a search that need not be certain settles for less; see [`Search::loosen`].
const GRANT: usize = 256;

/// The nearest point so far.
pub(super) struct Search<'a, S: Surface> {
    pub set: &'a PatchSet<S>,
    pub q: Vec3,
    /// Points farther away than this are of no interest.
    reach: f64,
    /// Points outside that are farther away than this need not be certain; see [`Search::loosen`].
    pub above: f64,
    pub best: Option<(u32, Local)>,
    /// Distance of the best point, or the reach.
    distance: f64,
    /// See [`cut`](Self::cut).
    cut: f64,
    /// See [`wide`](Self::wide).
    wide: f64,
    /// See [`slack`](Self::slack).
    slack: f64,
    /// A point as near as the best one, elsewhere, with its distance.
    tie: Option<(Vec3, f64)>,
    /// Pieces that hold nothing nearer, but perhaps a point as near; how many.
    kept: [u32; MOST_KEPT],
    kept_count: usize,
    /// Whether nothing in the block of cells around the best point is nearer.
    settled: bool,
    parts: usize,
    /// False where the number of parts ran out before the proof was complete.
    pub complete: bool,
    /// Whether the proofs settled for less.
    loose: bool,
    /// Whether a start from a sphere's centre was made.
    centred: bool,
    /// Whether the best point is as exact as it can be.
    sharp: bool,
    /// The sphere of the patch that was looked at last: pieces of one patch follow each other.
    sphere: Cell<Option<Beyond>>,
    /// Whether distances do not change about the best point, once it was asked for.
    flat: Cell<Option<bool>>,
}

impl<'a, S: Surface> Search<'a, S> {
    pub fn new(set: &'a PatchSet<S>, q: Vec3, reach: f64) -> Self {
        let mut search = Search {
            set,
            q,
            reach,
            above: f64::INFINITY,
            best: None,
            distance: reach,
            cut: reach,
            wide: reach,
            slack: 0.0,
            tie: None,
            kept: [0; MOST_KEPT],
            kept_count: 0,
            settled: false,
            parts: 0,
            complete: true,
            loose: false,
            centred: false,
            sharp: false,
            sphere: Cell::new(None),
            flat: Cell::new(None),
        };
        search.slack = search.least_slack();
        search
    }

    /// Takes a point of a piece if it is nearer than the best one, and takes note of it if it is as near.
    pub fn offer(&mut self, piece: u32, local: &Local) {
        let distance = local.d2.sqrt();
        if distance < self.distance || self.best.is_none() && distance <= self.reach {
            let set = self.set;
            let inside = local.trim.is_some() || set.trimmed.is_inside(piece);
            if !inside && set.trimmed_away(local.region.patch, local.xi) {
                return;
            }
            let tolerance = 1e-11 * set.size + 1e-14 * distance;
            if self.best.is_some() && self.distance - distance <= tolerance {
                self.take_as_near(piece, local, distance);
            } else {
                self.tie = None;
                self.take(piece, local, distance);
            }
        } else if distance <= self.wide && self.tie.is_none() && self.best.is_some() {
            let inside = local.trim.is_some() || self.set.trimmed.is_inside(piece);
            if inside || !self.set.trimmed_away(local.region.patch, local.xi) {
                self.compare(local);
            }
        }
    }

    /// Makes a point the best one.
    #[inline(always)]
    fn take(&mut self, piece: u32, local: &Local, distance: f64) {
        let set = self.set;
        let tolerance = 1e-11 * set.size + 1e-14 * distance;
        self.distance = distance;
        self.loose = false;
        self.sharp = false;
        self.flat.set(None);
        (self.cut, self.wide) = if distance > tolerance {
            (distance - tolerance, (distance + tolerance).min(self.reach))
        } else {
            (-1.0, -1.0)
        };
        self.slack = self.least_slack() + 2.0 * tolerance * distance;
        self.best = Some((piece, *local));
        self.settled = local.trim.is_none() && {
            let own = set.piece(piece);
            own.own.is_stationary_in_block(own, local)
                && (set.proofs(piece, own)).settle_block(&self.q, local, self.slack)
        };
    }

    /// Makes a point the best one that is nearer than the last one by no more than the tolerance.
    #[cold]
    #[inline(never)]
    fn take_as_near(&mut self, piece: u32, local: &Local, distance: f64) {
        let before = self.best.take();
        self.take(piece, local, distance);
        if let Some((_, before)) = before {
            self.compare(&before);
        }
    }

    /// Brings the best point to machine precision, before its distance is made the bound of a subdivision: on and next to
    /// the surface the tolerance of local iterations is more than the one of proofs.
    pub fn sharpen(&mut self) {
        let Some((piece, mut local)) = self
            .best
            .filter(|best| !self.sharp && best.1.trim.is_none())
        else {
            return;
        };
        self.set.polish_face(&self.q, &mut local);
        self.offer(piece, &local);
        self.sharp = true;
    }

    /// Takes note of a point that is as near as the best one, unless it belongs to the same foot.
    #[cold]
    #[inline(never)]
    fn compare(&mut self, other: &Local) {
        let Some((_, best)) = &self.best else {
            return;
        };
        let elsewhere = |rho: &Vec3| !self.is_around_best(|best| (rho - best).norm_squared());
        if self.cut < 0.0 {
            self.tie = None;
            return;
        }
        let known = self
            .tie
            .filter(|(rho, distance)| *distance <= self.wide && elsewhere(rho));
        self.tie = known.or_else(|| {
            if !elsewhere(&other.jet.rho) {
                return None;
            }
            let found = self.set.other_foot(&self.q, best, other)?;
            (found.1 <= self.wide && elsewhere(&found.0)).then_some(found)
        });
        if self.tie.is_some() {
            self.wide = self.cut;
        }
    }

    /// Whether another point of the set may be as near as the best one.
    pub fn is_tied(&self) -> bool {
        self.tie.is_some() || self.loose
    }

    fn least_slack(&self) -> f64 {
        let size = 4.0 * ROUGH * self.set.size;
        size * size
    }

    /// What the square of a distance may be less than that of a stationary point, because of what the iteration has left
    /// over of the gradient: 1e-11 of the size in distance, or what the last Newton steps gain in any case.
    #[inline]
    pub fn slack(&self) -> f64 {
        self.slack
    }

    /// Counts a part of a patch; returns whether the search may continue.
    pub fn spend(&mut self, patch: u32) -> bool {
        self.parts += 1;
        if self.parts.is_multiple_of(GRANT) && self.above < self.reach {
            self.loosen();
        }
        self.complete &= self.parts <= MOST_PARTS && self.may_go_on(patch);
        self.complete
    }

    /// Whether the patch allows the search to continue. Compiles to nothing for surfaces with the default answer, which indexing
    /// with its bounds check would not.
    #[inline(always)]
    fn may_go_on(&self, patch: u32) -> bool {
        (self.set.patches.get(patch as usize)).is_none_or(S::may_go_on)
    }

    /// Ends the search without a proof.
    #[cold]
    fn give_up(&mut self) {
        self.complete = false;
        (self.cut, self.wide) = (-1.0, -1.0);
    }

    /// Where points outside need not be certain beyond `above`, and the best one is such a point: a nearer one is only
    /// looked for if it is nearer than `above`, or by more than a ten-thousandth of the distance (and no more than
    /// the tolerance for joining edges). On the axis of a surface of revolution, where a circle of points is as near, that
    /// ends the search.
    #[cold]
    #[inline(never)]
    fn loosen(&mut self) {
        let Some((_, best)) = &self.best else {
            return;
        };
        let foot = self.set.finish(&self.q, *best, true, false);
        if foot.signed_distance > self.above {
            let less = (1e-4 * (self.distance - self.above)).min(self.set.tolerance);
            self.cut = (self.distance - less).max(self.above);
            self.wide = self.cut;
            self.loose = true;
        }
    }

    /// Iterates from `xi` in the whole smooth region around a pair of spans.
    pub fn start(&mut self, patch: u32, span: [usize; 2], xi: [f64; 2]) {
        let region = self.set.region(patch, span);
        let mut local = self.set.descend(&self.q, &region, xi, span, ROUGH);
        if local.converged && self.set.spheres[patch as usize].is_some() {
            // Spheres are compared up to rounding.
            self.set.refine(&self.q, &mut local);
        }
        let piece = self.set.piece_number(patch, local.span, local.xi);
        self.offer(piece, &local);
        if self.best.is_none() && !self.set.trimmed.is_inside(piece) {
            self.start_on_border(patch, local.xi);
        }
    }

    /// Whether the best point is proved to be the nearest of all: the nearest of its block, and the ball about the query
    /// that it lies on does not leave the block.
    #[inline]
    fn done(&self) -> bool {
        let Some((best, _)) = self.best else {
            return false;
        };
        self.settled && 2.0 * self.wide < self.set.proofs(best, self.set.piece(best)).clear
    }

    /// Radius of the ball that pieces must be proved to lie outside of: the best distance less a tolerance well above
    /// rounding and far below any tolerance of the result. Negative where nothing can be better.
    #[inline]
    pub fn cut(&self) -> f64 {
        self.cut
    }

    /// Radius of the ball that holds everything as near as the best point: its distance and the tolerance; no more than
    /// [`cut`](Self::cut) where another point as near is known.
    #[inline]
    pub fn wide(&self) -> f64 {
        self.wide
    }

    #[inline]
    fn limit2(&self) -> f64 {
        let c = self.wide;
        if c < 0.0 { -1.0 } else { c * c }
    }

    /// Searches everything that may hold a nearer point than the one offered before, if any.
    pub fn run(&mut self) {
        if self.done() {
            return;
        }
        let set = self.set;
        let q = self.q;
        let limit2 = self.limit2();
        set.tree.visit(&q, limit2, |piece| {
            self.piece(piece);
            if self.done() { -1.0 } else { self.limit2() }
        });
        if self.kept_count > 0 {
            self.look_for_ties();
        }
    }

    /// Whether nothing in a piece is as near as the best point, by the tests that need no iteration.
    #[inline]
    pub fn excluded(&self, piece: &Piece) -> bool {
        if self.behind_sphere(piece.patch) {
            return true;
        }
        if let Some((best, local)) = &self.best
            && self.settled
            && (self.set.piece(*best).own).covers(local.region.patch, piece)
        {
            return true;
        }
        let c = self.wide;
        c < 0.0
            || c.is_finite()
                && (piece.own.slab.distance2(&self.q) >= c * c
                    || outside_ball(piece.net(), piece.degree, &self.q, c))
    }

    /// Whether a piece that the ball of everything as near reaches is proved to hold nothing nearer; it is kept then.
    fn only_as_near(&mut self, piece: &Piece, id: u32) -> bool {
        let found = self.best.is_some()
            && self.cut < self.wide
            && outside_ball(piece.net(), piece.degree, &self.q, self.cut);
        if found && self.kept_count < MOST_KEPT {
            self.kept[self.kept_count] = id;
            self.kept_count += 1;
        }
        found
    }

    /// Looks for a point as near as the best one in the pieces that were kept.
    #[cold]
    #[inline(never)]
    fn look_for_ties(&mut self) {
        let set = self.set;
        for k in 0..self.kept_count {
            let id = self.kept[k];
            let piece = set.piece(id);
            if self.tie.is_some() || self.cut < 0.0 {
                return;
            }
            if !self.excluded(piece) {
                let u = piece.own.seed(&self.q);
                self.iterate(id, piece, u.map(|u| u.clamp(0.05, 0.95)));
            }
        }
    }

    /// Whether something is so close to the best point that what is as near there is no other foot, by a measure of its
    /// squared distance. Next to a centre of curvature the distance grows with the fourth power of the way only, and the
    /// tolerance is reached after `(48 * 1e-11 size / d)^(1/4)` of it; four times as much is left out.
    pub fn is_around_best(&self, distance2: impl FnOnce(&Vec3) -> f64) -> bool {
        let Some((_, best)) = &self.best else {
            return false;
        };
        let d = self.distance;
        distance2(&best.jet.rho) <= 4e-4 * d * (d * self.set.size).sqrt()
    }

    fn piece(&mut self, id: u32) {
        let set = self.set;
        if id as usize >= set.pieces.count() {
            return self.curve_leaf(id as usize - set.pieces.count());
        }
        let piece = set.piece(id);
        if !self.may_go_on(piece.patch) {
            return self.give_up();
        }
        if !self.centred
            && let Some(sphere) = &set.spheres[piece.patch as usize]
            && sphere.has_near_centre(&self.q)
        {
            self.start_from_centre(sphere.beyond(&self.q));
        }
        if set.trimmed.is_cut(id) {
            return self.cut_cell(id);
        }
        if self.behind_sphere(piece.patch) {
            return;
        }
        let cell = &piece.own;
        let own = |search: &Self| search.best.as_ref().is_some_and(|best| best.0 == id);
        if self.settled || !own(self) {
            if self.excluded(piece) || self.only_as_near(piece, id) {
                return;
            }
            if self.best.is_none() {
                let u = cell.seed(&self.q);
                self.start(piece.patch, piece.span, at(piece, u));
                if self.settled && self.excluded(piece) {
                    return;
                }
            }
        }
        let ends = |search: &Self, local: &Local| {
            local.converged
                && set
                    .proofs(id, piece)
                    .settle_cell(&search.q, local, search.slack)
                || search.cut < 0.0
        };
        let local = match &self.best {
            Some((best, local)) if *best == id => {
                if ends(self, local) {
                    return;
                }
                *local
            }
            _ => {
                let u = cell.seed(&self.q).map(|u| u.clamp(0.05, 0.95));
                let local = self.iterate(id, piece, u);
                if ends(self, &local) {
                    return;
                }
                local
            }
        };
        let known = self.known(piece, &local);
        if !covered(piece, &known, &[[0.0, 1.0]; 2]) {
            self.subdivide(id, piece, known);
        }
    }

    /// Local iteration within a piece from `u` (0 to 1 in each direction).
    pub fn iterate(&mut self, id: u32, piece: &Piece, u: [f64; 2]) -> Local {
        let region = region_of(piece);
        let mut local = self
            .set
            .descend(&self.q, &region, at(piece, u), piece.span, ROUGH);
        if local.converged && self.set.spheres[piece.patch as usize].is_some() {
            self.set.refine(&self.q, &mut local);
        }
        self.offer(id, &local);
        local
    }
}

/// The region that a piece is.
#[inline]
pub(super) fn region_of(piece: &Place) -> Region {
    Region {
        patch: piece.patch,
        spans: piece.span.map(|s| [s, s + 1]),
        domain: piece.domain,
    }
}

/// Parameters of the patch for parameters 0 to 1 of a piece.
#[inline]
pub(super) fn at(piece: &Place, u: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|k| {
        let [a, b] = piece.domain[k];
        a + u[k] * (b - a)
    })
}
