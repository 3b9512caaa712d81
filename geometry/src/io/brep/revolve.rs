//! Surfaces of revolution.

use crate::basis::Basis;
use crate::curve::conic::elliptic_arc;
use crate::{NurbsCurve, NurbsPatch, Vec3};

/// The curve (xi1) turned about the axis through `foot` with unit direction `axis` by the angles `range` (xi2). Ends of the
/// curve that miss the axis by 1e-9 of its largest distance are put onto it, so that the edge there is one point; also
/// returns by how much.
pub fn revolved(
    curve: &NurbsCurve<3>,
    foot: Vec3,
    axis: Vec3,
    range: [f64; 2],
) -> Result<(NurbsPatch, f64), String> {
    let split = |h: &[f64; 4]| {
        let x = Vec3::new(h[0], h[1], h[2]) / h[3];
        let on_axis = foot + axis * axis.dot(&(x - foot));
        (on_axis, x - on_axis)
    };
    let net = curve.homogeneous();
    let farthest = net.iter().map(|h| split(h).1.norm()).fold(0.0, f64::max);
    if farthest <= 0.0 {
        return Err("the generatrix lies on the axis".to_owned());
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
        let circle = elliptic_arc(on_axis, radial, axis.cross(&radial), range[0], range[1]);
        turned.push(circle.map_err(|e| e.to_string())?);
    }
    let along = curve.basis().clone();
    let around: Basis = turned[0].basis().clone();
    let mut points = Vec::with_capacity(columns * around.count());
    for j in 0..around.count() {
        for (h, circle) in net.iter().zip(&turned) {
            points.push(circle.homogeneous()[j].map(|x| x * h[3]));
        }
    }
    let patch = NurbsPatch::from_homogeneous([along, around], points);
    Ok((patch.map_err(|e| e.to_string())?, snapped))
}
