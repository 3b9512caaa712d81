//! Exact Bezier pieces of a patch.

use crate::basis::WIDTH;
use crate::patch::NurbsPatch;

/// One polynomial (rational) piece of a patch in Bezier form.
#[derive(Debug, Clone, PartialEq)]
pub struct BezierPiece {
    /// Its part of the patch's domain: `[direction][start, end]`.
    pub domain: [[f64; 2]; 2],
    /// Numbers of the spans that it comes from.
    pub span: [usize; 2],
    /// Polynomial degrees.
    pub degree: [usize; 2],
    /// Homogeneous control points (w x, w y, w z, w), xi1 fastest, `(p + 1) (q + 1)` of them.
    pub points: Vec<[f64; 4]>,
}

/// The Bezier pieces of a patch, one per pair of non-empty spans in its domain, those of xi1 fastest. Same surface with
/// the same parameters; exact up to rounding, whatever the knots (clamped or not) and the domain.
pub fn bezier_pieces(patch: &NurbsPatch) -> Vec<BezierPiece> {
    let coefficients = [0, 1].map(|dir| {
        let spans = 0..patch.basis(dir).span_count();
        spans
            .map(|span| coefficients(patch, dir, span))
            .collect::<Vec<_>>()
    });
    let mut pieces = Vec::with_capacity(coefficients[0].len() * coefficients[1].len());
    for (span2, c2) in coefficients[1].iter().enumerate() {
        for (span1, c1) in coefficients[0].iter().enumerate() {
            pieces.push(combined(patch, [span1, span2], [c1, c2]));
        }
    }
    pieces
}

/// One of the [`bezier_pieces`]: that of a pair of spans, which must be there.
pub(crate) fn bezier_piece(patch: &NurbsPatch, span: [usize; 2]) -> BezierPiece {
    let [c1, c2] = [0, 1].map(|dir| coefficients(patch, dir, span[dir]));
    combined(patch, span, [&c1, &c2])
}

/// Bezier points of a span as combinations of its control points.
type Coefficients = [[f64; WIDTH]; WIDTH];

fn coefficients(patch: &NurbsPatch, dir: usize, span: usize) -> Coefficients {
    let basis = patch.basis(dir);
    let mut c = [[0.0; WIDTH]; WIDTH];
    basis.bezier_coefficients(span, basis.span_range(span), &mut c);
    c
}

fn combined(patch: &NurbsPatch, span: [usize; 2], [c1, c2]: [&Coefficients; 2]) -> BezierPiece {
    let degree = patch.degree();
    let (p, q) = (degree[0], degree[1]);
    let bases = [patch.basis(0), patch.basis(1)];
    let (net, columns) = (patch.homogeneous(), bases[0].count());
    let first = [0, 1].map(|k| bases[k].first_function(span[k]));
    // First along xi1 in each row of the net, then across the rows.
    let mut rows = [[[0.0; 4]; WIDTH]; WIDTH];
    for (s, row) in rows.iter_mut().enumerate().take(q + 1) {
        let start = first[0] + columns * (first[1] + s);
        for (k, out) in row.iter_mut().enumerate().take(p + 1) {
            *out = combine(&c1[k][..=p], net[start..=start + p].iter());
        }
    }
    let mut points = Vec::with_capacity((p + 1) * (q + 1));
    for c in c2.iter().take(q + 1) {
        for k in 0..=p {
            points.push(combine(&c[..=q], rows.iter().map(|row| &row[k])));
        }
    }
    BezierPiece {
        domain: [0, 1].map(|k| bases[k].span_range(span[k])),
        span,
        degree,
        points,
    }
}

fn combine<'a>(c: &[f64], points: impl Iterator<Item = &'a [f64; 4]>) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for (c, point) in c.iter().zip(points) {
        for (sum, x) in sum.iter_mut().zip(point) {
            *sum += c * x;
        }
    }
    sum
}
