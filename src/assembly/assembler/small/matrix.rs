//! The system with a set of points in contact.
use super::super::{Assembler, Fault};
use super::friction;
use crate::contact::law::PairLaw;
use crate::model::state::State;

impl<L: PairLaw> Assembler<'_, L> {
    /// The system with the set of points in contact that `state` says are, which is then factorized; with friction it is the
    /// tangent where the residual was evaluated last.
    ///
    /// # Errors
    /// [`Fault::Pattern`], which no model has.
    pub fn small_matrix(&mut self, state: &State) -> Result<(), Fault> {
        let model = self.model;
        let (Some(linear), Some(small)) = (self.linear.as_deref_mut(), &model.small) else {
            return Ok(());
        };
        // Until the solver says so.
        linear.factored = None;
        let (base, transposed) = linear.base.split_at(self.matrix.values().len());
        self.matrix.values_mut().copy_from_slice(base);
        if let Some(values) = self.matrix.transposed_values_mut() {
            values.copy_from_slice(transposed);
        }
        let (mut nodes, mut weights, mut ke) = (Vec::new(), Vec::new(), Vec::new());
        let mut first = 0;
        for (index, (pair, own)) in model.pairs.iter().zip(&small.pairs).enumerate() {
            let range = first..first + pair.points.len();
            first = range.end;
            let rubbing = friction::of_pair(&linear.rubbing, model, state, index);
            for (i, (p, state)) in pair.points.iter().zip(&state.points[range]).enumerate() {
                let (true, Some(at)) = (state.closed, &own.points[i]) else {
                    continue;
                };
                nodes.clear();
                weights.clear();
                nodes.extend_from_slice(&p.nodes[..usize::from(p.count)]);
                weights.extend_from_slice(&p.shape[..usize::from(p.count)]);
                for &(node, w) in own.master(i) {
                    nodes.push(node);
                    weights.push(-w);
                }
                let k = at.normal * at.normal.transpose() * (self.penalties[index] * p.area);
                ke.clear();
                match rubbing.and_then(|rubbing| rubbing[i].of()) {
                    None => {
                        for b in &weights {
                            for c in 0..3 {
                                for a in &weights {
                                    ke.extend((0..3).map(|r| a * b * k[(r, c)]));
                                }
                            }
                        }
                    }
                    Some(rubs) => {
                        let k = k + rubs.tangent * p.area;
                        friction::assemble(&k, &at.normal, &weights, own.arms(i), &mut ke);
                    }
                }
                (self.matrix).scatter_constrained(&nodes, &ke, self.dofs, &mut self.work)?;
            }
        }
        self.matrix.set_identities(self.dofs);
        Ok(())
    }
}
