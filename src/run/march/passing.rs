//! Steps past a state from which no equilibrium goes on: a snap, or a block that sticks until it slips at once. Where a step
//! fails, every unknown is held to where the step begins by a force along its way, as in a viscous medium, and the same load is
//! solved for step by step; what the structure loses on its way the forces take up. They are let go as soon as there is an
//! equilibrium without them.
use super::{Ending, March, StepControl};
use crate::model::edges;
use crate::model::error::number;
use crate::model::state::State;
use crate::output::RunStatus;
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use crate::scene::Stabilization;
use crate::solve::event::Event;
use crate::solve::newton::{Converged, StepFailure};

/// Part of the first step below which one that fails is passed: larger ones would have found a path by then.
const BELOW: f64 = 1e-2;
/// Part of what elements resist with that holds a step, at first and at most, and the factors by which it grows where that does not
/// suffice and falls from one step to the next.
const FIRST: f64 = 0.3;
const MOST: f64 = 300.0;
const STRONGER: f64 = 10.0;
const WEAKER: f64 = 0.5;
/// How much farther than the step itself what is let go may move: an equilibrium beyond is not the one that the path leads to.
const FAR: f64 = 2.0;
/// Most steps without another try after one at which it was not let go; the double from each such step to the next.
const PAUSE: u32 = 8;
/// Steps in which a jump has to be over.
const STEPS: u32 = 60;
/// Part of the forces below which what is left may be let go: farther from an equilibrium a search for one may end in any.
const SMALL: f64 = 0.02;
/// Part of the work so far above which the energy that was taken is told.
const TOLD: f64 = 1e-3;
/// Part of the forces above which viscous forces in an accepted state are told: its forces do not balance.
const BALANCED: f64 = 0.01;

/// A jump that is being passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::run) struct Jump {
    /// Part of what elements resist with that holds the next step.
    pub rate: f64,
    /// The step at which it began, and its time.
    pub step: u32,
    pub time: f64,
    /// What the viscous forces had taken when it began (energy).
    pub taken: f64,
    /// Steps until it may be let go again, and those that there were to be since the last time it was not.
    pub left: u32,
    pub pause: u32,
    /// Largest part of the forces that the viscous ones were in an accepted state.
    pub largest: f64,
}

impl Jump {
    pub fn put(&self, out: &mut Writer) {
        let Jump {
            rate,
            step,
            time,
            taken,
            left,
            pause,
            largest,
        } = *self;
        out.f64(rate);
        out.u32(step);
        out.f64(time);
        out.f64(taken);
        out.u32(left);
        out.u32(pause);
        out.f64(largest);
    }

    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        Ok(Jump {
            rate: from.f64()?,
            step: from.u32()?,
            time: from.f64()?,
            taken: from.f64()?,
            left: from.u32()?,
            pause: from.u32()?,
            largest: from.f64()?,
        })
    }
}

impl March<'_, '_> {
    /// Whether a step that failed so often is tried with viscous forces, or with larger ones.
    pub(super) fn passes(
        &mut self,
        (step, dt): (u32, f64),
        failure: &StepFailure,
        committed: &State,
        walk: &mut StepControl,
    ) -> bool {
        let meant = self.scene.solution.stabilization == Stabilization::Auto
            && self.scene.solution.step.adaptive
            && self.model.small.is_none()
            && self.model.dynamics.is_none();
        let given_up = walk.given_up == Some(step);
        let initial = walk.stepping.initial();
        // From rest a path begins that is merely steep: how small its first step has to be says nothing of a jump.
        let rest = step == 1;
        let small = dt < BELOW * initial && !rest || walk.stepping.smallest(dt);
        if !meant || given_up || !small || matches!(failure, StepFailure::Interrupted) {
            return false;
        }
        // What no slave point sees would sink in unseen.
        let on_slave = |pair| edges::on_slave(self.model, pair, &committed.u);
        if walk.jump.is_none() && self.model.pairs.iter().any(on_slave) {
            return false;
        }
        let (begun, rate) = match walk.jump {
            None => (step, FIRST),
            Some(jump) => (jump.step, STRONGER * jump.rate),
        };
        if rate > MOST || step - begun > STEPS {
            if let Some(jump) = walk.jump.take()
                && step > jump.step
            {
                self.warn(format!(
                    "from time {} to {} viscous forces carried the path, since no equilibrium goes on there, and it came to none: \
                     the states in between are not in equilibrium, and their forces do not balance",
                    number(jump.time),
                    number(self.progress.time)
                ));
            }
            walk.given_up = Some(step);
            return false;
        }
        let time = self.progress.time;
        walk.jump = Some(match walk.jump {
            None => Jump {
                rate,
                step,
                time,
                taken: committed.stabilized,
                left: 0,
                pause: 0,
                largest: 0.0,
            },
            Some(jump) => Jump { rate, ..jump },
        });
        self.observer.event(&Event::StepRetried {
            step,
            start: "the last accepted state, held by viscous forces".to_owned(),
            reason: failure.to_string(),
        });
        true
    }

    /// Lets go of a step that viscous forces hold, where there is an equilibrium near without them.
    ///
    /// # Errors
    /// Only where the user stops the run, or the step as it was is no longer found.
    pub(super) fn let_go(
        &mut self,
        (step, end): (u32, f64),
        (committed, walk): (&State, &mut StepControl),
        trial: &mut State,
        converged: &mut Converged,
    ) -> Result<(), StepFailure> {
        let Some(jump) = walk.jump else {
            return Ok(());
        };
        let residual = self.workspace.residual();
        let share = self.assembler.drag(&trial.u, residual).share;
        let waits = jump.left > 0 && !walk.stepping.done(end);
        let weaker = Jump {
            rate: WEAKER * jump.rate,
            left: jump.left.saturating_sub(1),
            largest: jump.largest.max(share),
            ..jump
        };
        walk.jump = Some(weaker);
        if share > SMALL || waits {
            return Ok(());
        }
        let held = trial.clone();
        self.assembler.pass(&committed.u, 0.0);
        let way = |from: &State, to: &State| {
            let squares = from.u.iter().zip(&to.u).map(|(a, b)| (a - b).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let far = FAR * way(committed, &held);
        match (self.attempts(committed, &mut walk.habit, 0)).stiffened(step, end, trial) {
            Ok(next) if way(&held, trial) <= far => {
                converged.stiffened(next);
                walk.jump = None;
            }
            Err(StepFailure::Interrupted) => return Err(StepFailure::Interrupted),
            // Not found, or another one far away.
            Ok(_) | Err(_) => {
                let pause = (2 * jump.pause).clamp(1, PAUSE);
                walk.jump = Some(Jump {
                    left: pause,
                    pause,
                    ..weaker
                });
                self.assembler.pass(&committed.u, jump.rate);
                trial.copy_from(&held);
                let again =
                    (self.attempts(committed, &mut walk.habit, 0)).stiffened(step, end, trial);
                converged.stiffened(again?);
            }
        }
        Ok(())
    }

    /// Tells of a jump that is over.
    pub(super) fn tell_jump(&mut self, jump: &Jump, committed: &State) {
        let work = self.watch.turned_over();
        let taken = committed.stabilized - jump.taken;
        if taken > TOLD * work {
            let rest = format!(
                ": the path jumps there, and viscous forces carried it past, which took an energy of {} ({:.1} % of the work) in \
                 all; what follows is one of the states that it may have jumped to",
                number(committed.stabilized),
                100.0 * committed.stabilized / work
            );
            self.tell_time("no equilibrium goes on from time ", jump.time, &rest);
        } else if jump.largest > BALANCED {
            let rest = format!(
                ": viscous forces carried the path past states from which none goes on, and until they were let go they were more \
                 than {:.0} % of the forces, which do not balance by as much",
                100.0 * BALANCED
            );
            self.tell_time("no equilibrium from time ", jump.time, &rest);
        } else {
            self.observer.event(&Event::Note {
                text: format!(
                    "near time {} viscous forces carried the path past a state from which none goes on; they took an energy of {}",
                    number(jump.time),
                    number(taken)
                ),
            });
        }
    }

    /// Warns of what happened at a time; of several times in one warning.
    fn tell_time(&mut self, head: &str, time: f64, rest: &str) {
        let mut told = self.progress.warnings.iter();
        let earlier = told.position(|w| w.starts_with(head));
        let times = earlier.and_then(|i| {
            let (times, _) = self.progress.warnings[i][head.len()..].split_once(": ")?;
            Some(format!("{times}, "))
        });
        if let Some(i) = earlier {
            self.progress.warnings.remove(i);
        }
        let times = times.unwrap_or_default();
        self.warn(format!("{head}{times}{}{rest}", number(time)));
    }

    /// How a run ends that has come to its end time on viscous forces.
    pub(super) fn on_viscous_forces(&self, jump: &Jump) -> Ending {
        let reason = format!(
            "from time {} on no equilibrium goes on: the path jumps there, and at the end viscous forces still carry it; give it \
             more time, or smaller steps",
            number(jump.time)
        );
        Ending::new(RunStatus::NotConverged, Some(reason))
    }
}
