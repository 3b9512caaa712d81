//! Whether a Bezier piece lies outside of a ball: the proof that the search tries most.

use crate::basis::WIDTH;
use crate::surface::Vec3;

#[cfg(target_arch = "x86_64")]
mod avx2;

const fn binomials() -> [[f64; WIDTH]; WIDTH] {
    let mut table = [[0.0; WIDTH]; WIDTH];
    let mut n = 0;
    while n < WIDTH {
        table[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            table[n][k] = table[n - 1][k - 1] + if k < n { table[n - 1][k] } else { 0.0 };
            k += 1;
        }
        n += 1;
    }
    table
}

pub(crate) static BINOMIALS: [[f64; WIDTH]; WIDTH] = binomials();

/// Whether a Bezier piece is proved to lie outside of the open ball of radius `c` about `q`.
///
/// `|w (rho - q)|^2 - c^2 w^2` is a polynomial of twice the degrees; where none of its Bernstein coefficients is
/// negative, no point of the piece is nearer than `c` (X.-D. Chen, J.-H. Yong, G. Wang, J.-C. Paul, G. Xu, "Computing the
/// minimum distance between a point and a NURBS surface", CAD 40, 2008). For a sphere the bound is exact at its centre.
#[inline]
pub(crate) fn outside_ball(net: &[[f64; 4]], degree: [usize; 2], q: &Vec3, c: f64) -> bool {
    // The corners are coefficients, and the likeliest to be negative.
    let [n1, n] = [degree[0] + 1, net.len()];
    let inside = |k: usize| {
        let p = relative(&net[k], q, c, 1.0);
        product(&p, &p) < 0.0
    };
    if inside(0) || inside(n1 - 1) || inside(n - n1) || inside(n - 1) {
        return false;
    }
    #[cfg(target_arch = "x86_64")]
    if let Some(outside) = avx2::outside(net, degree, q, c) {
        return outside;
    }
    portable(net, degree, q, c)
}

/// For any processor.
fn portable(net: &[[f64; 4]], degree: [usize; 2], q: &Vec3, c: f64) -> bool {
    match (degree[0] + 1, degree[1] + 1) {
        (2, 2) => outside::<2, 2, 3>(net, q, c),
        (3, 3) => outside::<3, 3, 5>(net, q, c),
        (4, 4) => outside::<4, 4, 7>(net, q, c),
        (5, 5) => outside::<5, 5, 9>(net, q, c),
        (6, 6) => outside::<6, 6, 11>(net, q, c),
        (n1, n2) if n1 <= 6 && n2 <= 6 => {
            let mut points = [[0.0; 4]; 36];
            outside_wide(net, degree, q, c, &mut points[..n1 * n2])
        }
        _ => {
            let mut points = [[0.0; 4]; WIDTH * WIDTH];
            outside_wide(net, degree, q, c, &mut points[..net.len()])
        }
    }
}

/// Control points about `q`, times their binomials; the last component is `c w`.
#[inline(always)]
fn relative(point: &[f64; 4], q: &Vec3, c: f64, factor: f64) -> [f64; 4] {
    let w = point[3] * factor;
    [
        point[0] * factor - q.x * w,
        point[1] * factor - q.y * w,
        point[2] * factor - q.z * w,
        c * w,
    ]
}

#[inline(always)]
fn product(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - a[3] * b[3]
}

fn outside<const N1: usize, const N2: usize, const M1: usize>(
    net: &[[f64; 4]],
    q: &Vec3,
    c: f64,
) -> bool {
    let mut points = [[[0.0; 4]; N1]; N2];
    for (j, row) in points.iter_mut().enumerate() {
        for (i, p) in row.iter_mut().enumerate() {
            let factor = BINOMIALS[N1 - 1][i] * BINOMIALS[N2 - 1][j];
            *p = relative(&net[i + N1 * j], q, c, factor);
        }
    }
    // One row of coefficients at a time; corners first would fail sooner, rows keep the loops simple.
    for l in 0..2 * N2 - 1 {
        let mut row = [0.0; M1];
        let from = l.saturating_sub(N2 - 1);
        for j in from..=l.min(N2 - 1) {
            for (i, a) in points[j].iter().enumerate() {
                for (k, b) in points[l - j].iter().enumerate() {
                    row[i + k] += product(a, b);
                }
            }
        }
        if row.iter().any(|&g| g < 0.0 || g.is_nan()) {
            return false;
        }
    }
    true
}

fn outside_wide(
    net: &[[f64; 4]],
    [p, q_degree]: [usize; 2],
    q: &Vec3,
    c: f64,
    points: &mut [[f64; 4]],
) -> bool {
    let n1 = p + 1;
    for (k, (out, point)) in points.iter_mut().zip(net).enumerate() {
        let factor = BINOMIALS[p][k % n1] * BINOMIALS[q_degree][k / n1];
        *out = relative(point, q, c, factor);
    }
    for l in 0..=2 * q_degree {
        let mut row = [0.0; 2 * WIDTH - 1];
        for j in l.saturating_sub(q_degree)..=l.min(q_degree) {
            for (i, a) in points[n1 * j..][..n1].iter().enumerate() {
                for (k, b) in points[n1 * (l - j)..][..n1].iter().enumerate() {
                    row[i + k] += product(a, b);
                }
            }
        }
        if row[..=2 * p].iter().any(|&g| g < 0.0 || g.is_nan()) {
            return false;
        }
    }
    true
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    /// Both kernels on nets of all degrees, with balls that touch, cut and miss the piece: they may differ only where the
    /// least coefficient is zero up to rounding, which a ball smaller or larger by 1e-9 decides.
    #[test]
    fn kernels_agree() {
        let mut state = 5u64;
        let mut random = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut seen = [0; 2];
        for k in 0..20_000 {
            let degree = [1 + k % 5, 1 + (k / 5) % 5];
            let (n1, n2) = (degree[0] + 1, degree[1] + 1);
            let net: Vec<[f64; 4]> = (0..n1 * n2)
                .map(|k| {
                    let (i, j) = (k % n1, k / n1);
                    let w = 0.7 + 0.6 * random();
                    let p = [
                        i as f64 / degree[0] as f64 + 0.1 * random(),
                        j as f64 / degree[1] as f64 + 0.1 * random(),
                        0.3 * random(),
                    ];
                    [p[0] * w, p[1] * w, p[2] * w, w]
                })
                .collect();
            let q = Vec3::new(2.0 * random() - 0.5, 2.0 * random() - 0.5, 0.3 + random());
            let c = 0.9 * random();
            let Some(fast) = avx2::outside(&net, degree, &q, c) else {
                return;
            };
            let [small, large] = [c * (1.0 - 1e-9), c * (1.0 + 1e-9)];
            if portable(&net, degree, &q, small) == portable(&net, degree, &q, large) {
                assert_eq!(fast, portable(&net, degree, &q, c), "{degree:?} {q:?} {c}");
                seen[usize::from(fast)] += 1;
            }
        }
        assert!(seen[0] > 1000 && seen[1] > 1000, "{seen:?}");
    }
}
