//! Curve entities (ISO 10303-42, geometric model schema).

use super::curve::{Course, Kind, Run, backwards};
use super::entity::{Entity, Told};
use super::place::{frame, plane_frame, point, points, vector};
use super::scan::{Item, Value};
use super::scope::Scope;
use super::spline::spline_curve;
use nalgebra::SVector;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Reads a curve of space (`D` = 3) or of a parameter plane (2). A curve on a surface is its curve in space.
pub fn read<const D: usize>(scope: &Scope, index: u32) -> Told<Course<D>> {
    nested(scope, index, 0)
}

fn nested<const D: usize>(scope: &Scope, index: u32, depth: usize) -> Told<Course<D>> {
    let entity = scope.entity(index, depth)?;
    let number = number(scope, index);
    let whole = |kind| Ok(Course::Whole(Rc::new(kind), number));
    if entity.is("LINE") {
        let origin = entity.reference("LINE", 0, "a point of a line")?;
        let along = entity.reference("LINE", 1, "the direction of a line")?;
        return whole(Kind::Line {
            origin: point(scope.exchange, origin)?,
            along: vector(scope.exchange, along)?,
        });
    }
    if entity.is("CONIC") {
        return whole(conic(scope, &entity)?);
    }
    if entity.is("B_SPLINE_CURVE") {
        let mut kinds = spline_curve(scope, &entity)?;
        if kinds.len() == 1 {
            return whole(kinds.remove(0));
        }
        return Ok(Course::Runs(
            kinds.into_iter().map(|k| run(k, number)).collect(),
        ));
    }
    if entity.is("POLYLINE") {
        let list = entity.targets("POLYLINE", 0, "a point of a polyline")?;
        scope.budget.take(list.len())?;
        return polyline(&points(scope.exchange, &list)?, number)
            .ok_or_else(|| format!("{} has no length", entity.describe()));
    }
    if entity.is("TRIMMED_CURVE") {
        return trimmed(scope, &entity, depth);
    }
    if entity.is("COMPOSITE_CURVE") {
        let mut runs = Vec::new();
        for segment in entity.targets("COMPOSITE_CURVE", 0, "a segment of a composite curve")? {
            let (curve, forward) = segment_of(scope, segment, depth)?;
            let found = nested::<D>(scope, curve, depth + 1)?;
            let own = found
                .runs()
                .map_err(|e| format!("{}: {e}", entity.describe()))?;
            scope.budget.take(own.len())?;
            runs.extend(if forward { own } else { backwards(&own) });
        }
        if runs.is_empty() {
            return Err(format!("{} has no segments", entity.describe()));
        }
        return Ok(Course::Runs(runs));
    }
    if entity.is("SURFACE_CURVE") {
        let curve = entity.reference("SURFACE_CURVE", 0, "a curve in space")?;
        return nested(scope, curve, depth + 1);
    }
    Err(format!(
        "{} is a curve of a type that is not read",
        entity.describe()
    ))
}

/// The curve of a COMPOSITE_CURVE_SEGMENT, and whether it runs along it.
pub fn segment_of(scope: &Scope, index: u32, depth: usize) -> Told<(u32, bool)> {
    let segment = scope.entity(index, depth)?;
    let kind = "COMPOSITE_CURVE_SEGMENT";
    let forward = segment.flag(kind, 1, "the sense of a segment")?;
    Ok((
        segment.reference(kind, 2, "the curve of a segment")?,
        forward,
    ))
}

/// The number of an instance in reports and on edges.
pub fn number(scope: &Scope, index: u32) -> u32 {
    super::number_of(scope.exchange, index)
}

fn run<const D: usize>(kind: Kind<D>, entity: u32) -> Run<D> {
    let [from, to] = kind.range().unwrap_or([0.0, 1.0]);
    Run {
        kind: Rc::new(kind),
        from,
        to,
        entity,
    }
}

/// Straight lines between points; points that coincide are passed over.
pub fn polyline<const D: usize>(points: &[SVector<f64, D>], entity: u32) -> Option<Course<D>> {
    let mut runs: Vec<Run<D>> = Vec::new();
    for pair in points.windows(2) {
        let along = pair[1] - pair[0];
        if along.norm() > 0.0 {
            let origin = pair[0];
            let mut line = run(Kind::Line { origin, along }, entity);
            // The parameter of a polyline grows by one from point to point; nothing refers to it.
            (line.from, line.to) = (0.0, 1.0);
            runs.push(line);
        }
    }
    (!runs.is_empty()).then_some(Course::Runs(runs))
}

fn conic<const D: usize>(scope: &Scope, entity: &Entity) -> Told<Kind<D>> {
    let position = entity.reference("CONIC", 0, "the position of a conic")?;
    let place = scope.entity(position, 0)?;
    // In the plane the third coordinates are not there.
    let [center, x, y] = if D == 3 && place.is("AXIS2_PLACEMENT_3D") {
        let frame = frame(scope.exchange, position)?;
        [frame.origin, frame.axes[0], frame.axes[1]].map(|v| SVector::from_fn(|i, _| v[i]))
    } else if D == 2 && place.is("AXIS2_PLACEMENT_2D") {
        let (origin, [x, y]) = plane_frame(scope.exchange, position)?;
        [origin, x, y].map(|v| SVector::from_fn(|i, _| v[i]))
    } else {
        return Err(format!(
            "{} lies at {}",
            entity.describe(),
            place.describe()
        ));
    };
    let length = |kind: &str, k: usize| {
        let value = entity.real(kind, k, "a radius, half axis or focal distance")?;
        match value > 0.0 && value.is_finite() {
            true => Ok(value),
            false => {
                let item = entity.attribute(kind, k, "a length")?;
                Err(entity.wrong(item, "a length above zero"))
            }
        }
    };
    if entity.is("CIRCLE") {
        let r = length("CIRCLE", 0)?;
        let (e1, e2) = (x * r, y * r);
        return Ok(Kind::Ellipse { center, e1, e2 });
    }
    if entity.is("ELLIPSE") {
        let (e1, e2) = (x * length("ELLIPSE", 0)?, y * length("ELLIPSE", 1)?);
        return Ok(Kind::Ellipse { center, e1, e2 });
    }
    if entity.is("HYPERBOLA") {
        let (e1, e2) = (x * length("HYPERBOLA", 0)?, y * length("HYPERBOLA", 1)?);
        return Ok(Kind::Hyperbola { center, e1, e2 });
    }
    if entity.is("PARABOLA") {
        let f = length("PARABOLA", 0)?;
        let (e1, e2) = (y * (2.0 * f), x * f);
        return Ok(Kind::Parabola { center, e1, e2 });
    }
    Err(format!(
        "{} is a conic of a type that is not read",
        entity.describe()
    ))
}

/// A TRIMMED_CURVE: basis curve, two ends, each a point, a parameter or both, sense, and which of both is preferred.
fn trimmed<const D: usize>(scope: &Scope, entity: &Entity, depth: usize) -> Told<Course<D>> {
    let kind = "TRIMMED_CURVE";
    let basis = entity.reference(kind, 0, "the basis of a trimmed curve")?;
    let forward = entity.flag(kind, 3, "the sense of a trimmed curve")?;
    let course = nested::<D>(scope, basis, depth + 1)?;
    let (basis, number) = match &course {
        Course::Whole(kind, number) => (Rc::clone(kind), *number),
        Course::Runs(_) => {
            let text = "trims a curve of several parts, which is not read";
            return Err(format!("{} {text}", entity.describe()));
        }
    };
    let preferred = entity.attribute(kind, 4, "the preference of a trimmed curve")?;
    let points_first = matches!(preferred.value, Value::Enumeration(b"CARTESIAN"));
    let end = |k: usize| -> Told<f64> {
        let trim = entity.list(kind, k, "an end of a trimmed curve")?;
        let at = |item: &Item| -> Told<f64> {
            match item.value {
                Value::Reference(_) => {
                    let index = entity.target(item, "a point")?;
                    Ok(basis.parameter(&point::<D>(scope.exchange, index)?))
                }
                _ => {
                    let t = entity.number(item, "a parameter")?;
                    Ok(match *basis {
                        Kind::Ellipse { .. } => t * scope.angle,
                        _ => t,
                    })
                }
            }
        };
        let is_point = |item: &&Item| matches!(item.value, Value::Reference(_));
        let chosen = trim.iter().find(|item| is_point(item) == points_first);
        let chosen = chosen.or(trim.first());
        let Some(item) = chosen else {
            let item = entity.attribute(kind, k, "an end of a trimmed curve")?;
            return Err(entity.wrong(item, "a point or a parameter"));
        };
        let t = at(item)?;
        match t.is_finite() {
            true => Ok(t),
            false => Err(entity.wrong(item, "an end with a parameter on the curve")),
        }
    };
    let (mut from, mut to) = (end(1)?, end(2)?);
    match (&*basis, basis.range()) {
        (Kind::Ellipse { .. }, _) => {
            // Along the sense, less than a turn or all of it.
            let turn = if forward { to - from } else { from - to };
            let turn = turn.rem_euclid(TAU);
            let turn = if turn < 1e-12 { TAU } else { turn };
            to = if forward { from + turn } else { from - turn };
        }
        (_, Some([a, b])) => {
            from = from.clamp(a, b);
            to = to.clamp(a, b);
            let closed = (basis.point(a) - basis.point(b)).norm() <= scope.near;
            if (from < to) != forward && closed {
                return Ok(Course::Runs(over_seam(
                    &basis,
                    [from, to],
                    [a, b],
                    forward,
                    number,
                )));
            }
        }
        _ => {}
    }
    if from == to {
        return Err(format!("{} has no length", entity.describe()));
    }
    let kind = basis;
    let entity = number;
    Ok(Course::Runs(vec![Run {
        kind,
        from,
        to,
        entity,
    }]))
}

/// The parts of a closed spline from one parameter to another over its own start.
fn over_seam<const D: usize>(
    kind: &Rc<Kind<D>>,
    [from, to]: [f64; 2],
    [a, b]: [f64; 2],
    forward: bool,
    entity: u32,
) -> Vec<Run<D>> {
    let run = |from: f64, to: f64| Run {
        kind: Rc::clone(kind),
        from,
        to,
        entity,
    };
    let both = match forward {
        true => [run(from, b), run(a, to)],
        false => [run(from, a), run(b, to)],
    };
    both.into_iter().filter(|r| r.from != r.to).collect()
}
