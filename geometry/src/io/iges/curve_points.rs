//! Curves of straight pieces: line (110) and copious data (106).

use super::super::error::Fail;
use super::curve::{Reader, Shape, Stop};
use super::directory::Entry;
use super::params::Params;
use crate::{NurbsCurve, Vec3};

/// A 110: both end points, parameter 0 to 1.
pub fn line(entry: &Entry, params: &Params) -> Result<Vec<Shape>, Stop> {
    match entry.form {
        0 => {}
        1 => return Err(Stop::Reason("a half line without an end".to_owned())),
        2 => return Err(Stop::Reason("a line without ends".to_owned())),
        other => return Err(Stop::Reason(format!("a line of the unknown form {other}"))),
    }
    let x = params.reals(1, 6, "a coordinate of an end point")?;
    let ends = [Vec3::new(x[0], x[1], x[2]), Vec3::new(x[3], x[4], x[5])];
    Ok(vec![Shape::exact(NurbsCurve::line(ends[0], ends[1])?)])
}

/// A 106 of points: forms 1 to 3, as a polyline in their order, 11 to 13 (linear path) and 63 (closed planar curve). The
/// parameter is 0 at the first point and grows by 1 from point to point.
pub fn polyline(reader: &mut Reader, entry: &Entry, params: &Params) -> Result<Vec<Shape>, Stop> {
    if !matches!(entry.form, 1..=3 | 11..=13 | 63) {
        let reason = format!("copious data of form {} is no curve", entry.form);
        return Err(Stop::Reason(reason));
    }
    let mut points = points(params)?;
    if entry.form == 63
        && let (Some(&first), Some(&last)) = (points.first(), points.last())
        && first != last
    {
        points.push(first);
        reader.note(
            entry,
            "a closed curve that its points leave open was closed",
        );
    }
    let mut knots = Vec::with_capacity(points.len() + 2);
    let mut kept: Vec<Vec3> = Vec::with_capacity(points.len());
    for (k, x) in points.iter().enumerate() {
        // A point given twice has no segment behind it.
        if kept.last() != Some(x) {
            kept.push(*x);
            knots.push(k as f64);
        }
    }
    if kept.len() < 2 {
        let reason = "copious data without two different points".to_owned();
        return Err(Stop::Reason(reason));
    }
    if kept.len() < points.len() {
        let text = format!("{} points repeated in a row", points.len() - kept.len());
        reader.note(entry, &text);
    }
    knots.insert(0, knots[0]);
    knots.push(knots[knots.len() - 1]);
    Ok(vec![Shape::exact(NurbsCurve::new(1, knots, &kept, None)?)])
}

fn points(params: &Params) -> Result<Vec<Vec3>, Fail> {
    let kind = params.integer(1, "the kind IP of copious data")?;
    let count = params.count(2, "the number N of points")?;
    // A common z in front of pairs; triples; triples with a vector each.
    let (first, size) = match kind {
        1 => (4, 2),
        2 => (3, 3),
        3 => (3, 6),
        _ => return Err(params.fail(1, "1, 2 or 3 for the kind IP of copious data")),
    };
    let z = if kind == 1 {
        params.real(3, "the common z")?
    } else {
        0.0
    };
    let numbers = count.saturating_mul(size);
    let values = params.reals(first, numbers, "a coordinate of copious data")?;
    let point = |c: &[f64]| Vec3::new(c[0], c[1], if kind == 1 { z } else { c[2] });
    Ok(values.chunks_exact(size).map(point).collect())
}
