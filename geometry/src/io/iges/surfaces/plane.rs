//! Surfaces without an end in some direction: planes (108, 190), circular cylinders (192) and cones (194). They are cut
//! out by the points that a face has on them.

use std::f64::consts::TAU;

use super::super::curve::Stop;
use super::super::transform::Affine;
use super::{BasePatch, BaseSurface, Found, SurfaceReader};
use crate::curve::conic::arc_knots;
use crate::io::brep::revolved;
use crate::io::brep::{ParameterMap, Reparametrise};
use crate::{NurbsCurve, NurbsPatch, Vec3};

/// How far a sized patch reaches beyond the points it is sized by, as a share of their extent.
const MARGIN: f64 = 0.01;

#[derive(Debug, Clone, Copy)]
enum Kind {
    Plane,
    /// Radius.
    Cylinder(f64),
    /// Radius at the origin, tangent of the half angle (positive: wider along the axis).
    Cone(f64, f64),
}

/// A plane, cylinder or cone of unknown extent.
///
/// Parameters of the file (IGES 5.3): on a plane lengths along the reference direction and across it; on a cylinder or
/// cone the angle about the axis, in degrees, and the length along the axis.
#[derive(Debug, Clone)]
pub struct Unbounded {
    kind: Kind,
    /// In the entity's own coordinates.
    origin: Vec3,
    /// Reference direction, the one across it, normal or axis.
    triad: [Vec3; 3],
    map: Affine,
    scale: f64,
    /// A plane's own border: the directory number of a closed curve, which bounds it (108 form 1) or a hole in it (-1).
    pub border: Option<(u32, Border)>,
}

/// What the curve of a 108 bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Border {
    /// The plane's material.
    Outer,
    /// A hole.
    Hole,
}

impl Unbounded {
    /// The patch that reaches a little farther than `points` (model space, divided by its scale; control points of curves
    /// on the surface will do, as their hull holds the curve).
    ///
    /// # Errors
    /// No points, points that are not finite, points of which none is on the cone's side of its tip.
    pub fn sized(&self, points: &[Vec3]) -> Result<BasePatch, String> {
        let back = self.map.inverse().ok_or("the matrix is singular")?;
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for x in points {
            let local = back.apply(x * self.scale) - self.origin;
            let [e1, e2, e3] = self.triad;
            let place = match self.kind {
                Kind::Plane => [local.dot(&e1), local.dot(&e2)],
                _ => [0.0, local.dot(&e3)],
            };
            for d in 0..2 {
                low[d] = low[d].min(place[d]);
                high[d] = high[d].max(place[d]);
            }
        }
        let largest = (high[0] - low[0]).max(high[1] - low[1]);
        if !(largest.is_finite() && largest > 0.0) {
            return Err(
                "nothing that lies on this unbounded surface gives it an extent".to_owned(),
            );
        }
        let margin = MARGIN * largest;
        let mut range = [0, 1].map(|d| [low[d] - margin, high[d] + margin]);
        if !matches!(self.kind, Kind::Plane) {
            range[0] = [0.0, 360.0];
        }
        self.patch(range)
    }

    /// The patch on a box of the file's parameters, `[direction][start, end]`; a cylinder or cone always turns fully.
    ///
    /// # Errors
    /// An empty box, a cone without anything on this side of its tip.
    pub fn patch(&self, mut range: [[f64; 2]; 2]) -> Result<BasePatch, String> {
        let [e1, _, e3] = self.triad;
        let patch = match self.kind {
            Kind::Plane => self.flat(range),
            Kind::Cylinder(radius) => self.turned(range[1].map(|z| (radius, z))),
            Kind::Cone(radius, slope) => {
                let tip = -radius / slope;
                if slope > 0.0 {
                    range[1][0] = range[1][0].max(tip);
                } else {
                    range[1][1] = range[1][1].min(tip);
                }
                let at = |z: f64| {
                    if z == tip { 0.0 } else { radius + slope * z }
                };
                self.turned(range[1].map(|z| (at(z), z)))
            }
        }
        .map_err(|stop| match stop {
            Stop::Reason(reason) => reason,
            Stop::Damage(_) => format!("no patch about {e1}, {e3}"),
        })?;
        let patch = patch
            .transformed(&|x| self.map.apply(x) / self.scale)
            .map_err(|e| e.to_string())?;
        let along = ParameterMap::identity(range[1]);
        let first = match self.kind {
            Kind::Plane => ParameterMap::identity(range[0]),
            _ => degrees([0.0, TAU]),
        };
        Ok(BasePatch {
            patch,
            parameters: Reparametrise {
                directions: [first, along],
            },
            deviation: 0.0,
        })
    }

    /// The surface at `distance` (in the entity's own coordinates) on the side of `indicator`, a vector of model space.
    ///
    /// # Errors
    /// A plane with a border of its own; a radius that is not left; an indicator that does not tell the side.
    pub(super) fn offset(&self, distance: f64, indicator: &Vec3) -> Result<Self, String> {
        if self.border.is_some() {
            return Err("its border would not move with it".to_owned());
        }
        let back = self.map.inverse().ok_or("the matrix is singular")?;
        let to = back.linear * indicator;
        let mut moved = self.clone();
        // The normal in the middle of the range of parameters: on a cylinder or cone half a turn from the reference direction.
        let [e1, _, e3] = self.triad;
        let outward = match self.kind {
            Kind::Plane => e3,
            Kind::Cylinder(_) => -e1,
            Kind::Cone(_, slope) => -(e1 + e3 * slope).normalize(),
        };
        let cosine = to.dot(&outward) / to.norm();
        if cosine.is_nan() || cosine.abs() < 0.1 {
            return Err("the offset indicator does not say on which side it lies".to_owned());
        }
        let distance = distance * cosine.signum();
        match &mut moved.kind {
            Kind::Plane => moved.origin += e3 * distance,
            Kind::Cylinder(radius) => *radius += distance,
            Kind::Cone(radius, slope) => *radius += distance * slope.hypot(1.0),
        }
        if let Kind::Cylinder(radius) = moved.kind
            && radius <= 0.0
        {
            return Err("no radius is left".to_owned());
        }
        Ok(moved)
    }

    fn flat(&self, [u, v]: [[f64; 2]; 2]) -> Result<NurbsPatch, Stop> {
        let [e1, e2, _] = self.triad;
        let at = |x: f64, y: f64| self.origin + e1 * x + e2 * y;
        let points = [
            at(u[0], v[0]),
            at(u[1], v[0]),
            at(u[0], v[1]),
            at(u[1], v[1]),
        ];
        let knots = [u, v].map(|[a, b]| vec![a, a, b, b]);
        Ok(NurbsPatch::new([1, 1], knots, [2, 2], &points, None)?)
    }

    /// A straight generatrix between two pairs (radius, height) turned fully: xi1 the angle, xi2 the height.
    fn turned(&self, ends: [(f64, f64); 2]) -> Result<NurbsPatch, Stop> {
        let [e1, _, e3] = self.triad;
        let at = |(r, z): (f64, f64)| self.origin + e1 * r + e3 * z;
        let heights = [ends[0].1, ends[1].1];
        let line = NurbsCurve::line(at(ends[0]), at(ends[1]))?.with_parameters(heights)?;
        Ok(revolved(&line, self.origin, e3, [0.0, TAU])?.0.swapped()?)
    }
}

/// From an angle in degrees to the parameter of circular arcs whose knots are the angles in radians.
pub fn degrees(range: [f64; 2]) -> ParameterMap {
    ParameterMap::arcs(&arc_knots(range[0], range[1]))
        .with_file_range(range.map(f64::to_degrees), false)
}

impl SurfaceReader<'_, '_> {
    fn unbounded(&self, kind: Kind, origin: Vec3, triad: [Vec3; 3]) -> Unbounded {
        Unbounded {
            kind,
            origin,
            triad,
            map: self.map,
            scale: self.model.global.scale,
            border: None,
        }
    }

    /// The reference direction that form 1 of 190 to 198 gives as value `i`.
    fn reference(&mut self, i: usize) -> Result<Option<Vec3>, Stop> {
        if self.entry.form == 1 {
            self.direction(i, "the reference direction").map(Some)
        } else {
            Ok(None)
        }
    }

    /// Location, axis as values 1 and 2, and the reference direction as value `i`.
    pub(super) fn frame(&mut self, i: usize) -> Result<(Vec3, [Vec3; 3]), Stop> {
        let origin = self.location(1, "the location")?;
        let axis = self.direction(2, "the axis")?;
        let reference = self.reference(i)?;
        Ok((origin, self.triad(axis, reference)?))
    }

    pub(super) fn length(&self, i: usize, what: &str) -> Result<f64, Stop> {
        let value = self.params.real(i, what)?;
        if value > 0.0 {
            Ok(value)
        } else {
            Err(Stop::Reason(format!("{what} is {value}")))
        }
    }
}

/// A 108: A x + B y + C z = D. The standard gives it no parameters; here they are lengths from the point nearest to the
/// origin.
pub fn plane_108(reader: SurfaceReader) -> Found {
    let v = reader.params.reals(1, 4, "a coefficient of a plane")?;
    let normal = Vec3::new(v[0], v[1], v[2]);
    let size = normal.norm();
    if size <= 0.0 || !size.is_finite() {
        return Err(Stop::Reason("the plane has no normal".to_owned()));
    }
    let unit = normal / size;
    let triad = reader.triad(unit, None)?;
    let mut plane = reader.unbounded(Kind::Plane, unit * (v[3] / size), triad);
    let what = "the border of a plane (108)";
    let pointer = if reader.params.len() > 5 {
        reader.params.integer(5, what)?
    } else {
        0
    };
    if pointer != 0 {
        let kind = if reader.entry.form < 0 {
            Border::Hole
        } else {
            Border::Outer
        };
        plane.border = Some((reader.pointer(5, what)?.number, kind));
    }
    Ok((BaseSurface::Unbounded(Box::new(plane)), 10))
}

/// A 190: point, normal and, in form 1, reference direction.
pub fn plane_190(mut reader: SurfaceReader) -> Found {
    let (origin, triad) = reader.frame(3)?;
    let values = 3 + usize::from(reader.entry.form == 1);
    let plane = reader.unbounded(Kind::Plane, origin, triad);
    Ok((BaseSurface::Unbounded(Box::new(plane)), values))
}

/// A 192: point on the axis, axis, radius and, in form 1, reference direction.
pub fn cylinder(mut reader: SurfaceReader) -> Found {
    let radius = reader.length(3, "the radius")?;
    let (origin, triad) = reader.frame(4)?;
    let values = 4 + usize::from(reader.entry.form == 1);
    let cylinder = reader.unbounded(Kind::Cylinder(radius), origin, triad);
    Ok((BaseSurface::Unbounded(Box::new(cylinder)), values))
}

/// A 194: point on the axis, axis, radius there, half angle in degrees and, in form 1, reference direction.
pub fn cone(mut reader: SurfaceReader) -> Found {
    let radius = reader.params.real(3, "the radius")?;
    let angle = reader.params.real(4, "the half angle")?;
    if radius < 0.0 {
        return Err(Stop::Reason(format!("the radius is {radius}")));
    }
    if angle == 0.0 || angle.abs() >= 90.0 {
        return Err(Stop::Reason(format!("the half angle is {angle} degrees")));
    }
    let (origin, triad) = reader.frame(5)?;
    let values = 5 + usize::from(reader.entry.form == 1);
    let slope = angle.to_radians().tan();
    let cone = reader.unbounded(Kind::Cone(radius, slope), origin, triad);
    Ok((BaseSurface::Unbounded(Box::new(cone)), values))
}
