//! Multipliers made of tractions until gaps and slips are within their tolerances.
use super::Attempts;
use crate::model::state::State;
use crate::run::augment::{self, Left};
use crate::solve::event::Event;
use crate::solve::newton::{Converged, First, Patience, StepFailure};

impl Attempts<'_, '_> {
    /// Makes multipliers of the tractions and solves again, until every pair is within its tolerances. Attraction points stay
    /// where they were when the step began.
    pub(super) fn augment(
        &mut self,
        step: u32,
        end: f64,
        trial: &mut State,
        patience: Patience,
        mut converged: Converged,
    ) -> Result<Converged, StepFailure> {
        let (mut all, mut before) = (Vec::new(), Vec::<Left>::new());
        let mut raising = true;
        // Multipliers take the points to where they slide otherwise than they did.
        let slides = self.model.pairs.iter().any(|p| p.friction.is_some());
        let secants = slides.then(|| First {
            secants: true,
            ..First::default()
        });
        loop {
            Left::all(self.model, trial, self.assembler.answers(), &mut all);
            let Some(worst) = (all.iter()).max_by(|a, b| a.relative.total_cmp(&b.relative)) else {
                return Ok(converged);
            };
            self.observer.event(&Event::Augmented {
                step,
                augmentation: converged.augmentations,
                contact: self.model.pairs[worst.pair].name.clone(),
                gap: worst.gap,
                slip: worst.slip,
            });
            let exhausted = |left: &&Left| {
                let augmentation = &self.model.pairs[left.pair].augmentation;
                let max = augmentation.map_or(0, |a| a.max);
                left.relative > 1.0 && converged.augmentations >= max
            };
            if let Some(left) = all.iter().find(exhausted) {
                return Err(left.failure(self.model, converged.augmentations));
            }
            if worst.relative <= 1.0 {
                return Ok(converged);
            }
            augment::take(self.model, self.assembler.answers(), trial);
            let penalties = self.assembler.penalties.clone();
            if raising && self.raise(step, &all, &before) {
                // A penalty that Newton's method cannot follow is taken back.
                let kept = trial.clone();
                self.first = secants;
                let stiff = self.newton(step, end, trial, patience);
                match stiff.and_then(|c| self.none_sunk(end, trial).map(|()| c)) {
                    Ok(next) => converged.augmented(next),
                    Err(StepFailure::Interrupted) => return Err(StepFailure::Interrupted),
                    Err(failure) => {
                        raising = false;
                        self.again(
                            step,
                            "the penalty before it was raised",
                            &failure,
                            &penalties,
                        );
                        trial.copy_from(&kept);
                    }
                }
            }
            if self.assembler.penalties == penalties {
                self.first = secants;
                let next = self.newton(step, end, trial, patience)?;
                self.none_sunk(end, trial)?;
                converged.augmented(next);
            }
            std::mem::swap(&mut all, &mut before);
        }
    }

    /// Raises the penalties of pairs whose last augmentation left too much, and tells; whether there were any.
    fn raise(&mut self, step: u32, now: &[Left], before: &[Left]) -> bool {
        let mut raised = false;
        for (now, before) in now.iter().zip(before) {
            let (pair, left) = (&self.model.pairs[now.pair], now.relative / before.relative);
            let eps = self.assembler.penalties[now.pair];
            if now.relative <= 1.0 {
                continue;
            }
            let Some(penalty) = augment::stiffer(pair, eps, left) else {
                continue;
            };
            self.assembler.penalties[now.pair] = penalty;
            raised = true;
            self.observer.event(&Event::PenaltyRaised {
                step,
                contact: pair.name.clone(),
                penalty,
                left,
            });
        }
        raised
    }
}
