//! Elements: evaluated in parallel a chunk at a time, summed in order. The loops are generic over the shape of the
//! elements, which is chosen once for each body.
use super::{Assembler, Fault, Kind, Totals, element_fault};
use crate::contact::law::PairLaw;
use crate::model::state::{State, heap};
use crate::model::{BodyModel, Model};
use crate::shell::{
    Block, ElementBlock, ElementFault, ElementSystem, H8System, NurbsSystem, Q18System, with_block,
};
use crate::system::{ConstrainedScatter, DofMap, SystemMatrix};
use covact_geometry::Vec3;
use rayon::prelude::*;

/// Elements evaluated before their matrices are summed.
const CHUNK: usize = 128;

/// Room for one chunk of elements of each shape that the model has.
#[derive(Default)]
pub(super) struct Systems {
    h8: Vec<H8System>,
    q18: Vec<Q18System>,
    nurbs: Vec<NurbsSystem>,
}

impl Systems {
    pub(super) fn new(model: &Model) -> Systems {
        let most = |of: fn(&Block) -> bool| {
            let blocks = model.bodies.iter().map(|b| &b.block);
            let counts = blocks.filter(|b| of(b)).map(Block::elements);
            counts.max().unwrap_or(0).min(CHUNK)
        };
        Systems {
            h8: vec![H8System::default(); most(|b| matches!(b, Block::H8(_)))],
            q18: vec![Q18System::default(); most(|b| matches!(b, Block::Q18(_)))],
            nurbs: vec![NurbsSystem::default(); most(|b| matches!(b, Block::Nurbs(_)))],
        }
    }
}

impl Systems {
    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        heap(&self.h8) + heap(&self.q18) + heap(&self.nurbs)
    }
}

/// Pairs of `n` nodes, each counted once: entries of an element's map.
pub(super) const fn pairs(n: usize) -> usize {
    n * (n + 1) / 2
}

/// Where the elements of a body go.
struct Sums<'a> {
    matrix: &'a mut SystemMatrix,
    dofs: &'a DofMap,
    work: &'a mut ConstrainedScatter,
    /// Of the body's elements.
    kinds: &'a [Kind],
    maps: &'a [u32],
    increments: Option<&'a [f64]>,
    /// Displacements before the last correction, for mixed integration points.
    from: Option<&'a [f64]>,
    residual: &'a mut [f64],
    rhs: &'a mut [f64],
    energy: &'a mut f64,
}

impl<L: PairLaw> Assembler<'_, L> {
    pub(super) fn elements(
        &mut self,
        state: &mut State,
        (increments, from): (Option<&[f64]>, Option<&[f64]>),
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) -> Result<(), Fault> {
        let (mut first_state, mut first_element, mut first_map) = (0, 0, 0);
        for body in &self.model.bodies {
            let count = body.block.elements();
            let states = body.block.state_len() * count;
            let map = pairs(body.mesh.kind.nodes()) * count;
            let mut sums = Sums {
                matrix: &mut self.matrix,
                dofs: self.dofs,
                work: &mut self.work,
                kinds: &self.kinds[first_element..first_element + count],
                maps: &self.element_maps[first_map..first_map + map],
                increments,
                from,
                residual,
                rhs,
                energy: &mut totals.internal_energy,
            };
            let (states, u) = (
                &mut state.elements[first_state..first_state + states],
                &state.u,
            );
            first_state += states.len();
            first_element += count;
            first_map += map;
            match &body.block {
                Block::H8(b) => sums.add(body, b, &mut self.systems.h8, states, u),
                Block::Q18(b) => sums.add(body, b, &mut self.systems.q18, states, u),
                Block::Nurbs(b) => sums.add(body, &**b, &mut self.systems.nurbs, states, u),
            }?;
        }
        Ok(())
    }

    /// Internal forces and energy alone.
    pub(super) fn element_forces(
        &self,
        state: &State,
        residual: &mut [f64],
        totals: &mut Totals,
    ) -> Result<(), Fault> {
        let mut first = 0;
        for body in &self.model.bodies {
            let states = body.block.state_len() * body.block.elements();
            let own = &state.elements[first..first + states];
            first += states;
            with_block!(&body.block, block => {
                forces(body, block, own, &state.u, residual, &mut totals.internal_energy)
            })?;
        }
        Ok(())
    }
}

/// Sums the stiffness of all undeformed elements, of these kinds and with these places, into a matrix.
pub(super) fn undeformed(
    model: &Model,
    dofs: &DofMap,
    matrix: &mut SystemMatrix,
    systems: &mut Systems,
    (kinds, maps): (&[Kind], &[u32]),
) -> Result<(), Fault> {
    let zero = vec![0.0; 3 * model.nodes.len()];
    let (mut forces, mut rhs) = (zero.clone(), zero.clone());
    let (mut first_element, mut first_map) = (0, 0);
    for body in &model.bodies {
        let count = body.block.elements();
        let map = pairs(body.mesh.kind.nodes()) * count;
        let mut sums = Sums {
            matrix: &mut *matrix,
            dofs,
            work: &mut ConstrainedScatter::default(),
            kinds: &kinds[first_element..first_element + count],
            maps: &maps[first_map..first_map + map],
            increments: None,
            from: None,
            residual: &mut forces,
            rhs: &mut rhs,
            energy: &mut 0.0,
        };
        first_element += count;
        first_map += map;
        let mut states = vec![0.0; body.block.state_len() * count];
        match &body.block {
            Block::H8(b) => sums.add(body, b, &mut systems.h8, &mut states, &zero),
            Block::Q18(b) => sums.add(body, b, &mut systems.q18, &mut states, &zero),
            Block::Nurbs(b) => sums.add(body, &**b, &mut systems.nurbs, &mut states, &zero),
        }?;
    }
    Ok(())
}

/// What the large-rotation elements add to the linear ones at the same displacements.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Quadratic {
    /// Forces that are quadratic in the displacements, at all degrees of freedom.
    pub forces: Vec<f64>,
    /// Strain energy of even orders, that of the linear elements included.
    pub even: f64,
    /// Strain energy of odd orders.
    pub odd: f64,
}

/// The even part of the forces and both parts of the energy of all elements at displacements `u`, whose enhanced strains are
/// those of the linear elements, with condensation at no displacements.
///
/// # Errors
/// Strains that are impossible.
pub(super) fn quadratic(model: &Model, u: &[f64]) -> Result<Quadratic, Fault> {
    let mut out = Quadratic {
        forces: vec![0.0; u.len()],
        ..Quadratic::default()
    };
    for body in &model.bodies {
        with_block!(&body.block, block => add_quadratic(body, block, u, &mut out))?;
    }
    Ok(out)
}

fn add_quadratic<const N: usize, B: ElementBlock<N>>(
    body: &BodyModel,
    block: &B,
    u: &[f64],
    out: &mut Quadratic,
) -> Result<(), Fault>
where
    B::Forces: Send,
{
    let (len, alphas) = (block.state_len(), block.alpha_len());
    let still = [Vec3::zeros(); N];
    // Forces and energy at `sign u`.
    type Both<F> = [(F, f64); 2];
    let of = |e: usize| -> Result<Both<B::Forces>, ElementFault> {
        let x = body.displacements(block, e, u);
        let (mut state, mut system) = (vec![0.0; len], B::System::default());
        block.evaluate(e, &still, &mut state, &mut system)?;
        let none = vec![0.0; alphas];
        block.update_alpha(&mut state, &x, 1.0, &none);
        let linear = state[..alphas].to_vec();
        let mut both = [(B::NO_FORCES, 0.0); 2];
        for (sign, (f, energy)) in [1.0, -1.0].into_iter().zip(&mut both) {
            let x = x.map(|x| x * sign);
            let alpha: Vec<f64> = linear.iter().map(|a| sign * a).collect();
            state[..alphas].copy_from_slice(&alpha);
            *energy = block.residual(e, &x, &state, f)?;
            if alphas > 0 {
                // The quadratic strains ask for enhanced ones, too: a step of Newton's method.
                let mut there = state.clone();
                block.evaluate(e, &x, &mut there, &mut system)?;
                block.update_alpha(&mut there, &still, 1.0, &alpha);
                *energy = block.residual(e, &x, &there, &mut B::NO_FORCES.clone())?;
            }
        }
        Ok(both)
    };
    let all: Result<Vec<_>, _> = (0..block.elements())
        .into_par_iter()
        .with_min_len(16)
        .map(of)
        .collect();
    for (e, [(a, plus), (b, minus)]) in (all.map_err(|fault| element_fault(&body.name, fault))?)
        .iter()
        .enumerate()
    {
        out.even += 0.5 * (plus + minus);
        out.odd += 0.5 * (plus - minus);
        let nodes = body.nodes_of(block, e);
        for (at, &n) in nodes.iter().enumerate() {
            for c in 0..3 {
                let f = 0.5 * (a.as_ref()[3 * at + c] + b.as_ref()[3 * at + c]);
                out.forces[3 * n as usize + c] += f;
            }
        }
    }
    Ok(())
}

impl Sums<'_> {
    /// Evaluates and sums the elements of a body.
    fn add<const N: usize, B: ElementBlock<N>>(
        &mut self,
        body: &BodyModel,
        block: &B,
        systems: &mut [B::System],
        states: &mut [f64],
        u: &[f64],
    ) -> Result<(), Fault> {
        let (len, count) = (block.state_len(), block.elements());
        let from = self.from;
        for start in (0..count).step_by(CHUNK) {
            let n = CHUNK.min(count - start);
            let evaluate = |i: usize, out: &mut B::System, s: &mut [f64]| {
                let x = body.displacements(block, start + i, u);
                let correction = from.map(|from| {
                    let before = body.displacements(block, start + i, from);
                    std::array::from_fn(|k| x[k] - before[k])
                });
                block.evaluate_mixed(start + i, &x, correction.as_ref(), s, out)
            };
            let outputs = (systems[..n].par_iter_mut()).with_min_len(8);
            let done = if len == 0 {
                (outputs.enumerate()).try_for_each(|(i, out)| evaluate(i, out, &mut []))
            } else {
                let chunk = &mut states[start * len..(start + n) * len];
                (outputs.zip(chunk.par_chunks_mut(len)).enumerate())
                    .try_for_each(|(i, (out, s))| evaluate(i, out, s))
            };
            done.map_err(|fault| element_fault(&body.name, fault))?;
            for (i, system) in systems[..n].iter_mut().enumerate() {
                self.scatter(start + i, &body.nodes_of(block, start + i), system);
            }
        }
        Ok(())
    }

    /// Adds element `e` of the body.
    #[inline]
    fn scatter<const N: usize>(
        &mut self,
        e: usize,
        nodes: &[u32; N],
        system: &mut impl ElementSystem,
    ) {
        let (f, k, energy) = system.parts();
        *self.energy += energy;
        add_nodes(self.residual, nodes, f);
        let kind = self.kinds[e];
        if kind != Kind::Free
            && let Some(g) = self.increments
        {
            self.dofs.subtract_prescribed(nodes, k, g, self.rhs);
        }
        let map = &self.maps[pairs(N) * e..pairs(N) * (e + 1)];
        match kind {
            Kind::Free => self.matrix.scatter(map, k),
            Kind::Prescribed => {
                (self.dofs)
                    .condense_matrix(nodes, k)
                    .expect("an element without ties has all its nodes");
                self.matrix.scatter(map, k);
            }
            Kind::Tied => (self.matrix)
                .scatter_constrained(nodes, k, self.dofs, self.work)
                .expect("the pattern holds every element with what it is tied to"),
        }
    }
}

fn forces<const N: usize, B: ElementBlock<N>>(
    body: &BodyModel,
    block: &B,
    states: &[f64],
    u: &[f64],
    residual: &mut [f64],
    energy: &mut f64,
) -> Result<(), Fault> {
    let len = block.state_len();
    let mut f = B::NO_FORCES;
    for e in 0..block.elements() {
        let x = body.displacements(block, e, u);
        *energy += block
            .residual(e, &x, &states[e * len..(e + 1) * len], &mut f)
            .map_err(|fault| element_fault(&body.name, fault))?;
        add_nodes(residual, &body.nodes_of(block, e), f.as_ref());
    }
    Ok(())
}

#[inline]
fn add_nodes<const N: usize>(out: &mut [f64], nodes: &[u32; N], f: &[f64]) {
    for (f, &n) in f.chunks_exact(3).zip(nodes) {
        let at = 3 * n as usize;
        (0..3).for_each(|c| out[at + c] += f[c]);
    }
}
