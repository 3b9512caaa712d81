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
mod error;
mod estimate;
mod fields;
mod flow_fields;
mod friction_fields;
mod history;
mod hold;
mod linearity_check;
mod march;
mod memory;
#[cfg(test)]
mod other_law;
mod peaks;
mod penalty_rule;
mod plan;
mod probes;
mod progress;
mod reaction_fields;
mod remedy;
mod resultants;
mod stabilized;
mod step;
mod strain_fields;
mod stresses;
mod surface_cells;
mod traction_fields;
mod tunneling;
mod validity;
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
use crate::model::error::number;
use crate::output::{Accuracy, RunStatus, Summary, Versions, read_csv};
use crate::plan::Plan;
use crate::scene::{Element, LoadedScene, Scene, pointer};
use crate::solve::event::{Event, Observer};
use crate::system::linear::{DirectSolver, LinearSolver, LuSolver, SolverOptions};
use checkpoint::{Fingerprint, Found, Keeper};
use claim::{Claim, Entry};
use cost::{Cost, ResourceUse};
use fields::Fields;
use march::{Kept, March};
use progress::Progress;
use std::collections::BTreeMap;
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
    fn entry(&self) -> Entry {
        match (self.resume, self.force) {
            (true, _) => Entry::Resume,
            (false, true) => Entry::Replace,
            (false, false) => Entry::Start,
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
    pool.install(|| {
        let mut options = *options;
        let mut safe = match options.resume {
            true => variant_in(out, scene),
            false => None,
        };
        loop {
            let (loaded, changed) = match &safe {
                None => (scene, &[][..]),
                Some(Safe { loaded, changed }) => (loaded, &changed[..]),
            };
            let told = solve(
                loaded,
                out,
                threads,
                (&options, changed),
                observer,
                interrupt,
            )?;
            match safe_variant(scene, safe.as_ref(), &told) {
                Some(variant) => safe = Some(variant),
                None => return Ok(told.summary),
            }
            (options.resume, options.force) = (false, true);
        }
    })
}

/// A scene with other elements than the default ones, and what is told of the change.
struct Safe {
    loaded: LoadedScene,
    changed: Vec<String>,
}

/// What a run tells of itself.
struct Told {
    summary: Summary,
    /// Names of the bodies whose enhanced strains are what the run could not go on with.
    squeezed: Vec<String>,
}

/// The scene with displacement elements for the bodies whose default elements a run could not go on with: enhanced strains lose
/// their hold in strong compression, and steps accepted before may have suffered. Nothing where the scene names the
/// elements.
fn safe_variant(scene: &LoadedScene, before: Option<&Safe>, told: &Told) -> Option<Safe> {
    let when = format!("gave way at time {}", number(told.summary.time));
    let mut safe = None;
    for body in &told.squeezed {
        let before = safe.as_ref().or(before);
        safe = replaced(scene, before, body, &when).or(safe);
    }
    safe
}

/// The scene with displacement elements for a body, where it leaves the element to its default.
fn replaced(scene: &LoadedScene, before: Option<&Safe>, body: &str, when: &str) -> Option<Safe> {
    if names_element(scene, body) {
        return None;
    }
    let (mut loaded, mut changed) = match before {
        Some(Safe { loaded, changed }) => (loaded.clone(), changed.clone()),
        None => (scene.clone(), Vec::new()),
    };
    let element = &mut loaded.scene.bodies.get_mut(body)?.element;
    if *element != Element::H8 {
        return None;
    }
    *element = Element::H8Displacement;
    changed.push(format!(
        "body `{body}`: its default elements (`h8`) {when}, as they do in strong compression; the run was repeated with \
         `h8_displacement` for it, which is stiffer in bending: refine it where it bends, and name the `element` to have one of \
         them from the start"
    ));
    Some(Safe { loaded, changed })
}

/// Bodies of a scene up to which all choices of them are looked through.
const MANY: usize = 6;

/// The variant of the scene that a folder holds an unfinished run of, where it is one with other elements for some bodies.
fn variant_in(out: &Path, scene: &LoadedScene) -> Option<Safe> {
    let holds = |loaded: &LoadedScene| checkpoint::find(out, &Fingerprint::new(loaded)).is_ok();
    if holds(scene) {
        return None;
    }
    let bodies: Vec<&String> = scene.scene.bodies.keys().collect();
    // Of many bodies one of them, or all.
    let choices: Vec<Vec<bool>> = match bodies.len() {
        n @ ..=MANY => (1..1u32 << n)
            .map(|bits| (0..n).map(|k| bits >> k & 1 == 1).collect())
            .collect(),
        n => (0..=n)
            .map(|one| (0..n).map(|k| one == n || k == one).collect())
            .collect(),
    };
    let variants = choices.iter().filter_map(|chosen| {
        let chosen = bodies.iter().zip(chosen).filter(|(_, chosen)| **chosen);
        chosen.fold(None, |safe: Option<Safe>, (body, _)| {
            replaced(scene, safe.as_ref(), body, "gave way").or(safe)
        })
    });
    variants.into_iter().find(|safe| holds(&safe.loaded))
}

/// Whether a scene names the element of a body, rather than leaving it to its default.
fn names_element(scene: &LoadedScene, body: &str) -> bool {
    scene.has(&pointer(&["bodies", body, "element"]))
}

/// Checksum of a scene and of the files that it names, as [`Summary::scene`] tells it.
pub fn checksum(loaded: &LoadedScene) -> String {
    checkpoint::name(&Fingerprint::new(loaded))
}

fn solve(
    loaded: &LoadedScene,
    out: &Path,
    threads: usize,
    (options, changed): (&RunOptions, &[String]),
    observer: &mut (dyn Observer + Send),
    interrupt: &AtomicBool,
) -> Result<Told, RunError> {
    let cost = Cost::start();
    let mut claim = Claim::new(out, options.entry())?;
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
            return Ok(Told {
                summary: *summary,
                squeezed: Vec::new(),
            });
        }
        Some(Found::Unfinished(sections)) => Some(sections),
        None => None,
    };
    let mut phases = Phases::new();
    phases.start("model");
    let mut model = model::build::build(loaded).map_err(|e| RunError::model(loaded, e))?;
    model.warnings.extend_from_slice(changed);
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
    march.replaceable = (loaded.scene.bodies.iter())
        .filter(|(name, body)| body.element == Element::H8 && !names_element(loaded, name))
        .map(|(name, _)| name.clone())
        .collect();
    let (status, reason, squeezed, failure) = match march.run(out, fields, kept) {
        Ok(ending) => (ending.status, ending.reason, ending.squeezed, None),
        Err(e) => (RunStatus::Failed, Some(e.to_string()), Vec::new(), Some(e)),
    };
    let ResourceUse {
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
    // Nobody waits for a table that cannot be read back: the summary is then without it.
    let probed = match model.probes.is_empty() {
        true => BTreeMap::new(),
        false => read_csv(&out.join("history.csv"))
            .map(|table| probes::summary(&model, &table))
            .unwrap_or_default(),
    };
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
            contacts: march.peaks.account(
                &model,
                [&march.assembler.penalties, &march.assembler.ratios],
            ),
            ..march.compliance.account(&model)
        },
        probes: probed,
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
    Ok(Told {
        summary,
        squeezed: (squeezed.iter())
            .map(|&body| model.bodies[body].name.clone())
            .collect(),
    })
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
