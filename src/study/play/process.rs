//! One repeat of a run: a process, its limit, and the account of it.
use super::{Place, Settings};
use crate::output::atomic::{make_folder, remove_file, write_whole};
use crate::output::{FolderLock, LOCK_FILE, Locking, OutputError, RunStatus, Summary};
use crate::study::error::StudyError;
use crate::study::folder::Folder;
use crate::{run, scene};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Bounds of the time between two looks at a process: so short that a run's time is known to half a hundredth.
const LOOK: [Duration; 2] = [Duration::from_micros(500), Duration::from_millis(20)];

/// Processes of runs that have been started and not been waited for.
static RUNNING: AtomicUsize = AtomicUsize::new(0);

/// Number of processes of runs, of all studies of this program, that may still be there.
pub fn running() -> usize {
    RUNNING.load(Ordering::SeqCst)
}

/// Counts a process for as long as it lives.
struct Running;

impl Running {
    fn new() -> Self {
        RUNNING.fetch_add(1, Ordering::SeqCst);
        Running
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        RUNNING.fetch_sub(1, Ordering::SeqCst);
    }
}

/// `process.json` beside the results of a run: what its process took, and how it ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// Version of the program.
    pub covact: String,
    /// Checksum of the scene.
    pub scene: String,
    /// Threads of the run.
    pub threads: usize,
    /// Elapsed seconds of the process, as seen from outside.
    pub wall_s: f64,
    /// Processor seconds of all threads, as the run tells.
    pub cpu_s: Option<f64>,
    /// Largest resident memory in MB (10^6 bytes), as the run tells.
    pub peak_memory_mb: Option<f64>,
    /// None where a signal ended it.
    pub exit_code: Option<i32>,
    /// The signal that ended it, where one did.
    pub signal: Option<i32>,
    /// Seconds after which it was stopped, where it was.
    pub stopped_after: Option<f64>,
    /// A job of another system did the run, perhaps on another machine than others.
    #[serde(default)]
    pub elsewhere: bool,
}

impl Account {
    /// Reads the account in a folder of results; none where there is none that can be read.
    pub fn read(results: &Path) -> Option<Self> {
        let text = fs::read_to_string(results.join("process.json")).ok()?;
        serde_json::from_str(&text).ok()
    }

    fn write(&self, results: &Path) -> Result<(), OutputError> {
        let mut text = serde_json::to_string_pretty(self).map_err(|e| OutputError::Serialise {
            part: "the account of a process".to_owned(),
            reason: e.to_string(),
        })?;
        text.push('\n');
        write_whole(&results.join("process.json"), text.as_bytes())
    }
}

/// How it came out.
pub(super) enum Ended {
    /// It has ended, or was stopped at its limit.
    Done,
    /// The user wants the study to stop.
    Interrupted,
}

pub(super) struct Process<'a> {
    pub folder: &'a Folder,
    pub run: usize,
    pub repeat: u32,
    pub settings: &'a Settings,
}

impl Process<'_> {
    /// Does the run: anew, or from where it was cut short.
    pub fn run(&self, interrupt: &AtomicBool) -> Result<Ended, StudyError> {
        let ready = &self.folder.runs[self.run];
        let results = self.folder.results(&ready.id, self.repeat);
        let resume = self.settings.place == Place::Elsewhere && self.can_go_on(&results);
        match resume {
            true => {
                let _free = unused(&results)?;
                remove_file(&results.join("process.json"))?;
            }
            false => clear(&results)?,
        }
        let _running = Running::new();
        // Asked after it is counted: whoever interrupts and then sees none running can rely on it.
        if interrupt.load(Ordering::SeqCst) {
            return Ok(Ended::Interrupted);
        }
        let start = Instant::now();
        let mut child = self.start(&results, resume)?;
        let mut stopped_after = None;
        let status = loop {
            let over = start.elapsed() > self.settings.limit;
            let interrupted = interrupt.load(Ordering::Relaxed);
            if over || interrupted {
                // One that has just ended cannot be stopped any more.
                let _ = child.kill();
                let status = wait(&mut child, &results)?;
                if interrupted {
                    return Ok(Ended::Interrupted);
                }
                stopped_after = Some(self.settings.limit.as_secs_f64());
                break status;
            }
            match child.try_wait() {
                Ok(Some(status)) => break status,
                Ok(None) => std::thread::sleep((start.elapsed() / 200).clamp(LOOK[0], LOOK[1])),
                Err(e) => return Err(OutputError::io("wait for the run in", &results, e).into()),
            }
        };
        let wall_s = start.elapsed().as_secs_f64();
        let summary = Summary::read(&results.join("summary.json")).ok();
        // At the terminal an interrupt reaches the run, too, and perhaps before it reaches this program.
        if (summary.as_ref()).is_some_and(|s| s.status == RunStatus::Interrupted) {
            return Ok(Ended::Interrupted);
        }
        // Of all parts of a run that was continued, the run itself tells.
        let wall_s = match &summary {
            Some(s) if resume && s.resumed > 0 => wall_s.max(s.wall_s),
            _ => wall_s,
        };
        let account = Account {
            threads: self.folder.threads as usize,
            cpu_s: summary.as_ref().and_then(|s| s.cpu_s),
            peak_memory_mb: summary.as_ref().and_then(|s| s.peak_memory_mb),
            covact: env!("CARGO_PKG_VERSION").to_owned(),
            scene: ready.checksum.clone(),
            wall_s,
            exit_code: status.code(),
            signal: signal(status),
            stopped_after,
            elsewhere: self.settings.place == Place::Elsewhere,
        };
        account.write(&results)?;
        Ok(Ended::Done)
    }

    /// Whether the results are those of this run as far as it came, with a checkpoint to go on from.
    fn can_go_on(&self, results: &Path) -> bool {
        let id = &self.folder.runs[self.run].id;
        let scene = self.folder.path.join("runs").join(id).join("scene.json");
        scene::load(&scene).is_ok_and(|loaded| run::is_unfinished(&loaded, results))
    }

    fn start(&self, results: &Path, resume: bool) -> Result<Child, StudyError> {
        let said = results.join("stderr.txt");
        let said = File::create(&said).map_err(|e| OutputError::io("write", &said, e))?;
        let id = &self.folder.runs[self.run].id;
        let program = &self.settings.program;
        (Command::new(program).args(self.folder.arguments(id, self.repeat, resume)))
            .current_dir(&self.folder.path)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(said)
            .spawn()
            .map_err(|e| StudyError::Start {
                program: program.clone(),
                reason: e.to_string(),
            })
    }
}

/// Results of an earlier or unfinished run must not pass for those of this one. A folder that does not look like results, or
/// that another run is writing to, is left alone.
fn clear(results: &Path) -> Result<(), StudyError> {
    if !removable(results)? {
        return Err(StudyError::Occupied {
            path: results.to_path_buf(),
            what: "should hold results of a run, and holds something else".to_owned(),
        });
    }
    // Held until the folder is gone.
    let _lock = match results.is_dir() {
        true => Some(unused(results)?),
        false => None,
    };
    match fs::remove_dir_all(results) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => {
            return Err(OutputError::io("remove the folder", results, e).into());
        }
        _ => {}
    }
    Ok(make_folder(results)?)
}

/// The lock of a folder that no other run is writing to.
fn unused(results: &Path) -> Result<Locking, StudyError> {
    match FolderLock::take(results)? {
        Locking::InUse(holder) => {
            let by = (holder.as_ref()).map_or(String::new(), |holder| format!(" ({holder})"));
            Err(StudyError::Occupied {
                path: results.to_path_buf(),
                what: format!("is written to by another run{by}"),
            })
        }
        lock => Ok(lock),
    }
}

/// Files that tell a folder of results from others; a job that was killed early leaves no more than its history.
const OWN: [&str; 4] = ["process.json", "summary.json", "stderr.txt", "history.csv"];

/// It is not there, is empty, or holds a file that this program writes into every folder of results.
fn removable(results: &Path) -> Result<bool, OutputError> {
    let entries = match fs::read_dir(results) {
        Ok(entries) => entries,
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(true),
        Err(e) => return Err(OutputError::io("read the folder", results, e)),
    };
    let mut empty = true;
    for entry in entries {
        let name = (entry.map_err(|e| OutputError::io("read the folder", results, e))?).file_name();
        let name = name.to_string_lossy();
        let own = OWN.contains(&&*name);
        if own || name == LOCK_FILE || (name.starts_with("checkpoint.") && name.ends_with(".bin")) {
            return Ok(true);
        }
        empty = false;
    }
    Ok(empty)
}

fn wait(child: &mut Child, results: &Path) -> Result<ExitStatus, OutputError> {
    (child.wait()).map_err(|e| OutputError::io("wait for the run in", results, e))
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> Option<i32> {
    None
}
