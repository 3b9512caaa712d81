//! The way from an equilibrium that is unstable to the stable one beside it.
//!
//! A strip that is pressed along its length stays straight in equilibrium beyond the load under which it buckles, and Newton's method
//! from a state that is nearly straight finds just that. There the energy falls along the directions in which the tangent has
//! negative curvature; the method of Lanczos with the inverse of the tangent finds the one with the most of it. Along it the energy
//! falls to a minimum, beside which the bent equilibrium lies.
use super::{Newton, StepFailure, dot};
use crate::model::state::State;
use crate::system::linear::LinearSolver;
use nalgebra::DMatrix;

/// Vectors of the method of Lanczos at most, and the part of a vector below which those before it hold all of it.
const VECTORS: usize = 20;
const NEW: f64 = 1e-8;
/// Part of an eigenvalue by which it may still be off.
const SETTLED: f64 = 0.1;
/// Part of the largest displacement by which neighbouring nodes may move against each other where a structure buckles: a wave of some
/// twelve elements does so by half. Shorter ones are those of elements that give way themselves.
const SMOOTH: f64 = 0.5;
/// First and largest way along the direction: part of their distance by which it moves neighbouring nodes against each other.
const FIRST: f64 = 1e-5;
const LARGEST: f64 = 0.5;

impl<S: LinearSolver + ?Sized> Newton<'_, '_, S> {
    /// Moves `trial`, an equilibrium, along the direction that [`Self::falling`] has just found there, whose stretch this is, to where
    /// its energy falls no longer.
    ///
    /// # Errors
    /// It does not fall along it.
    pub fn depart(
        &mut self,
        trial: &mut State,
        stretch: f64,
        time: f64,
    ) -> Result<(), StepFailure> {
        let (mut s, most) = (FIRST / stretch, LARGEST / stretch);
        let (mut low, mut high) = (None, None);
        while s < most {
            self.apply(trial, s);
            // How the energy falls there; nothing where the state is impossible.
            match self.slope(trial, time) {
                Ok(slope) if slope > 0.0 => low = Some((s, slope)),
                other => {
                    high = Some((s, other.ok()));
                    break;
                }
            }
            s *= 2.0;
        }
        let (a, falls) = low.ok_or_else(|| StepFailure::Unstable {
            tangent: "the energy falls in no direction".to_owned(),
        })?;
        let way = match high {
            Some((b, Some(rises))) => a + (b - a) * falls / (falls - rises),
            _ => a,
        };
        self.apply(trial, way);
        Ok(())
    }

    /// A direction of negative curvature at the equilibrium `trial`, into `du`, towards where the state was `before` of both ways;
    /// and by how much of their distance it moves neighbouring nodes against each other. Nothing where there is none, or elements
    /// give way and not the structure.
    pub fn falling(&mut self, trial: &mut State, before: &[f64], time: f64) -> Option<f64> {
        self.linearize(trial, time, (false, false)).ok()?;
        self.factorize().ok()?;
        self.workspace.base.copy_from(trial);
        let dofs = &self.model.dofs;
        let w = &mut *self.workspace;
        let towards = |du: &mut [f64], base: &[f64]| {
            for ((d, u), was) in du.iter_mut().zip(base).zip(before) {
                *d = was - u;
            }
        };
        towards(&mut w.du, &w.base.u);
        dofs.fold(&mut w.du);
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut inverse = DMatrix::zeros(VECTORS, VECTORS);
        let mut size = dot(&w.du, &w.du).sqrt();
        let mut whole = size;
        while basis.len() < VECTORS && size > NEW * whole {
            basis.push(w.du.iter().map(|d| d / size).collect());
            let last = basis.len() - 1;
            w.du.copy_from_slice(&basis[last]);
            self.solver.solve_in_place(&mut w.du).ok()?;
            whole = dot(&w.du, &w.du).sqrt();
            for (k, v) in basis.iter().enumerate() {
                let along = dot(&w.du, v);
                inverse[(k, last)] = along;
                inverse[(last, k)] = along;
                w.du.iter_mut().zip(v).for_each(|(d, v)| *d -= along * v);
            }
            size = dot(&w.du, &w.du).sqrt();
        }
        let inverse = inverse.resize(basis.len(), basis.len(), 0.0);
        if basis.is_empty() || !inverse.iter().all(|v: &f64| v.is_finite()) {
            return None;
        }
        let found = inverse.symmetric_eigen();
        // The curvature is the reciprocal; one that is not settled yet may be any.
        let unsettled = |k: &usize| size * found.eigenvectors[(basis.len() - 1, *k)].abs();
        let falls = (0..basis.len()).filter(|k| {
            let inverse = found.eigenvalues[*k];
            inverse < 0.0 && unsettled(k) <= SETTLED * -inverse
        });
        let most = falls.max_by(|a, b| found.eigenvalues[*a].total_cmp(&found.eigenvalues[*b]))?;
        w.du.fill(0.0);
        for (v, part) in basis.iter().zip(found.eigenvectors.column(most).iter()) {
            w.du.iter_mut().zip(v).for_each(|(d, v)| *d += part * v);
        }
        dofs.expand(&mut w.du, None);
        towards(&mut w.scratch, &w.base.u);
        if dot(&w.scratch, &w.du) < 0.0 {
            w.du.iter_mut().for_each(|d| *d = -*d);
        }
        let nodes = 3 * self.model.body_nodes();
        let largest = (w.du[..nodes].as_chunks::<3>().0.iter())
            .map(|[x, y, z]| (x * x + y * y + z * z).sqrt())
            .fold(0.0, f64::max);
        let [stretch, apart] = self.model.largest_stretches(&w.du);
        (stretch > 0.0 && apart <= SMOOTH * largest).then_some(stretch)
    }
}
