//! A cheap proof that a stationary point is the closest one of all its surroundings.
//!
//! Let `x` be stationary on a rectangle of parameters, `d = q - x`, and `y` another point of the rectangle, `D` away in
//! the parameters. Then
//!
//! `|q - y|^2 - |q - x|^2 = |y - x|^2 - 2 d.(y - x)`.
//!
//! The second term is at most `D.Q.D`, `Q_ij = max d.rho_ij` over the rectangle, because `d.rho_i D_i <= 0` at a
//! stationary point with active bounds (and far below it where they hold it hard). The first is at least `(1 - e)^2 D.G.D`, where `G` is the metric of mean
//! tangents in a plane and `e` says how far the tangents, seen in that plane, are off the mean. Where the difference
//! of both forms is positive, nothing in the rectangle is nearer. `G` and the range of `rho_ij` are known beforehand,
//! so the proof costs less than an evaluation; it holds on the side where the surface bends away however far the
//! point is, and on the other side up to about the radius of curvature.

use super::piece::{Piece, difference, hull, row_of_pascal};
use crate::surface::Vec3;

/// Range of a number.
#[derive(Debug, Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

const EMPTY: Range = Range {
    low: f64::INFINITY,
    high: f64::NEG_INFINITY,
};

impl Range {
    fn take(&mut self, x: f64) {
        self.low = self.low.min(x);
        self.high = self.high.max(x);
    }

    fn join(&mut self, other: Range) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }

    fn middle(self) -> f64 {
        0.5 * (self.low + self.high)
    }

    fn half(self) -> f64 {
        0.5 * (self.high - self.low)
    }

    fn scaled(self, f: f64) -> Range {
        let (a, b) = (self.low * f, self.high * f);
        Range {
            low: a.min(b),
            high: a.max(b),
        }
    }

    fn times(self, other: Range) -> Range {
        let mut out = EMPTY;
        for a in [self.low, self.high] {
            for b in [other.low, other.high] {
                out.take(a * b);
            }
        }
        out
    }

    fn minus(self, other: Range) -> Range {
        Range {
            low: self.low - other.high,
            high: self.high - other.low,
        }
    }

    /// Divided by a positive range.
    fn over(self, w: Range) -> Range {
        self.times(Range {
            low: 1.0 / w.high,
            high: 1.0 / w.low,
        })
    }
}

/// Three unit vectors at right angles: two in the mean tangent plane, then its normal.
pub(super) type Axes = [Vec3; 3];

/// Axes of a piece from its corners; `None` where they do not span a plane.
pub(super) fn axes(net: &[[f64; 4]], degree: [usize; 2]) -> Option<Axes> {
    let point = |k: usize| Vec3::new(net[k][0], net[k][1], net[k][2]) / net[k][3];
    let (n1, n) = (degree[0] + 1, net.len());
    let corners = [point(0), point(n1 - 1), point(n - n1), point(n - 1)];
    let one = corners[1] - corners[0] + corners[3] - corners[2];
    let two = corners[2] - corners[0] + corners[3] - corners[1];
    let normal = one.cross(&two);
    if normal.norm() <= 1e-6 * one.norm() * two.norm() {
        return None;
    }
    let (first, normal) = (one.try_normalize(0.0)?, normal.try_normalize(0.0)?);
    Some([first, normal.cross(&first), normal])
}

/// Ranges of the derivatives 1, 2, 11, 12, 22 in the parameters of the patch, each along the three axes.
struct Derivatives([[Range; 3]; 5]);

impl Derivatives {
    const NONE: Derivatives = Derivatives([[EMPTY; 3]; 5]);

    fn join(&mut self, other: &Derivatives) {
        for (own, other) in self.0.iter_mut().flatten().zip(other.0.iter().flatten()) {
            own.join(*other);
        }
    }

    /// Of a rational Bezier net over a rectangle of the given widths: the control nets' derivatives hold those of
    /// numerator and weight, the quotient rule in ranges the rest. The first derivatives are taken from `tangents` where
    /// there are any.
    fn of(
        net: &[[f64; 4]],
        degree: [usize; 2],
        width: [f64; 2],
        tangents: [&[Vec3]; 2],
        axes: &Axes,
    ) -> Derivatives {
        let [low, high] = hull(net);
        let middle = (low + high) * 0.5;
        let mut place = [EMPTY; 3];
        let turn = |&[x, y, z, w]: &[f64; 4]| {
            let p = Vec3::new(x, y, z) - middle * w;
            let [a, b, c] = axes.map(|axis| p.dot(&axis));
            for (place, x) in place.iter_mut().zip([a, b, c]) {
                place.take(x / w);
            }
            [a, b, c, w]
        };
        let turned: Vec<[f64; 4]> = net.iter().map(turn).collect();
        let of = |orders| ranges(&turned, degree, orders);
        let w0 = of([0, 0])[3];
        let nets = [of([1, 0]), of([0, 1]), of([2, 0]), of([1, 1]), of([0, 2])];
        let w = nets.map(|n| n[3]);
        let mut out = Derivatives::NONE;
        for k in 0..3 {
            let first = [0, 1].map(|i| {
                if tangents[i].is_empty() {
                    return nets[i][k].minus(place[k].times(w[i])).over(w0);
                }
                let mut range = EMPTY;
                for tangent in tangents[i] {
                    range.take(tangent.dot(&axes[k]));
                }
                range
            });
            let second = |slot: usize, i: usize, j: usize| {
                nets[slot][k]
                    .minus(first[i].times(w[j]))
                    .minus(first[j].times(w[i]))
                    .minus(place[k].times(w[slot]))
                    .over(w0)
                    .scaled(1.0 / (width[i] * width[j]))
            };
            out.0[2][k] = second(2, 0, 0);
            out.0[3][k] = second(3, 0, 1);
            out.0[4][k] = second(4, 1, 1);
            out.0[0][k] = first[0].scaled(1.0 / width[0]);
            out.0[1][k] = first[1].scaled(1.0 / width[1]);
        }
        out
    }
}

/// Vectors whose convex hull holds the tangents `rho_1`, `rho_2` of a rational piece (for parameters from 0 to 1); none
/// for a polynomial one, whose tangents have control vectors of their own.
type Tangents = [Vec<Vec3>; 2];

/// With numerator `A` and denominator `w`, `rho_i = (A_i w - A w_i) / w^2`; both sides of the fraction are brought to
/// twice the degrees, where the ratios of their coefficients are such vectors.
fn tangents(net: &[[f64; 4]], degree: [usize; 2]) -> Tangents {
    if net.iter().all(|p| p[3] == net[0][3]) {
        return [Vec::new(), Vec::new()];
    }
    // About the middle, which keeps the products small.
    let [low, high] = hull(net);
    let middle = (low + high) * 0.5;
    let near = |p: &[f64; 4]| Vec3::new(p[0], p[1], p[2]) - middle * p[3];
    let [n1, n2] = degree.map(|p| p + 1);
    let binomials = degree.map(row_of_pascal);
    [0, 1].map(|dir| {
        let narrow = row_of_pascal(degree[dir] - 1);
        let (m1, m2) = (2 * degree[0] + 1, 2 * degree[1] + 1);
        let mut above = vec![Vec3::zeros(); m1 * m2];
        let mut below = vec![0.0; m1 * m2];
        for j in 0..n2 {
            for i in 0..n1 {
                let p = &net[i + n1 * j];
                let f = binomials[0][i] * binomials[1][j];
                for l in 0..n2 {
                    for k in 0..n1 {
                        let q = &net[k + n1 * l];
                        let g = f * binomials[0][k] * binomials[1][l];
                        below[i + k + m1 * (j + l)] += g * p[3] * q[3];
                        let at = [k, l];
                        if at[dir] == degree[dir] {
                            continue;
                        }
                        let next = &net[if dir == 0 {
                            k + 1 + n1 * l
                        } else {
                            k + n1 * (l + 1)
                        }];
                        let derivative = (near(next) - near(q)) * p[3] - near(p) * (next[3] - q[3]);
                        let other = binomials[1 - dir][at[1 - dir]];
                        let term = derivative * (f * narrow[at[dir]] * other * degree[dir] as f64);
                        // Times 1 - t + t, which raises the degree 2 p - 1 in this direction to 2 p.
                        above[i + k + m1 * (j + l)] += term;
                        let (a, b) = if dir == 0 { (1, 0) } else { (0, 1) };
                        above[i + k + a + m1 * (j + l + b)] += term;
                    }
                }
            }
        }
        // Both are scaled by the same binomials, which cancel.
        above.iter().zip(&below).map(|(a, b)| a / *b).collect()
    })
}

/// Ranges of the derivative net of the given orders.
fn ranges(net: &[[f64; 4]], degree: [usize; 2], orders: [usize; 2]) -> [Range; 4] {
    let mut out = [EMPTY; 4];
    if orders[0] > degree[0] || orders[1] > degree[1] {
        return [Range {
            low: 0.0,
            high: 0.0,
        }; 4];
    }
    let n1 = degree[0] + 1;
    let factor = (0..2)
        .map(|k| {
            (0..orders[k])
                .map(|m| (degree[k] - m) as f64)
                .product::<f64>()
        })
        .product::<f64>();
    for j in 0..=degree[1] - orders[1] {
        for i in 0..=degree[0] - orders[0] {
            let at = |a: usize, b: usize| &net[i + a + n1 * (j + b)];
            let point = match orders {
                [0, 0] => *at(0, 0),
                [1, 0] => difference(at(1, 0), at(0, 0)),
                [0, 1] => difference(at(0, 1), at(0, 0)),
                [1, 1] => difference(
                    &difference(at(1, 1), at(0, 1)),
                    &difference(at(1, 0), at(0, 0)),
                ),
                [2, _] => difference(
                    &difference(at(2, 0), at(1, 0)),
                    &difference(at(1, 0), at(0, 0)),
                ),
                _ => difference(
                    &difference(at(0, 2), at(0, 1)),
                    &difference(at(0, 1), at(0, 0)),
                ),
            };
            for (range, x) in out.iter_mut().zip(point) {
                range.take(x * factor);
            }
        }
    }
    out
}

/// What the proof needs to know of a rectangle.
#[derive(Debug, Clone)]
pub(super) struct Convex {
    axes: Axes,
    /// `(1 - e)^2 G`: 11, 12, 22. Minus infinity where there is no proof, so that nothing that holds a point makes up
    /// for it.
    metric: [f64; 3],
    /// Middle and half width of the ranges of `rho_11`, `rho_12`, `rho_22` along the axes.
    middle: [Vec3; 3],
    half: [Vec3; 3],
}

impl Convex {
    /// No proof for any point.
    pub const NEVER: Convex = Convex {
        axes: [Vec3::new(0.0, 0.0, 0.0); 3],
        metric: [f64::NEG_INFINITY, 0.0, f64::NEG_INFINITY],
        middle: [Vec3::new(0.0, 0.0, 0.0); 3],
        half: [Vec3::new(0.0, 0.0, 0.0); 3],
    };

    /// For a rectangle that consists of the given pieces.
    pub fn new<'a>(axes: &Axes, members: impl Iterator<Item = &'a Piece>) -> Convex {
        let mut all = Derivatives::NONE;
        for piece in members {
            let width = piece.domain.map(|[a, b]| b - a);
            let net = piece.net();
            let tangents = tangents(net, piece.degree);
            let tangents = [&tangents[0][..], &tangents[1][..]];
            all.join(&Derivatives::of(net, piece.degree, width, tangents, axes));
        }
        Convex::from_ranges(&all, axes)
    }

    /// For a part of a piece with the given control net and widths in the parameters.
    pub fn of_part(net: &[[f64; 4]], degree: [usize; 2], width: [f64; 2]) -> Convex {
        match axes(net, degree) {
            Some(axes) => {
                let all = Derivatives::of(net, degree, width, [&[], &[]], &axes);
                Convex::from_ranges(&all, &axes)
            }
            None => Convex::NEVER,
        }
    }

    fn from_ranges(all: &Derivatives, axes: &Axes) -> Convex {
        let d = &all.0;
        let tangent = [0, 1].map(|i| [d[i][0].middle(), d[i][1].middle()]);
        let off = [0, 1].map(|i| d[i][0].half().hypot(d[i][1].half()));
        let dot =
            |i: usize, j: usize| tangent[i][0] * tangent[j][0] + tangent[i][1] * tangent[j][1];
        let g = [dot(0, 0), dot(0, 1), dot(1, 1)];
        let det = g[0] * g[2] - g[1] * g[1];
        if det <= 1e-12 * g[0] * g[2] || det.is_nan() {
            return Convex::NEVER;
        }
        // |D_i| is at most sqrt(G_jj / det G) of the length of the step in the plane.
        let error = off[0] * (g[2] / det).sqrt() + off[1] * (g[0] / det).sqrt();
        if error >= 0.999 || error.is_nan() {
            return Convex::NEVER;
        }
        let vector = |slot: usize, f: fn(Range) -> f64| {
            let [a, b, c] = d[slot];
            Vec3::new(f(a), f(b), f(c))
        };
        let shrink = (1.0 - error) * (1.0 - error);
        Convex {
            axes: *axes,
            metric: g.map(|g| g * shrink),
            middle: [2, 3, 4].map(|slot| vector(slot, Range::middle)),
            half: [2, 3, 4].map(|slot| vector(slot, Range::half)),
        }
    }

    /// Whether the stationary point with `d = q - rho` is proved to be the nearest of the rectangle. `held` are twice the
    /// slopes `|rho_i . d|` that hold it on active bounds over the widths of the rectangle: on such a bound
    /// `-2 d.rho_i D_i` is at least that times `D_i^2`. `slope` is what the iteration has left over of `rho_i . d` in the
    /// free directions: the squares of other distances may be less than that of the point by what it is worth, which
    /// must not exceed `slack`.
    #[inline]
    pub fn holds(&self, d: &Vec3, held: [f64; 2], slope: [f64; 2], slack: f64) -> bool {
        let local = Vec3::new(
            self.axes[0].dot(d),
            self.axes[1].dot(d),
            self.axes[2].dot(d),
        );
        let size = local.abs();
        // A thousandth is left for rounding.
        let free = |k: usize| {
            let spread = self.half[k].dot(&size);
            (0.999 * self.metric[k] - self.middle[k].dot(&local), spread)
        };
        let (a, b, c) = (free(0), free(1), free(2));
        let (a, b, c) = (a.0 - a.1 + held[0], b.0.abs() + b.1, c.0 - c.1 + held[1]);
        let det = a * c - b * b;
        let worth = c * slope[0] * slope[0]
            + 2.0 * b * (slope[0] * slope[1]).abs()
            + a * slope[1] * slope[1];
        a > 0.0 && c > 0.0 && det > 0.0 && worth <= slack * det
    }
}
