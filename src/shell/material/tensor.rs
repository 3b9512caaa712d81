//! Invariants, inverses and products of symmetric tensors in Voigt order.
use super::{Collapsed, Metric};
use num_dual::DualNum;

/// Adjugate of a symmetric 3 x 3 matrix over its determinant, and the determinant.
pub(in crate::shell) fn inverse<D: DualNum<f64> + Copy>(m: &[D; 6]) -> ([D; 6], D) {
    let [m11, m22, m33, m12, m23, m13] = *m;
    let c11 = m22 * m33 - m23 * m23;
    let c12 = m13 * m23 - m12 * m33;
    let c13 = m12 * m23 - m13 * m22;
    let det = m11 * c11 + m12 * c12 + m13 * c13;
    let f = det.recip();
    let upper = [
        c11 * f,
        (m11 * m33 - m13 * m13) * f,
        (m11 * m22 - m12 * m12) * f,
        c12 * f,
        (m12 * m13 - m11 * m23) * f,
        c13 * f,
    ];
    (upper, det)
}

/// Mixed components `G^ik E_kj` of the strain, row i, column j.
#[inline(always)]
pub(in crate::shell) fn mixed<D: DualNum<f64> + Copy>(metric: &Metric, e: &[D; 6]) -> [[D; 3]; 3] {
    let [a, b, c, d, f, g] = metric.upper;
    let (e12, e23, e13) = (e[3] * 0.5, e[4] * 0.5, e[5] * 0.5);
    let columns = [[e[0], e12, e13], [e12, e[1], e23], [e13, e23, e[2]]];
    let row = |x: f64, y: f64, z: f64| columns.map(|v| v[0] * x + v[1] * y + v[2] * z);
    [row(a, d, g), row(d, b, f), row(g, f, c)]
}

/// Trace, second invariant and determinant of the mixed strain.
#[inline(always)]
pub(in crate::shell) fn invariants<D: DualNum<f64> + Copy>(m: &[[D; 3]; 3]) -> (D, D, D) {
    let minor = |i: usize, j: usize| m[i][i] * m[j][j] - m[i][j] * m[j][i];
    let second = minor(0, 1) + minor(1, 2) + minor(0, 2);
    let third = m[0][0] * minor(1, 2) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    (m[0][0] + m[1][1] + m[2][2], second, third)
}

/// `C = G + 2E`, checked to be positive definite, with `det C / det G - 1` from the invariants of E (no cancellation
/// at small strain).
#[inline(always)]
pub(in crate::shell) fn cauchy_green<D: DualNum<f64> + Copy>(
    metric: &Metric,
    e: &[D; 6],
    (i1, i2, i3): (D, D, D),
) -> Result<([D; 6], D), Collapsed> {
    let g = &metric.lower;
    let c = [
        e[0] * 2.0 + g[0],
        e[1] * 2.0 + g[1],
        e[2] * 2.0 + g[2],
        e[3] + g[3],
        e[4] + g[4],
        e[5] + g[5],
    ];
    let change = i1 * 2.0 + i2 * 4.0 + i3 * 8.0;
    let ratio = 1.0 + change.re();
    let (c11, c22, c12) = (c[0].re(), c[1].re(), c[3].re());
    if ratio > 0.0 && c11 > 0.0 && c11 * c22 - c12 * c12 > 0.0 && ratio.is_finite() {
        Ok((c, change))
    } else {
        Err(Collapsed { ratio })
    }
}

/// Product of mixed and contravariant components, known to be symmetric.
#[inline(always)]
pub(super) fn raise<D: DualNum<f64> + Copy>(m: &[[D; 3]; 3], upper: &[D; 6]) -> [D; 6] {
    let [a, b, c, d, f, g] = *upper;
    [
        m[0][0] * a + m[0][1] * d + m[0][2] * g,
        m[1][0] * d + m[1][1] * b + m[1][2] * f,
        m[2][0] * g + m[2][1] * f + m[2][2] * c,
        m[0][0] * d + m[0][1] * b + m[0][2] * f,
        m[1][0] * g + m[1][1] * f + m[1][2] * c,
        m[0][0] * g + m[0][1] * f + m[0][2] * c,
    ]
}

/// `lambda A^ij A^kl + kappa (A^ik A^jl + A^il A^jk)`.
#[inline(always)]
pub(in crate::shell) fn isotropic(a: &[f64; 6], lambda: f64, kappa: f64) -> [[f64; 6]; 6] {
    let [a11, a22, a33, a12, a23, a13] = *a;
    let full = [[a11, a12, a13], [a12, a22, a23], [a13, a23, a33]];
    let entry = |v: usize, w: usize| {
        let ((i, j), (k, l)) = (crate::shell::VOIGT[v], crate::shell::VOIGT[w]);
        lambda * a[v] * a[w] + kappa * (full[i][k] * full[j][l] + full[i][l] * full[j][k])
    };
    // Unrolled, so that every index above is a constant; the lower triangle is the upper one.
    let mut c = [[0.0; 6]; 6];
    macro_rules! fill {
        ($($v:literal $w:literal,)*) => { $( c[$v][$w] = entry($v, $w); )* };
    }
    fill! {
        0 0, 0 1, 0 2, 0 3, 0 4, 0 5, 1 1, 1 2, 1 3, 1 4, 1 5,
        2 2, 2 3, 2 4, 2 5, 3 3, 3 4, 3 5, 4 4, 4 5, 5 5,
    }
    for v in 1..6 {
        for w in 0..v {
            c[v][w] = c[w][v];
        }
    }
    c
}
