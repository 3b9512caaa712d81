//! Bisection of a piece: every part is proved to hold nothing nearer than the best point, or cut.

use super::ball::outside_ball;
use super::cells::holds;
use super::convex::Convex;
use super::local::{Local, Region};
use super::piece::{Piece, box_distance2, hull, split};
use super::search::{ROUGH, Search, at, region_of};
use crate::surface::{Surface, Vec3};
use std::cell::Cell;

thread_local! {
    /// Room for subdivision, kept from query to query.
    static ROOM: Cell<Room> = Cell::new(Room::default());
}

/// Parts that have been cut this often are proved by their convexity. Before, the bound on third derivatives about a
/// stationary point costs less.
const DEEP: u32 = 12;
/// Parts of a piece on a sphere that are looked at where the sphere proves that none is nearer.
const MOST_ON_SPHERE: usize = 1000;

/// Parts that are still to be looked at, with their control nets one after the other.
#[derive(Default)]
struct Room {
    nets: Vec<[f64; 4]>,
    parts: Vec<Part>,
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
pub(super) struct Known {
    at: [f64; 2],
    radius: f64,
}

impl<S: Surface> Search<'_, S> {
    /// Where a stationary point is, and how far around it the piece is proved to be no nearer.
    ///
    /// With `F = |q - rho|^2 / 2` and `g = F_,i`, every point of the piece satisfies
    /// `F >= F* + g.D + D.F_ij.D / 2 - L |D|^3 / 6`, `L` a bound on the third derivative; on an active bound `g.D >= 0`
    /// is worth `2 g / extent` of the Hessian. So `F >= F*` for `|D| <= 3 lambda / L`.
    pub(super) fn known(&self, piece: &Piece, s: &Local) -> Known {
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
        // What the iteration has left over of the gradient must be worth less than the slack: a hundredth of the radius is
        // given up for it, which leaves `lambda |D|^2 / 200`.
        let left = |k: usize, c: f64| if s.active[k] { 0.0 } else { s.gradient[k] * c };
        let (g1, g2) = (left(0, c1), left(1, c2));
        let worth = 100.0 * (g1 * g1 + g2 * g2);
        let radius = if lambda > 0.0 && worth <= self.slack() * lambda {
            0.99 * 3.0 * lambda / third
        } else {
            0.0
        };
        Known { at, radius }
    }

    /// Proves or improves by bisection.
    #[cold]
    #[inline(never)]
    pub(super) fn subdivide(&mut self, id: u32, piece: &Piece, first: Known) {
        let mut room = ROOM.take();
        self.bisect(id, piece, first, &mut room);
        ROOM.set(room);
    }

    fn bisect(&mut self, id: u32, piece: &Piece, first: Known, room: &mut Room) {
        let net = piece.net();
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
        let mut tries = 0;
        while let Some(part) = parts.pop() {
            let start = parts.len() * size;
            self.sharpen();
            if self.cut() < 0.0 || self.behind_sphere(piece.patch) {
                return;
            }
            // The sphere itself proves that nothing is nearer; what is left is which of its points is taken.
            tries += 1;
            if tries > MOST_ON_SPHERE && self.is_on_nearest_sphere(piece.patch) {
                return;
            }
            if known.iter().any(|k| covered(piece, k, &part.range)) {
                continue;
            }
            let own = &nets[start..start + size];
            if part.depth > 0 && self.misses(own, piece.degree) {
                continue;
            }
            if !self.spend(piece.patch) {
                return;
            }
            let extent = extents(own, piece.degree);
            let smallest = extent[0].max(extent[1]) < 1e-8 * self.set.size;
            let middle = part.range.map(|[a, b]| 0.5 * (a + b));
            let mut found = None;
            let deep = part.depth >= DEEP;
            if deep || smallest {
                let width = [0, 1].map(|k| {
                    let [a, b] = part.range[k];
                    (b - a) * (piece.domain[k][1] - piece.domain[k][0])
                });
                let convex = Convex::of_part(own, piece.degree, width);
                let [low, high] = hull(own);
                let d = self.q - (low + high) * 0.5;
                let promising = convex.holds(&d, [0.0; 2], [0.0; 2], 0.0);
                // Far from convex an iteration takes long and seldom ends in the part: first see whether it is worth it.
                let local = match promising || smallest {
                    true => self.iterate_part(piece, &part.range),
                    false => {
                        let xi = at(piece, middle);
                        self.set.state(&self.q, &region_of(piece), xi, piece.span)
                    }
                };
                if let Some(stationary) = self.offer_part(id, piece, &local) {
                    latest = (latest + 1) % known.len();
                    known[latest] = stationary;
                }
                let settled = || holds(&convex, &self.q, &local, &width, self.slack());
                if smallest || promising && local.converged && settled() {
                    continue;
                }
                found = promising.then_some(local);
            } else if part.depth > 0 && part.depth % 2 == 0 {
                let local = self.iterate(id, piece, middle);
                let stationary = self.known(piece, &local);
                let apart = |k: &Known| {
                    (k.at[0] - stationary.at[0]).abs() + (k.at[1] - stationary.at[1]).abs() > 1e-9
                };
                if known.iter().all(apart) {
                    latest = (latest + 1) % known.len();
                    known[latest] = stationary;
                }
                if covered(piece, &stationary, &part.range) {
                    continue;
                }
            }
            let dir = usize::from(extent[1] > extent[0]);
            let [a, b] = part.range[dir];
            // A stationary point on the cut leaves parts in which the distance only grows, where the bounds are sharp.
            let inner = |x: f64| {
                let t = (x - a) / (b - a);
                (t > 0.05 && t < 0.95).then_some(t)
            };
            let place = |s: &Local| {
                let [a, b] = piece.domain[dir];
                (s.xi[dir] - a) / (b - a)
            };
            let near = || {
                let often = part.depth < 4 || deep;
                often.then(|| inner(known[latest].at[dir])).flatten()
            };
            let t = (found.as_ref().and_then(|s| inner(place(s))))
                .or_else(near)
                .unwrap_or(0.5);
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

    /// Whether a part is proved to hold nothing nearer than the best point.
    fn misses(&self, net: &[[f64; 4]], degree: [usize; 2]) -> bool {
        let [low, high] = hull(net);
        let c = self.cut();
        c.is_finite()
            && (box_distance2(&self.q, &low, &high) >= c * c
                || outside_ball(net, degree, &self.q, c))
    }

    /// The point of a part that is nearest to the query, by a local iteration from its middle.
    fn iterate_part(&self, piece: &Piece, range: &[[f64; 2]; 2]) -> Local {
        let [low, middle, high] =
            [0.0, 0.5, 1.0].map(|t| at(piece, range.map(|[a, b]| a + t * (b - a))));
        let region = Region {
            domain: [0, 1].map(|k| [low[k], high[k]]),
            ..region_of(piece)
        };
        self.set
            .descend(&self.q, &region, middle, piece.span, ROUGH)
    }

    /// Offers the stationary point of the piece that is reached from the nearest point of a part, where that may be the best
    /// one or as near.
    fn offer_part(&mut self, id: u32, piece: &Piece, local: &Local) -> Option<Known> {
        let distance = local.d2.sqrt();
        let c = self.cut();
        let nearer = distance < c;
        let as_near = distance <= self.wide()
            && !(self.best.as_ref())
                .is_some_and(|(_, best)| self.set.is_same(&best.jet.rho, &local.jet.rho));
        if !(nearer || as_near) {
            return None;
        }
        let width = piece.domain.map(|[a, b]| b - a);
        let u = [0, 1].map(|k| (local.xi[k] - piece.domain[k][0]) / width[k]);
        let found = self.iterate(id, piece, u);
        Some(self.known(piece, &found))
    }
}

/// Whether a part lies within the radius of a stationary point.
#[inline]
pub(super) fn covered(piece: &Piece, known: &Known, range: &[[f64; 2]; 2]) -> bool {
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
