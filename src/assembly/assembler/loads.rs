//! Dead loads and follower pressure.
use super::elements::pairs;
use super::{Assembler, Fault, put};
use crate::contact::law::PairLaw;
use crate::model::loads::{follower_force, follower_stiffness};
use crate::model::sheet_pressure::DOFS;
use crate::model::state::State;
use covact_geometry::Vec3;

impl<L: PairLaw> Assembler<'_, L> {
    pub(super) fn loads<const TANGENT: bool>(
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
        // On the matrix side a load's stiffness counts negative. A symmetric system takes the symmetric part: what is
        // unsymmetric lives on the border of the loaded area, which is held there.
        let on_matrix: fn(&mut [f64], usize) = match self.matrix.is_symmetric() {
            true => negative_symmetric,
            false => |k, _| k.iter_mut().for_each(|k| *k = -*k),
        };
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
                    follower_stiffness(&x, face.count, p, &mut k);
                    let size = 3 * nodes.len();
                    on_matrix(&mut k[..size * size], size);
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
        for (index, (_, load)) in self.model.follower_loads.iter().enumerate() {
            if !load.spans.is_empty() {
                let pressure = load.value.eval(time)?;
                let at = load.faces.iter().map(|f| pairs(f.nodes().len())).sum();
                self.press_spans::<TANGENT>(index, (pressure, at), &state.u, increments, rhs);
            }
        }
        self.driving(state, time)?;
        for (r, f) in residual.iter_mut().zip(&self.external) {
            *r -= f;
        }
        Ok(())
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Pressure that follows faces of sheets; their blocks begin at place `at` of the load's map.
    #[cold]
    fn press_spans<const TANGENT: bool>(
        &mut self,
        index: usize,
        (pressure, mut at): (f64, usize),
        u: &[f64],
        increments: Option<&[f64]>,
        rhs: &mut [f64],
    ) {
        let model = self.model;
        let (mut f, mut k) = ([0.0; DOFS], Box::new([0.0; DOFS * DOFS]));
        for span in &model.follower_loads[index].1.spans {
            let nodes = span.nodes();
            let x = nodes.map(|n| model.position(n as usize, u));
            span.force(&x, pressure, &mut f, TANGENT.then_some(&mut *k));
            for (f, &n) in f.chunks_exact(3).zip(nodes) {
                (0..3).for_each(|c| self.external[3 * n as usize + c] += f[c]);
            }
            if !TANGENT {
                continue;
            }
            match self.matrix.is_symmetric() {
                true => negative_symmetric(&mut k[..], DOFS),
                false => k.iter_mut().for_each(|k| *k = -*k),
            }
            let count = pairs(nodes.len());
            let map = &self.follower_maps[index][at..at + count];
            at += count;
            put(
                &mut self.matrix,
                self.dofs,
                &mut self.work,
                nodes,
                map,
                &mut k[..],
                increments,
                rhs,
            );
        }
    }
}

/// `-(k + k^t) / 2` in place of `k` of `size` rows.
fn negative_symmetric(k: &mut [f64], size: usize) {
    for column in 0..size {
        for row in 0..=column {
            let [upper, lower] = [column * size + row, row * size + column];
            k[upper] = -0.5 * (k[upper] + k[lower]);
            k[lower] = k[upper];
        }
    }
}
