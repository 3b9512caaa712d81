//! Whether a facet, or a part of it, is proved to have its closest point where the iteration found one.
//!
//! `F = |rho - q|^2` is a polynomial of twice the degree. Its Bernstein coefficients bound it, their first differences its
//! slopes and their second differences its second derivatives. Where these say that `F` is convex, a stationary point with
//! active bounds is the nearest one; where `F` only grows in one direction, the nearest point lies on an edge, on which
//! one asks again.

use crate::project::ball::BINOMIALS;
use crate::surface::Vec3;

/// What the coefficients say of a rectangle of parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    /// The squared distance is convex: a stationary point of the rectangle is its nearest.
    Convex,
    /// The nearest point lies on this edge (0: low, 1: high end of the direction), along which the squared distance is
    /// convex.
    ConvexEdge {
        dir: usize,
        end: usize,
    },
    Unknown,
}

/// Judges a net of `M x M` control points; `L = 2 M - 1`.
#[inline]
pub(super) fn judge<const M: usize, const L: usize>(net: &[[f64; 4]], q: &Vec3) -> Verdict {
    verdict(&coefficients::<M, L, false>(net, q, 0.0))
}

/// Judges a rational net by `|w (rho - q)|^2 - c^2 w^2`, a polynomial. It is zero at a point at the distance `c`, and stationary
/// there, with the same active bounds, where the distance is. Where it is convex it is therefore positive elsewhere, and
/// nothing is nearer than that point; the same along an edge.
#[inline]
pub(super) fn judge_rational<const M: usize, const L: usize>(
    net: &[[f64; 4]],
    q: &Vec3,
    c: f64,
) -> Verdict {
    verdict(&coefficients::<M, L, true>(net, q, c))
}

#[inline]
fn verdict<const L: usize>(f: &[[f64; L]; L]) -> Verdict {
    let p = (L - 1) as f64;
    // Second derivatives, up to a common factor: f_uu, f_vv from second differences, f_uv from mixed ones.
    let (mut uu, mut vv, mut uv) = (f64::INFINITY, f64::INFINITY, 0.0f64);
    for row in f {
        for w in row.windows(3) {
            uu = uu.min(w[0] - 2.0 * w[1] + w[2]);
        }
    }
    for rows in f.windows(3) {
        for ((a, b), c) in rows[0].iter().zip(&rows[1]).zip(&rows[2]) {
            vv = vv.min(a - 2.0 * b + c);
        }
    }
    for rows in f.windows(2) {
        for (a, b) in rows[0].windows(2).zip(rows[1].windows(2)) {
            uv = uv.max((a[0] - a[1] - b[0] + b[1]).abs());
        }
    }
    let (uu, vv, uv) = (p * (p - 1.0) * uu, p * (p - 1.0) * vv, p * p * uv);
    if uu > 0.0 && vv > 0.0 && uu * vv > uv * uv * (1.0 + 1e-9) {
        return Verdict::Convex;
    }
    // Convex along the edge at the end of direction `dir`, which is a row or a column of coefficients.
    let edge = |dir: usize, end: usize| {
        let at = |k: usize| {
            if dir == 0 {
                f[k][end * (L - 1)]
            } else {
                f[end * (L - 1)][k]
            }
        };
        (0..L - 2).all(|k| at(k) - 2.0 * at(k + 1) + at(k + 2) >= 0.0)
    };
    for dir in 0..2 {
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut take = |step: f64| {
            least = least.min(step);
            most = most.max(step);
        };
        if dir == 0 {
            let steps = f.iter().flat_map(|row| row.windows(2));
            steps.for_each(|w| take(w[1] - w[0]));
        } else {
            let steps = f.windows(2).flat_map(|rows| rows[0].iter().zip(&rows[1]));
            steps.for_each(|(a, b)| take(b - a));
        }
        if least >= 0.0 && edge(dir, 0) {
            return Verdict::ConvexEdge { dir, end: 0 };
        }
        if most <= 0.0 && edge(dir, 1) {
            return Verdict::ConvexEdge { dir, end: 1 };
        }
    }
    Verdict::Unknown
}

/// Bernstein coefficients of `|rho - q|^2`, or of `|w (rho - q)|^2 - c^2 w^2` of a rational net, `[second direction][first]`.
#[inline]
fn coefficients<const M: usize, const L: usize, const RATIONAL: bool>(
    net: &[[f64; 4]],
    q: &Vec3,
    radius: f64,
) -> [[f64; L]; L] {
    let p = M - 1;
    let mut points = [[[0.0; 4]; M]; M];
    for (j, row) in points.iter_mut().enumerate() {
        for (i, out) in row.iter_mut().enumerate() {
            let c = &net[i + M * j];
            let factor = BINOMIALS[p][i] * BINOMIALS[p][j];
            let w = if RATIONAL { c[3] } else { 1.0 };
            *out = [
                (c[0] - q.x * w) * factor,
                (c[1] - q.y * w) * factor,
                (c[2] - q.z * w) * factor,
                radius * w * factor,
            ];
        }
    }
    let mut out = [[0.0; L]; L];
    for j in 0..M {
        for l in j..M {
            // Both orders of a pair of rows are the same.
            let double = if l == j { 1.0 } else { 2.0 };
            for (i, a) in points[j].iter().enumerate() {
                let a = a.map(|a| a * double);
                for (k, b) in points[l].iter().enumerate() {
                    let mut product = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                    if RATIONAL {
                        product -= a[3] * b[3];
                    }
                    out[j + l][i + k] += product;
                }
            }
        }
    }
    let inverse: [f64; L] = std::array::from_fn(|k| 1.0 / BINOMIALS[2 * p][k]);
    for (row, g) in out.iter_mut().zip(&inverse) {
        for (f, h) in row.iter_mut().zip(&inverse) {
            *f *= g * h;
        }
    }
    out
}
