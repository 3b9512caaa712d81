//! Rigid motion of a surface: placement first, then the prescribed rotation and translation.
use crate::scene::{self, TIME, TimeFunction, ValueError};
use covact_geometry::Vec3;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion};

/// Prescribed motion of a rigid surface.
#[derive(Debug, Clone)]
pub struct Motion {
    placement: Isometry3<f64>,
    translation: [TimeFunction; 3],
    rotation: Option<Turn>,
}

#[derive(Debug, Clone)]
struct Turn {
    center: Vec3,
    axis: Unit<Vec3>,
    /// Degrees.
    angle: TimeFunction,
}

/// Rotation about an axis through the origin by an angle in degrees; a zero axis turns nothing.
pub fn rotation(axis: [f64; 3], degrees: f64) -> UnitQuaternion<f64> {
    match Unit::try_new(Vec3::from(axis), 0.0) {
        Some(axis) => UnitQuaternion::from_axis_angle(&axis, degrees.to_radians()),
        None => UnitQuaternion::identity(),
    }
}

impl Motion {
    /// Compiles the scene's motion. The scale of the placement is applied to the surface itself, not here.
    pub fn new(motion: &scene::Motion, placement: &scene::Placement) -> Result<Self, ValueError> {
        let compile = |v: &scene::Value| v.compile(&TIME);
        let [x, y, z] = &motion.translation;
        let rotation = match &motion.rotation {
            None => None,
            Some(r) => Unit::try_new(Vec3::from(r.axis), 0.0)
                .map(|axis| {
                    Ok::<_, ValueError>(Turn {
                        center: Vec3::from(r.center),
                        axis,
                        angle: compile(&r.angle)?,
                    })
                })
                .transpose()?,
        };
        Ok(Motion {
            placement: Isometry3::from_parts(
                Translation3::from(Vec3::from(placement.translation)),
                self::rotation(placement.axis, placement.angle),
            ),
            translation: [compile(x)?, compile(y)?, compile(z)?],
            rotation,
        })
    }

    /// From the surface's own coordinates to space at time `t`.
    pub fn pose(&self, t: f64) -> Result<Isometry3<f64>, ValueError> {
        let [x, y, z] = &self.translation;
        let moved = Vec3::new(x.eval(t)?, y.eval(t)?, z.eval(t)?);
        let turned = match &self.rotation {
            None => Isometry3::identity(),
            Some(turn) => {
                let q =
                    UnitQuaternion::from_axis_angle(&turn.axis, turn.angle.eval(t)?.to_radians());
                let shift = turn.center - q * turn.center;
                Isometry3::from_parts(Translation3::from(shift), q)
            }
        };
        Ok(Translation3::from(moved) * turned * self.placement)
    }

    /// Its functions of time.
    pub fn functions(&self) -> impl Iterator<Item = &TimeFunction> {
        let angle = self.rotation.as_ref().map(|r| &r.angle);
        self.translation.iter().chain(angle)
    }
}
