//! Runs random scenes, each in a process of its own, so that a crash or a hang is a result.
use super::{Frame, RandomScene, audit, draw};
use crate::output::{Summary, read_csv};
use serde::Serialize;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// How scenes are run.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The program, which is called with `run SCENE -o OUT --quiet`.
    pub program: PathBuf,
    /// Where scenes and results are kept, a folder per seed.
    pub folder: PathBuf,
    /// A run that takes longer hangs.
    pub limit: Duration,
}

/// How a random scene ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "ending", content = "why")]
pub enum Ending {
    /// It reached its end, and its result passed the audit.
    Done,
    /// It did not, and said why.
    Told(String),
    /// It ended without an account of it, or by a signal.
    Crashed(String),
    /// It took longer than its limit.
    Hung,
    /// It said that all is well, or gave no reason, and the audit found otherwise.
    Silent(String),
}

/// A random scene that was run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Played {
    /// The seed that it was drawn from.
    pub seed: u64,
    /// What the scene is, in words.
    pub story: String,
    /// How the run ended.
    #[serde(flatten)]
    pub ending: Ending,
    /// Accepted steps.
    pub steps: u32,
    /// Newton iterations of all attempts.
    pub iterations: u64,
    /// Steps that were cut.
    pub cuts: u32,
    /// Number of warnings.
    pub warnings: usize,
    /// Elapsed time (s).
    pub seconds: f64,
}

impl Ending {
    /// In a word.
    pub fn name(&self) -> &'static str {
        match self {
            Ending::Done => "done",
            Ending::Told(_) => "told",
            Ending::Crashed(_) => "CRASHED",
            Ending::Hung => "HUNG",
            Ending::Silent(_) => "SILENT",
        }
    }

    /// Whether the program did what it promises.
    pub fn fair(&self) -> bool {
        matches!(self, Ending::Done | Ending::Told(_))
    }
}

/// Runs the scene of a seed and audits what comes out.
///
/// # Errors
/// Its folder cannot be written, or the program cannot be started.
pub fn play(seed: u64, settings: &Settings) -> io::Result<Played> {
    let scene = draw(seed);
    let folder = settings.folder.join(format!("seed_{seed:06}"));
    let out = folder.join("out");
    if out.exists() {
        // Results of an earlier run must not pass for this one's.
        fs::remove_dir_all(&out)?;
    }
    fs::create_dir_all(&folder)?;
    let written = scene.write(&Frame::default());
    fs::write(
        folder.join("scene.json"),
        serde_json::to_string_pretty(&written.scene)?,
    )?;
    if let Some(cad) = written.cad()? {
        fs::write(folder.join("tool.json"), cad)?;
    }
    let start = Instant::now();
    let ended = run(settings, &folder)?;
    let seconds = start.elapsed().as_secs_f64();
    let summary = Summary::read(&out.join("summary.json")).ok();
    let ending = judge(&scene, ended, summary.as_ref(), &folder);
    let count = |of: &dyn Fn(&Summary) -> u64| summary.as_ref().map_or(0, of);
    Ok(Played {
        seed,
        story: scene.story(),
        ending,
        steps: count(&|s| s.steps.into()) as u32,
        iterations: count(&|s| s.newton_iterations),
        cuts: count(&|s| s.cuts.into()) as u32,
        warnings: summary.as_ref().map_or(0, |s| s.warnings.len()),
        seconds,
    })
}

/// Runs the program on `scene.json`; none: it was stopped at its limit.
fn run(settings: &Settings, folder: &Path) -> io::Result<Option<ExitStatus>> {
    let mut child = Command::new(&settings.program)
        .args(["run", "scene.json", "-o", "out", "--quiet", "--no-report"])
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(folder.join("stderr.txt"))?)
        .spawn()?;
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if start.elapsed() > settings.limit {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn judge(
    scene: &RandomScene,
    ended: Option<ExitStatus>,
    summary: Option<&Summary>,
    folder: &Path,
) -> Ending {
    let Some(status) = ended else {
        return Ending::Hung;
    };
    let said = fs::read_to_string(folder.join("stderr.txt")).unwrap_or_default();
    let first = said.lines().next().unwrap_or_default().to_owned();
    let summary = match (status.code(), summary) {
        (None | Some(1 | 101), _) => return Ending::Crashed(format!("{status}: {first}")),
        (Some(2..), _) if first.is_empty() => return Ending::Silent(status.to_string()),
        (Some(3 | 5), _) => return Ending::Told(first),
        (_, None) => return Ending::Crashed(format!("{status}, and no summary: {first}")),
        (_, Some(summary)) => summary,
    };
    let history = match read_csv(&folder.join("out/history.csv")) {
        Ok(history) => history,
        Err(e) => return Ending::Silent(e.to_string()),
    };
    match audit(scene, summary, &history) {
        Err(finding) => Ending::Silent(finding.to_string()),
        Ok(()) if status.success() => Ending::Done,
        Ok(()) => Ending::Told(first),
    }
}
