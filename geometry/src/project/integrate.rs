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

/// Integrates `f dxi1 dxi2` over the part of the domain that belongs to the surface: 4 x 4 Gauss points per Bezier piece of
/// an untrimmed patch. On a trimmed patch the divergence theorem of the parameter plane turns it into an integral along
/// the trim curves of the primitive of `f` in xi1, each by Gauss points in the spans of the surface: the intervals of the
/// curves' polylines are cut where they cross its knot lines.
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
        let first = set.grids[patch as usize].first as usize;
        let pieces = set.pieces.list[first..].iter();
        for piece in pieces.take_while(|piece| piece.patch == patch) {
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
    // The primitive starts amid the curves, so that it is small.
    let all = || edges.iter().flat_map(|e| &e.samples).map(|s| s.xi[0]);
    let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
        (a.min(x), b.max(x))
    });
    let start = 0.5 * (low + high);
    let grid = &set.grids[patch as usize];
    let breaks = &grid.breaks[0];
    let degree = set.pieces.list[grid.first as usize].degree[0];
    let parts = if degree > 1 {
        INTERVALS.div_ceil(breaks.len())
    } else {
        1
    };
    let mut cuts = Vec::new();
    for edge in edges {
        let Some(curve) = edge_curve(set, edge) else {
            continue;
        };
        cuts.clear();
        for pair in edge.samples.windows(2) {
            cuts.push(pair[0].t);
            let first = cuts.len();
            for (dir, breaks) in grid.breaks.iter().enumerate() {
                crossings(curve, dir, breaks, [pair[0].t, pair[1].t], &mut cuts);
            }
            cuts[first..].sort_by(f64::total_cmp);
        }
        cuts.extend(edge.samples.last().map(|s| s.t));
        for pair in cuts.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            for (x, w) in GAUSS {
                let jet = curve.jet(a + (b - a) * x);
                let at = [jet.point.x, jet.point.y];
                let outer = edge.sense * w * (b - a) * jet.d1.y;
                // From the start to the curve, span by span.
                let (from, to, sign) = if at[0] >= start {
                    (start, at[0], 1.0)
                } else {
                    (at[0], start, -1.0)
                };
                for span in breaks.windows(2) {
                    let (s, e) = (span[0].max(from), span[1].min(to));
                    if e <= s {
                        continue;
                    }
                    let h = (e - s) / parts as f64;
                    for part in 0..parts {
                        for (x, w) in GAUSS {
                            let xi = [s + h * (part as f64 + x), at[1]];
                            add(outer * sign * w * h, f(&surface.jet(xi)));
                        }
                    }
                }
            }
        }
    }
    sum
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
