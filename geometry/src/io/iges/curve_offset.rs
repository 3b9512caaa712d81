//! Offset curves (130).

use super::curve::{CurvePart, Reader, Shape, Stop};
use super::directory::Entry;
use super::transform::Affine;
use crate::Vec3;
use crate::curve::CurveJet;
use crate::curve::fit::fit;

/// Largest deviation of the fitted curve, as a share of the base curve's size.
const TOLERANCE: f64 = 1e-9;

/// A 130 of constant distance (FLAG = 1): O(t) = C(t) + D1 V x T with the unit tangent T of the base curve and the normal V
/// of its plane, t from TT1 to TT2 of the base curve's parameter. Fitted by a spline with the base curve's NURBS
/// parameter, as it is rational only for lines and circles.
pub fn read(reader: &mut Reader, entry: &Entry, map: &Affine) -> Result<Vec<CurvePart>, Stop> {
    let params = reader.model.params(entry)?;
    let kind = params.integer(2, "the flag FLAG of an offset curve (130)")?;
    if kind != 1 {
        let reason = "an offset curve whose distance varies, which is not read";
        return Err(Stop::Reason(reason.to_owned()));
    }
    let base = reader.pointer(&params, 1, "the base of an offset curve (130)")?;
    let distance = params.real(6, "the distance D1")?;
    let v = params.reals(10, 5, "the normal VX, VY, VZ or a limit TT1, TT2")?;
    let normal = Vec3::new(v[0], v[1], v[2]);
    if normal.norm() <= 0.0 || !normal.norm().is_finite() {
        return Err(Stop::Reason(
            "the normal of an offset curve is zero".to_owned(),
        ));
    }
    let normal = normal.normalize();
    let parts = reader.base(base)?;
    let [part] = &parts[..] else {
        let reason = "an offset of a curve of several pieces, which is not read";
        return Err(Stop::Reason(reason.to_owned()));
    };
    let [a, b] = part.map.file_range();
    let (mut from, mut to) = (v[3], v[4]);
    if from >= to {
        reader.note(
            entry,
            "the limits TT1, TT2 are empty; all of the base curve was used",
        );
        (from, to) = (a, b);
    }
    let turns = part.map.turns([from, to]);
    let slack = 1e-8 * (b - a);
    let (from, to) = (from + turns, to + turns);
    if from < a - slack || to > b + slack {
        reader.note(
            entry,
            "the limits TT1, TT2 exceed the base curve, where the offset ends",
        );
    }
    let file = [from.max(a), to.min(b)];
    if file[0] >= file[1] {
        let reason = "the limits TT1, TT2 lie outside of the base curve";
        return Err(Stop::Reason(reason.to_owned()));
    }
    let own = file.map(|t| part.map.to_own(t));
    let curve = if own == part.curve.domain() {
        part.curve.clone()
    } else {
        part.curve.with_domain(own)?
    };
    let ends = curve.ends();
    let size = curve
        .homogeneous()
        .iter()
        .map(|h| (Vec3::new(h[0], h[1], h[2]) / h[3] - ends[0]).norm())
        .fold(distance.abs(), f64::max);
    let spans = curve.basis().span_count();
    let mut breaks: Vec<f64> = (0..spans).map(|k| curve.basis().span_range(k)[0]).collect();
    breaks.push(own[1]);
    let f = |span: usize, t: f64| {
        let jet = curve.jet_in_span(span, t);
        let speed = jet.d1.norm();
        let tangent = jet.d1 / speed;
        let turn = (jet.d2 - tangent * tangent.dot(&jet.d2)) / speed;
        // The second derivative of the offset needs the third of the curve: by differences, as only the spline's own
        // second derivative at knots depends on it, whose error the fit measures.
        let h = 1e-5 * (breaks[span + 1] - breaks[span]);
        let turn_at = |t: f64| {
            let jet = curve.jet_in_span(span, t);
            let speed = jet.d1.norm();
            let tangent = jet.d1 / speed;
            (jet.d2 - tangent * tangent.dot(&jet.d2)) / speed
        };
        let bend = (turn_at(t + h) - turn_at(t - h)) / (2.0 * h);
        CurveJet {
            point: jet.point + normal.cross(&tangent) * distance,
            d1: jet.d1 + normal.cross(&turn) * distance,
            d2: jet.d2 + normal.cross(&bend) * distance,
        }
    };
    let (fitted, deviation) = fit(&f, &breaks, TOLERANCE * size).map_err(|e| e.to_string())?;
    reader.note(
        entry,
        &format!("an offset curve, fitted within {deviation:.1e} of the file's unit"),
    );
    let shape = Shape {
        curve: fitted,
        map: part.map.restricted(file),
        deviation,
    };
    Ok(vec![reader.placed(entry, shape, map)?])
}
