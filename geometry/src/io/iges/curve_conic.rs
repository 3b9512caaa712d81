//! Circular arcs (100) and arcs of conics (104).

use std::f64::consts::TAU;

use super::curve::{Reader, Shape, Stop};
use super::directory::Entry;
use super::params::Params;
use crate::curve::conic::{arc_knots, elliptic_arc, hyperbolic_arc, parabolic_arc};
use crate::io::brep::ParameterMap;
use crate::{NurbsCurve, Vec3};
use nalgebra::Vector2;

/// Angles closer than this to a full turn, or to none, are taken for one: writers print as few as 9 digits.
const FULL_TURN: f64 = 1e-8;

/// Angles of the start, in [0, 2 pi), and of the end of a counterclockwise arc; a whole turn where both points are the
/// same.
fn turn(start: f64, end: f64) -> [f64; 2] {
    let mut from = start.rem_euclid(TAU);
    if from > TAU - FULL_TURN {
        from = 0.0;
    }
    let mut sweep = (end - from).rem_euclid(TAU);
    if !(FULL_TURN..=TAU - FULL_TURN).contains(&sweep) {
        sweep = TAU;
    }
    [from, from + sweep]
}

/// A 100: a counterclockwise arc in the plane z = ZT about (X1, Y1) from (X2, Y2) to (X3, Y3); its parameter is the angle.
pub fn circle(reader: &mut Reader, entry: &Entry, params: &Params) -> Result<Vec<Shape>, Stop> {
    let v = params.reals(1, 7, "a coordinate of a circular arc")?;
    let center = Vec3::new(v[1], v[2], v[0]);
    let start = Vector2::new(v[3] - v[1], v[4] - v[2]);
    let end = Vector2::new(v[5] - v[1], v[6] - v[2]);
    let radius = start.norm();
    if radius <= 0.0 || !radius.is_finite() {
        return Err(Stop::Reason("a circular arc without a radius".to_owned()));
    }
    let off = (end.norm() - radius).abs();
    if off > reader.resolution().max(1e-6 * radius) {
        let text = format!(
            "the end of the arc lies {off:.1e} off the circle through its start, radius {radius}"
        );
        reader.note(entry, &text);
    }
    let [from, to] = turn(start.y.atan2(start.x), end.y.atan2(end.x));
    let (e1, e2) = (Vec3::x() * radius, Vec3::y() * radius);
    Ok(vec![Shape {
        curve: elliptic_arc(center, e1, e2, from, to)?,
        map: ParameterMap::arcs(&arc_knots(from, to)),
        deviation: 0.0,
    }])
}

/// A x^2 + B x y + C y^2 + D x + E y + F = 0 in its plane z = ZT.
struct Conic {
    /// A, B / 2, C.
    quadratic: [f64; 3],
    linear: Vector2<f64>,
    constant: f64,
    z: f64,
}

impl Conic {
    fn value(&self, x: Vector2<f64>) -> f64 {
        let [a, b, c] = self.quadratic;
        a * x.x * x.x + 2.0 * b * x.x * x.y + c * x.y * x.y + self.linear.dot(&x) + self.constant
    }

    /// Size of the terms of [`value`](Self::value).
    fn size(&self, x: Vector2<f64>) -> f64 {
        let [a, b, c] = self.quadratic;
        (a * x.x * x.x).abs()
            + (2.0 * b * x.x * x.y).abs()
            + (c * x.y * x.y).abs()
            + (self.linear.x * x.x).abs()
            + (self.linear.y * x.y).abs()
            + self.constant.abs()
    }

    fn at(&self, x: Vector2<f64>) -> Vec3 {
        Vec3::new(x.x, x.y, self.z)
    }

    /// Directions of the axes with the coefficients of the squares along them. Those of x and y where they are the axes.
    fn axes(&self) -> [(Vector2<f64>, f64); 2] {
        let [a, b, c] = self.quadratic;
        if b == 0.0 {
            return [(Vector2::x(), a), (Vector2::y(), c)];
        }
        let angle = 0.5 * (2.0 * b).atan2(a - c);
        let v = Vector2::new(angle.cos(), angle.sin());
        let w = Vector2::new(-v.y, v.x);
        let along = |v: Vector2<f64>| a * v.x * v.x + 2.0 * b * v.x * v.y + c * v.y * v.y;
        [(v, along(v)), (w, along(w))]
    }
}

/// A 104: the part of a conic from (X1, Y1) to (X2, Y2). Its parameter is that of IGES 5.3: the angle t of (a cos t, b sin
/// t) on an ellipse, which is run through counterclockwise, of (a sec t, b tan t) on a hyperbola, and the coordinate along
/// the vertex tangent on a parabola.
pub fn conic(reader: &mut Reader, entry: &Entry, params: &Params) -> Result<Vec<Shape>, Stop> {
    let v = params.reals(1, 11, "a coefficient or coordinate of a conic arc")?;
    let largest = v[..3].iter().fold(0.0f64, |m, x| m.max(x.abs()));
    // The coefficients have a common factor that means nothing.
    let scale = if largest > 0.0 { largest } else { 1.0 };
    let conic = Conic {
        quadratic: [v[0] / scale, 0.5 * v[1] / scale, v[2] / scale],
        linear: Vector2::new(v[3], v[4]) / scale,
        constant: v[5] / scale,
        z: v[6],
    };
    let ends = [Vector2::new(v[7], v[8]), Vector2::new(v[9], v[10])];
    let [a, b, c] = conic.quadratic;
    let determinant = a * c - b * b;
    let flat = determinant.abs() <= 1e-12;
    let shape = match entry.form {
        3 if determinant.abs() <= 1e-6 => parabola(&conic, ends),
        _ if flat => parabola(&conic, ends),
        _ => central(&conic, determinant, ends),
    }?;
    let (shape, kind) = match shape {
        Some((shape, form)) => (shape, form),
        None => (segment(&conic, ends)?, 0),
    };
    if (1..=3).contains(&entry.form) && kind != entry.form {
        let names = ["pair of lines", "ellipse", "hyperbola", "parabola"];
        let text = format!(
            "form {} says {}, the coefficients say {}; they count",
            entry.form, names[entry.form as usize], names[kind as usize]
        );
        reader.note(entry, &text);
    }
    // The ends are on the conic only as well as the file says so.
    let found = shape.curve.ends();
    let off = (0..2).map(|k| {
        let closed = found[0] - found[1];
        let stated = conic.at(ends[k]);
        if closed.norm() == 0.0 {
            (found[0] - stated).norm()
        } else {
            (found[k] - stated).norm()
        }
    });
    let off = off.fold(0.0, f64::max);
    let size = ends[0].norm().max(ends[1].norm());
    if off > reader.resolution().max(1e-6 * size) {
        let text = format!("an end point lies {off:.1e} off the conic; the conic counts");
        reader.note(entry, &text);
    }
    Ok(vec![shape])
}

/// A shape with the form number of its kind; `None` for a conic that falls apart into lines.
type Found = Option<(Shape, i32)>;

/// Ellipse or hyperbola.
fn central(conic: &Conic, determinant: f64, ends: [Vector2<f64>; 2]) -> Result<Found, Stop> {
    let [a, b, c] = conic.quadratic;
    let l = conic.linear;
    let middle = Vector2::new(b * l.y - c * l.x, b * l.x - a * l.y) * (0.5 / determinant);
    let level = -(conic.constant + 0.5 * l.dot(&middle));
    let noise = 1e-14 * conic.size(middle).max(conic.constant.abs());
    if level.abs() <= noise {
        return if determinant > 0.0 {
            Err(Stop::Reason("a conic that is a single point".to_owned()))
        } else {
            Ok(None)
        };
    }
    let [(v, along_v), (w, along_w)] = conic.axes();
    let squares = [level / along_v, level / along_w];
    let flat = |x: Vector2<f64>| Vec3::new(x.x, x.y, 0.0);
    if determinant > 0.0 {
        if squares[0] < 0.0 || squares[1] < 0.0 {
            return Err(Stop::Reason("an ellipse without real points".to_owned()));
        }
        let [p, q] = squares.map(f64::sqrt);
        let [start, end] = ends.map(|x| {
            let x = x - middle;
            (x.dot(&w) / q).atan2(x.dot(&v) / p)
        });
        let [from, to] = turn(start, end);
        let (e1, e2) = (flat(v * p), flat(w * q));
        let shape = Shape {
            curve: elliptic_arc(conic.at(middle), e1, e2, from, to)?,
            map: ParameterMap::arcs(&arc_knots(from, to)),
            deviation: 0.0,
        };
        return Ok(Some((shape, 1)));
    }
    // Real points lie along the axis with the positive square.
    let (real, other) = if squares[0] > 0.0 { (0, 1) } else { (1, 0) };
    let directions = [v, w];
    let [p, q] = [squares[real].sqrt(), (-squares[other]).sqrt()];
    let sides = ends.map(|x| (x - middle).dot(&directions[real]) > 0.0);
    if sides[0] != sides[1] {
        let reason = "the ends of the hyperbola lie on different branches";
        return Err(Stop::Reason(reason.to_owned()));
    }
    let e1 = directions[real] * if sides[0] { p } else { -p };
    let mut e2 = directions[other] * q;
    let mut angles = ends.map(|x| ((x - middle).dot(&directions[other]) / q).atan());
    if angles[0] > angles[1] {
        e2 = -e2;
        angles = angles.map(|t| -t);
    }
    let [from, to] = angles;
    let curve = hyperbolic_arc(conic.at(middle), flat(e1), flat(e2), from, to)?;
    let mut map = ParameterMap::half_angle(angles);
    if !sides[0] {
        // On the other branch the secant is negative: the angle there is larger by pi.
        let shifted = angles.map(|t| t + std::f64::consts::PI);
        map = map.with_file_range(shifted, false);
    }
    let shape = Shape {
        curve,
        map,
        deviation: 0.0,
    };
    Ok(Some((shape, 2)))
}

/// One square only, that of the coordinate along the vertex tangent.
fn parabola(conic: &Conic, ends: [Vector2<f64>; 2]) -> Result<Found, Stop> {
    let [first, second] = conic.axes();
    let ((mut v, square), (w, _)) = if first.1.abs() >= second.1.abs() {
        (first, second)
    } else {
        (second, first)
    };
    let along = conic.linear.dot(&w);
    let size = ends[0].norm().max(ends[1].norm());
    if square == 0.0 || along.abs() <= 1e-12 * (square * size).abs().max(conic.linear.norm()) {
        return Ok(None);
    }
    let mut t = ends.map(|x| x.dot(&v));
    if t[0] > t[1] {
        v = -v;
        t = t.map(|t| -t);
    }
    let across = conic.linear.dot(&v);
    let flat = |x: Vector2<f64>| Vec3::new(x.x, x.y, 0.0);
    let curve = parabolic_arc(
        conic.at(w * (-conic.constant / along)),
        flat(v - w * (across / along)),
        flat(w * (-square / along)),
        t[0],
        t[1],
    )?;
    Ok(Some((Shape::exact(curve), 3)))
}

/// The line between the ends where the conic is made of lines and holds it.
fn segment(conic: &Conic, ends: [Vector2<f64>; 2]) -> Result<Shape, Stop> {
    for s in [0.25, 0.5, 0.75] {
        let x = ends[0] + (ends[1] - ends[0]) * s;
        if conic.value(x).abs() > 1e-7 * conic.size(x) {
            let reason = "a conic of two lines whose ends lie on different ones";
            return Err(Stop::Reason(reason.to_owned()));
        }
    }
    if ends[0] == ends[1] {
        return Err(Stop::Reason("a conic arc without length".to_owned()));
    }
    let curve = NurbsCurve::line(conic.at(ends[0]), conic.at(ends[1]))?;
    Ok(Shape::exact(curve))
}
