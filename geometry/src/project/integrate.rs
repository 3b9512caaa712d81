//! Integrals over patches.

use super::PatchSet;
use super::topology::{Edge, EdgeCurve};
use crate::NurbsCurve;
use crate::surface::{Jet, Surface};

/// Points and weights of the Gauss rule with four points on (0, 1).
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Spans of a trimmed patch are cut so that the primitive has at least about this many intervals.
const INTERVALS: usize = 6;

/// Rational trim curves are cut until each part contributes to the area with this accuracy, as a share of the curve's box.
const EXACT: f64 = 1e-12;
/// Halvings of one interval of a polyline.
const HALVINGS: u32 = 10;

/// Integrates `f dxi1 dxi2` over the part of the domain that belongs to the surface: 4 x 4 Gauss points per Bezier piece of
/// an untrimmed patch. On a trimmed patch the divergence theorem of the parameter plane turns it into an integral along
/// the trim curves of the primitive of `f` in xi1. The intervals of the curves' polylines are cut where they cross knot lines
/// of the surface; each is integrated with the primitive that starts at the knot line in front of it, and every crossing adds
/// a column of whole cells.
pub(super) fn over<S: Surface, const N: usize>(
    set: &PatchSet<S>,
    patch: u32,
    edges: &[Edge],
    f: impl Fn(&Jet) -> [f64; N],
) -> [f64; N] {
    let mut sum = [0.0; N];
    let mut add = |weight: f64, values: [f64; N]| {
        for (sum, value) in sum.iter_mut().zip(values) {
            *sum += weight * value;
        }
    };
    let surface = &set.patches[patch as usize];
    let trimmed = (edges.first()).is_some_and(|e| matches!(e.curve, EdgeCurve::Trim { .. }));
    if !trimmed {
        for piece in set.grids[patch as usize].places(patch) {
            let [[a1, b1], [a2, b2]] = piece.domain;
            for (x2, w2) in GAUSS {
                for (x1, w1) in GAUSS {
                    let xi = [a1 + (b1 - a1) * x1, a2 + (b2 - a2) * x2];
                    let weight = w1 * w2 * (b1 - a1) * (b2 - a2);
                    add(weight, f(&surface.jet_in_span(piece.span, xi)));
                }
            }
        }
        return sum;
    }
    let cells = Cells::new(set, patch, &f);
    let mut columns = vec![None; cells.breaks[0].len() - 1];
    let mut start = 0;
    while start < edges.len() {
        // One loop after the other.
        let a_loop = loop_of(&edges[start]);
        let count = edges[start..].iter();
        let count = count.take_while(|e| loop_of(e) == a_loop).count();
        let along = walk(set, &edges[start..start + count], cells.breaks);
        start += count;
        let Some(last) = along.last() else { continue };
        let mut before = last.cell[0];
        for part in &along {
            // Crossing a knot line adds or takes away the whole column in front of it, up to where it is crossed.
            let (from, to) = (before.min(part.cell[0]), before.max(part.cell[0]));
            let sign = if part.cell[0] > before { -1.0 } else { 1.0 };
            for (column, rows) in columns.iter_mut().enumerate().take(to).skip(from) {
                let rows = rows.get_or_insert_with(|| cells.column(column));
                add(part.sense * sign, cells.below(column, rows, part.start));
            }
            before = part.cell[0];
            // Within its column: the primitive from the knot line to the curve.
            let [a, b] = part.interval;
            for (x, w) in GAUSS {
                let jet = part.curve.jet(a + (b - a) * x);
                let outer = part.sense * w * (b - a) * jet.d1.y;
                let from = cells.start(0, part.cell[0]);
                let row = cells.row([from, jet.point.x], jet.point.y, part.cell);
                add(outer, row);
            }
        }
    }
    sum
}

fn loop_of(edge: &Edge) -> usize {
    match edge.curve {
        EdgeCurve::Trim { a_loop, .. } => a_loop,
        EdgeCurve::Side { .. } => usize::MAX,
    }
}

/// A part of a trim curve within one cell of knot lines.
struct Part<'c> {
    curve: &'c NurbsCurve<2>,
    interval: [f64; 2],
    cell: [usize; 2],
    /// Second parameter of the surface where it starts.
    start: f64,
    sense: f64,
}

/// A loop of trim curves, cut where it crosses knot lines.
fn walk<'s, S: Surface>(
    set: &'s PatchSet<S>,
    edges: &[Edge],
    breaks: &[Vec<f64>; 2],
) -> Vec<Part<'s>> {
    let mut out = Vec::new();
    let mut cuts = Vec::new();
    for edge in edges {
        let Some(curve) = edge_curve(set, edge) else {
            continue;
        };
        cuts.clear();
        for pair in edge.samples.windows(2) {
            cuts.push(pair[0].t);
            let first = cuts.len();
            for (dir, breaks) in breaks.iter().enumerate() {
                crossings(curve, dir, breaks, [pair[0].t, pair[1].t], &mut cuts);
            }
            cuts[first..].sort_by(f64::total_cmp);
        }
        cuts.extend(edge.samples.last().map(|s| s.t));
        refine(curve, area_of(curve), &mut cuts);
        out.extend(cuts.windows(2).map(|pair| {
            let middle = curve.point(0.5 * (pair[0] + pair[1]));
            Part {
                curve,
                interval: [pair[0], pair[1]],
                cell: [0, 1].map(|k| cell(&breaks[k], middle[k])),
                start: curve.point(pair[0]).y,
                sense: edge.sense,
            }
        }));
    }
    out
}

/// Halves the intervals of a rational curve until the rule integrates what they bound in the parameter plane. (Of polynomial
/// curves of degree 3 it is exact; the ends of a hyperbola are run through thousands of times as fast as its middle.)
fn refine(curve: &NurbsCurve<2>, area: f64, cuts: &mut Vec<f64>) {
    if curve
        .homogeneous()
        .iter()
        .all(|p| p[3] == curve.homogeneous()[0][3])
    {
        return;
    }
    let moment = |a: f64, b: f64, x: f64| {
        let terms = GAUSS.iter().map(|(s, w)| {
            let jet = curve.jet(a + (b - a) * s);
            w * (b - a) * (jet.point.x - x) * jet.d1.y
        });
        terms.sum::<f64>()
    };
    let mut out = Vec::with_capacity(cuts.len());
    let mut left = Vec::new();
    for pair in cuts.windows(2) {
        left.push((pair[0], pair[1], 0));
        while let Some((a, b, depth)) = left.pop() {
            let (middle, x) = (0.5 * (a + b), curve.point(a).x);
            let halves = moment(a, middle, x) + moment(middle, b, x);
            if depth < HALVINGS && (moment(a, b, x) - halves).abs() > EXACT * area {
                left.extend([(middle, b, depth + 1), (a, middle, depth + 1)]);
            } else {
                out.push(a);
            }
        }
    }
    out.extend(cuts.last());
    *cuts = out;
}

/// Area of the box around a curve's control points.
fn area_of(curve: &NurbsCurve<2>) -> f64 {
    let extent = |d: usize| {
        let values = curve.homogeneous().iter().map(|p| p[d] / p[3]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        high - low
    };
    extent(0) * extent(1)
}

/// Number of the interval between breaks that holds `x`, the first or the last one beyond them.
fn cell(breaks: &[f64], x: f64) -> usize {
    let after = breaks.partition_point(|&b| b <= x);
    after.saturating_sub(1).min(breaks.len() - 2)
}

/// Integrals over the cells of knot lines.
struct Cells<'a, S: Surface, F, const N: usize> {
    surface: &'a S,
    breaks: &'a [Vec<f64>; 2],
    /// Lowest parameters of the trim curves: what lies below bounds nothing, and may be where the surface folds.
    low: [f64; 2],
    /// Cells are cut into so many parts in each direction.
    parts: [usize; 2],
    f: &'a F,
}

impl<'a, S: Surface, F: Fn(&Jet) -> [f64; N], const N: usize> Cells<'a, S, F, N> {
    fn new(set: &'a PatchSet<S>, patch: u32, f: &'a F) -> Self {
        let grid = &set.grids[patch as usize];
        let degree = set.patches[patch as usize].bezier_piece([0, 0]).degree;
        let parts = |k: usize| match degree[k] {
            0 | 1 => 1,
            _ => INTERVALS.div_ceil(grid.breaks[k].len()),
        };
        let surface = &set.patches[patch as usize];
        let bounds = surface.trim().map(|trim| trim.bounds());
        Self {
            surface,
            breaks: &grid.breaks,
            low: [0, 1].map(|k| bounds.map_or(f64::NEG_INFINITY, |b| b[k][0])),
            parts: [parts(0), parts(1)],
            f,
        }
    }

    /// Where what counts of a column or row of cells begins.
    fn start(&self, dir: usize, cell: usize) -> f64 {
        let [a, b] = [self.breaks[dir][cell], self.breaks[dir][cell + 1]];
        self.low[dir].clamp(a, b)
    }

    /// Integral along a line of constant second parameter.
    fn row(&self, [from, to]: [f64; 2], at: f64, cell: [usize; 2]) -> [f64; N] {
        let mut sum = [0.0; N];
        let h = (to - from) / self.parts[0] as f64;
        for part in 0..self.parts[0] {
            for (x, w) in GAUSS {
                let xi = [from + h * (part as f64 + x), at];
                let values = (self.f)(&self.surface.jet_in_span(cell, xi));
                for (sum, value) in sum.iter_mut().zip(values) {
                    *sum += w * h * value;
                }
            }
        }
        sum
    }

    /// Integral over the part of a cell between two values of the second parameter.
    fn slab(&self, [from, to]: [f64; 2], cell: [usize; 2]) -> [f64; N] {
        let mut sum = [0.0; N];
        let line = [self.start(0, cell[0]), self.breaks[0][cell[0] + 1]];
        let h = (to - from) / self.parts[1] as f64;
        for part in 0..self.parts[1] {
            for (y, w) in GAUSS {
                let values = self.row(line, from + h * (part as f64 + y), cell);
                for (sum, value) in sum.iter_mut().zip(values) {
                    *sum += w * h * value;
                }
            }
        }
        sum
    }

    /// Integrals over a column from its start to every break.
    fn column(&self, column: usize) -> Vec<[f64; N]> {
        let breaks = &self.breaks[1];
        let mut sum = [0.0; N];
        let mut out = vec![sum];
        for row in 0..breaks.len() - 1 {
            let values = self.slab([self.start(1, row), breaks[row + 1]], [column, row]);
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += value;
            }
            out.push(sum);
        }
        out
    }

    /// Integral over a column from its start to `y`.
    fn below(&self, column: usize, rows: &[[f64; N]], y: f64) -> [f64; N] {
        let row = cell(&self.breaks[1], y);
        let mut sum = self.slab([self.start(1, row), y], [column, row]);
        for (sum, value) in sum.iter_mut().zip(rows[row]) {
            *sum += value;
        }
        sum
    }
}

/// The curve of an edge of a trimmed patch.
fn edge_curve<'s, S: Surface>(set: &'s PatchSet<S>, edge: &Edge) -> Option<&'s NurbsCurve<2>> {
    let EdgeCurve::Trim { a_loop, curve } = edge.curve else {
        return None;
    };
    let trim = set.patches[edge.patch as usize].trim()?;
    Some(&trim.loops().get(a_loop)?.curves.get(curve)?.parameter)
}

/// Adds where a part of a curve crosses knot lines, one place for each line between its ends.
fn crossings(
    curve: &NurbsCurve<2>,
    dir: usize,
    breaks: &[f64],
    [a, b]: [f64; 2],
    out: &mut Vec<f64>,
) {
    let at = |t: f64| curve.jet(t).point[dir];
    let (x, y) = (at(a), at(b));
    let from = breaks.partition_point(|&k| k <= x.min(y));
    let to = breaks.partition_point(|&k| k < x.max(y));
    for &knot in breaks.get(from..to).unwrap_or(&[]) {
        let [mut low, mut high] = if x < y { [a, b] } else { [b, a] };
        // A billionth of the part is near enough: the integrand has no more than a kink there.
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if at(middle) < knot {
                low = middle;
            } else {
                high = middle;
            }
        }
        out.push(0.5 * (low + high));
    }
}
