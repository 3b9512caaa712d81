//! Closest points on trimmed patches: cells that the border runs through, and the trim curves.
//!
//! The nearest point of the trimmed part of a cell is either a point of a trim curve, or inside of the trim and then a local
//! minimum of the distance on the whole cell. Trim curves are leaves of the tree and are searched as curves. A cell is
//! bisected into parts that are proved to be trimmed away, to lie outside of the ball about the query, to hold no
//! stationary point, or to be so small that half the squared distance is convex on them: then the one minimum is found,
//! and counts if it is inside.

use std::cell::Cell;

use super::PatchSet;
use super::ball::outside_ball;
use super::local::{Local, Region, TrimPlace};
use super::piece::{Piece, box_distance2, hull, split};
use super::search::{ROUGH, Search, at, region_of};
use super::subdivide::extents;
use super::trimmed::{CurveLeaf, curve_outside_ball, split_curve};
use crate::surface::{Surface, Vec3};
use crate::trim::Part;

/// Newton steps along a curve.
const ITERATIONS: usize = 40;
const HALVINGS: usize = 12;
/// Tolerance of points of curves: as fine as rounding allows, because proofs start at them.
const FINE: f64 = 1e-14;

/// Parts still to be looked at, with their nets one after the other.
#[derive(Default)]
struct Room {
    nets: Vec<[f64; 4]>,
    parts: Vec<CellPart>,
    curves: Vec<[f64; 2]>,
    ball: Vec<[f64; 4]>,
}

struct CellPart {
    /// Parameters 0 to 1 of the piece.
    range: [[f64; 2]; 2],
    depth: u32,
}

thread_local! {
    static ROOM: Cell<Room> = Cell::new(Room::default());
}

/// Point of a trim curve with the distance's derivatives along the curve.
#[derive(Clone, Copy)]
struct OnCurve {
    t: f64,
    local: Local,
    /// Derivatives of half the squared distance.
    slope: f64,
    bend: f64,
    /// Squared length of the tangent.
    metric: f64,
}

impl<S: Surface> PatchSet<S> {
    /// Whether a point of a patch is trimmed away.
    pub(super) fn trimmed_away(&self, patch: u32, xi: [f64; 2]) -> bool {
        self.patches[patch as usize]
            .trim()
            .is_some_and(|trim| !trim.contains(xi))
    }

    /// Point at `t` of a trim curve; `None` where the patch has none of that number.
    fn on_curve(
        &self,
        q: &Vec3,
        patch: u32,
        curve: u32,
        t: f64,
        span: [usize; 2],
    ) -> Option<OnCurve> {
        let c = self.patches[patch as usize].trim()?.curve(curve as usize)?;
        let c = c.parameter.jet(t);
        let region = self.region(patch, span);
        let mut local = self.state(q, &region, [c.point.x, c.point.y], span);
        let [r1, r2] = local.jet.rho_i;
        let [r11, r12, r22] = local.jet.rho_ij;
        let (u, v) = (c.d1.x, c.d1.y);
        let d1 = r1 * u + r2 * v;
        let d2 = r11 * (u * u) + r12 * (2.0 * u * v) + r22 * (v * v) + r1 * c.d2.x + r2 * c.d2.y;
        let d = q - local.jet.rho;
        // The trim holds the point, whatever the sides of the domain do.
        local.active = [true; 2];
        Some(OnCurve {
            t,
            local,
            slope: -d.dot(&d1),
            bend: d1.norm_squared() - d.dot(&d2),
            metric: d1.norm_squared(),
        })
    }

    /// Safeguarded Newton iteration along a trim curve from `t` within `range`, in one span of the surface.
    fn descend_curve(
        &self,
        q: &Vec3,
        (patch, curve): (u32, u32),
        range: [f64; 2],
        t: f64,
        span: [usize; 2],
    ) -> Option<Local> {
        let [low, high] = range;
        let mut s = self.on_curve(q, patch, curve, t.clamp(low, high), span)?;
        let mut converged = false;
        for _ in 0..ITERATIONS {
            let held = s.t <= low && s.slope > 0.0 || s.t >= high && s.slope < 0.0;
            let small = FINE * FINE * s.metric * s.local.d2.max(self.size * self.size);
            if held || s.slope * s.slope <= small {
                converged = true;
                break;
            }
            let f = if s.bend > 0.0 { s.bend } else { s.metric };
            let mut step = -s.slope / f;
            let noise = 1e-15 * (s.local.d2 + s.local.jet.rho.norm_squared());
            let mut next = None;
            for _ in 0..HALVINGS {
                let t = (s.t + step).clamp(low, high);
                if t == s.t {
                    break;
                }
                let trial = self.on_curve(q, patch, curve, t, span)?;
                let closer = trial.local.d2 < s.local.d2;
                if closer
                    || trial.local.d2 <= s.local.d2 + noise && trial.slope.abs() < s.slope.abs()
                {
                    next = Some(trial);
                    break;
                }
                step *= 0.5;
            }
            let Some(next) = next else {
                // No representable progress.
                let limit = 1e-9 * s.local.d2.sqrt().max(self.size);
                converged = s.slope * s.slope <= limit * limit * s.metric;
                break;
            };
            s = next;
        }
        let domain = self.patches[patch as usize].trim()?.curve(curve as usize)?;
        let domain = domain.parameter.domain();
        let end = if s.t <= domain[0] {
            -1
        } else {
            i8::from(s.t >= domain[1])
        };
        let free = end == 0;
        s.local.trim = Some(TrimPlace {
            curve,
            t: s.t,
            end,
            focal: free && s.bend <= 1e-7 * s.metric,
        });
        s.local.converged = converged;
        Some(s.local)
    }

    /// The point of the trim nearest in the parameter plane, moved along its curve to where the distance is least, over from
    /// leaf to leaf.
    pub(super) fn slide_on_trim(&self, q: &Vec3, patch: u32, xi: [f64; 2]) -> Option<Local> {
        let trim = self.patches[patch as usize].trim()?;
        let scale = self.grids[patch as usize].scale.map(|s| 1.0 / s);
        let near = trim.nearest_border(xi, scale, f64::INFINITY)?;
        self.slide_along(q, patch, near.curve, near.t)
    }

    /// Local minimum of the distance along the loop from a point of a curve.
    fn slide_along(&self, q: &Vec3, patch: u32, curve: u32, t: f64) -> Option<Local> {
        let leaves = &self.trimmed.leaves;
        let mut number = self.trimmed.leaf_at(patch, curve, t)?;
        let leaf = &leaves[number];
        let mut best = self.descend_curve(q, (patch, leaf.curve), leaf.t, t, leaf.span)?;
        let trim = self.patches[patch as usize].trim()?;
        for _ in 0..64 {
            let leaf = &leaves[number];
            let place = best.trim?;
            let ahead = place.t >= leaf.t[1];
            if !ahead && place.t > leaf.t[0] {
                break;
            }
            // The leaf beyond the end, of the same curve or of the next one.
            let side = usize::from(ahead);
            let domain = trim.curve(leaf.curve as usize)?.parameter.domain();
            let at_end = place.t == domain[side];
            let (curve, t) = if at_end {
                let curve = trim.neighbours(leaf.curve as usize)?[side];
                let t = trim.curve(curve)?.parameter.domain()[1 - side];
                (curve as u32, t)
            } else {
                (leaf.curve, place.t)
            };
            let next = match self.trimmed.leaf_at(patch, curve, t) {
                // The end of one leaf is the start of the next, which is found; going back, the one before is meant.
                Some(n) if !at_end && !ahead && n > 0 => n - 1,
                Some(n) => n,
                None => break,
            };
            let leaf = &leaves[next];
            if next == number || (leaf.patch, leaf.curve) != (patch, curve) {
                break;
            }
            let found = self.descend_curve(q, (patch, curve), leaf.t, t, leaf.span)?;
            if found.d2 >= best.d2 {
                break;
            }
            (best, number) = (found, next);
        }
        Some(best)
    }

    /// Brings a point of a trim curve to machine precision, on over the ends of leaves and curves.
    pub(super) fn polish_on_trim(&self, q: &Vec3, start: Local) -> Local {
        let Some(place) = start.trim else {
            return start;
        };
        match self.slide_along(q, start.region.patch, place.curve, place.t) {
            Some(s) if s.d2 <= start.d2 * (1.0 + 1e-14) => s,
            _ => start,
        }
    }

    /// A polished point, or where that is trimmed away or on the border the point that the trim stops it at.
    #[cold]
    #[inline(never)]
    pub(super) fn stopped_by_trim(&self, q: &Vec3, s: Local) -> Local {
        let patch = s.region.patch;
        if self.trimmed_away(patch, s.xi) {
            return self.slide_on_trim(q, patch, s.xi).unwrap_or(s);
        }
        // Where the border follows a line at which the region ends anyway, the trim is what holds the point.
        let held =
            s.active != [false; 2] && self.trimmed.is_cut(self.piece_number(patch, s.span, s.xi));
        if held
            && let Some(trim) = self.patches[patch as usize].trim()
            && trim.on_border(s.xi, 1e-10)
            && let Some(t) = self.slide_on_trim(q, patch, s.xi)
            && t.d2 <= s.d2 * (1.0 + 1e-14) + 1e-28 * self.size * self.size
        {
            return t;
        }
        s
    }
}

impl<S: Surface> Search<'_, S> {
    /// Starts on the trim curve nearest to a point that is trimmed away.
    #[cold]
    pub(super) fn start_on_border(&mut self, patch: u32, xi: [f64; 2]) {
        if let Some(local) = self.set.slide_on_trim(&self.q, patch, xi)
            && let Some(place) = local.trim
            && let Some(leaf) = self.set.trimmed.leaf_at(patch, place.curve, place.t)
        {
            self.offer((self.set.pieces.count() + leaf) as u32, &local);
        }
    }

    /// Searches a piece of a trim curve, `id` counted from the first leaf.
    #[cold]
    #[inline(never)]
    pub(super) fn curve_leaf(&mut self, id: usize) {
        let set = self.set;
        let leaf = &set.trimmed.leaves[id];
        let mut room = ROOM.take();
        self.search_curve((set.pieces.count() + id) as u32, leaf, &mut room);
        ROOM.set(room);
    }

    fn search_curve(&mut self, id: u32, leaf: &CurveLeaf, room: &mut Room) {
        let set = self.set;
        let net = set.trimmed.net(leaf);
        let size = net.len();
        let Room {
            nets, curves, ball, ..
        } = room;
        nets.clear();
        nets.extend_from_slice(net);
        curves.clear();
        curves.push([0.0, 1.0]);
        while let Some([a, b]) = curves.pop() {
            let start = curves.len() * size;
            // One iteration on the whole leaf finds a point that is only as near.
            let c = if start == 0 { self.wide() } else { self.cut() };
            if c < 0.0 {
                return;
            }
            let own = &nets[start..start + size];
            let [low, high] = hull(own);
            if c.is_finite()
                && (box_distance2(&self.q, &low, &high) >= c * c
                    || curve_outside_ball(own, &self.q, c, ball))
            {
                continue;
            }
            if !self.spend(leaf.patch) {
                return;
            }
            // Where the chord is nearest.
            let ends = [&own[0], &own[size - 1]].map(|p| Vec3::new(p[0], p[1], p[2]) / p[3]);
            let chord = ends[1] - ends[0];
            let share = (self.q - ends[0]).dot(&chord) / chord.norm_squared();
            let share = if share.is_finite() {
                share.clamp(0.0, 1.0)
            } else {
                0.5
            };
            let [t0, t1] = leaf.t;
            let range = [a, b].map(|s| t0 + s * (t1 - t0));
            let t = range[0] + share * (range[1] - range[0]);
            let key = (leaf.patch, leaf.curve);
            let found = set.descend_curve(&self.q, key, range, t, leaf.span);
            let mut cut = 0.5;
            if let Some(local) = found {
                self.offer(id, &local);
                if let Some(place) = local.trim {
                    let s = (place.t - range[0]) / (range[1] - range[0]);
                    // Beside a stationary point the distance only grows, and bounds are sharp.
                    if s > 1e-3 && s < 1.0 - 1e-3 && b - a > 1e-3 {
                        cut = s;
                    }
                }
            }
            if (high - low).norm() < 1e-8 * set.size {
                continue;
            }
            let c = self.cut();
            if c >= 0.0
                && c.is_finite()
                && curve_outside_ball(&nets[start..start + size], &self.q, c, ball)
            {
                continue;
            }
            nets.resize(start + 2 * size, [0.0; 4]);
            let (left, right) = nets[start..].split_at_mut(size);
            split_curve(left, &mut right[..size], cut);
            let middle = a + cut * (b - a);
            curves.push([a, middle]);
            curves.push([middle, b]);
        }
    }

    /// Searches a cell that the border of its trim runs through.
    #[cold]
    #[inline(never)]
    pub(super) fn cut_cell(&mut self, id: u32) {
        let set = self.set;
        let piece = set.piece(id);
        if self.excluded(piece) {
            return;
        }
        let u = piece.own.seed(&self.q).map(|u| u.clamp(0.05, 0.95));
        let local = self.iterate(id, piece, u);
        let inside = !set.trimmed_away(piece.patch, local.xi);
        let settled = || {
            local.converged
                && set
                    .proofs(id, piece)
                    .settle_cell(&self.q, &local, self.slack())
        };
        if inside && settled() || self.cut() < 0.0 {
            return;
        }
        let mut room = ROOM.take();
        self.bisect_cell(id, piece, &mut room);
        ROOM.set(room);
    }

    fn bisect_cell(&mut self, id: u32, piece: &Piece, room: &mut Room) {
        let set = self.set;
        let Some(trim) = set.patches[piece.patch as usize].trim() else {
            return;
        };
        let net = piece.net();
        let size = net.len();
        // Sides at which the surface ends or breaks may hold a minimum that is not stationary.
        let smooth = set.region(piece.patch, piece.span).domain;
        let Room { nets, parts, .. } = room;
        nets.clear();
        nets.extend_from_slice(net);
        parts.clear();
        parts.push(CellPart {
            range: [[0.0, 1.0]; 2],
            depth: 0,
        });
        while let Some(part) = parts.pop() {
            let start = parts.len() * size;
            let c = self.cut();
            if c < 0.0 {
                return;
            }
            let own = &nets[start..start + size];
            if c.is_finite() {
                let [low, high] = hull(own);
                if box_distance2(&self.q, &low, &high) >= c * c
                    || outside_ball(own, piece.degree, &self.q, c)
                {
                    continue;
                }
            }
            let [low, high] = [0, 1].map(|e| at(piece, part.range.map(|r| r[e])));
            let domain = [0, 1].map(|k| [low[k], high[k]]);
            if part.depth > 0 && trim.part(domain) == Part::Outside {
                continue;
            }
            if !self.spend(piece.patch) {
                return;
            }
            let middle = at(piece, part.range.map(|[a, b]| 0.5 * (a + b)));
            let region = Region {
                domain,
                ..region_of(piece)
            };
            let s = set.state(&self.q, &region, middle, piece.span);
            let hard = [0, 1].map(|k| {
                domain[k][0] <= smooth[k][0] && s.gradient[k] > 0.0
                    || domain[k][1] >= smooth[k][1] && s.gradient[k] < 0.0
            });
            match verdict(piece, &s, &part.range, hard) {
                Verdict::Empty => continue,
                Verdict::Convex => {
                    let found = set.descend(&self.q, &region, middle, piece.span, ROUGH);
                    self.offer(id, &found);
                    if found.converged {
                        continue;
                    }
                }
                Verdict::Open => {}
            }
            let extent = extents(&nets[start..start + size], piece.degree);
            if extent[0].max(extent[1]) < 1e-8 * set.size {
                continue;
            }
            let dir = usize::from(extent[1] > extent[0]);
            let [a, b] = part.range[dir];
            nets.resize(start + 2 * size, [0.0; 4]);
            let (left, right) = nets[start..].split_at_mut(size);
            split(left, &mut right[..size], piece.degree, dir, 0.5);
            let cut = 0.5 * (a + b);
            for half in [[a, cut], [cut, b]] {
                let mut range = part.range;
                range[dir] = half;
                parts.push(CellPart {
                    range,
                    depth: part.depth + 1,
                });
            }
        }
    }
}

/// What is known of the stationary points of a part.
enum Verdict {
    /// There is none.
    Empty,
    /// There is one at most, the minimum.
    Convex,
    Open,
}

/// Looks at half the squared distance `F` from the middle of a part, in parameters scaled so that tangents are no longer than
/// one: its Hessian changes by `L r` at most over a distance `r`, `L` the bound on third derivatives, so it stays
/// positive definite where its smallest eigenvalue exceeds that; and the gradient, which changes by at most
/// `(|F_ij| + L r / 2) r`, cannot vanish where it is longer. Directions `hard` do not count for that.
fn verdict(piece: &Piece, s: &Local, range: &[[f64; 2]; 2], hard: [bool; 2]) -> Verdict {
    let width = [0, 1].map(|k| piece.domain[k][1] - piece.domain[k][0]);
    let [m1, m2] = piece.scale;
    let (c1, c2) = (width[0] / m1, width[1] / m2);
    let h = [
        s.hessian[0] * c1 * c1,
        s.hessian[1] * c1 * c2,
        s.hessian[2] * c2 * c2,
    ];
    let half = [0, 1].map(|k| 0.5 * piece.scale[k] * (range[k][1] - range[k][0]));
    let r = half[0].hypot(half[1]);
    let far = s.d2.sqrt() + r * std::f64::consts::SQRT_2;
    let third = 3.0 * std::f64::consts::SQRT_2 * piece.second + piece.third * far;
    let (mean, spread) = (0.5 * (h[0] + h[2]), 0.5 * (h[0] - h[2]));
    let spread = spread.hypot(h[1]);
    let free = |k: usize, c: f64| if hard[k] { 0.0 } else { s.gradient[k] * c };
    let slope = free(0, c1).hypot(free(1, c2));
    // A thousandth is left for rounding.
    if 0.999 * slope > (mean.abs() + spread + 0.5 * third * r) * r {
        Verdict::Empty
    } else if 0.999 * (mean - spread) > third * r {
        Verdict::Convex
    } else {
        Verdict::Open
    }
}
