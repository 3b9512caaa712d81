//! Surface entities (ISO 10303-42, geometric model schema).

use super::curve_read;
use super::entity::{Entity, Told};
use super::place::{Frame, axis, frame, transformation, triad, vector};
use super::scope::{Budget, Scope};
use super::spline::spline_surface;
use super::surface::{Shape, Surface};
use crate::Vec3;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Reads a surface without what bounds a face on it.
pub fn read(scope: &Scope, index: u32) -> Told<Surface> {
    nested(scope, index, 0)
}

fn nested(scope: &Scope, index: u32, depth: usize) -> Told<Surface> {
    let entity = scope.entity(index, depth)?;
    let angle = scope.angle;
    let nowhere = Frame {
        origin: Vec3::zeros(),
        axes: [Vec3::x(), Vec3::y(), Vec3::z()],
    };
    let made = |shape, frame| {
        Ok(Surface {
            shape,
            frame,
            angle,
        })
    };
    if entity.is("ELEMENTARY_SURFACE") {
        let position = entity.reference("ELEMENTARY_SURFACE", 0, "the position of a surface")?;
        return made(
            elementary(scope, &entity)?,
            frame(scope.exchange, position)?,
        );
    }
    if entity.is("SURFACE_OF_LINEAR_EXTRUSION") {
        let curve = entity.reference("SWEPT_SURFACE", 0, "the curve of an extrusion")?;
        let along = entity.reference(
            "SURFACE_OF_LINEAR_EXTRUSION",
            0,
            "the vector of an extrusion",
        )?;
        let along = vector(scope.exchange, along)?;
        return made(
            Shape::Extrusion(curve_read::read(scope, curve)?, along),
            nowhere,
        );
    }
    if entity.is("SURFACE_OF_REVOLUTION") {
        let curve = entity.reference("SWEPT_SURFACE", 0, "the curve of a revolution")?;
        let position = entity.reference("SURFACE_OF_REVOLUTION", 0, "the axis of a revolution")?;
        let (origin, along) = axis(scope.exchange, position)?;
        let axes = triad(along, None);
        let curve = curve_read::read(scope, curve)?;
        return made(Shape::Revolution(curve), Frame { origin, axes });
    }
    if entity.is("B_SPLINE_SURFACE") {
        let patch = spline_surface(scope, &entity)?;
        return made(Shape::Spline(Box::new(patch)), nowhere);
    }
    if entity.is("RECTANGULAR_TRIMMED_SURFACE") {
        return rectangle(scope, &entity, depth);
    }
    if entity.is("OFFSET_SURFACE") {
        let base = entity.reference("OFFSET_SURFACE", 0, "the base of an offset surface")?;
        let distance = entity.real("OFFSET_SURFACE", 1, "the distance of an offset surface")?;
        let surface = nested(scope, base, depth + 1)?;
        return offset(surface, distance, scope.budget)
            .map_err(|e| format!("{} {e}", entity.describe()));
    }
    if entity.is("SURFACE_REPLICA") {
        let base = entity.reference("SURFACE_REPLICA", 0, "the surface of a copy")?;
        let map = entity.reference("SURFACE_REPLICA", 1, "the placement of a copy")?;
        let surface = nested(scope, base, depth + 1)?;
        let map = transformation(scope.exchange, map)?;
        return made(Shape::Moved(Box::new(surface), map), nowhere);
    }
    Err(format!(
        "{} is a surface of a type that is not read",
        entity.describe()
    ))
}

fn elementary(scope: &Scope, entity: &Entity) -> Told<Shape> {
    let length = |kind: &str, k: usize, what: &str| {
        let value = entity.real(kind, k, what)?;
        match value > 0.0 && value.is_finite() {
            true => Ok(value),
            false => {
                let item = entity.attribute(kind, k, what)?;
                Err(entity.wrong(item, &format!("{what} above zero")))
            }
        }
    };
    if entity.is("PLANE") {
        return Ok(Shape::Plane);
    }
    if entity.is("CYLINDRICAL_SURFACE") {
        return Ok(Shape::Cylinder(length(
            "CYLINDRICAL_SURFACE",
            0,
            "a radius",
        )?));
    }
    if entity.is("SPHERICAL_SURFACE") {
        return Ok(Shape::Sphere(length("SPHERICAL_SURFACE", 0, "a radius")?));
    }
    if entity.is("CONICAL_SURFACE") {
        let kind = "CONICAL_SURFACE";
        let radius = entity.real(kind, 0, "a radius")?;
        let half = scope.angle * entity.real(kind, 1, "a half angle")?;
        if radius.is_nan() || radius < 0.0 {
            let item = entity.attribute(kind, 0, "a radius")?;
            return Err(entity.wrong(item, "a radius that is not negative"));
        }
        let slope = half.tan();
        if !(half.abs() < std::f64::consts::FRAC_PI_2 && slope != 0.0) {
            let item = entity.attribute(kind, 1, "a half angle")?;
            return Err(entity.wrong(item, "a half angle between zero and a right angle"));
        }
        return Ok(Shape::Cone(radius, slope));
    }
    if entity.is("TOROIDAL_SURFACE") {
        let kind = "TOROIDAL_SURFACE";
        let major = length(kind, 0, "a major radius")?;
        let minor = length(kind, 1, "a minor radius")?;
        let mut tube = [0.0, TAU];
        if minor > major && entity.is("DEGENERATE_TOROIDAL_SURFACE") {
            let outer = entity.flag("DEGENERATE_TOROIDAL_SURFACE", 0, "which part of a torus")?;
            let axis = (-major / minor).acos();
            tube = if outer {
                [-axis, axis]
            } else {
                [axis, TAU - axis]
            };
        }
        return Ok(Shape::Torus(major, minor, tube));
    }
    Err(format!(
        "{} is a surface of a type that is not read",
        entity.describe()
    ))
}

/// A RECTANGULAR_TRIMMED_SURFACE: a surface, the ends u1, u2, v1, v2, and whether both parameters run as those of the surface.
fn rectangle(scope: &Scope, entity: &Entity, depth: usize) -> Told<Surface> {
    let kind = "RECTANGULAR_TRIMMED_SURFACE";
    let base = entity.reference(kind, 0, "the base of a trimmed surface")?;
    let base = nested(scope, base, depth + 1)?;
    let turns = match &base.shape {
        Shape::Cylinder(_) | Shape::Cone(..) | Shape::Revolution(_) => [true, false],
        Shape::Sphere(_) | Shape::Torus(..) => [true, true],
        _ => [false, false],
    };
    let mut ranges = [[0.0; 2]; 2];
    for d in 0..2 {
        let unit = if turns[d] { scope.angle } else { 1.0 };
        let what = "an end of a trimmed surface";
        let from = unit * entity.real(kind, 1 + 2 * d, what)?;
        let to = unit * entity.real(kind, 2 + 2 * d, what)?;
        let forward = entity.flag(kind, 5 + d, "the sense of a trimmed surface")?;
        let (low, mut high) = if forward { (from, to) } else { (to, from) };
        let closed = turns[d] && !(d == 1 && matches!(base.shape, Shape::Sphere(_)));
        if closed && high <= low {
            high += TAU;
        }
        ranges[d] = [low, high];
    }
    let (frame, angle) = (base.frame, base.angle);
    Ok(Surface {
        shape: Shape::Part(Box::new(base), ranges),
        frame,
        angle,
    })
}

/// The surface at a distance along the normal of `base`: exact where that is of a kind that offsets keep, else fitted.
fn offset(base: Surface, distance: f64, budget: &Budget) -> Result<Surface, String> {
    let Surface {
        shape,
        mut frame,
        angle,
    } = base;
    let axis = frame.axes[2];
    let radius = |r: f64| match r + distance {
        r if r > 0.0 => Ok(r),
        _ => Err(format!("lies {distance} inside of a radius of {r}")),
    };
    let shape = match shape {
        Shape::Plane => {
            frame.origin += axis * distance;
            Shape::Plane
        }
        Shape::Cylinder(r) => Shape::Cylinder(radius(r)?),
        Shape::Sphere(r) => Shape::Sphere(radius(r)?),
        Shape::Torus(major, minor, tube) => Shape::Torus(major, radius(minor)?, tube),
        Shape::Cone(r, slope) => {
            // The normal is (cos, -sin) of the half angle in radius and height: the same cone, its origin moved so that
            // heights keep their meaning.
            let cos = 1.0 / (1.0 + slope * slope).sqrt();
            frame.origin -= axis * (distance * slope * cos);
            Shape::Cone(r + distance * cos, slope)
        }
        Shape::Part(base, ranges) => {
            Shape::Part(Box::new(offset(*base, distance, budget)?), ranges)
        }
        Shape::Moved(base, map) => {
            // A placement that scales has the same factor in all directions.
            let factor = map.linear.determinant().abs().cbrt();
            let sign = if map.mirrors() { -1.0 } else { 1.0 };
            Shape::Moved(
                Box::new(offset(*base, sign * distance / factor, budget)?),
                map,
            )
        }
        Shape::Spline(_) | Shape::Extrusion(..) | Shape::Revolution(_) => {
            let base = Surface {
                shape,
                frame,
                angle,
            };
            Shape::Offset(Box::new(base), distance, Rc::clone(&budget.grant))
        }
        Shape::Offset(..) => return Err("is an offset of an offset, which is not read".to_owned()),
    };
    Ok(Surface {
        shape,
        frame,
        angle,
    })
}
