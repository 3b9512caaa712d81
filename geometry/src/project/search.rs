//! Global search: tree descent, local iteration, and proofs that nothing nearer was missed.

use super::PatchSet;
use super::ball::outside_ball;
use super::local::{Local, Region};
use super::piece::{Piece, box_distance2, hull, split};
use crate::surface::{Surface, Vec3};
use std::cell::Cell;

thread_local! {
    /// Room for subdivision, kept from query to query.
    static ROOM: Cell<Room> = Cell::new(Room::default());
}

/// Parts that are still to be looked at, with their control nets one after the other.
#[derive(Default)]
struct Room {
    nets: Vec<[f64; 4]>,
    parts: Vec<Part>,
}

/// Tolerance of local iterations during the search; the winner is polished afterwards.
pub(super) const ROUGH: f64 = 1e-10;
/// Parts into which pieces may be cut within one query before the search gives up proving.
pub(super) const MOST_PARTS: usize = 100_000;

/// The nearest point so far.
pub(super) struct Search<'a, S: Surface> {
    pub set: &'a PatchSet<S>,
    pub q: Vec3,
    /// Points farther away than this are of no interest.
    reach: f64,
    pub best: Option<(u32, Local)>,
    /// Distance of the best point, or the reach.
    distance: f64,
    /// See [`cut`](Self::cut).
    cut: f64,
    /// Whether nothing in the block of cells around the best point is nearer.
    settled: bool,
    pub parts: usize,
    /// False where the number of parts ran out before the proof was complete.
    pub complete: bool,
    /// Whether a start from a sphere's centre was made.
    centred: bool,
}

/// Part of a piece.
struct Part {
    /// Parameters from 0 to 1 of the piece.
    range: [[f64; 2]; 2],
    depth: u32,
}

/// A stationary point of a piece, with the radius (in scaled parameters) around it in which no point of the piece is
/// nearer to the query.
#[derive(Clone, Copy)]
struct Known {
    at: [f64; 2],
    radius: f64,
}

impl<'a, S: Surface> Search<'a, S> {
    pub fn new(set: &'a PatchSet<S>, q: Vec3, reach: f64) -> Self {
        Search {
            set,
            q,
            reach,
            best: None,
            distance: reach,
            cut: reach,
            settled: false,
            parts: 0,
            complete: true,
            centred: false,
        }
    }

    /// Takes a point of a piece if it is nearer than the best one.
    pub fn offer(&mut self, piece: u32, local: &Local) {
        let distance = local.d2.sqrt();
        if distance < self.distance || self.best.is_none() && distance <= self.reach {
            let set = self.set;
            let inside = local.trim.is_some() || set.trimmed.is_inside(piece);
            if !inside && set.trimmed_away(local.region.patch, local.xi) {
                return;
            }
            self.distance = distance;
            let tolerance = 1e-11 * set.size + 1e-14 * distance;
            self.cut = if distance > tolerance {
                distance - tolerance
            } else {
                -1.0
            };
            self.best = Some((piece, *local));
            let id = piece as usize;
            self.settled = local.trim.is_none()
                && set.cells[id].settles_block(&set.pieces.list[id], &self.q, local);
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
        self.settled && 2.0 * self.distance < self.set.cells[best as usize].clear
    }

    /// Radius of the ball that pieces must be proved to lie outside of: the best distance less a tolerance well above
    /// rounding and far below any tolerance of the result. Negative where nothing can be better.
    #[inline]
    pub fn cut(&self) -> f64 {
        self.cut
    }

    #[inline]
    fn limit2(&self) -> f64 {
        let c = self.cut();
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
    }

    /// Whether nothing in a piece is nearer than the best point, by the tests that need no iteration.
    #[inline]
    pub fn excluded(&self, piece: &Piece, id: u32) -> bool {
        if self.behind_sphere(piece.patch) {
            return true;
        }
        if let Some((best, local)) = &self.best
            && self.settled
            && self.set.cells[*best as usize].covers(local.region.patch, piece)
        {
            return true;
        }
        let c = self.cut();
        c < 0.0
            || c.is_finite()
                && (self.set.cells[id as usize].slab.distance2(&self.q) >= c * c
                    || outside_ball(self.set.pieces.net(piece), piece.degree, &self.q, c))
    }

    /// Whether the best point is as near as the sphere that a patch lies on, up to rounding, and stationary: next to a pole
    /// only the slope tells the nearest point from others.
    #[inline]
    fn behind_sphere(&self, patch: u32) -> bool {
        let set = self.set;
        let (Some(sphere), Some((_, best))) = (&set.spheres[patch as usize], &self.best) else {
            return false;
        };
        let bound = sphere.distance(&self.q);
        // At the centre all points are as near, and which of them is taken means nothing.
        sphere.has_near_centre(&self.q) && bound >= self.cut()
            || bound + 1e-14 * (set.size + self.distance) >= self.distance && set.flat(best)
    }

    /// Next to the centre of a sphere distances differ by less than bounds over pieces tell: starts at the point nearest to
    /// `target`, the point of the sphere in the direction of the query, which is the nearest to the query too.
    #[cold]
    #[inline(never)]
    fn start_from_centre(&mut self, target: Vec3) {
        self.centred = true;
        let mut other = Search::new(self.set, target, f64::INFINITY);
        other.centred = true;
        other.run();
        if let Some((_, local)) = other.best {
            self.start(local.region.patch, local.span, local.xi);
        }
    }

    fn piece(&mut self, id: u32) {
        let set = self.set;
        if id as usize >= set.pieces.list.len() {
            return self.curve_leaf(id as usize - set.pieces.list.len());
        }
        if !self.centred
            && let Some(sphere) = &set.spheres[set.pieces.list[id as usize].patch as usize]
            && sphere.has_near_centre(&self.q)
        {
            self.start_from_centre(sphere.beyond(&self.q));
        }
        if set.trimmed.is_cut(id) {
            return self.cut_cell(id);
        }
        let piece = &set.pieces.list[id as usize];
        if self.behind_sphere(piece.patch) {
            return;
        }
        let cell = &set.cells[id as usize];
        let own = |search: &Self| search.best.as_ref().is_some_and(|best| best.0 == id);
        if self.settled || !own(self) {
            if self.excluded(piece, id) {
                return;
            }
            if self.best.is_none() {
                let u = cell.seed(&self.q);
                self.start(piece.patch, piece.span, at(piece, u));
                if self.settled && self.excluded(piece, id) {
                    return;
                }
            }
        }
        let local = match &self.best {
            Some((best, local)) if *best == id => *local,
            _ => {
                let u = cell.seed(&self.q).map(|u| u.clamp(0.05, 0.95));
                self.iterate(id, piece, u)
            }
        };
        if cell.settles_itself(&self.q, &local) {
            return;
        }
        let known = self.known(piece, &local);
        if covered(piece, &known, &[[0.0, 1.0]; 2]) || self.cut() < 0.0 {
            return;
        }
        let mut room = ROOM.take();
        self.subdivide(id, piece, known, &mut room);
        ROOM.set(room);
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

    /// Where a stationary point is, and how far around it the piece is proved to be no nearer.
    ///
    /// With `F = |q - rho|^2 / 2` and `g = F_,i`, every point of the piece satisfies
    /// `F >= F* + g.D + D.F_ij.D / 2 - L |D|^3 / 6`, `L` a bound on the third derivative; on an active bound `g.D >= 0`
    /// is worth `2 g / extent` of the Hessian. So `F >= F*` for `|D| <= 3 lambda / L`.
    fn known(&self, piece: &Piece, s: &Local) -> Known {
        let width = [0, 1].map(|k| piece.domain[k][1] - piece.domain[k][0]);
        let at = [0, 1].map(|k| (s.xi[k] - piece.domain[k][0]) / width[k]);
        if !s.converged {
            return Known { at, radius: 0.0 };
        }
        let [m1, m2] = piece.scale;
        let (c1, c2) = (width[0] / m1, width[1] / m2);
        let mut h = [
            s.hessian[0] * c1 * c1,
            s.hessian[1] * c1 * c2,
            s.hessian[2] * c2 * c2,
        ];
        if s.active[0] {
            h[0] += 2.0 * s.gradient[0].abs() * c1 / m1;
        }
        if s.active[1] {
            h[2] += 2.0 * s.gradient[1].abs() * c2 / m2;
        }
        let (mean, half) = (0.5 * (h[0] + h[2]), 0.5 * (h[0] - h[2]));
        let lambda = mean - (half * half + h[1] * h[1]).sqrt();
        let far = s.d2.sqrt() + 1.5 * (m1 + m2);
        let third = 3.0 * std::f64::consts::SQRT_2 * piece.second + piece.third * far;
        let radius = if lambda > 0.0 {
            // 0.999 leaves room for rounding and for the gradient that the iteration has left over.
            0.999 * 3.0 * lambda / third
        } else {
            0.0
        };
        Known { at, radius }
    }

    /// Proves or improves by bisection.
    #[cold]
    #[inline(never)]
    fn subdivide(&mut self, id: u32, piece: &Piece, first: Known, room: &mut Room) {
        let net = self.set.pieces.net(piece);
        let size = net.len();
        let Room { nets, parts } = room;
        nets.clear();
        nets.reserve(64 * size);
        nets.extend_from_slice(net);
        parts.clear();
        parts.reserve(64);
        parts.push(Part {
            range: [[0.0, 1.0]; 2],
            depth: 0,
        });
        let mut known = [first; 4];
        let mut latest = 0;
        while let Some(part) = parts.pop() {
            let start = parts.len() * size;
            let c = self.cut();
            if c < 0.0 || self.behind_sphere(piece.patch) {
                return;
            }
            if known.iter().any(|k| covered(piece, k, &part.range)) {
                continue;
            }
            let own = &nets[start..start + size];
            if part.depth > 0 && c.is_finite() {
                let [low, high] = hull(own);
                if box_distance2(&self.q, &low, &high) >= c * c
                    || outside_ball(own, piece.degree, &self.q, c)
                {
                    continue;
                }
            }
            let middle = part.range.map(|[a, b]| 0.5 * (a + b));
            if part.depth > 0 && part.depth % 2 == 0 {
                let local = self.iterate(id, piece, middle);
                let found = self.known(piece, &local);
                let apart = |k: &Known| {
                    (k.at[0] - found.at[0]).abs() + (k.at[1] - found.at[1]).abs() > 1e-9
                };
                if known.iter().all(apart) {
                    latest = (latest + 1) % known.len();
                    known[latest] = found;
                }
                if covered(piece, &found, &part.range) {
                    continue;
                }
            }
            let extent = extents(&nets[start..start + size], piece.degree);
            self.parts += 1;
            if self.parts > MOST_PARTS {
                self.complete = false;
                return;
            }
            if extent[0].max(extent[1]) < 1e-8 * self.set.size {
                continue;
            }
            let dir = usize::from(extent[1] > extent[0]);
            let [a, b] = part.range[dir];
            // A stationary point on the cut leaves parts in which the distance only grows, where the bounds are sharp.
            let wanted = (known[latest].at[dir] - a) / (b - a);
            let t = if part.depth < 4 && wanted > 0.05 && wanted < 0.95 {
                wanted
            } else {
                0.5
            };
            nets.resize(start + 2 * size, [0.0; 4]);
            let (left, right) = nets[start..].split_at_mut(size);
            split(left, &mut right[..size], piece.degree, dir, t);
            let cut = a + t * (b - a);
            for half in [[a, cut], [cut, b]] {
                let mut range = part.range;
                range[dir] = half;
                parts.push(Part {
                    range,
                    depth: part.depth + 1,
                });
            }
        }
    }
}

/// Whether a part lies within the radius of a stationary point.
#[inline]
fn covered(piece: &Piece, known: &Known, range: &[[f64; 2]; 2]) -> bool {
    let far = [0, 1].map(|k| {
        let [a, b] = range[k];
        piece.scale[k] * (known.at[k] - a).abs().max((known.at[k] - b).abs())
    });
    far[0] * far[0] + far[1] * far[1] <= known.radius * known.radius
}

/// Longest control polygon in each direction. Next to a pole the one around it is short, so no cuts are wasted on it.
pub(super) fn extents(net: &[[f64; 4]], degree: [usize; 2]) -> [f64; 2] {
    let n1 = degree[0] + 1;
    let point = |k: usize| {
        let [x, y, z, w] = net[k];
        Vec3::new(x, y, z) / w
    };
    let rows = (0..=degree[1]).map(|j| {
        (0..degree[0])
            .map(|i| (point(i + 1 + n1 * j) - point(i + n1 * j)).norm())
            .sum::<f64>()
    });
    let columns = (0..n1).map(|i| {
        (0..degree[1])
            .map(|j| (point(i + n1 * (j + 1)) - point(i + n1 * j)).norm())
            .sum::<f64>()
    });
    [rows.fold(0.0, f64::max), columns.fold(0.0, f64::max)]
}

/// The region that a piece is.
#[inline]
pub(super) fn region_of(piece: &Piece) -> Region {
    Region {
        patch: piece.patch,
        spans: piece.span.map(|s| [s, s + 1]),
        domain: piece.domain,
    }
}

/// Parameters of the patch for parameters 0 to 1 of a piece.
#[inline]
pub(super) fn at(piece: &Piece, u: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|k| {
        let [a, b] = piece.domain[k];
        a + u[k] * (b - a)
    })
}
