//! From one stage to the next: what a run hands over to the model of the next stage, and what is told of a stage at its end.
use super::hand_over::{HandOver, evaluate};
use super::start::Problem;
use super::{Caller, March, RunState};
use crate::assembly::{Assembler, Totals};
use crate::model::loads::DeadLoad;
use crate::model::stages::{StageModel, StageStart};
use crate::model::state::State;
use crate::model::{Model, build};
use crate::output::StageSummary;
use crate::run::RunError;
use crate::run::commit::FrictionTotals;
use crate::run::memory;
use crate::scene::{LoadedScene, Scene};
use crate::solve::event::{Event, Observer};
use covact_geometry::Vec3;
use std::sync::atomic::AtomicBool;

/// Part of the largest force up to which the reactions of supports that were found, and what contacts that end still bear, are nothing.
const NOTHING: f64 = 1e-6;

/// The largest force of a tool, or between bodies.
fn largest(totals: &Totals) -> f64 {
    let tools = totals.surfaces.iter().map(|s| s.force.norm());
    let bodies = totals.pairs.iter().map(|p| p.slave.force.norm());
    tools.chain(bodies).fold(0.0, f64::max)
}

impl RunState<'_> {
    /// Whether the last accepted step ended a stage that another follows.
    pub(in crate::run) fn stage_is_over(&self) -> bool {
        let stage = self.problem.model.stage.as_ref();
        stage.is_some_and(|s| !s.last && self.ends(s))
    }

    fn ends(&self, stage: &StageModel) -> bool {
        let tiny = 1e-9 * self.problem.loaded.scene.solution.end_time;
        self.progress.time >= stage.span[1] - tiny
    }

    /// Takes the run apart for the stage of a scene that follows.
    ///
    /// # Errors
    /// A contact that cannot be evaluated at the accepted state, which is a fault of the program.
    pub(in crate::run) fn hand_over(&mut self, scene: &Scene) -> Result<HandOver, RunError> {
        let model = &self.problem.model;
        let time = self.progress.time;
        let state = &self.course.committed;
        let before = model.stage.as_ref().map(|s| s.start.clone());
        let before = before.unwrap_or_default();
        let index = before.index + 1;
        let mut residual = vec![0.0; state.u.len()];
        let totals = (self
            .assembler
            .contact(&mut state.clone(), time, &mut residual))
        .map_err(|e| RunError::internal(&e))?;
        let active = scene.active_contacts(index);
        let lasting = |pair: usize| active.contains(model.pairs[pair].name.as_str());
        let [all, kept] = [&|_: usize| true, &lasting as &dyn Fn(usize) -> bool]
            .map(|of| FrictionTotals::of(model, &self.assembler, state, of));
        let start = StageStart {
            index,
            stabilized: match index {
                1 => model.stabilization.is_some(),
                _ => before.stabilized,
            },
            dissipated: before.dissipated + all.dissipated - kept.dissipated,
            force: before.force.max(largest(&totals)),
            released: Vec::new(),
            held: Vec::new(),
        };
        let stored = totals.contact_energy + all.stored;
        Ok(self.taken_apart(start, stored))
    }

    /// Tells what is known of a stage once the last step of it is accepted, or where it is `cut` short.
    pub(in crate::run) fn end_stage(&mut self, observer: &mut (dyn Observer + Send), cut: bool) {
        let model = &self.problem.model;
        let Some(stage) = model.stage.as_ref().filter(|s| cut || self.ends(s)) else {
            return;
        };
        if self.stages.len() > stage.start.index {
            return;
        }
        let residual = self.workspace.residual();
        let held = stage.start.held.iter();
        let reaction = held.fold(0.0f64, |most, (dof, _)| {
            most.max(residual[*dof as usize].abs())
        });
        let forces = &self.course.outputs.fields.bearings.pairs;
        let bears = |name: &&String| {
            let mut pairs = model.pairs.iter().zip(self.touching.iter().zip(forces));
            pairs.any(|(pair, (touching, bearing))| {
                *touching && pair.name == **name && bearing.force > NOTHING * stage.start.force
            })
        };
        let bearing: Vec<String> = stage.ending.iter().filter(bears).cloned().collect();
        let mut texts = Vec::new();
        if reaction > NOTHING * stage.start.force {
            // Each body has supports of its own, which hold it against what others press on it.
            let mut between = model.pairs.iter().zip(forces).filter(|(pair, bearing)| {
                pair.body_master().is_some() && bearing.force > NOTHING * stage.start.force
            });
            let why = match between.next() {
                Some((pair, _)) => format!(
                    "bodies press on each other in contact `{}`, and what is left is not the shape of free bodies: release it, too",
                    pair.name
                ),
                None => "loads act on the body, or its supports do not fit together".to_owned(),
            };
            texts.push(format!(
                "stage `{}`: the supports that were found exert forces up to {reaction:.3e} at its end, where they should \
                 exert none: {why}",
                stage.name
            ));
        }
        for contact in &bearing {
            texts.push(format!(
                "stage `{}`: contact `{contact}` still bears at its end, with its tool back where it started: what is left is not the \
                 shape of a free body. Move the tool on, away from it, or take `\"release\": \"forces\"`",
                stage.name
            ));
        }
        let told = StageSummary {
            name: stage.name.clone(),
            until: self.progress.time,
            step: self.progress.steps,
            force: stage.start.force,
            found_supports: stage.start.held.len(),
            reaction,
            bearing,
        };
        self.stages.push(told);
        let never = AtomicBool::new(false);
        let (mut march, _) = self.march(Caller {
            observer,
            interrupt: &never,
        });
        texts.into_iter().for_each(|text| march.warn(text));
    }
}

impl FrictionTotals {
    /// Those of the pairs `of` at an accepted state.
    pub(super) fn of(
        model: &Model,
        assembler: &Assembler,
        state: &State,
        of: &dyn Fn(usize) -> bool,
    ) -> FrictionTotals {
        let mut total = FrictionTotals::default();
        for (index, pair) in model.pairs.iter().enumerate().filter(|(i, _)| of(*i)) {
            let (Some(range), Some(_)) = (state.history(model, index), &pair.friction) else {
                continue;
            };
            let answers = pair
                .augmentation
                .map(|_| &assembler.answers()[range.clone()]);
            let eps_t = assembler.ratios[index] * assembler.penalties[index];
            let histories = &state.histories[range];
            let points = state.slaves(model, index);
            total.add(histories, answers, points, eps_t, pair.share());
        }
        total
    }
}

impl HandOver {
    /// The model of the next stage and its state: what acted in the stage before and does not any more is a load that is let down.
    ///
    /// # Errors
    /// A body that nothing holds in the stage, or a fault of the program.
    pub(in crate::run) fn next(
        &mut self,
        loaded: &LoadedScene,
    ) -> Result<(Model, State), RunError> {
        let mut model = build::build_stage(loaded, self.start.clone(), Some(&self.u))
            .map_err(|e| RunError::model(loaded, e))?;
        let state = self.state(&model).map_err(|e| RunError::internal(&e))?;
        let released = {
            let mut assembler =
                Assembler::new(&model, &model.dofs).map_err(|e| memory::pattern(loaded, &e))?;
            self.set(&mut assembler)?;
            self.watch.in_equilibrium(&mut assembler);
            let (residual, _) = evaluate(&mut assembler, &state, self.time)?;
            let mut free = residual.clone();
            model.dofs.fold(&mut free);
            let own = 3 * model.body_nodes();
            for (dof, _) in model.stage.iter().flat_map(|s| &s.start.held) {
                free[*dof as usize] = residual[*dof as usize];
            }
            let forces = free[..own].iter().enumerate().filter(|(_, f)| **f != 0.0);
            forces.map(|(dof, f)| (dof as u32, *f)).collect::<Vec<_>>()
        };
        if let Some((_, DeadLoad::Nodal { forces, .. })) = model.dead_loads.last_mut() {
            forces.clone_from(&released);
        }
        if let Some(stage) = &mut model.stage {
            let norm = released.iter().map(|(_, f)| f * f).sum::<f64>().sqrt();
            stage.start.force = stage.start.force.max(norm);
            stage.start.released = released;
        }
        Ok((model, state))
    }
}

impl<'m> RunState<'m> {
    /// A run at the start of a stage that follows another.
    ///
    /// # Errors
    /// What has no room in memory, or a fault of the program.
    pub(in crate::run) fn enter(
        problem: &'m Problem,
        hand: HandOver,
        committed: State,
        threads: usize,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Self, RunError> {
        let time = hand.time;
        let (mut run, acting) = RunState::taken_over(problem, hand, committed, threads)?;
        let (model, state) = (&problem.model, &run.course.committed);
        let sliding = FrictionTotals::of(model, &run.assembler, state, &|_| true);
        let stored = acting.totals.contact_energy + sliding.stored;
        run.acts(acting, stored);
        let never = AtomicBool::new(false);
        let (mut march, course) = run.march(Caller {
            observer,
            interrupt: &never,
        });
        march.gather(&mut course.outputs, &course.committed, time)?;
        march.tell_stage(&problem.loaded.scene);
        Ok(run)
    }
}

impl March<'_, '_> {
    /// Tells that a stage begins, and how.
    fn tell_stage(&mut self, scene: &Scene) {
        let model = self.model;
        let Some(stage) = &model.stage else { return };
        let mut text = format!("stage `{}` begins", stage.name);
        let ended = scene.ending_contacts(stage.start.index);
        let ended: Vec<String> = ended.iter().map(|name| format!("`{name}`")).collect();
        if !ended.is_empty() {
            text += &match stage.ending.is_empty() {
                true => format!("; the forces of contact {} are let down", ended.join(", ")),
                false => format!("; the tools of contact {} go back", ended.join(", ")),
            };
        }
        for (dof, _) in &stage.start.held {
            let node = *dof as usize / 3;
            let x: Vec3 = model.nodes[node];
            let axis = ["x", "y", "z"][*dof as usize % 3];
            let at = x.data.0[0].map(crate::model::error::number).join(", ");
            text += &format!("; {axis} held at ({at})");
        }
        self.observer.event(&Event::Note { text });
    }
}
