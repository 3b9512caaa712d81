//! Cells: pieces small enough to be nearly flat, each with a block of cells around it for which one test proves that a
//! stationary point is the nearest one, and with its distance from everything outside of the block.
//!
//! The proofs are nearly all of the work of setting up a set, and queries ask for those of the cells that they end in only: each
//! is made when it is first asked for.

use super::convex::{Axes, Convex, axes};
use super::local::Local;
use super::piece::{Piece, Place, split};
use super::set::PatchSet;
use crate::bezier::BezierPiece;
use crate::surface::{Surface, Vec3};
use std::sync::OnceLock;

/// Control polygons of a cell turn by about this much at most (radians), unless there would be more than [`MOST`].
const TURN: f64 = 0.4;
/// Their legs differ by about this factor at most, unless there would be more than [`MOST_STRETCH`] cells.
const STRETCH: f64 = 1.6;
const MOST_STRETCH: f64 = 4.0;
/// Most cells of one span in each direction.
const MOST: usize = 8;

/// In how many parts a Bezier piece is to be cut in each direction.
pub(crate) fn parts(bezier: &BezierPiece) -> [usize; 2] {
    let n1 = bezier.degree[0] + 1;
    let n2 = bezier.degree[1] + 1;
    let point = |k: usize| {
        let [x, y, z, w] = bezier.points[k];
        Vec3::new(x, y, z) / w
    };
    let turn = |lines: usize, count: usize, at: &dyn Fn(usize, usize) -> usize| {
        let mut most = 0.0f64;
        for line in 0..lines {
            let mut sum = 0.0;
            let legs = (1..count).map(|k| (point(at(line, k)) - point(at(line, k - 1))).norm());
            let (short, long) = legs.fold((f64::INFINITY, 0.0f64), |s, l| (s.0.min(l), s.1.max(l)));
            if short > 0.0 {
                let parts = (long / short).ln() / STRETCH.ln();
                most = most.max(parts.min(MOST_STRETCH) * TURN);
            }
            for k in 2..count {
                let [a, b, c] = [k - 2, k - 1, k].map(|k| point(at(line, k)));
                let (u, v) = (b - a, c - b);
                sum += u.cross(&v).norm().atan2(u.dot(&v));
            }
            most = most.max(sum);
        }
        // NaN ends as one part.
        ((most / TURN).ceil() as usize).clamp(1, MOST)
    };
    [
        turn(n2, n1, &|line, k| k + n1 * line),
        turn(n1, n2, &|line, k| line + n1 * k),
    ]
}

/// Cuts a Bezier piece into equal parts in each direction and calls `f` with place and net of each, xi1 fastest.
pub(super) fn cut(
    bezier: &BezierPiece,
    parts: [usize; 2],
    mut f: impl FnMut([usize; 2], &[[f64; 4]]),
) {
    let size = bezier.points.len();
    let mut rest = bezier.points.clone();
    let mut row = vec![[0.0; 4]; size];
    let mut row_rest = row.clone();
    let mut cell = row.clone();
    // First strips of xi2, then cells.
    for j in 0..parts[1] {
        row_rest.copy_from_slice(&rest);
        if j + 1 < parts[1] {
            let t = 1.0 / (parts[1] - j) as f64;
            split(&mut row_rest, &mut row, bezier.degree, 1, t);
            std::mem::swap(&mut rest, &mut row);
        }
        for i in 0..parts[0] {
            cell.copy_from_slice(&row_rest);
            if i + 1 < parts[0] {
                let t = 1.0 / (parts[0] - i) as f64;
                split(&mut cell, &mut row, bezier.degree, 0, t);
                std::mem::swap(&mut row_rest, &mut row);
            }
            f([i, j], &cell);
        }
    }
}

/// The net of the part at a place of those that [`cut`] makes, to the last bit.
pub(super) fn part(bezier: BezierPiece, parts: [usize; 2], place: [usize; 2]) -> Vec<[f64; 4]> {
    let mut net = bezier.points;
    if parts == [1, 1] {
        return net;
    }
    let mut rest = vec![[0.0; 4]; net.len()];
    for dir in [1, 0] {
        for k in 0..=place[dir] {
            if k + 1 < parts[dir] {
                let t = 1.0 / (parts[dir] - k) as f64;
                split(&mut net, &mut rest, bezier.degree, dir, t);
                if k < place[dir] {
                    std::mem::swap(&mut net, &mut rest);
                }
            }
        }
    }
    net
}

/// A cell within its surroundings.
#[derive(Debug, Clone)]
pub(super) struct Cell {
    /// The cells around it up to the next crease or edge: `[direction][first, end]`, numbers within the patch.
    pub block: [[u32; 2]; 2],
    /// Box along the axes of the cell.
    pub slab: Slab,
    /// Parameters (0 to 1) of the cell grow along these vectors, from 1/2 at the middle of the slab; zero where the cell spans
    /// no plane.
    seed: [Vec3; 2],
    /// Whether it spans a plane.
    spans: bool,
    proofs: OnceLock<Box<Proofs>>,
}

/// What proves that stationary points of a cell are nearest ones.
#[derive(Debug, Clone)]
pub(super) struct Proofs {
    /// Proof for the block, and the block's widths in the parameters.
    around: Convex,
    around_width: [f64; 2],
    /// Proof for the cell alone, and its widths.
    own: Convex,
    own_width: [f64; 2],
    /// Lower bound of the distance between the cell and everything outside of the block.
    pub clear: f64,
}

/// A box along given axes.
#[derive(Debug, Clone)]
pub(super) struct Slab {
    axes: Axes,
    middle: Vec3,
    half: Vec3,
}

impl Slab {
    fn new(net: &[[f64; 4]], axes: &Axes) -> Slab {
        let mut low = Vec3::from_element(f64::INFINITY);
        let mut high = -low;
        for &[x, y, z, w] in net {
            let p = along(axes, &(Vec3::new(x, y, z) / w));
            low = low.inf(&p);
            high = high.sup(&p);
        }
        Slab {
            axes: *axes,
            middle: (low + high) * 0.5,
            half: (high - low) * 0.5,
        }
    }

    /// Squared distance of a point.
    #[inline]
    pub fn distance2(&self, q: &Vec3) -> f64 {
        let p = along(&self.axes, q) - self.middle;
        let mut sum = 0.0;
        for k in 0..3 {
            let d = (p[k].abs() - self.half[k]).max(0.0);
            sum += d * d;
        }
        sum
    }

    /// Lower bound of the squared distance of everything in another box, which has axes along the coordinates.
    fn box_separation2(&self, low: &Vec3, high: &Vec3) -> f64 {
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let p = along(&self.axes, &middle) - self.middle;
        let mut sum = 0.0;
        for k in 0..3 {
            let reach = self.half[k] + self.axes[k].abs().dot(&half);
            let d = (p[k].abs() - reach).max(0.0);
            sum += d * d;
        }
        sum
    }

    /// Lower bound of the squared distance of another control net's hull.
    fn net_separation2(&self, net: &[[f64; 4]]) -> f64 {
        let other = Slab::new(net, &self.axes);
        let mut sum = 0.0;
        for k in 0..3 {
            let d = (self.middle[k] - other.middle[k]).abs() - self.half[k] - other.half[k];
            sum += d.max(0.0) * d.max(0.0);
        }
        sum
    }
}

#[inline]
fn along(axes: &Axes, p: &Vec3) -> Vec3 {
    Vec3::new(axes[0].dot(p), axes[1].dot(p), axes[2].dot(p))
}

impl Cell {
    /// Whether a piece belongs to the block around this cell, which is one of patch `patch`.
    #[inline]
    pub fn covers(&self, patch: u32, piece: &Place) -> bool {
        piece.patch == patch
            && (0..2).all(|k| {
                let [first, end] = self.block[k];
                piece.cell[k] >= first && piece.cell[k] < end
            })
    }

    /// Whether a stationary point of this cell (which is `piece`) is stationary in its block. Points that the cell's own border
    /// holds inside of the block are not.
    #[inline]
    pub fn is_stationary_in_block(&self, piece: &Place, s: &Local) -> bool {
        s.converged
            && (0..2).all(|k| {
                let [first, end] = self.block[k];
                !s.active[k]
                    || s.at[k] < 0 && piece.cell[k] == first
                    || s.at[k] > 0 && piece.cell[k] + 1 == end
            })
    }

    /// Where to look for the foot of `q` (parameters 0 to 1 of the cell, outside of it by half of its width at most).
    #[inline]
    pub fn seed(&self, q: &Vec3) -> [f64; 2] {
        let slab = &self.slab;
        let p = along(&slab.axes, q) - slab.middle;
        self.seed.map(|s| (0.5 + s.dot(&p)).clamp(-0.5, 1.5))
    }
}

impl Proofs {
    /// Whether a point that is stationary in the block is proved to be the nearest point of the block.
    #[inline]
    pub fn settle_block(&self, q: &Vec3, s: &Local, slack: f64) -> bool {
        holds(&self.around, q, s, &self.around_width, slack)
    }

    /// Whether a stationary point of the cell is proved to be the nearest point of the cell.
    #[inline]
    pub fn settle_cell(&self, q: &Vec3, s: &Local, slack: f64) -> bool {
        holds(&self.own, q, s, &self.own_width, slack)
    }
}

/// Whether a stationary point of a rectangle is proved to be its nearest point, up to `slack` in the squared distance.
#[inline]
pub(super) fn holds(convex: &Convex, q: &Vec3, s: &Local, width: &[f64; 2], slack: f64) -> bool {
    let (mut held, mut slope) = ([0.0; 2], s.gradient);
    for k in 0..2 {
        if s.active[k] {
            held[k] = 2.0 * s.gradient[k].abs() / width[k];
            slope[k] = 0.0;
        }
    }
    convex.holds(&(q - s.jet.rho), held, slope, slack)
}

impl<S: Surface> PatchSet<S> {
    /// A piece, made when it is first asked for.
    #[inline]
    pub(super) fn piece(&self, number: u32) -> &Piece {
        self.pieces.get(number, || self.make(number))
    }

    /// Where a piece lies; makes nothing.
    pub(super) fn piece_place(&self, number: u32) -> Place {
        let after = self.grids.partition_point(|grid| grid.first <= number);
        self.grids[after - 1].place(after as u32 - 1, number)
    }

    /// Degrees and control net of a piece, which are not kept.
    pub(super) fn net_at(&self, place: &Place) -> ([usize; 2], Vec<[f64; 4]>) {
        let grid = &self.grids[place.patch as usize];
        grid.net(&self.patches[place.patch as usize], place)
    }

    #[cold]
    #[inline(never)]
    fn make(&self, number: u32) -> Box<Piece> {
        let place = self.piece_place(number);
        let (degree, net) = self.net_at(&place);
        let grid = &self.grids[place.patch as usize];
        let block = [0, 1].map(|k| {
            let spans = grid.smooth_spans(k, place.span[k]);
            let [first, end] = spans.map(|s| grid.cells[k][s]);
            [
                place.cell[k].saturating_sub(1).max(first),
                (place.cell[k] + 2).min(end),
            ]
        });
        let found = axes(&net, degree);
        let plain = [Vec3::x(), Vec3::y(), Vec3::z()];
        let cell = Cell {
            block: self.trimmed.block(grid, place.cell, block),
            slab: Slab::new(&net, found.as_ref().unwrap_or(&plain)),
            seed: (found.as_ref())
                .map_or([Vec3::zeros(); 2], |axes| seed_vectors(&net, degree, axes)),
            spans: found.is_some(),
            proofs: OnceLock::new(),
        };
        Box::new(Piece::new(place, degree, net, cell))
    }

    /// The proofs of a piece, made when they are first asked for.
    #[inline]
    pub(super) fn proofs<'a>(&'a self, number: u32, piece: &'a Piece) -> &'a Proofs {
        piece.own.proofs.get_or_init(|| self.prove(number, piece))
    }

    #[cold]
    #[inline(never)]
    fn prove(&self, number: u32, piece: &Piece) -> Box<Proofs> {
        let trimmed = &self.trimmed;
        let grid = &self.grids[piece.patch as usize];
        let cell = &piece.own;
        let block = &cell.block;
        let mut out = Box::new(Proofs {
            around: Convex::NEVER,
            around_width: [0, 1].map(|k| {
                let [low, high] = [block[k][0], block[k][1] - 1].map(|c| {
                    let mut place = piece.cell;
                    place[k] = c;
                    self.piece(grid.piece(place)).domain[k]
                });
                high[1] - low[0]
            }),
            own: Convex::NEVER,
            own_width: piece.domain.map(|[a, b]| b - a),
            clear: 0.0,
        });
        if !cell.spans {
            return out;
        }
        let axes = &cell.slab.axes;
        out.own = Convex::new(axes, std::iter::once(piece));
        if !trimmed.is_inside(number) {
            // Never the middle of a block.
            return out;
        }
        let members = (block[1][0]..block[1][1])
            .flat_map(|j| (block[0][0]..block[0][1]).map(move |i| self.piece(grid.piece([i, j]))));
        out.around = Convex::new(axes, members);
        // The cells beside the block are outside of it and near: the scan has little left to look at.
        let mut clear2 = f64::INFINITY;
        for k in 0..2 {
            let last = grid.cells[k][grid.spans[k]];
            let beside = [block[k][0].checked_sub(1), Some(block[k][1])];
            for place in beside.into_iter().flatten().filter(|&place| place < last) {
                let mut other = piece.cell;
                other[k] = place;
                let other = self.piece(grid.piece(other));
                clear2 = clear2.min(cell.slab.net_separation2(other.net()));
            }
        }
        if clear2 <= 0.0 {
            return out;
        }
        self.tree.scan(
            |low, high| cell.slab.box_separation2(low, high),
            clear2,
            |number| {
                // Trim curves lie in cells, which count.
                if (number as usize) < self.pieces.count() {
                    let other = self.piece(number);
                    if !cell.covers(piece.patch, other) {
                        clear2 = clear2.min(cell.slab.net_separation2(other.net()));
                    }
                }
                // Nothing is below zero, so that ends the scan.
                if clear2 > 0.0 { clear2 } else { -1.0 }
            },
        );
        out.clear = clear2.max(0.0).sqrt();
        out
    }
}

/// The vectors that are dual to the mean tangents, along the axes.
fn seed_vectors(net: &[[f64; 4]], degree: [usize; 2], axes: &Axes) -> [Vec3; 2] {
    let point = |k: usize| {
        along(
            axes,
            &(Vec3::new(net[k][0], net[k][1], net[k][2]) / net[k][3]),
        )
    };
    let (n1, n) = (degree[0] + 1, net.len());
    let [a, b, c, d] = [point(0), point(n1 - 1), point(n - n1), point(n - 1)];
    let one = (b - a + d - c) * 0.5;
    let two = (c - a + d - b) * 0.5;
    let det = one.x * two.y - one.y * two.x;
    if det.abs() <= 1e-12 * one.norm() * two.norm() || det.is_nan() {
        return [Vec3::zeros(); 2];
    }
    [
        Vec3::new(two.y, -two.x, 0.0) / det,
        Vec3::new(-one.y, one.x, 0.0) / det,
    ]
}
