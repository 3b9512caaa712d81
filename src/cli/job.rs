//! `covact job`.
use super::{JobArgs, exit, report, study};
use crate::study::record::Ending;
use crate::study::{Job, Jobs, StudyError};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

pub(super) fn job(args: &JobArgs) -> u8 {
    match run(&args.folder, &args.run) {
        Ok(code) => code,
        Err(e) => {
            report::error(&format!("{}: {e}", args.run));
            exit::IO
        }
    }
}

fn run(folder: &Path, name: &str) -> Result<u8, StudyError> {
    let jobs = Jobs::read(folder)?;
    let interrupt = Arc::new(AtomicBool::new(false));
    study::watch(&interrupt);
    let done = jobs.play(folder, name, study::program()?, &interrupt)?;
    Ok(tell(name, done, jobs.may_fail))
}

/// A line for the log of the system; the exit code.
fn tell(name: &str, done: Option<Job>, may_fail: bool) -> u8 {
    let Some(job) = done else {
        report::error(&format!(
            "{name}: interrupted; called again, it goes on from its last checkpoint"
        ));
        return exit::NOT_CONVERGED;
    };
    let before = if job.before { " (before)" } else { "" };
    match job.ending {
        Ending::Done => {
            report::stderr(&format!(
                "{name}: done{before}, {} steps, {} iterations, {:.2} s\n",
                job.steps,
                job.newton_iterations,
                job.wall_s.unwrap_or_default()
            ));
            0
        }
        Ending::Failed(reason) => {
            report::error(&format!("{name}: failed{before}: {reason}"));
            match may_fail {
                true => 0,
                false => exit::NOT_CONVERGED,
            }
        }
        Ending::Missing => {
            let why = job.why.map_or(String::new(), |why| format!(": {why}"));
            report::error(&format!("{name}: left no results{why}"));
            exit::NOT_CONVERGED
        }
    }
}
