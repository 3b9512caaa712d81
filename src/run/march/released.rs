//! Stabilisation that the run brought in by itself is released in every step in which contact does without it.
use super::{March, StepControl};
use crate::model::stabilization::{RELEASED, RELEASES};
use crate::model::state::State;
use crate::solve::event::Event;
use crate::solve::newton::{Converged, StepFailure};

impl March<'_, '_> {
    /// Solves a step again with little of the stabilisation that the run brought in by itself, where that carries anything:
    /// contact may hold by now what it was to hold. Where it does not, the step stays as it is.
    ///
    /// # Errors
    /// Only where the user stops the run, or the step as it was is no longer found.
    pub(super) fn released(
        &mut self,
        (step, end): (u32, f64),
        (committed, walk): (&State, &mut StepControl),
        trial: &mut State,
        converged: &mut Converged,
    ) -> Result<(), StepFailure> {
        let releases = (self.model.stabilization.as_ref()).is_some_and(|s| s.released);
        let carries = || {
            let residual = self.workspace.residual();
            let drag = self.assembler.drag(&trial.u, residual);
            // Metal that flows answers to a little force by a lot.
            let carried = match self.model.flows() {
                true => drag.beside_loads,
                false => drag.share,
            };
            carried > RELEASES[0] && drag.share < RELEASES[1]
        };
        if !releases || !self.assembler.stabilizes() || !carries() {
            return Ok(());
        }
        let held = trial.clone();
        let scale = |march: &mut Self, factor: f64| {
            let viscous = march.assembler.effects.viscous.iter_mut();
            viscous.for_each(|v| v.scale(factor));
        };
        scale(self, RELEASED);
        match (self.attempts(committed, &mut walk.habit, 0)).stiffened(step, end, trial) {
            Ok(next) => converged.stiffened(next),
            Err(StepFailure::Interrupted) => return Err(StepFailure::Interrupted),
            Err(failure) => {
                scale(self, 1.0 / RELEASED);
                self.observer.event(&Event::StepRetried {
                    step,
                    start: "the stabilization before it was released".to_owned(),
                    reason: failure.to_string(),
                });
                trial.copy_from(&held);
                let again =
                    (self.attempts(committed, &mut walk.habit, 0)).stiffened(step, end, trial);
                converged.stiffened(again?);
            }
        }
        Ok(())
    }
}
