//! A step that is solved, before it is accepted: its histories, its fields, and whether its penalties serve.
mod corners;
mod pressed;

use super::{March, Outputs, RELIABLE, StepControl};
use crate::assembly::Totals;
use crate::contact::friction::history::PointHistory;
use crate::model::Model;
use crate::model::error::number;
use crate::model::state::State;
use crate::run::RunError;
use crate::run::bearing::{Bearing, Bearings};
use crate::run::commit::{self, FrictionTotals};
use crate::run::compliance::{Compliance, Errors, StepEnd};
use crate::run::habit::Habit;
use crate::run::penalty_rule::{self, PenaltyRule};
use crate::run::step::Attempts;
use crate::solve::event::Event;
use crate::solve::newton::{Converged, RigidLimit, StepFailure, StickLimit};
use pressed::{Pressing, Reshaped};

/// Times that penalties may be raised within a step.
const RAISES: usize = 6;
/// Part of the largest force that a raise at the last step may change without a word on the steps before.
const AT_LAST: f64 = 0.02;

/// What is known of a step that is solved.
#[derive(Debug, Clone, Default)]
pub(super) struct Settled {
    pub sliding: FrictionTotals,
    /// What every pair leaves; empty where the run chooses no penalty.
    pub errors: Errors,
    /// What rigid contact would change.
    pub limit: Option<RigidLimit>,
    /// What rigid sticking would change, per pair; empty where it was not measured.
    pub sticking: Vec<StickLimit>,
    pub reshaped: Reshaped,
}

/// What a raise of penalties went out from.
struct Tried {
    state: State,
    penalties: Vec<f64>,
    errors: Errors,
    totals: Totals,
    /// What rigid contact would change there, where that was measured.
    limit: Option<RigidLimit>,
    /// Points in contact and the deepest penetration (length), per pair.
    points: Vec<(usize, f64)>,
    /// The raise that led there, where it changed a force by far more than that said; it went out from there itself.
    outran: Option<Box<Tried>>,
    reshaped: Reshaped,
}

impl Tried {
    /// Takes what the raise has changed for what is left of the error ([`RigidLimit::bound`]), by the smallest factor of the contacts
    /// that touch: one that was not raised shows nothing.
    fn bound(
        &self,
        model: &Model,
        limit: &mut RigidLimit,
        (state, penalties, totals): (&State, &[f64], &Totals),
    ) {
        let raised = penalties.iter().zip(&self.penalties).zip(&totals.touching);
        let factors = raised.filter(|(_, touches)| **touches);
        let factor = (factors.map(|((now, was), _)| now / was)).fold(f64::INFINITY, f64::min);
        let ways = state.u[..3 * model.body_nodes()].iter().zip(&self.state.u);
        let moved = ways.fold(0.0f64, |most, (now, was)| most.max((now - was).abs()));
        limit.bound(model, [&self.totals, totals], moved, factor);
    }
}

/// Whether an equilibrium is more than what rounding leaves.
fn reliable(converged: &Converged) -> bool {
    (converged.history.last()).is_none_or(|last| last.0 <= RELIABLE)
}

impl<'m> March<'_, 'm> {
    /// The attempts at a step.
    pub(super) fn attempts<'b>(
        &'b mut self,
        committed: &'b State,
        habit: &'b mut Habit,
        cuts: u32,
    ) -> Attempts<'b, 'm> {
        Attempts {
            model: self.model,
            committed,
            assembler: self.assembler,
            solver: self.solver,
            workspace: self.workspace,
            settings: &self.scene.solution.newton,
            phases: self.phases,
            interrupt: self.interrupt,
            observer: self.observer,
            progress: self.progress,
            rule: self.rule,
            first: None,
            habit,
            cuts,
            opened: false,
            mixed: true,
            was_mixed: false,
            departs: None,
        }
    }

    /// Takes the step into the histories of `trial` and gathers its fields; where the penalties that the run may choose make too
    /// large an error, it is solved again under stiffer ones.
    ///
    /// # Errors
    /// Inside, why the step is not to be accepted.
    pub(super) fn settle(
        &mut self,
        (step, end, cuts): (u32, f64, u32),
        (committed, walk): (&State, &mut StepControl),
        trial: &mut State,
        converged: &mut Converged,
        outputs: &mut Outputs,
    ) -> Result<Result<Settled, StepFailure>, RunError> {
        let start = self.progress.time;
        let rules = self.model.pairs.iter().any(|p| p.ruled.is_some());
        let fields = rules.then(|| outputs.fields.before());
        let mut raises = if rules { RAISES } else { 0 };
        let mut rejected = false;
        // What a raise went out from.
        let mut tried: Option<Tried> = None;
        // The penalties that the steps before had, and what they came to in this one.
        let mut first: Option<(Vec<f64>, Totals)> = None;
        let (last, turns) = (walk.stepping.done(end), walk.stepping.at_kink(end));
        let mut pressing = Pressing::default();
        loop {
            let mut histories = trial.histories.clone();
            let was = (&committed.u[..], start);
            let sliding = match commit::commit(self.model, self.assembler, trial, was, end) {
                Ok(sliding) => sliding,
                // A foot that is looked for anew may not be found on faces that are much distorted.
                Err(fault) => return Ok(Err(fault.into())),
            };
            self.gather(outputs, trial, end)?;
            let bearings = &outputs.fields.bearings;
            let turned = walk.stepping.at_kink(start);
            let due = self.compliance.is_due(step, bearings, turned)
                || self.compliance.sticking.is_due()
                || turns
                || last;
            let mut limit = match due && reliable(converged) {
                true => self.rigid_limit(trial, &histories, bearings, end),
                false => None,
            };
            let fresh = limit.clone();
            if let (Some(limit), Some(tried)) = (&mut limit, &tried) {
                let penalties = &self.assembler.penalties;
                tried.bound(self.model, limit, (trial, penalties, &converged.totals));
            }
            let at = (step, end, [turns, last]);
            let Some(fields) = &fields else {
                let own = (committed, &mut *walk);
                match self.press(&mut pressing, at, own, (trial, &mut histories), converged)? {
                    Ok(true) => continue,
                    Ok(false) => {}
                    Err(failure) => return Ok(Err(failure)),
                }
                let sticking = self.sticking(limit.is_some(), trial, &histories, bearings, end)?;
                return Ok(Ok(Settled {
                    sliding,
                    errors: Errors::default(),
                    limit,
                    sticking,
                    reshaped: pressing.reshaped,
                }));
            };
            let [errors, ruling] = self.errors(outputs, trial, at, limit.as_ref(), converged)?;
            let mut outran = None;
            if let Some(mut tried) = tried.take() {
                let beyond = self.outruns(&tried, &converged.totals);
                let before = tried.outran.take();
                let bearings = &outputs.fields.bearings;
                let corners = "under a stiffer one faces press on each other with their corners";
                let parted = self.parted(&tried, &converged.totals, bearings);
                let mut kept = None;
                let (from, why) = match (beyond, before, parted) {
                    (Some(index), Some(first), _) => {
                        self.tell_outrun(index, end, (&first, &converged.totals));
                        (Some(*first), corners)
                    }
                    (_, _, Some(index)) => {
                        self.tell_outrun(index, end, (&tried, &converged.totals));
                        kept = Some(index);
                        (Some(tried), corners)
                    }
                    _ if !PenaltyRule::unknown(self.model, &tried.errors)
                        && !PenaltyRule::helped(&tried.errors, &ruling) =>
                    {
                        (Some(tried), "a stiffer one does not lower the error")
                    }
                    (beyond, ..) => {
                        outran = beyond.map(|_| Box::new(tried));
                        (None, "")
                    }
                };
                if let Some(from) = from {
                    outputs.fields.back(fields);
                    let penalty = kept.map(|i| (i, from.penalties[i], from.errors.sum()));
                    let found = penalty_rule::between_bodies(self.model).then(|| from.errors.sum());
                    let told = (why, found);
                    pressing.reshaped = from.reshaped;
                    match self.back((step, end), (committed, walk), trial, from, told) {
                        Ok(next) => converged.stiffened(next),
                        Err(failure) => return Ok(Err(failure)),
                    }
                    if let Some((index, penalty, error)) = penalty {
                        self.rule.keep(self.model, index, penalty, error);
                    }
                    // Where it does not help, half as far would not.
                    raises = 0;
                    continue;
                }
            }
            let mut stiffer = self.assembler.penalties.clone();
            let raise = raises > 0 && self.rule.raise(self.model, &ruling, rejected, &mut stiffer);
            let error = ruling.sum();
            // Elements that hold where they gave way ask for more than could be foreseen.
            if (converged.eased || rejected && !raise)
                && !pressing.again
                && let Some(error) = penalty_rule::untenable(self.model, &errors, cuts)
            {
                return Ok(Err(StepFailure::TooSoft {
                    error: error.min(1.0),
                }));
            }
            if !raise {
                let own = (committed, &mut *walk);
                match self.press(&mut pressing, at, own, (trial, &mut histories), converged)? {
                    Ok(true) => {
                        outputs.fields.back(fields);
                        continue;
                    }
                    Ok(false) => {}
                    Err(failure) => return Ok(Err(failure)),
                }
                if let Some(first) = &first {
                    self.tell_raised_at_last(first, &converged.totals);
                }
                let bearings = &outputs.fields.bearings;
                let sticking = self.sticking(limit.is_some(), trial, &histories, bearings, end)?;
                return Ok(Ok(Settled {
                    sliding,
                    errors,
                    limit,
                    sticking,
                    reshaped: pressing.reshaped,
                }));
            }
            raises -= 1;
            // Solved again from where it is.
            std::mem::swap(&mut trial.histories, &mut histories);
            let pairs = outputs.fields.bearings.pairs.iter();
            let deepest = |b: &Bearing| b.deepest.map_or(0.0, |point| point.depth);
            let points = pairs.map(|b| (b.active, deepest(b))).collect();
            outputs.fields.back(fields);
            let softer = std::mem::replace(&mut self.assembler.penalties, stiffer);
            self.hold_given();
            self.tell_raise(step, &softer, error);
            if last {
                first.get_or_insert_with(|| (softer.clone(), converged.totals.clone()));
            }
            let from = Tried {
                state: trial.clone(),
                penalties: softer,
                errors: ruling,
                totals: converged.totals.clone(),
                limit: fresh,
                points,
                outran,
                reshaped: pressing.reshaped,
            };
            match (self.attempts(committed, &mut walk.habit, 0)).stiffened(step, end, trial) {
                Ok(next) => {
                    converged.stiffened(next);
                    tried = Some(from);
                }
                Err(StepFailure::Interrupted) => return Ok(Err(StepFailure::Interrupted)),
                Err(failure) => {
                    let why = failure.to_string();
                    pressing.reshaped = from.reshaped;
                    match self.back((step, end), (committed, walk), trial, from, (&why, None)) {
                        Ok(next) => converged.stiffened(next),
                        Err(failure) => return Ok(Err(failure)),
                    }
                    rejected = true;
                }
            }
        }
    }

    /// Tells of a penalty that was raised at the last step alone by how much forces changed there: those of the steps before were
    /// off by about as much.
    fn tell_raised_at_last(&mut self, (softer, before): &(Vec<f64>, Totals), totals: &Totals) {
        if self.model.dynamics.is_some() || self.progress.steps == 0 {
            return;
        }
        let of = |index: usize, t: &Totals| RigidLimit::of_pair(self.model, index, t);
        let pairs = 0..self.model.pairs.len();
        let largest = pairs.clone().map(|i| of(i, totals)).fold(0.0, f64::max);
        let changed = pairs
            .filter(|i| self.assembler.penalties[*i] > softer[*i])
            .map(|i| (i, of(i, before), of(i, totals)))
            .max_by(|a, b| (a.2 - a.1).abs().total_cmp(&(b.2 - b.1).abs()));
        let Some((index, soft, stiff)) = changed else {
            return;
        };
        // A path that stiffens at its end, where the steps before were right, is raised there as well.
        let error = self.compliance.last_error();
        if (stiff - soft).abs() <= AT_LAST * largest || error <= AT_LAST {
            return;
        }
        self.warn(format!(
            "contact `{}`: forces of the steps before the last one are off by up to about {:.0} %: its penalty was raised at the last \
             step, which changed its force there from {} to {}; a `penalty` of about {} from the start shows what came before",
            self.model.pairs[index].name,
            100.0 * error.min(1.0),
            number(soft),
            number(stiff),
            number(self.assembler.penalties[index])
        ));
    }

    /// Takes a raise back: what is known of the step is again that of the softer penalties.
    fn back(
        &mut self,
        (step, end): (u32, f64),
        (committed, walk): (&State, &mut StepControl),
        trial: &mut State,
        from: Tried,
        (why, error): (&str, Option<f64>),
    ) -> Result<Converged, StepFailure> {
        (self.rule).reject(&from.penalties, &self.assembler.penalties, error);
        self.take_back(&from.penalties);
        trial.copy_from(&from.state);
        self.observer.event(&Event::StepRetried {
            step,
            start: "the penalty before it was raised".to_owned(),
            reason: why.to_owned(),
        });
        (self.attempts(committed, &mut walk.habit, 0)).stiffened(step, end, trial)
    }

    /// What rigid contact would change; nothing where contact cannot be evaluated beside the state.
    fn rigid_limit(
        &mut self,
        state: &State,
        histories: &[PointHistory],
        bearings: &Bearings,
        time: f64,
    ) -> Option<RigidLimit> {
        // A force of inertia is no load that it could be measured by.
        if self.model.pairs.is_empty() || self.model.dynamics.is_some() {
            return None;
        }
        self.phases.start("accuracy");
        let limit = self.workspace.rigid_limit(
            self.model,
            self.assembler,
            self.solver,
            (state, histories),
            (time, Compliance::little(self.model)),
        );
        self.phases.stop("accuracy");
        let mut limit = limit.ok().flatten()?;
        let part = |b: &Bearing| b.prescribed / b.force.max(f64::MIN_POSITIVE);
        limit.leave_out(bearings.pairs.iter().map(part));
        Some(limit)
    }

    /// The errors that show at the end of a step, and those that rule its penalties: what rigid contact would change shows the
    /// same from one step to the next, and only the last one has no next, nor has a peak where motions turn.
    fn errors(
        &self,
        outputs: &Outputs,
        state: &State,
        (step, time, [turns, last]): (u32, f64, [bool; 2]),
        limit: Option<&RigidLimit>,
        converged: &Converged,
    ) -> Result<[Errors; 2], RunError> {
        // Where rounding is all there is, nothing is known.
        if !reliable(converged) {
            let none = Errors::none(self.model);
            return Ok([none.clone(), none]);
        }
        let end = StepEnd {
            step,
            time,
            state,
            bearings: &outputs.fields.bearings,
            internal: converged.totals.internal_energy,
            taken: converged.totals.internal_energy,
            work: 0.0,
            penalties: &self.assembler.penalties,
            limit,
        };
        let errors =
            (self.compliance.errors(self.model, &end)).map_err(|e| RunError::internal(&e))?;
        let mut ruling = errors.clone();
        let compliance = &self.compliance;
        if last
            || turns && compliance.is_largest(limit)
            || compliance.gives_way(self.model, limit, &errors)
        {
            compliance.add_limit(self.model, &end, &mut ruling);
        }
        Ok([errors, ruling])
    }

    fn tell_raise(&mut self, step: u32, softer: &[f64], error: f64) {
        let penalties = self.assembler.penalties.clone();
        for ((pair, before), penalty) in self.model.pairs.iter().zip(softer).zip(penalties) {
            if penalty > *before {
                self.observer.event(&Event::PenaltyRuled {
                    step,
                    contact: pair.name.clone(),
                    penalty,
                    error: error.min(1.0),
                });
            }
        }
    }

    /// Adapts the penalties that the run may choose to an accepted step, for the next one. `errors` are those at its end, `growth`
    /// the one that shows over the last steps. `errors` are first those of energies and depths, then with what rigid contact has been
    /// found to change in two steps alike: a penalty that bears little beside bodies that bend is not lowered for its little energy.
    pub(super) fn adapt(
        &mut self,
        [mut errors, all]: [Errors; 2],
        growth: f64,
        converged: &Converged,
    ) {
        if errors.forces.is_empty() {
            return;
        }
        let model: &Model = self.model;
        let iterations = converged.iterations + self.failed;
        let mut penalties = self.assembler.penalties.clone();
        let last = errors.clone();
        self.rule.lower(model, &all, iterations, &mut penalties);
        let sum = errors.sum();
        if growth > sum && sum > 0.0 {
            // Of faces whose folds may be corners the energy grows as they part.
            let pairs = model.pairs.iter().zip(&mut errors.forces);
            pairs
                .filter(|(pair, _)| !corners::has_folds(pair))
                .for_each(|(_, e)| *e *= growth / sum);
            self.rule.raise(model, &errors, false, &mut penalties);
        }
        for index in self.rule.left_behind(&penalties) {
            self.progress.forget(&corners::outrun(self.model, index));
        }
        (self.rule).remember(&last, &self.assembler.penalties, &penalties);
        self.assembler.penalties.copy_from_slice(&penalties);
        self.hold_given();
    }

    /// Softens penalties that the run may choose where a step has failed under some that are far stiffer than asked for; whether there
    /// were any. The step is then worth another attempt before it is cut.
    pub(super) fn eases(&mut self, step: u32, failure: &StepFailure) -> bool {
        if !failure.finds_none() {
            return false;
        }
        let mut penalties = self.assembler.penalties.clone();
        if !self.rule.ease(self.model, &mut penalties) {
            return false;
        }
        self.take_back(&penalties);
        self.observer.event(&Event::StepRetried {
            step,
            start: "softer penalties of contacts that are stiffer than asked for".to_owned(),
            reason: failure.to_string(),
        });
        true
    }

    /// Takes the penalties that there were before a raise.
    pub(super) fn take_back(&mut self, penalties: &[f64]) {
        self.assembler.penalties.copy_from_slice(penalties);
        self.hold_given();
    }
}
