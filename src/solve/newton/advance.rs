//! The step along an increment, and the search for how far it goes.
use super::line_search::{self, SMALLEST};
use super::{Newton, StepFailure, dot};
use crate::assembly::{Fault, Totals};
use crate::model::state::State;
use crate::shell::{ElementBlock, with_block};
use crate::system::linear::LinearSolver;
use rayon::prelude::*;

impl<S: LinearSolver + ?Sized> Newton<'_, '_, S> {
    /// Moves `trial` along the increment and linearises there; halves the step where an element or a contact point
    /// cannot follow, and searches along it where asked to, with mixed integration points where asked for, and keeps
    /// points in contact where it asks for that and cannot do without. A body that nothing holds yet goes a part of the way only.
    /// Returns the factor and whether prescribed displacements are still to come.
    pub(super) fn advance(
        &mut self,
        trial: &mut State,
        time: f64,
        (search, mixed, keeps): (bool, bool, bool),
        pending: bool,
        largest: f64,
    ) -> Result<(Totals, f64, bool), StepFailure> {
        self.workspace.base.copy_from(trial);
        let slope = dot(&self.workspace.du, &self.workspace.rhs);
        let stabilization = self.model.stabilization.as_ref();
        let mut s = stabilization.map_or(1.0, |m| m.stride(&self.workspace.du).0);
        if search && s == 1.0 {
            s = self.line_search(trial, time, slope);
        }
        s = s.min(largest);
        let smallest = s * SMALLEST;
        loop {
            self.apply(trial, s);
            let left = pending && s < 1.0;
            if left {
                let increments = &mut self.workspace.increments;
                (self.model.increments(&trial.u, time, increments)).map_err(Fault::from)?;
            }
            // Changes of status count from where the iteration began, whatever was tried in between.
            trial.points.copy_from_slice(&self.workspace.base.points);
            match self.linearize(trial, time, (left, mixed)) {
                Ok(totals) => return Ok((totals, s, left)),
                // A point that cannot be kept in contact where it is now.
                Err(_) if self.assembler.linearization.keep_active => {
                    self.assembler.linearization.keep_active = false;
                }
                Err(fault) => {
                    // What has opened may have been all that holds a surface driven by force.
                    if keeps
                        && !left
                        && let Some(kept) = self.kept(trial, time)
                    {
                        return Ok((kept, s, left));
                    }
                    if s <= smallest {
                        return Err(fault.into());
                    }
                    s *= 0.5;
                }
            }
        }
    }

    /// [`line_search::factor`], on residuals alone.
    fn line_search(&mut self, trial: &mut State, time: f64, slope: f64) -> f64 {
        line_search::factor(slope, |s| {
            self.apply(trial, s);
            self.slope(trial, time).ok()
        })
    }

    /// `-du . residual` at the present trial state.
    pub(super) fn slope(&mut self, trial: &mut State, time: f64) -> Result<f64, Fault> {
        self.phases.start("line_search");
        let w = &mut *self.workspace;
        let result = self.assembler.residual(trial, time, &mut w.scratch);
        self.phases.stop("line_search");
        result?;
        self.model.dofs.fold(&mut w.scratch);
        Ok(-dot(&w.du, &w.scratch))
    }

    /// `trial = base + s du`, element states included.
    pub(super) fn apply(&mut self, trial: &mut State, s: f64) {
        let w = &*self.workspace;
        for ((u, b), d) in trial.u.iter_mut().zip(&w.base.u).zip(&w.du) {
            *u = b + s * d;
        }
        let mut first = 0;
        for body in &self.model.bodies {
            let (len, count) = (body.block.state_len(), body.block.elements());
            let range = first..first + len * count;
            first += len * count;
            if len == 0 {
                continue;
            }
            let (states, base) = (&mut trial.elements[range.clone()], &w.base.elements[range]);
            with_block!(&body.block, block => {
                let alphas = ElementBlock::alpha_len(block);
                (states.par_chunks_mut(len).zip(base.par_chunks(len)).enumerate())
                    .with_min_len(64)
                    .for_each(|(e, (state, from))| {
                        // The condensation cache must be that of the linearisation that produced du.
                        state.copy_from_slice(from);
                        let du = body.displacements(block, e, &w.du);
                        block.update_alpha(state, &du, s, &from[..alphas]);
                    });
            });
        }
    }
}
