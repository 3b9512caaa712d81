//! Surfaces of revolution (120).

use std::f64::consts::TAU;

use super::super::curve::Stop;
use super::super::curve_map::ParameterMap;
use super::super::reparametrise::Reparametrise;
use super::{BasePatch, BaseSurface, Found, SurfaceReader};
use crate::basis::Basis;
use crate::curve::conic::{arc_knots, elliptic_arc};
use crate::{NurbsCurve, NurbsPatch, Vec3};

/// A 120: the generatrix C(u) turned about the axis L by the angle v from SA to TA, positive by the right-hand rule about
/// the direction of L. xi1 is the generatrix's parameter, xi2 the angle, which is the patch's own at its knots only.
pub fn read(mut reader: SurfaceReader) -> Found {
    let what = "the axis of a surface of revolution (120)";
    let axis = reader.curve(1, what)?;
    let [foot, tip] = axis.curve.ends();
    let direction = tip - foot;
    let straight = axis.curve.degree() == 1 && axis.curve.homogeneous().len() == 2;
    if !straight || direction.norm() <= 0.0 {
        return Err(Stop::Reason(format!("{what} is no line with a direction")));
    }
    let what = "the generatrix of a surface of revolution (120)";
    let generatrix = reader.curve(2, what)?;
    let [mut from, mut to] = [
        reader.params.real(3, "the start angle SA")?,
        reader.params.real(4, "the end angle TA")?,
    ];
    if from > to {
        reader.note("the start angle is larger than the end angle; they were exchanged");
        (from, to) = (to, from);
    }
    if to - from > TAU * (1.0 + 1e-8) {
        reader
            .note("the angles span more than a full turn; one turn from the start angle was used");
    }
    // Angles of nine digits: a turn that is full but for that is meant to be full.
    let full = to - from > TAU * (1.0 - 1e-8);
    if full {
        to = from + TAU;
    }
    if from >= to {
        return Err(Stop::Reason("the angles span no turn".to_owned()));
    }
    let curve = generatrix.curve.refined(0, &[])?;
    let (patch, snapped) = revolved(&curve, foot, direction.normalize(), [from, to])?;
    let patch = patch.transformed(&|x| reader.place(x))?;
    let angle = ParameterMap::arcs(&arc_knots(from, to));
    let base = BasePatch {
        patch,
        parameters: Reparametrise {
            directions: [generatrix.map, angle],
        },
        deviation: generatrix.deviation.max(snapped) / reader.model.global.scale,
    };
    Ok((BaseSurface::Patches(vec![base]), 5))
}

/// The curve (xi1) turned about the axis through `foot` with unit direction `axis` by the angles `range` (xi2). Ends of the
/// curve that miss the axis by 1e-9 of its largest distance are put onto it, so that the edge there is one point; also
/// returns by how much.
pub fn revolved(
    curve: &NurbsCurve<3>,
    foot: Vec3,
    axis: Vec3,
    range: [f64; 2],
) -> Result<(NurbsPatch, f64), Stop> {
    let split = |h: &[f64; 4]| {
        let x = Vec3::new(h[0], h[1], h[2]) / h[3];
        let on_axis = foot + axis * axis.dot(&(x - foot));
        (on_axis, x - on_axis)
    };
    let net = curve.homogeneous();
    let farthest = net.iter().map(|h| split(h).1.norm()).fold(0.0, f64::max);
    if farthest <= 0.0 {
        let reason = "the generatrix lies on the axis".to_owned();
        return Err(Stop::Reason(reason));
    }
    let columns = net.len();
    let mut snapped = 0.0f64;
    let mut turned = Vec::with_capacity(columns);
    for (i, h) in net.iter().enumerate() {
        let (on_axis, mut radial) = split(h);
        let distance = radial.norm();
        if (i == 0 || i + 1 == columns) && distance <= 1e-9 * farthest {
            snapped = snapped.max(distance);
            radial = Vec3::zeros();
        }
        // A full circle about each control point's foot on the axis, of whatever radius.
        turned.push(elliptic_arc(
            on_axis,
            radial,
            axis.cross(&radial),
            range[0],
            range[1],
        )?);
    }
    let along = curve.basis().clone();
    let around: Basis = turned[0].basis().clone();
    let mut points = Vec::with_capacity(columns * around.count());
    for j in 0..around.count() {
        for (h, circle) in net.iter().zip(&turned) {
            points.push(circle.homogeneous()[j].map(|x| x * h[3]));
        }
    }
    let patch = NurbsPatch::from_homogeneous([along, around], points)?;
    Ok((patch, snapped))
}
