//! Distances to space curves that follow each other.

use super::face::Part;
use crate::Vec3;

const ITERATIONS: usize = 12;

/// Space curves one after the other.
pub(super) struct Chain<'a> {
    parts: &'a [Part<3>],
    spans: Vec<Span>,
}

/// A span of one of the curves.
struct Span {
    /// Number of the curve, and of the span in it.
    place: [usize; 2],
    /// Parameters and points, ends included.
    samples: Vec<(f64, Vec3)>,
    /// Largest distance between samples that follow each other.
    step: f64,
}

impl<'a> Chain<'a> {
    pub fn new(parts: &'a [Part<3>]) -> Self {
        let spans = parts.iter().enumerate().flat_map(|(k, part)| {
            let basis = part.curve.basis();
            let n = 2 * (basis.degree() + 1);
            (0..basis.span_count()).map(move |span| {
                let [a, b] = basis.span_range(span);
                let at = |i: usize| a + (b - a) * (i as f64 / n as f64);
                let samples: Vec<(f64, Vec3)> = (0..=n)
                    .map(|i| (at(i), part.curve.jet_in_span(span, at(i)).point))
                    .collect();
                let steps = samples
                    .windows(2)
                    .map(|pair| (pair[1].1 - pair[0].1).norm());
                Span {
                    place: [k, span],
                    step: steps.fold(0.0, f64::max),
                    samples,
                }
            })
        });
        Self {
            parts,
            spans: spans.collect(),
        }
    }

    /// Start of the first curve and end of the last one.
    pub fn ends(&self) -> [Vec3; 2] {
        let last = self.parts.len() - 1;
        [
            self.parts[0].curve.ends()[0],
            self.parts[last].curve.ends()[1],
        ]
    }

    /// Distance of `q` from the nearest curve: Newton's method from the nearest sample of each span that may be nearest,
    /// within that span. (Across a knot the curve may have a kink, or run on at another speed.)
    pub fn distance(&self, q: &Vec3) -> f64 {
        let nearest = |span: &Span| {
            let offs = span.samples.iter().map(|s| ((s.1 - q).norm(), s.0));
            offs.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let starts: Vec<_> = self.spans.iter().map(nearest).collect();
        let found = starts.iter().flatten();
        let mut best = found.fold(f64::INFINITY, |best, s| best.min(s.0));
        for (span, start) in self.spans.iter().zip(starts) {
            let Some((off, t)) = start else {
                continue;
            };
            if off - span.step < best {
                best = best.min(self.within(span.place, t, q));
            }
        }
        best
    }

    /// Distance of `q` from a span, from a start there.
    fn within(&self, [part, span]: [usize; 2], mut t: f64, q: &Vec3) -> f64 {
        let curve = &self.parts[part].curve;
        let [a, b] = curve.basis().span_range(span);
        let mut best = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let jet = curve.jet_in_span(span, t);
            let d = jet.point - q;
            best = best.min(d.norm());
            let slope = jet.d1.dot(&d);
            let full = jet.d1.norm_squared() + jet.d2.dot(&d);
            // Gauss-Newton where the curve bends away from the point.
            let bend = if full > 0.0 {
                full
            } else {
                jet.d1.norm_squared()
            };
            let next = (t - slope / bend).clamp(a, b);
            if !next.is_finite() || next == t {
                return best;
            }
            t = next;
        }
        best.min((curve.jet_in_span(span, t).point - q).norm())
    }
}
