//! Steps that were solved, and came to another equilibrium than the one on their path.
use super::{March, StepControl};
use crate::model::error::number;
use crate::model::state::State;
use crate::run::watch::{Span, Work};
use crate::solve::event::Event;
use crate::solve::newton::{Converged, StepFailure};
use crate::system::linear::{self, Method};

/// Cuts of a step after which it is taken where it came, and told: a large step may have come to another equilibrium than the one
/// on its path. What snaps or buckles does so in smaller steps, too. Where edges of rigid surfaces are slaves every step that
/// jumps is cut: a slave that catches on an edge in a large step slides over it in small ones.
const JUMPS: u32 = 2;
/// Most ways that lead from one unstable equilibrium to another that is less so.
const BRANCHES: u32 = 4;

impl March<'_, '_> {
    /// Why a step that is `large` is to be cut, of which it took `cuts` so far ([`Watch::leapt`](crate::run::watch::Watch::leapt)).
    pub(super) fn astray(
        &self,
        (step, cuts, large): (u32, u32, bool),
        energies: (&Work, f64),
        (span, converged): (&Span, &Converged),
    ) -> Option<StepFailure> {
        if cuts >= JUMPS || !large {
            return None;
        }
        let softened = converged.softened;
        (self.watch).leapt(self.model, step, energies, (span, softened))
    }

    /// Looks at a step that came from a stable equilibrium to one from which a structure would buckle: a strip that is pressed
    /// along its length, whatever small force it has to its side. A large one that came past several such states is cut, another
    /// one goes on to the stable equilibrium beside it; where none is found it stays as it is.
    ///
    /// # Errors
    /// That it is to be cut, the user stops the run, or the step as it was is no longer found.
    pub(super) fn stabler(
        &mut self,
        (step, end, cuts): (u32, f64, u32),
        (committed, walk): (&State, &mut StepControl),
        trial: &mut State,
        converged: &mut Converged,
    ) -> Result<(), StepFailure> {
        let statics = self.model.dynamics.is_none() && self.model.small.is_none();
        if !statics || walk.jump.is_some() {
            return Ok(());
        }
        self.count_negative(converged, step == 1 || cuts > 0 || self.watch.unstable);
        if self.watch.unstable {
            return Ok(());
        }
        let last =
            |converged: &Converged| converged.factorization.filter(|f| f.negative_pivots > 0);
        let mut found = false;
        for _ in 0..BRANCHES {
            let Some(before) = last(converged) else {
                break;
            };
            let mut attempts = self.attempts(committed, &mut walk.habit, 0);
            let Some(stretch) = attempts.buckles(end, trial) else {
                break;
            };
            let far = !found && before.negative_pivots > 1;
            if far && cuts < JUMPS && walk.stepping.large(end - self.progress.time) {
                let tangent = before.indefinite();
                return Err(StepFailure::Unstable { tangent });
            }
            let held = trial.clone();
            match (self.attempts(committed, &mut walk.habit, 0)).departed(step, end, trial, stretch)
            {
                Ok(mut next) => {
                    self.count_negative(&mut next, true);
                    if last(&next).is_none_or(|f| f.negative_pivots < before.negative_pivots) {
                        converged.stiffened(next);
                        found = true;
                        continue;
                    }
                }
                Err(StepFailure::Interrupted) => return Err(StepFailure::Interrupted),
                Err(_) => {}
            }
            trial.copy_from(&held);
            let mut attempts = self.attempts(committed, &mut walk.habit, 0);
            converged.stiffened(attempts.stiffened(step, end, trial)?);
            break;
        }
        if found && last(converged).is_none() {
            let text = format!(
                "step {step} (time {}): the equilibrium that was found first is unstable, as that of a column that stays straight; \
                 the step went on to the stable one beside it (to which side, a small load or an imperfection decides; without any it is \
                 arbitrary)",
                number(end)
            );
            self.observer.event(&Event::Note { text });
        }
        Ok(())
    }

    /// Counts the negative pivots of the last tangent where LU has told nothing of them: an even number leaves the determinant
    /// positive. Only of a `first` attempt of a path and of a step whose residual rose on the way, as it does where a structure
    /// buckles: one such pivot after the other is seen as it comes.
    fn count_negative(&mut self, converged: &mut Converged, first: bool) {
        let mut residuals = converged.history.iter().map(|(residual, _)| *residual);
        let start = residuals.next().unwrap_or(0.0);
        let suspect = first || converged.softened || residuals.any(|residual| residual > start);
        let Some(last) = &mut converged.factorization else {
            return;
        };
        if last.method != Method::Lu || !(suspect || last.negative_pivots > 0) {
            return;
        }
        self.phases.start("factorization");
        let counted = linear::negative_pivots(self.assembler.matrix());
        self.phases.stop("factorization");
        if let Some(counted) = counted.filter(|n| *n > 0) {
            (last.method, last.negative_pivots) = (Method::Ldlt, counted);
        }
    }
}
