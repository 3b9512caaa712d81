//! The steps of a model with small displacements: linear but for the points in contact, whose set is sought.
//!
//! With a given set the system is linear, and one solution is exact. The gaps then say which points are in contact, and where these are
//! the same, that is the answer; if not, they are the next set (the active set method, a Newton method for the piecewise
//! linear residual: M. Hintermueller, K. Ito, K. Kunisch, "The primal-dual active set strategy as a semismooth Newton
//! method", SIAM Journal on Optimization 13 (2002)). Penalties make the answer the minimum of a convex energy, so that where
//! a full step does not lower it enough, the minimum along the step does, and no set comes back.
//!
//! A factorization is kept for as long as the set stays the same, over iterations, steps and loads.
mod friction;

use super::{Converged, Newton, StepFailure, Verdict, dot, oscillation};
use crate::assembly::{Fault, Needed};
use crate::model::state::State;
use crate::solve::event::{Event, Observer};
use crate::solve::place;
use crate::system::linear::{Factorization, LinearSolver};

/// Part of the fall of the energy that its slope promises, of which a full step has to bring as much.
const ARMIJO: f64 = 1e-4;

impl<S: LinearSolver + ?Sized> Newton<'_, '_, S> {
    /// [`Newton::solve`] for models with small displacements.
    pub fn solve_small(
        &mut self,
        step: u32,
        time: f64,
        trial: &mut State,
        observer: &mut dyn Observer,
    ) -> Result<Converged, StepFailure> {
        self.prescribe(trial, time)?;
        if self.model.pairs.iter().any(|p| p.friction.is_some()) {
            return self.solve_small_with_friction(step, time, trial, observer);
        }
        let mut factorization = None;
        let mut history = Vec::new();
        let (mut floor, mut factor) = (0.0f64, 1.0);
        self.measure(trial, time)?;
        // The set of the last step costs nothing if its factorization is at hand; otherwise that of the start is as good.
        let mut changed = 0;
        if self.assembler.small_needs(&trial.points) == Needed::Factorization {
            changed = self.assembler.small_switch(&mut trial.points);
        }
        for iteration in 0.. {
            if self.interrupt.load(std::sync::atomic::Ordering::Relaxed) {
                return Err(StepFailure::Interrupted);
            }
            let mut totals = self.measure(trial, time)?;
            if iteration == 0 && changed == 0 {
                // The set at hand is not yet that of the gaps.
                changed = self.assembler.small_switch(&mut trial.points.clone());
            }
            totals.changed = changed;
            let norms = self.norms(trial, &totals);
            floor = floor.max(norms.floor / norms.force.max(f64::MIN_POSITIVE));
            history.push((norms.relative(), changed));
            let settled = changed == 0;
            observer.event(&Event::Iteration {
                step,
                iteration,
                residual: norms.relative(),
                energy: 0.0,
                active: totals.active,
                changed,
                line_search: factor,
            });
            match norms.judge(self.settings.tolerance, settled) {
                Verdict::Converged => {
                    self.assembler.small_settled();
                    return Ok(Converged {
                        iterations: iteration,
                        augmentations: 0,
                        augmenting: 0,
                        totals,
                        force: norms.force,
                        history,
                        floor,
                        factorization,
                        softened: false,
                        eased: false,
                    });
                }
                Verdict::Diverged => {
                    let residual = &self.workspace.residual;
                    let place = place::not_finite(self.model, self.assembler, trial, residual);
                    return Err(StepFailure::NotFinite { iteration, place });
                }
                Verdict::Continue => {}
            }
            if iteration >= self.settings.max_iterations {
                return Err(StepFailure::TooManyIterations {
                    iterations: iteration,
                    residual: norms.relative(),
                    oscillation: oscillation(&history),
                });
            }
            factorization = self.solve_set(trial)?.or(factorization);
            self.iterations += 1;
            (changed, factor) = self.go(trial, time, iteration > 0)?;
        }
        unreachable!("the loop ends by its own limit")
    }

    /// Moves to the prescribed displacements at once.
    fn prescribe(&mut self, trial: &mut State, time: f64) -> Result<(), Fault> {
        let w = &mut *self.workspace;
        (self.model)
            .increments(&trial.u, time, &mut w.increments)
            .map_err(Fault::from)?;
        for (u, g) in trial.u.iter_mut().zip(&w.increments) {
            *u += g;
        }
        Ok(())
    }

    /// Residual with the points in contact that the state says are.
    fn measure(
        &mut self,
        trial: &State,
        time: f64,
    ) -> Result<crate::assembly::Totals, StepFailure> {
        self.phases.start("assembly");
        let residual = &mut self.workspace.residual;
        let totals = self.assembler.small_residual(trial, time, residual);
        self.phases.stop("assembly");
        Ok(totals?)
    }

    /// Solves for the increment under the set of the state.
    fn solve_set(&mut self, trial: &State) -> Result<Option<Factorization>, StepFailure> {
        let needed = self.assembler.small_needs(&trial.points);
        let mut made = None;
        if needed != Needed::Nothing {
            let factored = self.factorize_small(trial)?;
            if needed == Needed::Factorization {
                *(self.workspace.factorizations)
                    .entry(factored.method)
                    .or_default() += 1;
            }
            made = Some(factored);
        }
        self.solve_for_increment()?;
        Ok(made)
    }

    /// Factorizes the system of the state.
    fn factorize_small(&mut self, trial: &State) -> Result<Factorization, StepFailure> {
        self.phases.start("assembly");
        let built = self.assembler.small_matrix(trial);
        self.phases.stop("assembly");
        built?;
        let factored = self.factorize()?;
        self.assembler.small_factored(&trial.points);
        Ok(factored)
    }

    /// The increment that the factors at hand make of the residual.
    fn solve_for_increment(&mut self) -> Result<(), StepFailure> {
        self.phases.start("solve");
        let w = &mut *self.workspace;
        for (du, r) in w.du.iter_mut().zip(&w.residual) {
            *du = -r;
        }
        self.model.dofs.fold(&mut w.du);
        let solved = (self.solver).solve_with(self.assembler.matrix(), &mut w.du);
        self.phases.stop("solve");
        solved.map_err(|error| self.unsolvable(error))?;
        let w = &mut *self.workspace;
        self.model.dofs.expand(&mut w.du, None);
        Ok(())
    }

    /// Moves along the increment, and takes the points in contact there; returns how many changed, and the factor. From a
    /// state whose set is that of its gaps the energy must fall.
    fn go(
        &mut self,
        trial: &mut State,
        time: f64,
        falls: bool,
    ) -> Result<(usize, f64), StepFailure> {
        let base = &mut self.workspace.base;
        base.u.copy_from_slice(&trial.u);
        base.points.copy_from_slice(&trial.points);
        let line = falls.then(|| {
            let w = &*self.workspace;
            self.assembler.small_line(&w.du, &w.residual)
        });
        self.walk(trial, 1.0);
        self.assembler
            .small_gaps(&trial.u, time)
            .map_err(Fault::from)?;
        let changed = self.assembler.small_switch(&mut trial.points);
        let Some(line) = line.filter(|_| changed > 0) else {
            return Ok((changed, 1.0));
        };
        let slope = dot(&self.workspace.du, &self.workspace.residual);
        if line.change(1.0) <= ARMIJO * slope {
            return Ok((changed, 1.0));
        }
        let factor = line.least();
        self.walk(trial, factor);
        trial.points.copy_from_slice(&self.workspace.base.points);
        self.assembler
            .small_gaps(&trial.u, time)
            .map_err(Fault::from)?;
        let changed = self.assembler.small_switch(&mut trial.points);
        // Not settled, even if the set is that of before: the residual is not zero.
        Ok((changed, factor))
    }

    fn walk(&self, trial: &mut State, factor: f64) {
        let w = &*self.workspace;
        for ((u, b), d) in trial.u.iter_mut().zip(&w.base.u).zip(&w.du) {
            *u = b + factor * d;
        }
    }
}
