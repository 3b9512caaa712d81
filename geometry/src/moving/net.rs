//! Bezier nets of `M x M` control points over `[-1, 1]^2`, polynomial or rational: jets, shape weights, boxes, sub-pieces.
//!
//! Control points are homogeneous, `(w x, w y, w z, w)`. Where all weights are 1 nothing looks at them.

use num_dual::DualNum;

use super::EMPTY_BOX;
use crate::surface::{Jet, Vec3};

/// Bernstein polynomials of degree `M - 1` at `xi`, with first and second derivatives by `xi`.
#[inline]
pub(super) fn bernstein<D: DualNum<f64> + Copy, const M: usize>(xi: D) -> [[D; M]; 3] {
    // Weights that are 0 and 1 at the ends, so that corners are control points to the last digit.
    let (zero, half) = (D::zero(), D::from(0.5));
    let (a, b) = ((D::one() - xi) * half, (D::one() + xi) * half);
    let mut out = [[zero; M]; 3];
    let p = (M - 1) as f64;
    // Degrees P - 2, P - 1 and P, one from the other; differences of lower degrees are derivatives.
    let mut low = [zero; M];
    low[0] = D::one();
    for degree in 1..M {
        if degree + 1 == M {
            let f = D::from(0.5 * p);
            for (k, first) in out[1].iter_mut().enumerate() {
                let before = if k > 0 { low[k - 1] } else { zero };
                let own = if k < degree { low[k] } else { zero };
                *first = (before - own) * f;
            }
        }
        if degree + 2 == M {
            let f = D::from(0.25 * p * (p - 1.0));
            for (k, out) in out[2].iter_mut().enumerate() {
                let at = |i: usize| if i < degree { low[i] } else { zero };
                let mut second = at(k);
                if k > 0 {
                    second -= at(k - 1) + at(k - 1);
                }
                if k > 1 {
                    second += at(k - 2);
                }
                *out = second * f;
            }
        }
        for k in (0..=degree).rev() {
            let before = if k > 0 { low[k - 1] * b } else { zero };
            let own = if k < degree { low[k] * a } else { zero };
            low[k] = before + own;
        }
    }
    out[0] = low;
    out
}

/// Point with first and second derivatives.
#[inline]
pub(super) fn jet<const M: usize>(net: &[[f64; 4]], xi: [f64; 2], rational: bool) -> Jet {
    if rational {
        return rational_jet::<M>(net, xi);
    }
    let [rho, r1, r2, r11, r12, r22] = sums::<M, 3>(net, xi).map(Vec3::from);
    Jet {
        rho,
        rho_i: [r1, r2],
        rho_ij: [r11, r12, r22],
    }
}

/// [`jet`] of a rational piece, by the quotient rule.
#[inline(never)]
fn rational_jet<const M: usize>(net: &[[f64; 4]], xi: [f64; 2]) -> Jet {
    let [a, a1, a2, a11, a12, a22] =
        sums::<M, 4>(net, xi).map(|[x, y, z, w]| (Vec3::new(x, y, z), w));
    let rho = a.0 / a.1;
    let [r1, r2] = [a1, a2].map(|b| (b.0 - rho * b.1) / a.1);
    Jet {
        rho,
        rho_i: [r1, r2],
        rho_ij: [
            (a11.0 - r1 * (2.0 * a1.1) - rho * a11.1) / a.1,
            (a12.0 - r1 * a2.1 - r2 * a1.1 - rho * a12.1) / a.1,
            (a22.0 - r2 * (2.0 * a2.1) - rho * a22.1) / a.1,
        ],
    }
}

/// The first `K` components of a net at `xi`, with derivatives 1, 2, 11, 12, 22.
#[inline(always)]
fn sums<const M: usize, const K: usize>(net: &[[f64; 4]], xi: [f64; 2]) -> [[f64; K]; 6] {
    let [u, v] = xi.map(bernstein::<f64, M>);
    let mut sums = [[0.0; K]; 6];
    for (j, row) in net.chunks_exact(M).enumerate().take(M) {
        // Value and derivatives along the row.
        let mut along = [[0.0; K]; 3];
        for (i, p) in row.iter().enumerate() {
            for (along, u) in along.iter_mut().zip(&u) {
                for k in 0..K {
                    along[k] += u[i] * p[k];
                }
            }
        }
        let orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];
        for (sum, (a, b)) in sums.iter_mut().zip(orders) {
            for k in 0..K {
                sum[k] += v[b][j] * along[a][k];
            }
        }
    }
    sums
}

/// A control point in space.
#[inline]
pub(super) fn point(&[x, y, z, w]: &[f64; 4], rational: bool) -> Vec3 {
    match rational {
        true => Vec3::new(x, y, z) / w,
        false => Vec3::new(x, y, z),
    }
}

/// Box around the control points, which holds the piece (weights are positive); empty where one of them is not finite.
#[inline]
pub(super) fn bounds(net: &[[f64; 4]], rational: bool) -> [Vec3; 2] {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    let mut sum = 0.0;
    for p in net {
        let p = point(p, rational);
        for k in 0..3 {
            low[k] = if p[k] < low[k] { p[k] } else { low[k] };
            high[k] = if p[k] > high[k] { p[k] } else { high[k] };
            sum += p[k];
        }
    }
    if f64::is_finite(sum) {
        [low.into(), high.into()]
    } else {
        EMPTY_BOX
    }
}

/// The halves of a net: `left` becomes the first, the second is returned in `right`.
pub(super) fn halve<const M: usize>(left: &mut [[f64; 4]], right: &mut [[f64; 4]], dir: usize) {
    crate::project::piece::split(left, right, [M - 1; 2], dir, 0.5);
}

#[cfg(test)]
mod tests {
    use num_dual::Dual64;

    use super::bernstein;

    fn check<const M: usize>() {
        for xi in [-1.0, -0.37, 0.2, 0.99] {
            let exact = bernstein::<Dual64, M>(Dual64::new(xi, 1.0));
            let found = bernstein::<f64, M>(xi);
            assert!((found[0].iter().sum::<f64>() - 1.0).abs() < 1e-15);
            for order in 0..2 {
                let largest = exact[order].iter().map(|d| d.eps.abs()).fold(0.0, f64::max);
                assert!(largest > 0.1 || order + 1 >= M);
                for k in 0..M {
                    assert_eq!(found[order][k], exact[order][k].re);
                    assert!((found[order + 1][k] - exact[order][k].eps).abs() < 1e-14);
                }
            }
        }
    }

    /// The derivatives are those of the polynomials (by dual numbers).
    #[test]
    fn derivatives_are_derivatives() {
        check::<2>();
        check::<3>();
        check::<4>();
    }
}
