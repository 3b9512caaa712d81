//! Rigid surfaces driven by force: chosen components of their motion are unknowns.
//!
//! A driven surface has two nodes of the system of its own, after those of all bodies: one whose three degrees of
//! freedom are the translation, and one for the rotation. The latter holds the rotation vector times a length, the lever,
//! so that all unknowns are lengths and all residuals forces, whatever the units. Components that are not named stay
//! zero, as prescribed degrees of freedom. The present position is
//!
//! ```text
//! pose(t) = translation(u) * rotation(exp(theta) about the centre moved by the prescribed motion) * prescribed pose(t)
//! ```
pub mod press;
pub mod start;
pub mod turn;

use super::error::{At, number, text};
use super::motion::Motion;
use super::{Model, ModelError, SurfaceModel};
use crate::scene::{self, TIME, TimeFunction, ValueError};
use covact_geometry::Vec3;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion};

/// The free part of a surface's motion.
#[derive(Debug, Clone)]
pub struct Driven {
    /// Centre in the surface's own coordinates.
    pub center: Vec3,
    /// Length by which rotation vectors are multiplied: from the centre to the farthest corner of the surface's box.
    pub lever: f64,
    /// Node of the system that holds the translation; the next one holds the rotation.
    pub node: u32,
    /// Force along each free translation, then moment about each free rotation; `None` is not free.
    pub loads: [Option<TimeFunction>; 6],
    /// Degrees of freedom before the first step: moved until the surface first touches.
    pub start: [f64; 6],
    /// Friction alone works against what drives it, as against a pulley: nothing is pressed however it turns.
    pub by_friction: bool,
}

/// What the six components are called.
const WORDS: [&str; 6] = [
    "along x", "along y", "along z", "about x", "about y", "about z",
];

impl Driven {
    /// Compiles the scene's free motion for a surface whose first own node has the number `node`.
    ///
    /// # Errors
    /// [`ModelError`] for values that do not compile and surfaces without extent.
    pub fn new(
        name: &str,
        free: &scene::FreeMotion,
        motion: &Motion,
        bounds: [Vec3; 2],
        node: u32,
    ) -> Result<Self, ModelError> {
        let pointer = |field: &str| format!("/surfaces/{name}/motion/free{field}");
        let mut loads: [Option<TimeFunction>; 6] = Default::default();
        for (first, quantity, components) in
            [(0, "force", &free.force), (3, "moment", &free.moment)]
        {
            for (i, (axis, value)) in components.axes().into_iter().enumerate() {
                loads[first + i] = (value.map(|v| v.compile(&TIME)).transpose())
                    .at(|| pointer(&format!("/{quantity}/{axis}")))?;
            }
        }
        let placed = motion.pose(0.0).at(|| pointer(""))?;
        let center = match free.center {
            Some(c) => placed.inverse_transform_point(&Point3::from(c)).coords,
            None => (bounds[0] + bounds[1]) * 0.5,
        };
        let lever = (0..8)
            .map(|corner| {
                let at = Vec3::from_fn(|c, _| bounds[corner >> c & 1][c]);
                (at - center).norm()
            })
            .fold(0.0, f64::max);
        if !(lever > 0.0 && lever.is_finite()) {
            return Err(text(pointer(""), format!("surface `{name}` has no extent")));
        }
        Ok(Driven {
            center,
            lever,
            node,
            loads,
            start: [0.0; 6],
            by_friction: false,
        })
    }

    /// Number of a degree of freedom in the system: three translations, three rotations.
    pub fn dof(&self, component: usize) -> usize {
        3 * self.node as usize + component
    }

    /// The node of the translation and that of the rotation.
    pub fn nodes(&self) -> [u32; 2] {
        [self.node, self.node + 1]
    }

    /// Which of the six components are unknowns.
    pub fn free(&self) -> [bool; 6] {
        std::array::from_fn(|c| self.loads[c].is_some())
    }

    /// Translation and rotation vector in displacements of the system.
    pub fn motion(&self, u: &[f64]) -> (Vec3, Vec3) {
        let at = self.dof(0);
        let part = |i: usize| Vec3::from_column_slice(&u[at + i..at + i + 3]);
        (part(0), part(3) / self.lever)
    }

    /// The pose that a prescribed one becomes by a translation and a rotation vector.
    pub fn pose(&self, prescribed: &Isometry3<f64>, moved: &Vec3, theta: &Vec3) -> Isometry3<f64> {
        let center = (prescribed * Point3::from(self.center)).coords;
        let q = UnitQuaternion::from_scaled_axis(*theta);
        Isometry3::from_parts(Translation3::from(center - q * center + moved), q) * prescribed
    }

    /// Given force and moment at time `t`, zero where the component is not free.
    pub fn given(&self, t: f64) -> Result<(Vec3, Vec3), ValueError> {
        let mut given = [0.0; 6];
        for (g, load) in given.iter_mut().zip(&self.loads) {
            if let Some(load) = load {
                *g = load.eval(t)?;
            }
        }
        let [fx, fy, fz, mx, my, mz] = given;
        Ok((Vec3::new(fx, fy, fz), Vec3::new(mx, my, mz)))
    }

    /// Generalised forces on the six degrees of freedom: the force, and the moment by the lever.
    pub fn driving(&self, t: f64, u: &[f64]) -> Result<[f64; 6], ValueError> {
        let (force, moment) = self.given(t)?;
        let (_, theta) = self.motion(u);
        let moment = turn::spin_of(&theta).tr_mul(&moment) / self.lever;
        let all = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
        let free = self.free();
        Ok(std::array::from_fn(|c| if free[c] { all[c] } else { 0.0 }))
    }

    /// Whether no force and no moment acts on what is free at time `t`.
    pub fn idle(&self, t: f64, u: &[f64]) -> Result<bool, ValueError> {
        Ok(self.driving(t, u)?.iter().all(|f| *f == 0.0))
    }

    /// The free components in words, e.g. `along z and about y`.
    pub fn words(&self) -> String {
        let free = self.free();
        join((0..6).filter(|&c| free[c]).map(|c| WORDS[c].to_owned()))
    }

    /// A direction among the six degrees of freedom in words.
    pub fn direction_words(&self, direction: &[f64; 6]) -> String {
        let largest = direction.iter().fold(0.0f64, |a, d| a.max(d.abs()));
        join(
            (0..6)
                .filter(|&c| direction[c].abs() > 1e-3 * largest)
                .map(|c| WORDS[c].to_owned()),
        )
    }

    /// The first direction of a start in words: displacement, or angle.
    fn start_words(&self) -> String {
        let [x, y, z, a, b, c] = self.start;
        let (moved, turned) = (Vec3::new(x, y, z), Vec3::new(a, b, c) / self.lever);
        let vector = |v: Vec3| format!("({}, {}, {})", number(v.x), number(v.y), number(v.z));
        if turned.norm() > 0.0 {
            return format!(
                "turned by {} degrees",
                vector(turned * 180.0 / std::f64::consts::PI)
            );
        }
        format!("moved by {}", vector(moved))
    }
}

fn join(words: impl Iterator<Item = String>) -> String {
    let words: Vec<String> = words.collect();
    match words.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, before)) => format!("{} and {last}", before.join(", ")),
        None => String::new(),
    }
}

impl SurfaceModel {
    /// From the surface's own coordinates to space, at time `t` and displacements `u` of the system.
    pub fn pose(&self, t: f64, u: &[f64]) -> Result<Isometry3<f64>, ValueError> {
        let prescribed = self.motion.pose(t)?;
        let Some(driven) = &self.driven else {
            return Ok(prescribed);
        };
        let (moved, theta) = driven.motion(u);
        Ok(driven.pose(&prescribed, &moved, &theta))
    }

    /// Present position of the centre of a driven surface; the origin for others.
    pub fn center(&self, t: f64, u: &[f64]) -> Result<Vec3, ValueError> {
        let Some(driven) = &self.driven else {
            return Ok(Vec3::zeros());
        };
        let prescribed = self.motion.pose(t)?;
        Ok((prescribed * Point3::from(driven.center)).coords + driven.motion(u).0)
    }
}
