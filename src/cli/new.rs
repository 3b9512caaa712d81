//! `covact new`: a scene to start from.
use super::{NewArgs, exit, report};
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::PathBuf;

/// A plate under a ball. JSON has no comments, so titles and names have to speak for themselves.
pub(super) const STARTER: &str = include_str!("starter.json");

pub(super) fn new(args: &NewArgs) -> u8 {
    let name = args.name.strip_suffix(".json").unwrap_or(&args.name);
    let path = PathBuf::from(format!("{name}.json"));
    let written = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&path)
        .and_then(|mut file| {
            file.write_all(STARTER.as_bytes())
                .and_then(|()| file.sync_all())
        });
    match written {
        Ok(()) => {
            report::stderr(&format!(
                "{0} is written; `covact check {0}` shows what it amounts to, `covact run {0} -o out` solves it\n",
                path.display()
            ));
            0
        }
        Err(e) if e.kind() == ErrorKind::AlreadyExists => {
            report::error(&format!(
                "{} exists already and is left as it is",
                path.display()
            ));
            exit::IO
        }
        Err(e) => {
            report::error(&format!("cannot write {}: {e}", path.display()));
            exit::IO
        }
    }
}
