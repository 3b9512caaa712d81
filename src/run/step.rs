//! One step, from the cheapest start that gets there.
//!
//! 1. The path so far, continued: rotations are then right to second order, and a smooth path takes three or four
//!    iterations.
//!    Points that were in contact and that it takes off a surface are kept in contact by the first linearisation:
//!    where the path fails as it is, and in the steps after one that needed it.
//! 2. The last accepted state under a soft penalty that is stiffened in stages. A flat tool on a flat sheet touches at
//!    hundreds of points of which a handful stay: under a stiff penalty the points chatter, under a soft one the few
//!    come out, and each stage starts from nearly the right ones.
//! 3. The last accepted state as it is, which comes before the soft penalty where there is no path yet. With friction the first
//!    linearisations take secants. Points are kept in contact in the first iterations where the first correction opens most of them.
//! 4. The last accepted state, searching along every increment: a strip that snaps from one support to the next is thrown far by
//!    a full step. It is tried where a step has been cut, before the softened penalty where that has cost more
//!    ([`super::habit`]), and goes on in the steps after one that it has solved, until one fails. Where a material flows all starts
//!    search.
//!
//! Where the first of these has failed again and again, the one that has lately solved steps in the fewest iterations comes before
//! it for some steps. Later ones that have failed again and again are left out of some attempts ([`super::habit`]).
//!
//! Where the last stages fail and the run may choose the penalties, the last stage that was solved is what the step gets:
//! whether its penalties serve is measured by [`super::penalty_rule`]. What fails all four is cut.
mod augmenting;
mod buckled;
mod continuing;
mod softened;
mod starts;

use super::habit::Habit;
use super::penalty_rule::PenaltyRule;
use super::progress::Progress;
use super::tunneling;
use super::validity;
use super::watch::Span;
use crate::assembly::{Assembler, Fault};
use crate::contact::law::Penalty;
use crate::machine::clock::Phases;
use crate::model::Model;
use crate::model::driven::press::{Placed, Presser};
use crate::model::state::State;
use crate::scene;
use crate::solve::event::{Event, Observer};
use crate::solve::newton::{Converged, First, Patience, StepFailure, Workspace};
use crate::solve::place;
use crate::system::linear::LinearSolver;
use nalgebra::Vector6;
use starts::{Start, another};
use std::sync::atomic::AtomicBool;

/// Times a penalty that lets points fall through their master may be raised within a step, and the factor.
const DEEPER: (usize, f64) = (4, 10.0);

/// The attempts at one step.
pub(super) struct Attempts<'a, 'm> {
    pub model: &'m Model,
    /// The last accepted state.
    pub committed: &'a State,
    pub assembler: &'a mut Assembler<'m>,
    pub solver: &'a mut dyn LinearSolver,
    pub workspace: &'a mut Workspace,
    pub settings: &'a scene::Newton,
    pub phases: &'a mut Phases,
    pub interrupt: &'a AtomicBool,
    pub observer: &'a mut (dyn Observer + Send),
    pub progress: &'a mut Progress,
    pub rule: &'a mut PenaltyRule,
    /// For the first Newton iterations of a start.
    pub first: Option<First>,
    pub habit: &'a mut Habit,
    /// How often the step has been cut.
    pub cuts: u32,
    /// Whether the last start opened points that were in contact.
    pub opened: bool,
    /// Whether the next Newton iterations may have mixed integration points.
    pub mixed: bool,
    /// Whether most of the last ones had them.
    pub was_mixed: bool,
    /// The next Newton iterations start beside the state that was solved for, where its energy is lower along a direction of this
    /// stretch.
    pub departs: Option<f64>,
}

impl Attempts<'_, '_> {
    /// Solves the step that ends at `end`; `trial` is its state on success and of no use after a failure. Penalties are
    /// as before on failure.
    pub fn solve(
        &mut self,
        step: u32,
        end: f64,
        dt: f64,
        before: Option<&(State, f64)>,
        trial: &mut State,
    ) -> Result<Converged, StepFailure> {
        let penalties = self.assembler.penalties.clone();
        let result = match validity::turns(self.model, end - dt, end) {
            Ok(None) => self.deeper(step, end, dt, before, trial),
            Ok(Some(failure)) => Err(failure),
            Err(error) => Err(Fault::from(error).into()),
        };
        result.map_err(|failure| {
            self.assembler.penalties.copy_from_slice(&penalties);
            let StepFailure::Fault(Fault::Value(error)) = failure else {
                return failure;
            };
            match place::without_value(self.model, self.committed, end, &error) {
                Some(pointer) => StepFailure::NoValue { pointer, error },
                None => StepFailure::Fault(Fault::Value(error)),
            }
        })
    }

    /// The attempts, and again under stiffer penalties where those that the run may choose let points fall through.
    fn deeper(
        &mut self,
        step: u32,
        end: f64,
        dt: f64,
        before: Option<&(State, f64)>,
        trial: &mut State,
    ) -> Result<Converged, StepFailure> {
        let (raises, factor) = DEEPER;
        for _ in 0..raises {
            let penalties = self.assembler.penalties.clone();
            let failure = match self.attempt(step, end, dt, before, trial, &penalties) {
                Err(failure) => failure,
                done => return done,
            };
            let mut stiffer = penalties.clone();
            for (pair, eps) in self.model.pairs.iter().zip(&mut stiffer) {
                if let Some(ruled) = pair.ruled
                    && failure.fell_through(&pair.name)
                {
                    *eps = (factor * *eps).min(ruled.stiffest).max(*eps);
                }
            }
            if stiffer == penalties {
                return Err(failure);
            }
            self.again(step, "a stiffer penalty", &failure, &stiffer);
        }
        let penalties = self.assembler.penalties.clone();
        self.attempt(step, end, dt, before, trial, &penalties)
    }

    fn attempt(
        &mut self,
        step: u32,
        end: f64,
        dt: f64,
        before: Option<&(State, f64)>,
        trial: &mut State,
        penalties: &[f64],
    ) -> Result<Converged, StepFailure> {
        if self.model.small.is_some() {
            // The answer does not depend on the start.
            trial.copy_from(self.committed);
            let result = self.penalized(step, end, trial, Patience::Long);
            let slides = self.model.pairs.iter().any(|p| p.friction.is_some());
            let failure = match result {
                Err(failure) if slides && another(&failure) => failure,
                result => return result,
            };
            self.again(step, "secants of friction", &failure, penalties);
            trial.copy_from(self.committed);
            self.first = Some(First {
                secants: true,
                ..First::default()
            });
            return self.penalized(step, end, trial, Patience::Long);
        }
        let touching = !self.model.pairs.is_empty();
        let at = (step, end, dt);
        // The path of a body that nothing holds yet may lead through what it is to meet.
        let stabilization = self.model.stabilization.as_ref();
        let leaps = |u: &[f64]| stabilization.is_some_and(|s| s.leaps(&self.committed.u, u));
        let path = self.continues(before, dt, trial) && !leaps(&trial.u);
        self.habit.hold &= path;
        let starts = self.starts(path, touching);
        // Where nothing comes after it, a start of what cannot be softened may take all iterations.
        let patience = |i: usize| match touching || i + 1 < starts.len() {
            true => Patience::Short,
            false => Patience::Long,
        };
        let mut result = Err(StepFailure::Interrupted);
        // What stopped the softened penalty says why a step cannot be solved; what stopped others may be how far they were from it.
        let mut of_softened = None;
        for (i, start) in starts.iter().enumerate() {
            if let (false, Err(failure)) = (i == 0, &result) {
                self.again(step, start.words(), failure, penalties);
            }
            self.was_mixed = false;
            result = self.started(*start, at, (before, patience(i)), trial, penalties);
            if let (Start::Accepted, true, Err(failure)) = (start, self.was_mixed, &result)
                && another(failure)
                && !touching
            {
                self.again(step, Start::Plain.words(), failure, penalties);
                result = self.started(Start::Plain, at, (before, patience(i)), trial, penalties);
            }
            if !result.as_ref().is_err_and(another) {
                break;
            }
            if let (Start::Softened, Err(failure)) = (start, &result) {
                of_softened = Some(failure.clone());
            }
        }
        self.habit.ended();
        match (result, of_softened) {
            (Err(failure), Some(softened)) if another(&failure) => Err(softened),
            (result, _) => result,
        }
    }

    /// Solves from the path continued, as it is or with the points kept that it opens.
    fn continued(
        &mut self,
        (step, end, dt): (u32, f64, f64),
        before: Option<&(State, f64)>,
        trial: &mut State,
        penalties: &[f64],
    ) -> Result<Converged, StepFailure> {
        let mut hold = self.habit.hold;
        loop {
            self.continues(before, dt, trial);
            self.first = Some(First {
                hold,
                secants: false,
                search: self.habit.search,
                keep: false,
            });
            let failure = match self.converge(step, end, trial, Patience::Short) {
                Err(failure) if another(&failure) => failure,
                other => {
                    // A start that opens none tells nothing.
                    if self.opened {
                        self.habit.hold = hold;
                    }
                    return other;
                }
            };
            if hold || !self.opened {
                self.habit.hold = false;
                return Err(failure);
            }
            let start = "the continued path with the points kept that it opens";
            self.again(step, start, &failure, penalties);
            hold = true;
        }
    }

    /// Solves from a start, and takes down what it has cost.
    fn started(
        &mut self,
        start: Start,
        (step, end, dt): (u32, f64, f64),
        (before, patience): (Option<&(State, f64)>, Patience),
        trial: &mut State,
        penalties: &[f64],
    ) -> Result<Converged, StepFailure> {
        let iterations = self.progress.iterations;
        let result = match start {
            Start::Path => self.continued((step, end, dt), before, trial, penalties),
            Start::Accepted | Start::Plain | Start::Searched => {
                self.restart(end, trial)?;
                let search = start == Start::Searched;
                // Before the first step nothing is pressed that could be kept, but bodies may lie on what is to hold them.
                let (keep, hold) = (step > 1, step == 1);
                self.first = Some(First {
                    hold,
                    secants: true,
                    search,
                    keep,
                });
                self.mixed = start == Start::Accepted;
                let result = self.converge(step, end, trial, patience);
                self.mixed = true;
                result
            }
            Start::Softened => self.softened(step, end, trial, penalties),
        };
        let iterations = (self.progress.iterations - iterations) as u32;
        if start == Start::Searched {
            self.habit.search = result.is_ok();
        }
        let account = match start {
            Start::Path => &mut self.habit.path,
            Start::Accepted | Start::Plain => &mut self.habit.accepted,
            Start::Searched => &mut self.habit.searched,
            Start::Softened => &mut self.habit.softened,
        };
        account.tried(iterations, result.is_ok());
        result
    }

    /// Solves a step that is in equilibrium again, under stiffer penalties.
    pub fn stiffened(
        &mut self,
        step: u32,
        end: f64,
        trial: &mut State,
    ) -> Result<Converged, StepFailure> {
        self.converge(step, end, trial, Patience::Short)
    }

    /// Takes the last accepted state. A surface driven by force that touches nothing in it, or would not at `end`, is
    /// placed where the contact with bodies that stand still carries its force: where it merely touched it would have no
    /// stiffness. Nothing is done where friction alone resists.
    fn restart(&self, end: f64, trial: &mut State) -> Result<(), Fault> {
        trial.copy_from(self.committed);
        for entry in self.model.driven() {
            let (index, surface, driven) = entry;
            // One that stands still, because no contact acts on it.
            if !driven.free().contains(&true) {
                continue;
            }
            let mut first = 0;
            let touches = (self.model.pairs.iter().enumerate()).any(|(i, pair)| {
                let range = first..first + trial.slaves(self.model, i).len();
                first = range.end;
                pair.rigid_master() == Some(index) && trial.points[range].iter().any(|p| p.closed)
            });
            let at = driven.dof(0)..driven.dof(6);
            let mut q = Vector6::from_column_slice(&trial.u[at.clone()]);
            let penalties = &self.assembler.penalties;
            let mut presser =
                Presser::<Penalty>::new(self.model, entry, penalties, &trial.histories, &trial.u);
            if driven.by_friction || touches && presser.press(end, &q)?.active > 0 {
                continue;
            }
            let mut u = trial.u.clone();
            let placed = presser.place(end, &mut q, |q| {
                u[at.clone()].copy_from_slice(q.as_slice());
                driven.driving(end, &u)
            })?;
            if let Placed::RunsAway(direction) = placed {
                return Err(Fault::unresisted(surface, driven, &direction));
            }
            trial.u[at].copy_from_slice(q.as_slice());
        }
        Ok(())
    }

    fn again(&mut self, step: u32, start: &str, failure: &StepFailure, penalties: &[f64]) {
        self.assembler.penalties.copy_from_slice(penalties);
        self.observer.event(&Event::StepRetried {
            step,
            start: start.to_owned(),
            reason: failure.to_string(),
        });
    }

    /// Equilibrium with multipliers where the scene asks for them.
    fn converge(
        &mut self,
        step: u32,
        end: f64,
        trial: &mut State,
        patience: Patience,
    ) -> Result<Converged, StepFailure> {
        let converged = self.penalized(step, end, trial, patience)?;
        let from = (self.committed, self.progress.time);
        validity::far_side(self.model, from, (trial, end))?;
        match self.model.pairs.iter().any(|p| p.augmentation.is_some()) {
            true => self.augment(step, end, trial, patience, converged),
            false => Ok(converged),
        }
    }

    /// Newton's method. A state in which a point fell through the surface is none, however well in equilibrium: contact was
    /// lost on the way.
    fn penalized(
        &mut self,
        step: u32,
        end: f64,
        trial: &mut State,
        patience: Patience,
    ) -> Result<Converged, StepFailure> {
        let converged = self.newton(step, end, trial, patience)?;
        if self.model.small.is_none() {
            self.none_sunk(end, trial)?;
        }
        Ok(converged)
    }

    /// Fails where a point that was in contact in the last accepted state lies below the surface, deeper than its
    /// depth, or where one that was in front of it has passed through it.
    fn none_sunk(&mut self, end: f64, trial: &State) -> Result<(), StepFailure> {
        let masters = &mut self.assembler.masters;
        masters.update(self.model, &trial.u);
        let mut first = 0;
        for (index, pair) in self.model.pairs.iter().enumerate() {
            let master = (masters.at(self.model, index, &trial.u, end)).map_err(Fault::from)?;
            let points = trial.slaves(self.model, index);
            let range = first..first + points.len();
            first = range.end;
            let now = &trial.points[range.clone()];
            let opened = (points.iter().zip(now))
                .zip(&self.committed.points[range])
                .enumerate()
                .filter(|(_, ((_, now), before))| before.closed && !now.closed);
            let sunk = opened.filter(|(i, ((p, now), _))| {
                let x = self.model.point_position(p, &trial.u);
                (master.see(*i, &x, now.hint)).is_some_and(|s| s.behind)
            });
            let points = sunk.count();
            if points > 0 {
                return Err(StepFailure::Sunk {
                    pair: pair.name.clone(),
                    master: pair.master_words(self.model),
                    points,
                    depth: master.depth(),
                });
            }
        }
        let span = Span {
            from: (self.committed, self.progress.time),
            to: (trial, end),
        };
        tunneling::none_passed(self.model, masters, &span)
    }

    fn newton(
        &mut self,
        step: u32,
        end: f64,
        trial: &mut State,
        patience: Patience,
    ) -> Result<Converged, StepFailure> {
        let first = self.first.take();
        let departs = std::mem::take(&mut self.departs);
        let small = self.model.small.is_some();
        let (mut newton, observer) = self.method(patience, first.unwrap_or_default());
        if let Some(stretch) = departs {
            newton.depart(trial, stretch, end)?;
        }
        let mut result = match small {
            false => newton.solve(step, end, trial, observer),
            true => newton.solve_small(step, end, trial, observer),
        };
        let (opened, iterations) = (newton.opened, newton.iterations);
        let (mixed, ping_pongs) = (newton.mixed_iterations, newton.ping_pongs);
        if first.is_some() {
            self.opened = opened;
        }
        self.was_mixed = 2 * mixed > iterations;
        self.progress.ping_pongs += ping_pongs;
        self.progress.iterations += u64::from(iterations);
        if result.is_ok() && self.model.small.is_none() {
            result = validity::inside_out(self.model, trial).and(result);
        }
        result
    }
}
