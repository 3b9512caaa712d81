//! From one stage of the scene to the next: the run goes on with another model.
use super::{Running, Simulation};
use crate::run::RunError;
use crate::run::history;
use crate::run::march::{Problem, RunState};

impl Simulation<'_> {
    /// Goes on to the next stage, where the last accepted step ended one.
    ///
    /// # Errors
    /// A body that nothing holds in the stage, what has no room in memory, or a fault of the program.
    pub(super) fn enter_stage(&mut self) -> Result<(), RunError> {
        if !self.run_state().stage_is_over() {
            return Ok(());
        }
        let mut hand = (self.running).with_dependent_mut(|_, run| run.hand_over())?;
        let Problem {
            loaded,
            plan,
            replaceable,
            exchangeable,
            may_see,
            patience,
            changes,
            ..
        } = &**self.running.borrow_owner();
        let (mut model, state) = hand.next(loaded)?;
        model.warnings.clone_from(&self.model().warnings);
        if history::columns(&model) != self.history.columns {
            let text = "a stage has other columns of the history than the first".to_owned();
            return Err(RunError::Internal(text));
        }
        let problem = Box::new(Problem {
            loaded: loaded.clone(),
            model,
            plan: plan.clone(),
            replaceable: replaceable.clone(),
            exchangeable: *exchangeable,
            may_see: may_see.clone(),
            patience: *patience,
            changes: changes.clone(),
        });
        let (threads, observer) = (rayon::current_num_threads(), &mut *self.options.observer);
        self.running = Running::try_new(problem, |problem| {
            RunState::enter(problem, hand, state, threads, observer)
        })?;
        Ok(())
    }
}
