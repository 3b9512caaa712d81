//! Viscous stabilisation: what keeps a step solvable where the structure itself does not.
//!
//! Every unknown of every body feels the force `c m (u - u_committed) / dt`, `m` being the volume lumped to its node; where
//! supports move a body that they do not hold, the rigid motion that they prescribe is left out of `u`. In
//! an equilibrium that stands still the force is nothing; where a structure snaps, or a body moves freely until it
//! touches, it takes up what nothing else does. It is a backward Euler step of a structure in a viscous medium: the energy
//! that it takes is dissipated, never stored.
//!
//! The coefficient has to be small beside what holds a structure at rest and large beside nothing at all, so it is
//! measured by the softest way in which a body deforms. A body of modulus E, size L and mean thickness h bends under
//! forces per volume of `E (h / L)^2 u / L^2` (a compact body, h about L, is only sheared: the same number). Hence
//!
//! `c = factor * T * min over bodies of E (h / L)^2 / L^2`   (force time / length^4),
//!
//! with T the end time: a motion evenly spread over the run meets forces of about `factor` times those that bend the
//! softest body as far, and a snap takes a time of about `factor * T`. A scale of `E / L^2` would be `(L / h)^2` times too
//! stiff for a shell.
//!
//! Where the program itself asks for it, only bodies that contact has to hold feel it, and a step in which it carries anything is
//! solved again with next to nothing of it: contact holds the body by then, or the step stays as it was.
use super::error::{number, text};
use super::free_motion::FreeMotion;
use super::{BodyModel, Model, ModelError, penalty};
use crate::mesh::ElementKind;
use crate::scene::{Scene, Stabilization, VISCOUS_FACTOR};
use covact_geometry::Vec3;
use nalgebra::{Matrix3, SymmetricEigen};

/// Part of the depth of the masters that a free body moves in one iteration at most: no point may pass a surface unseen.
const STRIDE: f64 = 0.5;
/// Part of its own size that it moves at most: an increment that turns a body farther inflates it.
const TURN: f64 = 0.25;
/// Sizes of the model that a free body may move before it has run away.
const FAR: f64 = 10.0;
/// Part of the forces that the stabilisation may be before the answer rests on it.
pub const RESTS: f64 = 0.01;
/// Parts of the forces between which a step is solved again with [`RELEASED`] of it. Where it is more, nothing else holds the body
/// yet.
pub const RELEASES: [f64; 2] = [1e-3, 0.5];
/// What is left of the coefficient then.
pub const RELEASED: f64 = 1e-4;
/// Part of the strain energy that it may dissipate without a word.
pub const DISSIPATES: f64 = 0.05;

/// Stabilisation of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilizationModel {
    /// The coefficient `c` (force time / length^4).
    pub coefficient: f64,
    /// Steps that start at this time or later are not stabilised.
    pub until: f64,
    /// Whether the run releases it in steps in which contact holds what it was to hold.
    pub released: bool,
    /// `c m` of every degree of freedom (force time / length); zero where it is no unknown of a body.
    pub weights: Vec<f64>,
    /// What only contact and the stabilisation hold.
    pub free: Vec<FreePiece>,
    /// Diagonal of the box around all bodies (length).
    pub size: f64,
}

/// A connected piece of a body that its supports do not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct FreePiece {
    pub motion: FreeMotion,
    /// Longest way of one of its nodes in one iteration (length).
    pub stride: f64,
}

/// Sizes of a body that tell how softly it bends.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bending {
    /// Length of the bar with the largest second moment of the body about its centroid per volume.
    length: f64,
    /// Mean thickness, twice the volume by the surface.
    thickness: f64,
}

impl Bending {
    /// `(h / L)^2 / L^2`.
    fn softness(&self) -> f64 {
        (self.thickness / self.length / self.length).powi(2)
    }
}

/// What helps where a body is not held and nothing stabilises it.
pub(super) fn not_held(small: bool) -> &'static str {
    match small {
        true => {
            "add or extend a support until the body is held, or leave `kinematics` to its default, `large`, where contact is to hold it: \
             small displacements have no stabilisation"
        }
        false => {
            "add or extend a support until the body is held, or leave `solution.stabilization` to its default where contact is to hold \
             it: contact and loads alone do not hold it before it touches"
        }
    }
}

/// The stabilisation that a scene asks for; `free` are the motions that no support hinders.
///
/// # Errors
/// A body that can move freely and that no contact could stop.
pub fn stabilization(
    scene: &Scene,
    model: &Model,
    free: Vec<FreeMotion>,
) -> Result<Option<(StabilizationModel, String)>, ModelError> {
    let (factor, until, only_free) = match scene.solution.stabilization {
        Stabilization::None => return Ok(None),
        Stabilization::Auto if free.is_empty() => return Ok(None),
        Stabilization::Auto => (VISCOUS_FACTOR, None, true),
        Stabilization::Viscous { factor, until } => (factor, until, false),
    };
    let mut weights = vec![0.0; 3 * model.nodes.len()];
    let mut softest: Option<(f64, &BodyModel, f64, Bending)> = None;
    for body in &model.bodies {
        if only_free && !free.iter().any(|f| f.body == body.name) {
            continue;
        }
        let volumes = volumes(body);
        let first = 3 * body.first_node as usize;
        for (n, v) in volumes.iter().enumerate() {
            weights[first + 3 * n..first + 3 * n + 3].fill(*v);
        }
        let (e, bending) = (penalty::modulus(&body.material), bending(body, &volumes));
        let stiffness = e * bending.softness();
        if softest.as_ref().is_none_or(|s| stiffness < s.0) {
            softest = Some((stiffness, body, e, bending));
        }
    }
    let Some((stiffness, body, e, bending)) = softest else {
        return Ok(None);
    };
    let coefficient = factor * scene.solution.end_time * stiffness;
    weights.iter_mut().for_each(|w| *w *= coefficient);
    for dof in model.dofs.removed() {
        weights[dof as usize] = 0.0;
    }
    let free = (free.into_iter())
        .map(|motion| piece(model, motion))
        .collect::<Result<_, _>>()?;
    let note = format!(
        "stabilization: every unknown of {} feels a viscous force of {} (force time / length^4) times its volume and \
         velocity, {} of what bends body `{}` as far in the time of the run (E {}, {} long, {} thick){}",
        match only_free {
            true => "a body that contact has to hold",
            false => "a body",
        },
        number(coefficient),
        number(factor),
        body.name,
        number(e),
        number(bending.length),
        number(bending.thickness),
        until.map_or_else(String::new, |t| format!(", until time {}", number(t)))
    );
    let stabilization = StabilizationModel {
        coefficient,
        until: until.unwrap_or(f64::INFINITY),
        released: only_free,
        weights,
        free,
        size: size(model.nodes[..model.body_nodes()].iter()),
    };
    Ok(Some((stabilization, note)))
}

/// The piece that moves, if a contact can stop it.
fn piece(model: &Model, motion: FreeMotion) -> Result<FreePiece, ModelError> {
    let body = (model.bodies.iter()).position(|b| b.name == motion.body);
    let meets = (model.pairs.iter())
        .filter(|p| Some(p.body) == body || p.body_master().is_some_and(|m| Some(m.body) == body))
        // The surface itself says how far a body may go past it, not its rims.
        .filter(|p| !model.of_rims(p))
        // Contacts that do not act in a stage have none.
        .filter(|p| !p.points.is_empty());
    let depth = meets
        .map(|p| p.master.depth(model))
        .fold(f64::INFINITY, f64::min);
    if depth == f64::INFINITY {
        let message = format!(
            "body `{}` can move freely {}: no support hinders it, and it takes part in no contact that could stop it",
            motion.body, motion.motion
        );
        let help = "add a support or a contact";
        return Err(text(format!("/bodies/{}", motion.body), message).help(help));
    }
    let nodes = motion.nodes.iter().map(|n| &model.nodes[*n as usize]);
    let stride = (STRIDE * depth).min(TURN * size(nodes));
    Ok(FreePiece { motion, stride })
}

/// Volume of every node of a body: each element's shared among its nodes, evenly for eight nodes, as Simpson's rule in the
/// plane for eighteen.
fn volumes(body: &BodyModel) -> Vec<f64> {
    let mesh = &body.mesh;
    if let Some(sheet) = body.block.sheet() {
        let areas = sheet.tributary_areas();
        return areas.into_iter().map(|a| a * sheet.thickness).collect();
    }
    let mut out = vec![0.0; mesh.nodes.len()];
    for e in 0..mesh.elements() {
        let volume = mesh.element_volume(e);
        for (i, &n) in mesh.element(e).iter().enumerate() {
            let share = match mesh.kind {
                ElementKind::H8 | ElementKind::Nurbs => 0.125,
                ElementKind::Q18 => {
                    let simpson = |k: usize| if k == 1 { 4.0 } else { 1.0 };
                    simpson(i % 3) * simpson(i % 9 / 3) / 72.0
                }
            };
            out[n as usize] += share * volume;
        }
    }
    out
}

/// What an element around a node resists with, `E V^(1/3)` for the volume V of the node (force / length), for every degree of
/// freedom of the bodies; zero where none is unknown.
pub fn local_stiffness(model: &Model) -> Vec<f64> {
    let mut out = vec![0.0; 3 * model.body_nodes()];
    for body in &model.bodies {
        let e = penalty::modulus(&body.material);
        let first = 3 * body.first_node as usize;
        for (n, v) in volumes(body).into_iter().enumerate() {
            out[first + 3 * n..first + 3 * n + 3].fill(e * v.cbrt());
        }
    }
    for dof in model.dofs.removed() {
        if let Some(weight) = out.get_mut(dof as usize) {
            *weight = 0.0;
        }
    }
    out
}

fn bending(body: &BodyModel, volumes: &[f64]) -> Bending {
    let mesh = &body.mesh;
    let total: f64 = volumes.iter().sum();
    let mean = (mesh.nodes.iter().zip(volumes)).fold(Vec3::zeros(), |s, (x, v)| s + x * *v) / total;
    let moment = (mesh.nodes.iter().zip(volumes)).fold(Matrix3::zeros(), |s, (x, v)| {
        let r = x - mean;
        s + r * r.transpose() * *v
    }) / total;
    let surface: f64 = (mesh.outer_faces().into_iter())
        .map(|f| mesh.face_area_normal(f).0)
        .sum();
    Bending {
        length: (12.0 * SymmetricEigen::new(moment).eigenvalues.max()).sqrt(),
        thickness: match body.block.sheet() {
            Some(sheet) => sheet.thickness,
            None => 2.0 * total / surface,
        },
    }
}

/// Diagonal of the box around nodes.
fn size<'a>(nodes: impl Iterator<Item = &'a Vec3>) -> f64 {
    let start = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let (low, high) = nodes.fold(start, |(low, high), x| (low.inf(x), high.sup(x)));
    (high - low).norm()
}

impl StabilizationModel {
    /// Whether a step that starts at this time is stabilised.
    pub fn acts(&self, start: f64) -> bool {
        start < self.until
    }

    /// The largest part of an increment, at most all of it, with which no node of a free piece goes farther than it may, and
    /// the piece that it holds back.
    pub fn stride(&self, du: &[f64]) -> (f64, Option<&FreePiece>) {
        self.part(|n| at(du, n))
    }

    /// Whether a node of a free piece goes farther than in one iteration.
    pub fn leaps(&self, from: &[f64], to: &[f64]) -> bool {
        self.part(|n| at(to, n) - at(from, n)).1.is_some()
    }

    fn part(&self, way: impl Fn(u32) -> Vec3) -> (f64, Option<&FreePiece>) {
        let mut least = (1.0, None);
        for piece in &self.free {
            let ways = piece.motion.nodes.iter().map(|n| way(*n).norm());
            let longest = ways.fold(0.0, f64::max);
            if longest * least.0 > piece.stride {
                least = (piece.stride / longest, Some(piece));
            }
        }
        least
    }

    /// A free piece that has moved farther from where it started than anything could be that it is meant to meet.
    pub fn run_away(&self, u: &[f64]) -> Option<(&FreePiece, Vec3)> {
        self.free.iter().find_map(|piece| {
            let nodes = &piece.motion.nodes;
            let sum = (nodes.iter()).fold(Vec3::zeros(), |s, n| s + at(u, *n));
            let mean = sum / nodes.len() as f64;
            (mean.norm() > FAR * self.size).then_some((piece, mean))
        })
    }
}

fn at(u: &[f64], node: u32) -> Vec3 {
    let first = 3 * node as usize;
    Vec3::new(u[first], u[first + 1], u[first + 2])
}
