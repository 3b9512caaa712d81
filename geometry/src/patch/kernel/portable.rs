//! The kernel for any processor; four lanes at a time, which compilers turn into whatever vectors there are.

use super::{Piece, bernstein, with_degrees};
use crate::basis::{Lanes, lanes};
use crate::surface::{Jet, Vec3, quotient};

pub(super) fn jet(degree: [usize; 2], piece: &Piece, xi: [f64; 2]) -> Jet {
    with_degrees!(degree, of_degree(piece, xi))
}

fn of_degree<const P: usize, const Q: usize>(piece: &Piece, xi: [f64; 2]) -> Jet {
    let n1 = functions::<P>(piece.rows[0], xi[0]);
    let n2 = functions::<Q>(piece.rows[1], xi[1]);
    let mut sum = [[0.0; 4]; 6];
    for s in 0..=Q {
        let row = &piece.points[s * piece.stride..][..=P];
        let mut part = [[0.0; 4]; 3];
        for (r, point) in row.iter().enumerate() {
            for (m, part) in part.iter_mut().enumerate() {
                add(part, point, n1[m][r]);
            }
        }
        let n = [n2[0][s], n2[1][s], n2[2][s]];
        add(&mut sum[0], &part[0], n[0]);
        add(&mut sum[1], &part[1], n[0]);
        add(&mut sum[2], &part[0], n[1]);
        add(&mut sum[3], &part[2], n[0]);
        add(&mut sum[4], &part[1], n[1]);
        add(&mut sum[5], &part[0], n[2]);
    }
    let a = sum.map(|[x, y, z, _]| Vec3::new(x, y, z));
    match piece.weight {
        None => quotient(&a, &sum.map(|p| p[3])),
        Some(weight) => {
            let inverse = 1.0 / weight;
            let [rho, r1, r2, r11, r12, r22] = a.map(|x| x * inverse);
            Jet {
                rho,
                rho_i: [r1, r2],
                rho_ij: [r11, r12, r22],
            }
        }
    }
}

/// The functions with first and second derivatives.
#[inline(always)]
fn functions<const P: usize>(rows: &[Lanes], t: f64) -> [[f64; 8]; 3] {
    let rows = &rows[..1 + 3 * P * lanes(P)];
    let b = bernstein::<P>(rows[0].0, t);
    let mut out = [[0.0; 8]; 3];
    let mut next = 1;
    for m in 0..3.min(P + 1) {
        for &b in &b[m][..=P - m] {
            for lane in 0..lanes(P) {
                for (out, e) in out[m][4 * lane..].iter_mut().zip(rows[next].0) {
                    *out += b * e;
                }
                next += 1;
            }
        }
    }
    out
}

/// `sum += f * point`.
#[inline(always)]
fn add(sum: &mut [f64; 4], point: &[f64; 4], f: f64) {
    for (sum, x) in sum.iter_mut().zip(point) {
        *sum += f * x;
    }
}
