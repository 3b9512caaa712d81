//! `covact run`.
use super::log::Log;
use super::progress::{JsonLines, Plain, Terminal};
use super::{RunArgs, check, exit, report, view, without};
use crate::output::RunStatus;
use crate::run::{self, RunOptions};
use crate::solve::event::{Observer, Silent};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

pub(super) fn run(args: &RunArgs) -> u8 {
    let scene = match check::load(&args.scene) {
        Ok(scene) => scene,
        Err(e) => return report::scene_error(&e, args.json),
    };
    let scene = match &args.off {
        Some(name) => match without::scene_without(&scene, name, args.json) {
            Ok(scene) => scene,
            Err(code) => return code,
        },
        None => scene,
    };
    if let Err(code) = without::check_names(&scene, args) {
        return code;
    }
    if let Err(code) = without::check_folders(&scene, args) {
        return code;
    }
    let interrupt = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupt);
    let handler = super::interrupt::watch(move || {
        if flag.swap(true, Ordering::Relaxed) {
            // The second time: at once.
            std::process::exit(exit::KILLED.into());
        }
        report::stderr(
            "\nstopping after this step, what was computed is kept (again to stop at once)\n",
        );
    });
    if let Err(e) = handler {
        report::warning(&format!("interrupting will lose the step under way: {e}"));
    }

    let end_time = scene.scene.solution.end_time;
    let shown: Box<dyn Observer + Send> = if args.json {
        Box::new(JsonLines)
    } else if args.quiet {
        Box::new(Silent)
    } else if std::io::stderr().is_terminal() {
        Box::new(Terminal::new(end_time))
    } else {
        Box::new(Plain::new(end_time, args.verbose))
    };
    let mut observer = Log::new(&args.out, end_time, shown);
    let options = RunOptions {
        threads: args.threads,
        resume: args.resume,
        force: args.force,
    };
    let result = run::run(&scene, &args.out, &options, &mut observer, &interrupt);
    // Clears the progress bar before anything else is printed.
    drop(observer);
    let summary = match result {
        Ok(summary) => summary,
        Err(e) => return report::run_error(&e, &scene, args.json),
    };
    let (code, status) = match summary.status {
        RunStatus::Done => (0, "done"),
        RunStatus::NotConverged => (exit::NOT_CONVERGED, "not converged"),
        RunStatus::NoContact => (exit::NOT_CONVERGED, "no contact"),
        RunStatus::Interrupted => (exit::NOT_CONVERGED, "interrupted"),
        RunStatus::Failed => (exit::IO, "failed"),
    };
    if code != 0 {
        let reason = summary
            .reason
            .as_ref()
            .map_or(String::new(), |r| format!(": {r}"));
        let kept = format!(
            "{} steps up to time {} are in {}",
            summary.steps,
            summary.time,
            args.out.display()
        );
        report::error(&format!("{status}{reason}; {kept}"));
    } else if !args.quiet && !args.json {
        report::stderr(&format!(
            "{status}: {} steps, {} iterations{}, {:.2} s; results in {}\n",
            summary.steps,
            summary.newton_iterations,
            summary.in_vain(),
            summary.wall_s,
            args.out.display()
        ));
    }
    if !args.no_report {
        view::after_run(args);
    }
    // A run that the user stopped, or that lost its folder, is not followed by others.
    let goes_on = !matches!(summary.status, RunStatus::Interrupted | RunStatus::Failed);
    match goes_on && !args.without.is_empty() {
        true => without::what_ifs(&scene, args, code, &interrupt),
        false => code,
    }
}
