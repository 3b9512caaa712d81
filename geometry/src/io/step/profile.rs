//! Curves that are moved or turned to surfaces: their ranges and NURBS forms, and where points lie on what they sweep.

use super::curve::{Course, Kind, Run};
use super::place::Frame;
use crate::curve::conic::arc_knots;
use crate::io::brep::ParameterMap;
use crate::{NurbsCurve, Vec3};
use nalgebra::{Matrix2, Matrix3, Vector2};

/// From angles in the file's unit to the parameter of arcs whose knots are the angles in radians.
pub fn angles(range: [f64; 2], unit: f64) -> ParameterMap {
    let map = ParameterMap::arcs(&arc_knots(range[0], range[1]));
    if unit == 1.0 {
        map
    } else {
        map.with_file_range(range.map(|t| t / unit), false)
    }
}

/// Point and direction of a course that is a line without ends.
pub fn line(course: &Course<3>) -> Option<(Vec3, Vec3)> {
    match course {
        Course::Whole(kind, _) => match **kind {
            Kind::Line { origin, along } => Some((origin, along)),
            _ => None,
        },
        Course::Runs(_) => None,
    }
}

/// A course that is a parabola or hyperbola without ends.
pub fn conic(course: &Course<3>) -> Option<&Kind<3>> {
    match course {
        Course::Whole(kind, _) => match **kind {
            Kind::Parabola { .. } | Kind::Hyperbola { .. } => Some(kind),
            _ => None,
        },
        Course::Runs(_) => None,
    }
}

/// The parameter of such a conic, turned about the third axis of `frame`, at the height of `x`: of two, the one whose
/// distance from the axis is nearer to that of `x`.
pub fn conic_parameter(course: &Course<3>, frame: &Frame, x: &Vec3) -> Result<f64, String> {
    let axis = frame.axes[2];
    let kind = conic(course).ok_or("turns a curve without ends, which is read for conics only")?;
    let height = |y: &Vec3| axis.dot(&(y - frame.origin));
    let distance = |y: &Vec3| (y - frame.origin).cross(&axis).norm();
    let z = height(x);
    let candidates = match kind {
        Kind::Parabola { center, e1, e2 } => {
            roots(e2.dot(&axis), e1.dot(&axis), height(center) - z)
        }
        Kind::Hyperbola { center, e1, e2 } => {
            // Of y = exp t.
            let (a, b) = (e1.dot(&axis), e2.dot(&axis));
            let found = roots(0.5 * (a + b), height(center) - z, 0.5 * (a - b));
            found.map(|y| y.filter(|&y| y > 0.0).map(f64::ln))
        }
        _ => [None; 2],
    };
    let off = |t: &f64| (distance(&kind.point(*t)) - distance(x)).abs();
    let found = candidates.into_iter().flatten();
    let nearest = found.min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.ok_or_else(|| "turns a conic that no point of a boundary lies on".to_owned())
}

/// Real roots of `a t^2 + b t + c`; the extremum where there are none.
fn roots(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    let finite = |t: f64| t.is_finite().then_some(t);
    if a.abs() <= 1e-14 * (b.abs() + c.abs()) {
        return [finite(-c / b), None];
    }
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
    // No difference of like numbers.
    let q = -0.5 * (b + root.copysign(b));
    match q == 0.0 {
        true => [Some(0.0), None],
        false => [finite(q / a), finite(c / q)],
    }
}

/// The parameter at which such a conic has its vertex on the axis, if it has.
pub fn conic_on_axis(course: &Course<3>, frame: &Frame) -> Option<f64> {
    let axis = frame.axes[2];
    let kind = conic(course)?;
    let off = |y: Vec3| (y - frame.origin).cross(&axis).norm();
    let size = match kind {
        Kind::Parabola { e1, e2, .. } | Kind::Hyperbola { e1, e2, .. } => e1.norm() + e2.norm(),
        _ => return None,
    };
    (off(kind.point(0.0)) <= 1e-9 * size).then_some(0.0)
}

/// The parameters of a profile as a whole.
pub fn profile_range(course: &Course<3>) -> Option<[f64; 2]> {
    match course {
        Course::Whole(kind, _) => kind.range(),
        // One part keeps the parameter of its basis, several have lengths of parameters one after the other.
        Course::Runs(runs) => match &runs[..] {
            [run] if run.from < run.to => Some([run.from, run.to]),
            runs => {
                let length = |r: &Run<3>| (r.to - r.from).abs();
                Some([0.0, runs.iter().map(length).sum()])
            }
        },
    }
}

/// A profile as one curve, with the map from the file's parameter.
pub fn profile(
    course: &Course<3>,
    range: [f64; 2],
    unit: f64,
) -> Result<(NurbsCurve<3>, ParameterMap), String> {
    let runs = match course {
        Course::Whole(kind, entity) => vec![Run {
            kind: kind.clone(),
            from: range[0],
            to: range[1],
            entity: *entity,
        }],
        Course::Runs(runs) => match &runs[..] {
            [run] if run.from < run.to => vec![Run {
                from: range[0].max(run.from),
                to: range[1].min(run.to),
                ..run.clone()
            }],
            runs => runs.to_vec(),
        },
    };
    let mut curves = Vec::with_capacity(runs.len());
    let mut maps = Vec::with_capacity(runs.len());
    for run in &runs {
        let curve = run.curve().map_err(|e| e.to_string())?;
        let domain = curve.domain();
        maps.push(match *run.kind {
            Kind::Ellipse { .. } => angles(domain, unit),
            _ => ParameterMap::identity(domain),
        });
        curves.push(curve);
    }
    if let ([_], [map]) = (&curves[..], &maps[..]) {
        let curve = curves[0].refined(0, &[]).map_err(|e| e.to_string())?;
        return Ok((curve, map.clone()));
    }
    let (curve, _) = NurbsCurve::joined(&curves).map_err(|e| e.to_string())?;
    let own = curve.domain();
    let map = ParameterMap::chain(&maps, 0.0, own[0]);
    Ok((curve, map.unwrap_or_else(|| ParameterMap::identity(own))))
}

/// The parameters of a point on an extrusion.
pub fn extrusion_parameters(
    course: &Course<3>,
    along: Vec3,
    x: &Vec3,
) -> Result<[[f64; 2]; 2], String> {
    let flat = "moves a curve along itself";
    let kind = match course {
        Course::Whole(kind, _) => Some(&**kind),
        Course::Runs(_) => None,
    };
    match kind {
        Some(Kind::Line {
            origin,
            along: first,
        }) => {
            let d = x - origin;
            let gram = Matrix2::new(
                first.norm_squared(),
                first.dot(&along),
                first.dot(&along),
                along.norm_squared(),
            );
            let inverse = gram.try_inverse().filter(|_| {
                gram.determinant() > 1e-18 * first.norm_squared() * along.norm_squared()
            });
            let inverse = inverse.ok_or(flat)?;
            let at = inverse * Vector2::new(d.dot(first), d.dot(&along));
            Ok([[at.x, at.x], [at.y, at.y]])
        }
        Some(Kind::Parabola { center, e1, e2 } | Kind::Hyperbola { center, e1, e2 }) => {
            let inverse = Matrix3::from_columns(&[*e1, *e2, along])
                .try_inverse()
                .ok_or(flat)?;
            let at = inverse * (x - center);
            let u = match kind {
                Some(Kind::Hyperbola { .. }) => at.y.asinh(),
                _ => at.x,
            };
            Ok([[u, u], [at.z, at.z]])
        }
        _ => {
            // Which point of the profile it is above is left open: all of its control points are looked at.
            let runs = course.runs()?;
            let height = |x: Vec3| x.dot(&along) / along.norm_squared();
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for run in runs {
                let curve = run.curve().map_err(|e| e.to_string())?;
                for p in curve.homogeneous() {
                    let at = height(Vec3::new(p[0], p[1], p[2]) / p[3]);
                    low = low.min(at);
                    high = high.max(at);
                }
            }
            let at = height(*x);
            Ok([[0.0, 0.0], [at - high, at - low]])
        }
    }
}
