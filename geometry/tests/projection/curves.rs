//! Loops with known insides.
#![allow(dead_code)]

use covact_geometry::{NurbsCurve, NurbsPatch, Trim, TrimCurve, TrimLoop, Vec3};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// xorshift64*; deterministic and without a dependency.
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.unit()
    }
}

pub fn curve(parameter: NurbsCurve<2>) -> TrimCurve {
    TrimCurve {
        parameter,
        space: None,
        entity: 0,
    }
}

pub fn one_curve(parameter: NurbsCurve<2>) -> TrimLoop {
    TrimLoop {
        curves: vec![curve(parameter)],
    }
}

/// Closed polygon of straight lines, one curve each.
pub fn polygon(points: &[[f64; 2]]) -> TrimLoop {
    let n = points.len();
    TrimLoop {
        curves: (0..n)
            .map(|k| {
                let (a, b) = (points[k].into(), points[(k + 1) % n].into());
                curve(NurbsCurve::line(a, b).unwrap())
            })
            .collect(),
    }
}

pub fn rectangle([[a, b], [c, d]]: [[f64; 2]; 2]) -> TrimLoop {
    polygon(&[[a, c], [b, c], [b, d], [a, d]])
}

/// Ellipse as one rational quadratic curve of four arcs, turned by `turn`.
pub fn ellipse(centre: [f64; 2], radii: [f64; 2], turn: f64) -> TrimLoop {
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let unit = [
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.0],
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
        [1.0, 0.0],
    ];
    let (s, c) = turn.sin_cos();
    let points = unit.map(|[x, y]| {
        let (x, y) = (x * radii[0], y * radii[1]);
        Vector2::new(centre[0] + c * x - s * y, centre[1] + s * x + c * y)
    });
    let weights = [1.0, h, 1.0, h, 1.0, h, 1.0, h, 1.0];
    let knots = vec![
        0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0,
    ];
    one_curve(NurbsCurve::new(2, knots, &points, Some(&weights)).unwrap())
}

/// Closed curve of `count` spans and any degree about a centre: control points at even angles and random radii.
pub fn star(
    random: &mut Random,
    centre: [f64; 2],
    radii: [f64; 2],
    degree: usize,
    count: usize,
    rational: bool,
) -> NurbsCurve<2> {
    let mut points: Vec<Vector2<f64>> = (0..count + degree)
        .map(|k| {
            let r = random.between(radii[0], radii[1]);
            let angle = TAU * k as f64 / (count + degree) as f64;
            Vector2::new(centre[0] + r * angle.cos(), centre[1] + r * angle.sin())
        })
        .collect();
    *points.last_mut().unwrap() = points[0];
    let n = points.len();
    let mut knots = vec![0.0; degree + 1];
    knots.extend((1..n - degree).map(|k| k as f64 / (n - degree) as f64));
    knots.extend(vec![1.0; degree + 1]);
    let weights: Vec<f64> = (0..n)
        .map(|_| {
            if rational {
                10f64.powf(random.between(-3.0, 3.0))
            } else {
                1.0
            }
        })
        .collect();
    NurbsCurve::new(degree, knots, &points, Some(&weights)).unwrap()
}

/// Whether a point is inside by the winding number of a fine polygon, and how near the polygon is. Shares nothing with the
/// test under test.
pub fn winding(polygons: &[Vec<Vector2<f64>>], x: [f64; 2]) -> (bool, f64) {
    let x = Vector2::from(x);
    let mut odd = false;
    let mut near = f64::INFINITY;
    for polygon in polygons {
        let mut turns = 0.0;
        for k in 0..polygon.len() {
            let (a, b) = (polygon[k] - x, polygon[(k + 1) % polygon.len()] - x);
            turns += a.perp(&b).atan2(a.dot(&b));
            let run = b - a;
            let share = (-a.dot(&run) / run.norm_squared()).clamp(0.0, 1.0);
            near = near.min((a + run * if share.is_nan() { 0.0 } else { share }).norm());
        }
        odd ^= (turns / TAU).round().rem_euclid(2.0) == 1.0;
    }
    (odd, near)
}

/// Points of the curves of a trim, `per_span` to a Bezier piece, loop by loop.
pub fn dense(trim: &Trim, per_span: usize) -> Vec<Vec<Vector2<f64>>> {
    trim.loops()
        .iter()
        .map(|a_loop| {
            let mut out = Vec::new();
            for c in &a_loop.curves {
                for piece in c.parameter.bezier_pieces() {
                    let [a, b] = piece.domain;
                    out.extend(
                        (0..per_span)
                            .map(|k| c.parameter.point(a + (b - a) * k as f64 / per_span as f64)),
                    );
                }
            }
            out
        })
        .collect()
}

/// Flat square plate [-1, 1] x [-1, 1] in the plane z = 0, parameters equal to coordinates.
pub fn plate() -> NurbsPatch {
    let points =
        [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let knots = vec![-1.0, -1.0, 1.0, 1.0];
    NurbsPatch::new([1, 1], [knots.clone(), knots], [2, 2], &points, None).unwrap()
}
