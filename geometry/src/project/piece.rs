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

/// Binomial coefficients `n` over 0 to `n`.
pub(super) fn row_of_pascal(n: usize) -> Vec<f64> {
    let mut row = vec![1.0; n + 1];
    for k in 1..n {
        row[k] = row[k - 1] * (n + 1 - k) as f64 / k as f64;
    }
    row
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

/// Cuts a control net at `t` (0 to 1) of direction `dir`: `left` becomes the first part, `right` the second one.
pub(crate) fn split(
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
