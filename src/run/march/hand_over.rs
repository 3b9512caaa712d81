//! What a run hands over to one of another model that goes on from its last accepted step.
use super::start::{Problem, analysed};
use super::{Course, Outputs, RunState, StepControl};
use crate::assembly::{Assembler, AssemblerMemory, Fault, Totals};
use crate::contact::friction::history::PointHistory;
use crate::contact::points::SlavePoint;
use crate::machine::clock::Phases;
use crate::model::Model;
use crate::model::master::Masters;
use crate::model::stages::StageStart;
use crate::model::state::{PointState, State};
use crate::output::StageSummary;
use crate::run::RunError;
use crate::run::commit;
use crate::run::compliance::Compliance;
use crate::run::cost::Cost;
use crate::run::fields::Fields;
use crate::run::memory;
use crate::run::peaks::Peaks;
use crate::run::penalty_rule::PenaltyRule;
use crate::run::progress::Progress;
use crate::run::unseen::{Travel, Unseen};
use crate::run::watch::Watch;
use crate::solve::newton::Workspace;
use crate::system::linear::Method;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What a contact pair remembers.
struct PairState {
    points: Vec<PointState>,
    nodes: Vec<bool>,
    histories: Vec<PointHistory>,
    cut: Option<Arc<[SlavePoint]>>,
    tractions: Vec<[f64; 2]>,
}

/// What a run hands over to one of another model that goes on from its last accepted step: at the end of a stage, or with other elements.
pub(in crate::run) struct HandOver {
    pub(super) start: StageStart,
    pub(super) time: f64,
    /// Displacements, states of the elements of each body, and what stabilisation has dissipated.
    pub(super) u: Vec<f64>,
    elements: Vec<Vec<f64>>,
    stabilized: f64,
    pairs: Vec<PairState>,
    /// Energy that is stored in what the other model has otherwise.
    stored: f64,
    penalties: Vec<f64>,
    ratios: Vec<f64>,
    rebuilds: u32,
    factorizations: BTreeMap<Method, u64>,
    pub(super) largest_force: f64,
    phases: Phases,
    progress: Progress,
    touched: Vec<bool>,
    touching: Vec<bool>,
    pub(super) watch: Watch,
    compliance: Compliance,
    rule: PenaltyRule,
    peaks: Peaks,
    travels: Vec<Travel>,
    cost: Cost,
    files: Option<super::KeptFiles>,
    stages: Vec<StageSummary>,
}

/// The residual of a state at all degrees of freedom, with what was summed.
pub(super) fn evaluate(
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

/// What acts in a state that has been taken over.
pub(super) struct Acting {
    /// Of all degrees of freedom (force).
    pub residual: Vec<f64>,
    pub totals: Totals,
    /// Energy that was stored before in what the model has otherwise.
    pub before: f64,
    /// Tractions of the points with history.
    pub tractions: Vec<[f64; 2]>,
}

impl RunState<'_> {
    /// Takes the run apart for a stage that begins as `start` says; `stored` is the energy in what the other model has otherwise.
    pub(super) fn taken_apart(&mut self, start: StageStart, stored: f64) -> HandOver {
        let model = &self.problem.model;
        let state = &self.course.committed;
        let mut rest = &state.elements[..];
        let elements = (model.bodies.iter()).map(|body| {
            let (own, others) = rest.split_at(model.state_len(body) * body.block.elements());
            rest = others;
            own.to_vec()
        });
        let elements = elements.collect();
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
        HandOver {
            start,
            time: self.progress.time,
            u: state.u.clone(),
            elements,
            stabilized: state.stabilized,
            pairs,
            stored,
            penalties: self.assembler.penalties.clone(),
            ratios: self.assembler.ratios.clone(),
            rebuilds: self.assembler.rebuilds(),
            factorizations: self.workspace.factorizations.clone(),
            largest_force: self.workspace.largest_force,
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
        }
    }
}

impl HandOver {
    /// The state that is handed over as one of the other model; elements that hold states of another kind there begin with none.
    pub(super) fn state(&self, model: &Model) -> Result<State, Fault> {
        let mut state = State::new(model);
        state.u.copy_from_slice(&self.u);
        let mut rest = &mut state.elements[..];
        for (body, before) in model.bodies.iter().zip(&self.elements) {
            let (own, others) = rest.split_at_mut(model.state_len(body) * body.block.elements());
            rest = others;
            if own.len() == before.len() {
                own.copy_from_slice(before);
            }
        }
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
            let mut masters = Masters::new(model);
            let begins = |index: usize| begins.contains(&index);
            commit::start(model, &mut masters, &mut state, (self.time, &begins))?;
        }
        Ok(state)
    }

    /// Gives an assembler what it carries on.
    pub(super) fn set(&self, assembler: &mut Assembler) -> Result<(), RunError> {
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
    /// A run at a state that another one has handed over, and what acts in it; its watch still knows what acted in the other one
    /// ([`Self::acts`]).
    ///
    /// # Errors
    /// What has no room in memory, or a fault of the program.
    pub(super) fn taken_over(
        problem: &'m Problem,
        hand: HandOver,
        committed: State,
        threads: usize,
    ) -> Result<(Self, Acting), RunError> {
        let (loaded, model) = (&problem.loaded, &problem.model);
        let mut assembler =
            Assembler::new(model, &model.dofs).map_err(|e| memory::pattern(loaded, &e))?;
        hand.set(&mut assembler)?;
        hand.watch.in_equilibrium(&mut assembler);
        let (residual, totals) = evaluate(&mut assembler, &committed, hand.time)?;
        let solver = analysed(loaded, model, &mut assembler, threads)?;
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
        let acting = Acting {
            residual,
            totals,
            before,
            tractions,
        };
        Ok((run, acting))
    }

    /// Goes on from what acts in the state: `stored` is the energy in what the model has otherwise, and nobody put in the difference.
    pub(super) fn acts(&mut self, acting: Acting, stored: f64) {
        let Acting {
            residual,
            totals,
            before,
            tractions,
        } = acting;
        let model = &self.problem.model;
        let watch = std::mem::take(&mut self.watch);
        let by = (stored - before, tractions);
        self.watch = watch.enter(model, &self.assembler, (&residual, &totals), by);
    }
}
