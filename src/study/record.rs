//! What a study found: all that tables and pictures are made of.
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the format of `study.json`.
pub const RECORD_FORMAT: u32 = 1;

/// `study.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version of the format.
    pub format: u32,
    /// Version of this program.
    pub covact: String,
    /// Title of the study.
    pub title: String,
    /// What the study asks.
    pub question: String,
    /// Scene, by file name.
    pub scene: String,
    /// The machine that did the runs.
    pub machine: Machine,
    /// How often every run was done, on how many threads and for how long at most.
    pub timing: super::file::Timing,
    /// Names of the choices, in the order of the study.
    pub choices: Vec<String>,
    /// What was measured, in the order of the study.
    pub quantities: Vec<QuantityRecord>,
    /// Relative errors that the report says the cost of.
    pub targets: Vec<f64>,
    /// In the order of the study; those of references last.
    pub runs: Vec<RunRecord>,
    /// What the user should know, in words.
    pub warnings: Vec<String>,
}

/// Where the runs were done.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor, where the system tells.
    pub processor: String,
    /// Cores that this process may use.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
}

/// A quantity and what it was compared with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuantityRecord {
    /// Name of the quantity.
    pub name: String,
    /// Its unit, for axes.
    pub unit: String,
    /// What is measured, in words, e.g. "`surface.ball.force.z` at the end".
    pub measure: String,
    /// Values are curves.
    pub curve: bool,
    /// Values are relative swings: less is better, without any reference.
    pub swing: bool,
    /// What it was compared with; none: its value alone is shown.
    pub reference: Option<ReferenceRecord>,
}

/// What a quantity was compared with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceRecord {
    /// In words: source, or which run.
    pub source: String,
    /// None for curves and fields.
    pub value: Option<f64>,
    /// The curve: points of the independent variable and the value.
    pub curve: Option<Vec<[f64; 2]>>,
    /// Estimate of the reference's own error, relative as those of the runs are; zero for closed forms, none where it
    /// cannot be estimated.
    pub error: Option<f64>,
    /// Order of convergence it was estimated with.
    pub order: Option<f64>,
    /// Order and estimate are observed in three runs, not assumed.
    pub observed: bool,
}

/// A run of the study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Name of its folder.
    pub id: String,
    /// By name of the choice; a choice that the run's grid does not have is missing.
    pub choices: BTreeMap<String, Label>,
    /// Name of the reference that this run is the end of, or a coarser run for.
    pub reference: Option<String>,
    /// How the run ended.
    pub ending: Ending,
    /// Elapsed seconds, process and all.
    pub wall: Option<Spread>,
    /// Processor seconds of all threads.
    pub cpu: Option<Spread>,
    /// Elapsed seconds by phase, medians.
    pub phases: BTreeMap<String, f64>,
    /// Largest resident memory (10^6 bytes).
    pub peak_memory_mb: Option<f64>,
    /// Unknowns.
    pub dofs: usize,
    /// Slave points of all contacts.
    pub contact_points: usize,
    /// Newton iterations of all attempts.
    pub newton_iterations: u64,
    /// Accepted steps.
    pub steps: u32,
    /// Steps that were cut.
    pub cuts: u32,
    /// End time and iterations of every accepted step.
    pub steps_taken: Vec<(f64, u32)>,
    /// Number of factorizations, by method.
    pub factorizations: BTreeMap<String, u64>,
    /// Warnings of the run.
    pub warnings: Vec<String>,
    /// As many as the record has quantities.
    pub measured: Vec<Measured>,
}

/// A value of a choice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Label {
    /// In words, e.g. "bilinear, chord 0.1".
    pub text: String,
    /// Without what makes it finer, e.g. "bilinear": runs that agree in all of these are joined by a line.
    pub series: String,
    /// What makes it finer as it becomes smaller, e.g. the chord.
    pub size: Option<f64>,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// It reached its end.
    Done,
    /// It did not reach its end, and why.
    Failed(String),
    /// It has not been done, or its results have not been brought here.
    Missing,
}

/// Times of the repeats of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The median (s).
    pub median: f64,
    /// The smallest (s).
    pub least: f64,
    /// The largest (s).
    pub most: f64,
    /// Number of repeats.
    pub repeats: u32,
}

/// A quantity of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// None for fields, and where it could not be measured.
    pub value: Option<f64>,
    /// The curve, as pairs of the independent variable and the value.
    pub curve: Option<Vec<[f64; 2]>>,
    /// Relative to the reference.
    pub error: Option<f64>,
    /// Why there is none, in words.
    pub missing: Option<String>,
}
