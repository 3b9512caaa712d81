//! Elements that are pressed at the end of a step otherwise than at its start.
use super::{March, StepControl};
use crate::assembly::Fault;
use crate::contact::friction::history::PointHistory;
use crate::model::state::State;
use crate::run::RunError;
use crate::solve::newton::{Converged, StepFailure};

/// Times that a step is solved again for that.
const SOLVED_AGAIN: usize = 12;
/// Change of the shares that elements take off their thickness strain which is left to the next step, and where nothing comes after.
const LEFT: [f64; 2] = [1e-3, 1e-6];
/// Part of the strain energy by which elements would still change theirs from which on it is told: forces are off by about as much.
const TOLD: f64 = 1e-2;
const NOT_PRESSED: &str = "elements that are pressed on both faces could not take all of what presses on them into their thickness strain, \
                           and may give way: a smaller step may do it, and elements of `h8_mean_dilatation` need none";

/// What was done for elements that are pressed in a step.
#[derive(Default)]
pub(super) struct Pressing {
    /// Whether it was.
    done: bool,
    /// Whether the step was solved again for that.
    pub again: bool,
    pub reshaped: Reshaped,
}

/// What elements came to by taking other strains in a step.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reshaped {
    /// By how much their energy changed (energy).
    pub energy: f64,
    /// The same of what was left, since the step had no equilibrium with it (energy).
    pub left: f64,
}

impl March<'_, '_> {
    /// Solves a step again, once in each, until its elements have the strains of what presses on them at its end; returns whether it was
    /// solved again, from the histories that it began with, as `trial` has then.
    pub(super) fn press(
        &mut self,
        pressing: &mut Pressing,
        (step, end, turns_or_ends): (u32, f64, [bool; 2]),
        (committed, walk): (&State, &mut StepControl),
        (trial, histories): (&mut State, &mut Vec<PointHistory>),
        converged: &mut Converged,
    ) -> Result<Result<bool, StepFailure>, RunError> {
        if std::mem::replace(&mut pressing.done, true) || !trial.may_be_pressed(self.model) {
            return Ok(Ok(false));
        }
        let left = LEFT[usize::from(turns_or_ends.contains(&true))];
        for round in 0..=SOLVED_AGAIN {
            let mut next = trial.elements.clone();
            let [change, energy] = (trial.press(self.model, &mut next))
                .map_err(|(body, fault)| RunError::internal(&Fault::Element { body, fault }))?;
            pressing.reshaped.left = if change > left { energy } else { 0.0 };
            if change <= left || round == SOLVED_AGAIN {
                break;
            }
            if !std::mem::replace(&mut pressing.again, true) {
                std::mem::swap(&mut trial.histories, histories);
            }
            let before = trial.clone();
            trial.elements = next;
            match (self.attempts(committed, &mut walk.habit, 0)).stiffened(step, end, trial) {
                Ok(next) => converged.stiffened(next),
                Err(StepFailure::Interrupted) => return Ok(Err(StepFailure::Interrupted)),
                // It is taken as it was, and goes on from there.
                Err(_) => {
                    trial.copy_from(&before);
                    match (self.attempts(committed, &mut walk.habit, 0)).stiffened(step, end, trial)
                    {
                        Ok(next) => converged.stiffened(next),
                        Err(failure) => return Ok(Err(failure)),
                    }
                    break;
                }
            }
            pressing.reshaped.energy += energy;
        }
        Ok(Ok(pressing.again))
    }

    /// Tells of a step in which elements did not come to the strains of what presses on them.
    pub(in crate::run::march) fn tell_left(&mut self, step: u32, left: f64, stored: f64) {
        if left.abs() > TOLD * stored {
            self.warn_of_step(step, NOT_PRESSED);
        }
    }
}
