//! Surfaces with the parameters that ISO 10303-42 gives them, cut out by the points that a face has on them.

use super::curve::Course;
use super::place::{Frame, Placement};
use super::profile::{
    angles, conic, conic_on_axis, conic_parameter, extrusion_parameters, line, profile,
    profile_range,
};
use crate::basis::Basis;
use crate::curve::conic::elliptic_arc;
use crate::io::brep::{BasePatch, Grant, ParameterMap, Reparametrise, offset, revolved};
use crate::{NurbsCurve, NurbsPatch, Vec3};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::rc::Rc;

/// How far a patch reaches beyond the points that it is sized by, as a share of their extent.
const MARGIN: f64 = 0.01;
/// A line that comes this near to the axis about which it turns, as a share of its distance from it elsewhere, meets it.
const AXIS: f64 = 1e-9;

/// What a surface is, in a frame.
#[derive(Debug, Clone)]
pub enum Shape {
    Plane,
    /// Radius.
    Cylinder(f64),
    /// Radius at the origin, tangent of the half angle.
    Cone(f64, f64),
    /// Radius.
    Sphere(f64),
    /// Major and minor radius, range of the angle about the tube.
    Torus(f64, f64, [f64; 2]),
    /// A curve and the vector along which it is moved.
    Extrusion(Course<3>, Vec3),
    /// A curve turned about the third axis of the frame.
    Revolution(Course<3>),
    Spline(Box<NurbsPatch>),
    /// A part: ranges of both parameters, angles in radians.
    Part(Box<Surface>, [[f64; 2]; 2]),
    /// A copy.
    Moved(Box<Surface>, Placement),
    /// The surface at a distance along the normal of another, and the grant that pays for its approximation.
    Offset(Box<Surface>, f64, Rc<Grant>),
}

/// A surface.
#[derive(Debug, Clone)]
pub struct Surface {
    pub shape: Shape,
    pub frame: Frame,
    /// Radians in the file's unit of angles.
    pub angle: f64,
}

/// The ranges of both parameters; `None` where the surface has no end.
type Natural = [Option<[f64; 2]>; 2];

impl Surface {
    /// The patch that reaches a little farther than `points`: control points of curves on the surface will do, as their hull
    /// holds the curve.
    pub fn sized(&self, points: &[Vec3]) -> Result<BasePatch, String> {
        if let Shape::Moved(base, placement) = &self.shape {
            let back = placement.inverse().ok_or("its placement is singular")?;
            let points: Vec<Vec3> = points.iter().map(|x| back.apply(*x)).collect();
            let base = base.sized(&points)?;
            let patch = base.patch.transformed(&|x| placement.apply(x));
            return Ok(BasePatch {
                patch: patch.map_err(|e| e.to_string())?,
                ..base
            });
        }
        self.patch(self.ranges(points)?)
    }

    /// The whole surface, where it has ends.
    pub fn whole(&self) -> Result<BasePatch, String> {
        if let Shape::Moved(..) = self.shape {
            return self.sized(&[]);
        }
        let [Some(u), Some(v)] = self.natural() else {
            return Err("has no end, and no face says which part of it is meant".to_owned());
        };
        self.patch([u, v])
    }

    fn natural(&self) -> Natural {
        let turn = Some([0.0, TAU]);
        match &self.shape {
            Shape::Plane | Shape::Moved(..) => [None, None],
            Shape::Cylinder(_) | Shape::Cone(..) => [turn, None],
            Shape::Sphere(_) => [turn, Some([-FRAC_PI_2, FRAC_PI_2])],
            Shape::Torus(_, _, tube) => [turn, Some(*tube)],
            Shape::Extrusion(course, _) => [profile_range(course), None],
            Shape::Revolution(course) => [turn, profile_range(course)],
            Shape::Spline(patch) => patch.domain().map(Some),
            Shape::Part(_, ranges) => ranges.map(Some),
            Shape::Offset(base, ..) => base.natural(),
        }
    }

    /// The ranges of both parameters, where the surface has no end those of the points.
    fn ranges(&self, points: &[Vec3]) -> Result<[[f64; 2]; 2], String> {
        let natural = self.natural();
        if let [Some(u), Some(v)] = natural {
            return Ok([u, v]);
        }
        let mut own = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for x in points {
            let at = self.parameters(x)?;
            for d in 0..2 {
                own[d][0] = own[d][0].min(at[d][0]);
                own[d][1] = own[d][1].max(at[d][1]);
            }
        }
        let extent = |d: usize| match natural[d] {
            Some(_) => 0.0,
            None => own[d][1] - own[d][0],
        };
        // Lengths of both parameters of a plane are alike; of others only one counts.
        let largest = extent(0).max(extent(1));
        if !(largest.is_finite() && largest > 0.0) {
            return Err("nothing that lies on it gives it an extent".to_owned());
        }
        let mut out = [[0.0; 2]; 2];
        for d in 0..2 {
            let margin = match self.shape {
                Shape::Plane => MARGIN * largest,
                _ => MARGIN * extent(d).max(1e-3 * largest),
            };
            out[d] = natural[d].unwrap_or([own[d][0] - margin, own[d][1] + margin]);
            if natural[d].is_none() {
                out[d] = self.before_axis(out[d], own[d]);
            }
        }
        Ok(out)
    }

    /// A cone, or a line turned about an axis that it meets, ends where it meets the axis, unless its points lie on both sides.
    fn before_axis(&self, mut range: [f64; 2], own: [f64; 2]) -> [f64; 2] {
        let tip = match &self.shape {
            Shape::Cone(radius, slope) => Some(-radius / slope),
            Shape::Revolution(course) => match line(course) {
                Some((origin, along)) => self.meets_axis(origin, along, range),
                None => conic_on_axis(course, &self.frame),
            },
            _ => None,
        };
        if let Some(tip) = tip {
            let slack = 1e-6 * (own[1] - own[0]);
            if own[0] >= tip - slack {
                range[0] = range[0].max(tip);
            } else if own[1] <= tip + slack {
                range[1] = range[1].min(tip);
            }
        }
        range
    }

    /// Where a line meets the axis.
    fn meets_axis(&self, origin: Vec3, along: Vec3, range: [f64; 2]) -> Option<f64> {
        let axis = self.frame.axes[2];
        let across = |v: Vec3| v - axis * axis.dot(&v);
        let (d, a) = (across(origin - self.frame.origin), across(along));
        let t = -d.dot(&a) / a.norm_squared();
        let reach = range.map(|t| (d + a * t).norm());
        let near = (d + a * t).norm() <= AXIS * reach[0].max(reach[1]);
        (t.is_finite() && near).then_some(t)
    }

    /// The point in which straight generatrices meet on the axis.
    pub fn tip(&self) -> Option<Vec3> {
        match &self.shape {
            Shape::Cone(radius, slope) => {
                Some(self.frame.origin - self.frame.axes[2] * (radius / slope))
            }
            Shape::Revolution(course) => {
                let Some((origin, along)) = line(course) else {
                    let t = conic_on_axis(course, &self.frame)?;
                    return Some(conic(course)?.point(t));
                };
                let t = self.meets_axis(origin, along, [-1.0, 1.0])?;
                let slanted = along.dot(&self.frame.axes[2]) != 0.0;
                slanted.then(|| origin + along * t)
            }
            _ => None,
        }
    }

    /// The axis about which the surface turns, as a point and a direction.
    pub fn axis(&self) -> [Vec3; 2] {
        [self.frame.origin, self.frame.axes[2]]
    }

    /// The second parameter of a point of a cylinder or cone: its height.
    pub fn height(&self, x: &Vec3) -> Option<f64> {
        match self.shape {
            Shape::Cylinder(_) | Shape::Cone(..) => {
                Some((x - self.frame.origin).dot(&self.frame.axes[2]))
            }
            _ => None,
        }
    }

    /// The range in which each parameter of a point lies, as far as it tells.
    fn parameters(&self, x: &Vec3) -> Result<[[f64; 2]; 2], String> {
        let [e1, e2, e3] = self.frame.axes;
        let local = x - self.frame.origin;
        let exact = |u: f64, v: f64| Ok([[u, u], [v, v]]);
        match &self.shape {
            Shape::Plane => exact(local.dot(&e1), local.dot(&e2)),
            Shape::Cylinder(_) | Shape::Cone(..) => exact(0.0, local.dot(&e3)),
            // The margin covers what the distance changes.
            Shape::Offset(base, ..) => base.parameters(x),
            Shape::Extrusion(course, along) => extrusion_parameters(course, *along, x),
            Shape::Revolution(course) => {
                let Some((origin, along)) = line(course) else {
                    let v = conic_parameter(course, &self.frame, x)?;
                    return exact(0.0, v);
                };
                let (from, slope) = ((origin - self.frame.origin).dot(&e3), along.dot(&e3));
                if slope.abs() > 1e-9 * along.norm() {
                    let v = (local.dot(&e3) - from) / slope;
                    return exact(0.0, v);
                }
                // A disc: the distance from the axis.
                let across = |v: Vec3| v - e3 * e3.dot(&v);
                let (d, a) = (across(origin - self.frame.origin), across(along));
                let r2 = across(local).norm_squared();
                let (half, whole) = (d.dot(&a) / a.norm_squared(), a.norm_squared());
                let root = (half * half - (d.norm_squared() - r2) / whole)
                    .max(0.0)
                    .sqrt();
                // The line meets the axis or passes it: one side is enough, the one where it begins.
                let v = if half <= 0.0 && -half > root {
                    -half - root
                } else {
                    -half + root
                };
                exact(0.0, v)
            }
            _ => Err("has no extent that points could give".to_owned()),
        }
    }

    /// The patch on ranges of both parameters.
    pub fn patch(&self, [u, v]: [[f64; 2]; 2]) -> Result<BasePatch, String> {
        if [u, v]
            .iter()
            .any(|[a, b]| !(b > a && a.is_finite() && b.is_finite()))
        {
            return Err(format!("has the parameters {u:?} and {v:?}"));
        }
        let Frame { origin, axes } = self.frame;
        let [e1, e2, _] = axes;
        match &self.shape {
            Shape::Plane => {
                let at = |x: f64, y: f64| origin + e1 * x + e2 * y;
                parallelogram([u, v], at)
            }
            Shape::Cylinder(radius) => self.generated(u, v, |z| (*radius, z)),
            Shape::Cone(radius, slope) => {
                let tip = -radius / slope;
                let distance = |z: f64| if z == tip { 0.0 } else { radius + slope * z };
                self.generated(u, v, |z| (distance(z), z))
            }
            Shape::Sphere(radius) => self.tube(u, v, [0.0, *radius]),
            Shape::Torus(major, minor, _) => self.tube(u, v, [*major, *minor]),
            Shape::Extrusion(course, along) => {
                if let Some((start, first)) = line(course) {
                    return parallelogram([u, v], |x, y| start + first * x + along * y);
                }
                let (curve, map) = profile(course, u, self.angle)?;
                extruded(&curve, map, *along, v)
            }
            Shape::Revolution(course) => {
                let (curve, map) = profile(course, v, self.angle)?;
                self.turned(&curve, map, u)
            }
            Shape::Spline(patch) => {
                let patch = match patch.domain() == [u, v] {
                    true => (**patch).clone(),
                    false => patch.with_domain([u, v]).map_err(|e| e.to_string())?,
                };
                Ok(BasePatch {
                    parameters: Reparametrise {
                        directions: patch.domain().map(ParameterMap::identity),
                    },
                    patch,
                    deviation: 0.0,
                })
            }
            Shape::Part(base, _) => base.patch([u, v]),
            Shape::Offset(base, distance, grant) => {
                let base = base.patch([u, v])?;
                let (patch, deviation) = offset(&base.patch, *distance, grant)?;
                Ok(BasePatch {
                    patch,
                    deviation: base.deviation + deviation,
                    ..base
                })
            }
            Shape::Moved(..) => Err("is a copy of a surface without an extent".to_owned()),
        }
    }

    /// A straight generatrix, given as distance from the axis and height, turned by the angles `u`.
    fn generated(
        &self,
        u: [f64; 2],
        v: [f64; 2],
        at: impl Fn(f64) -> (f64, f64),
    ) -> Result<BasePatch, String> {
        let Frame { origin, axes } = self.frame;
        let place = |z: f64| {
            let (r, z) = at(z);
            origin + axes[0] * r + axes[2] * z
        };
        let line = NurbsCurve::new(1, vec![v[0], v[0], v[1], v[1]], &v.map(place), None);
        let line = line.map_err(|e| e.to_string())?;
        self.turned(&line, ParameterMap::identity(v), u)
    }

    /// An arc about a center at the distance `major` from the axis, turned by the angles `u`.
    fn tube(
        &self,
        u: [f64; 2],
        v: [f64; 2],
        [major, minor]: [f64; 2],
    ) -> Result<BasePatch, String> {
        let Frame { origin, axes } = self.frame;
        let [e1, _, e3] = axes;
        let arc = elliptic_arc(origin + e1 * major, e1 * minor, e3 * minor, v[0], v[1]);
        let arc = arc.map_err(|e| e.to_string())?;
        self.turned(&arc, angles(v, self.angle), u)
    }

    /// A curve turned by the angles `u` about the axis: xi1 the angle, xi2 along the curve.
    fn turned(
        &self,
        curve: &NurbsCurve<3>,
        map: ParameterMap,
        u: [f64; 2],
    ) -> Result<BasePatch, String> {
        let (patch, snapped) = revolved(curve, self.frame.origin, self.frame.axes[2], u)?;
        Ok(BasePatch {
            patch: patch.swapped().map_err(|e| e.to_string())?,
            parameters: Reparametrise {
                directions: [angles(u, self.angle), map],
            },
            deviation: snapped,
        })
    }
}

fn parallelogram(
    [u, v]: [[f64; 2]; 2],
    at: impl Fn(f64, f64) -> Vec3,
) -> Result<BasePatch, String> {
    let points = [
        at(u[0], v[0]),
        at(u[1], v[0]),
        at(u[0], v[1]),
        at(u[1], v[1]),
    ];
    let knots = [u, v].map(|[a, b]| vec![a, a, b, b]);
    let patch = NurbsPatch::new([1, 1], knots, [2, 2], &points, None);
    Ok(BasePatch {
        patch: patch.map_err(|e| e.to_string())?,
        parameters: Reparametrise {
            directions: [u, v].map(ParameterMap::identity),
        },
        deviation: 0.0,
    })
}

fn extruded(
    curve: &NurbsCurve<3>,
    map: ParameterMap,
    along: Vec3,
    v: [f64; 2],
) -> Result<BasePatch, String> {
    let net = curve.homogeneous();
    let points = v.iter().flat_map(|&t| {
        net.iter().map(move |&[x, y, z, w]| {
            let d = along * (t * w);
            [x + d.x, y + d.y, z + d.z, w]
        })
    });
    let across = Basis::new(1, vec![v[0], v[0], v[1], v[1]], 2).map_err(|e| e.to_string())?;
    let patch = NurbsPatch::from_homogeneous([curve.basis().clone(), across], points.collect());
    Ok(BasePatch {
        patch: patch.map_err(|e| e.to_string())?,
        parameters: Reparametrise {
            directions: [map, ParameterMap::identity(v)],
        },
        deviation: 0.0,
    })
}
