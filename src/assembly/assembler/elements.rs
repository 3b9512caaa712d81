//! Elements: evaluated in parallel a chunk at a time, summed in order.
use super::{Assembler, CHUNK, Fault, Kind, PAIRS, Totals, add_nodes, element_fault};
use crate::model::state::State;
use crate::shell::H8System;
use rayon::prelude::*;

impl Assembler<'_> {
    pub(super) fn elements(
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
}
