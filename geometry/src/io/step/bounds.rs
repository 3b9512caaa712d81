//! What bounds a face: loops of edges, of points, of one vertex, and the boundary curves of a bounded surface.

use super::curve::{Course, Kind, Run, backwards, between};
use super::curve_read::{self, number, polyline, segment_of};
use super::entity::{Entity, Told};
use super::place::{point, points};
use super::scope::Scope;
use super::surface::Surface;
use crate::Vec3;
use crate::io::brep::{Boundary, Part, Preference, Stretch, reversed};
use std::f64::consts::TAU;
use std::rc::Rc;

/// Vertices this near to the end of a curve, as a share of its size, are its end.
const END: f64 = 1e-6;
/// Parameters of an edge may leave the curve in the parameter plane by this share of it.
const SLACK: f64 = 1e-6;
/// Lines whose angle changes less than this, for each unit of height, run along a generatrix.
const UPRIGHT: f64 = 1e-9;

/// The surface that carries a face: its index and what was read of it.
pub type Base<'s> = (u32, &'s Surface);

/// A loop of a face.
pub enum Bound {
    Curves(Boundary),
    /// A vertex alone, where a surface closes in one point. It bounds nothing.
    Vertex(Vec3),
}

/// Reads a FACE_BOUND. `base` is the surface of the face, `turned` says that its loops run with the face on their right.
pub fn bound(scope: &Scope, index: u32, base: Option<Base>, turned: bool) -> Told<Bound> {
    let bound = scope.entity(index, 0)?;
    let ahead = bound.flag("FACE_BOUND", 1, "the orientation of a bound")?;
    let a_loop = bound.reference("FACE_BOUND", 0, "the loop of a bound")?;
    let a_loop = scope.entity(a_loop, 0)?;
    let name = a_loop.describe();
    let stretches = if a_loop.is("VERTEX_LOOP") {
        let vertex = a_loop.reference("VERTEX_LOOP", 0, "the vertex of a loop")?;
        return Ok(Bound::Vertex(vertex_point(scope, vertex)?));
    } else if a_loop.is("POLY_LOOP") {
        let list = a_loop.targets("POLY_LOOP", 0, "a point of a loop")?;
        scope.budget.take(list.len())?;
        let mut corners = points::<3>(scope.exchange, &list)?;
        corners.extend(corners.first().copied());
        let lines = polyline(&corners, 0).ok_or_else(|| format!("{name} has no length"))?;
        vec![Stretch {
            space: parts(&lines.runs()?)?,
            ..Stretch::default()
        }]
    } else if a_loop.is("EDGE_LOOP") {
        let list = a_loop.targets("PATH", 0, "an edge of a loop")?;
        let edges = list.into_iter().map(|edge| oriented(scope, edge, base));
        let edges = edges.collect::<Told<Vec<_>>>()?;
        edges.into_iter().flatten().collect()
    } else {
        return Err(format!("{name} is a loop of a type that is not read"));
    };
    if stretches.is_empty() {
        return Err(format!("{name} has no edges"));
    }
    let stretches = match ahead != turned {
        true => stretches,
        false => opposite(stretches)?,
    };
    Ok(Bound::Curves(Boundary { name, stretches }))
}

/// The corners of a POLY_LOOP under a FACE_BOUND, for faces that name no surface.
pub fn corners(scope: &Scope, index: u32) -> Told<Vec<Vec3>> {
    let bound = scope.entity(index, 0)?;
    let a_loop = bound.reference("FACE_BOUND", 0, "the loop of a bound")?;
    let a_loop = scope.entity(a_loop, 0)?;
    let list = a_loop.targets("POLY_LOOP", 0, "a point of a loop")?;
    scope.budget.take(list.len())?;
    let corners = points(scope.exchange, &list)?;
    match bound.flag("FACE_BOUND", 1, "the orientation of a bound")? {
        true => Ok(corners),
        false => Ok(corners.into_iter().rev().collect()),
    }
}

fn vertex_point(scope: &Scope, index: u32) -> Told<Vec3> {
    let vertex = scope.entity(index, 0)?;
    let at = vertex.reference("VERTEX_POINT", 0, "the point of a vertex")?;
    point(scope.exchange, at)
}

/// An ORIENTED_EDGE in its own direction; `None` for a straight edge between a vertex and itself, as it is written at the tip of
/// a cone: it is that point.
fn oriented(scope: &Scope, index: u32, base: Option<Base>) -> Told<Option<Stretch>> {
    let mut use_of = scope.entity(index, 0)?;
    let (mut ahead, mut depth) = (true, 0);
    while use_of.is("ORIENTED_EDGE") {
        ahead ^= !use_of.flag("ORIENTED_EDGE", 1, "the orientation of an edge")?;
        depth += 1;
        use_of = scope.entity(use_of.reference("ORIENTED_EDGE", 0, "an edge")?, depth)?;
    }
    let edge = use_of;
    let told = |e: String| format!("{}: {e}", edge.describe());
    if !edge.is("EDGE_CURVE") {
        return Err(format!(
            "{} is an edge of a type that is not read",
            edge.describe()
        ));
    }
    let vertices = [
        edge.reference("EDGE", 0, "the first vertex of an edge")?,
        edge.reference("EDGE", 1, "the second vertex of an edge")?,
    ];
    let ends = [
        vertex_point(scope, vertices[0])?,
        vertex_point(scope, vertices[1])?,
    ];
    let closed = vertices[0] == vertices[1] || ends[0] == ends[1];
    let forward = edge.flag("EDGE_CURVE", 1, "the sense of an edge")?;
    let geometry = edge.reference("EDGE_CURVE", 0, "the curve of an edge")?;
    let curve = scope.entity(geometry, 0)?;
    let number = number(scope, edge.index);
    if curve.is("PCURVE") {
        let parameter = parameter_parts(scope, geometry, base, None, forward).map_err(told)?;
        let stretch = Stretch {
            parameter,
            edge: number,
            ..Stretch::default()
        };
        let stretch = if ahead { stretch } else { turned(stretch)? };
        return Ok(Some(stretch));
    }
    if closed && curve.is("LINE") {
        return Ok(None);
    }
    let course = curve_read::read::<3>(scope, geometry)?;
    let near = scope.near.max(END * extent(&course, &ends));
    let runs = between(&course, ends, closed, forward, near).map_err(told)?;
    let mut stretch = Stretch {
        parameter: Vec::new(),
        space: parts(&runs).map_err(told)?,
        preference: Preference::Space,
        edge: number,
    };
    if curve.is("SURFACE_CURVE") {
        let found = pcurves(scope, &curve, base.map(|b| b.0))?;
        // A seam has one for each side; where the loop has come to tells later which period is meant.
        let chosen = if ahead { found.first() } else { found.last() };
        if let Some(&pcurve) = chosen {
            // Of no use: the curve in space counts.
            let read = parameter_parts(scope, pcurve, base, Some(&runs), forward);
            stretch.parameter = read.unwrap_or_default();
        }
    }
    Ok(Some(if ahead { stretch } else { turned(stretch)? }))
}

/// The size of a curve, as far as ends and control points tell.
fn extent(course: &Course<3>, ends: &[Vec3; 2]) -> f64 {
    let chord = (ends[0] - ends[1]).norm();
    match course {
        Course::Whole(kind, _) => match &**kind {
            Kind::Ellipse { e1, e2, .. } => e1.norm().max(e2.norm()),
            Kind::Spline(curve) => {
                let at = |h: &[f64; 4]| Vec3::new(h[0], h[1], h[2]) / h[3];
                let points = curve.homogeneous().iter().map(at);
                points.fold(chord, |size, x| size.max((x - ends[0]).norm()))
            }
            _ => chord,
        },
        Course::Runs(runs) => {
            let points = runs.iter().flat_map(Run::ends);
            points.fold(chord, |size, x| size.max((x - ends[0]).norm()))
        }
    }
}

/// The curves in the parameter plane of `base` that a curve on surfaces has: two where it is a seam.
fn pcurves(scope: &Scope, curve: &Entity, base: Option<u32>) -> Told<Vec<u32>> {
    let mut found = Vec::new();
    for one in curve.targets("SURFACE_CURVE", 1, "a curve in a parameter plane")? {
        let pcurve = scope.entity(one, 0)?;
        // One on a surface that is not in the file is no curve of this face.
        let surface = pcurve.reference("PCURVE", 0, "the surface of a curve");
        if pcurve.is("PCURVE") && surface.is_ok_and(|surface| Some(surface) == base) {
            found.push(one);
        }
    }
    Ok(found)
}

/// Runs of a curve in space with their NURBS forms.
fn parts(runs: &[Run<3>]) -> Told<Vec<Part<3>>> {
    let parts = runs.iter().map(|run| {
        Ok(Part {
            entity: run.entity,
            curve: run.curve().map_err(|e| e.to_string())?,
        })
    });
    parts.collect()
}

/// The curve of a PCURVE as far as an edge takes it: by the parameters of the edge on its curve in space, which both curves
/// share, or as a whole where it has ends and those do not fit.
fn parameter_parts(
    scope: &Scope,
    index: u32,
    base: Option<Base>,
    space: Option<&[Run<3>]>,
    forward: bool,
) -> Told<Vec<Part<2>>> {
    let pcurve = scope.entity(index, 0)?;
    let plane = pcurve.reference("PCURVE", 1, "a curve in a parameter plane")?;
    let plane = scope.entity(plane, 0)?;
    let items = plane.targets("REPRESENTATION", 1, "a curve in a parameter plane")?;
    let [curve] = items[..] else {
        let expected = "one curve in a parameter plane";
        let at = scope.exchange.at(plane.index);
        let found = format!("{} of them", items.len());
        return Err(scope.exchange.told(at, expected, &found));
    };
    let course = curve_read::read::<2>(scope, curve)?;
    let runs = match (&course, space) {
        (Course::Whole(kind, entity), Some(space)) => {
            let heights = |run: &Run<3>| {
                let height = |x: Vec3| base.and_then(|(_, surface)| surface.height(&x));
                let [a, b] = run.ends().map(height);
                Some([a?, b?])
            };
            let fitting = (space.iter()).map(|run| {
                along_generatrix(kind, *entity, heights(run))
                    .or_else(|| shared(scope, kind, *entity, run))
            });
            match fitting.collect::<Option<Vec<_>>>() {
                Some(runs) => runs,
                None => as_a_whole(&course, forward)?,
            }
        }
        _ => as_a_whole(&course, forward)?,
    };
    let parts = runs.iter().map(|run| {
        Ok(Part {
            entity: run.entity,
            curve: run.curve().map_err(|e| e.to_string())?,
        })
    });
    parts.collect()
}

fn as_a_whole(course: &Course<2>, forward: bool) -> Told<Vec<Run<2>>> {
    let runs = course.runs()?;
    Ok(if forward { runs } else { backwards(&runs) })
}

/// The part between two heights of a line that runs along the straight generatrices of a cylinder or cone. Writers measure its
/// parameter along the generatrix or along the axis; the heights of its ends do not depend on that.
fn along_generatrix(kind: &Rc<Kind<2>>, entity: u32, heights: Option<[f64; 2]>) -> Option<Run<2>> {
    let Kind::Line { origin, along } = **kind else {
        return None;
    };
    if along.x.abs() > UPRIGHT * along.y.abs() {
        return None;
    }
    let [from, to] = heights?.map(|v| (v - origin.y) / along.y);
    (from != to && from.is_finite() && to.is_finite()).then(|| Run {
        kind: Rc::clone(kind),
        from,
        to,
        entity,
    })
}

/// The part of a curve in the parameter plane that has the same parameters as a part of a curve in space.
fn shared(scope: &Scope, kind: &Rc<Kind<2>>, entity: u32, space: &Run<3>) -> Option<Run<2>> {
    // In the file's unit.
    let round = matches!(*space.kind, Kind::Ellipse { .. });
    let unit = if round { scope.angle } else { 1.0 };
    let [mut from, mut to] = [space.from, space.to].map(|t| t / unit);
    match **kind {
        Kind::Ellipse { .. } => {
            from *= scope.angle;
            to *= scope.angle;
        }
        Kind::Spline(ref curve) => {
            let [a, b] = curve.domain();
            if round {
                let turn = TAU / scope.angle;
                let turns = ((a + b - from - to) * 0.5 / turn).round() * turn;
                from += turns;
                to += turns;
            }
            let slack = SLACK * (b - a);
            let fits = |t: f64| t >= a - slack && t <= b + slack;
            if !(fits(from) && fits(to)) {
                return None;
            }
            from = from.clamp(a, b);
            to = to.clamp(a, b);
        }
        _ => {}
    }
    (from != to).then(|| Run {
        kind: Rc::clone(kind),
        from,
        to,
        entity,
    })
}

/// A stretch run through backwards.
fn turned(stretch: Stretch) -> Told<Stretch> {
    Ok(Stretch {
        parameter: reversed(stretch.parameter).map_err(|e| e.to_string())?,
        space: reversed(stretch.space).map_err(|e| e.to_string())?,
        ..stretch
    })
}

/// A loop run through backwards.
fn opposite(stretches: Vec<Stretch>) -> Told<Vec<Stretch>> {
    stretches.into_iter().rev().map(turned).collect()
}

/// Reads a BOUNDARY_CURVE of a CURVE_BOUNDED_SURFACE on the surface `base`.
pub fn boundary(scope: &Scope, index: u32, base: Base) -> Told<Boundary> {
    let boundary = scope.entity(index, 0)?;
    let name = boundary.describe();
    let mut stretches = Vec::new();
    if !boundary.is("COMPOSITE_CURVE") {
        stretches.push(member(scope, index, base)?);
    } else {
        for segment in boundary.targets("COMPOSITE_CURVE", 0, "a segment of a boundary")? {
            let (curve, ahead) = segment_of(scope, segment, 0)?;
            let stretch = member(scope, curve, base)?;
            stretches.push(if ahead { stretch } else { turned(stretch)? });
        }
    }
    match stretches.is_empty() {
        true => Err(format!("{name} has no segments")),
        false => Ok(Boundary { name, stretches }),
    }
}

/// A curve of a boundary in its own direction, between its own ends.
fn member(scope: &Scope, index: u32, base: Base) -> Told<Stretch> {
    let curve = scope.entity(index, 0)?;
    let edge = number(scope, index);
    if curve.is("PCURVE") {
        return Ok(Stretch {
            parameter: parameter_parts(scope, index, Some(base), None, true)?,
            edge,
            ..Stretch::default()
        });
    }
    let course = curve_read::read::<3>(scope, index)?;
    let told = |e: String| format!("{}: {e}", curve.describe());
    let surface_curve = curve.is("SURFACE_CURVE");
    let found = match surface_curve {
        true => pcurves(scope, &curve, Some(base.0))?,
        false => Vec::new(),
    };
    let runs = course.runs();
    let parameter = match found.first() {
        Some(&pcurve) => {
            let space = runs.as_ref().ok().map(Vec::as_slice);
            parameter_parts(scope, pcurve, Some(base), space, true).unwrap_or_default()
        }
        None => Vec::new(),
    };
    let space = match runs {
        Ok(runs) => parts(&runs).map_err(told)?,
        // A line without ends of its own, which the curve in the parameter plane has.
        Err(_) if !parameter.is_empty() => Vec::new(),
        Err(e) => return Err(told(e)),
    };
    Ok(Stretch {
        parameter,
        space,
        preference: Preference::Space,
        edge,
    })
}
