//! How a run went and what it cost.
use super::atomic::write_whole;
use super::planned::PlanSummary;
use super::{Accuracy, OutputError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Version of the format of `summary.json`.
pub const SUMMARY_FORMAT: u32 = 1;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunStatus {
    /// The end time was reached.
    Done,
    /// A step failed at the smallest step size; what was computed before is kept.
    NotConverged,
    /// The end time was reached, but a contact pair never touched.
    NoContact,
    /// The user stopped the run; what was computed before is kept.
    Interrupted,
    /// Something else went wrong, e.g. a full disk.
    Failed,
}

impl RunStatus {
    /// The name in `summary.json`.
    pub const fn name(self) -> &'static str {
        match self {
            RunStatus::Done => "done",
            RunStatus::NotConverged => "not_converged",
            RunStatus::NoContact => "no_contact",
            RunStatus::Interrupted => "interrupted",
            RunStatus::Failed => "failed",
        }
    }
}

/// `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The scene's `title`; empty where it has none.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// How the run ended.
    pub status: RunStatus,
    /// Why the run ended early, in words.
    pub reason: Option<String>,
    /// Time that was reached, of the scene's clock.
    pub time: f64,
    /// Elapsed seconds from reading the scene to the last result.
    pub wall_s: f64,
    /// Processor seconds of all threads; none where the system does not tell.
    pub cpu_s: Option<f64>,
    /// Elapsed seconds by phase, without phases inside.
    pub phases: BTreeMap<String, f64>,
    /// Largest resident memory in MB (10^6 bytes); none where the system does not tell.
    pub peak_memory_mb: Option<f64>,
    /// Threads used.
    pub threads: usize,
    /// Unknowns, prescribed ones left out.
    pub dofs: usize,
    /// Slave points of all contact pairs.
    pub contact_points: usize,
    /// Iterations of all steps, of failed attempts too, and of runs that were given up.
    pub newton_iterations: u64,
    /// Those of them that failed attempts took, and runs that were given up.
    #[serde(default)]
    pub failed_iterations: u64,
    /// Runs that were given up before this one took their place, with what they say in the warnings; seconds and phases have
    /// what they cost, too.
    #[serde(default, skip_serializing_if = "GivenUp::is_none")]
    pub given_up: GivenUp,
    /// Factorizations by method, `llt`, `ldlt` or `lu`, of failed attempts too.
    #[serde(default)]
    pub factorizations: BTreeMap<String, u64>,
    /// Accepted steps.
    pub steps: u32,
    /// Attempts that failed and were rolled back.
    pub cuts: u32,
    /// Times that contact points switched between open and closed round and round, and were stopped.
    #[serde(default)]
    pub ping_pongs: u32,
    /// Times the system's structure was set up anew because slave points had come to faces of a body that it did not
    /// hold yet.
    #[serde(default)]
    pub pattern_rebuilds: u32,
    /// Effects that were on, by name.
    pub effects: Vec<String>,
    /// What was done and why, contact by contact; none where the device was too full to write it.
    #[serde(default)]
    pub plan: Option<PlanSummary>,
    /// Columns of probes: the last value and the extremes.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub probes: BTreeMap<String, ProbeSummary>,
    /// What the user should know, in words.
    pub warnings: Vec<String>,
    /// What was found about the accuracy of contact forces.
    #[serde(default)]
    pub accuracy: Accuracy,
    /// Stages of the run that have ended, in their order; none where the scene has no stages.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<StageSummary>,
    /// Times that the run was continued after an interruption. Seconds and phases are then those of all parts, each up to
    /// the step that the next one went on from.
    #[serde(default)]
    pub resumed: u32,
    /// Checksum of the scene and of the files that it names.
    #[serde(default)]
    pub scene: String,
    /// Versions that made this file.
    pub versions: Versions,
}

/// Runs that were given up before another one, with other elements or other slaves, took their place.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GivenUp {
    /// How many.
    pub runs: u32,
    /// Their iterations.
    pub newton_iterations: u64,
}

impl GivenUp {
    fn is_none(&self) -> bool {
        self.runs == 0
    }
}

impl Summary {
    /// The iterations that lead to no accepted step, in words and brackets; nothing where there are none.
    pub fn in_vain(&self) -> String {
        let GivenUp {
            runs,
            newton_iterations,
        } = self.given_up;
        let failed = match self.failed_iterations.saturating_sub(newton_iterations) {
            0 => None,
            n => Some(format!("{n} in attempts that failed")),
        };
        let given_up = match runs {
            0 => None,
            1 => Some(format!("{newton_iterations} in a run that was given up")),
            n => Some(format!(
                "{newton_iterations} in {n} runs that were given up"
            )),
        };
        let parts: Vec<String> = failed.into_iter().chain(given_up).collect();
        match parts.is_empty() {
            true => String::new(),
            false => format!(" ({})", parts.join(", ")),
        }
    }
}

/// How a stage of a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageSummary {
    /// Name of the stage.
    pub name: String,
    /// Time at its end.
    pub until: f64,
    /// Its last step.
    pub step: u32,
    /// The largest force so far of a tool, between bodies, or of what was let down in a stage (force); 0 in the first stage.
    pub force: f64,
    /// Number of displacements that supports found by the program held.
    pub found_supports: usize,
    /// Largest force of one of these supports at the end (force).
    pub reaction: f64,
    /// Contacts whose tools have gone back, and which still bear.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bearing: Vec<String>,
}

/// A column of a probe.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ProbeSummary {
    /// At the end of the run.
    pub last: f64,
    /// Smallest of all steps.
    pub min: f64,
    /// Largest of all steps.
    pub max: f64,
}

/// Versions that a result depends on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Versions {
    /// Version of this program.
    pub covact: String,
    /// Version of the format of this file.
    pub format: u32,
}

impl Default for Versions {
    fn default() -> Self {
        Versions {
            covact: env!("CARGO_PKG_VERSION").to_string(),
            format: SUMMARY_FORMAT,
        }
    }
}

impl Summary {
    /// Writes the summary as JSON, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        let mut text = serde_json::to_string_pretty(self).map_err(|e| OutputError::Serialise {
            part: "the summary".to_string(),
            reason: e.to_string(),
        })?;
        text.push('\n');
        write_whole(path, text.as_bytes())
    }

    /// Reads a summary back.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let text = std::fs::read_to_string(path).map_err(|e| OutputError::io("read", path, e))?;
        serde_json::from_str(&text).map_err(|e| OutputError::Table {
            path: path.to_path_buf(),
            line: e.line(),
            reason: e.to_string(),
        })
    }
}
