//! Newton's method for one step.
//!
//! Full steps by default: a thin shell's first iterate stretches it, so that the residual jumps by orders of magnitude
//! before it falls, and a search that forbids the jump would crawl. The line search (on the slope of the energy along
//! the increment, which also covers steps an element cannot take) comes in where full steps fail to make headway. Where a material
//! flows it is there from the start: what a point stores and takes in a step is convex in its strain (backward Euler's rule), but its
//! slope turns by Young's modulus over the slope of hardening where it begins to flow, or ends, and full steps throw a bent sheet
//! from one side of that to the other.
mod advance;
mod converged;
mod departure;
mod headway;
mod keeping;
mod line_search;
mod patience;
mod rigid_limit;
mod small;
mod stick_limit;
mod workspace;

pub use converged::Converged;
use headway::{hops, nearly, oscillation, round};
pub use patience::Patience;
pub use rigid_limit::RigidLimit;
pub use stick_limit::StickLimit;
pub use workspace::Workspace;

use super::convergence::{Norms, Verdict};
use super::cycle::{Cycle, PingPong};
use super::event::{Event, Observer};
pub use super::failure::StepFailure;
use super::place;
use super::unstable::{Unstable, singular};
use crate::assembly::{Assembler, Fault, Linearization, Totals};
use crate::contact::friction::law::Slide;
use crate::machine::clock::Phases;
use crate::model::Model;
use crate::model::state::State;
use crate::scene;
use crate::system::linear::{Factorization, LinearError, LinearSolver, Method};
use std::sync::atomic::{AtomicBool, Ordering};

/// What the first linearisations of a start make of contact.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct First {
    /// Where points that were in contact are open at the start, the first linearisation keeps them, and secants follow. A path
    /// that is continued straight past a curved tool leaves it by more than a stiff penalty lets points sink in.
    pub hold: bool,
    /// The first linearisations take secants of friction: the start knows nothing of where points slide to.
    pub secants: bool,
    /// Every increment is searched along, not only where full steps fail to make headway.
    pub search: bool,
    /// Points in contact stay so for the first iterations where the first correction opens most of them: along the tangent planes
    /// of a curved surface a large way leads off it by more than a stiff penalty lets points sink in.
    pub keep: bool,
}

/// One step of Newton's method.
pub struct Newton<'a, 'm, S: LinearSolver + ?Sized> {
    /// The model.
    pub model: &'m Model,
    /// Evaluates forces and tangent.
    pub assembler: &'a mut Assembler<'m>,
    /// Solves the linear systems.
    pub solver: &'a mut S,
    /// Vectors that are allocated once for a run.
    pub workspace: &'a mut Workspace,
    /// Tolerance and limits of the scene.
    pub settings: &'a scene::Newton,
    /// How long it goes on without getting nearer.
    pub patience: Patience,
    /// How contact is linearised at first.
    pub first: First,
    /// Whether corrections that rotate far are followed by mixed integration points.
    pub mixed: bool,
    /// Linearisations that had them.
    pub mixed_iterations: u32,
    /// Where elapsed times are added up.
    pub phases: &'a mut Phases,
    /// Set from outside to stop.
    pub interrupt: &'a AtomicBool,
    /// Iterations done, also by a solve that failed.
    pub iterations: u32,
    /// Whether points that were in contact were open at the start, so many that they are worth keeping.
    pub opened: bool,
    /// Cycles of contact points that were broken.
    pub ping_pongs: u32,
}

/// Linearisations that take secants of friction.
const SECANTS: u32 = 2;
/// Iterations at most for which points are kept in contact, and the residual from which on they are not.
const KEPT: u32 = 4;
const NEAR: f64 = 0.05;
/// Times as many points as are left in contact have to be in contact before for that.
const MOST_OPEN: usize = 2;
/// Points in contact with bodies of which more than one has to open at the start for those that do to be worth keeping: where
/// few do, many others are pressed in, and it is these that go wrong.
const MANY_OPENED: usize = 4;
/// Iterations without headway after which the line search is switched on.
const UNTIL_SEARCH: u32 = 6;
/// Times that iterates which go round while no point switches go half of the way.
const ROUNDS: u32 = 3;
/// Iterations without headway, and since the last time, after which points that slide to and fro are taken to stick.
const UNTIL_STUCK: u32 = 2;
/// Iterations without headway after which a start is given up where another is at hand. A thin shell may take six to
/// come down from the jump of its first iterate.
const UNTIL_GIVEN_UP: u32 = 9;
/// Part of their distance by which an increment has to move neighbouring nodes against each other for mixed integration points to take
/// part from there on: what turns less is not stretched enough to spoil the tangent.
const BENDS: f64 = 0.5;
/// Multiple of their distance by which an increment that is larger than the one before may move neighbouring nodes against each
/// other: iterates of elements that do not turn inside out grow without bounds otherwise, and contact is searched over all of it.
const WILD: f64 = 1e3;
/// Iterations after which mixed integration points have not helped, and may go round.
const MIXED: u32 = 12;
/// Part of an increment, by its square, that has to be a rigid motion for a body to run away.
const MOSTLY: f64 = 0.5;
/// Multiple of the allowed iterations up to which an attempt goes on that is nearly done.
const EXTENDED: u32 = 2;
/// Iterations without headway after which a residual this multiple of the tolerance is accepted.
const STALLS: u32 = 6;
const STALLED: f64 = 100.0;
/// Tolerance from which on that is done: who asks for a smaller one wants it met.
const LOOSE: f64 = 1e-8;
impl<S: LinearSolver + ?Sized> Newton<'_, '_, S> {
    /// Solves for equilibrium at `time`, starting from `trial`, and leaves it there. On failure `trial` is spoilt: the
    /// caller takes its copy back.
    pub fn solve(
        &mut self,
        step: u32,
        time: f64,
        trial: &mut State,
        observer: &mut dyn Observer,
    ) -> Result<Converged, StepFailure> {
        self.opened = false;
        let w = &mut *self.workspace;
        w.factored = false;
        let outstanding = (self.model)
            .increments(&trial.u, time, &mut w.increments)
            .map_err(Fault::from)?;
        let mut pending = outstanding > 0.0;
        let mut history: Vec<(f64, usize)> = Vec::new();
        let (mut floor, mut factorization) = (0.0f64, None);
        let (mut best, mut since_best) = (f64::INFINITY, 0u32);
        let mut first_energy = 0.0;
        let mut factor = 1.0;
        let mut energy = 0.0;
        let (mut totals, secants) = self.begin(trial, time, pending)?;
        let (mut touched, mut keep, mut bends) = (false, false, false);
        // By how much the last increment moved neighbouring nodes: a thin shell may come down from a wild first one.
        let mut moved = f64::INFINITY;
        // The first correction, or the motion, has opened most points.
        let mut far = self.first.keep && self.assembler.linearization.keep_active;
        // Contact alone holds a body: supports, or inertia, hold others, which may well leave a surface. Times that its last points
        // were kept.
        let alone = self.model.stabilization.is_some() && self.model.dynamics.is_none();
        let mut held_back = 0;
        let searches = self.first.search || self.model.flows();
        let (mut cycle, mut broken, mut damped) = (Cycle::default(), None::<PingPong>, 0u32);
        let mut rounds = 0;
        // When points that slide to and fro were taken to stick last.
        let mut stuck_at = 0;
        for iteration in 0.. {
            if self.interrupt.load(Ordering::Relaxed) {
                return Err(StepFailure::Interrupted);
            }
            let own = self.norms(trial, &totals);
            // A light touch comes to rest by its own measure; what rounding opens and closes does not.
            let chatters = iteration >= UNTIL_SEARCH && totals.changed > 0;
            let (norms, vanished) = match chatters {
                true => own.beside(self.workspace.largest_force),
                false => (own, false),
            };
            floor = floor.max(norms.floor / norms.force.max(f64::MIN_POSITIVE));
            history.push((norms.relative(), totals.changed));
            keep |= iteration >= 2 || hops(&history);
            let held = self.assembler.linearization.keep_active;
            // The state before the first solve may be converged as it stands only if nothing was prescribed to move.
            let rough = self.patience == Patience::Rough;
            let still = iteration == 0 || totals.changed == 0 || vanished || rough;
            let settled = !pending && !held && still;
            observer.event(&Event::Iteration {
                step,
                iteration,
                residual: norms.relative(),
                energy: if first_energy > 0.0 {
                    energy / first_energy
                } else {
                    0.0
                },
                active: totals.active,
                changed: totals.changed,
                line_search: factor,
            });
            // A point that goes to and fro between two facets leaves a residual that iterations do not lower.
            let stalled = since_best >= STALLS && norms.residual >= best;
            let tolerance = match stalled && self.settings.tolerance >= LOOSE {
                true => STALLED * self.settings.tolerance,
                false if rough => self.settings.tolerance.max(patience::ROUGH),
                false => self.settings.tolerance,
            };
            touched |= totals.active > 0;
            match norms.judge(tolerance, settled) {
                Verdict::Converged => {
                    self.stays(&trial.u, iteration)?;
                    // An iterate that overshoots may lose all contact, and find what is beyond a snap.
                    let unstable =
                        |f: &Factorization| f.method != Method::Lu && f.negative_pivots > 0;
                    if touched
                        && totals.active == 0
                        && self.patience == Patience::Short
                        && factorization.as_ref().is_some_and(unstable)
                    {
                        return Err(StepFailure::LostContact);
                    }
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
            let stuck = self.patience == Patience::Short && since_best >= UNTIL_GIVEN_UP;
            let most = self.settings.max_iterations;
            let late = iteration >= most && (iteration >= EXTENDED * most || !nearly(&history));
            if late || stuck {
                if let Some(failure) = self.runs_away(&trial.u) {
                    return Err(failure);
                }
                let negligible = norms.target(self.settings.tolerance);
                if let Some(fault) = self.assembler.runs_away(&totals.loose, negligible) {
                    return Err(fault.into());
                }
                return Err(StepFailure::TooManyIterations {
                    iterations: iteration,
                    residual: norms.relative(),
                    oscillation: broken.map_or_else(|| oscillation(&history), |r| r.to_string()),
                });
            }
            if held {
                // Not the residual of this state.
            } else if norms.residual < best {
                (best, since_best) = (norms.residual, 0);
            } else {
                since_best += 1;
            }
            if totals.changed == 0 || held {
                cycle.clear();
                let again = round(&history).filter(|_| rounds < ROUNDS && damped == 0 && !held);
                if let Some(period) = again {
                    (damped, since_best, rounds) = (period, 0, rounds + 1);
                }
            } else if let Some(period) = cycle.add(&trial.points, &trial.nodes)
                && let Some(found) =
                    PingPong::find(self.model, &self.workspace.base.points, trial, period)
            {
                // Kept in contact for once, then approached by half of the way.
                let hold = self.ping_pongs.is_multiple_of(2) && self.keep(trial, time)?.is_some();
                damped = if hold { 0 } else { period as u32 };
                observer.event(&found.event(step, iteration, hold));
                self.ping_pongs += 1;
                since_best = 0;
                cycle.clear();
                broken = Some(found);
            }
            if totals.changed == 0
                && !(pending || held)
                && since_best.min(iteration - stuck_at) >= UNTIL_STUCK
                && let Some(sticking) = self.stick(trial, time)?
            {
                (totals, stuck_at) = (sticking, iteration);
            }
            factorization = Some(self.solve_linear(pending)?);
            self.iterations += 1;
            let bend = self.model.largest_stretch(&self.workspace.du);
            bends |= bend > BENDS && iteration < MIXED;
            if iteration == 0 {
                self.workspace.bend = bend;
            }
            // A body that nothing holds yet goes a part of it only.
            let free = self.model.stabilization.as_ref();
            let part = free.map_or(1.0, |s| s.stride(&self.workspace.du).0);
            let before = std::mem::replace(&mut moved, part * bend);
            if moved > WILD && moved > before && moved.is_finite() {
                return Err(StepFailure::Diverges {
                    iteration,
                    stretch: moved,
                });
            }
            let keep_active = far && held && iteration < KEPT && norms.relative() > NEAR;
            self.assembler.linearization = Linearization {
                keep_active,
                slide: Slide::secant(iteration + 1 < secants || keep_active),
                keep_facets: keep,
            };
            let search =
                self.settings.line_search && !pending && (searches || since_best >= UNTIL_SEARCH);
            let largest = if damped > 0 { 0.5 } else { 1.0 };
            damped = damped.saturating_sub(1);
            let mixed = self.mixed && !held && iteration < MIXED && bends;
            // Residuals then rise before they fall, more than others do.
            let search = search && (!mixed || searches);
            let pressed = totals.active;
            let touching = std::mem::take(&mut totals.touching);
            let keeps = iteration == 0 && self.first.keep;
            (totals, factor, pending) =
                self.advance(trial, time, (search, mixed, keeps), pending, largest)?;
            far |= keeps && self.assembler.linearization.keep_active;
            if keeps
                && !far
                && !pending
                && MOST_OPEN * totals.active < pressed
                && let Some(kept) = self.keep(trial, time)?
            {
                totals = kept;
                far = true;
            }
            let lost = alone
                && (touching.iter().zip(&totals.touching)).any(|(before, now)| *before && !now);
            if lost
                && !far
                && !pending
                && held_back < KEPT
                && !self.assembler.linearization.keep_active
                && let Some(kept) = self.keep(trial, time)?
            {
                totals = kept;
                held_back += 1;
            }
            energy = dot(&self.workspace.du, &self.workspace.rhs).abs();
            if iteration == 0 {
                first_energy = energy;
            }
        }
        unreachable!("the loop ends by its own limit")
    }

    /// `pending`: prescribed displacements are still to come; `mixed`: with mixed integration points.
    fn linearize(
        &mut self,
        trial: &mut State,
        time: f64,
        (pending, mixed): (bool, bool),
    ) -> Result<Totals, Fault> {
        let w = &mut *self.workspace;
        self.mixed_iterations += u32::from(mixed);
        self.phases.start("assembly");
        let increments = pending.then_some(&w.increments[..]);
        let from = mixed.then_some(&w.base.u[..]);
        let totals = (self.assembler).linearize_mixed(
            trial,
            time,
            (increments, from),
            &mut w.residual,
            &mut w.rhs,
        );
        self.phases.stop("assembly");
        totals
    }

    /// Solves for the increment.
    fn solve_linear(&mut self, pending: bool) -> Result<Factorization, StepFailure> {
        self.workspace.factored = false;
        let factored = self.factorize()?;
        let w = &mut *self.workspace;
        w.factored = true;
        *w.factorizations.entry(factored.method).or_default() += 1;
        self.phases.start("solve");
        w.du.copy_from_slice(&w.rhs);
        let solved = (self.solver).solve_with(self.assembler.matrix(), &mut w.du);
        self.phases.stop("solve");
        solved.map_err(|error| self.unsolvable(error))?;
        let w = &mut *self.workspace;
        let g = pending.then_some(&w.increments[..]);
        self.model.dofs.expand(&mut w.du, g);
        w.unstable = Unstable::of(self.model, &factored, &w.du).or(w.unstable);
        Ok(factored)
    }

    /// Factorizes the matrix of the assembler, whose pattern is analysed before where it is new.
    fn factorize(&mut self) -> Result<Factorization, StepFailure> {
        if let Some(pattern) = self.assembler.take_new_pattern() {
            self.phases.start("analysis");
            let analyzed = self.solver.analyze(&pattern).map(drop);
            self.phases.stop("analysis");
            analyzed.map_err(|error| self.unsolvable(error))?;
        }
        self.phases.start("factorization");
        let factored = self.solver.factorize(self.assembler.matrix());
        self.phases.stop("factorization");
        factored.map_err(|error| self.unsolvable(error))
    }

    /// What a matrix that cannot be factorized means: in the terms of the scene where a surface driven by force or a body is
    /// not held.
    fn unsolvable(&self, error: LinearError) -> StepFailure {
        if let LinearError::NonPositivePivot { dof }
        | LinearError::ZeroPivot { dof }
        | LinearError::TinyPivot { dof, .. } = &error
            && let Some(fault) = self.assembler.unheld(dof.dof())
        {
            return StepFailure::Fault(fault);
        }
        if let Some(words) = singular(self.model, &error, self.assembler.stabilizes()) {
            return StepFailure::Singular { error, words };
        }
        let place = place::of_linear(self.model, &error);
        StepFailure::Solve { error, place }
    }

    /// A free body at displacements `u` that the iterations ended with holding back. An increment that deforms it more than
    /// it moves it is that of a body that gives way, not of one that goes.
    fn runs_away(&self, u: &[f64]) -> Option<StepFailure> {
        let stabilization = self.model.stabilization.as_ref()?;
        let (part, piece) = stabilization.stride(&self.workspace.du);
        let motion = &piece?.motion;
        let position = |n: u32| self.model.position(n as usize, u);
        if motion.rigid_share(position, &self.workspace.du) < MOSTLY {
            return None;
        }
        Some(StepFailure::RunsAway {
            body: motion.body.clone(),
            motion: motion.motion.clone(),
            reached: format!(
                "the last iteration wanted {:.1e} times the way that an iteration may go",
                1.0 / part
            ),
            loaded: self.model.loaded(),
        })
    }

    fn norms(&mut self, trial: &State, totals: &Totals) -> Norms {
        let w = &mut *self.workspace;
        w.scratch.copy_from_slice(&w.residual);
        self.model.dofs.fold(&mut w.scratch);
        let residual = dot(&w.scratch, &w.scratch).sqrt();
        let reactions: f64 = (self.model.dofs.removed())
            .map(|d| w.residual[d as usize].powi(2))
            .sum();
        let external = self.assembler.external();
        let external = dot(external, external).sqrt();
        // Strains are computed from displacements, so these count; a trace of the positions keeps the floor above zero
        // before anything has moved.
        for (node, x) in self.model.nodes.iter().enumerate() {
            for c in 0..3 {
                let u = trial.u[3 * node + c];
                w.scratch[3 * node + c] = u.abs().max(f64::EPSILON * x[c].abs());
            }
        }
        let force = (reactions.sqrt().max(external))
            .max(totals.contact_norm)
            .max(totals.effects_norm);
        // The curvatures of a sheet are those of its positions, and rounding leaves forces of these once there are no others.
        let sheets = (self.model.bodies.iter()).filter(|b| b.block.sheet().is_some());
        for body in sheets.filter(|_| Norms::vanish(force, w.largest_force)) {
            let first = body.first_node as usize;
            for node in first..first + body.mesh.nodes.len() {
                for c in 0..3 {
                    let at = self.model.nodes[node][c] + trial.u[3 * node + c];
                    let scratch = &mut w.scratch[3 * node + c];
                    *scratch = scratch.max(at.abs());
                }
            }
        }
        self.assembler
            .matrix()
            .abs_multiply(&w.scratch, &mut w.absolute);
        self.model.dofs.fold(&mut w.absolute);
        let floor =
            0.5 * f64::EPSILON * dot(&w.absolute, &w.absolute).sqrt() + totals.contact_rounding;
        Norms {
            residual,
            force,
            floor,
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
