//! Runs of a study that are done elsewhere: the list of them in its folder, and doing one of it.
use super::error::StudyError;
use super::folder::{Folder, Ready};
use super::gather::state;
use super::play::{Event, Place, Settings, one};
use super::record::Ending;
use crate::output::OutputError;
use crate::output::atomic::write_whole;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// The list, in the folder of the study.
pub const JOBS: &str = "jobs.json";

/// `jobs.json`: all that a machine needs to know of a study to do its runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Jobs {
    /// Version of the program that wrote the scenes, and that has to do the runs.
    pub covact: String,
    /// In the order of the study.
    pub runs: Vec<Ready>,
    /// Times that every run is done.
    pub repeats: u32,
    /// Threads of a run.
    pub threads: u32,
    /// Seconds after which a run is stopped, and counts as failed.
    pub limit: f64,
    /// Runs that fail are results, and no failure of the study.
    pub may_fail: bool,
}

/// Repeats of the runs of a study, by name (`RUN/REPEAT`).
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Standing {
    /// Those that have to be done.
    pub open: Vec<String>,
    /// Those that are done.
    pub done: usize,
    /// Those that have failed, each with its reason. They are not done again.
    pub failed: Vec<String>,
}

impl Jobs {
    /// The runs of a folder.
    pub fn of(folder: &Folder, limit: f64, may_fail: bool) -> Self {
        Jobs {
            covact: env!("CARGO_PKG_VERSION").to_owned(),
            runs: folder.runs.clone(),
            repeats: folder.repeats,
            threads: folder.threads,
            limit,
            may_fail,
        }
    }

    /// Writes the list into the folder of the study.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let mut text = serde_json::to_string_pretty(self).map_err(|e| OutputError::Serialise {
            part: "the list of runs".to_owned(),
            reason: e.to_string(),
        })?;
        text.push('\n');
        write_whole(&folder.join(JOBS), text.as_bytes())
    }

    /// Reads the list in the folder of a study.
    ///
    /// # Errors
    /// [`StudyError::Jobs`]: it is not there, cannot be read, or is of another version of the program.
    pub fn read(folder: &Path) -> Result<Self, StudyError> {
        let path = folder.join(JOBS);
        let refuse = |reason: String| StudyError::Jobs {
            path: path.clone(),
            reason,
        };
        let bytes = std::fs::read(&path).map_err(|e| {
            refuse(format!(
                "cannot be read ({e}): `covact study --for` writes it"
            ))
        })?;
        let jobs: Self = serde_json::from_slice(&bytes)
            .map_err(|e| refuse(format!("is no list of runs of this version ({e})")))?;
        match jobs.covact == env!("CARGO_PKG_VERSION") {
            true => Ok(jobs),
            false => Err(refuse(format!(
                "is of covact {}, and this is {}: every machine needs the version that wrote the scenes",
                jobs.covact,
                env!("CARGO_PKG_VERSION")
            ))),
        }
    }

    /// The folder that the list lies in, as runs are done in it.
    fn folder(&self, path: &Path) -> Folder {
        Folder {
            path: path.to_path_buf(),
            runs: self.runs.clone(),
            repeats: self.repeats,
            threads: self.threads,
        }
    }

    /// What is done, what has failed, and what is left to do.
    pub fn standing(&self, path: &Path) -> Standing {
        let folder = self.folder(path);
        let mut standing = Standing::default();
        for (run, repeat) in folder.rounds() {
            let name = format!("{}/{repeat}", folder.runs[run].id);
            let state = state(&folder, run, repeat);
            match (state.again(self.limit), state.ending) {
                (true, _) | (_, Ending::Missing) => standing.open.push(name),
                (false, Ending::Done) => standing.done += 1,
                (false, Ending::Failed(reason)) => {
                    standing.failed.push(format!("{name}: {reason}"));
                }
            }
        }
        standing
    }

    /// Does the run of a name (`RUN/REPEAT`) in the folder of the study: one that has ended is left as it is, one that was
    /// cut short goes on from its last checkpoint. None where the user interrupted it.
    ///
    /// # Errors
    /// [`StudyError::Jobs`] where the list has no such run; a folder that cannot be written, a program that cannot be started.
    pub fn play(
        &self,
        path: &Path,
        name: &str,
        program: PathBuf,
        interrupt: &AtomicBool,
    ) -> Result<Option<Job>, StudyError> {
        let folder = self.folder(path);
        let parts = name.rsplit_once('/');
        let found = parts.and_then(|(id, repeat)| {
            let run = folder.runs.iter().position(|r| r.id == id)?;
            let repeat = repeat.parse().ok()?;
            (1..=self.repeats)
                .contains(&repeat)
                .then_some((run, repeat))
        });
        let Some(place) = found else {
            return Err(StudyError::Jobs {
                path: path.join(JOBS),
                reason: format!("has no run `{name}`"),
            });
        };
        let settings = Settings {
            program,
            together: 1,
            // Longer than any run.
            limit: Duration::try_from_secs_f64(self.limit).unwrap_or(Duration::MAX),
            place: Place::Elsewhere,
        };
        let job = |event: Event, why| Job {
            ending: event.ending,
            why,
            steps: event.steps,
            newton_iterations: event.newton_iterations,
            wall_s: event.wall_s,
            before: event.before,
        };
        Ok(one(&folder, place, &settings, interrupt)?.map(|(event, why)| job(event, why)))
    }
}

/// How a run that was asked for by its name came out.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// How it ended.
    pub ending: Ending,
    /// Why results that are there are not taken.
    pub why: Option<String>,
    /// Accepted steps.
    pub steps: u32,
    /// Newton iterations of all attempts.
    pub newton_iterations: u64,
    /// Elapsed time (s), of all parts of a run that was continued; none where it was not measured.
    pub wall_s: Option<f64>,
    /// It had ended before.
    pub before: bool,
}
