//! From one stage to the next: what a run hands over to the model of the next stage, and what is told of a stage at its end.
use super::start::Problem;
use super::{Caller, Course, March, Outputs, RunState, StepControl};
use crate::assembly::{Assembler, AssemblerMemory, Fault, Totals};
use crate::contact::friction::history::PointHistory;
use crate::contact::points::SlavePoint;
use crate::machine::clock::Phases;
use crate::model::loads::DeadLoad;
use crate::model::stages::{StageModel, StageStart};
use crate::model::state::{PointState, State};
use crate::model::{Model, build};
use crate::output::StageSummary;
use crate::run::RunError;
use crate::run::commit::{self, FrictionTotals};
use crate::run::compliance::Compliance;
use crate::run::cost::Cost;
use crate::run::fields::Fields;
use crate::run::memory;
use crate::run::peaks::Peaks;
use crate::run::penalty_rule::PenaltyRule;
use crate::run::progress::Progress;
use crate::run::unseen::{Travel, Unseen};
use crate::run::watch::Watch;
use crate::scene::{LoadedScene, Scene};
use crate::solve::event::{Event, Observer};
use crate::solve::newton::Workspace;
use crate::system::linear::Method;
use covact_geometry::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Part of the largest force up to which the reactions of supports that were found, and what contacts that end still bear, are nothing.
const NOTHING: f64 = 1e-6;

/// What a contact pair remembers.
struct PairState {
    points: Vec<PointState>,
    nodes: Vec<bool>,
    histories: Vec<PointHistory>,
    cut: Option<Arc<[SlavePoint]>>,
    tractions: Vec<[f64; 2]>,
}

/// What a run hands over at the end of a stage.
pub(in crate::run) struct HandOver {
    start: StageStart,
    time: f64,
    /// Displacements, states of elements, and what stabilisation has dissipated.
    u: Vec<f64>,
    elements: Vec<f64>,
    stabilized: f64,
    pairs: Vec<PairState>,
    /// Energy that contacts store.
    stored: f64,
    penalties: Vec<f64>,
    ratios: Vec<f64>,
    rebuilds: u32,
    factorizations: BTreeMap<Method, u64>,
    phases: Phases,
    progress: Progress,
    touched: Vec<bool>,
    touching: Vec<bool>,
    watch: Watch,
    compliance: Compliance,
    rule: PenaltyRule,
    peaks: Peaks,
    travels: Vec<Travel>,
    cost: Cost,
    files: Option<super::KeptFiles>,
    stages: Vec<StageSummary>,
}

/// The residual of a state at all degrees of freedom, with what was summed.
fn evaluate(
    assembler: &mut Assembler,
    state: &State,
    time: f64,
) -> Result<(Vec<f64>, Totals), RunError> {
    let n = state.u.len();
    let (mut residual, mut rhs) = (vec![0.0; n], vec![0.0; n]);
    let totals = (assembler.linearize(&mut state.clone(), time, None, &mut residual, &mut rhs))
        .map_err(|e| RunError::internal(&e))?;
    Ok((residual, totals))
}

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
        let mut first = 0;
        let mut pairs = Vec::new();
        for (pair, own) in model.pairs.iter().enumerate() {
            let count = state.slaves(model, pair).len();
            let nodes = own.averaged.as_ref().map_or(0..0, |nodes| nodes.range());
            let history = state.history(model, pair).unwrap_or(0..0);
            pairs.push(PairState {
                points: state.points[first..first + count].to_vec(),
                nodes: state.nodes[nodes].to_vec(),
                histories: state.histories[history.clone()].to_vec(),
                cut: state.cuts.get(pair).cloned().flatten(),
                tractions: self.watch.tractions(history).to_vec(),
            });
            first += count;
        }
        Ok(HandOver {
            start,
            time,
            u: state.u.clone(),
            elements: state.elements.clone(),
            stabilized: state.stabilized,
            pairs,
            stored: totals.contact_energy + all.stored,
            penalties: self.assembler.penalties.clone(),
            ratios: self.assembler.ratios.clone(),
            rebuilds: self.assembler.rebuilds(),
            factorizations: self.workspace.factorizations.clone(),
            phases: std::mem::take(&mut self.phases),
            progress: self.progress.clone(),
            touched: self.touched.clone(),
            touching: self.touching.clone(),
            watch: self.watch.clone(),
            compliance: self.compliance.clone(),
            rule: self.rule.clone(),
            peaks: self.peaks.clone(),
            travels: self.unseen.between.travels(model),
            cost: std::mem::replace(&mut self.cost, Cost::start()),
            files: self.files.clone(),
            stages: self.stages.clone(),
        })
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
    fn of(
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

    /// The state of the stage before as one of the model of the next.
    fn state(&self, model: &Model) -> Result<State, Fault> {
        let mut state = State::new(model);
        state.u.copy_from_slice(&self.u);
        state.elements.copy_from_slice(&self.elements);
        state.stabilized = self.stabilized;
        let mut points = Vec::with_capacity(state.points.len());
        let mut begins = BTreeSet::new();
        for (index, (pair, before)) in model.pairs.iter().zip(&self.pairs).enumerate() {
            let acts = !pair.points.is_empty();
            if acts && before.points.is_empty() {
                begins.insert(index);
                points.resize(points.len() + pair.points.len(), PointState::default());
                continue;
            }
            if !acts {
                continue;
            }
            points.extend_from_slice(&before.points);
            if let Some(nodes) = &pair.averaged {
                state.nodes[nodes.range()].copy_from_slice(&before.nodes);
            }
            if let Some(cut) = state.cuts.get_mut(index) {
                cut.clone_from(&before.cut);
            }
        }
        state.points = points;
        state.forget_histories(model);
        for (index, before) in self.pairs.iter().enumerate() {
            if let Some(range) = state.history(model, index)
                && range.len() == before.histories.len()
            {
                state.histories[range].copy_from_slice(&before.histories);
            }
        }
        if !begins.is_empty() {
            let mut masters = crate::model::master::Masters::new(model);
            let begins = |index: usize| begins.contains(&index);
            commit::start(model, &mut masters, &mut state, (self.time, &begins))?;
        }
        Ok(state)
    }

    /// Gives an assembler what it carries on.
    fn set(&self, assembler: &mut Assembler) -> Result<(), RunError> {
        let memory = AssemblerMemory {
            penalties: self.penalties.clone(),
            ratios: self.ratios.clone(),
            rebuilds: self.rebuilds,
            ..assembler.memory()
        };
        assembler
            .restore(&memory)
            .map_err(|e| RunError::internal(&e))
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
        let (loaded, model) = (&problem.loaded, &problem.model);
        let mut assembler =
            Assembler::new(model, &model.dofs).map_err(|e| memory::pattern(loaded, &e))?;
        hand.set(&mut assembler)?;
        hand.watch.in_equilibrium(&mut assembler);
        let (residual, totals) = evaluate(&mut assembler, &committed, hand.time)?;
        let solver = super::start::analysed(loaded, model, &mut assembler, threads)?;
        let stored = totals.contact_energy
            + FrictionTotals::of(model, &assembler, &committed, &|_| true).stored;
        hand.set(&mut assembler)?;
        let acting = |pair: usize| !model.pairs[pair].points.is_empty();
        let mut tractions = vec![[0.0; 2]; committed.histories.len()];
        for (pair, before) in hand.pairs.iter().enumerate() {
            if let Some(range) = committed.history(model, pair)
                && range.len() == before.tractions.len()
            {
                tractions[range].copy_from_slice(&before.tractions);
            }
        }
        let HandOver {
            time,
            factorizations,
            phases,
            progress,
            touched,
            touching,
            watch,
            compliance,
            rule,
            peaks,
            travels,
            cost,
            files,
            stages,
            stored: before,
            ..
        } = hand;
        let watch = watch.enter(
            model,
            &assembler,
            (&residual, &totals),
            (stored - before, tractions),
        );
        let walk = StepControl::new(loaded, model);
        let mut workspace = Workspace::new(model);
        workspace.factorizations = factorizations;
        let mut outputs = Outputs {
            fields: Fields::new(model, &loaded.scene.output)?,
            row: Vec::new(),
        };
        outputs.fields.went_on();
        let mut run = RunState {
            problem,
            assembler,
            solver,
            workspace,
            phases,
            progress,
            touched,
            touching: (touching.into_iter().enumerate())
                .map(|(pair, touching)| touching && acting(pair))
                .collect(),
            watch,
            compliance,
            rule,
            peaks,
            unseen: Unseen::new(
                model,
                problem.loaded.scene.solution.end_time,
                &problem.may_see,
            ),
            cost,
            course: Course {
                trial: committed.clone(),
                committed,
                walk,
                outputs,
            },
            files,
            stages,
        };
        run.unseen.between.go_on(&travels);
        let never = AtomicBool::new(false);
        let (mut march, course) = run.march(Caller {
            observer,
            interrupt: &never,
        });
        march.gather(&mut course.outputs, &course.committed, time)?;
        march.tell_stage(&loaded.scene);
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
