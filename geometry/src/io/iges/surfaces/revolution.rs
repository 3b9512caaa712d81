//! Surfaces of revolution (120).

use std::f64::consts::TAU;

use super::super::curve::Stop;
use super::{BasePatch, BaseSurface, Found, SurfaceReader};
use crate::curve::conic::arc_knots;
use crate::io::brep::{ParameterMap, Reparametrise, revolved};

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
