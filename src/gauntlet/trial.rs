//! The bench a case works on: runs scenes, collects checks.
use super::{Check, Verdict};
use crate::output::{RunStatus, Summary, Table, read_csv};
use crate::run::{self, RunError, RunOptions};
use crate::scene::{self, LoadedScene};
use crate::solve::event::{Event, Observer};
use covact_geometry::NurbsPatch;
use covact_geometry::io::{CadFile, LengthUnit, write_json};
use serde_json::Value;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use tempfile::TempDir;

/// Why a case could not go on, in words.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct CaseError(pub(super) String);

impl CaseError {
    /// With the reason.
    pub fn new(text: impl Into<String>) -> Self {
        CaseError(text.into())
    }
}

/// A case under way.
pub struct Trial {
    /// Threads of the scenes that do not set their own number.
    threads: u32,
    checks: Vec<Check>,
    iterations: u64,
    allowed: u64,
    /// Where CAD and mesh files of the scenes lie.
    folder: TempDir,
}

/// A run of a scene.
pub struct Outcome {
    /// The summary of the run.
    pub summary: Summary,
    /// The columns of `history.csv`.
    pub history: Table,
    /// Events of the run, in their order.
    pub events: Vec<Event>,
    /// Holds the results.
    pub folder: TempDir,
}

#[derive(Default)]
struct Recorder(Vec<Event>);

impl Observer for Recorder {
    fn event(&mut self, event: &Event) {
        self.0.push(event.clone());
    }
}

/// Stops a run after some steps.
struct Stopper<'a> {
    steps: u32,
    stop: &'a AtomicBool,
}

impl Observer for Stopper<'_> {
    fn event(&mut self, event: &Event) {
        if matches!(event, Event::StepAccepted { step, .. } if *step >= self.steps) {
            self.stop.store(true, Ordering::Relaxed);
        }
    }
}

fn temporary() -> Result<TempDir, CaseError> {
    tempfile::tempdir().map_err(|e| CaseError(format!("no temporary folder: {e}")))
}

impl Trial {
    pub(super) fn new(threads: u32) -> Result<Self, CaseError> {
        Ok(Trial {
            threads,
            checks: Vec::new(),
            iterations: 0,
            allowed: u64::MAX,
            folder: temporary()?,
        })
    }

    pub(super) fn verdict(self, broken: Option<CaseError>, seconds: f64) -> Verdict {
        Verdict {
            checks: self.checks,
            iterations: self.iterations,
            allowed: self.allowed,
            seconds,
            broken: broken.map(|b| b.to_string()),
        }
    }

    /// Folder that paths in scenes are relative to.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Writes patches as a CAD file in millimetres into the folder; its name, for `surfaces.X.cad.file`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn cad(&self, name: &str, patches: Vec<NurbsPatch>) -> Result<String, CaseError> {
        let unit = LengthUnit {
            name: "mm".into(),
            to_metre: Some(1e-3),
        };
        let file = format!("{name}.json");
        let text = write_json(&CadFile::of(patches, unit)).map_err(|e| CaseError(e.to_string()))?;
        std::fs::write(self.folder().join(&file), text).map_err(|e| CaseError(e.to_string()))?;
        Ok(file)
    }

    /// Runs a scene, however it ends; its iterations count.
    ///
    /// # Errors
    /// The scene is refused, or its results cannot be written.
    pub fn solve(&mut self, scene: &Value) -> Result<Outcome, CaseError> {
        self.run(scene)?
            .map_err(|e| CaseError(format!("the scene is refused: {e}")))
    }

    /// Runs a scene that must reach its end, in contact.
    ///
    /// # Errors
    /// It does not.
    pub fn done(&mut self, scene: &Value) -> Result<Outcome, CaseError> {
        Self::ended(self.solve(scene)?)
    }

    /// That a run has reached its end.
    fn ended(outcome: Outcome) -> Result<Outcome, CaseError> {
        if outcome.summary.status != RunStatus::Done {
            let reason = outcome.summary.reason.unwrap_or_default();
            let status = outcome.summary.status.name();
            return Err(CaseError(format!("the run ended as {status}: {reason}")));
        }
        Ok(outcome)
    }

    /// Runs a scene that must be refused; the message with its remedy.
    ///
    /// # Errors
    /// It is not.
    pub fn refused(&mut self, scene: &Value) -> Result<String, CaseError> {
        match self.run(scene)? {
            Err(RunError::Scene { message, help, .. }) => {
                Ok([message, help.unwrap_or_default()].join(" "))
            }
            Err(e) => Err(CaseError(e.to_string())),
            Ok(outcome) => Err(CaseError(format!(
                "the scene is not refused, but ended as {}",
                outcome.summary.status.name()
            ))),
        }
    }

    /// Runs a scene that must reach its end, stopped after this many steps and continued from what was kept.
    ///
    /// # Errors
    /// It does not reach its end, or is not stopped before.
    pub fn continued(&mut self, scene: &Value, steps: u32) -> Result<Outcome, CaseError> {
        let loaded = self.load(scene)?;
        let folder = temporary()?;
        let stop = AtomicBool::new(false);
        let mut stopper = Stopper { steps, stop: &stop };
        let first = run::run(
            &loaded,
            folder.path(),
            &RunOptions::default(),
            &mut stopper,
            &stop,
        );
        let first = first.map_err(|e| CaseError(e.to_string()))?;
        if first.status != RunStatus::Interrupted {
            return Err(CaseError::new("the run was not stopped"));
        }
        let options = RunOptions {
            resume: true,
            ..RunOptions::default()
        };
        let outcome = self.enter(&loaded, folder, &options)?;
        Self::ended(outcome.map_err(|e| CaseError(e.to_string()))?)
    }

    /// Reads and checks a scene.
    fn load(&self, scene: &Value) -> Result<LoadedScene, CaseError> {
        let mut scene = scene.clone();
        if scene["solution"]["threads"].is_null() {
            scene["solution"]["threads"] = self.threads.into();
        }
        let text = scene.to_string();
        let mut loaded =
            scene::parse(&text, "scene.json").map_err(|e| CaseError(format!("the scene: {e}")))?;
        loaded.dir = self.folder().to_path_buf();
        let problems = scene::check(&loaded);
        if !problems.is_empty() {
            let error = loaded.error(problems);
            return Err(CaseError(format!("the scene: {error}")));
        }
        Ok(loaded)
    }

    /// Reads, checks and runs a scene as `covact run` does.
    fn run(&mut self, scene: &Value) -> Result<Result<Outcome, RunError>, CaseError> {
        let loaded = self.load(scene)?;
        self.enter(&loaded, temporary()?, &RunOptions::default())
    }

    /// Runs a scene into a folder.
    fn enter(
        &mut self,
        loaded: &LoadedScene,
        folder: TempDir,
        options: &RunOptions,
    ) -> Result<Result<Outcome, RunError>, CaseError> {
        let mut recorder = Recorder::default();
        let never = AtomicBool::new(false);
        let summary = match run::run(loaded, folder.path(), options, &mut recorder, &never) {
            Ok(summary) => summary,
            Err(error) => return Ok(Err(error)),
        };
        self.iterations += summary.newton_iterations;
        let history =
            read_csv(&folder.path().join("history.csv")).map_err(|e| CaseError(e.to_string()))?;
        Ok(Ok(Outcome {
            summary,
            history,
            events: recorder.0,
            folder,
        }))
    }

    /// The runs of the case may take this many Newton iterations together, those of failed attempts included.
    pub fn iterations(&mut self, at_most: u64) {
        self.allowed = at_most;
    }

    /// A number that must not be larger in size than `limit`.
    pub fn within(&mut self, what: impl Into<String>, value: f64, limit: f64) {
        self.checks.push(Check {
            what: what.into(),
            value: value.abs(),
            limit,
        });
    }

    /// A number that must be `right` up to `tolerance`, relative to `right`.
    pub fn equal(&mut self, what: impl Into<String>, value: f64, right: f64, tolerance: f64) {
        // Against nothing no relative difference is told: that is a fault of the case.
        self.within(what, (value - right) / right.abs(), tolerance);
    }

    /// A statement that must hold.
    pub fn holds(&mut self, what: impl Into<String>, is: bool) {
        self.within(what, f64::from(u8::from(!is)), 0.0);
    }

    /// A message that must name each of `words`.
    pub fn says(&mut self, message: &str, words: &[&str]) {
        let missing: Vec<&str> = (words.iter())
            .filter(|w| !message.contains(**w))
            .copied()
            .collect();
        let what = match missing.is_empty() {
            true => format!("the message names `{}`", words.join("`, `")),
            false => format!("`{}` missing in: {message}", missing.join("`, `")),
        };
        self.within(what, missing.len() as f64, 0.0);
    }
}

impl Outcome {
    /// A column of the history.
    ///
    /// # Errors
    /// There is none of this name.
    pub fn column(&self, name: &str) -> Result<Vec<f64>, CaseError> {
        let found = self.history.column(name);
        found.ok_or_else(|| CaseError(format!("the history has no column `{name}`")))
    }

    /// The last value of a column.
    ///
    /// # Errors
    /// There is none of this name, or no step.
    pub fn last(&self, name: &str) -> Result<f64, CaseError> {
        let found = self.column(name)?.last().copied();
        found.ok_or_else(|| CaseError::new("no step was accepted"))
    }

    /// Value of a column at the step that ends at `time`.
    ///
    /// # Errors
    /// There is no such column or step.
    pub fn at(&self, name: &str, time: f64) -> Result<f64, CaseError> {
        let times = self.column("time")?;
        let row = times.iter().position(|t| (t - time).abs() < 1e-9);
        let row = row.ok_or_else(|| CaseError(format!("no step ends at {time}")))?;
        Ok(self.column(name)?[row])
    }

    /// Warnings that hold `words`.
    pub fn warnings(&self, words: &str) -> Vec<&str> {
        let all = self.summary.warnings.iter().map(String::as_str);
        all.filter(|w| w.contains(words)).collect()
    }

    /// Why the run ended early; empty where it did not.
    pub fn reason(&self) -> &str {
        self.summary.reason.as_deref().unwrap_or_default()
    }
}
