//! What is told of an accepted step, and its line of the history.
use super::ending::UNSTABLE;
use super::{March, Outputs, energy};
use crate::assembly::Drag;
use crate::model::error::number;
use crate::model::penalty;
use crate::model::state::State;
use crate::run::RunError;
use crate::run::bearing::Bearing;
use crate::run::commit::FrictionTotals;
use crate::run::compliance::{Errors, StepEnd};
use crate::run::history;
use crate::run::linearity_check;
use crate::run::watch::Work;
use crate::solve::event::Event;
use crate::solve::newton::{Converged, RigidLimit};
use crate::system::linear::Method;

/// Part of all works so far below which that of a step is rounding.
const NOTHING: f64 = 1e-6;

impl March<'_, '_> {
    /// Counts the step, and tells what has shown in it; `work` is what was done on the bodies from outside (energy).
    pub(super) fn accept(&mut self, step: u32, end: f64, converged: &Converged, work: f64) {
        self.progress.steps = step;
        self.progress.time = end;
        let touching = &converged.totals.touching;
        let before = std::mem::replace(self.touching, touching.clone());
        for (i, pair) in self.model.pairs.iter().enumerate() {
            let deepest = converged.totals.penetration[i];
            self.touched[i] |= touching[i];
            // A tool that a stage takes back is meant to leave.
            let ends = self
                .model
                .stage
                .as_ref()
                .is_some_and(|s| s.ending.contains(&pair.name));
            let lasting = self.model.dynamics.is_none() && !ends;
            if lasting && self.either(&before, i) && !self.either(touching, i) && !pair.is_second()
            {
                let text = format!(
                    "contact `{}` opened at step {step} (time {}): none of its points touches any more",
                    pair.name,
                    number(end)
                );
                // Bodies that push back what is taken from them are let go, and where nothing works nothing presses.
                match work > NOTHING * self.watch.turned_over() {
                    true => self.warn(text),
                    false => self.observer.event(&Event::Note { text }),
                }
            }
            let allowed = penalty::TOLERATED * pair.element_size;
            if pair.ruled.is_none() && pair.augmentation.is_none() && deepest > allowed {
                self.warn(format!(
                    "contact `{}`: penetration above 1 % of an element ({allowed:.3e}) under the {} penalty",
                    pair.name,
                    if lasting { "given" } else { "present" }
                ));
            }
        }
        for (index, surface, driven) in self.model.driven() {
            let mut share = [0.0f64; 6];
            for loose in (converged.totals.loose.iter()).filter(|l| l.surface == index) {
                for (s, d) in share.iter_mut().zip(loose.direction) {
                    *s += d * d;
                }
            }
            if share.iter().any(|s| *s > 0.0) {
                self.warn(format!(
                    "surface `{}` is free to move {}, but nothing resists it there and nothing drives it: it is held as \
                     it stands",
                    surface.name,
                    driven.direction_words(&share)
                ));
            }
        }
        if let Some(why) = self.solver.take_handover() {
            let text = format!("{why}; `auto` solves the systems from here on");
            self.warn_of_step(step, &text);
        }
        if let Some(last) = converged.factorization {
            let negative = last.negative_pivots;
            self.watch.unstable = negative > 0;
            if negative > 0 && last.method == Method::Lu {
                let text =
                    format!("the determinant of the step's last tangent is negative: {UNSTABLE}");
                self.warn_of_step(step, &text);
            } else if negative > 0 {
                let text = format!(
                    "the last tangent of the step has {negative} negative pivot(s): {UNSTABLE}"
                );
                self.warn_of_step(step, &text);
            }
            if last.perturbed_pivots > 0 {
                let text = format!(
                    "{} pivot(s) of the last tangent were too small and were replaced; the solution was refined",
                    last.perturbed_pivots
                );
                self.warn_of_step(step, &text);
            }
        }
        if self.model.dynamics.is_none() {
            let largest = &mut self.workspace.largest_force;
            *largest = largest.max(converged.force);
        }
        let spent = self.progress.iterations - self.progress.counted;
        self.progress.counted = self.progress.iterations;
        self.progress.accepted += u64::from(converged.iterations);
        let failed = spent.saturating_sub(u64::from(converged.iterations));
        self.failed = u32::try_from(failed).unwrap_or(u32::MAX);
        self.observer.event(&Event::StepAccepted {
            step,
            time: end,
            iterations: converged.iterations,
            failed_iterations: self.failed,
            active: converged.totals.active,
            penetration: (converged.totals.penetration.iter()).fold(0.0, |a, b| a.max(*b)),
        });
    }

    /// Tells where points lie deep in their master under a penalty that the run chooses, beside the layer of elements behind them.
    fn tell_sunk(&mut self, bearings: &[Bearing]) {
        if self.model.dynamics.is_some() {
            return;
        }
        for (pair, bearing) in self.model.pairs.iter().zip(bearings) {
            let (Some(ruled), Some(deepest)) = (pair.ruled, bearing.deepest) else {
                continue;
            };
            let depth = deepest.depth;
            if depth <= ruled.half {
                continue;
            }
            let head = format!("contact `{}`: its points lie ", pair.name);
            if self.progress.warnings.iter().any(|w| w.starts_with(&head)) {
                continue;
            }
            self.warn(format!(
                "{head}{} deep in {} at step {} (time {}), more than half of an element's layer, under the softest penalty that the \
                 step could be solved with: what contact carries there may be wrong, or belong to a path that jumps. Take a smaller \
                 `solution.step.max`, or drive by what keeps the forces growing",
                number(depth),
                pair.master_words(self.model),
                self.progress.steps,
                number(self.progress.time)
            ));
        }
    }

    /// Makes the row of an accepted step; whether its energies tell of a jump.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn record(
        &mut self,
        outputs: &mut Outputs,
        state: &State,
        span: [f64; 2],
        cuts: u32,
        converged: &Converged,
        sliding: &FrictionTotals,
        (work, drag): (Work, Drag),
        (errors, limit): (Errors, Option<RigidLimit>),
    ) -> Result<bool, RunError> {
        let (step, time) = (self.progress.steps, self.progress.time);
        self.phases.start("output");
        for (pair, sunk) in self.model.pairs.iter().zip(&outputs.fields.sunk) {
            if *sunk > 0 && !self.model.of_rims(pair) {
                self.warn(format!(
                    "contact `{}`: {sunk} point(s) passed through {} at step {step}, deeper than its `depth` {}, and are \
                     not in contact: take smaller steps or a larger `depth`",
                    pair.name,
                    pair.master_words(self.model),
                    number(pair.master.depth(self.model))
                ));
            }
        }
        let totals = &converged.totals;
        let energy = energy(totals, sliding) + state.stabilized;
        let pressed = &outputs.fields.pressed;
        let softened = converged.softened;
        let energies = [energy, totals.contact_energy + sliding.stored];
        let told = (self.watch).close(self.model, (step, span), work, pressed, energies, softened);
        let told = told.filter(|_| self.model.dynamics.is_none());
        let mut jumped = false;
        if let Some((text, by_elements)) = told {
            jumped = by_elements;
            self.warn_of_balance(step, text);
        }
        let end = StepEnd {
            step,
            time,
            state,
            bearings: &outputs.fields.bearings,
            internal: totals.internal_energy,
            taken: totals.internal_energy + state.plastic_work(self.model).in_energy,
            work: self.watch.external,
            penalties: &self.assembler.penalties,
            limit: limit.as_ref(),
        };
        let growth = match self.model.dynamics {
            // Strain energy comes and goes with the motion.
            Some(_) => 0.0,
            None => (self.compliance.step(self.model, &end)).map_err(|e| RunError::internal(&e))?,
        };
        let mut all = errors.clone();
        self.compliance.add_lasting(&end, &mut all);
        self.tell_sunk(&outputs.fields.bearings.pairs);
        self.adapt([errors, all], growth, converged);
        let bearings = &outputs.fields.bearings;
        let residual = converged.history.last().map_or(0.0, |last| last.0);
        (self.peaks).step(self.model, (step, time, residual), bearings, totals);
        self.tell_stretched(state, step);
        let doubts = linearity_check::doubts(self.model, &mut self.assembler.masters, state, time);
        for doubt in doubts.map_err(|e| RunError::internal(&e))? {
            self.doubt(doubt);
        }
        outputs.row = history::row(&history::Record {
            model: self.model,
            step,
            time,
            dt: span[1] - span[0],
            cuts,
            failed: self.failed,
            converged,
            sliding,
            stabilized: (state.stabilized, drag.share),
            residual: self.workspace.residual(),
            u: &state.u,
            fields: &outputs.fields,
            watch: &*self.watch,
        });
        self.phases.stop("output");
        Ok(jumped)
    }
}
