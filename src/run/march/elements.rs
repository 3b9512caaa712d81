//! Going on from the last accepted step with other elements for bodies whose own cannot be followed any farther.
use super::hand_over::{HandOver, evaluate};
use super::start::Problem;
use super::{Caller, RunState};
use crate::assembly::Totals;
use crate::machine::clock::Phases;
use crate::model::{Model, build};
use crate::run::RunError;
use crate::run::commit::FrictionTotals;
use crate::run::cost::Cost;
use crate::scene::LoadedScene;
use crate::solve::event::Observer;
use covact_geometry::Vec3;
use std::sync::atomic::AtomicBool;

/// Part of the strain energy, and of the largest force, by which the answers of both kinds of elements may differ where one goes on
/// from the other, or stands for it without a word.
pub(in crate::run) const ALIKE: f64 = 0.05;

/// A run that goes on with other elements.
pub(in crate::run) struct OtherElements {
    hand: HandOver,
    /// What was summed with the elements before.
    totals: Totals,
    /// Size of the last step (time).
    size: f64,
    /// Increments of the displacements in the last step, while the path is smooth, and its size (time).
    path: Option<(Vec<f64>, f64)>,
}

/// Why a run does not go on with other elements.
pub(in crate::run) enum Unlike {
    /// They have no equilibrium beside that of the elements before, or another one.
    Found(Box<Spent>),
    Run(RunError),
}

/// What was spent in all, with what it took to find that out.
pub(in crate::run) struct Spent {
    phases: Phases,
    cost: Cost,
    iterations: u64,
}

impl From<RunError> for Unlike {
    fn from(error: RunError) -> Self {
        Unlike::Run(error)
    }
}

impl OtherElements {
    /// The model of the present stage in a scene with other elements.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn model(&self, loaded: &LoadedScene) -> Result<Model, RunError> {
        build::build_stage(loaded, self.hand.start.clone(), None)
            .map_err(|e| RunError::model(loaded, e))
    }
}

impl RunState<'_> {
    /// Takes the run apart to go on from its last accepted step, in equilibrium and at rest, with other elements for some bodies; nothing
    /// where their elements remember more than the displacements tell, and before the first step.
    ///
    /// # Errors
    /// A state that cannot be evaluated, which is a fault of the program.
    pub(in crate::run) fn for_elements(
        &mut self,
        bodies: &[usize],
    ) -> Result<Option<OtherElements>, RunError> {
        let model = &self.problem.model;
        let remember = |body: &usize| model.bodies[*body].block.law().state_len() > 0;
        let walk = &self.course.walk;
        if self.progress.steps == 0
            || walk.jump.is_some()
            || model.dynamics.is_some()
            || model.small.is_some()
            || bodies.iter().any(remember)
        {
            return Ok(None);
        }
        let size = walk.before.as_ref().map_or(0.0, |(_, size)| *size);
        let size = size.max(walk.stepping.size());
        let state = &self.course.committed;
        let (_, totals) = evaluate(&mut self.assembler, state, self.progress.time)?;
        let sliding = FrictionTotals::of(model, &self.assembler, state, &|_| true);
        let path = walk.before.as_ref().map(|(before, size)| {
            let along = state.u.iter().zip(&before.u).map(|(now, was)| now - was);
            (along.collect(), *size)
        });
        let stored = totals.internal_energy + totals.contact_energy + sliding.stored;
        let start = model.stage.as_ref().map(|stage| stage.start.clone());
        Ok(Some(OtherElements {
            hand: self.taken_apart(start.unwrap_or_default(), stored),
            totals,
            size,
            path,
        }))
    }

    /// Takes back what was handed over, where nothing goes on from it.
    pub(in crate::run) fn back(&mut self, spent: Spent) {
        (self.phases, self.cost) = (spent.phases, spent.cost);
        self.progress.iterations = spent.iterations;
    }
}

/// Whether two answers to the same loads and motions are alike.
fn are_alike(one: &Totals, other: &Totals) -> bool {
    let energies = [one, other].map(|totals| totals.internal_energy);
    let forces = |totals: &Totals| -> Vec<Vec3> {
        let tools = totals.surfaces.iter().map(|s| s.force);
        let bodies = totals.pairs.iter().map(|p| p.slave.force);
        tools.chain(bodies).collect()
    };
    let [one, other] = [one, other].map(forces);
    let largest = (one.iter().chain(&other)).fold(0.0, |most: f64, f| most.max(f.norm()));
    let apart = one.iter().zip(&other).map(|(a, b)| (a - b).norm());
    apart.fold(0.0, f64::max) <= ALIKE * largest
        && (energies[0] - energies[1]).abs() <= ALIKE * energies[0].max(energies[1])
}

impl<'m> RunState<'m> {
    /// A run that goes on from another one with other elements, from their equilibrium at the same time.
    ///
    /// # Errors
    /// [`Unlike`]
    pub(in crate::run) fn with_elements(
        problem: &'m Problem,
        other: OtherElements,
        threads: usize,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Self, Unlike> {
        let model = &problem.model;
        let OtherElements {
            hand,
            totals,
            size,
            path,
        } = other;
        let (time, force) = (hand.time, hand.largest_force);
        let state = hand.state(model).map_err(|e| RunError::internal(&e))?;
        let (mut run, mut acting) = RunState::taken_over(problem, hand, state, threads)?;
        run.workspace.largest_force = force;
        run.course.walk.stepping.set_size(size);
        let never = AtomicBool::new(false);
        let (mut march, course) = run.march(Caller {
            observer,
            interrupt: &never,
        });
        let penalties = march.assembler.penalties.clone();
        let (step, committed) = (march.progress.steps, &course.committed);
        (march.assembler).begin_step(&committed.u, time - size, time);
        march.assembler.pass(&committed.u, 0.0);
        let habit = &mut course.walk.habit;
        let solved =
            (march.attempts(committed, habit, 0)).solve(step, time, 0.0, None, &mut course.trial);
        let alike = solved
            .is_ok_and(|converged| !converged.softened && are_alike(&totals, &converged.totals));
        if !alike || march.assembler.penalties != penalties {
            return Err(Unlike::Found(Box::new(Spent {
                iterations: run.progress.iterations,
                phases: run.phases,
                cost: run.cost,
            })));
        }
        course.committed.copy_from(&course.trial);
        // The path goes on as it came.
        course.walk.before = path.map(|(along, size)| {
            let mut before = course.committed.clone();
            for (u, along) in before.u.iter_mut().zip(along) {
                *u -= along;
            }
            (before, size)
        });
        (acting.residual, acting.totals) = evaluate(march.assembler, &course.committed, time)?;
        march.gather(&mut course.outputs, &course.committed, time)?;
        let sliding = FrictionTotals::of(model, march.assembler, &course.committed, &|_| true);
        let totals = &acting.totals;
        let stored = totals.internal_energy + totals.contact_energy + sliding.stored;
        run.acts(acting, stored);
        run.watch.keep_tractions(run.assembler.answers());
        Ok(run)
    }
}
