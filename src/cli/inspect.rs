//! `covact inspect`.
mod extent;
mod findings;
mod listing;
mod stl;

use super::cad::{Stop, fault};
use super::text::folded;
use super::{InspectArgs, exit, print, print_json, report};
use covact_geometry::PatchSet;
use covact_geometry::io::{CadError, CadFile, ReadOptions, read_path_with, read_stl_path};
use covact_geometry::project::Joining;
use findings::Findings;

pub(super) fn inspect(args: &InspectArgs) -> u8 {
    let options = ReadOptions {
        hidden: args.hidden,
    };
    match read_path_with(&args.file, &options) {
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

/// How edges of a file are joined where nobody says otherwise.
fn joining(file: &CadFile) -> Joining {
    Joining {
        tolerance: None,
        resolution: file.resolution,
    }
}

fn cad(args: &InspectArgs, file: &CadFile) -> u8 {
    let patches = file.patches.iter().map(|p| p.patch.clone()).collect();
    let mut wrong = None;
    let set = match file.patches.is_empty() {
        true => None,
        false => PatchSet::join(patches, joining(file))
            .map_err(|e| wrong = Some(e.to_string()))
            .ok(),
    };
    let findings = Findings::new(file, set.as_ref());
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
