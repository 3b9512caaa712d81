//! Runs random scenes, each in a process of its own, so that a crash or a hang is a result.
use super::repeat::{finer, is_of_mesh, off, repetition};
use super::{Frame, RandomScene, audit, draw_with_effects};
use crate::output::{Summary, read_csv};
use serde::Serialize;
use serde_json::Value;
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
    /// Whether what reaches its end is repeated in half of the steps and under ten times the penalty, and on a finer mesh where a
    /// warning is of the mesh.
    pub repeat: bool,
}

/// Part of the largest force by which a result may be off without a word.
const UNTOLD: f64 = 0.02;

/// What a repetition says of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Repeated {
    /// How far the force on the tool is off, relative to its largest one.
    pub off: f64,
    /// Number of warnings of the repetition: with any, it is no judge of a run without.
    pub warnings: usize,
    /// How far it is off from that on a mesh of half the size; none: no warning is of the mesh, or the finer run did not reach its end.
    pub on_finer_mesh: Option<f64>,
}

impl Repeated {
    /// How far the force is off by what its warnings are of.
    pub fn most(&self) -> f64 {
        self.off.max(self.on_finer_mesh.unwrap_or(0.0))
    }
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
    /// What its repetition says; none: there was none, or it did not reach its end.
    pub repeated: Option<Repeated>,
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
    let scene = draw_with_effects(seed);
    let folder = settings.folder.join(format!("seed_{seed:06}"));
    fs::create_dir_all(&folder)?;
    let written = scene.write(&Frame::default());
    for (name, text) in [
        ("tool.json", written.cad()?),
        ("sheet.json", written.sheet()?),
    ] {
        if let Some(text) = text {
            fs::write(folder.join(name), text)?;
        }
    }
    let start = Instant::now();
    let (ended, summary) = run(settings, (&folder, ["scene.json", "out"]), &written.scene)?;
    let seconds = start.elapsed().as_secs_f64();
    let mut ending = judge(&scene, ended, summary.as_ref(), &folder);
    let count = |of: &dyn Fn(&Summary) -> u64| summary.as_ref().map_or(0, of);
    let warnings = summary.as_ref().map_or(0, |s| s.warnings.len());
    let mut repeated = None;
    if settings.repeat && ending == Ending::Done {
        let other = |name: &str, scene_again: &Value| -> io::Result<Option<(f64, usize)>> {
            let file = format!("{name}.json");
            let (ended, again) = run(settings, (&folder, [&file, name]), scene_again)?;
            let [first, second] =
                ["out", name].map(|out| read_csv(&folder.join(out).join("history.csv")));
            Ok(
                match (ended.map(|status| status.success()), again, first, second) {
                    (Some(true), Some(again), Ok(first), Ok(second)) => {
                        off(&scene, &first, &second).map(|off| (off, again.warnings.len()))
                    }
                    _ => None,
                },
            )
        };
        repeated =
            other("again", &repetition(&scene, &written.scene))?.map(|(off, warnings)| Repeated {
                off,
                warnings,
                on_finer_mesh: None,
            });
        let mut told = summary.iter().flat_map(|s| &s.warnings);
        if let Some(repeated) = &mut repeated
            && told.any(|w| is_of_mesh(w))
        {
            let finer = finer(&scene).write(&Frame::default());
            repeated.on_finer_mesh = other("finer", &finer.scene)?.map(|(off, _)| off);
        }
        if let Some(Repeated {
            off, warnings: 0, ..
        }) = repeated
            && off > UNTOLD
            && warnings == 0
        {
            ending = Ending::Silent(format!(
                "its force is {:.1} % off from that of half the steps and ten times the penalty, and nothing was told",
                100.0 * off
            ));
        }
    }
    Ok(Played {
        seed,
        story: scene.story(),
        ending,
        steps: count(&|s| s.steps.into()) as u32,
        iterations: count(&|s| s.newton_iterations),
        cuts: count(&|s| s.cuts.into()) as u32,
        warnings,
        seconds,
        repeated,
    })
}

/// Runs the program on a scene, which it writes; the status is none where it was stopped at its limit.
fn run(
    settings: &Settings,
    (folder, [file, out]): (&Path, [&str; 2]),
    scene: &Value,
) -> io::Result<(Option<ExitStatus>, Option<Summary>)> {
    if folder.join(out).exists() {
        // Results of an earlier run must not pass for this one's.
        fs::remove_dir_all(folder.join(out))?;
    }
    fs::write(folder.join(file), serde_json::to_string_pretty(scene)?)?;
    let said = File::create(folder.join(out).with_extension("stderr.txt"))?;
    let mut child = Command::new(&settings.program)
        .args(["run", file, "-o", out, "--quiet", "--no-report"])
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(said)
        .spawn()?;
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break Some(status);
        }
        if start.elapsed() > settings.limit {
            child.kill()?;
            child.wait()?;
            break None;
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    let summary = Summary::read(&folder.join(out).join("summary.json")).ok();
    Ok((status, summary))
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
    let said = fs::read_to_string(folder.join("out.stderr.txt")).unwrap_or_default();
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
