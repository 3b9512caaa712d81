//! A scene from file to results: what `covact run` and `covact check` do, without the printing.
mod augment;
mod averaged;
mod check;
mod commit;
mod error;
mod fields;
mod friction_fields;
mod history;
mod march;
mod memory;
mod passed;
mod pieces;
mod progress;
mod sound;
mod stabilized;
mod step;
pub mod watch;

pub use check::{
    BodyReport, CheckReport, LoadReport, PairReport, SupportReport, SurfaceReport, check,
};
pub use error::RunError;

use crate::assembly::Assembler;
use crate::model;
use crate::output::{Phases, RunStatus, Summary, Versions, cpu_seconds, peak_memory_mb};
use crate::scene::{LoadedScene, Scene};
use crate::solve::event::{Event, Observer};
use crate::solve::linear::{DirectSolver, LinearSolver, LuSolver, SolverOptions};
use march::March;
use progress::Progress;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Choices that are the caller's, not the scene's.
#[derive(Debug, Clone, Copy, Default)]
pub struct RunOptions {
    /// Threads; 0 takes the scene's number, and where that is 0 too, what the machine has.
    pub threads: usize,
}

/// Solves a scene and writes its results into the folder `out`. A run that does not reach its end returns its summary
/// with a status that says so: what was computed is kept.
///
/// # Errors
/// [`RunError`] where the scene or a file it names is wrong, or a result cannot be written.
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
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(asked)
        .build()
        .map_err(|e| RunError::scene(scene, "/solution/threads", e.to_string()))?;
    let threads = pool.current_num_threads();
    pool.install(|| solve(scene, out, threads, observer, interrupt))
}

fn solve(
    loaded: &LoadedScene,
    out: &Path,
    threads: usize,
    observer: &mut (dyn Observer + Send),
    interrupt: &AtomicBool,
) -> Result<Summary, RunError> {
    let (wall, cpu) = (Instant::now(), cpu_seconds());
    let mut phases = Phases::new();
    phases.start("model");
    let model = model::build::build(loaded).map_err(|e| RunError::model(loaded, e))?;
    phases.stop("model");
    observer.event(&Event::Model {
        dofs: model.unknowns(),
        contact_points: model.contact_points(),
        effects: model.effects.clone(),
        notes: model.notes.clone(),
    });
    for text in &model.warnings {
        observer.event(&Event::Warning { text: text.clone() });
    }
    memory::flat_copies(loaded, &model)?;
    phases.start("analysis");
    let mut assembler =
        Assembler::new(&model, &model.dofs).map_err(|e| memory::pattern(loaded, &e))?;
    let mut solver = solver(&loaded.scene, model.symmetric, threads);
    if let Some(pattern) = assembler.take_new_pattern() {
        solver
            .analyze(&pattern)
            .map_err(|e| memory::analysis(loaded, &e))?;
    }
    phases.stop("analysis");
    let mut march = March::new(
        &loaded.scene,
        &model,
        &mut assembler,
        &mut *solver,
        observer,
        interrupt,
        phases,
    );
    let (status, reason, failure) = match march.run(out) {
        Ok(ending) => (ending.status, ending.reason, None),
        Err(e) => (RunStatus::Failed, Some(e.to_string()), Some(e)),
    };
    let Progress {
        warnings,
        iterations,
        cuts,
        ping_pongs,
        steps,
        time,
    } = march.progress;
    let phases = march.phases;
    let pattern_rebuilds = march.assembler.rebuilds();
    let factorizations = march.workspace.factorizations.iter();
    let summary = Summary {
        status,
        reason,
        time,
        wall_s: wall.elapsed().as_secs_f64(),
        cpu_s: cpu_seconds().zip(cpu).map(|(now, then)| now - then),
        phases: phases.seconds(),
        peak_memory_mb: peak_memory_mb(),
        threads,
        dofs: model.unknowns(),
        contact_points: model.contact_points(),
        newton_iterations: iterations,
        factorizations: factorizations
            .map(|(method, count)| (method.name().to_owned(), *count))
            .collect(),
        steps,
        cuts,
        ping_pongs,
        pattern_rebuilds,
        effects: model.effects.clone(),
        warnings,
        versions: Versions::default(),
    };
    let path = out.join("summary.json");
    let written = summary.write(&path);
    // Where not even that could be written, an earlier run's summary must not pass for this one's.
    if written.is_err() && path.is_file() {
        let _ = std::fs::remove_file(&path);
    }
    if let Some(failure) = failure {
        return Err(failure);
    }
    written?;
    march.observer.event(&Event::Finished {
        status: status.name().to_owned(),
        wall_s: summary.wall_s,
    });
    Ok(summary)
}

/// The solver that the scene asks for; an unsymmetric system has only one, which the model has checked.
fn solver(scene: &Scene, symmetric: bool, threads: usize) -> Box<dyn LinearSolver> {
    use crate::scene::LinearSolver as Choice;
    use crate::solve::linear::Mode;
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
