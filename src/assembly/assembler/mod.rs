//! Residual and tangent of the whole model.
//!
//! Elements and slave points are evaluated in parallel, a chunk at a time, and summed in order by one thread, so that
//! the result is the same to the last bit for every number of threads.
mod elements;
mod loads;
mod rigid;

use super::{ConstrainedScatter, DofMap, Pattern, PatternError, SystemMatrix};

use crate::contact::rigid::{PointFault, Touch};
use crate::model::Model;
use crate::model::state::State;
use crate::scene::ValueError;
use crate::shell::{ElementFault, H8System};
use covact_geometry::Vec3;

use std::sync::Arc;

/// Elements evaluated before their matrices are summed.
const CHUNK: usize = 128;

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
    systems: Vec<H8System>,
    touches: Vec<Result<Option<Touch>, PointFault>>,
    work: ConstrainedScatter,
    /// Dead loads at the present time.
    external: Vec<f64>,
    contact: Vec<f64>,
    /// Penalty per pair; an automatic one may be raised in the course of a run.
    pub penalties: Vec<f64>,
}

const PAIRS: usize = 36;

impl<'m> Assembler<'m> {
    /// Builds the pattern of the model under its constraints.
    pub fn new(model: &'m Model, dofs: &'m DofMap) -> Result<Self, PatternError> {
        let mut groups: Vec<Vec<u32>> = Vec::new();
        for body in &model.bodies {
            for e in 0..body.block.elements() {
                let mut group = Vec::with_capacity(8);
                dofs.extend_nodes(&body.element_nodes(e), &mut group);
                groups.push(group);
            }
        }
        let pattern = Pattern::new(model.nodes.len(), groups.iter().map(Vec::as_slice))?;
        let (mut element_maps, mut kinds) = (Vec::new(), Vec::new());
        for body in &model.bodies {
            for e in 0..body.block.elements() {
                let nodes = body.element_nodes(e);
                pattern.element_map(&nodes, &mut element_maps)?;
                let mut extended = Vec::new();
                dofs.extend_nodes(&nodes, &mut extended);
                kinds.push(if extended.len() > 8 {
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
                pattern.element_map(nodes, &mut maps)?;
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
        Ok(Assembler {
            model,
            dofs,
            matrix: SystemMatrix::new(Arc::new(pattern)),
            element_maps,
            kinds,
            point_maps,
            follower_maps,
            systems: vec![H8System::default(); CHUNK],
            touches: vec![Ok(None); most],
            work: ConstrainedScatter::default(),
            external: vec![0.0; n],
            contact: vec![0.0; n],
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
        let mut first = 0;
        for body in &self.model.bodies {
            let len = body.block.state_len();
            let mut f = [0.0; 24];
            for e in 0..body.block.elements() {
                let at = first + e * len;
                let x = body.displacements(e, &state.u);
                let energy = (body.block)
                    .residual(e, &x, &state.elements[at..at + len], &mut f)
                    .map_err(|fault| element_fault(&body.name, fault))?;
                totals.internal_energy += energy;
                add_nodes(residual, &body.element_nodes(e), &f);
            }
            first += len * body.block.elements();
        }
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

fn add_nodes(out: &mut [f64], nodes: &[u32; 8], f: &[f64; 24]) {
    for (k, &n) in nodes.iter().enumerate() {
        let at = 3 * n as usize;
        (0..3).for_each(|c| out[at + c] += f[3 * k + c]);
    }
}
