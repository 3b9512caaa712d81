//! Motion of rigid surfaces over a step, on which their forces do work.
use super::Span;
use crate::assembly::SurfaceForce;
use crate::model::motion::SmallMotion;
use crate::model::{Model, SurfaceModel};
use crate::scene::ValueError;
use covact_geometry::Vec3;
use nalgebra::Isometry3;

/// Motion of a rigid surface over a step as the screw that leads from one position to the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Twist {
    /// Displacement of the point of the surface that passes the origin (length).
    velocity: Vec3,
    /// Rotation vector.
    spin: Vec3,
}

impl Twist {
    /// Per surface; none where it stands still.
    pub(super) fn all(model: &Model, span: &Span) -> Result<Vec<Option<Twist>>, ValueError> {
        let ((from, start), (to, end)) = (span.from, span.to);
        if model.small.is_some() {
            let between = |s: &SurfaceModel| {
                let [a, b] = [s.motion.small(start)?, s.motion.small(end)?];
                Ok((a != b).then(|| Twist::small(&a, &b)))
            };
            return model.surfaces.iter().map(between).collect();
        }
        let between = |s: &SurfaceModel| {
            let (a, b) = (s.pose(start, &from.u)?, s.pose(end, &to.u)?);
            Ok((a != b).then(|| Twist::between(&a, &b)))
        };
        model.surfaces.iter().map(between).collect()
    }

    /// Between two small motions, which refer to where everything was at the start, as their forces do.
    fn small(a: &SmallMotion, b: &SmallMotion) -> Twist {
        let spin = b.spin - a.spin;
        Twist {
            velocity: b.shift - a.shift - spin.cross(&b.center),
            spin,
        }
    }

    /// The logarithm of the motion (R. M. Murray, Z. Li, S. S. Sastry, "A Mathematical Introduction to Robotic Manipulation",
    /// 1994, proposition 2.9), by the displacement of a point near the surface: positions may be far from the origin.
    fn between(a: &Isometry3<f64>, b: &Isometry3<f64>) -> Twist {
        let turn = b.rotation * a.rotation.inverse();
        let spin = turn.scaled_axis();
        let angle = spin.norm();
        let moved = b.translation.vector - a.translation.vector;
        // (1 - (angle / 2) cot(angle / 2)) / angle^2, and its limit.
        let half = 0.5 * angle;
        let second = match angle > 1e-3 {
            true => (1.0 - half / half.tan()) / (angle * angle),
            false => 1.0 / 12.0 + angle * angle / 720.0,
        };
        let across = spin.cross(&moved);
        let velocity = moved - 0.5 * across + second * spin.cross(&across);
        Twist {
            velocity: velocity - spin.cross(&a.translation.vector),
            spin,
        }
    }

    /// Work of force and moment on the motion.
    pub(super) fn power(&self, on: &SurfaceForce) -> f64 {
        self.velocity.dot(&on.force) + self.spin.dot(&on.moment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Translation3, UnitQuaternion};

    /// The screw through two positions takes points of the one to the other.
    #[test]
    fn screws_lead_from_one_position_to_the_other() {
        for angle in [0.0, 1e-9, 1e-4, 0.3, 3.0] {
            let turn = |v: Vec3| UnitQuaternion::from_scaled_axis(v);
            let a = Isometry3::from_parts(
                Translation3::new(3.0, -2.0, 5.0),
                turn(Vec3::new(0.2, 0.5, -0.9)),
            );
            let spin = Vec3::new(2.0, -1.0, 2.0) * (angle / 3.0);
            let step = Isometry3::from_parts(Translation3::new(0.1, 0.7, -0.4), turn(spin));
            let twist = Twist::between(&a, &(step * a));
            // By steps along the field of velocities, of fourth order.
            let field = |x: Vec3| twist.velocity + twist.spin.cross(&x);
            let mut x = Vec3::new(1.0, 2.0, 3.0);
            let to = (step * Point3::from(x)).coords;
            let h = 1.0 / 400.0;
            for _ in 0..400 {
                let k1 = field(x);
                let k2 = field(x + k1 * (0.5 * h));
                let k3 = field(x + k2 * (0.5 * h));
                let k4 = field(x + k3 * h);
                x += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
            }
            assert!((x - to).norm() < 1e-8, "{angle}: {x} {to}");
        }
    }
}
