//! The model: what a scene becomes before anything is solved. All choices of effects are made here, once.
pub(crate) mod augmentation;
pub(crate) mod averaged;
mod both_faces;
pub mod build;
pub(crate) mod carried;
pub(crate) mod constraints;
pub(crate) mod driven;
pub mod dynamics;
pub(crate) mod edge_couple;
pub(crate) mod edges;
mod effect;
pub(crate) mod error;
mod foreign_solver;
mod found_supports;
pub(crate) mod free_motion;
pub(crate) mod friction;
pub(crate) mod grid;
pub(crate) mod histories;
pub(crate) mod initial;
pub(crate) mod kernel;
pub mod loads;
pub(crate) mod master;
pub(crate) mod motion;
pub(crate) mod overclosure;
pub(crate) mod pace;
pub(crate) mod penalty;
pub(crate) mod probe;
pub(crate) mod reach;
pub(crate) mod recut;
pub(crate) mod rims;
mod sagitta;
pub mod segments;
pub(crate) mod self_contact;
pub(crate) mod sharp;
pub(crate) mod sheet_pressure;
pub(crate) mod slave;
pub(crate) mod small;
pub(crate) mod stabilization;
pub(crate) mod stages;
pub mod state;
mod stretch;
pub mod stretched;
pub mod surface;
pub(crate) mod symmetry;
pub(crate) mod winding;

use crate::contact::lever::Lever;
use crate::contact::points::SlavePoint;
use crate::mesh::{Face, Mesh};
use crate::scene::{Material, Points, Tangent, TimeFunction, ValueError};
use crate::shell::{Block, ElementBlock};
use crate::system::DofMap;
use augmentation::AugmentationModel;
use averaged::SlaveNodes;
use constraints::{MeanPrescribed, Prescribed, Tied};
use covact_geometry::Vec3;
use driven::Driven;
use dynamics::DynamicsModel;
use friction::FrictionModel;
use loads::{DeadLoad, FollowerPressure};
use master::Master;
use overclosure::Overclosure;
use rims::RimNodes;
use sagitta::CurvedMaster;
use small::SmallModel;
use stabilization::StabilizationModel;
use stages::StageModel;
use symmetry::Unsymmetric;
use winding::LargestStep;

pub use effect::EffectKind;
pub use error::ModelError;
pub use surface::SurfaceModel;

/// Bodies, rigid surfaces, contact pairs, supports and loads, with all names resolved.
#[derive(Debug)]
pub struct Model {
    /// Title of the scene.
    pub title: String,
    /// Undeformed positions of all nodes, body after body, then those on rims of rigid surfaces, then two for every surface driven
    /// by force: its centre, and the origin for its rotation.
    pub nodes: Vec<Vec3>,
    /// Deformable bodies, sorted by their names.
    pub bodies: Vec<BodyModel>,
    /// Rigid surfaces, sorted by their names.
    pub surfaces: Vec<SurfaceModel>,
    /// Contact pairs.
    pub pairs: Vec<PairModel>,
    /// Nodes on the rims of rigid surfaces that are slaves.
    pub rims: Vec<RimNodes>,
    /// Names of the supports.
    pub supports: Vec<String>,
    /// Degrees of freedom that supports prescribe.
    pub prescribed: Vec<Prescribed>,
    /// Means of two degrees of freedom that supports at a mid-surface prescribe.
    pub means: Vec<MeanPrescribed>,
    /// Degrees of freedom that supports of sheets tie to others, with those that nothing prescribes.
    pub tied: Vec<Tied>,
    /// Loads of constant direction, with their names.
    pub dead_loads: Vec<(String, DeadLoad)>,
    /// Loads that follow the deformed faces, with their names.
    pub follower_loads: Vec<(String, FollowerPressure)>,
    /// Which degrees of freedom are unknown.
    pub dofs: DofMap,
    /// Viscous stabilisation where the scene asks for it.
    pub stabilization: Option<StabilizationModel>,
    /// Inertia where the scene asks for it.
    pub dynamics: Option<DynamicsModel>,
    /// Contact as it is linearised at the start, where the scene declares displacements small.
    pub small: Option<SmallModel>,
    /// Whether the tangent is symmetric (`symmetry::unsymmetric_effects`).
    pub symmetric: bool,
    /// What makes it unsymmetric.
    pub unsymmetric: Vec<Unsymmetric>,
    /// Choices the program made, in words.
    pub notes: Vec<String>,
    /// Things the user should look at.
    pub warnings: Vec<String>,
    /// Times at which something prescribed has a kink, ascending.
    pub kinks: Vec<f64>,
    /// Where steps are smaller for what is prescribed.
    pub largest_steps: Vec<LargestStep>,
    /// Curves that the scene asks for.
    pub probes: Vec<probe::ProbeModel>,
    /// Which part of the run it is the model of; none where the scene has no stages.
    pub stage: Option<StageModel>,
    /// Fibres of shells that supports stretch where they tilt.
    pub stretched: Vec<stretched::Stretched>,
    /// Slave points at a height above a mid-surface, by the numbers in them; none where no shell is a CAD surface.
    pub levers: Vec<Lever>,
}

/// A deformable body.
#[derive(Debug)]
pub struct BodyModel {
    /// Name in the scene.
    pub name: String,
    /// The undeformed mesh.
    pub mesh: Mesh,
    /// Its elements, set up.
    pub block: Block,
    /// The law of its elements, in the units of the scene.
    pub material: Material,
    /// Name and yield strength of a metal that the scene takes by name.
    pub metal: Option<Metal>,
    /// Number of the body's first node in the model.
    pub first_node: u32,
}

/// Name and yield strength of a metal.
pub type Metal = (&'static str, f64);

/// A contact pair.
#[derive(Debug)]
pub struct PairModel {
    /// Name of the contact in the scene.
    pub name: String,
    /// The slave faces, `body.set`.
    pub slave: String,
    /// Number of the slave body.
    pub body: usize,
    /// The slave faces.
    pub faces: Vec<Face>,
    /// The rigid surface or the faces that the points press on.
    pub master: Master,
    /// Slave points; those of integration segments as they are before anything moves ([`state::State::slaves`]).
    pub points: Vec<SlavePoint>,
    /// Where the slave faces are sampled; never left open.
    pub sampled: Points,
    /// One of the two passes of a contact whose sides are both slaves.
    pub half: Option<HalfPass>,
    /// The points are on the sharp edges of the master of this pair, and the master is its slave. Those of a rigid surface belong
    /// to no body (module `rims`): `body` is then that of the master, and there are no slave faces.
    pub edges_of: Option<usize>,
    /// All of its points that see the master at the start lie in front of it or on it, and some do.
    pub starts_in_front: bool,
    /// Penalty (force / length^3).
    pub eps_n: f64,
    /// What the run may choose the penalty by; nothing where it is given, or tractions are augmented.
    pub ruled: Option<penalty::Ruled>,
    /// Which tangent of contact is used.
    pub tangent: Tangent,
    /// Mean edge length of the slave faces.
    pub element_size: f64,
    /// Offsets of the gaps where the scene asks for them.
    pub overclosure: Option<Overclosure>,
    /// Per slave point, its normal coordinate at the start less the gap between the curved surfaces that flat facets stand for
    /// (length); empty where that changes nothing.
    pub bow: Vec<f64>,
    /// The master of such a pair, where its facets are some of them.
    pub below: Option<CurvedMaster>,
    /// Distance from the master at which contact begins (length, `>= 0`).
    pub offset: f64,
    /// Multipliers where the scene asks for them.
    pub augmentation: Option<AugmentationModel>,
    /// The slave's nodes, where gaps are averaged.
    pub averaged: Option<SlaveNodes>,
    /// Friction where the scene asks for it.
    pub friction: Option<FrictionModel>,
    /// Number of the first point among those with history before anything moves ([`state::State::history`]); none where the
    /// points have none.
    pub first_history: Option<usize>,
}

/// A pass of the two-half-pass contact (R. A. Sauer and L. De Lorenzis, "A computational contact formulation based on
/// surface potentials", Computer Methods in Applied Mechanics and Engineering 253 (2013), and "An unbiased computational
/// contact formulation for 3D friction", International Journal for Numerical Methods in Engineering 101 (2015)): each side
/// is the slave once, and a pass acts on its slave alone, with all of the traction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HalfPass {
    /// The pair of the other pass.
    pub other: usize,
    /// The second of the two passes: its slave is what the scene calls the master.
    pub back: bool,
}

impl Model {
    /// Deformed position of a node.
    #[inline]
    pub fn position(&self, node: usize, u: &[f64]) -> Vec3 {
        let u = &u[3 * node..3 * node + 3];
        self.nodes[node] + Vec3::new(u[0], u[1], u[2])
    }

    /// Deformed position of a slave point.
    pub fn point_position(&self, p: &SlavePoint, u: &[f64]) -> Vec3 {
        self.position_of(p, u)
    }

    /// [`Self::point_position`] for loops over points: the loop over nodes is none for all faces but rare ones.
    #[inline(always)]
    pub fn position_of(&self, p: &SlavePoint, u: &[f64]) -> Vec3 {
        match p.count {
            1 => self.combined(p, 1, u),
            4 => self.combined(p, 4, u),
            9 => self.combined(p, 9, u),
            0 => self.above(p, u),
            n => self.combined(p, n as usize, u),
        }
    }

    /// [`Self::position_of`] a point at a height above a mid-surface.
    #[cold]
    #[inline(never)]
    fn above(&self, p: &SlavePoint, u: &[f64]) -> Vec3 {
        self.levers[p.nodes[0] as usize].position(|n| self.position(n as usize, u))
    }

    /// Nodes with the shape functions by which values at a slave point are shared among them.
    pub fn terms<'a>(&'a self, p: &'a SlavePoint) -> impl Iterator<Item = (usize, f64)> + 'a {
        let (nodes, shape) = match p.lever_number() {
            Some(number) => {
                let lever = &self.levers[number];
                (&lever.nodes[..], &lever.n[..])
            }
            None => {
                let n = p.count as usize;
                (&p.nodes[..n], &p.shape[..n])
            }
        };
        nodes
            .iter()
            .zip(shape)
            .map(|(&node, &w)| (node as usize, w))
    }

    #[inline(always)]
    fn combined(&self, p: &SlavePoint, count: usize, u: &[f64]) -> Vec3 {
        let terms = p.nodes[..count].iter().zip(&p.shape[..count]);
        let terms = terms.map(|(node, w)| self.position(*node as usize, u) * *w);
        terms.reduce(|x, y| x + y).unwrap_or_else(Vec3::zeros)
    }

    /// Number of nodes that belong to bodies; those on rims and of driven surfaces come after them.
    pub fn body_nodes(&self) -> usize {
        self.nodes.len() - self.rim_nodes() - 2 * self.driven().count()
    }

    /// Surfaces driven by force, with their numbers.
    pub fn driven(&self) -> impl Iterator<Item = (usize, &SurfaceModel, &Driven)> {
        (self.surfaces.iter().enumerate()).filter_map(|(i, s)| Some((i, s, s.driven.as_ref()?)))
    }

    /// Whether loads or driving forces act.
    pub fn loaded(&self) -> bool {
        !self.dead_loads.is_empty()
            || !self.follower_loads.is_empty()
            || self.driven().next().is_some()
    }

    /// Whether any material flows.
    pub fn flows(&self) -> bool {
        self.bodies.iter().any(|body| body.material.flows())
    }

    /// Numbers that an element of a body keeps in a run; none of the linear elements for small displacements.
    pub fn state_len(&self, body: &BodyModel) -> usize {
        match self.small {
            None => body.block.state_len(),
            Some(_) => 0,
        }
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.dofs.dofs() - self.dofs.removed().count()
    }

    /// Number of slave points with history before anything moves.
    pub fn histories(&self) -> usize {
        let pairs = self.pairs.iter();
        pairs
            .map(|p| p.first_history.map_or(0, |_| p.carriers()))
            .sum()
    }

    /// Whether slave points with history are cut anew with every step.
    pub fn recuts_histories(&self) -> bool {
        let mut pairs = self.pairs.iter();
        pairs.any(|p| p.remembers() && p.segments().is_some())
    }

    /// Number of slave points.
    pub fn contact_points(&self) -> usize {
        self.pairs.iter().map(|p| p.points.len()).sum()
    }

    /// What supports hold: prescribed degrees of freedom first, then means of two.
    pub fn supports(&self) -> impl Iterator<Item = Support<'_>> {
        let node = |dof: u32| self.nodes[dof as usize / 3];
        let held = self.prescribed.iter().map(move |p| Support {
            dofs: [p.dof; 2],
            at: node(p.dof),
            value: p.value.as_ref(),
        });
        let means = self.means.iter().map(move |m| Support {
            dofs: [m.free, m.tied],
            at: (node(m.free) + node(m.tied)) * 0.5,
            value: m.mean.as_ref(),
        });
        held.chain(means)
    }

    /// Increments from the present displacements to what is prescribed at `time`, for prescribed degrees of freedom
    /// and those tied by mid-surface supports; returns the largest.
    pub fn increments(&self, u: &[f64], time: f64, g: &mut [f64]) -> Result<f64, ValueError> {
        g.fill(0.0);
        for support in self.supports() {
            let [free, tied] = support.dofs.map(|d| d as usize);
            // A mean is met by the second of its two.
            let both = if free == tied { 1.0 } else { 2.0 };
            g[tied] = both * support.missing(u, time)?;
        }
        let largest = g.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        self.dofs.particular(g);
        Ok(largest)
    }
}

/// The mean of two displacements that a support holds, or one displacement, which stands twice.
#[derive(Debug, Clone, Copy)]
pub struct Support<'a> {
    /// The two degrees of freedom `3 node + component`.
    pub dofs: [u32; 2],
    /// Where it is at the start.
    pub at: Vec3,
    value: Option<&'a TimeFunction>,
}

impl Support<'_> {
    /// Whether it moves with time.
    pub fn moves(&self) -> bool {
        self.value.is_some()
    }

    /// What is missing from the displacements `u` to its value at `time`.
    ///
    /// # Errors
    /// A value that cannot be evaluated.
    pub fn missing(&self, u: &[f64], time: f64) -> Result<f64, ValueError> {
        let wanted = match self.value {
            None => 0.0,
            Some(value) => value.eval_at(&self.at, time)?,
        };
        let [a, b] = self.dofs.map(|d| u[d as usize]);
        Ok(wanted - 0.5 * (a + b))
    }
}

impl PairModel {
    /// The degree of the rules on the pieces, where slave faces are cut by the master's facets.
    pub fn segments(&self) -> Option<u8> {
        match self.sampled {
            Points::Segments(degree) => Some(degree),
            _ => None,
        }
    }

    /// Whether another pair of the same contact is the one by which it is known: this is the second of two half passes, or
    /// holds the edges of the master.
    pub fn is_second(&self) -> bool {
        self.edges_of.is_some() || self.half.is_some_and(|half| half.back)
    }

    /// What such a second pair holds: `edges` of the master, or the half pass with the sides `exchanged`.
    pub fn second_part(&self) -> Option<&'static str> {
        match self.edges_of {
            Some(_) => Some("edges"),
            None => self.is_second().then_some("exchanged"),
        }
    }

    /// Share of the pair in the energy of its contact: both passes of two are one contact with two sides, whose energy is
    /// the mean of both.
    #[inline]
    pub fn share(&self) -> f64 {
        match self.half {
            None => 1.0,
            Some(_) => 0.5,
        }
    }

    /// Whether its points have a history; where gaps are averaged and there is no friction, its nodes.
    pub fn remembers(&self) -> bool {
        self.friction.is_some() || self.augmentation.is_some()
    }

    /// Number of its points, or of its nodes where gaps are averaged and there is no friction, before anything moves.
    pub fn carriers(&self) -> usize {
        match (&self.averaged, &self.friction) {
            (Some(nodes), None) => nodes.len(),
            _ => self.points.len(),
        }
    }

    /// Whether facets of its master are coupled with each other beside its slave points. A closed node of averaged gaps couples
    /// all that the points around it feel.
    pub fn links(&self) -> bool {
        self.friction.is_some() && self.averaged.is_none()
    }
}

impl BodyModel {
    /// Whether it has nodes inside its thickness, or no thickness of its own: no shell of one layer.
    pub fn is_block(&self) -> bool {
        self.mesh.opposite_nodes().contains(&None)
    }

    /// Node numbers of an element in the model; `block` holds the body's elements.
    #[inline]
    pub fn nodes_of<const N: usize>(&self, block: &impl ElementBlock<N>, e: usize) -> [u32; N] {
        block.nodes_of(e).map(|n| n + self.first_node)
    }

    /// Displacements of an element's nodes, from those of the model; `block` holds the body's elements.
    #[inline]
    pub fn displacements<const N: usize>(
        &self,
        block: &impl ElementBlock<N>,
        e: usize,
        u: &[f64],
    ) -> [Vec3; N] {
        self.nodes_of(block, e).map(|n| {
            let at = 3 * n as usize;
            Vec3::new(u[at], u[at + 1], u[at + 2])
        })
    }

    /// Node numbers of an element in the model, for any shape of elements.
    pub fn element_nodes(&self, e: usize) -> impl Iterator<Item = u32> + '_ {
        self.mesh.element(e).iter().map(|n| n + self.first_node)
    }
}
