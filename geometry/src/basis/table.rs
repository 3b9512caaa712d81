//! The basis functions of every span as Bernstein polynomials, for fast evaluation.
//!
//! On a span `[a, b]` of length `h`, with `s = (t - a) / h` and `u = (b - t) / h`, a function of degree `p` is
//! `sum_k e_k C(p, k) s^k u^(p - k)`, and its Bezier ordinates `e_k` are not negative, so nothing cancels inside of the span and
//! small functions are as exact as large ones. Derivatives have differences of the ordinates (G. Farin, "Curves and
//! Surfaces for CAGD", 5th ed. 2002, section 5.3), which are stored with their factors: what is left to do is `3 p`
//! products of a number with a row of functions, no division and no recursion.
//!
//! A span takes `32 (1 + 3 p L)` bytes in each direction (`L` = 1 up to degree 3, 2 above), 320 for a cubic: the tables grow
//! with the number of rows of a patch, not with the number of its control points.

use super::{Basis, WIDTH};

/// Highest degree for which there are tables.
pub(crate) const TABLE_DEGREE: usize = 5;

/// Four functions, one per lane.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub(crate) struct Lanes(pub [f64; 4]);

/// Tables of all spans of a basis. Those of a span are a row with `a`, `b` and `1 / h`, then [`lanes`] rows for each of
/// the `p + 1` ordinates, `p` first and `p - 1` second differences, times binomial coefficients and powers of `1 / h`.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Table {
    stride: usize,
    rows: Vec<Lanes>,
}

/// Rows that hold the functions of degree `p`.
pub(crate) const fn lanes(p: usize) -> usize {
    if p <= 3 { 1 } else { 2 }
}

impl Table {
    /// The tables of a basis of degree [`TABLE_DEGREE`] at most.
    pub fn new(basis: &Basis) -> Self {
        let p = basis.degree;
        let stride = 1 + 3 * p * lanes(p);
        let mut rows = Vec::with_capacity(stride * basis.spans.len());
        for (number, span) in basis.spans.iter().enumerate() {
            let [a, b] = [basis.knots[span.knot], basis.knots[span.knot + 1]];
            let inverse = 1.0 / (b - a);
            rows.push(Lanes([a, b, inverse, 0.0]));
            let mut e = [[0.0; WIDTH]; WIDTH];
            basis.bezier_coefficients(number, [a, b], &mut e);
            let mut factor = 1.0;
            for m in 0..3.min(p + 1) {
                // Differences of order m: p + 1 - m of them, Bernstein polynomials of degree p - m.
                let mut binomial = 1.0;
                for (k, e) in e.iter().enumerate().take(p + 1 - m) {
                    let row: [f64; 8] = std::array::from_fn(|r| {
                        if r <= p {
                            e[r] * binomial * factor
                        } else {
                            0.0
                        }
                    });
                    for lane in 0..lanes(p) {
                        let four = std::array::from_fn(|r| row[4 * lane + r]);
                        rows.push(Lanes(four));
                    }
                    binomial *= (p - m - k) as f64 / (k + 1) as f64;
                }
                for k in 0..p - m {
                    e[k] = std::array::from_fn(|r| e[k + 1][r] - e[k][r]);
                }
                factor *= (p - m) as f64 * inverse;
            }
        }
        Self { stride, rows }
    }

    /// The rows of one span, which must be one.
    #[inline(always)]
    pub fn span(&self, span: usize) -> &[Lanes] {
        &self.rows[span * self.stride..(span + 1) * self.stride]
    }
}
