//! Bezier pieces: control nets with bounds on their points and derivatives.
//!
//! Of every piece a set keeps its box, in the tree. The rest, some twenty times as much, follows from the patch and is made by
//! the first query that comes near.

use super::cells::Cell;
use crate::basis::WIDTH;
use crate::surface::Vec3;
use std::ops::Deref;
use std::sync::OnceLock;

/// Where a piece lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub patch: u32,
    pub span: [usize; 2],
    /// Place among the pieces of the patch.
    pub cell: [u32; 2],
    pub domain: [[f64; 2]; 2],
}

/// One Bezier piece of a patch, or a part of one, as the search uses it.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    place: Place,
    pub degree: [usize; 2],
    /// Homogeneous control points (w x, w y, w z, w), xi1 fastest.
    net: Box<[[f64; 4]]>,
    /// The piece within its surroundings.
    pub own: Cell,
    /// Bounds on `|rho_i|` over the piece, for parameters that run from 0 to 1.
    pub scale: [f64; 2],
    /// Bound on the second derivative as a quadratic form, in parameters scaled by `scale`.
    pub second: f64,
    /// Bound on the third derivative as a cubic form, in parameters scaled by `scale`.
    pub third: f64,
}

impl Deref for Piece {
    type Target = Place;

    #[inline]
    fn deref(&self) -> &Place {
        &self.place
    }
}

impl Piece {
    pub fn new(place: Place, degree: [usize; 2], net: Vec<[f64; 4]>, own: Cell) -> Self {
        let bounds = derivative_bounds(&net, degree);
        Self {
            place,
            degree,
            net: net.into(),
            own,
            scale: bounds.scale,
            second: bounds.second,
            third: bounds.third,
        }
    }

    /// Homogeneous control points (w x, w y, w z, w), xi1 fastest.
    #[inline]
    pub fn net(&self) -> &[[f64; 4]] {
        &self.net
    }
}

/// All pieces by number, each made when it is first asked for.
#[derive(Debug, Clone, Default)]
pub(super) struct Pieces {
    list: Vec<OnceLock<Box<Piece>>>,
}

impl Pieces {
    pub fn of(count: usize) -> Self {
        let list = (0..count).map(|_| OnceLock::new()).collect();
        Self { list }
    }

    pub fn count(&self) -> usize {
        self.list.len()
    }

    /// The piece with a number, made by `make` if it is the first time.
    #[inline]
    pub fn get(&self, number: u32, make: impl FnOnce() -> Box<Piece>) -> &Piece {
        self.list[number as usize].get_or_init(make)
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
    let moved: Vec<[f64; 4]> = about(middle(&hull(net)), net).collect();
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
    let m = scale(surface[1][0], surface[0][1]);
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

fn middle([low, high]: &[Vec3; 2]) -> Vec3 {
    (low + high) * 0.5
}

/// A control net about a point.
fn about(middle: Vec3, net: &[[f64; 4]]) -> impl Iterator<Item = [f64; 4]> {
    let moved =
        move |&[x, y, z, w]: &[f64; 4]| [x - middle.x * w, y - middle.y * w, z - middle.z * w, w];
    net.iter().map(moved)
}

/// Bounds on `|rho_i|` that are no less than a billionth of each other.
fn scale(first: f64, second: f64) -> [f64; 2] {
    let size = first.max(second).max(f64::MIN_POSITIVE);
    [first.max(1e-9 * size), second.max(1e-9 * size)]
}

/// What of [`derivative_bounds`] a set keeps of every patch, [`Piece::scale`], to the last bit, from a control net and its
/// [`hull`]; `room` is left as it comes.
pub(super) fn tangent_bounds(
    net: &[[f64; 4]],
    degree: [usize; 2],
    hull: &[Vec3; 2],
    room: &mut Vec<[f64; 4]>,
) -> [f64; 2] {
    room.clear();
    room.extend(about(middle(hull), net));
    let (mut smallest, mut reach) = (f64::INFINITY, 0.0f64);
    for &[x, y, z, w] in room.iter() {
        smallest = smallest.min(w);
        reach = reach.max(Vec3::new(x, y, z).norm() / w);
    }
    let n1 = degree[0] + 1;
    let tangent = |dir: usize| {
        let ([columns, rows], step) = match dir {
            0 => ([n1 - 1, degree[1] + 1], 1),
            _ => ([n1, degree[1]], n1),
        };
        let (mut vector, mut weight) = (0.0f64, 0.0f64);
        for j in 0..rows {
            for k in n1 * j..n1 * j + columns {
                let [x, y, z, w] = difference(&room[k + step], &room[k]);
                vector = vector.max(Vec3::new(x, y, z).norm());
                weight = weight.max(w.abs());
            }
        }
        let factor = degree[dir] as f64;
        (vector * factor + weight * factor * reach) / smallest
    };
    scale(tangent(0), tangent(1))
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
