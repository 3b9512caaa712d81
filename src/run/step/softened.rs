//! Starts from a softened penalty, which is brought back in stages.
use super::Attempts;
use crate::assembly::Linearization;
use crate::model::state::State;
use crate::run::{augment, penalty_rule};
use crate::solve::newton::{Converged, Patience, StepFailure};

/// The softest start, as a multiple of the penalty, with its stages; and the stiffest one.
const SOFTEST: [f64; 3] = [1e-3, 1e-2, 1e-1];
const STIFFEST: f64 = 0.1;
/// Part of an element that points may sink in at the first stage, under the pressures of the last accepted state. Where they sink
/// in farther, bodies that are about as stiff as the penalty of that stage spring back, and the start is far from both states.
const SINKS: f64 = 0.05;
/// First stage from which on there are two of them.
const FEW: f64 = 0.01;

impl Attempts<'_, '_> {
    pub(super) fn softened(
        &mut self,
        step: u32,
        end: f64,
        trial: &mut State,
        penalties: &[f64],
    ) -> Result<Converged, StepFailure> {
        let (mut iterations, mut factorization) = (0, None);
        // The last stage that was solved, where the run may keep its penalties.
        let chooses = penalty_rule::rules_all(self.model);
        let mut kept: Option<(State, Vec<f64>)> = None;
        let stages = self.stages(trial)?;
        // A stage is a start and no more. Those of sheets take long, and end at less; elsewhere that has cost as much as it saved.
        let sheets = self.model.bodies.iter().any(|b| b.block.sheet().is_some());
        let patience = if sheets {
            Patience::Rough
        } else {
            Patience::Long
        };
        for (i, stage) in stages.into_iter().enumerate() {
            let full = stage.into_iter().zip(penalties);
            for (eps, (part, full)) in self.assembler.penalties.iter_mut().zip(full) {
                *eps = part * full;
            }
            if i == 0 {
                self.restart(end, trial)?;
                augment::forget(self.model, trial);
            }
            match self.newton(step, end, trial, patience) {
                Ok(converged) => {
                    iterations += converged.iterations;
                    factorization = converged.factorization.or(factorization);
                }
                Err(failure) => return self.eased(step, end, trial, kept, failure, penalties),
            }
            if chooses {
                kept = Some((trial.clone(), self.assembler.penalties.clone()));
            }
        }
        self.assembler.penalties.copy_from_slice(penalties);
        match self.converge(step, end, trial, Patience::Long) {
            Ok(mut converged) => {
                converged.iterations += iterations;
                converged.factorization = converged.factorization.or(factorization);
                converged.softened = true;
                Ok(converged)
            }
            Err(failure) => self.eased(step, end, trial, kept, failure, penalties),
        }
    }

    /// Goes back to the last stage of a softened start that was solved, after the next one failed.
    fn eased(
        &mut self,
        step: u32,
        end: f64,
        trial: &mut State,
        kept: Option<(State, Vec<f64>)>,
        failure: StepFailure,
        full: &[f64],
    ) -> Result<Converged, StepFailure> {
        let Some((state, penalties)) = kept.filter(|_| failure != StepFailure::Interrupted) else {
            return Err(failure);
        };
        self.again(step, "the penalty of the last stage", &failure, &penalties);
        trial.copy_from(&state);
        let mut converged = match self.converge(step, end, trial, Patience::Long) {
            Ok(converged) => converged,
            Err(StepFailure::Interrupted) => return Err(StepFailure::Interrupted),
            // What falls through under so soft a penalty says nothing of the full one.
            Err(_) => return Err(failure),
        };
        converged.softened = true;
        converged.eased = true;
        self.rule.reject(&penalties, full, None);
        Ok(converged)
    }

    /// The stages of a start, each with its multiple of the penalty of every pair. `trial` is used up.
    fn stages(&mut self, trial: &mut State) -> Result<Vec<Vec<f64>>, StepFailure> {
        let pairs = &self.model.pairs;
        let mut first = vec![SOFTEST[0]; pairs.len()];
        if self.model.small.is_none() && self.committed.points.iter().any(|p| p.closed) {
            trial.copy_from(self.committed);
            self.assembler.linearization = Linearization::default();
            let mut unused = vec![0.0; trial.u.len()];
            let totals = self
                .assembler
                .residual(trial, self.progress.time, &mut unused)?;
            for (first, (pair, sunk)) in first.iter_mut().zip(pairs.iter().zip(&totals.penetration))
            {
                *first = (sunk / (SINKS * pair.element_size)).clamp(SOFTEST[0], STIFFEST);
            }
        }
        let softest = first.iter().copied().fold(STIFFEST, f64::min);
        let stages = if softest < FEW { 3 } else { 2 };
        let stage = |k: usize| {
            let part = |first: &f64| match *first <= SOFTEST[0] {
                true if stages == 3 => SOFTEST[k],
                _ => first.powf(1.0 - k as f64 / stages as f64),
            };
            first.iter().map(part).collect()
        };
        Ok((0..stages).map(stage).collect())
    }
}
