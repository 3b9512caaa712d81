//! Trims: the part of a patch's parameter rectangle that belongs to the surface.
//!
//! A trim is a set of closed loops of NURBS curves in the parameter plane. A point belongs to the surface where a ray from it
//! crosses the loops an odd number of times, so the direction of loops does not matter. When a trim is made its curves are
//! cut into monotone pieces with a tree over them; a test then costs O(log n) for n pieces.

mod along;
mod attach;
mod cells;
mod index;
mod monotone;
mod polygon;

pub use along::CurvePart;
pub use attach::{TrimNote, TrimNoteKind, Trimmed};
pub use cells::RulePoint;
pub use index::{BorderPoint, Part};

use nalgebra::Vector2;

use crate::curve::NurbsCurve;
use index::Index;
#[cfg(test)]
pub(crate) use monotone::choose;
use monotone::monotone_pieces;
pub(crate) use monotone::{Monotone, binomials};
use polygon::polygon;

/// Why a trim could not be made. Loops and curves count from zero, curves within their loop.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrimError {
    /// A loop without curves.
    #[error("trim loop {0} has no curves")]
    Empty(usize),
    /// Two curves that follow each other in a loop do not meet.
    #[error("trim loop {0} is open: curve {1} ends {gap:.2e} (share of the domain) from where the next begins", gap = .2)]
    Open(usize, usize, f64),
    /// No loops at all.
    #[error("a trim needs at least one loop")]
    None,
    /// The loop that should bound the surface has no area.
    #[error("the outer trim loop {0} has no area")]
    ZeroArea(usize),
    /// A loop runs outside of the patch's domain, and not by whole periods.
    #[error("trim loop {0} leaves the domain of its surface by {beyond:.2e} (share of the domain)", beyond = .1)]
    Beyond(usize, f64),
    /// A loop had to be moved, and a number got too large.
    #[error("trim loop {0} cannot be moved into the domain")]
    Move(usize),
}

/// One curve of a trim loop.
#[derive(Debug, Clone, PartialEq)]
pub struct TrimCurve {
    /// The curve in the parameter plane (xi1, xi2), in the direction of the loop.
    pub parameter: NurbsCurve<2>,
    /// The curve in space that the file gives beside it, if any. It runs from the same start to the same end; the
    /// parameters of both need not correspond.
    pub space: Option<NurbsCurve<3>>,
    /// The file's number of the curve or edge (0 where there is none): edges of neighbouring faces may share it.
    pub entity: u32,
}

/// A closed chain of curves.
#[derive(Debug, Clone, PartialEq)]
pub struct TrimLoop {
    /// Its curves, each beginning where the one before ends, the first where the last ends.
    pub curves: Vec<TrimCurve>,
}

/// A gap between two curves that was closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosedGap {
    /// Number of the loop.
    pub loop_number: usize,
    /// Number of the curve (within its loop) before the gap.
    pub curve: usize,
    /// Its width as a share of the extent of the domain, the larger of both directions.
    pub width: f64,
}

/// The loops that bound the part of a patch's domain that belongs to the surface, with what tests need to know of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Trim {
    /// All loops; where the file gives no outer one, the border of the domain is the first.
    loops: Vec<TrimLoop>,
    /// Number of the first curve of every loop, and the number of all curves.
    first: Vec<usize>,
    /// Extent of the domain.
    extent: [f64; 2],
    gaps: Vec<ClosedGap>,
    index: Index,
}

/// Gaps up to this share of the domain are rounding and not worth telling.
const ROUNDING: f64 = 1e-12;

impl Trim {
    /// Takes closed loops. Gaps up to `gap_allowed` (a share of the extent of `domain`, the larger of both directions)
    /// between curves that follow each other are closed: both ends move to the middle of the gap, the curves with them where
    /// their knots are clamped, else a straight line is thought across it. [`gaps`](Self::gaps) tells which.
    ///
    /// # Errors
    /// No loops; empty or open loops.
    pub fn new(
        mut loops: Vec<TrimLoop>,
        domain: [[f64; 2]; 2],
        gap_allowed: f64,
    ) -> Result<Self, TrimError> {
        if loops.is_empty() {
            return Err(TrimError::None);
        }
        let extent = domain.map(|[a, b]| b - a);
        let mut gaps = Vec::new();
        let mut first = vec![0];
        for (number, a_loop) in loops.iter_mut().enumerate() {
            close(a_loop, number, extent, gap_allowed, &mut gaps)?;
            first.push(first[number] + a_loop.curves.len());
        }
        let mut pieces = Vec::new();
        let mut ranges = Vec::new();
        for (a_loop, first) in loops.iter().zip(&first) {
            let start = pieces.len();
            for (k, curve) in a_loop.curves.iter().enumerate() {
                push_curve(
                    (first + k) as u32,
                    &curve.parameter,
                    start,
                    extent,
                    &mut pieces,
                );
            }
            close_chain(&mut pieces, start, extent);
            ranges.push(start..pieces.len());
        }
        Ok(Self {
            loops,
            first,
            extent,
            gaps,
            index: Index::new(pieces, &ranges),
        })
    }

    /// The loops.
    pub fn loops(&self) -> &[TrimLoop] {
        &self.loops
    }

    /// Number of curves of all loops.
    pub fn curve_count(&self) -> usize {
        self.first[self.loops.len()]
    }

    /// Curve `k`, counted over all loops.
    pub fn curve(&self, k: usize) -> Option<&TrimCurve> {
        let (number, place) = self.place(k)?;
        self.loops[number].curves.get(place)
    }

    /// Number of the loop that curve `k` belongs to, and its place there.
    pub fn place(&self, k: usize) -> Option<(usize, usize)> {
        let number = self.first.partition_point(|&first| first <= k);
        (k < self.curve_count()).then(|| (number - 1, k - self.first[number - 1]))
    }

    /// The curves before and after curve `k` in its loop (itself where the loop has no other).
    pub fn neighbours(&self, k: usize) -> Option<[usize; 2]> {
        let (number, place) = self.place(k)?;
        let (first, n) = (self.first[number], self.loops[number].curves.len());
        Some([first + (place + n - 1) % n, first + (place + 1) % n])
    }

    /// Gaps wider than rounding that were closed.
    pub fn gaps(&self) -> &[ClosedGap] {
        &self.gaps
    }

    /// Whether a point of the parameter plane belongs to the surface. Within rounding of the border the answer is one or
    /// the other. O(log n) for n curves.
    #[inline]
    pub fn contains(&self, xi: [f64; 2]) -> bool {
        self.index.contains(xi, || ())
    }

    /// How many nodes of the tree [`contains`](Self::contains) looks at, a measure of its cost that does not depend on the
    /// machine.
    pub fn cost(&self, xi: [f64; 2]) -> usize {
        let mut count = 0;
        self.index.contains(xi, || count += 1);
        count
    }

    /// How a rectangle of parameters `[direction][start, end]` lies; one that touches a loop (to 1e-12 of the domain) is
    /// cut.
    pub fn part(&self, rectangle: [[f64; 2]; 2]) -> Part {
        let slack = self.extent.map(|e| 1e-12 * e);
        let low = [0, 1].map(|k| rectangle[k][0] - slack[k]);
        let high = [0, 1].map(|k| rectangle[k][1] + slack[k]);
        if self.index.meets(low, high) {
            return Part::Cut;
        }
        if self.contains(rectangle.map(|[a, b]| 0.5 * (a + b))) {
            Part::Inside
        } else {
            Part::Outside
        }
    }

    /// The point of the loops nearest to `xi` in the parameter plane, each direction divided by its `scale`; `None` where
    /// none is nearer than `reach`. It is a local minimum of the distance, and farther than the nearest of all by a
    /// thousandth at most.
    pub fn nearest_border(&self, xi: [f64; 2], scale: [f64; 2], reach: f64) -> Option<BorderPoint> {
        self.index.nearest(xi, scale, reach)
    }

    /// Whether `xi` lies on a loop, or no farther from it than `tolerance` times the extent of the domain.
    pub fn on_border(&self, xi: [f64; 2], tolerance: f64) -> bool {
        let reach = tolerance.max(f64::MIN_POSITIVE) * (1.0 + f64::EPSILON);
        self.nearest_border(xi, self.extent, reach).is_some()
    }

    /// Lowest and highest corner of the loops: `[direction][start, end]`.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        let mut out = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for piece in &self.index.pieces {
            let [low, high] = piece.bounds();
            for k in 0..2 {
                out[k] = [out[k][0].min(low[k]), out[k][1].max(high[k])];
            }
        }
        out
    }

    /// Polygons of the loops, closed (the first point is not repeated), nowhere farther than `tolerance` from the curves, but
    /// for rounding: a share of the extent of the domain, or of the loop in a direction in which that is larger.
    pub fn polygons(&self, tolerance: f64) -> Vec<Vec<[f64; 2]>> {
        self.polygons_within(tolerance, usize::MAX)
    }

    /// The same, coarser where a polygon would have more than `most` points in addition to those at which its pieces begin.
    pub(crate) fn polygons_within(&self, tolerance: f64, most: usize) -> Vec<Vec<[f64; 2]>> {
        let mut pieces = vec![Vec::new(); self.loops.len()];
        for piece in &self.index.pieces {
            if let Some((number, _)) = self.place(piece.curve as usize) {
                pieces[number].push(piece);
            }
        }
        let polygon = |pieces: &Vec<&Monotone>| polygon(pieces, self.extent, tolerance, most);
        pieces.iter().map(polygon).collect()
    }

    /// The monotone pieces, loop after loop.
    pub(crate) fn pieces(&self) -> &[Monotone] {
        &self.index.pieces
    }

    /// The trim with every point of the parameter plane mapped by `xi -> a xi + b` (a reversed or exchanged direction);
    /// `domain` is the mapped one.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn mapped(
        &self,
        a: &nalgebra::Matrix2<f64>,
        b: &Vector2<f64>,
        domain: [[f64; 2]; 2],
    ) -> Result<Self, TrimError> {
        let mut loops = self.loops.clone();
        for (number, a_loop) in loops.iter_mut().enumerate() {
            for curve in &mut a_loop.curves {
                curve.parameter = curve
                    .parameter
                    .mapped(|[x, y, z, w]| {
                        let p = a * Vector2::new(x, y) + b * w;
                        [p.x, p.y, z, w]
                    })
                    .map_err(|_| TrimError::Move(number))?;
            }
        }
        let mut trim = Self::new(loops, domain, 1e-9)?;
        trim.gaps.clone_from(&self.gaps);
        Ok(trim)
    }
}

/// Checks a loop and closes its gaps.
fn close(
    a_loop: &mut TrimLoop,
    number: usize,
    extent: [f64; 2],
    allowed: f64,
    gaps: &mut Vec<ClosedGap>,
) -> Result<(), TrimError> {
    let n = a_loop.curves.len();
    if n == 0 {
        return Err(TrimError::Empty(number));
    }
    let extent = Vector2::from(extent);
    let mut ends: Vec<[Vector2<f64>; 2]> =
        a_loop.curves.iter().map(|c| c.parameter.ends()).collect();
    for k in 0..n {
        let next = (k + 1) % n;
        let (end, start) = (ends[k][1], ends[next][0]);
        let width = (end - start).component_div(&extent).amax();
        if width.is_nan() || width > allowed {
            return Err(TrimError::Open(number, k, width));
        }
        if width > ROUNDING {
            gaps.push(ClosedGap {
                loop_number: number,
                curve: k,
                width,
            });
        }
        let middle = (end + start) * 0.5;
        ends[k][1] = middle;
        ends[next][0] = middle;
    }
    for (curve, ends) in a_loop.curves.iter_mut().zip(ends) {
        if curve.parameter.ends() != ends
            && let Some(moved) = curve.parameter.with_ends(ends)
        {
            curve.parameter = moved;
        }
    }
    Ok(())
}

/// Adds the monotone pieces of a curve to those of a loop, which begin at `start`.
fn push_curve(
    number: u32,
    curve: &NurbsCurve<2>,
    start: usize,
    extent: [f64; 2],
    out: &mut Vec<Monotone>,
) {
    for bezier in curve.bezier_pieces() {
        let net: Vec<[f64; 3]> = bezier.points.iter().map(|p| [p[0], p[1], p[3]]).collect();
        let before = out.len();
        monotone_pieces(number, bezier.domain, &net, out);
        if before > start {
            let to = out[before - 1].to;
            let from = out[before].from;
            if near(to, from, extent) {
                out[before].from = to;
            } else {
                let t = out[before].t[0];
                out.insert(before, Monotone::bridge(number, t, to, from));
            }
        }
    }
}

/// Lets the last piece of a loop end where the first begins.
fn close_chain(pieces: &mut Vec<Monotone>, start: usize, extent: [f64; 2]) {
    let from = pieces[start].from;
    if let Some(last) = pieces.last_mut()
        && last.to != from
    {
        if near(last.to, from, extent) {
            last.to = from;
        } else {
            let (to, curve, t) = (last.to, last.curve, last.t[1]);
            pieces.push(Monotone::bridge(curve, t, to, from));
        }
    }
}

fn near(a: [f64; 2], b: [f64; 2], extent: [f64; 2]) -> bool {
    (0..2).all(|k| (a[k] - b[k]).abs() <= 1e-14 * extent[k])
}
