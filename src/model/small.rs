//! Contact for small displacements: every slave point is projected once, where it starts, and keeps normal and foot.
//!
//! The gap of a point is `g = g_0 + n . (u_s - u_m)`: `n` and `g_0` are normal and gap at the start, `u_s` is the displacement
//! of the point, `u_m` that of the material point of the master at the foot (of a rigid surface its motion to first order, of a
//! body `sum N_k u_k` of the face there). The contact stiffness `eps_n A n (x) n` then depends on nothing but which points
//! are in contact. It is the limit of the covariant form for displacements that are small against radii of curvature,
//! distances to edges and elements; on edges and vertices `n` is the direction of the distance.
mod friction;

use super::error::{At, number};
use super::master::{BodyMaster, Master};
use super::motion::SmallMotion;
use super::{Model, ModelError, PairModel};
use crate::contact::points::SlavePoint;
use crate::contact::{moving, rigid};
use crate::scene::{Kinematics, Scene, ValueError};
use covact_geometry::moving::{MovingFoot, MovingPlace};
use covact_geometry::{EdgeKind, Foot, Hint, Location, ShapeRows, Status, Vec3};
use nalgebra::UnitQuaternion;
use rayon::prelude::*;

/// Distance from an edge below which the direction of the distance gives way to the pseudo-normal, relative to the size of
/// the slave's elements.
const ON_EDGE: f64 = 1e-9;

/// Contact of all pairs, linearised.
#[derive(Debug)]
pub struct SmallModel {
    /// Per pair of the model.
    pub pairs: Vec<SmallPair>,
}

/// The points of a pair where they start.
#[derive(Debug)]
pub struct SmallPair {
    /// Per slave point; none where nothing of the master is in front of it: it stays open.
    pub points: Vec<Option<SmallPoint>>,
    /// Where the nodes of the master's faces begin for each point, and one more; empty for a rigid master.
    starts: Vec<u32>,
    /// Nodes of the model, and their shape functions at the foot.
    master: Vec<(u32, f64)>,
    /// For each of them what its displacement along the normal moves a point away along the surface ([`SmallPair::slip`]); empty
    /// without friction, and for a rigid master.
    arms: Vec<Vec3>,
}

/// A slave point and its foot at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmallPoint {
    /// Unit normal, from the master to the slave.
    pub normal: Vec3,
    /// Normal coordinate at the start (length).
    pub gap: f64,
    /// The foot in space.
    pub foot: Vec3,
    /// Where the foot is on the master.
    pub hint: Hint,
    /// The normal is the direction of the distance from an edge or a vertex.
    pub line: bool,
}

impl SmallPair {
    /// Nodes of the master's face at the foot of a point, with their shape functions; none of a rigid master.
    #[inline]
    pub fn master(&self, point: usize) -> &[(u32, f64)] {
        match self.starts.get(point..point + 2) {
            Some(range) => &self.master[range[0] as usize..range[1] as usize],
            None => &[],
        }
    }

    /// Points with the facets at their feet, of a master that is a body.
    pub fn feet(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        (self.points.iter().enumerate()).filter_map(|(i, p)| Some((i, p.as_ref()?.hint.patch)))
    }

    /// `n . (u_s - u_m)` of a point (length); `p` is the slave point, `motion` that of a rigid master.
    #[inline]
    pub fn approach(
        &self,
        point: usize,
        at: &SmallPoint,
        p: &SlavePoint,
        motion: Option<&SmallMotion>,
        u: &[f64],
    ) -> f64 {
        at.normal.dot(&self.relative(point, at, p, motion, u))
    }

    /// Length of `u_s - u_m`, and [`Self::approach`].
    pub fn way(
        &self,
        point: usize,
        at: &SmallPoint,
        p: &SlavePoint,
        motion: Option<&SmallMotion>,
        u: &[f64],
    ) -> (f64, f64) {
        let relative = self.relative(point, at, p, motion, u);
        (relative.norm(), at.normal.dot(&relative))
    }

    #[inline]
    fn relative(
        &self,
        point: usize,
        at: &SmallPoint,
        p: &SlavePoint,
        motion: Option<&SmallMotion>,
        u: &[f64],
    ) -> Vec3 {
        let master = match motion {
            Some(motion) => motion.at(&at.foot),
            None => (self.master(point).iter())
                .fold(Vec3::zeros(), |sum, &(n, w)| sum + moved(n as usize, u) * w),
        };
        slave_moved(p, u) - master
    }
}

/// Displacement of a node (length).
fn moved(node: usize, u: &[f64]) -> Vec3 {
    Vec3::new(u[3 * node], u[3 * node + 1], u[3 * node + 2])
}

/// Displacement of a slave point (length).
fn slave_moved(p: &SlavePoint, u: &[f64]) -> Vec3 {
    (p.terms()).fold(Vec3::zeros(), |sum, (n, w)| sum + moved(n, u) * w)
}

impl Model {
    /// Motion of a pair's master since the start, to first order; none of a body.
    ///
    /// # Errors
    /// A motion without a value at `time`.
    pub fn small_motion(
        &self,
        pair: &PairModel,
        time: f64,
    ) -> Result<Option<SmallMotion>, ValueError> {
        match pair.rigid_master() {
            None => Ok(None),
            Some(surface) => self.surfaces[surface].motion.small(time).map(Some),
        }
    }
}

impl Model {
    /// How the coordinates of a pair's master are turned at the start; not at all of a body.
    ///
    /// # Errors
    /// A motion without a value then.
    pub fn small_pose(&self, pair: &PairModel) -> Result<UnitQuaternion<f64>, ValueError> {
        match pair.rigid_master() {
            None => Ok(UnitQuaternion::identity()),
            Some(surface) => Ok(self.surfaces[surface].motion.pose(0.0)?.rotation),
        }
    }
}

/// Projects all slave points where the scene declares displacements small; nothing where it does not.
///
/// # Errors
/// A motion of a surface without a value at the start.
pub(super) fn linearise(
    scene: &Scene,
    model: &mut Model,
) -> Result<Option<SmallModel>, ModelError> {
    if scene.solution.kinematics != Kinematics::Small {
        return Ok(None);
    }
    let (mut pairs, mut notes) = (Vec::new(), Vec::new());
    for pair in &model.pairs {
        let (small, uncertain) = start(model, pair)?;
        let without = small.points.iter().filter(|p| p.is_none()).count();
        notes.push(format!(
            "contact `{}`: linearised at the start: normals and feet of {} points stay what they are there{}",
            pair.name,
            small.points.len() - without,
            match without {
                0 => String::new(),
                n => format!("; {n} have no foot on {} and stay open", pair.master_words(model)),
            }
        ));
        if let Some(x) = uncertain {
            model.warnings.push(format!(
                "contact `{}`: the closest point of {} is not certain for a slave point near ({}, {}, {}), and maybe others: \
                 with small displacements they stay open",
                pair.name,
                pair.master_words(model),
                number(x.x),
                number(x.y),
                number(x.z)
            ));
        }
        pairs.push(small);
    }
    if !model.follower_loads.is_empty() {
        notes.push(
            "small displacements: follower pressures act on the undeformed faces, as dead loads"
                .to_owned(),
        );
    }
    notes.push(
        "small displacements: linear elements with Hooke's law, factorized once for every change of the points in contact"
            .to_owned(),
    );
    model.notes.extend(notes);
    Ok(Some(SmallModel { pairs }))
}

/// The points of a pair at the start, and where one is whose foot is not certain.
fn start(model: &Model, pair: &PairModel) -> Result<(SmallPair, Option<Vec3>), ModelError> {
    let zero = vec![0.0; 3 * model.nodes.len()];
    let position = |p: &SlavePoint| model.point_position(p, &zero);
    let small = ON_EDGE * pair.element_size;
    let found: Vec<Result<Option<SmallPoint>, Vec3>> = match &pair.master {
        Master::Rigid(surface) => {
            let surface = &model.surfaces[*surface];
            let master =
                (surface.at(0.0, &zero)).at(|| format!("/surfaces/{}/motion", surface.name))?;
            let point = |p: &SlavePoint| {
                let x = position(p);
                let Some(foot) = master.foot(&x, None, f64::INFINITY) else {
                    return Ok(None);
                };
                if foot.status == Status::NotConverged {
                    return Err(x);
                }
                if rigid::free(&foot) || rigid::behind(&foot, master.depth) {
                    return Ok(None);
                }
                let at = (master.pose * nalgebra::Point3::from(foot.jet.rho)).coords;
                let normal = master.pose.rotation * foot.normal;
                let gap = foot.signed_distance;
                let line = on_line(&foot) && foot.distance > small;
                Ok(Some(SmallPoint {
                    normal: if line { (x - at) / gap } else { normal },
                    gap,
                    foot: at,
                    hint: foot.hint(),
                    line,
                }))
            };
            pair.points.par_iter().map(point).collect()
        }
        Master::Body(master) => (pair.points.par_iter())
            .map(|p| on_body(master, &position(p), small))
            .collect(),
    };
    let mut uncertain = None;
    let mut out = SmallPair {
        points: Vec::with_capacity(found.len()),
        starts: Vec::new(),
        master: Vec::new(),
        arms: Vec::new(),
    };
    for point in found {
        out.points.push(point.unwrap_or_else(|x| {
            uncertain = Some(x);
            None
        }));
    }
    if let Master::Body(master) = &pair.master {
        let mut rows = ShapeRows::default();
        out.starts.push(0);
        for point in &out.points {
            if let Some(at) = point {
                master.facets.shape(at.hint.patch, at.hint.xi, &mut rows);
                let nodes = master.facets.nodes(at.hint.patch).iter().copied();
                out.master.extend(nodes.zip(rows.n));
                if pair.friction.is_some() {
                    friction::arms(master, at, &rows, &mut out.arms);
                }
            }
            out.starts.push(out.master.len() as u32);
        }
    }
    Ok((out, uncertain))
}

fn on_body(master: &BodyMaster, x: &Vec3, small: f64) -> Result<Option<SmallPoint>, Vec3> {
    let found = master.facets.project(x, None, f64::INFINITY, |_| true);
    let Some(foot) = found else {
        return Ok(None);
    };
    if foot.status == Status::NotConverged {
        return Err(*x);
    }
    if moving::free(&foot, x) || moving::behind(&foot, x, master.depth) {
        return Ok(None);
    }
    let line = moving_on_line(&foot) && foot.distance > small;
    Ok(Some(SmallPoint {
        normal: match line {
            true => (x - foot.jet.rho) / foot.signed_distance,
            false => foot.normal,
        },
        gap: foot.signed_distance,
        foot: foot.jet.rho,
        hint: foot.hint(),
        line,
    }))
}

/// Whether a foot lies where the distance has a direction of its own.
fn on_line(foot: &Foot) -> bool {
    match foot.location {
        Location::Edge { kind, .. } | Location::Corner { kind, .. } => kind == EdgeKind::Sharp,
        Location::Crease { .. } => true,
        Location::Face | Location::Pole { .. } => false,
    }
}

fn moving_on_line(foot: &MovingFoot) -> bool {
    match foot.place {
        MovingPlace::Edge { kind, .. } | MovingPlace::Corner { kind } => kind != EdgeKind::Smooth,
        MovingPlace::Face => false,
    }
}
