//! Going on: a step at a time or to the end, with whoever receives the steps.
use super::{Simulation, Step, StepError};
use crate::output::{RunStatus, Summary};
use crate::run::RunError;
use crate::run::march::{AcceptedStep, Caller, Outcome};
use crate::run::sink::Sink;
use crate::solve::event::Event;
use std::sync::Arc;

impl Simulation<'_> {
    /// Goes on to the next accepted step, with as many cuts and retries as it takes; `None` once the run has reached its
    /// end time. Where its defaults turn out to be unfit (slave points that miss what lies between them, elements that were too
    /// soft before they gave way), the run begins again at time 0 with others, and what is returned is its first step
    /// ([`Step::attempt`]).
    ///
    /// # Errors
    /// [`StepError`]; the simulation stays at the last accepted step.
    pub fn step(&mut self) -> Result<Option<Step>, StepError> {
        self.step_into(&mut [])
    }

    /// [`step`](Self::step), which hands the accepted step to sinks: the same at every call. They are closed at the end of
    /// the run, where it is not interrupted.
    ///
    /// # Errors
    /// [`StepError`]
    pub fn step_into(&mut self, sinks: &mut [&mut dyn Sink]) -> Result<Option<Step>, StepError> {
        let pool = Arc::clone(&self.pool);
        pool.install(|| {
            loop {
                let step = match self.follow(sinks) {
                    Ok(step) => step,
                    Err(error) => return Err(self.broken(sinks, error).into()),
                };
                let reached = self.done();
                if !reached && step.is_some() {
                    return Ok(step);
                }
                if self.status() == Some(RunStatus::Interrupted) {
                    self.conclude();
                    return Err(StepError::Interrupted);
                }
                if step.is_none() && !reached && self.exchange_elements()? {
                    continue;
                }
                self.close(sinks)?;
                if reached {
                    return Ok(step);
                }
                if !self.begin_again()? {
                    let ending = self.ended.as_ref();
                    let reason = ending.and_then(|e| e.reason.clone()).unwrap_or_default();
                    return Err(StepError::NotConverged { reason });
                }
            }
        })
    }

    /// Goes on to the end, or as far as it gets, and hands every accepted step to the sinks. A run that does not reach its
    /// end returns its summary with a status that says so.
    ///
    /// # Errors
    /// [`RunError`]: what a sink could not write, or a fault of the program.
    pub fn run(&mut self, sinks: &mut [&mut dyn Sink]) -> Result<Summary, RunError> {
        // These sinks have not been told where the run is.
        (self.begun, self.closed) = (false, None);
        loop {
            match self.step_into(sinks) {
                Ok(Some(_)) => {}
                Err(StepError::Run(error)) => return Err(error),
                Ok(None) | Err(StepError::NotConverged { .. } | StepError::Interrupted) => {
                    let pool = Arc::clone(&self.pool);
                    return pool.install(|| self.close(sinks));
                }
            }
        }
    }

    /// The next accepted step, or none where the run has ended, handed to the sinks.
    fn follow(&mut self, sinks: &mut [&mut dyn Sink]) -> Result<Option<Step>, RunError> {
        if !std::mem::replace(&mut self.begun, true) {
            for sink in sinks.iter_mut() {
                self.timed("output", |run| sink.begin(run))?;
                for text in sink.notes() {
                    self.options.observer.event(&Event::Note { text });
                }
            }
            self.keep(sinks)?;
        }
        let step = self.advance()?;
        if step.is_some() {
            for sink in sinks.iter_mut() {
                self.timed("output", |run| sink.step(run))?;
            }
            // A run that ends before its time can be continued before the step that ended it.
            if self.ended.is_none() || self.done() {
                self.keep(sinks)?;
            }
        }
        Ok(step)
    }

    /// Keeps the last accepted step, as long as the scene that was given leads there.
    fn keep(&mut self, sinks: &mut [&mut dyn Sink]) -> Result<(), RunError> {
        if self.steered {
            return Ok(());
        }
        for sink in sinks.iter_mut() {
            self.timed("checkpoint", |run| sink.keep(run))?;
        }
        Ok(())
    }

    /// Says what is known at the end and closes the sinks, once.
    fn close(&mut self, sinks: &mut [&mut dyn Sink]) -> Result<Summary, RunError> {
        if let Some(summary) = &self.closed {
            return Ok(summary.clone());
        }
        self.conclude();
        let mut failure = None;
        for sink in sinks.iter_mut() {
            if let Err(error) = self.timed("output", |run| sink.close(run))
                && failure.is_none()
            {
                self.fail(&error);
                failure = Some(error);
            }
        }
        let summary = self.summary();
        for sink in sinks.iter_mut() {
            let written = sink.summary(self, &summary);
            failure = failure.or(written.err());
        }
        self.closed = Some(summary.clone());
        if let Some(error) = failure {
            return Err(error);
        }
        self.options.observer.event(&Event::Finished {
            status: summary.status.name().to_owned(),
            wall_s: summary.wall_s,
        });
        Ok(summary)
    }

    /// Ends a run that cannot go on by a fault, of a sink or of the program, which is returned.
    fn broken(&mut self, sinks: &mut [&mut dyn Sink], error: RunError) -> RunError {
        self.fail(&error);
        self.conclude();
        for sink in sinks.iter_mut() {
            // The first fault is the one to tell.
            let _ = self.timed("output", |run| sink.close(run));
        }
        let summary = self.summary();
        for sink in sinks.iter_mut() {
            let _ = sink.summary(self, &summary);
        }
        self.closed = Some(summary);
        error
    }

    /// The next accepted step, or none where the run has ended.
    fn advance(&mut self) -> Result<Option<Step>, RunError> {
        if (self.ended.as_ref()).is_some_and(|e| e.status != RunStatus::Interrupted) {
            return Ok(None);
        }
        (self.ended, self.concluded) = (None, false);
        self.closed = None;
        if let Err(error) = self.enter_stage() {
            self.fail(&error);
            return Err(error);
        }
        let caller = Caller {
            observer: &mut *self.options.observer,
            interrupt: self.options.interrupt,
        };
        let outcome = (self.running).with_dependent_mut(|_, run| {
            let (mut march, course) = run.march(caller);
            march.step(course)
        });
        match outcome {
            Ok(Outcome::Accepted(accepted, ending)) => {
                self.ended = ending;
                let observer = &mut *self.options.observer;
                (self.running).with_dependent_mut(|_, run| run.end_stage(observer, false));
                let run = self.running.borrow_dependent();
                self.history.rows.push(run.course.outputs.row.clone());
                let number = run.progress.steps;
                let time = run.progress.time;
                if self.ended.is_none() {
                    self.ended = self.beside_former();
                }
                let AcceptedStep {
                    dt,
                    iterations,
                    cuts,
                } = accepted;
                Ok(Some(Step {
                    number,
                    time,
                    dt,
                    iterations,
                    cuts,
                    attempt: self.attempt,
                }))
            }
            Ok(Outcome::Stopped(ending)) => {
                self.ended = Some(ending);
                Ok(None)
            }
            Err(error) => {
                self.fail(&error);
                Err(error)
            }
        }
    }
}
