//! `covact inspect`.
mod extent;
mod findings;
mod listing;
mod stl;

use super::cad::{Stop, fault};
use super::text::folded;
use super::{InspectArgs, exit, print, print_json, report};
use covact_geometry::PatchSet;
use covact_geometry::io::{
    CadError, CadFile, ReadOptions, ReadProgress, read_path_watched, read_stl_path,
};
use findings::Findings;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// The line is not written more often than this.
const STEP: Duration = Duration::from_millis(200);

pub(super) fn inspect(args: &InspectArgs) -> u8 {
    let options = ReadOptions {
        hidden: args.hidden,
    };
    let mut progress = Progress::new();
    let read = read_path_watched(&args.file, &options, &mut |at| progress.show(at));
    progress.clear();
    match read {
        Ok(file) => cad(args, &file),
        Err(e) => {
            // STL holds triangles, no surfaces of CAD: another reader, other findings.
            if let CadError::Format { found, .. } = &e
                && (found.contains("STL") || found.contains("binary"))
            {
                match read_stl_path(&args.file, None) {
                    Ok(file) => return stl::show(args, &file),
                    Err(e) if found.contains("STL") => {
                        report::error(&e.to_string());
                        return exit::SCENE;
                    }
                    Err(_) => {}
                }
            }
            let Stop(text, code) = fault(&args.file, &e);
            report::error(&text);
            code
        }
    }
}

fn cad(args: &InspectArgs, file: &CadFile) -> u8 {
    let mut wrong = None;
    let set = match file.patches.is_empty() || args.brief {
        true => None,
        false => {
            let patches = file.patches.iter().map(|p| p.patch.clone()).collect();
            PatchSet::join(patches, file.joining())
                .map_err(|e| wrong = Some(e.to_string()))
                .ok()
        }
    };
    let findings = Findings::new(file, set.as_ref(), args.brief);
    let code = match args.json {
        true => print_json(&findings),
        false => print(&folded(&listing::listing(&findings))),
    };
    if let Some(wrong) = wrong {
        report::error(&format!("{}: {wrong}", file.path));
        return exit::SCENE;
    }
    if !file.skipped.is_empty() {
        let n = file.skipped.len();
        report::warning(&format!(
            "{n} surface{} not read",
            if n == 1 { " was" } else { "s were" }
        ));
    }
    code
}

/// How far the reading of a large file is, in a line on the terminal that is written anew; nothing elsewhere.
struct Progress {
    terminal: bool,
    last: Instant,
    shown: bool,
}

impl Progress {
    fn new() -> Self {
        Self {
            terminal: std::io::stderr().is_terminal(),
            last: Instant::now(),
            shown: false,
        }
    }

    fn show(&mut self, at: ReadProgress) {
        if self.terminal && self.last.elapsed() >= STEP {
            self.last = Instant::now();
            self.shown = true;
            report::stderr(&format!("\rface {} of {}", at.faces, at.of));
        }
    }

    fn clear(&self) {
        if self.shown {
            report::stderr("\r\x1b[K");
        }
    }
}
