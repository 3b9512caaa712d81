//! A run in memory: stepped from outside or run through, with its results at hand and no file touched.
mod again;
mod changes;
mod elements;
mod joined;
mod read;
mod smooth;
mod stages;
mod stepping;
mod substitute;
mod unseen_master;
mod variant;

pub use read::{Force, NodalField, ReadError};

use super::RunError;
use super::checkpoint::{self, Fingerprint, Sections};
use super::cost::Cost;
use super::march::{Caller, Ending, KeptFiles, Patience, Problem, RunState, take_variant};
use super::probes;
use crate::machine;
use crate::machine::clock::Phases;
use crate::model::stages::StageStart;
use crate::model::{self, Model, PairModel};
use crate::output::{RunStatus, Summary, Table};
use crate::plan::Plan;
use crate::run::unseen::MaySee;
use crate::scene::{self, Contact, Element, LoadedScene};
use crate::solve::event::{Event, Observer, Silent};
use changes::Changes;
use joined::with_joined;
use serde::{Deserialize, Serialize};
use smooth::smooth_pairs;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use unseen_master::with_seen_masters;
use variant::{Safe, edges_may, names_element, points_may, with_exchanged, with_sides};

/// Nobody interrupts.
static NEVER: AtomicBool = AtomicBool::new(false);

self_cell::self_cell!(
    /// A problem with the run that borrows it.
    struct Running {
        owner: Box<Problem>,
        #[covariant]
        dependent: RunState,
    }
);

/// Choices of the caller of a simulation.
pub struct Options<'o> {
    /// Threads; 0 takes the scene's number, and where that is 0 too, what the machine has. No more are used than that.
    pub threads: usize,
    /// Receives the events of the run; by default nobody.
    pub observer: Box<dyn Observer + Send + 'o>,
    /// Ends the run when it becomes true, at the latest after one iteration of Newton's method; by default never.
    pub interrupt: &'o AtomicBool,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Options {
            threads: 0,
            observer: Box::new(Silent),
            interrupt: &NEVER,
        }
    }
}

/// An accepted step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// Number of the step, from 1.
    pub number: u32,
    /// Time at its end.
    pub time: f64,
    /// Its size.
    pub dt: f64,
    /// Newton iterations of the attempt that was accepted.
    pub iterations: u32,
    /// How many times the step was cut before.
    pub cuts: u32,
    /// Which run it belongs to: 1, or more where the run began again with other points or elements ([`Simulation::step`]).
    pub attempt: u32,
}

/// Why there is no further step.
#[derive(Debug, thiserror::Error)]
pub enum StepError {
    /// No equilibrium was found, even with the smallest step.
    #[error("{reason}")]
    NotConverged {
        /// What went wrong, in words.
        reason: String,
    },
    /// [`Options::interrupt`] was set. Once it is reset, the next step goes on.
    #[error("interrupted")]
    Interrupted,
    /// Something else went wrong.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// Whether rims of rigid surfaces have become slaves by themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Rims {
    /// They have not.
    Out,
    /// In a run that stands for one that was given up while it might have gone on.
    Instead,
    /// What the run is repeated with next is no question of theirs.
    Settled,
    /// The run that came farthest is followed to its end: nothing is left to repeat it with.
    Last,
}

/// A run of a scene: it starts at time 0 and goes on a step at a time ([`Self::step`]) or to its end ([`Self::run`]).
/// Whatever it computes is read in memory; files are written by [sinks](super::Sink) alone. `'o` is the life of its observer.
pub struct Simulation<'o> {
    /// The scene as it was given.
    scene: LoadedScene,
    /// The scene in its place, once elements had to be replaced.
    safe: Option<Safe>,
    rims: Rims,
    running: Running,
    pool: Arc<rayon::ThreadPool>,
    options: Options<'o>,
    fingerprint: Fingerprint,
    history: Table,
    /// The history is that of the whole run.
    whole: bool,
    ended: Option<Ending>,
    /// What there is to say at the end has been said.
    concluded: bool,
    /// The sinks have been told where the run begins.
    begun: bool,
    /// The account that the sinks were closed with.
    closed: Option<Summary>,
    attempt: u32,
    /// A stage was begun that the scene did not have.
    steered: bool,
}

impl<'o> Simulation<'o> {
    /// Builds the model of a scene, at time 0.
    ///
    /// # Errors
    /// [`RunError::Scene`] with what is wrong with the scene, or what it has no memory for.
    ///
    /// ```
    /// use covact::run::{Options, Simulation};
    /// let scene = covact::scene::load("examples/scenes/ball_on_plate.json")?;
    /// let mut simulation = Simulation::new(scene, Options::default())?;
    /// let first = simulation.step()?.expect("the run has a step");
    /// assert_eq!(first.number, 1);
    /// assert!(simulation.force("ball")?.force.z < 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(scene: LoadedScene, options: Options<'o>) -> Result<Self, RunError> {
        RunError::of(scene::check(&scene))?;
        Self::start(scene, None, options)
    }

    /// [`Self::new`], or from a checkpoint.
    pub(super) fn start(
        scene: LoadedScene,
        sections: Option<&Sections>,
        mut options: Options<'o>,
    ) -> Result<Self, RunError> {
        let asked = match options.threads {
            0 => scene.scene.solution.threads as usize,
            n => n,
        };
        let (used, capped) = machine::threads(asked);
        if let Some(text) = capped {
            options.observer.event(&Event::Note { text });
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(used)
            .build()
            .map_err(|e| RunError::scene(&scene, "/solution/threads", e.to_string()))?;
        let observer = &mut *options.observer;
        let (mut safe, rims) = match sections {
            Some(sections) => Changes::read(sections, &scene)?,
            None => (pool.install(|| with_joined(&scene)), Rims::Out),
        };
        let mut begin = |safe: Option<&Safe>| {
            pool.install(|| running(&scene, safe, sections, rims, &mut *observer))
        };
        let mut running = begin(safe.as_ref())?;
        let model = &running.borrow_owner().model;
        let seen = with_seen_masters(&scene, safe.as_ref(), model).filter(|_| sections.is_none());
        if let Some(seen) = seen {
            running = begin(Some(&seen))?;
            safe = Some(seen);
        }
        let run = running.borrow_dependent();
        let history = Table {
            columns: run.columns(),
            rows: Vec::new(),
        };
        Ok(Simulation {
            whole: sections.is_none(),
            fingerprint: Fingerprint::new(&scene),
            scene,
            safe,
            rims,
            running,
            pool: Arc::new(pool),
            options,
            history,
            ended: None,
            concluded: false,
            begun: false,
            closed: None,
            attempt: 1,
            steered: false,
        })
    }

    /// Does some work as a phase of the run.
    fn timed<T>(&mut self, phase: &'static str, work: impl FnOnce(&Self) -> T) -> T {
        (self.running).with_dependent_mut(|_, run| run.phases.start(phase));
        let done = work(self);
        (self.running).with_dependent_mut(|_, run| run.phases.stop(phase));
        done
    }

    fn fail(&mut self, error: &RunError) {
        self.ended = Some(Ending::new(RunStatus::Failed, Some(error.to_string())));
    }

    /// Tells once what is known when a run has ended.
    fn conclude(&mut self) {
        // What is repeated has nothing to say of the answer.
        let unseen = |e: &Ending| e.on_rims || !e.between.is_empty() || !e.slid.is_empty();
        let settled = matches!(self.rims, Rims::Settled | Rims::Last);
        if !settled && self.ended.as_ref().is_some_and(unseen) {
            return;
        }
        if std::mem::replace(&mut self.concluded, true) {
            return;
        }
        let caller = Caller {
            observer: &mut *self.options.observer,
            interrupt: self.options.interrupt,
        };
        (self.running).with_dependent_mut(|_, run| {
            let (mut march, course) = run.march(caller);
            march.conclude(&course.committed);
        });
    }

    /// How the run went so far. Before its end the status is [`RunStatus::Interrupted`].
    pub fn summary(&self) -> Summary {
        let (status, reason) = match &self.ended {
            Some(ending) => (ending.status, ending.reason.clone()),
            None => (RunStatus::Interrupted, None),
        };
        let run = self.running.borrow_dependent();
        let threads = self.pool.current_num_threads();
        let probed = self.whole && !self.model().probes.is_empty();
        Summary {
            probes: match probed {
                true => probes::summary(self.model(), &self.history),
                false => Default::default(),
            },
            scene: checkpoint::name(&self.fingerprint),
            ..run.summary(threads, status, reason)
        }
    }

    /// Takes the rows of the history before the checkpoint that the run went on from.
    pub(super) fn set_earlier(&mut self, table: Option<Table>) {
        let step = self.history.columns.iter().position(|c| c == "step");
        if let (Some(mut earlier), Some(step)) = (table, step)
            && earlier.columns == self.history.columns
        {
            let last = f64::from(self.steps());
            // Later ones are of steps that the run does anew.
            earlier.rows.retain(|row| row[step] <= last);
            (self.history, self.whole) = (earlier, true);
        }
    }

    pub(super) fn run_state(&self) -> &RunState<'_> {
        self.running.borrow_dependent()
    }

    pub(super) fn fingerprint(&self) -> &Fingerprint {
        &self.fingerprint
    }

    /// The files of the checkpoint that the run went on from.
    pub(super) fn kept_files(&self) -> Option<&KeptFiles> {
        self.run_state().files.as_ref()
    }

    /// The scene that is solved: as it was given, or with the elements that replaced others.
    pub fn scene(&self) -> &LoadedScene {
        &self.running.borrow_owner().loaded
    }

    /// The model of the scene.
    pub fn model(&self) -> &Model {
        &self.running.borrow_owner().model
    }

    /// How the run ended; `None` while it goes on.
    pub fn status(&self) -> Option<RunStatus> {
        Some(self.ended.as_ref()?.status)
    }

    /// Whether the end time has been reached.
    pub fn done(&self) -> bool {
        matches!(self.status(), Some(RunStatus::Done | RunStatus::NoContact))
    }
}

/// The model of a scene with its run. One that stands for another is given up where steps are cut again
/// and again.
fn running(
    scene: &LoadedScene,
    safe: Option<&Safe>,
    sections: Option<&Sections>,
    rims: Rims,
    observer: &mut (dyn Observer + Send),
) -> Result<Running, RunError> {
    let cost = Cost::start();
    let (loaded, changed, notes) = match safe {
        None => (scene, &[][..], &[][..]),
        Some(safe) => (&safe.loaded, &safe.changed[..], &safe.notes[..]),
    };
    let mut phases = Phases::new();
    phases.start("model");
    // A run that goes on does so in the stage where it was.
    let stage = match sections {
        Some(sections) => sections.read_first("variant", |from| Ok(take_variant(from)?.1.0))?,
        None => StageStart::default(),
    };
    let mut model = model::build::build_stage(loaded, stage.clone(), None)
        .map_err(|e| RunError::model(loaded, e))?;
    model.warnings.extend_from_slice(changed);
    model.notes.extend_from_slice(notes);
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
    let problem = Box::new(problem(scene, (loaded, safe), (model, plan, stage), rims));
    let threads = rayon::current_num_threads();
    Running::try_new(problem, |problem| {
        RunState::new(problem, (phases, cost), threads, sections, observer)
    })
}

/// What a run of `loaded`, the scene as given or in another form, solves, and what it may be repeated with.
fn problem(
    scene: &LoadedScene,
    (loaded, safe): (&LoadedScene, Option<&Safe>),
    (model, plan, stage): (Model, Plan, StageStart),
    rims: Rims,
) -> Problem {
    let kept = safe.map_or(&[][..], |safe| &safe.kept);
    let last = rims == Rims::Last;
    let replaceable = (loaded.scene.bodies.iter())
        .filter(|_| !last)
        .filter(|(name, body)| body.element == Element::H8 && !names_element(loaded, name))
        .filter(|(name, _)| !kept.contains(name))
        .map(|(name, _)| name.clone())
        .collect();
    let may = |may: fn(&LoadedScene, &Contact) -> bool| -> Vec<usize> {
        let of = |p: &PairModel| loaded.scene.contacts.get(&p.name);
        let pairs = model.pairs.iter().enumerate();
        pairs
            .filter(|(_, p)| of(p).is_some_and(|contact| may(loaded, contact)))
            .map(|(i, _)| i)
            .collect()
    };
    let may_see = MaySee {
        edges: match last {
            true => Vec::new(),
            false => may(edges_may),
        },
        points: match rims {
            Rims::Settled | Rims::Last => Vec::new(),
            _ => may(points_may),
        },
        smooth: match last {
            true => Vec::new(),
            false => smooth_pairs(loaded, &model, &stage),
        },
    };
    let block = |name: &str| again::is_block(&model.bodies, name);
    let sides_may = with_sides(loaded, None, None, &block).is_some();
    Problem {
        loaded: loaded.clone(),
        model,
        plan,
        replaceable,
        exchangeable: !last && with_exchanged(loaded, None, None, &|_| false).is_some(),
        sides_may: !last && sides_may,
        may_see,
        patience: match (rims, kept) {
            (Rims::Instead, _) => Patience::Short,
            (Rims::Last, _) | (_, []) => Patience::Full,
            _ => Patience::Long,
        },
        changes: Changes::of(scene, safe, rims).text(),
    }
}
