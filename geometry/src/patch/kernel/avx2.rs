//! The kernel for x86-64 with AVX2 and FMA. The only unsafe code of the crate: calls of functions that need those
//! instructions, and loads and stores of whole registers.
#![allow(unsafe_code)]

use std::arch::x86_64::*;

use super::{Piece, bernstein, with_degrees};
use crate::basis::{Lanes, lanes};
use crate::surface::{Jet, Vec3};

/// Proof that this processor has AVX2 and FMA: there is no other way to get one than to ask it.
#[derive(Debug, Clone, Copy)]
pub(in crate::patch) struct Available(());

impl Available {
    /// Asks the processor (the answer is cached by the standard library).
    pub fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        found.then_some(Self(()))
    }

    #[inline(always)]
    pub(super) fn jet(self, degree: [usize; 2], piece: &Piece, xi: [f64; 2]) -> Jet {
        // SAFETY: `self` exists only where `detect` found both features.
        unsafe { with_degrees!(degree, of_degree(piece, xi)) }
    }
}

#[target_feature(enable = "avx2,fma")]
fn of_degree<const P: usize, const Q: usize>(piece: &Piece, xi: [f64; 2]) -> Jet {
    let n1 = functions::<P>(piece.rows[0], xi[0]);
    let n2 = functions::<Q>(piece.rows[1], xi[1]);
    let mut sum = [_mm256_setzero_pd(); 6];
    for s in 0..=Q {
        let row = &piece.points[s * piece.stride..][..=P];
        let mut part = [_mm256_setzero_pd(); 3];
        for (r, point) in row.iter().enumerate() {
            let point = load(point);
            for (m, part) in part.iter_mut().enumerate() {
                *part = _mm256_fmadd_pd(_mm256_broadcast_sd(&n1[m][r]), point, *part);
            }
        }
        let n = [0, 1, 2].map(|m| _mm256_broadcast_sd(&n2[m][s]));
        sum[0] = _mm256_fmadd_pd(n[0], part[0], sum[0]);
        sum[1] = _mm256_fmadd_pd(n[0], part[1], sum[1]);
        sum[2] = _mm256_fmadd_pd(n[1], part[0], sum[2]);
        sum[3] = _mm256_fmadd_pd(n[0], part[2], sum[3]);
        sum[4] = _mm256_fmadd_pd(n[1], part[1], sum[4]);
        sum[5] = _mm256_fmadd_pd(n[2], part[0], sum[5]);
    }
    match piece.weight {
        Some(weight) => {
            let inverse = _mm256_set1_pd(1.0 / weight);
            store(sum.map(|a| _mm256_mul_pd(a, inverse)))
        }
        None => store(quotient(sum)),
    }
}

/// [`quotient`](crate::surface::quotient) with the weights in the last lane.
#[target_feature(enable = "avx2,fma")]
#[inline]
fn quotient([a, a1, a2, a11, a12, a22]: [__m256d; 6]) -> [__m256d; 6] {
    let [w, w1, w2, w11, w12, w22] =
        [a, a1, a2, a11, a12, a22].map(|x| _mm256_permute4x64_pd::<0xff>(x));
    let inverse = _mm256_div_pd(_mm256_set1_pd(1.0), w);
    let r = _mm256_mul_pd(a, inverse);
    let r1 = _mm256_mul_pd(_mm256_fnmadd_pd(r, w1, a1), inverse);
    let r2 = _mm256_mul_pd(_mm256_fnmadd_pd(r, w2, a2), inverse);
    let (twice1, twice2) = (_mm256_add_pd(w1, w1), _mm256_add_pd(w2, w2));
    let r11 = _mm256_fnmadd_pd(r1, twice1, _mm256_fnmadd_pd(r, w11, a11));
    let r12 = _mm256_fnmadd_pd(r1, w2, _mm256_fnmadd_pd(r, w12, a12));
    let r12 = _mm256_fnmadd_pd(r2, w1, r12);
    let r22 = _mm256_fnmadd_pd(r2, twice2, _mm256_fnmadd_pd(r, w22, a22));
    [
        r,
        r1,
        r2,
        _mm256_mul_pd(r11, inverse),
        _mm256_mul_pd(r12, inverse),
        _mm256_mul_pd(r22, inverse),
    ]
}

/// The functions with first and second derivatives.
#[target_feature(enable = "avx2,fma")]
#[inline]
fn functions<const P: usize>(rows: &[Lanes], t: f64) -> [[f64; 8]; 3] {
    let rows = &rows[..1 + 3 * P * lanes(P)];
    let b = bernstein::<P>(rows[0].0, t);
    let mut sum = [[_mm256_setzero_pd(); 2]; 3];
    let mut next = 1;
    for m in 0..3.min(P + 1) {
        for b in &b[m][..=P - m] {
            let b = _mm256_broadcast_sd(b);
            for lane in 0..lanes(P) {
                sum[m][lane] = _mm256_fmadd_pd(b, load(&rows[next].0), sum[m][lane]);
                next += 1;
            }
        }
    }
    let mut out = [[0.0; 8]; 3];
    for (out, sum) in out.iter_mut().zip(sum) {
        for (lane, sum) in sum.into_iter().enumerate().take(lanes(P)) {
            let out: &mut [f64] = &mut out[4 * lane..4 * lane + 4];
            // SAFETY: the slice has room for four numbers; no alignment is asked for.
            unsafe { _mm256_storeu_pd(out.as_mut_ptr(), sum) };
        }
    }
    out
}

/// The first three lanes of each.
#[target_feature(enable = "avx2,fma")]
#[inline]
fn store(lanes: [__m256d; 6]) -> Jet {
    let zero = Vec3::zeros();
    let mut jet = Jet {
        rho: zero,
        rho_i: [zero; 2],
        rho_ij: [zero; 3],
    };
    let [r1, r2] = &mut jet.rho_i;
    let [r11, r12, r22] = &mut jet.rho_ij;
    for (out, x) in [&mut jet.rho, r1, r2, r11, r12, r22].into_iter().zip(lanes) {
        let out: &mut [f64; 3] = out.as_mut();
        // SAFETY: two numbers at the start of three; no alignment is asked for.
        unsafe { _mm_storeu_pd(out.as_mut_ptr(), _mm256_castpd256_pd128(x)) };
        out[2] = _mm_cvtsd_f64(_mm256_extractf128_pd::<1>(x));
    }
    jet
}

#[target_feature(enable = "avx2,fma")]
#[inline]
fn load(numbers: &[f64; 4]) -> __m256d {
    // SAFETY: the reference is to four numbers; no alignment is asked for.
    unsafe { _mm256_loadu_pd(numbers.as_ptr()) }
}
