//! Exact NURBS forms of arcs of conics.
//!
//! A circle, an ellipse and a hyperbola are rational quadratics in `s = tan(angle / 2)`: `cos = (1 - s^2) / (1 + s^2)`,
//! `sin = 2 s / (1 + s^2)`, `sec = (1 + s^2) / (1 - s^2)`, `tan = 2 s / (1 - s^2)`. A parabola is a polynomial.

use std::f64::consts::FRAC_PI_2;

use nalgebra::SVector;

use super::{CurveError, NurbsCurve};
use crate::basis::Basis;

/// Number of arcs of at most a right angle that make up `angle`; rounding does not add one.
fn arcs(angle: f64) -> usize {
    // The cast takes what is not a number to zero.
    ((angle / FRAC_PI_2 - 1e-9).ceil() as usize).clamp(1, 4096)
}

/// Angles at which the pieces of [`elliptic_arc`] begin, and the end of the last.
pub fn arc_knots(from: f64, to: f64) -> Vec<f64> {
    let n = arcs(to - from);
    (0..=n)
        .map(|k| match k {
            0 => from,
            k if k == n => to,
            k => from + (to - from) * (k as f64 / n as f64),
        })
        .collect()
}

/// The arc `center + e1 cos(angle) + e2 sin(angle)` for angles (radians) from `from` up to `to`: a circle where `e1` and
/// `e2` are orthogonal and equally long, else an ellipse. Equal rational quadratic pieces of at most a right angle, whose
/// knots are the angles (Piegl and Tiller 1997, section 7.5); between two knots with middle `m` and half difference `a`
/// the angle at parameter `t` is `m + 2 atan(tan(a / 2) (t - m) / a)`.
///
/// # Errors
/// `to <= from`, or numbers that are not finite.
pub fn elliptic_arc<const D: usize>(
    center: SVector<f64, D>,
    e1: SVector<f64, D>,
    e2: SVector<f64, D>,
    from: f64,
    to: f64,
) -> Result<NurbsCurve<D>, CurveError> {
    let angles = arc_knots(from, to);
    let half = 0.5 * (to - from) / (angles.len() - 1) as f64;
    let w = half.cos();
    let mut points = Vec::with_capacity(2 * angles.len() - 1);
    let mut knots = vec![from; 3];
    let at = |angle: f64, radius: f64, w: f64| {
        let x = center + (e1 * angle.cos() + e2 * angle.sin()) * radius;
        homogeneous(x, w)
    };
    points.push(at(from, 1.0, 1.0));
    for pair in angles.windows(2) {
        points.push(at(0.5 * (pair[0] + pair[1]), 1.0 / w, w));
        points.push(at(pair[1], 1.0, 1.0));
        knots.extend([pair[1], pair[1]]);
    }
    knots.push(to);
    let basis = Basis::new(2, knots, points.len())?;
    NurbsCurve::from_homogeneous(basis, points)
}

/// The arc `center + e1 sec(angle) + e2 tan(angle)` of a hyperbola for angles from `from` up to `to`, both between -pi/2
/// and pi/2: one rational quadratic piece on the domain `[from, to]`, whose parameter is affine in `tan(angle / 2)`.
///
/// # Errors
/// `to <= from`, angles outside of their range, or numbers that are not finite.
pub fn hyperbolic_arc<const D: usize>(
    center: SVector<f64, D>,
    e1: SVector<f64, D>,
    e2: SVector<f64, D>,
    from: f64,
    to: f64,
) -> Result<NurbsCurve<D>, CurveError> {
    let [a, b] = [from, to].map(|angle| (0.5 * angle).tan());
    // Blossom of (e1 (1 + s^2) + 2 e2 s) / (1 - s^2).
    let blossom = |s: f64, t: f64| {
        let w = 1.0 - s * t;
        let x = center * w + e1 * (1.0 + s * t) + e2 * (s + t);
        let mut p = [0.0, 0.0, 0.0, w];
        for (p, x) in p.iter_mut().zip(x.iter()) {
            *p = *x;
        }
        p
    };
    let basis = Basis::new(2, vec![from, from, from, to, to, to], 3)?;
    NurbsCurve::from_homogeneous(basis, vec![blossom(a, a), blossom(a, b), blossom(b, b)])
}

/// The arc `center + e1 t + e2 t^2` of a parabola for `t` from `from` up to `to`, with that parameter.
///
/// # Errors
/// `to <= from`, or numbers that are not finite.
pub fn parabolic_arc<const D: usize>(
    center: SVector<f64, D>,
    e1: SVector<f64, D>,
    e2: SVector<f64, D>,
    from: f64,
    to: f64,
) -> Result<NurbsCurve<D>, CurveError> {
    let blossom = |s: f64, t: f64| center + e1 * (0.5 * (s + t)) + e2 * (s * t);
    let points = [blossom(from, from), blossom(from, to), blossom(to, to)];
    NurbsCurve::new(2, vec![from, from, from, to, to, to], &points, None)
}

fn homogeneous<const D: usize>(x: SVector<f64, D>, w: f64) -> [f64; 4] {
    let mut p = [0.0, 0.0, 0.0, w];
    for (p, x) in p.iter_mut().zip(x.iter()) {
        *p = x * w;
    }
    p
}
