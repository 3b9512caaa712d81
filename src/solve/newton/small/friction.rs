//! The steps of a model with small displacements and friction: elements are linear and normals stay, but tractions of friction
//! depend on pressures and directions, so that no energy is least in equilibrium, and no set of points makes the system linear.
//!
//! Newton's method takes the points in contact by the gaps of every iterate, and the exact tangent of friction there. The first
//! iteration keeps the points of the last step, as a step without friction does. Points that slide to and fro are held by secants
//! and taken to stick as at large displacements ([`Newton::solve`]), sets that come back are left by half steps. With limits of
//! friction that stay there is a convex energy (Tresca's friction): increments that switch points are searched along it.
use super::super::line_search;
use super::super::{
    Converged, EXTENDED, Newton, PingPong, ROUNDS, SECANTS, StepFailure, UNTIL_SEARCH, UNTIL_STUCK,
    Verdict, dot, oscillation, round,
};
use crate::assembly::{Fault, Linearization, Totals};
use crate::contact::friction::law::Slide;
use crate::model::state::State;
use crate::solve::cycle::Cycle;
use crate::solve::event::{Event, Observer};
use crate::solve::place;
use crate::system::linear::LinearSolver;

/// Relative residual up to which a solution may take more iterations than are allowed.
const NEARLY: f64 = 1e-2;
/// Part of an increment below which the next iterations take secants, where a start without them has failed.
const SHORT: f64 = 0.3;

impl<S: LinearSolver + ?Sized> Newton<'_, '_, S> {
    /// [`Newton::solve_small`] with friction, from where displacements are as prescribed.
    pub(super) fn solve_small_with_friction(
        &mut self,
        step: u32,
        time: f64,
        trial: &mut State,
        observer: &mut dyn Observer,
    ) -> Result<Converged, StepFailure> {
        let mut factorization = None;
        let mut history = Vec::new();
        let (mut floor, mut factor) = (0.0f64, 1.0);
        let (mut best, mut since_best) = (f64::INFINITY, 0u32);
        let (mut cycle, mut broken, mut damped) = (Cycle::default(), None::<PingPong>, 0u32);
        let (mut rounds, mut stuck_at) = (0, 0);
        // The start knows nothing of where points slide to.
        let mut secants = SECANTS;
        self.assembler.small_begin();
        self.assembler.linearization = Linearization {
            keep_active: true,
            slide: Slide::Secant,
            keep_facets: false,
        };
        let mut changed = 0;
        self.small_gaps(trial, time)?;
        if !trial.points.iter().any(|p| p.closed) {
            changed = self.assembler.small_switch(&mut trial.points);
        }
        let mut totals = self.linearize_small(trial, time)?;
        if changed == 0 {
            // The set of the last step is not yet that of the gaps.
            changed = self.assembler.small_switch(&mut trial.points.clone());
        }
        for iteration in 0.. {
            if self.interrupt.load(std::sync::atomic::Ordering::Relaxed) {
                return Err(StepFailure::Interrupted);
            }
            totals.changed = changed;
            let own = self.norms(trial, &totals);
            let chatters = iteration >= UNTIL_SEARCH && changed > 0;
            let (norms, vanished) = match chatters {
                true => own.beside(self.workspace.largest_force),
                false => (own, false),
            };
            floor = floor.max(norms.floor / norms.force.max(f64::MIN_POSITIVE));
            history.push((norms.relative(), changed));
            observer.event(&Event::Iteration {
                step,
                iteration,
                residual: norms.relative(),
                energy: 0.0,
                active: totals.active,
                changed,
                line_search: factor,
            });
            match norms.judge(self.settings.tolerance, changed == 0 || vanished) {
                Verdict::Converged => {
                    self.assembler.small_settled();
                    return Ok(Converged {
                        iterations: iteration,
                        augmentations: 0,
                        augmenting: 0,
                        totals,
                        force: own.force,
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
            // One that gets nearer, if slowly, is not cut: its iterations cost little.
            let most = self.settings.max_iterations;
            if iteration >= most && (iteration >= EXTENDED * most || norms.relative() > NEARLY) {
                return Err(StepFailure::TooManyIterations {
                    iterations: iteration,
                    residual: norms.relative(),
                    oscillation: broken.map_or_else(|| oscillation(&history), |r| r.to_string()),
                });
            }
            if iteration == 0 {
                // Not the residual of this state where points are kept.
            } else if norms.residual < best {
                (best, since_best) = (norms.residual, 0);
            } else {
                since_best += 1;
            }
            if changed == 0 || iteration == 0 {
                cycle.clear();
                let again = round(&history).filter(|_| rounds < ROUNDS && damped == 0);
                if let Some(period) = again {
                    (damped, since_best, rounds) = (period, 0, rounds + 1);
                }
            } else if let Some(period) = cycle.add(&trial.points, &trial.nodes)
                && let Some(found) =
                    PingPong::find(self.model, &self.workspace.base.points, trial, period)
            {
                damped = period as u32;
                observer.event(&found.event(step, iteration, false));
                self.ping_pongs += 1;
                since_best = 0;
                cycle.clear();
                broken = Some(found);
            }
            if changed == 0
                && iteration > 0
                && since_best.min(iteration - stuck_at) >= UNTIL_STUCK
                && self.assembler.oscillates()
            {
                self.assembler.linearization.slide = Slide::Stick;
                self.linearize_small(trial, time)?;
                stuck_at = iteration;
            }
            let factored = self.factorize_small(trial)?;
            *(self.workspace.factorizations)
                .entry(factored.method)
                .or_default() += 1;
            factorization = Some(factored);
            self.solve_for_increment()?;
            self.iterations += 1;
            self.assembler.linearization = Linearization::default();
            let base = &mut self.workspace.base;
            base.u.copy_from_slice(&trial.u);
            base.points.copy_from_slice(&trial.points);
            factor = match iteration > 0 && self.settings.line_search {
                true => self.search_small(trial, time, since_best)?,
                false => 1.0,
            };
            secants = match self.first.secants && factor < SHORT {
                true => SECANTS,
                false => secants.saturating_sub(1),
            };
            self.assembler.linearization.slide = Slide::secant(secants > 0);
            if damped > 0 {
                (factor, damped) = (factor.min(0.5), damped - 1);
            }
            changed = self.follow(trial, time, factor)?;
            totals = self.linearize_small(trial, time)?;
        }
        unreachable!("the loop ends by its own limit")
    }

    fn small_gaps(&mut self, trial: &State, time: f64) -> Result<(), StepFailure> {
        let gaps = self.assembler.small_gaps(&trial.u, time);
        Ok(gaps.map_err(Fault::from)?)
    }

    /// The residual, and what the next tangent is made of.
    fn linearize_small(&mut self, trial: &State, time: f64) -> Result<Totals, StepFailure> {
        let totals = self.measure(trial, time)?;
        self.assembler.small_note();
        Ok(totals)
    }

    /// How far to go along the increment: all of the way where no point switches, else to where the forces along it have fallen to half of
    /// what they were, with the limits of friction that there are where it begins, which make what acts the gradient of a convex
    /// energy. Points that would have turned at the end of the way are linearised by their secants.
    fn search_small(
        &mut self,
        trial: &mut State,
        time: f64,
        since_best: u32,
    ) -> Result<f64, StepFailure> {
        let w = &*self.workspace;
        let slope = -dot(&w.du, &w.residual);
        let changed = self.follow(trial, time, 1.0)?;
        if slope <= 0.0 || changed == 0 && since_best < UNTIL_SEARCH {
            return Ok(1.0);
        }
        self.phases.start("line_search");
        let factor = line_search::factor(slope, |s| {
            self.follow(trial, time, s).ok()?;
            (self.assembler)
                .small_search(trial, time, &mut self.workspace.scratch)
                .ok()?;
            Some(-dot(&self.workspace.du, &self.workspace.scratch))
        });
        self.phases.stop("line_search");
        if factor < 1.0 {
            self.follow(trial, time, 1.0)?;
            self.linearize_small(trial, time)?;
        }
        Ok(factor)
    }

    /// Moves along the increment from where it begins; returns how many points switch.
    fn follow(&mut self, trial: &mut State, time: f64, factor: f64) -> Result<usize, StepFailure> {
        self.walk(trial, factor);
        trial.points.copy_from_slice(&self.workspace.base.points);
        self.small_gaps(trial, time)?;
        Ok(self.assembler.small_switch(&mut trial.points))
    }
}
