//! Residual and tangent of the whole model.
//!
//! Elements and slave points are evaluated in parallel, a chunk at a time, and summed in order by one thread, so that
//! the result is the same to the last bit for every number of threads.
mod driven;
mod elements;
mod loads;
mod rigid;

use super::{ConstrainedScatter, DofMap, Pattern, PatternError, SystemMatrix};

use crate::contact::rigid::{PointFault, Touch};
use crate::model::Model;
use crate::model::driven::press::PressFault;
use crate::model::state::State;
use crate::scene::ValueError;
use crate::shell::ElementFault;
use covact_geometry::Vec3;

use driven::Border;
use elements::Systems;
use std::sync::Arc;

pub use driven::Loose;

/// What kept the model from being evaluated at a trial state. The step is cut.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Fault {
    #[error("body `{body}`: {fault}")]
    Element { body: String, fault: ElementFault },
    #[error("contact `{pair}`, slave point {point} near ({:.6e}, {:.6e}, {:.6e}): {fault}", at[0], at[1], at[2])]
    Contact {
        pair: String,
        point: usize,
        at: [f64; 3],
        fault: PointFault,
    },
    /// A surface driven by force touches no slave point.
    #[error(
        "surface `{surface}`, which forces drive {free}, has lost all contact: nothing holds it. Forces act on the \
         surface: check their sign and size over time, the components that are free, and what supports the bodies under it"
    )]
    Untouched { surface: String, free: String },
    /// A surface driven by force moves in a direction in which nothing resists it.
    #[error(
        "nothing resists the motion of surface `{surface}` {motion}, and its forces drive it on: take the component out \
         of `free`, or give its force another direction"
    )]
    Unresisted { surface: String, motion: String },
    /// A surface driven by force could not be placed.
    #[error(transparent)]
    Press(#[from] PressFault),
    #[error(transparent)]
    Value(#[from] ValueError),
}

/// What a rigid surface does to the bodies.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SurfaceForce {
    /// Force of the surface on the bodies.
    pub force: Vec3,
    /// Moment of that force about the origin.
    pub moment: Vec3,
}

/// Totals of one evaluation.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Totals {
    /// Strain energy.
    pub internal_energy: f64,
    /// Energy stored in the penalty.
    pub contact_energy: f64,
    /// Per surface of the model.
    pub surfaces: Vec<SurfaceForce>,
    /// Points in contact.
    pub active: usize,
    /// Points whose status differs from the one in the state when the evaluation began.
    pub changed: usize,
    /// Deepest penetration, >= 0, per pair.
    pub penetration: Vec<f64>,
    /// Norm of the contact forces on nodes.
    pub contact_norm: f64,
    /// Motions of driven surfaces that the contact does not resist, found with the tangent.
    pub loose: Vec<Loose>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Free,
    Prescribed,
    Tied,
}

/// Evaluates the model into a sparse system.
pub struct Assembler<'m> {
    model: &'m Model,
    dofs: &'m DofMap,
    matrix: SystemMatrix,
    element_maps: Vec<u32>,
    kinds: Vec<Kind>,
    /// Per pair: per point, where its blocks go.
    point_maps: Vec<Vec<u32>>,
    follower_maps: Vec<Vec<u32>>,
    systems: Systems,
    touches: Vec<Result<Option<Touch>, PointFault>>,
    work: ConstrainedScatter,
    /// Dead loads at the present time.
    external: Vec<f64>,
    contact: Vec<f64>,
    borders: Vec<Border>,
    /// Penalty per pair; an automatic one may be raised in the course of a run.
    pub penalties: Vec<f64>,
}

impl<'m> Assembler<'m> {
    /// Builds the pattern of the model under its constraints.
    pub fn new(model: &'m Model, dofs: &'m DofMap) -> Result<Self, PatternError> {
        let mut groups: Vec<Vec<u32>> = Vec::new();
        let mut nodes = Vec::new();
        for body in &model.bodies {
            for e in 0..body.block.elements() {
                nodes.clear();
                nodes.extend(body.element_nodes(e));
                let mut group = Vec::with_capacity(nodes.len());
                dofs.extend_nodes(&nodes, &mut group);
                groups.push(group);
            }
        }
        groups.extend(driven::groups(model, |nodes, out| {
            dofs.extend_nodes(nodes, out)
        }));
        let border = (model.nodes.len() - model.body_nodes()) as u32;
        let pattern =
            Pattern::new(model.nodes.len(), groups.iter().map(Vec::as_slice))?.with_border(border);
        let (mut element_maps, mut kinds) = (Vec::new(), Vec::new());
        let mut extended = Vec::new();
        for body in &model.bodies {
            for e in 0..body.block.elements() {
                nodes.clear();
                nodes.extend(body.element_nodes(e));
                pattern.element_map(&nodes, &mut element_maps)?;
                extended.clear();
                dofs.extend_nodes(&nodes, &mut extended);
                kinds.push(if extended.len() > nodes.len() {
                    Kind::Tied
                } else if dofs.constrains(&nodes) {
                    Kind::Prescribed
                } else {
                    Kind::Free
                });
            }
        }
        let mut point_maps = Vec::new();
        for pair in &model.pairs {
            let mut maps = Vec::new();
            for p in &pair.points {
                pattern.element_map(&p.nodes[..p.count as usize], &mut maps)?;
            }
            point_maps.push(maps);
        }
        let mut follower_maps = Vec::new();
        for (_, load) in &model.follower_loads {
            let mut maps = Vec::new();
            for nodes in &load.faces {
                pattern.element_map(nodes.nodes(), &mut maps)?;
            }
            follower_maps.push(maps);
        }
        let most = model
            .pairs
            .iter()
            .map(|p| p.points.len())
            .max()
            .unwrap_or(0);
        let n = 3 * model.nodes.len();
        let borders = Border::all(model, &pattern)?;
        Ok(Assembler {
            model,
            dofs,
            matrix: SystemMatrix::new(Arc::new(pattern)),
            element_maps,
            kinds,
            point_maps,
            follower_maps,
            systems: Systems::new(model),
            touches: vec![Ok(None); most],
            work: ConstrainedScatter::default(),
            external: vec![0.0; n],
            contact: vec![0.0; n],
            borders,
            penalties: model.pairs.iter().map(|p| p.eps_n).collect(),
        })
    }

    /// The tangent of the last [`Self::linearize`].
    pub fn matrix(&self) -> &SystemMatrix {
        &self.matrix
    }

    /// Dead loads of the last evaluation.
    pub fn external(&self) -> &[f64] {
        &self.external
    }

    /// Residual `f_int + f_contact - f_ext` at all degrees of freedom (reactions included) and the tangent; the element
    /// states receive what their condensation needs, the point states where their search ended. `increments` are
    /// prescribed displacements still to come: the returned right-hand side is `-residual - K increments`.
    pub fn linearize(
        &mut self,
        state: &mut State,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
    ) -> Result<Totals, Fault> {
        self.matrix.clear();
        residual.fill(0.0);
        rhs.fill(0.0);
        let mut totals = Totals::default();
        self.elements(state, increments, residual, rhs, &mut totals)?;
        self.contacts::<true>(state, time, increments, residual, rhs, &mut totals)?;
        self.loads::<true>(state, time, increments, residual, rhs)?;
        self.own_blocks(&state.u, time, residual, &mut totals)?;
        for (b, r) in rhs.iter_mut().zip(residual.iter()) {
            *b -= r;
        }
        self.dofs.fold(rhs);
        self.matrix.set_identities(self.dofs);
        Ok(totals)
    }

    /// The residual alone, for a line search; uses the condensation cached by the last [`Self::linearize`].
    pub fn residual(
        &mut self,
        state: &mut State,
        time: f64,
        residual: &mut [f64],
    ) -> Result<Totals, Fault> {
        residual.fill(0.0);
        let mut totals = Totals::default();
        self.element_forces(state, residual, &mut totals)?;
        self.contacts::<false>(state, time, None, residual, &mut [], &mut totals)?;
        self.loads::<false>(state, time, None, residual, &mut [])?;
        Ok(totals)
    }
}

/// Scatters a small matrix under the constraints, with what prescribed increments contribute to the right-hand side.
#[allow(clippy::too_many_arguments)]
fn put(
    matrix: &mut SystemMatrix,
    dofs: &DofMap,
    work: &mut ConstrainedScatter,
    nodes: &[u32],
    map: &[u32],
    ke: &mut [f64],
    increments: Option<&[f64]>,
    rhs: &mut [f64],
) {
    if !dofs.constrains(nodes) {
        matrix.scatter(map, ke);
        return;
    }
    if let Some(g) = increments {
        dofs.subtract_prescribed(nodes, ke, g, rhs);
    }
    matrix
        .scatter_constrained(nodes, ke, dofs, work)
        .expect("a face's nodes lie in one element, which the pattern holds");
}

fn element_fault(body: &str, fault: ElementFault) -> Fault {
    Fault::Element {
        body: body.to_owned(),
        fault,
    }
}
