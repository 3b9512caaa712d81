//! `covact view` and `covact compare`: pages of runs.
use super::{CompareArgs, RunArgs, ViewArgs, exit, print, report};
use crate::output::OutputError;
use crate::page::{self, PageError};
use std::path::Path;

pub(super) fn view(args: &ViewArgs) -> u8 {
    match page::write(&args.folder) {
        Ok(path) => print(&format!("{}\n", path.display())),
        Err(e) => failed(&e, &[&args.folder]),
    }
}

pub(super) fn compare(args: &CompareArgs) -> u8 {
    let folders = [args.first.as_path(), args.second.as_path()];
    match page::write_beside(folders, &args.out) {
        Ok(()) => print(&format!("{}\n", args.out.display())),
        Err(e) => failed(&e, &folders),
    }
}

/// Makes the page of a run that has ended. The results are there without it, so a failure is a warning.
pub(super) fn after_run(args: &RunArgs) {
    if args.resume && is_newer(&args.out) {
        return;
    }
    if let Err(e) = page::write(&args.out) {
        report::warning(&format!("no {}: {e}", page::REPORT));
    }
}

/// Whether the page of a folder is newer than the results.
fn is_newer(folder: &Path) -> bool {
    let changed = |name: &str| folder.join(name).metadata().and_then(|m| m.modified());
    match (changed(page::REPORT), changed("summary.json")) {
        (Ok(page), Ok(summary)) => page >= summary,
        _ => false,
    }
}

fn failed(e: &PageError, folders: &[&Path]) -> u8 {
    report::error(&e.to_string());
    let empty = folders.iter().find(|f| !f.join("summary.json").is_file());
    if let (Some(folder), PageError::Output(OutputError::Io { .. })) = (empty, e) {
        let folder = folder.display();
        report::stderr(&format!(
            "`{folder}` does not hold the results of a run that has ended\n"
        ));
    }
    match e {
        PageError::Foreign(_) => exit::USAGE,
        PageError::Output(_) | PageError::Fields(_) => exit::IO,
    }
}
