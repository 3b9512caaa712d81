//! Residual and tangent of the whole model.
//!
//! Elements and slave points are evaluated in parallel, a chunk at a time, and summed in order by one thread, so that
//! the result is the same to the last bit for every number of threads.
use super::{ConstrainedScatter, DofMap, Pattern, PatternError, SystemMatrix};
use crate::contact::law::{NormalLaw, Penalty};
use crate::contact::published::Parts;
use crate::contact::rigid::{Exact, PointFault, RigidMaster, RigidTangent, Touch};
use crate::model::loads::{follower_force, follower_stiffness};
use crate::model::state::{PointState, State};
use crate::model::{Model, PairModel};
use crate::scene::{Tangent, ValueError};
use crate::shell::{ElementFault, H8System};
use covact_geometry::Vec3;
use rayon::prelude::*;
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

    fn elements(
        &mut self,
        state: &mut State,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) -> Result<(), Fault> {
        let (mut first_state, mut first_element) = (0, 0);
        for body in &self.model.bodies {
            let (len, count) = (body.block.state_len(), body.block.elements());
            let states = &mut state.elements[first_state..first_state + len * count];
            let u = &state.u;
            for start in (0..count).step_by(CHUNK) {
                let n = CHUNK.min(count - start);
                let evaluate = |i: usize, out: &mut H8System, s: &mut [f64]| {
                    let x = body.displacements(start + i, u);
                    body.block.evaluate(start + i, &x, s, out)
                };
                let outputs = (self.systems[..n].par_iter_mut()).with_min_len(8);
                let done = if len == 0 {
                    (outputs.enumerate()).try_for_each(|(i, out)| evaluate(i, out, &mut []))
                } else {
                    let chunk = &mut states[start * len..(start + n) * len];
                    (outputs.zip(chunk.par_chunks_mut(len)).enumerate())
                        .try_for_each(|(i, (out, s))| evaluate(i, out, s))
                };
                done.map_err(|fault| element_fault(&body.name, fault))?;
                for i in 0..n {
                    let nodes = body.element_nodes(start + i);
                    let system = &mut self.systems[i];
                    totals.internal_energy += system.energy;
                    add_nodes(residual, &nodes, &system.f);
                    let global = first_element + start + i;
                    let kind = self.kinds[global];
                    if kind != Kind::Free
                        && let Some(g) = increments
                    {
                        self.dofs.subtract_prescribed(&nodes, &system.k, g, rhs);
                    }
                    let map = &self.element_maps[PAIRS * global..PAIRS * (global + 1)];
                    match kind {
                        Kind::Free => self.matrix.scatter(map, &system.k),
                        Kind::Prescribed => {
                            (self.dofs)
                                .condense_matrix(&nodes, &mut system.k)
                                .expect("an element without ties has all its nodes");
                            self.matrix.scatter(map, &system.k);
                        }
                        Kind::Tied => (self.matrix)
                            .scatter_constrained(&nodes, &system.k, self.dofs, &mut self.work)
                            .expect("the pattern holds every element with what it is tied to"),
                    }
                }
            }
            first_state += len * count;
            first_element += count;
        }
        Ok(())
    }

    fn contacts<const TANGENT: bool>(
        &mut self,
        state: &mut State,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) -> Result<(), Fault> {
        totals.surfaces = vec![SurfaceForce::default(); self.model.surfaces.len()];
        self.contact.fill(0.0);
        let mut first = 0;
        for (index, pair) in self.model.pairs.iter().enumerate() {
            let surface = &self.model.surfaces[pair.surface];
            let master = surface.at(time)?;
            let n = pair.points.len();
            let points = &mut state.points[first..first + n];
            let touches = &mut self.touches[..n];
            let u = &state.u;
            let law = Penalty {
                eps_n: self.penalties[index],
            };
            let batch = Batch {
                model: self.model,
                pair,
                master: &master,
                law: &law,
                u,
            };
            match pair.tangent {
                Tangent::Exact => batch.evaluate(points, touches, &Exact),
                Tangent::Published {
                    rotational,
                    curvature,
                } => {
                    let parts = Parts {
                        rotational,
                        curvature,
                    };
                    batch.evaluate(points, touches, &parts)
                }
            }
            let mut deepest = 0.0f64;
            let mut ke = [0.0; 729];
            let mut at = 0;
            let maps = &self.point_maps[index];
            for (i, p) in pair.points.iter().enumerate() {
                let count = p.count as usize;
                let pairs = count * (count + 1) / 2;
                let map = &maps[at..at + pairs];
                at += pairs;
                let touch = match &touches[i] {
                    Err(fault) => {
                        let x = self.model.point_position(p, u);
                        return Err(Fault::Contact {
                            pair: pair.name.clone(),
                            point: i,
                            at: [x.x, x.y, x.z],
                            fault: *fault,
                        });
                    }
                    Ok(touch) => touch,
                };
                totals.changed += usize::from(touch.is_some() != points[i].closed);
                points[i].closed = touch.is_some();
                let Some(touch) = touch else { continue };
                totals.active += 1;
                deepest = deepest.max(-touch.xi3);
                totals.contact_energy += 0.5 * touch.n * touch.xi3 * p.area;
                let force = touch.residual * p.area;
                let on = &mut totals.surfaces[pair.surface];
                on.force -= force;
                on.moment -= self.model.point_position(p, u).cross(&force);
                for (node, w) in p.terms() {
                    for c in 0..3 {
                        residual[3 * node + c] += w * force[c];
                        self.contact[3 * node + c] += w * force[c];
                    }
                }
                if TANGENT {
                    let size = 3 * count;
                    let k = touch.tangent * p.area;
                    for (b, wb) in p.shape[..count].iter().enumerate() {
                        for (a, wa) in p.shape[..count].iter().enumerate() {
                            for c in 0..3 {
                                for r in 0..3 {
                                    ke[(3 * b + c) * size + 3 * a + r] = wa * wb * k[(r, c)];
                                }
                            }
                        }
                    }
                    let ke = &mut ke[..size * size];
                    put(
                        &mut self.matrix,
                        self.dofs,
                        &mut self.work,
                        &p.nodes[..count],
                        map,
                        ke,
                        increments,
                        rhs,
                    );
                }
            }
            totals.penetration.push(deepest);
            first += n;
        }
        totals.contact_norm = self.contact.iter().map(|f| f * f).sum::<f64>().sqrt();
        Ok(())
    }

    fn loads<const TANGENT: bool>(
        &mut self,
        state: &State,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
    ) -> Result<(), Fault> {
        let (mut x, mut f, mut k) = ([Vec3::zeros(); 9], [0.0; 27], [0.0; 729]);
        self.external.fill(0.0);
        for (_, load) in &self.model.dead_loads {
            load.add(time, &mut self.external)?;
        }
        for (index, (_, load)) in self.model.follower_loads.iter().enumerate() {
            let p = load.value.eval(time)?;
            let mut at = 0;
            for face in &load.faces {
                let nodes = face.nodes();
                for (x, &n) in x.iter_mut().zip(nodes) {
                    *x = self.model.position(n as usize, &state.u);
                }
                follower_force(&x, face.count, p, &mut f);
                for (k, &n) in nodes.iter().enumerate() {
                    (0..3).for_each(|c| self.external[3 * n as usize + c] += f[3 * k + c]);
                }
                if TANGENT {
                    // The system is symmetric: what is unsymmetric lives on the border of the loaded area only.
                    follower_stiffness(&x, face.count, p, &mut k);
                    let size = 3 * nodes.len();
                    for column in 0..size {
                        for row in 0..=column {
                            let [upper, lower] = [column * size + row, row * size + column];
                            k[upper] = -0.5 * (k[upper] + k[lower]);
                            k[lower] = k[upper];
                        }
                    }
                    let pairs = nodes.len() * (nodes.len() + 1) / 2;
                    let map = &self.follower_maps[index][at..at + pairs];
                    at += pairs;
                    put(
                        &mut self.matrix,
                        self.dofs,
                        &mut self.work,
                        nodes,
                        map,
                        &mut k[..size * size],
                        increments,
                        rhs,
                    );
                }
            }
        }
        for (r, f) in residual.iter_mut().zip(&self.external) {
            *r -= f;
        }
        Ok(())
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

/// The slave points of a pair at one trial state.
struct Batch<'a, L> {
    model: &'a Model,
    pair: &'a PairModel,
    master: &'a RigidMaster<'a>,
    law: &'a L,
    u: &'a [f64],
}

impl<L: NormalLaw> Batch<'_, L> {
    /// Evaluates every point; law and tangent are types here, nothing is chosen inside the loop.
    fn evaluate<T: RigidTangent>(
        &self,
        states: &mut [PointState],
        touches: &mut [Result<Option<Touch>, PointFault>],
        tangent: &T,
    ) {
        (self.pair.points.par_iter())
            .zip(states.par_iter_mut())
            .zip(touches.par_iter_mut())
            .with_min_len(64)
            .for_each(|((p, s), out)| {
                let x = self.model.point_position(p, self.u);
                *out = self.master.touch(&x, &mut s.hint, self.law, tangent);
            });
    }
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
