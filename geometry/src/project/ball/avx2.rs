//! The Bernstein coefficients with AVX2 and FMA: rows of control points by components, four columns to a register, products
//! of equal rows taken once.
#![allow(unsafe_code)]

use std::arch::x86_64::*;

use super::BINOMIALS;
use crate::surface::Vec3;

/// [`outside_ball`](super::outside_ball) for degrees up to 5; `None` where the processor or the degree is another one.
#[inline]
pub(super) fn outside(net: &[[f64; 4]], degree: [usize; 2], q: &Vec3, c: f64) -> Option<bool> {
    if degree[0] > 5
        || degree[1] > 5
        || !(is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"))
    {
        return None;
    }
    // SAFETY: both features have just been found.
    Some(unsafe {
        match degree {
            [2, 2] => narrow::<3, 3>(net, q, c),
            [3, 3] => narrow::<4, 4>(net, q, c),
            [0..=3, _] => any_narrow(net, degree, q, c),
            [4, 4] => wide::<5, 5>(net, q, c),
            [5, 5] => wide::<6, 6>(net, q, c),
            _ => any_wide(net, degree, q, c),
        }
    })
}

/// Up to four columns.
#[target_feature(enable = "avx2,fma")]
fn narrow<const N1: usize, const N2: usize>(net: &[[f64; 4]], q: &Vec3, c: f64) -> bool {
    rows::<1>(net, [N1, N2], q, c)
}

#[target_feature(enable = "avx2,fma")]
fn any_narrow(net: &[[f64; 4]], degree: [usize; 2], q: &Vec3, c: f64) -> bool {
    rows::<1>(net, degree.map(|p| p + 1), q, c)
}

/// Up to eight columns.
#[target_feature(enable = "avx2,fma")]
fn wide<const N1: usize, const N2: usize>(net: &[[f64; 4]], q: &Vec3, c: f64) -> bool {
    rows::<2>(net, [N1, N2], q, c)
}

#[target_feature(enable = "avx2,fma")]
fn any_wide(net: &[[f64; 4]], degree: [usize; 2], q: &Vec3, c: f64) -> bool {
    rows::<2>(net, degree.map(|p| p + 1), q, c)
}

/// One row of control points about `q` times their binomials, by components; the last one is `c w`.
type Row = [[f64; 8]; 4];

/// `LANES` registers hold a row. Inlined into the functions above, where the numbers of points are constants.
#[target_feature(enable = "avx2,fma")]
#[inline]
fn rows<const LANES: usize>(net: &[[f64; 4]], [n1, n2]: [usize; 2], q: &Vec3, c: f64) -> bool {
    let mut points: [Row; 6] = [[[0.0; 8]; 4]; 6];
    for (j, (row, own)) in points.iter_mut().zip(net.chunks_exact(n1)).enumerate() {
        for (i, &[x, y, z, w]) in own.iter().enumerate() {
            let factor = BINOMIALS[n1 - 1][i] * BINOMIALS[n2 - 1][j];
            let w = w * factor;
            row[0][i] = x * factor - q.x * w;
            row[1][i] = y * factor - q.y * w;
            row[2][i] = z * factor - q.z * w;
            row[3][i] = c * w;
        }
    }
    let zero = _mm256_setzero_pd();
    for l in 0..2 * n2 - 1 {
        // Column i of the first row times all of the second, doubled where the rows may change places.
        let mut sums = [[zero; LANES]; 6];
        let mut j = (l + 1).saturating_sub(n2);
        while 2 * j <= l {
            let (a, b) = (&points[j], &points[l - j]);
            let twice = _mm256_set1_pd(if 2 * j == l { 1.0 } else { 2.0 });
            for lane in 0..LANES {
                let b = [0, 1, 2, 3].map(|k| _mm256_mul_pd(twice, load(&b[k][4 * lane..])));
                for (i, sum) in sums.iter_mut().enumerate().take(n1) {
                    let a = [0, 1, 2, 3].map(|k| _mm256_broadcast_sd(&a[k][i]));
                    let mut s = sum[lane];
                    s = _mm256_fmadd_pd(a[0], b[0], s);
                    s = _mm256_fmadd_pd(a[1], b[1], s);
                    s = _mm256_fmadd_pd(a[2], b[2], s);
                    sum[lane] = _mm256_fnmadd_pd(a[3], b[3], s);
                }
            }
            j += 1;
        }
        let mut row = [0.0; 16];
        for (i, sum) in sums.iter().enumerate().take(n1) {
            for (lane, sum) in sum.iter().enumerate() {
                let out = &mut row[i + 4 * lane..];
                let added = _mm256_add_pd(load(out), *sum);
                store(out, added);
            }
        }
        // Past the last coefficient there are zeros. Neither negative nor NaN.
        for lane in 0..(2 * n1 + 2) / 4 {
            let fine = _mm256_cmp_pd::<_CMP_GE_OQ>(load(&row[4 * lane..]), zero);
            if _mm256_movemask_pd(fine) != 0xf {
                return false;
            }
        }
    }
    true
}

#[target_feature(enable = "avx2,fma")]
#[inline]
fn load(numbers: &[f64]) -> __m256d {
    let numbers = &numbers[..4];
    // SAFETY: the slice holds four numbers; no alignment is asked for.
    unsafe { _mm256_loadu_pd(numbers.as_ptr()) }
}

#[target_feature(enable = "avx2,fma")]
#[inline]
fn store(out: &mut [f64], numbers: __m256d) {
    let out = &mut out[..4];
    // SAFETY: the slice has room for four numbers; no alignment is asked for.
    unsafe { _mm256_storeu_pd(out.as_mut_ptr(), numbers) };
}
