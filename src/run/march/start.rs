//! What a run is made of, at time 0 or where it was kept.
use super::{Caller, Course, Kept, KeptFiles, March, Outputs, Patience, StepControl};
use crate::assembly::{Assembler, AssemblerMemory};
use crate::machine::clock::Phases;
use crate::model::Model;
use crate::model::edges;
use crate::model::error::number;
use crate::model::state::State;
use crate::output::StageSummary;
use crate::plan::Plan;
use crate::run::checkpoint::{CheckpointError, Sections};
use crate::run::commit;
use crate::run::compliance::Compliance;
use crate::run::cost::Cost;
use crate::run::fields::Fields;
use crate::run::habit::Habit;
use crate::run::peaks::Peaks;
use crate::run::penalty_rule::PenaltyRule;
use crate::run::progress::Progress;
use crate::run::unseen::{MaySee, Unseen};
use crate::run::watch::Watch;
use crate::run::{RunError, memory, resting};
use crate::scene::LoadedScene;
use crate::solve::event::{Event, Observer};
use crate::solve::newton::Workspace;
use crate::solve::stepping::Stepping;
use crate::system::linear::{DirectSolver, LinearSolver, LuSolver, SolverOptions};
use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

/// What a run solves.
#[derive(Debug)]
pub(crate) struct Problem {
    pub loaded: LoadedScene,
    pub model: Model,
    pub plan: Plan,
    /// Bodies whose elements another variant may replace.
    pub replaceable: Vec<String>,
    /// Whether another variant may exchange the sides of a contact.
    pub exchangeable: bool,
    /// Whether another variant may have all faces of a body as a master, where its edge lies on the slave.
    pub sides_may: bool,
    /// Pairs whose slaves may see more in another variant.
    pub may_see: MaySee,
    /// How long the run is followed where it goes on badly.
    pub patience: Patience,
    /// What it has other than the scene as given, as checkpoints keep it.
    pub changes: String,
}

/// Everything of a run that lasts from one step to the next.
pub(crate) struct RunState<'m> {
    pub(super) problem: &'m Problem,
    pub(in crate::run) assembler: Assembler<'m>,
    pub(super) solver: Box<dyn LinearSolver + Send>,
    pub(super) workspace: Workspace,
    pub(in crate::run) phases: Phases,
    pub(in crate::run) progress: Progress,
    pub(super) touched: Vec<bool>,
    pub(super) touching: Vec<bool>,
    pub(super) watch: Watch,
    pub(super) compliance: Compliance,
    pub(super) rule: PenaltyRule,
    pub(super) peaks: Peaks,
    pub(super) unseen: Unseen,
    pub(super) cost: Cost,
    pub(in crate::run) course: Course,
    /// The files of the checkpoint that the run went on from.
    pub(in crate::run) files: Option<KeptFiles>,
    /// Stages that have ended.
    pub(super) stages: Vec<StageSummary>,
}

impl<'m> RunState<'m> {
    /// Whether an edge of a master lies on its slave in the last accepted state, between slave points that do not see it.
    pub(in crate::run) fn edges_on_slaves(&self) -> bool {
        let (model, u) = (&self.problem.model, &self.course.committed.u);
        (model.pairs.iter()).any(|pair| edges::on_slave(model, pair, u))
    }

    /// Whether an edge of a rigid surface has sunk into its slave in the last accepted state, between slave points, and may be a
    /// slave in another run.
    pub(in crate::run) fn rims_sunk(&mut self) -> bool {
        let (model, u) = (&self.problem.model, &self.course.committed.u);
        let penetration = vec![0.0; model.pairs.len()];
        let bearings = &self.course.outputs.fields.bearings.pairs;
        let by = (&penetration[..], &bearings[..]);
        let sunk = (self.unseen.rims).sunk(model, u, self.progress.time, by);
        sunk.iter().any(|s| s.may)
    }

    /// Whether a contact with the faces of a body is closed.
    pub(in crate::run) fn on_bodies(&self) -> bool {
        let model = &self.problem.model;
        let mut pairs = model.pairs.iter().zip(&self.touching);
        pairs.any(|(pair, touching)| *touching && model.between_bodies(pair))
    }

    /// A run at time 0, or as it was when its checkpoint was written.
    ///
    /// # Errors
    /// What has no room in memory, a checkpoint that does not fit the model, or a field that cannot be made.
    pub fn new(
        problem: &'m Problem,
        (mut phases, cost): (Phases, Cost),
        threads: usize,
        sections: Option<&Sections>,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Self, RunError> {
        let (loaded, model) = (&problem.loaded, &problem.model);
        memory::flat_copies(loaded, model)?;
        phases.start("analysis");
        let mut assembler =
            Assembler::new(model, &model.dofs).map_err(|e| memory::pattern(loaded, &e))?;
        let kept = sections.map(|sections| Kept::read(sections, model));
        let kept = kept.transpose()?;
        if let (Some(kept), Some(sections)) = (&kept, sections) {
            (assembler.restore(&kept.assembler))
                .map_err(|e| CheckpointError::misfit(sections.folder(), &e.to_string()))?;
        }
        let mut solver = analysed(loaded, model, &mut assembler, threads)?;
        if let Some(kept) = &kept {
            solver.expect_indefinite(kept.expects_indefinite);
        }
        phases.stop("analysis");
        let walk = StepControl::new(loaded, model);
        let outputs = Outputs {
            fields: Fields::new(model, &loaded.scene.output)?,
            row: Vec::new(),
        };
        let committed = State::new(model);
        let mut run = RunState {
            problem,
            assembler,
            solver,
            workspace: Workspace::new(model),
            phases,
            progress: Progress {
                warnings: model.warnings.clone(),
                ..Progress::default()
            },
            // A pair whose overclosure counts as touching touches from the start.
            touched: (model.pairs.iter())
                .map(|p| p.overclosure.is_some())
                .collect(),
            touching: vec![false; model.pairs.len()],
            watch: Watch::new(model),
            compliance: Compliance::new(model).map_err(|e| RunError::internal(&e))?,
            rule: PenaltyRule::new(model),
            peaks: Peaks::new(model),
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
            files: None,
            stages: Vec::new(),
        };
        match kept {
            None => run.begin(observer)?,
            Some(kept) => run.go_on(kept, observer)?,
        }
        Ok(run)
    }

    /// Starts at time 0.
    fn begin(&mut self, observer: &mut (dyn Observer + Send)) -> Result<(), RunError> {
        let never = AtomicBool::new(false);
        let (mut march, course) = self.march(Caller {
            observer,
            interrupt: &never,
        });
        for note in course.outputs.fields.notes() {
            march.warn(note);
        }
        let masters = &mut march.assembler.masters;
        commit::start(
            march.model,
            masters,
            &mut course.committed,
            (0.0, &|_| true),
        )
        .map_err(|e| RunError::internal(&e))?;
        resting::close(march.model, masters, &mut course.committed)
            .map_err(|e| RunError::internal(&e))?;
        (march
            .assembler
            .set_in_motion(march.solver, &course.committed))
        .map_err(|e| RunError::internal(&e))?;
        if march.model.dynamics.is_some() {
            let mut balance = vec![0.0; course.committed.u.len()];
            (march.assembler).balance(&course.committed.u, &mut balance);
            march.watch.start(march.assembler, &balance);
        }
        course.trial = course.committed.clone();
        march.gather(&mut course.outputs, &course.committed, 0.0)
    }

    /// Takes up a run where it was kept.
    fn go_on(&mut self, kept: Kept, observer: &mut (dyn Observer + Send)) -> Result<(), RunError> {
        let Kept {
            passed_over,
            committed,
            before,
            dt,
            habit,
            jump,
            progress,
            touched,
            touching,
            turned,
            watch,
            compliance,
            rule,
            peaks,
            travels,
            factorizations,
            largest_force,
            // The rest was given back where the pattern is analysed.
            assembler: AssemblerMemory { motion, .. },
            expects_indefinite: _,
            spent,
            files,
            stages,
        } = kept;
        self.files = Some(files);
        self.stages = stages;
        self.workspace.factorizations = factorizations;
        self.workspace.largest_force = largest_force;
        (self.progress, self.touched, self.touching) = (progress, touched, touching);
        (self.watch, self.compliance, self.peaks) = (watch, compliance, peaks);
        self.rule = rule;
        self.unseen.between.go_on(&travels);
        self.cost.earlier = spent;
        self.cost.earlier.resumed += 1;
        let course = &mut self.course;
        course.walk.stepping.set_size(dt);
        (course.walk.before, course.walk.habit) = (before, habit);
        course.walk.jump = jump;
        course.walk.turned = (0..turned.len()).filter(|b| turned[*b]).collect();
        self.assembler.go_on(motion, &committed.u);
        (course.trial, course.committed) = (committed.clone(), committed);
        let (step, time) = (self.progress.steps, self.progress.time);
        let never = AtomicBool::new(false);
        let (mut march, course) = self.march(Caller {
            observer,
            interrupt: &never,
        });
        if step > 0 {
            course.outputs.fields.went_on();
        }
        march.gather(&mut course.outputs, &course.committed, time)?;
        for text in passed_over {
            let text = format!("{text}; the checkpoint before it is taken");
            march.observer.event(&Event::Note { text });
        }
        let text = format!("continued after step {step} (time {})", number(time));
        march.observer.event(&Event::Note { text });
        Ok(())
    }

    /// The run going on, and where it is.
    pub fn march<'a>(&'a mut self, caller: Caller<'a>) -> (March<'a, 'm>, &'a mut Course) {
        let RunState {
            problem,
            assembler,
            solver,
            workspace,
            phases,
            progress,
            touched,
            touching,
            watch,
            compliance,
            rule,
            peaks,
            unseen,
            cost: _,
            course,
            files: _,
            stages: _,
        } = self;
        let march = March {
            scene: &problem.loaded.scene,
            model: &problem.model,
            assembler,
            solver: &mut **solver,
            workspace,
            observer: caller.observer,
            interrupt: caller.interrupt,
            phases,
            progress,
            failed: 0,
            touched,
            touching,
            watch,
            compliance,
            rule,
            replaceable: &problem.replaceable,
            exchangeable: problem.exchangeable,
            sides_may: problem.sides_may,
            unseen,
            patience: problem.patience,
            peaks,
        };
        (march, course)
    }
}

impl StepControl {
    /// That of a run, or a stage, which begins.
    pub(super) fn new(loaded: &LoadedScene, model: &Model) -> Self {
        let settings = &loaded.scene.solution;
        StepControl {
            stepping: Stepping::new(
                loaded.steps(),
                settings.end_time,
                &model.kinks,
                &settings.stops,
                (model.largest_steps.iter().map(|s| (s.span, s.size))).collect(),
            ),
            before: None,
            habit: Habit::default(),
            jump: None,
            given_up: None,
            turned: BTreeSet::new(),
        }
    }
}

/// The solver of a model, with the pattern of its system analysed.
///
/// # Errors
/// What has no room in memory.
pub(super) fn analysed(
    loaded: &LoadedScene,
    model: &Model,
    assembler: &mut Assembler,
    threads: usize,
) -> Result<Box<dyn LinearSolver + Send>, RunError> {
    let mut solver = solver(loaded, model.symmetric, threads);
    if let Some(pattern) = assembler.take_new_pattern() {
        let analysis = solver.analyze(&pattern);
        let factorizing = analysis.map_err(|e| memory::analysis(loaded, &e))?.threads;
        memory::packing(loaded, factorizing)?;
    }
    Ok(solver)
}

/// The solver that the scene asks for; on the processor an unsymmetric system has only one, which the model has checked.
fn solver(loaded: &LoadedScene, symmetric: bool, threads: usize) -> Box<dyn LinearSolver + Send> {
    use crate::scene::LinearSolver as Choice;
    use crate::system::linear::Mode;
    let options = |mode| SolverOptions {
        mode,
        threads,
        ..SolverOptions::default()
    };
    let mode = match &loaded.scene.solution.linear_solver {
        #[cfg(feature = "cudss")]
        Choice::Cudss => {
            use crate::system::linear::ForeignSolver;
            return Box::new(ForeignSolver::cudss(symmetric, options(Mode::Auto)));
        }
        #[cfg(feature = "mumps")]
        Choice::Mumps(settings) => {
            use crate::system::linear::ForeignSolver;
            let options = options(Mode::Auto);
            return Box::new(ForeignSolver::mumps(
                symmetric,
                options,
                mumps(loaded, settings),
            ));
        }
        _ if !symmetric => return Box::new(LuSolver::new(options(Mode::Auto))),
        Choice::Lu => return Box::new(LuSolver::new(options(Mode::Auto))),
        Choice::Auto => Mode::Auto,
        // The model has refused it.
        #[cfg(not(feature = "cudss"))]
        Choice::Cudss => Mode::Auto,
        #[cfg(not(feature = "mumps"))]
        Choice::Mumps(_) => Mode::Auto,
        Choice::Llt => Mode::Llt,
        Choice::Ldlt => Mode::Ldlt,
    };
    Box::new(DirectSolver::new(options(mode)))
}

/// The settings of MUMPS, with the folder that is meant.
#[cfg(feature = "mumps")]
fn mumps(
    loaded: &LoadedScene,
    settings: &crate::scene::Mumps,
) -> crate::system::linear::MumpsOptions {
    use crate::scene::OutOfCore;
    crate::system::linear::MumpsOptions {
        ordering: settings.ordering,
        out_of_core: match &settings.out_of_core {
            OutOfCore::Temporary(false) => None,
            OutOfCore::Temporary(true) => Some(std::env::temp_dir()),
            OutOfCore::Folder(folder) => Some(loaded.resolve(folder)),
        },
    }
}
