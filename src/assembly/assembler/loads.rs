//! Dead loads and follower pressure.
use super::{Assembler, Fault, put};
use crate::model::state::State;

impl Assembler<'_> {
    pub(super) fn loads<const TANGENT: bool>(
        &mut self,
        state: &State,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
    ) -> Result<(), Fault> {
        self.external.fill(0.0);
        for (_, load) in &self.model.dead_loads {
            load.add(time, &mut self.external)?;
        }
        for (index, (_, load)) in self.model.follower_loads.iter().enumerate() {
            let p = load.value.eval(time)?;
            for (i, nodes) in load.faces.iter().enumerate() {
                let x = nodes.map(|n| self.model.position(n as usize, &state.u));
                let f = crate::model::loads::follower_force(&x, p);
                for (k, &n) in nodes.iter().enumerate() {
                    (0..3).for_each(|c| self.external[3 * n as usize + c] += f[3 * k + c]);
                }
                if TANGENT {
                    // The system is symmetric: what is unsymmetric lives on the border of the loaded area only.
                    let k = crate::model::loads::follower_stiffness(&x, p);
                    let mut k = (k + k.transpose()) * -0.5;
                    let map = &self.follower_maps[index][10 * i..10 * (i + 1)];
                    put(
                        &mut self.matrix,
                        self.dofs,
                        &mut self.work,
                        nodes,
                        map,
                        k.as_mut_slice(),
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
