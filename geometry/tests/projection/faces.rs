//! Trimmed faces with known shapes for the tests of topology.

use covact_geometry::curve::NurbsCurve;
use covact_geometry::trim::{Trim, TrimCurve, TrimLoop};
use covact_geometry::{NurbsPatch, Vec3};
use nalgebra::Vector2;

/// Parameters of a planar face are lengths over this, so that nothing depends on unit tangents.
pub const UNIT: f64 = 2.5;

/// Closed polygon of straight curves through plane points.
pub fn polygon(points: &[[f64; 2]]) -> Vec<NurbsCurve<2>> {
    (0..points.len())
        .map(|k| {
            let [a, b] = [points[k], points[(k + 1) % points.len()]];
            NurbsCurve::line(Vector2::from(a), Vector2::from(b)).unwrap()
        })
        .collect()
}

/// Circular arc from angle `a` to `b` (radians, either way round) as one curve of quadratic pieces.
pub fn arc(center: [f64; 2], radius: f64, a: f64, b: f64) -> NurbsCurve<2> {
    let pieces = ((b - a).abs() / 1.6).ceil().max(1.0) as usize;
    let step = (b - a) / pieces as f64;
    let at =
        |angle: f64, r: f64| Vector2::new(center[0] + r * angle.cos(), center[1] + r * angle.sin());
    let (mut points, mut weights) = (vec![at(a, radius)], vec![1.0]);
    let mut knots = vec![0.0; 3];
    for k in 0..pieces {
        let start = a + step * k as f64;
        let w = (0.5 * step).cos();
        points.push(at(start + 0.5 * step, radius / w));
        points.push(at(start + step, radius));
        weights.extend([w, 1.0]);
        knots.extend([(k + 1) as f64; 2]);
    }
    knots.push(pieces as f64);
    // A closed arc ends exactly where it began.
    if ((b - a).abs() - std::f64::consts::TAU).abs() < 1e-12 {
        let last = points.len() - 1;
        points[last] = points[0];
    }
    NurbsCurve::new(2, knots, &points, Some(&weights)).unwrap()
}

/// Loop with the entity numbers 0.
pub fn a_loop(curves: Vec<NurbsCurve<2>>) -> TrimLoop {
    let curve = |parameter| TrimCurve {
        parameter,
        space: None,
        entity: 0,
    };
    TrimLoop {
        curves: curves.into_iter().map(curve).collect(),
    }
}

/// Trims a patch by loops of its own parameters.
pub fn trimmed(patch: NurbsPatch, loops: Vec<Vec<NurbsCurve<2>>>) -> NurbsPatch {
    let loops = loops.into_iter().map(a_loop).collect();
    let trim = Trim::new(loops, patch.domain(), 1e-9).unwrap();
    patch.with_trim(Some(trim))
}

fn scaled(curve: &NurbsCurve<2>) -> NurbsCurve<2> {
    let points = curve.homogeneous().iter();
    let points = points
        .map(|[x, y, z, w]| [x / UNIT, y / UNIT, *z, *w])
        .collect();
    NurbsCurve::from_homogeneous(curve.basis().clone(), points).unwrap()
}

/// Face in the plane `origin + x e1 + y e2` that reaches from `-extent` to `extent` in both and is trimmed by loops of
/// plane coordinates (x, y).
pub fn face(
    origin: [f64; 3],
    e1: [f64; 3],
    e2: [f64; 3],
    extent: f64,
    loops: &[Vec<NurbsCurve<2>>],
) -> NurbsPatch {
    let [o, e1, e2] = [origin, e1, e2].map(Vec3::from);
    let corner = |x: f64, y: f64| o + e1 * (x * extent) + e2 * (y * extent);
    let points = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(-1.0, 1.0),
        corner(1.0, 1.0),
    ];
    let end = extent / UNIT;
    let knots = vec![-end, -end, end, end];
    let patch = NurbsPatch::new([1; 2], [knots.clone(), knots], [2; 2], &points, None).unwrap();
    let loops = loops
        .iter()
        .map(|curves| curves.iter().map(scaled).collect())
        .collect();
    trimmed(patch, loops)
}

/// Box [-a, a] x [-b, b] x [-c, c] of six trimmed planes. Loops and parametrisations run either way.
pub fn trimmed_box(half: [f64; 3]) -> Vec<NurbsPatch> {
    let mut faces = Vec::new();
    for axis in 0..3 {
        for (number, end) in [-1.0, 1.0].into_iter().enumerate() {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let unit = |k: usize| {
                let mut e = [0.0; 3];
                e[k] = 1.0;
                e
            };
            let mut origin = [0.0; 3];
            origin[axis] = end * half[axis];
            let (a, b) = (half[i], half[j]);
            let mut corners = [[-a, -b], [a, -b], [a, b], [-a, b]];
            if (axis + number) % 2 == 1 {
                corners.reverse();
            }
            let extent = 1.7 * a.max(b);
            faces.push(face(origin, unit(i), unit(j), extent, &[polygon(&corners)]));
        }
    }
    faces
}

/// Disc of a radius about the z axis at height `z`, its border cut into arcs at the angles given (one: closed).
pub fn disc(radius: f64, z: f64, cuts: &[f64]) -> NurbsPatch {
    let border = ring(radius, cuts);
    face(
        [0.0, 0.0, z],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        1.3 * radius,
        &[border],
    )
}

/// Circle about the origin, cut into arcs at the angles given.
pub fn ring(radius: f64, cuts: &[f64]) -> Vec<NurbsCurve<2>> {
    let end = |k: usize| match cuts.get(k + 1) {
        Some(angle) => *angle,
        None => cuts[0] + std::f64::consts::TAU,
    };
    (0..cuts.len())
        .map(|k| arc([0.0; 2], radius, cuts[k], end(k)))
        .collect()
}

/// Exact signed distance of a box about the origin, negative inside.
pub fn box_distance(half: [f64; 3], q: &Vec3) -> f64 {
    let d = [0, 1, 2].map(|k| q[k].abs() - half[k]);
    let outside = Vec3::from(d.map(|x| x.max(0.0))).norm();
    let inside = d.into_iter().fold(f64::NEG_INFINITY, f64::max);
    if inside > 0.0 { outside } else { inside }
}

/// Exact signed distance of a closed cylinder about the z axis, negative inside.
pub fn cylinder_distance(radius: f64, half: f64, q: &Vec3) -> f64 {
    let d = [q.x.hypot(q.y) - radius, q.z.abs() - half];
    let outside = d[0].max(0.0).hypot(d[1].max(0.0));
    let inside = d[0].max(d[1]);
    if inside > 0.0 { outside } else { inside }
}
