//! Curves that are moved or turned to surfaces: their ranges and NURBS forms, and where points lie on what they sweep.

use super::curve::{Course, Kind, Run};
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
