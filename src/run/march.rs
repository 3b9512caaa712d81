//! The march through time: one accepted step after another, with cuts, retries and roll-back inside.
mod accepted;
mod astray;
mod elements;
mod ending;
mod foreseen;
mod giving_up;
mod hand_over;
mod motion;
mod outcome;
pub(in crate::run) mod passing;
mod released;
mod replaced;
mod restart;
mod segments;
mod settle;
mod slip;
mod stages;
mod start;
mod summary;
mod telling;

pub(super) use elements::{ALIKE, Unlike};
pub(super) use giving_up::Patience;
pub(super) use outcome::{AcceptedStep, Ending, Outcome};
pub(super) use restart::{Kept, KeptFiles, take_variant};
use settle::Settled;
pub(super) use start::{Problem, RunState};

use super::RunError;
use super::commit::FrictionTotals;
use super::compliance::Compliance;
use super::fields::Fields;
use super::habit::Habit;
use super::hold;
use super::motion_fields::MotionFields;
use super::peaks::Peaks;
use super::penalty_rule::PenaltyRule;
use super::progress::Progress;
use super::unseen::Unseen;
use super::watch::{Span, Watch};
use crate::assembly::{Assembler, Fault, Totals};
use crate::contact::law::Penalty;
use crate::machine::clock::Phases;
use crate::model::state::State;
use crate::model::{BodyModel, Model};
use crate::output::RunStatus;
use crate::scene::Scene;
use crate::solve::event::{Event, Observer};
use crate::solve::newton::{StepFailure, Workspace};
use crate::solve::stepping::Stepping;
use crate::system::linear::LinearSolver;
use passing::Jump;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

/// Residual relative to the forces up to which an equilibrium that only the round-off floor accepts is taken without a
/// word.
const RELIABLE: f64 = 1e-4;
/// Cuts of a step after which one that gained energy out of nothing is taken, and told.
const GIVES_IN: u32 = 4;

/// What a caller lends to a run while it goes on.
pub(super) struct Caller<'a> {
    pub observer: &'a mut (dyn Observer + Send),
    pub interrupt: &'a AtomicBool,
}

/// A run going on: what it is made of ([`RunState`]) and what its caller lends it.
pub(super) struct March<'a, 'm> {
    pub(super) scene: &'m Scene,
    pub(super) model: &'m Model,
    pub assembler: &'a mut Assembler<'m>,
    pub(super) solver: &'a mut dyn LinearSolver,
    pub workspace: &'a mut Workspace,
    pub observer: &'a mut (dyn Observer + Send),
    interrupt: &'a AtomicBool,
    pub phases: &'a mut Phases,
    pub progress: &'a mut Progress,
    /// Iterations of the step's attempts that failed, once it is accepted.
    failed: u32,
    /// Pairs that were in contact at some accepted step.
    touched: &'a mut Vec<bool>,
    /// Pairs that are in contact at the last accepted step.
    touching: &'a mut Vec<bool>,
    pub watch: &'a mut Watch,
    pub compliance: &'a mut Compliance,
    rule: &'a mut PenaltyRule,
    /// Bodies whose elements another variant may replace.
    replaceable: &'a [String],
    /// Whether another variant may exchange the sides of a contact.
    exchangeable: bool,
    /// Whether another variant may have all faces of a body as a master.
    sides_may: bool,
    /// What slave points do not see.
    unseen: &'a mut Unseen,
    /// How long the run is followed where it goes on badly.
    patience: Patience,
    pub peaks: &'a mut Peaks,
}

/// What carries over from one step to the next, beside the accepted state.
pub(super) struct StepControl {
    pub(super) stepping: Stepping,
    /// The state before the last accepted step and that step's size, while the path is smooth.
    before: Option<(State, f64)>,
    habit: Habit,
    /// Bodies whose elements turned inside out in a step that was cut.
    turned: BTreeSet<usize>,
    /// The jump that is being passed.
    jump: Option<Jump>,
    /// The last step in which passing it was given up.
    given_up: Option<u32>,
}

/// What an accepted step tells.
pub(super) struct Outputs {
    pub fields: Fields,
    /// Its line of the history.
    pub row: Vec<f64>,
}

/// Where a run is, and how it goes on from there.
pub(super) struct Course {
    pub committed: State,
    /// Room for the state that is tried.
    trial: State,
    pub walk: StepControl,
    pub outputs: Outputs,
}

/// What is stored, and what friction, plastic flow and motion have taken since the start.
fn energy(totals: &Totals, sliding: &FrictionTotals) -> f64 {
    let stored = totals.internal_energy + totals.contact_energy + sliding.stored;
    stored + sliding.dissipated + totals.plastic_work + totals.motion.taken()
}

impl March<'_, '_> {
    /// Goes on to the next accepted step, with as many cuts as it takes. At the end of the run there is none to come.
    pub fn step(&mut self, course: &mut Course) -> Result<Outcome, RunError> {
        let Course {
            committed,
            trial,
            walk,
            outputs,
        } = course;
        let (mut cuts, mut eased) = (0, false);
        let mut damping = None;
        let model = self.model;
        let number_of = |body: &BodyModel| {
            let mut bodies = model.bodies.iter();
            bodies.position(|b| b.name == body.name)
        };
        let segmented = self.model.pairs.iter().any(|p| p.segments().is_some());
        while !walk.stepping.done(self.progress.time) {
            let end = walk.stepping.next(self.progress.time);
            let dt = end - self.progress.time;
            let step = self.progress.steps + 1;
            // On the last accepted state, so that a step that is cut has the same segments.
            if segmented && cuts == 0 {
                self.recut(committed, walk, outputs)?;
            }
            self.observer.event(&Event::StepStarted {
                step,
                time: end,
                dt,
            });
            (self.assembler).begin_step(&committed.u, self.progress.time, end);
            (self.assembler).pass(&committed.u, walk.jump.map_or(0.0, |jump| jump.rate));
            self.workspace.unstable = None;
            let penalties = self.assembler.penalties.clone();
            self.foresee(committed, walk, (dt, end));
            let mut result = (self.attempts(committed, &mut walk.habit, cuts)).solve(
                step,
                end,
                dt,
                walk.before.as_ref(),
                trial,
            );
            let mut settled = None;
            if let Ok(converged) = &mut result
                && let Err(failure) =
                    self.released((step, end), (&*committed, walk), trial, converged)
            {
                result = Err(failure);
            }
            let passing = walk.jump;
            if let Ok(converged) = &mut result
                && let Err(failure) =
                    self.let_go((step, end), (&*committed, walk), trial, converged)
            {
                result = Err(failure);
            }
            if let Ok(converged) = &mut result
                && let Err(failure) =
                    self.stabler((step, end, cuts), (&*committed, walk), trial, converged)
            {
                result = Err(failure);
            }
            let mut moved = match result.is_ok() {
                true => self.moved(committed, trial),
                false => None,
            };
            if let Some(moved) = &moved
                && let Some(failure) = self.too_long(moved, (dt, cuts), &walk.stepping)
            {
                result = Err(failure);
            }
            if let Ok(converged) = &mut result {
                let at = (step, end, cuts);
                match self.settle(at, (&*committed, walk), trial, converged, outputs)? {
                    Ok(found) => settled = Some(found),
                    Err(failure) => {
                        self.take_back(&penalties);
                        result = Err(failure);
                    }
                }
            }
            let failure = match result {
                Ok(mut converged) => 'solved: {
                    let start = self.progress.time;
                    let Settled {
                        sliding,
                        errors,
                        limit,
                        sticking,
                        reshaped,
                    } = settled.unwrap_or_default();
                    (self.assembler).balance(&trial.u, self.workspace.residual_mut());
                    let residual = self.workspace.residual();
                    let span = Span {
                        from: (committed, start),
                        to: (&*trial, end),
                    };
                    let drag = self.assembler.drag(&trial.u, residual);
                    let mut work = (self.watch)
                        .work(
                            self.model,
                            self.assembler,
                            residual,
                            &converged.totals,
                            &span,
                        )
                        .map_err(|e| RunError::internal(&e))?
                        .with_sudden(sliding.sudden);
                    work.adjusted += reshaped.energy;
                    if let Some(moved) = &moved {
                        converged.totals.motion = moved.energy;
                    }
                    let flowed = committed.plastic_work(self.model);
                    let energy = energy(&converged.totals, &sliding) + flowed.done
                        - flowed.in_energy
                        + committed.stabilized
                        + drag.work;
                    if let Some(moved) = &mut moved
                        && let Some(failure) = self.damped(
                            moved,
                            (dt, cuts, &mut damping),
                            (&work, energy, &converged.totals.touching),
                            &walk.stepping,
                        )
                    {
                        self.take_back(&penalties);
                        break 'solved failure;
                    }
                    let large = walk.stepping.large(dt) && passing.is_none();
                    let gained = (self.watch).gained(self.model, (step, large), &work, energy);
                    if let Some(part) = gained.filter(|_| cuts < GIVES_IN && moved.is_none()) {
                        self.take_back(&penalties);
                        break 'solved StepFailure::GainedEnergy { part };
                    }
                    if let Some(failure) =
                        self.astray((step, cuts, large), (&work, energy), (&span, &converged))
                    {
                        self.take_back(&penalties);
                        break 'solved failure;
                    }
                    let mut gave_way = self.lost_hold(trial, &converged);
                    // What they answer is not taken where others go on from here.
                    if let Some(ending) = self.without(&gave_way) {
                        self.take_back(&penalties);
                        return Ok(Outcome::Stopped(ending));
                    }
                    (self.watch).accept(self.assembler, residual, &converged.totals, &span);
                    match &mut walk.before {
                        Some((state, size)) => {
                            std::mem::swap(state, committed);
                            *size = dt;
                        }
                        None => walk.before = Some((committed.clone(), dt)),
                    }
                    committed.copy_from(trial);
                    let left = (committed.remember(self.model)).map_err(|(body, fault)| {
                        RunError::internal(&Fault::Element { body, fault })
                    })?;
                    converged.totals.internal_energy += left.energy;
                    work.adjusted += left.energy;
                    let flowed = committed.plastic_work(self.model);
                    converged.totals.internal_energy -= flowed.in_energy;
                    converged.totals.plastic_work = flowed.done;
                    committed.stabilized += drag.work;
                    // Augmentations say nothing of how far a step may go.
                    let iterations = converged.iterations - converged.augmenting;
                    match (passing.is_some(), &moved) {
                        (true, _) => walk.stepping.set_size(dt),
                        (false, None) => walk.stepping.accepted(iterations),
                        (false, Some(moved)) => {
                            let internal = converged.totals.internal_energy;
                            let (end, work) = ((&committed.u[..], dt), (internal, iterations));
                            self.move_on(moved, end, work, &mut walk.stepping);
                        }
                    }
                    let turns = walk.stepping.at_kink(start);
                    let lag = (self.watch).flowed(left.flow, &work, turns);
                    walk.stepping.flowed(dt, left.flow.most, lag);
                    let aside = self.headed(&walk.before, (committed, start, end), turns)?;
                    walk.stepping.headed(dt, aside);
                    if let Some(jump) = passing.filter(|_| walk.jump.is_none()) {
                        self.tell_jump(&jump, committed);
                    }
                    if walk.stepping.at_kink(end) {
                        walk.before = None;
                    }
                    self.accept(step, end, &converged, work.external);
                    self.tell_left(step, reshaped.left, converged.totals.internal_energy);
                    let jumped = self.record(
                        outputs,
                        committed,
                        [start, end],
                        cuts,
                        &converged,
                        &sliding,
                        (work, drag),
                        (errors, limit),
                    )?;
                    let bearings = &outputs.fields.bearings;
                    (self.adapt_slip(bearings, end, &converged, &sticking))
                        .map_err(|e| RunError::internal(&e))?;
                    let internal = converged.totals.internal_energy;
                    // A load that goes up and down again between kinks is seen, too.
                    let grown = internal > 2.0 * self.progress.measured;
                    if self.model.small.is_some()
                        && (grown || walk.stepping.done(end) || walk.stepping.at_kink(end))
                    {
                        self.beyond_linear(committed, internal);
                    }
                    let done = walk.stepping.done(end);
                    self.tell_weighted(step, dt);
                    self.tell_energy(done);
                    let mut ending = self.stabilized(committed, &drag, &converged, done);
                    if jumped {
                        let before = walk.before.as_ref().map(|(state, _)| state);
                        gave_way.extend(self.lost_in_jump(committed, before));
                    }
                    if ending.is_none() {
                        ending = self.without(&gave_way).map(|ending| Ending {
                            accepted: true,
                            ..ending
                        });
                    }
                    if ending.is_none() {
                        gave_way.into_iter().for_each(|g| self.tell_lost(g));
                    }
                    let accepted = AcceptedStep {
                        dt,
                        iterations: converged.iterations,
                        cuts,
                    };
                    let by = (
                        &converged.totals.penetration[..],
                        &outputs.fields.bearings.pairs[..],
                    );
                    let ending = ending
                        .or_else(|| self.sinks(committed, [start, end], by))
                        .or_else(|| self.slides(committed));
                    let ending = ending.or_else(|| {
                        let held = walk.jump.map(|jump| self.on_viscous_forces(&jump));
                        done.then(|| held.unwrap_or_else(|| self.ending()))
                    });
                    return Ok(Outcome::Accepted(accepted, ending));
                }
                Err(failure) => failure,
            };
            if failure == StepFailure::Interrupted {
                let reason = Some("stopped by the user".to_owned());
                return Ok(Outcome::Stopped(Ending::new(
                    RunStatus::Interrupted,
                    reason,
                )));
            }
            // Let go of, it was not found or is not taken: larger ones may hold it.
            walk.jump = walk.jump.or(passing);
            if self.passes((step, dt), &failure, committed, walk) {
                continue;
            }
            if !eased && self.eases(step, &failure) {
                eased = true;
                continue;
            }
            cuts += 1;
            self.progress.cuts += 1;
            let reason = failure.to_string();
            // Elements that another variant would replace are not followed down to the smallest step.
            let turned = hold::turned(self.model, &failure);
            let mut lost = self.may_be_replaced(&hold::lost(self.model, committed));
            // Those of a block give way for themselves. A shell may buckle, and follow in smaller steps; not so in one after which
            // they turned inside out again.
            let again = |b: &usize| cuts >= hold::SUSPECT || walk.turned.contains(b);
            lost.retain(|b| self.model.bodies[*b].is_block() || again(b));
            walk.turned.extend(turned.and_then(number_of));
            // What is bent far in a step that is too large turns inside out as well, and is not squeezed when it begins.
            let squeezed = |b: &BodyModel| {
                self.replaceable.contains(&b.name) && hold::compressed(b, &committed.u)
            };
            let hopeless =
                !lost.is_empty() || cuts >= hold::HOPELESS && turned.is_some_and(squeezed);
            let part = match (&failure, &walk.before) {
                (StepFailure::TooLong { part, .. } | StepFailure::Damped { part, .. }, _) => *part,
                (failure, _) if failure.halves() => 0.5,
                // From rest the first increment is proportional to the step: one that moves neighbouring nodes by as much as
                // their distance is what may be followed.
                (_, None) => 1.0 / self.workspace.bend,
                _ => 0.5,
            };
            let hopeless = hopeless || self.gives_up(committed);
            let next = walk.stepping.failed(dt, part).filter(|_| !hopeless);
            let Some(next_dt) = next else {
                let unstable = self.workspace.unstable.map_or_else(String::new, |u| {
                    format!("; {}", u.words(self.model, self.assembler.stabilizes()))
                });
                // Where the structure gives way the elements may be what does.
                let suspect = turned.or_else(|| {
                    let body = self.workspace.unstable?.body(self.model)?;
                    let squeezed =
                        body.block.alpha_len() > 0 && hold::compressed(body, &committed.u);
                    squeezed.then_some(body)
                });
                // All of them at once: each would end a run of its own.
                (walk.turned).retain(|b| hold::compressed(&self.model.bodies[*b], &committed.u));
                walk.turned.extend(suspect.and_then(number_of));
                let helps = hold::remedy(turned);
                let reason = format!(
                    "step {step} from time {} failed {}: {reason}{helps}{unstable}",
                    self.progress.time,
                    match hopeless {
                        true => "at ever smaller step sizes",
                        false => "at the smallest step size",
                    }
                );
                return Ok(Outcome::Stopped(Ending {
                    squeezed: match lost.is_empty() {
                        true => walk.turned.iter().copied().collect(),
                        false => lost,
                    },
                    ..Ending::new(RunStatus::NotConverged, Some(reason))
                }));
            };
            self.observer.event(&Event::StepCut {
                step,
                dt,
                next_dt,
                reason,
            });
        }
        Ok(Outcome::Stopped(self.ending()))
    }

    /// Tells what is known once a run has ended, however it did.
    pub fn conclude(&mut self, committed: &State) {
        if self.model.dynamics.is_none()
            && let Some(text) = self.watch.drift(self.model)
        {
            self.warn(text);
        }
        self.tell_turns();
        let soft = (self.compliance).warning(self.model, &self.assembler.penalties);
        let (penalties, ratios) = (&self.assembler.penalties, &self.assembler.ratios);
        let tangential: Vec<f64> = penalties.iter().zip(ratios).map(|(p, r)| p * r).collect();
        let sticking = (self.compliance.sticking).warnings(self.model, &tangential);
        let all = soft.into_iter().chain(sticking);
        let unseen = self.unseen.between.warnings(self.model);
        for text in all.chain(self.peaks.warnings(self.model)).chain(unseen) {
            self.warn(text);
        }
        self.tell_untouched();
        for text in self.peaks.notes(self.model, &committed.u) {
            self.observer.event(&Event::Note { text });
        }
    }

    /// Gathers the fields of a state.
    fn gather(&mut self, outputs: &mut Outputs, state: &State, time: f64) -> Result<(), RunError> {
        let assembler = &mut *self.assembler;
        outputs.fields.motion = MotionFields::new(self.model, assembler, &state.u);
        let masters = &mut assembler.masters;
        (outputs.fields).gather::<Penalty>(self.model, &assembler.penalties, masters, state, time)
    }
}
