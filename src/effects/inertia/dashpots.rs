//! Viscosity of the material (Kelvin-Voigt): dashpots beside all elements, whose stress `eta D : (E_1 - E_0) / dt` is that of the mean
//! rate of strain in a step, with the moduli D of the material at small strain.
//!
//! They are elements of the same shape with the law [`Dashpot`](crate::shell::material::Dashpot) and enhanced strains of their own, which
//! start from nothing in every step. Their energy is quadratic in these, so that condensed forces are exact whatever they are. What
//! dashpots take is `eta dE : D : dE / dt`, never negative.
use crate::effects::Tangent;
use crate::model::state::heap;
use crate::model::{BodyModel, Model};
use crate::shell::{
    Block, ElementBlock, ElementFault, ElementSystem, H8System, NurbsSystem, Q18System, with_block,
};
use covact_geometry::Vec3;
use rayon::prelude::*;

/// Elements evaluated before they are summed.
const CHUNK: usize = 128;
/// Enhanced strains of any element.
const MOST_ENHANCED: usize = 8;

/// The dashpots of all bodies; their elements are those of the model.
#[derive(Debug, Clone)]
pub struct Dashpots {
    /// Viscosity over moduli (time).
    time: f64,
    /// States of the elements, body after body: enhanced strains, their condensation, and strains at the start of the step.
    states: Vec<f64>,
    /// Room for a chunk of elements of each shape.
    h8: Vec<H8System>,
    q18: Vec<Q18System>,
    nurbs: Vec<NurbsSystem>,
    /// Forces of the last evaluation, 3 per node.
    forces: Vec<f64>,
    /// What they take in the step to the state of the last evaluation.
    taken: f64,
}

/// Where the elements of a body add to.
struct Sums<'a, 'b, 't> {
    forces: &'a mut [f64],
    /// The tangent, and the places of the elements of the body among its maps.
    to: Option<&'a mut Tangent<'t>>,
    first: &'b mut usize,
    /// Viscosity over the step.
    scale: f64,
    energy: f64,
}

impl Dashpots {
    /// Those that the model asks for.
    pub fn new(model: &Model) -> Option<Dashpots> {
        let own = model.dynamics.as_ref()?;
        let time = own.settings.damping.viscosity;
        if time <= 0.0 {
            return None;
        }
        let len = |b: &Block| b.state_len() * b.elements();
        let room = |of: fn(&Block) -> bool| {
            let counts = own.dashpots.iter().filter(|b| of(b)).map(Block::elements);
            counts.max().unwrap_or(0).min(CHUNK)
        };
        Some(Dashpots {
            time,
            states: vec![0.0; own.dashpots.iter().map(len).sum()],
            h8: vec![H8System::default(); room(|b| matches!(b, Block::H8(_)))],
            q18: vec![Q18System::default(); room(|b| matches!(b, Block::Q18(_)))],
            nurbs: vec![NurbsSystem::default(); room(|b| matches!(b, Block::Nurbs(_)))],
            forces: vec![0.0; 3 * model.nodes.len()],
            taken: 0.0,
        })
    }

    /// Bytes that an element of a body takes.
    pub fn of_element(body: &BodyModel) -> usize {
        size_of::<f64>() * body.block.dashpot_state_len()
    }

    /// Bytes of the room for a chunk of elements of each shape.
    pub fn room(model: &Model) -> usize {
        let most = |of: fn(&Block) -> bool| {
            let blocks = model.bodies.iter().map(|b| &b.block);
            let counts = blocks.filter(|b| of(b)).map(Block::elements);
            counts.max().unwrap_or(0).min(CHUNK)
        };
        size_of::<H8System>() * most(|b| matches!(b, Block::H8(_)))
            + size_of::<Q18System>() * most(|b| matches!(b, Block::Q18(_)))
            + size_of::<NurbsSystem>() * most(|b| matches!(b, Block::Nurbs(_)))
    }

    /// Bytes of heap that they hold.
    pub fn bytes(&self) -> usize {
        heap(&self.states)
            + heap(&self.forces)
            + heap(&self.h8)
            + heap(&self.q18)
            + heap(&self.nurbs)
    }

    /// Forces of the last evaluation, 3 per node.
    pub fn forces(&self) -> &[f64] {
        &self.forces
    }

    /// What they take in the step to the state of the last evaluation.
    pub fn taken(&self) -> f64 {
        self.taken
    }

    /// A step begins at the displacements `u`.
    pub fn begin(&mut self, model: &Model, u: &[f64]) {
        self.forces.fill(0.0);
        self.taken = 0.0;
        let blocks = model.dynamics.iter().flat_map(|d| &d.dashpots);
        let mut rest = &mut self.states[..];
        for (body, block) in model.bodies.iter().zip(blocks) {
            let (own, more) = rest.split_at_mut(block.state_len() * block.elements());
            rest = more;
            with_block!(block, block => begin(body, block, own, u));
        }
    }

    /// Adds their forces at the displacements `u` in a step of size `dt`, and their tangent. Forces are not finite where an element
    /// cannot be evaluated, which its body tells before.
    pub fn add(
        &mut self,
        model: &Model,
        (u, dt): (&[f64], f64),
        residual: &mut [f64],
        mut to: Option<&mut Tangent<'_>>,
    ) {
        let Dashpots {
            time,
            states,
            h8,
            q18,
            nurbs,
            forces,
            taken,
        } = self;
        forces.fill(0.0);
        *taken = 0.0;
        let mut rest = &mut states[..];
        let mut first = 0;
        let blocks = model.dynamics.iter().flat_map(|d| &d.dashpots);
        for (body, block) in model.bodies.iter().zip(blocks) {
            let (own, more) = rest.split_at_mut(block.state_len() * block.elements());
            rest = more;
            let mut sums = Sums {
                forces,
                to: to.as_deref_mut(),
                first: &mut first,
                scale: *time / dt,
                energy: 0.0,
            };
            let done = match block {
                Block::H8(b) => sums.add(body, b, h8, own, u),
                Block::Q18(b) => sums.add(body, b, q18, own, u),
                Block::Nurbs(b) => sums.add(body, &**b, nurbs, own, u),
            };
            *taken += 2.0 * sums.energy;
            if done.is_err() {
                forces.fill(f64::NAN);
            }
        }
        for (r, f) in residual.iter_mut().zip(forces.iter()) {
            *r += f;
        }
    }
}

/// Takes the strains at the start of a step; enhanced ones are nothing there.
fn begin<const N: usize, B: ElementBlock<N>>(
    body: &BodyModel,
    block: &B,
    states: &mut [f64],
    u: &[f64],
) {
    let (len, alphas) = (block.state_len(), block.alpha_len());
    if len == 0 {
        return;
    }
    (states.par_chunks_mut(len).enumerate())
        .with_min_len(64)
        .for_each(|(e, state)| {
            state[..alphas].fill(0.0);
            let x = body.displacements(block, e, u);
            if block.remember(e, &x, state).is_err() {
                state.fill(f64::NAN);
            }
        });
}

impl Sums<'_, '_, '_> {
    fn add<const N: usize, B: ElementBlock<N>>(
        &mut self,
        body: &BodyModel,
        block: &B,
        systems: &mut [B::System],
        states: &mut [f64],
        u: &[f64],
    ) -> Result<(), ElementFault> {
        let (len, count) = (block.state_len(), block.elements());
        let (still, alphas) = ([Vec3::zeros(); N], block.alpha_len());
        for start in (0..count).step_by(CHUNK) {
            let n = CHUNK.min(count - start);
            let chunk = &mut states[start * len..(start + n) * len];
            (systems[..n].par_iter_mut())
                .zip(chunk.par_chunks_mut(len.max(1)))
                .enumerate()
                .with_min_len(8)
                .try_for_each(|(i, (out, state))| {
                    let x = body.displacements(block, start + i, u);
                    block.evaluate(start + i, &x, state, out)?;
                    // Where they are relaxed at these displacements, for the geometric part of the next tangent.
                    let mut alpha = [0.0; MOST_ENHANCED];
                    alpha[..alphas].copy_from_slice(&state[..alphas]);
                    block.update_alpha(state, &still, 1.0, &alpha);
                    Ok(())
                })?;
            for (i, system) in systems[..n].iter_mut().enumerate() {
                self.scatter(&body.nodes_of(block, start + i), system);
            }
        }
        Ok(())
    }

    fn scatter<const N: usize>(&mut self, nodes: &[u32; N], system: &mut impl ElementSystem) {
        let scale = self.scale;
        let (f, k, energy) = system.parts();
        self.energy += scale * energy;
        for (n, f) in nodes.iter().zip(f.chunks_exact(3)) {
            for (sum, f) in self.forces[3 * *n as usize..].iter_mut().zip(f) {
                *sum += scale * f;
            }
        }
        let pairs = N * (N + 1) / 2;
        let map = *self.first..*self.first + pairs;
        *self.first = map.end;
        let Some(to) = self.to.as_deref_mut() else {
            return;
        };
        k.iter_mut().for_each(|k| *k *= scale);
        if !to.dofs.constrains(nodes) {
            to.matrix.scatter(&to.maps[map], k);
            return;
        }
        if let Some(g) = to.increments {
            to.dofs.subtract_prescribed(nodes, k, g, to.rhs);
        }
        (to.matrix)
            .scatter_constrained(nodes, k, to.dofs, to.work)
            .expect("the pattern holds every element with what it is tied to");
    }
}
