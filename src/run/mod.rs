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
mod crest;
mod edge_fields;
mod error;
mod estimate;
mod exit;
mod fields;
mod flow_fields;
mod friction_fields;
mod habit;
mod history;
mod hold;
mod law_range;
mod linearity_check;
mod march;
mod memory;
mod motion_fields;
#[cfg(test)]
mod other_law;
mod peaks;
mod penalty_rule;
mod plan;
mod probes;
mod progress;
mod reaction_fields;
mod remedy;
mod resting;
mod resultants;
mod sheet_fields;
mod shell_stresses;
mod simulation;
mod sink;
mod stabilized;
mod step;
mod strain_fields;
mod stresses;
mod surface_cells;
mod traction_fields;
mod tunneling;
mod unseen;
mod validity;
pub(crate) mod watch;

pub use check::{
    BodyReport, CheckReport, LoadReport, PairReport, SetReport, SupportReport, SurfaceReport, check,
};
pub use checkpoint::CheckpointError;
#[doc(hidden)]
pub use checkpoint::resealed;
pub use claim::{ClaimError, FolderError, vacant};
pub use error::RunError;
pub use estimate::Estimate;
pub use exit::{Exit, exit_table};
pub use plan::{PlanReport, plan};
pub use simulation::{Force, NodalField, Options, ReadError, Simulation, Step, StepError};
pub use sink::{ResultsFolder, Sink};

use crate::output::Summary;
use crate::scene::LoadedScene;
use crate::solve::event::{Event, Observer};
use checkpoint::{Fingerprint, Found};
use claim::Entry;
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
///
/// ```
/// use covact::run::{RunOptions, run};
/// use covact::solve::event::Silent;
/// use std::sync::atomic::AtomicBool;
///
/// let mut scene = covact::scene::load("examples/scenes/ball_on_plate.json")?;
/// scene.scene.solution.end_time = 0.1;
/// let out = tempfile::tempdir()?;
/// let folder = out.path().join("out");
/// let summary = run(&scene, &folder, &RunOptions::default(), &mut Silent, &AtomicBool::new(false))?;
/// assert_eq!(summary.status.name(), "done");
/// // Every accepted step is a row of the table.
/// let table = covact::output::read_csv(&folder.join("history.csv"))?;
/// let force = table.column("force.ball.z").expect("the ball");
/// assert!(*force.last().expect("a step") < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run(
    scene: &LoadedScene,
    out: &Path,
    options: &RunOptions,
    observer: &mut (dyn Observer + Send),
    interrupt: &AtomicBool,
) -> Result<Summary, RunError> {
    let caller = Options {
        threads: options.threads,
        observer: Box::new(observer),
        interrupt,
    };
    match open(scene, out, options, caller)? {
        Opened::Finished(summary) => Ok(*summary),
        Opened::Going(mut simulation, mut folder) => simulation.run(&mut [&mut *folder]),
    }
}

/// What a folder holds for a run.
pub enum Opened<'o> {
    /// A run at its start, or where it was kept, with the folder that it goes on in.
    Going(Box<Simulation<'o>>, Box<ResultsFolder>),
    /// The run that was to be continued has reached its end already.
    Finished(Box<Summary>),
}

/// Makes a scene ready to run into the folder `out`, from its start or, where `options` say so, from the checkpoint that is
/// there. The threads are those of `caller` ([`RunOptions::threads`] is for [`run`]).
///
/// # Errors
/// As [`run`].
pub fn open<'o>(
    scene: &LoadedScene,
    out: &Path,
    options: &RunOptions,
    mut caller: Options<'o>,
) -> Result<Opened<'o>, RunError> {
    let entry = options.entry();
    let mut folder = ResultsFolder::open(out, entry)?;
    let mut sections = None;
    if entry == Entry::Resume {
        match folder.find(&Fingerprint::new(scene))? {
            Found::Unfinished(found) => sections = Some(found),
            Found::Finished(summary) => {
                let text = format!("the run in {} has reached its end already", out.display());
                caller.observer.event(&Event::Note { text });
                caller.observer.event(&Event::Finished {
                    status: summary.status.name().to_owned(),
                    wall_s: summary.wall_s,
                });
                return Ok(Opened::Finished(summary));
            }
        }
    }
    let mut simulation = Simulation::start(scene.clone(), sections.as_ref(), caller)?;
    folder.enter(&simulation)?;
    if sections.is_some() {
        simulation.set_earlier(folder.earlier());
    }
    Ok(Opened::Going(Box::new(simulation), Box::new(folder)))
}

/// Whether `folder` holds a run of this scene that was cut short and that [`RunOptions::resume`] goes on with.
pub fn is_unfinished(loaded: &LoadedScene, folder: &Path) -> bool {
    let found = checkpoint::find(folder, &Fingerprint::new(loaded));
    matches!(found, Ok(Found::Unfinished(_)))
}

/// Checksum of a scene and of the files that it names, as [`Summary::scene`] tells it.
pub fn checksum(loaded: &LoadedScene) -> String {
    checkpoint::name(&Fingerprint::new(loaded))
}
