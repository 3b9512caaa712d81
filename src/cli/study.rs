//! `covact study`.
use super::{StudyArgs, exit, report};
use crate::machine;
use crate::study::record::{Ending, Record};
use crate::study::{
    Event, Folder, LoadedStudy, Settings, StudyError, System, conclude, expand, load, play, running,
};
use serde_json::json;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

pub(super) fn study(args: &StudyArgs) -> u8 {
    match run(args) {
        Ok(code) => code,
        Err(StudyError::Scene(e)) => report::scene_error(&e, args.json),
        Err(e) => report::other_error(&e.to_string(), exit::IO, args.json),
    }
}

fn run(args: &StudyArgs) -> Result<u8, StudyError> {
    let loaded = load(&args.study)?;
    let expansion = expand(&loaded)?;
    let mut folder = Folder::write(&args.out, &loaded.study, &expansion)?;
    if args.jobs {
        let program = args.program.as_deref().unwrap_or("covact");
        let count = folder.write_jobs(program)?;
        if !args.quiet {
            report::stderr(&format!(
                "{count} jobs in {}, to be called in that folder\n",
                args.out.join("jobs.txt").display()
            ));
        }
        return Ok(0);
    }
    if let Some(target) = args.system {
        return script(args, &loaded, &folder, target.system());
    }
    let interrupt = Arc::new(AtomicBool::new(false));
    if !args.collect {
        watch(&interrupt);
        // Results tell how many threads they took, and are compared with what the study asks for.
        let (threads, capped) = machine::threads(folder.threads as usize);
        if let Some(text) = capped {
            report::warning(&format!("`/timing/threads`: {text}"));
            folder.threads = threads as u32;
        }
        let settings = settings(&loaded)?;
        let width = expansion.runs.iter().map(|r| r.id.len()).max().unwrap_or(0);
        play(&folder, &settings, &interrupt, &|event| {
            tell(event, args, width)
        })?;
    }
    let record = conclude(&loaded, &expansion, &folder);
    record.write(&args.out)?;
    crate::study::report::write(&record, &args.out)?;
    Ok(end(
        args,
        &loaded,
        &record,
        interrupt.load(Ordering::Relaxed),
    ))
}

/// A system that `--for` names.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(super) enum Target {
    /// An array of jobs of Slurm
    Slurm,
    /// GNU parallel, here or by ssh
    Parallel,
    /// Snakemake
    Snakemake,
}

impl Target {
    fn system(self) -> System {
        match self {
            Target::Slurm => System::Slurm,
            Target::Parallel => System::Parallel,
            Target::Snakemake => System::Snakemake,
        }
    }
}

/// Writes a script that has another system do what is open, and names what has failed.
fn script(
    args: &StudyArgs,
    loaded: &LoadedStudy,
    folder: &Folder,
    system: System,
) -> Result<u8, StudyError> {
    let program = args.program.as_deref().unwrap_or("covact");
    let standing = folder.write_script(&loaded.study, system, program)?;
    let (open, done) = (standing.open.len(), standing.done);
    for text in &standing.failed {
        report::error(&format!("failed: {text}"));
    }
    if args.json {
        let line = json!({
            "event": "script",
            "file": (open > 0).then(|| args.out.join(system.file())),
            "command": system.command(),
            "open": open,
            "done": done,
            "failed": standing.failed.len(),
        });
        super::print(&format!("{line}\n"));
    } else if !args.quiet {
        let left = match open {
            0 => "nothing to do: take the results with `--collect`".to_owned(),
            _ => format!("`{}` in {} does them", system.command(), args.out.display()),
        };
        report::stderr(&format!(
            "{open} runs open, {done} done, {} failed; {left}\n",
            standing.failed.len()
        ));
    }
    match standing.failed.is_empty() || loaded.study.may_fail {
        true => Ok(0),
        false => Ok(exit::NOT_CONVERGED),
    }
}

fn settings(loaded: &LoadedStudy) -> Result<Settings, StudyError> {
    Ok(Settings::of(&loaded.study.timing, program()?))
}

/// The program that does the runs: this one.
pub(super) fn program() -> Result<PathBuf, StudyError> {
    super::program().map_err(|e| StudyError::Start {
        program: PathBuf::from("covact"),
        reason: format!("cannot tell where this program is: {e}"),
    })
}

/// Time for the processes of runs to be stopped and waited for.
const STOPPING: Duration = Duration::from_secs(5);

/// An interrupt ends the study; what is done is kept.
pub(super) fn watch(interrupt: &Arc<AtomicBool>) {
    let flag = Arc::clone(interrupt);
    let handler = super::interrupt::watch(move || {
        if flag.swap(true, Ordering::SeqCst) {
            // The first one has them killed; none may outlive the study.
            let start = Instant::now();
            while running() > 0 && start.elapsed() < STOPPING {
                std::thread::sleep(Duration::from_millis(2));
            }
            std::process::exit(exit::KILLED.into());
        }
        report::stderr("\nstopping, what is done is kept (the same command goes on)\n");
    });
    if let Err(e) = handler {
        report::warning(&format!(
            "interrupting will lose what has been measured: {e}"
        ));
    }
}

/// A line for a repeat that has ended.
fn tell(event: &Event, args: &StudyArgs, width: usize) {
    if args.json {
        let (ending, reason) = match &event.ending {
            Ending::Done => ("done", None),
            Ending::Failed(reason) => ("failed", Some(reason)),
            Ending::Missing => ("missing", None),
        };
        let line = json!({
            "event": "run",
            "id": event.id,
            "repeat": event.repeat,
            "ending": ending,
            "reason": reason,
            "wall_s": event.wall_s,
            "steps": event.steps,
            "newton_iterations": event.newton_iterations,
            "done": event.done,
            "of": event.of,
            "before": event.before,
        });
        super::print(&format!("{line}\n"));
    }
    if args.quiet || args.json || event.before {
        return;
    }
    let wall = event.wall_s.map_or(String::new(), |s| format!("{s:8.2} s"));
    let cost = format!(
        "{:5} steps {:6} iterations",
        event.steps, event.newton_iterations
    );
    let told = match &event.ending {
        Ending::Done => cost,
        Ending::Failed(reason) => format!("FAILED: {reason}"),
        Ending::Missing => "left no results".to_owned(),
    };
    report::stderr(&format!(
        "{:4}/{} {:width$} {:>2} {wall} {told}\n",
        event.done, event.of, event.id, event.repeat,
    ));
}

/// Says how it came out; the exit code.
fn end(args: &StudyArgs, loaded: &LoadedStudy, record: &Record, interrupted: bool) -> u8 {
    let (mut failed, mut missing) = (Vec::new(), Vec::new());
    for run in &record.runs {
        match &run.ending {
            Ending::Done => {}
            Ending::Failed(reason) => failed.push(format!("{}: {reason}", run.id)),
            Ending::Missing => missing.push(run.id.clone()),
        }
    }
    for warning in &record.warnings {
        report::warning(warning);
    }
    for text in &failed {
        report::error(&format!("failed: {text}"));
    }
    for id in &missing {
        report::error(&format!("missing: {id}"));
    }
    let repeats = loaded.study.timing.repeats;
    let short = |run: &&crate::study::record::RunRecord| {
        run.ending == Ending::Done && run.wall.is_none_or(|w| w.repeats < repeats)
    };
    let incomplete = record.runs.iter().filter(short).count();
    let done = record.runs.len() - failed.len() - missing.len();
    if args.json {
        let line = json!({
            "event": "finished",
            "done": done,
            "failed": failed.len(),
            "missing": missing.len(),
            "incomplete": incomplete,
        });
        super::print(&format!("{line}\n"));
    } else if !args.quiet {
        report::stderr(&format!(
            "{} runs: {} done, {} failed, {} missing; results in {}\n",
            record.runs.len(),
            done,
            failed.len(),
            missing.len(),
            args.out.display()
        ));
    }
    let failures = !failed.is_empty() && !loaded.study.may_fail;
    match failures || !missing.is_empty() || incomplete > 0 || interrupted {
        true => exit::NOT_CONVERGED,
        false => 0,
    }
}
