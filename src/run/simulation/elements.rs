//! Going on with other elements for bodies whose default ones give way, from the last accepted step: the run begins again at time 0
//! where that is no equilibrium beside theirs.
use super::again::is_block;
use super::variant::{BEGUN, WENT_ON, safe_variant};
use super::{Rims, Running, Simulation, problem};
use crate::plan::Plan;
use crate::run::RunError;
use crate::run::history;
use crate::run::march::{Caller, RunState, Unlike};

impl Simulation<'_> {
    /// Goes on with other elements for those bodies that a step was not accepted for; whether it does.
    pub(super) fn exchange_elements(&mut self) -> Result<bool, RunError> {
        let Some(ending) = &self.ended else {
            return Ok(false);
        };
        let squeezed = ending.squeezed.clone();
        let bodies = &self.model().bodies;
        let may = match self.rims {
            Rims::Out | Rims::Settled => true,
            // As for a run that begins again.
            Rims::Instead => squeezed.iter().all(|&b| is_block(bodies, &bodies[b].name)),
            Rims::Last => false,
        };
        let waits = |safe: &super::Safe| safe.former.is_some() || !safe.kept.is_empty();
        if squeezed.is_empty() || !may || self.safe.as_ref().is_some_and(waits) {
            return Ok(false);
        }
        let names = squeezed.iter().map(|&b| bodies[b].name.as_str());
        let found = (self.time(), &self.history, false);
        let Some(mut safe) = safe_variant(&self.scene, self.safe.as_ref(), names, found) else {
            return Ok(false);
        };
        safe.former = None;
        let before = self.safe.as_ref().map_or(0, |safe| safe.changed.len());
        for text in &mut safe.changed[before..] {
            *text = text.replace(BEGUN, WENT_ON);
        }
        let other = (self.running).with_dependent_mut(|_, run| run.for_elements(&squeezed))?;
        let Some(other) = other else {
            return Ok(false);
        };
        let mut model = other.model(&safe.loaded)?;
        model.warnings.clone_from(&self.model().warnings);
        if history::columns(&model) != self.history.columns {
            let text = "other elements have other columns of the history".to_owned();
            return Err(RunError::Internal(text));
        }
        let plan = Plan::new(&safe.loaded, &model);
        let stage = model.stage.as_ref().map(|stage| stage.start.clone());
        let built = (model, plan, stage.unwrap_or_default());
        let next = problem(&self.scene, (&safe.loaded, Some(&safe)), built, self.rims);
        let (threads, observer) = (rayon::current_num_threads(), &mut *self.options.observer);
        let made = Running::try_new(Box::new(next), |problem| {
            RunState::with_elements(problem, other, threads, observer)
        });
        match made {
            Ok(running) => self.running = running,
            Err(Unlike::Run(error)) => return Err(error),
            Err(Unlike::Found(spent)) => {
                (self.running).with_dependent_mut(|_, run| run.back(*spent));
                return Ok(false);
            }
        }
        self.ended = None;
        let caller = Caller {
            observer: &mut *self.options.observer,
            interrupt: self.options.interrupt,
        };
        (self.running).with_dependent_mut(|_, run| {
            let (mut march, _) = run.march(caller);
            let texts = safe.changed[before..].iter();
            texts.for_each(|text| march.warn(text.clone()));
        });
        self.safe = Some(safe);
        Ok(true)
    }
}
