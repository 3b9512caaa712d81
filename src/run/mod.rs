//! A scene from file to results: what `covact run` and `covact check` do, without the printing.
mod augment;
mod averaged;
mod bearing;
mod check;
mod checkpoint;
mod claim;
mod commit;
mod compliance;
mod cost;
mod doubt;
mod error;
mod estimate;
mod fields;
mod friction_fields;
mod history;
mod march;
mod memory;
#[cfg(test)]
mod other_law;
mod passed;
mod peaks;
mod pieces;
mod plan;
mod progress;
mod remedy;
mod sound;
mod stabilized;
mod step;
pub mod watch;

pub use check::{
    BodyReport, CheckReport, LoadReport, PairReport, SupportReport, SurfaceReport, check,
};
pub use checkpoint::CheckpointError;
pub use claim::{ClaimError, FolderError, vacant};
pub use error::RunError;
pub use estimate::Estimate;
pub use plan::{PlanReport, plan};

use crate::assembly::Assembler;
use crate::machine;
use crate::machine::clock::Phases;
use crate::model;
use crate::output::{Accuracy, RunStatus, Summary, Versions};
use crate::plan::Plan;
use crate::scene::{LoadedScene, Scene};
use crate::solve::event::{Event, Observer};
use crate::system::linear::{DirectSolver, LinearSolver, LuSolver, SolverOptions};
use checkpoint::{Fingerprint, Found, Keeper};
use claim::{Claim, Manner};
use cost::{Cost, Spent};
use fields::Fields;
use march::{Kept, March};
use progress::Progress;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Choices that are the caller's, not the scene's.
#[derive(Debug, Clone, Copy, Default)]
pub struct RunOptions {
    /// Threads; 0 takes the scene's number, and where that is 0 too, what the machine has. No more are used than that.
    pub threads: usize,
    /// Go on with the run whose checkpoint is in the folder; one that has reached its end is left as it is.
    pub resume: bool,
    /// Replace a run that is in the folder: its files are removed, those of others never are. Without it, and without
    /// `resume`, such a folder is refused.
    pub force: bool,
}

impl RunOptions {
    fn manner(&self) -> Manner {
        match (self.resume, self.force) {
            (true, _) => Manner::Resume,
            (false, true) => Manner::Replace,
            (false, false) => Manner::Start,
        }
    }
}

/// Solves a scene and writes its results into the folder `out`. A run that does not reach its end returns its summary
/// with a status that says so: what was computed is kept.
///
/// # Errors
/// [`RunError`] where the scene or a file it names is wrong, a result cannot be written, the folder is in use or holds a
/// run already, or there is no run to continue.
pub fn run(
    scene: &LoadedScene,
    out: &Path,
    options: &RunOptions,
    observer: &mut (dyn Observer + Send),
    interrupt: &AtomicBool,
) -> Result<Summary, RunError> {
    let asked = match options.threads {
        0 => scene.scene.solution.threads as usize,
        n => n,
    };
    let (used, capped) = machine::threads(asked);
    if let Some(text) = capped {
        observer.event(&Event::Note { text });
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(used)
        .build()
        .map_err(|e| RunError::scene(scene, "/solution/threads", e.to_string()))?;
    let threads = pool.current_num_threads();
    pool.install(|| solve(scene, out, threads, options, observer, interrupt))
}

/// Checksum of a scene and of the files that it names, as [`Summary::scene`] tells it.
pub fn checksum(loaded: &LoadedScene) -> String {
    checkpoint::name(&Fingerprint::new(loaded))
}

fn solve(
    loaded: &LoadedScene,
    out: &Path,
    threads: usize,
    options: &RunOptions,
    observer: &mut (dyn Observer + Send),
    interrupt: &AtomicBool,
) -> Result<Summary, RunError> {
    let cost = Cost::start();
    let mut claim = Claim::new(out, options.manner())?;
    let fingerprint = Fingerprint::new(loaded);
    let found = match options.resume {
        true => Some(checkpoint::find(out, &fingerprint)?),
        false => None,
    };
    let sections = match found {
        Some(Found::Finished(summary)) => {
            let text = format!("the run in {} has reached its end already", out.display());
            observer.event(&Event::Note { text });
            observer.event(&Event::Finished {
                status: summary.status.name().to_owned(),
                wall_s: summary.wall_s,
            });
            return Ok(*summary);
        }
        Some(Found::Unfinished(sections)) => Some(sections),
        None => None,
    };
    let mut phases = Phases::new();
    phases.start("model");
    let model = model::build::build(loaded).map_err(|e| RunError::model(loaded, e))?;
    let plan = Plan::new(loaded, &model);
    phases.stop("model");
    observer.event(&Event::Model {
        dofs: model.unknowns(),
        contact_points: model.contact_points(),
        effects: plan.names(),
        notes: model.notes.clone(),
    });
    for text in &model.warnings {
        observer.event(&Event::Warning { text: text.clone() });
    }
    memory::flat_copies(loaded, &model)?;
    phases.start("analysis");
    let mut assembler =
        Assembler::new(&model, &model.dofs).map_err(|e| memory::pattern(loaded, &e))?;
    let kept = sections.map(|sections| Kept::read(&sections, &model));
    let kept = kept.transpose()?;
    if let Some(kept) = &kept {
        (assembler.restore(&kept.assembler))
            .map_err(|e| CheckpointError::misfit(out, &e.to_string()))?;
    }
    let mut solver = solver(&loaded.scene, model.symmetric, threads);
    if let Some(pattern) = assembler.take_new_pattern() {
        let analysis = solver.analyze(&pattern);
        let factorizing = analysis.map_err(|e| memory::analysis(loaded, &e))?.threads;
        memory::packing(loaded, factorizing)?;
    }
    if let Some(kept) = &kept {
        solver.expect_indefinite(kept.expects_indefinite);
    }
    phases.stop("analysis");
    let fields = Fields::new(&model, &loaded.scene.output)?;
    let parts = (loaded.scene.output.every > 0).then(|| fields.part_names(&model));
    let replaced = claim.enter(parts.as_ref())?;
    if let Some(reason) = &claim.unlocked {
        let text = format!(
            "{} cannot be locked ({reason}): nothing keeps another run from writing there",
            out.display()
        );
        observer.event(&Event::Note { text });
    }
    if replaced {
        let text = format!("the run in {} is replaced", out.display());
        observer.event(&Event::Note { text });
    }
    let scene = checkpoint::name(&fingerprint);
    let mut march = March::new(
        &loaded.scene,
        &model,
        &mut assembler,
        &mut *solver,
        observer,
        interrupt,
        phases,
        cost,
        Keeper::new(out, fingerprint),
    )?;
    let (status, reason, failure) = match march.run(out, fields, kept) {
        Ok(ending) => (ending.status, ending.reason, None),
        Err(e) => (RunStatus::Failed, Some(e.to_string()), Some(e)),
    };
    let Spent {
        wall_s,
        cpu_s,
        phases,
        peak_memory_mb,
        resumed,
    } = march.cost.spent(&march.phases);
    let Progress {
        warnings,
        iterations,
        accepted,
        counted: _,
        cuts,
        ping_pongs,
        steps,
        time,
        measured: _,
    } = march.progress;
    let pattern_rebuilds = march.assembler.rebuilds();
    let factorizations = march.workspace.factorizations.iter();
    let summary = Summary {
        status,
        reason,
        time,
        wall_s,
        cpu_s,
        phases,
        peak_memory_mb,
        threads,
        dofs: model.unknowns(),
        contact_points: model.contact_points(),
        newton_iterations: iterations,
        failed_iterations: iterations.saturating_sub(accepted),
        factorizations: factorizations
            .map(|(method, count)| (method.name().to_owned(), *count))
            .collect(),
        steps,
        cuts,
        ping_pongs,
        pattern_rebuilds,
        effects: plan.names(),
        plan: Some(plan.summary(march.assembler.ran())),
        accuracy: Accuracy {
            contacts: march.peaks.account(&model),
            ..march.compliance.account(&model)
        },
        warnings,
        resumed,
        scene,
        versions: Versions::default(),
    };
    let path = out.join("summary.json");
    let mut written = summary.write(&path);
    // A device that is nearly full, or allows small files only, may take the account alone: most of a summary is its plan.
    if written.is_err() {
        written = Summary {
            plan: None,
            ..summary.clone()
        }
        .write(&path);
    }
    // Where not even that could be written, an earlier run's summary must not pass for this one's.
    if written.is_err() && path.is_file() {
        let _ = std::fs::remove_file(&path);
    }
    if let Some(failure) = failure {
        return Err(failure);
    }
    written?;
    if matches!(status, RunStatus::Done | RunStatus::NoContact) {
        march.keeper.finish()?;
    }
    march.observer.event(&Event::Finished {
        status: status.name().to_owned(),
        wall_s: summary.wall_s,
    });
    Ok(summary)
}

/// The solver that the scene asks for; an unsymmetric system has only one, which the model has checked.
fn solver(scene: &Scene, symmetric: bool, threads: usize) -> Box<dyn LinearSolver> {
    use crate::scene::LinearSolver as Choice;
    use crate::system::linear::Mode;
    let options = |mode| SolverOptions {
        mode,
        threads,
        ..SolverOptions::default()
    };
    let mode = match scene.solution.linear_solver {
        _ if !symmetric => return Box::new(LuSolver::new(options(Mode::Auto))),
        Choice::Lu => return Box::new(LuSolver::new(options(Mode::Auto))),
        Choice::Auto => Mode::Auto,
        Choice::Llt => Mode::Llt,
        Choice::Ldlt => Mode::Ldlt,
    };
    Box::new(DirectSolver::new(options(mode)))
}
