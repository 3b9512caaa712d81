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
    back: Option<WayBack>,
}

/// From the time `from` on the motion is run back, evenly until `to`, and the surface then stays where it was at time 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WayBack {
    pub from: f64,
    pub to: f64,
}

impl WayBack {
    /// The time whose place the surface has at time `t`.
    fn of(&self, t: f64) -> f64 {
        match t <= self.from {
            true => t,
            false => self.from * ((self.to - t) / (self.to - self.from)).max(0.0),
        }
    }

    /// The time at which the surface has the place of `t` once more.
    fn again(&self, t: f64) -> f64 {
        self.to - t / self.from * (self.to - self.from)
    }
}

#[derive(Debug, Clone)]
struct Turn {
    center: Vec3,
    axis: Unit<Vec3>,
    /// Degrees.
    angle: TimeFunction,
}

/// A displacement of a rigid surface that is small: `shift + spin x (X - center)` of what was at X at time 0.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SmallMotion {
    pub shift: Vec3,
    /// Rotation vector (radians).
    pub spin: Vec3,
    pub center: Vec3,
}

impl SmallMotion {
    /// Displacement of what was at `x` at time 0.
    #[inline]
    pub fn at(&self, x: &Vec3) -> Vec3 {
        self.shift + self.spin.cross(&(x - self.center))
    }
}

/// Rotation about an axis through the origin by an angle in degrees; a zero axis turns nothing.
pub fn rotation(axis: [f64; 3], degrees: f64) -> UnitQuaternion<f64> {
    match Unit::try_new(Vec3::from(axis), 0.0) {
        Some(axis) => UnitQuaternion::from_axis_angle(&axis, degrees.to_radians()),
        None => UnitQuaternion::identity(),
    }
}

/// Rotation and translation of a placement; its scale is for the caller to apply first.
pub fn pose(placement: &scene::Placement) -> Isometry3<f64> {
    let rotation = rotation(placement.axis, placement.angle);
    let center = Vec3::from(placement.center);
    let shift = Vec3::from(placement.translation) + (center - rotation * center);
    Isometry3::from_parts(Translation3::from(shift), rotation)
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
            placement: pose(placement),
            translation: [compile(x)?, compile(y)?, compile(z)?],
            rotation,
            back: None,
        })
    }

    /// Runs the motion back from a time on.
    pub fn go_back(&mut self, back: WayBack) {
        self.back = Some(back);
    }

    /// The time that its functions are evaluated at.
    #[inline]
    fn clock(&self, t: f64) -> f64 {
        self.back.map_or(t, |back| back.of(t))
    }

    /// Times at which it has a kink on its way back.
    pub fn kinks_back(&self) -> Vec<f64> {
        let Some(back) = self.back else {
            return Vec::new();
        };
        let rows = self.functions().flat_map(TimeFunction::breakpoints);
        let passed = rows.filter(|t| *t > 0.0 && *t < back.from);
        let again = passed.map(|t| back.again(t));
        again.chain([back.from, back.to]).collect()
    }

    /// From the surface's own coordinates to space at time `t`.
    pub fn pose(&self, t: f64) -> Result<Isometry3<f64>, ValueError> {
        let t = self.clock(t);
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

    /// Displacement since time 0, taken to first order in the turn.
    pub fn small(&self, t: f64) -> Result<SmallMotion, ValueError> {
        let moved = |t: f64| {
            let [x, y, z] = &self.translation;
            Ok::<_, ValueError>(Vec3::new(x.eval(t)?, y.eval(t)?, z.eval(t)?))
        };
        let start = moved(0.0)?;
        let (spin, center) = match &self.rotation {
            None => (Vec3::zeros(), Vec3::zeros()),
            Some(turn) => {
                let angle = turn.angle.eval(t)? - turn.angle.eval(0.0)?;
                (turn.axis.scale(angle.to_radians()), turn.center + start)
            }
        };
        Ok(SmallMotion {
            shift: moved(t)? - start,
            spin,
            center,
        })
    }

    /// Prescribed turn from time `start` to `end` (degrees).
    pub fn turn(&self, start: f64, end: f64) -> Result<f64, ValueError> {
        let Some(turn) = &self.rotation else {
            return Ok(0.0);
        };
        let [start, end] = [start, end].map(|t| self.clock(t));
        Ok(turn.angle.eval(end)? - turn.angle.eval(start)?)
    }

    /// Whether it ever leaves the placement.
    pub fn moves(&self) -> bool {
        self.functions().any(|f| f.as_constant() != Some(0.0))
    }

    /// Prescribed translation at a time, and the angle of the prescribed rotation (degrees) where there is one.
    pub fn way(&self, t: f64) -> Result<(Vec3, Option<f64>), ValueError> {
        let t = self.clock(t);
        let [x, y, z] = &self.translation;
        let angle = self.rotation.as_ref().map(|turn| turn.angle.eval(t));
        Ok((
            Vec3::new(x.eval(t)?, y.eval(t)?, z.eval(t)?),
            angle.transpose()?,
        ))
    }

    /// A turn about the axis of the prescribed rotation, in the surface's own coordinates; none where none is prescribed.
    pub fn turned(&self, degrees: f64) -> Option<Isometry3<f64>> {
        let turn = self.rotation.as_ref()?;
        let q = UnitQuaternion::from_axis_angle(&turn.axis, degrees.to_radians());
        let shift = turn.center - q * turn.center;
        let turned = Isometry3::from_parts(Translation3::from(shift), q);
        Some(self.placement.inverse() * turned * self.placement)
    }

    /// Whether a rotation is prescribed.
    pub fn turns(&self) -> bool {
        self.rotation.is_some()
    }

    /// Its functions of time.
    pub fn functions(&self) -> impl Iterator<Item = &TimeFunction> {
        let angle = self.rotation.as_ref().map(|r| &r.angle);
        self.translation.iter().chain(angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn run_back_it_meets_its_places_again() {
        let text = |t: &str| scene::Value::Expression(t.to_owned());
        let motion = scene::Motion {
            translation: [text("3*t*t"), text("0"), text("-t")],
            ..scene::Motion::default()
        };
        let forth = Motion::new(&motion, &scene::Placement::default()).unwrap();
        let mut back = forth.clone();
        back.go_back(WayBack { from: 0.8, to: 1.2 });
        let place = |m: &Motion, t: f64| m.pose(t).unwrap().translation.vector;
        // Twice as fast as it came.
        for (t, as_at) in [
            (0.3, 0.3),
            (0.8, 0.8),
            (0.9, 0.6),
            (1.0, 0.4),
            (1.2, 0.0),
            (1.5, 0.0),
        ] {
            let apart = (place(&back, t) - place(&forth, as_at)).norm();
            assert!(apart < 1e-14, "at {t}: {apart}");
        }
        assert!(place(&back, 1.0).norm() > 0.1);
    }

    #[test]
    fn placed_then_turned_about_its_centre_then_moved() {
        let motion = scene::Motion {
            translation: [
                scene::Value::Number(0.0),
                scene::Value::Expression("2*t".to_owned()),
                scene::Value::Table {
                    table: vec![[0.0, 0.0], [1.0, -4.0]],
                },
            ],
            free: None,
            rotation: Some(scene::Rotation {
                center: [1.0, 0.0, 0.0],
                axis: [0.0, 0.0, 3.0],
                angle: scene::Value::Expression("90*t".to_owned()),
            }),
        };
        let placement = scene::Placement {
            axis: [1.0, 0.0, 0.0],
            angle: 90.0,
            translation: [1.0, 0.0, 0.0],
            ..scene::Placement::default()
        };
        let motion = Motion::new(&motion, &placement).unwrap();
        // Placed: (1, 2, 0) -> (1, 0, 2) -> (2, 0, 2). Turned by 90 degrees about (1, 0, .): (1, 1, 2). Moved: (1, 3, -2).
        for (t, expected) in [(0.0, [2.0, 0.0, 2.0]), (1.0, [1.0, 3.0, -2.0])] {
            let at = motion.pose(t).unwrap() * Point3::new(1.0, 2.0, 0.0);
            assert!((at.coords - Vec3::from(expected)).norm() < 1e-14, "{at}");
        }
    }
}
