//! Bezier pieces: control nets with bounds on their points and derivatives.

use crate::basis::WIDTH;
use crate::surface::Vec3;

/// One Bezier piece of a patch, or a part of one, as the search uses it.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub patch: u32,
    pub span: [usize; 2],
    /// Place among the pieces of the patch.
    pub cell: [u32; 2],
    pub domain: [[f64; 2]; 2],
    pub degree: [usize; 2],
    /// Start of its control net in [`Pieces::nets`].
    net: usize,
    /// Bounds on `|rho_i|` over the piece, for parameters that run from 0 to 1.
    pub scale: [f64; 2],
    /// Bound on the second derivative as a quadratic form, in parameters scaled by `scale`.
    pub second: f64,
    /// Bound on the third derivative as a cubic form, in parameters scaled by `scale`.
    pub third: f64,
}

/// All pieces with their control nets in one place.
#[derive(Debug, Clone, Default)]
pub(super) struct Pieces {
    pub list: Vec<Piece>,
    /// Homogeneous control points (w x, w y, w z, w), xi1 fastest.
    nets: Vec<[f64; 4]>,
}

impl Pieces {
    /// Adds a piece: patch, spans, place among the patch's pieces, domain, degrees and control net.
    pub fn push(
        &mut self,
        patch: u32,
        span: [usize; 2],
        cell: [u32; 2],
        domain: [[f64; 2]; 2],
        degree: [usize; 2],
        points: &[[f64; 4]],
    ) {
        let net = self.nets.len();
        self.nets.extend_from_slice(points);
        let bounds = derivative_bounds(points, degree);
        self.list.push(Piece {
            patch,
            span,
            cell,
            domain,
            degree,
            net,
            scale: bounds.scale,
            second: bounds.second,
            third: bounds.third,
        });
    }

    pub fn net(&self, piece: &Piece) -> &[[f64; 4]] {
        &self.nets[piece.net..piece.net + (piece.degree[0] + 1) * (piece.degree[1] + 1)]
    }
}

struct Bounds {
    scale: [f64; 2],
    second: f64,
    third: f64,
}

/// Bounds on the derivatives of a rational Bezier piece up to order three: the derivative nets of numerator (about the
/// middle of the piece) and denominator are bounded by their largest control vectors, the quotient rule does the rest.
fn derivative_bounds(net: &[[f64; 4]], degree: [usize; 2]) -> Bounds {
    let [low, high] = hull(net);
    let middle = (low + high) * 0.5;
    let moved: Vec<[f64; 4]> = net
        .iter()
        .map(|&[x, y, z, w]| [x - middle.x * w, y - middle.y * w, z - middle.z * w, w])
        .collect();
    let smallest = net.iter().map(|p| p[3]).fold(f64::INFINITY, f64::min);
    // Bounds on numerator and denominator derivatives, then on the derivatives of the surface, [order 1][order 2].
    let mut above = [[0.0f64; 4]; 4];
    let mut below = [[0.0f64; 4]; 4];
    for a in 0..4 {
        for b in 0..4 - a {
            (above[a][b], below[a][b]) = largest_difference(&moved, degree, [a, b]);
        }
    }
    let mut surface = [[0.0f64; 4]; 4];
    surface[0][0] = moved
        .iter()
        .map(|&[x, y, z, w]| Vec3::new(x, y, z).norm() / w)
        .fold(0.0, f64::max);
    let choose = [
        [1.0, 0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0, 0.0],
        [1.0, 2.0, 1.0, 0.0],
        [1.0, 3.0, 3.0, 1.0],
    ];
    for order in 1..4 {
        for a in 0..=order {
            let b = order - a;
            let mut sum = above[a][b];
            for k in 0..=a {
                for l in 0..=b {
                    if k + l > 0 {
                        sum += choose[a][k] * choose[b][l] * below[k][l] * surface[a - k][b - l];
                    }
                }
            }
            surface[a][b] = sum / smallest;
        }
    }
    let size = surface[1][0].max(surface[0][1]).max(f64::MIN_POSITIVE);
    let m = [
        surface[1][0].max(1e-9 * size),
        surface[0][1].max(1e-9 * size),
    ];
    let form = |terms: &[(usize, usize, f64)]| {
        terms
            .iter()
            .map(|&(a, b, count)| {
                let t = surface[a][b] / (m[0].powi(a as i32) * m[1].powi(b as i32));
                count * t * t
            })
            .sum::<f64>()
            .sqrt()
    };
    Bounds {
        scale: m,
        second: form(&[(2, 0, 1.0), (1, 1, 2.0), (0, 2, 1.0)]),
        third: form(&[(3, 0, 1.0), (2, 1, 3.0), (1, 2, 3.0), (0, 3, 1.0)]),
    }
}

/// Largest control vector of the derivative net of the given orders: of its first three components and of the fourth.
fn largest_difference(net: &[[f64; 4]], degree: [usize; 2], orders: [usize; 2]) -> (f64, f64) {
    if orders[0] > degree[0] || orders[1] > degree[1] {
        return (0.0, 0.0);
    }
    let mut work = net.to_vec();
    let stride = degree[0] + 1;
    let mut factor = 1.0;
    let (mut n1, mut n2) = (degree[0] + 1, degree[1] + 1);
    for _ in 0..orders[0] {
        n1 -= 1;
        factor *= n1 as f64;
        for j in 0..n2 {
            for i in 0..n1 {
                let k = i + stride * j;
                work[k] = difference(&work[k + 1], &work[k]);
            }
        }
    }
    for _ in 0..orders[1] {
        n2 -= 1;
        factor *= n2 as f64;
        for j in 0..n2 {
            for i in 0..n1 {
                let k = i + stride * j;
                work[k] = difference(&work[k + stride], &work[k]);
            }
        }
    }
    let (mut vector, mut weight) = (0.0f64, 0.0f64);
    for j in 0..n2 {
        for i in 0..n1 {
            let [x, y, z, w] = work[i + stride * j];
            vector = vector.max(Vec3::new(x, y, z).norm());
            weight = weight.max(w.abs());
        }
    }
    (vector * factor, weight * factor)
}

pub(super) fn difference(a: &[f64; 4], b: &[f64; 4]) -> [f64; 4] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

/// Box around homogeneous control points: lowest and highest corner.
pub(super) fn hull(net: &[[f64; 4]]) -> [Vec3; 2] {
    let mut low = Vec3::from_element(f64::INFINITY);
    let mut high = -low;
    for &[x, y, z, w] in net {
        let p = Vec3::new(x, y, z) / w;
        low = low.inf(&p);
        high = high.sup(&p);
    }
    [low, high]
}

/// Squared distance of `q` from the box.
#[inline]
pub(super) fn box_distance2(q: &Vec3, low: &Vec3, high: &Vec3) -> f64 {
    let mut sum = 0.0;
    for k in 0..3 {
        let d = (low[k] - q[k]).max(q[k] - high[k]).max(0.0);
        sum += d * d;
    }
    sum
}

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

static BINOMIALS: [[f64; WIDTH]; WIDTH] = binomials();

/// Whether a Bezier piece is proved to lie outside of the open ball of radius `c` about `q`.
///
/// `|w (rho - q)|^2 - c^2 w^2` is a polynomial of twice the degrees; where none of its Bernstein coefficients is
/// negative, no point of the piece is nearer than `c` (X.-D. Chen, J.-H. Yong, G. Wang, J.-C. Paul, G. Xu, "Computing the
/// minimum distance between a point and a NURBS surface", CAD 40, 2008). For a sphere the bound is exact at its centre.
#[inline]
pub(super) fn outside_ball(net: &[[f64; 4]], degree: [usize; 2], q: &Vec3, c: f64) -> bool {
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

/// Cuts a control net at `t` (0 to 1) of direction `dir`: `left` becomes the first part, `right` the second one.
pub(super) fn split(
    left: &mut [[f64; 4]],
    right: &mut [[f64; 4]],
    degree: [usize; 2],
    dir: usize,
    t: f64,
) {
    let n1 = degree[0] + 1;
    let (lines, step, stride) = match dir {
        0 => (degree[1] + 1, n1, 1),
        _ => (n1, 1, n1),
    };
    let p = degree[dir];
    for line in 0..lines {
        let at = |i: usize| line * step + i * stride;
        let mut work = [[0.0; 4]; WIDTH];
        for (i, w) in work.iter_mut().enumerate().take(p + 1) {
            *w = left[at(i)];
        }
        for r in 0..=p {
            left[at(r)] = work[0];
            right[at(p - r)] = work[p - r];
            for i in 0..p - r {
                let next = work[i + 1];
                for (x, next) in work[i].iter_mut().zip(next) {
                    *x += t * (next - *x);
                }
            }
        }
    }
}
