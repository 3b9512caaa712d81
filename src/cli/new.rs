//! `covact new`: a scene to start from.
use super::{NewArgs, exit, report};
use crate::scene;
use clap::ValueEnum;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The schema that editors find beside a new scene.
const SCHEMA: &str = "covact.schema.json";

/// Scenes to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Template {
    /// A ball pressed into a clamped rubber sheet
    Press,
    /// A strip drawn over a cylinder with friction
    Draw,
    /// A tube squeezed between two plates
    Squeeze,
    /// A cylinder pressed on a block, Hertz's problem
    Hertz,
    /// A shallow arch that a tool pushes through
    Snap,
}

impl Template {
    /// The scene, with comments.
    fn text(self) -> &'static str {
        match self {
            Template::Press => include_str!("templates/press.json"),
            Template::Draw => include_str!("templates/draw.json"),
            Template::Squeeze => include_str!("templates/squeeze.json"),
            Template::Hertz => include_str!("templates/hertz.json"),
            Template::Snap => include_str!("templates/snap.json"),
        }
    }
}

pub(super) fn new(args: &NewArgs) -> u8 {
    let name = args.name.strip_suffix(".json").unwrap_or(&args.name);
    let path = PathBuf::from(format!("{name}.json"));
    if let Err(code) = write_new(&path, args.template.text()) {
        return code;
    }
    let schema = path.with_file_name(SCHEMA);
    // A schema that is there already is as good, or somebody's own.
    if !schema.exists()
        && let Err(code) = write_new(&schema, &scene::schema())
    {
        return code;
    }
    report::stderr(&format!(
        "{0} is written, with {SCHEMA} beside it for editors; `covact check {0}` shows what it amounts to, `covact run {0} -o \
         out` solves it\n",
        path.display()
    ));
    0
}

/// Writes a file that is not there yet, or tells why not.
fn write_new(path: &Path, text: &str) -> Result<(), u8> {
    let written = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(path)
        .and_then(|mut file| {
            file.write_all(text.as_bytes())
                .and_then(|()| file.sync_all())
        });
    written.map_err(|e| {
        report::error(&match e.kind() {
            ErrorKind::AlreadyExists => {
                format!("{} exists already and is left as it is", path.display())
            }
            _ => format!("cannot write {}: {e}", path.display()),
        });
        exit::IO
    })
}
