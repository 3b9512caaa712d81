//! Spheres (196) and tori (198) as full patches.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::super::curve::Stop;
use super::plane::degrees;
use super::{BasePatch, BaseSurface, Found, SurfaceReader};
use crate::Vec3;
use crate::curve::conic::elliptic_arc;
use crate::io::brep::Reparametrise;
use crate::io::brep::revolved;

/// A 196: center, radius and, in form 1, axis and reference direction. Parameters of the file: longitude from the
/// reference direction and latitude, in degrees.
pub fn sphere(mut reader: SurfaceReader) -> Found {
    let center = reader.location(1, "the center of a sphere (196)")?;
    let radius = reader.length(2, "the radius")?;
    let (axis, reference) = if reader.entry.form == 1 {
        let axis = reader.direction(3, "the axis")?;
        (axis, Some(reader.direction(4, "the reference direction")?))
    } else {
        (Vec3::z(), None)
    };
    let values = 3 + 2 * usize::from(reader.entry.form == 1);
    let triad = reader.triad(axis, reference)?;
    let latitude = [-FRAC_PI_2, FRAC_PI_2];
    let base = tube(&reader, center, triad, [0.0, radius], latitude)?;
    Ok((BaseSurface::Patches(vec![base]), values))
}

/// A 198: center, axis, both radii and, in form 1, reference direction. Parameters of the file: the angle about the tube from
/// the outer equator towards the axis, and the angle about the axis, from 360 at the reference direction down to 0 (as Open
/// CASCADE writes and reads them), in degrees.
pub fn torus(mut reader: SurfaceReader) -> Found {
    let major = reader.length(3, "the major radius")?;
    let minor = reader.length(4, "the minor radius")?;
    let (center, triad) = reader.frame(5)?;
    let values = 5 + usize::from(reader.entry.form == 1);
    if minor >= major {
        reader.note("the tube of the torus is thicker than its hole: the surface meets itself");
    }
    let mut base = tube(&reader, center, triad, [major, minor], [0.0, TAU])?;
    // A full turn in equal arcs backwards has the same map from angles to parameters.
    base.patch = base.patch.swapped()?.reversed(1)?;
    Ok((BaseSurface::Patches(vec![base]), values))
}

/// The arc of radius `minor` about a center at distance `major` from the axis, turned fully: xi1 the angle about the axis,
/// xi2 that of the arc.
fn tube(
    reader: &SurfaceReader,
    center: Vec3,
    [e1, _, e3]: [Vec3; 3],
    [major, minor]: [f64; 2],
    range: [f64; 2],
) -> Result<BasePatch, Stop> {
    let arc = elliptic_arc(
        center + e1 * major,
        e1 * minor,
        e3 * minor,
        range[0],
        range[1],
    )?;
    let (patch, _) = revolved(&arc, center, e3, [0.0, TAU])?;
    Ok(BasePatch {
        patch: patch.swapped()?.transformed(&|x| reader.place(x))?,
        parameters: Reparametrise {
            directions: [degrees([0.0, TAU]), degrees(range)],
        },
        deviation: 0.0,
    })
}
