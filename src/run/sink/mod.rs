//! Where results of a run go: whoever wants files, or anything else of every step, gives the run a sink.
mod folder;

pub use folder::ResultsFolder;

use super::{RunError, Simulation};
use crate::output::Summary;

/// Receives a run as it goes on. [`Simulation::run`] calls it at the start, at every accepted step and at the end.
pub trait Sink: Send {
    /// The run is at its start, or where it goes on from. Called again where a run begins again with other elements: what
    /// was received before counts no more.
    ///
    /// # Errors
    /// What ends the run as failed.
    fn begin(&mut self, run: &Simulation) -> Result<(), RunError> {
        let _ = run;
        Ok(())
    }

    /// What there is to tell of the start, in words; told once as notes.
    fn notes(&mut self) -> Vec<String> {
        Vec::new()
    }

    /// A step was accepted.
    ///
    /// # Errors
    /// What ends the run as failed.
    fn step(&mut self, run: &Simulation) -> Result<(), RunError>;

    /// Every sink has received the step: the place for a checkpoint, which is then no newer than what it goes on from.
    ///
    /// # Errors
    /// What ends the run as failed.
    fn keep(&mut self, run: &Simulation) -> Result<(), RunError> {
        let _ = run;
        Ok(())
    }

    /// The run has ended ([`Simulation::status`]), whether it reached its end or not.
    ///
    /// # Errors
    /// What makes the run a failed one.
    fn close(&mut self, run: &Simulation) -> Result<(), RunError> {
        let _ = run;
        Ok(())
    }

    /// The account of the run, once every sink is closed.
    ///
    /// # Errors
    /// What is returned to the caller of the run.
    fn summary(&mut self, run: &Simulation, summary: &Summary) -> Result<(), RunError> {
        let _ = (run, summary);
        Ok(())
    }
}
