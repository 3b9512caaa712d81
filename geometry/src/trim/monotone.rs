//! Monotone pieces: rational Bezier pieces of parameter curves, cut where one of the coordinates turns round.
//!
//! A monotone piece lies in the box of its two end points, and a line parallel to an axis meets it once at most. That
//! makes tests against it exact in all but rounding: ends decide everything outside of the box.

use std::cmp::Ordering;

use crate::basis::WIDTH;

/// Point of the parameter plane.
pub(crate) type Point = [f64; 2];

/// One monotone piece.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Monotone {
    /// Number of the curve, counted over all loops.
    pub curve: u32,
    /// Parameters of the curve at both ends.
    pub t: [f64; 2],
    /// First and last point; the last one is the first one of the next piece to the bit.
    pub from: Point,
    pub to: Point,
    /// Homogeneous control points (w x, w y, w) over the parameter 0 to 1. Two are a straight line.
    pub net: Vec<[f64; 3]>,
}

impl Monotone {
    /// The straight line between two points of a loop.
    pub fn bridge(curve: u32, t: f64, from: Point, to: Point) -> Self {
        Self {
            curve,
            t: [t; 2],
            from,
            to,
            net: vec![[from[0], from[1], 1.0], [to[0], to[1], 1.0]],
        }
    }

    /// Lowest and highest corner.
    pub fn bounds(&self) -> [Point; 2] {
        [
            [0, 1].map(|k| self.from[k].min(self.to[k])),
            [0, 1].map(|k| self.from[k].max(self.to[k])),
        ]
    }

    /// Point at `s` (0 to 1).
    pub fn point(&self, s: f64) -> Point {
        let [x, y, w] = match self.net.len() {
            2 => de_casteljau::<2>(&self.net, s),
            3 => de_casteljau::<3>(&self.net, s),
            4 => de_casteljau::<4>(&self.net, s),
            _ => de_casteljau::<WIDTH>(&self.net, s),
        };
        // Rounding must not take a point out of the box.
        let [low, high] = self.bounds();
        [
            (x / w).clamp(low[0], high[0]),
            (y / w).clamp(low[1], high[1]),
        ]
    }

    /// Point and tangent (by `s`) at `s`.
    pub fn tangent(&self, s: f64) -> (Point, Point) {
        let n = self.net.len();
        let mut work = [[0.0; 3]; WIDTH];
        work[..n].copy_from_slice(&self.net);
        for r in 1..n - 1 {
            for i in 0..n - r {
                let next = work[i + 1];
                for (x, next) in work[i].iter_mut().zip(next) {
                    *x += s * (next - *x);
                }
            }
        }
        let h = [0, 1, 2].map(|c| work[0][c] + s * (work[1][c] - work[0][c]));
        let d = [0, 1, 2].map(|c| (work[1][c] - work[0][c]) * (n - 1) as f64);
        let p = [h[0] / h[2], h[1] / h[2]];
        (p, [0, 1].map(|k| (d[k] - p[k] * d[2]) / h[2]))
    }

    /// Parameter of the whole curve at `s`.
    pub fn parameter(&self, s: f64) -> f64 {
        self.t[0] + s * (self.t[1] - self.t[0])
    }

    /// Compares the other coordinate of the piece, where coordinate `k` is `value`, with `other`. `value` lies within the
    /// piece's range.
    pub fn compare(&self, k: usize, value: f64, other: f64) -> Ordering {
        let (mut a, mut b) = ((0.0, self.from), (1.0, self.to));
        let o = 1 - k;
        // What is left of the piece holds the point; its box shrinks, so this ends as soon as the box decides.
        for step in 0..100 {
            if a.1[o] > other && b.1[o] > other {
                return Ordering::Greater;
            }
            if a.1[o] < other && b.1[o] < other {
                return Ordering::Less;
            }
            let run = b.1[k] - a.1[k];
            let share = (value - a.1[k]) / run;
            if self.net.len() == 2 && self.net[0][2] == self.net[1][2]
                || b.0 - a.0 <= f64::EPSILON
                || run == 0.0
            {
                let share = if share.is_finite() { share } else { 0.5 };
                let at = a.1[o] + share.clamp(0.0, 1.0) * (b.1[o] - a.1[o]);
                return at.total_cmp(&other);
            }
            // Every third step halves, so that the bracket shrinks whatever the curve is like.
            let share = if step % 3 == 2 {
                0.5
            } else {
                share.clamp(0.02, 0.98)
            };
            let s = a.0 + share * (b.0 - a.0);
            let p = self.point(s);
            if (p[k] <= value) == (self.from[k] <= self.to[k]) {
                a = (s, p);
            } else {
                b = (s, p);
            }
        }
        a.1[o].total_cmp(&other)
    }

    /// Parameters `s` (0 to 1) at which coordinate `k` is `value`, which lies within the piece's range.
    pub fn solve(&self, k: usize, value: f64) -> f64 {
        let (mut a, mut b) = ((0.0, self.from[k]), (1.0, self.to[k]));
        for step in 0..100 {
            if b.0 - a.0 <= f64::EPSILON || a.1 == b.1 {
                break;
            }
            let share = if step % 3 == 2 {
                0.5
            } else {
                ((value - a.1) / (b.1 - a.1)).clamp(1e-3, 1.0 - 1e-3)
            };
            let s = a.0 + share * (b.0 - a.0);
            let x = self.point(s)[k];
            if x == value {
                return s;
            }
            if (x <= value) == (self.from[k] <= self.to[k]) {
                a = (s, x);
            } else {
                b = (s, x);
            }
        }
        0.5 * (a.0 + b.0)
    }

    /// Whether the piece meets the closed rectangle.
    pub fn meets(&self, low: Point, high: Point) -> bool {
        let [from, to] = self.bounds();
        if (0..2).any(|k| from[k] > high[k] || to[k] < low[k]) {
            return false;
        }
        if from[0] == to[0] {
            return true;
        }
        // Running up or down in xi2 with growing xi1, it misses the rectangle where it passes one of two corners.
        let up = (self.from[0] <= self.to[0]) == (self.from[1] <= self.to[1]);
        let (left, right) = (low[0], high[0]);
        let (beside_left, beside_right) = if up {
            (high[1], low[1])
        } else {
            (low[1], high[1])
        };
        // At xi1 = left the piece has passed the left corner, or at xi1 = right the right corner.
        let passes = |x: f64, y: f64, wanted: Ordering| {
            x >= from[0] && x <= to[0] && self.compare(0, x, y) == wanted
        };
        let (over, under) = if up {
            (Ordering::Greater, Ordering::Less)
        } else {
            (Ordering::Less, Ordering::Greater)
        };
        !(passes(left, beside_left, over) || passes(right, beside_right, under))
    }
}

/// Homogeneous point of a net of no more than `ROOM` control points.
#[inline]
fn de_casteljau<const ROOM: usize>(net: &[[f64; 3]], s: f64) -> [f64; 3] {
    let n = net.len().min(ROOM);
    let mut work = [[0.0; 3]; ROOM];
    work[..n].copy_from_slice(&net[..n]);
    for r in 1..n {
        for i in 0..n - r {
            let next = work[i + 1];
            for (x, next) in work[i].iter_mut().zip(next) {
                *x += s * (next - *x);
            }
        }
    }
    work[0]
}

/// Cuts a rational Bezier piece (w x, w y, w) over the parameters `t` into monotone pieces.
pub(crate) fn monotone_pieces(curve: u32, t: [f64; 2], net: &[[f64; 3]], out: &mut Vec<Monotone>) {
    let mut cuts = vec![0.0];
    for k in 0..2 {
        let turn = turning(net, k);
        roots(&turn, [0.0, 1.0], 0, &mut cuts);
    }
    cuts.sort_by(f64::total_cmp);
    cuts.push(1.0);
    cuts.dedup_by(|a, b| *a - *b <= 1e-13);
    if let Some(last) = cuts.last_mut() {
        *last = 1.0;
    }
    if cuts.len() < 2 {
        cuts = vec![0.0, 1.0];
    }
    let mut rest = net.to_vec();
    let mut first = project(&net[0]);
    for pair in cuts.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let own = if b < 1.0 {
            let (left, right) = split(&rest, (b - a) / (1.0 - a));
            rest = right;
            left
        } else {
            std::mem::take(&mut rest)
        };
        let last = project(&own[own.len() - 1]);
        let at = |s: f64| {
            if s >= 1.0 {
                t[1]
            } else {
                t[0] + s * (t[1] - t[0])
            }
        };
        out.push(Monotone {
            curve,
            t: [at(a), at(b)],
            from: first,
            to: last,
            net: own,
        });
        first = last;
    }
}

fn project(&[x, y, w]: &[f64; 3]) -> Point {
    [x / w, y / w]
}

/// Bernstein coefficients (degree `2 p - 1`) of `X' W - X W'`, whose sign is that of the derivative of coordinate `k`.
fn turning(net: &[[f64; 3]], k: usize) -> Vec<f64> {
    let p = net.len() - 1;
    // About the first point, so that what is constant to rounding comes out as zero.
    let origin = net[0][k] / net[0][2];
    let x: Vec<f64> = net.iter().map(|c| c[k] - origin * c[2]).collect();
    let w: Vec<f64> = net.iter().map(|c| c[2]).collect();
    let d = |v: &[f64]| v.windows(2).map(|v| v[1] - v[0]).collect::<Vec<_>>();
    let a = product(&d(&x), &w);
    let b = product(&x, &d(&w));
    let largest = x
        .iter()
        .zip(&w)
        .map(|(x, w)| (x / w).abs())
        .fold(0.0, f64::max);
    // Below this a coefficient is rounding.
    let floor = 1e-15 * (largest + origin.abs()) * w.iter().fold(0.0f64, |s, w| s.max(w * w));
    let out: Vec<f64> = a
        .iter()
        .zip(&b)
        .map(|(a, b)| {
            let x = a - b;
            if x.abs() <= floor { 0.0 } else { x }
        })
        .collect();
    debug_assert_eq!(out.len(), 2 * p);
    out
}

/// Product of polynomials in Bernstein form.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let n = a.len() + b.len() - 2;
    let b: Vec<f64> = b
        .iter()
        .zip(binomials(b.len() - 1))
        .map(|(b, c)| b * c)
        .collect();
    let mut out = vec![0.0; n + 1];
    for (i, (a, c)) in a.iter().zip(binomials(a.len() - 1)).enumerate() {
        for (out, b) in out[i..].iter_mut().zip(&b) {
            *out += a * c * b;
        }
    }
    for (out, c) in out.iter_mut().zip(binomials(n)) {
        *out /= c;
    }
    out
}

/// The binomial coefficients of `n` as floats, in order.
pub(crate) fn binomials(n: usize) -> impl Iterator<Item = f64> {
    let next =
        move |&(k, c): &(usize, f64)| (k < n).then(|| (k + 1, c * (n - k) as f64 / (k + 1) as f64));
    std::iter::successors(Some((0, 1.0)), next).map(|(_, c)| c)
}

/// Binomial coefficient as a float.
#[cfg(test)]
pub(crate) fn choose(n: usize, k: usize) -> f64 {
    let k = k.min(n - k);
    (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64)
}

/// Roots with a change of sign of a Bernstein polynomial on `range` (its own 0 to 1), by halving until the coefficients
/// change their sign once, then by bisection.
fn roots(c: &[f64], range: [f64; 2], depth: u32, out: &mut Vec<f64>) {
    let mut signs = c.iter().filter(|c| **c != 0.0).map(|c| *c > 0.0);
    let Some(mut sign) = signs.next() else {
        return;
    };
    let mut changes = 0;
    for s in signs {
        changes += u32::from(s != sign);
        sign = s;
    }
    if changes == 0 {
        return;
    }
    let middle = 0.5 * (range[0] + range[1]);
    if depth > 50 || range[1] - range[0] < 1e-14 {
        out.push(middle);
        return;
    }
    let (left, right) = halve(c);
    // A root at the cut itself shows in neither half.
    if right[0] == 0.0 {
        out.push(middle);
    }
    roots(&left, [range[0], middle], depth + 1, out);
    roots(&right, [middle, range[1]], depth + 1, out);
}

fn halve(c: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = c.len();
    let mut work = c.to_vec();
    let (mut left, mut right) = (vec![0.0; n], vec![0.0; n]);
    for r in 0..n {
        left[r] = work[0];
        right[n - 1 - r] = work[n - 1 - r];
        for i in 0..n - 1 - r {
            work[i] = 0.5 * (work[i] + work[i + 1]);
        }
    }
    (left, right)
}

/// De Casteljau's algorithm at `s`: both parts.
fn split(net: &[[f64; 3]], s: f64) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let n = net.len();
    let mut work = net.to_vec();
    let (mut left, mut right) = (work.clone(), work.clone());
    for r in 0..n {
        left[r] = work[0];
        right[n - 1 - r] = work[n - 1 - r];
        for i in 0..n - 1 - r {
            let next = work[i + 1];
            for (x, next) in work[i].iter_mut().zip(next) {
                *x += s * (next - *x);
            }
        }
    }
    (left, right)
}
