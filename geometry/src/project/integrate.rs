//! Integrals over patches.

use super::PatchSet;
use super::topology::{Edge, EdgeCurve, edge_point};
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
/// the trim curves of the primitive of `f` in xi1, each by Gauss points in the intervals of the curves' polylines and in
/// the spans of the surface.
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
    let breaks = &set.grids[patch as usize].breaks[0];
    let degree = set.pieces.list[set.grids[patch as usize].first as usize].degree[0];
    let parts = if degree > 1 {
        INTERVALS.div_ceil(breaks.len())
    } else {
        1
    };
    for edge in edges {
        for pair in edge.samples.windows(2) {
            let [a, b] = [pair[0].t, pair[1].t];
            for (x, w) in GAUSS {
                let t = a + (b - a) * x;
                let at = edge_point(set, edge, t);
                let slope = edge_slope(set, edge, t);
                let outer = edge.sense * w * (b - a) * slope;
                // From the start to the curve, span by span.
                let (from, to, sign) = if at.xi[0] >= start {
                    (start, at.xi[0], 1.0)
                } else {
                    (at.xi[0], start, -1.0)
                };
                for span in breaks.windows(2) {
                    let (s, e) = (span[0].max(from), span[1].min(to));
                    if e <= s {
                        continue;
                    }
                    let h = (e - s) / parts as f64;
                    for part in 0..parts {
                        for (x, w) in GAUSS {
                            let xi = [s + h * (part as f64 + x), at.xi[1]];
                            add(outer * sign * w * h, f(&surface.jet(xi)));
                        }
                    }
                }
            }
        }
    }
    sum
}

/// dxi2/dt of a trim curve.
fn edge_slope<S: Surface>(set: &PatchSet<S>, edge: &Edge, t: f64) -> f64 {
    let EdgeCurve::Trim { a_loop, curve } = edge.curve else {
        return 0.0;
    };
    let trim = set.patches[edge.patch as usize].trim();
    let curve = trim.and_then(|trim| trim.loops().get(a_loop)?.curves.get(curve));
    curve.map_or(0.0, |curve| curve.parameter.jet(t).d1.y)
}
