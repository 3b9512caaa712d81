//! CAD files as the commands read them: what is left out is told, faults have their exit codes.
use super::{exit, report};
use crate::output::OutputError;
use crate::scene::{nearest, nearest_file};
use covact_geometry::io::{CadError, CadFile, LengthUnit, read_path};
use std::path::Path;

/// Surfaces that are named one by one when they were not read.
const NAMED: usize = 20;

/// Why a command ends early: what to say and the exit code.
pub(super) struct Stop(pub String, pub u8);

impl From<OutputError> for Stop {
    fn from(e: OutputError) -> Self {
        Stop(e.to_string(), exit::IO)
    }
}

/// Reads a CAD file, in the unit asked for, and warns of every surface that it does not give.
pub(super) fn read(path: &Path, unit: Option<&str>) -> Result<CadFile, Stop> {
    let unit = unit.map(length_unit).transpose()?;
    let mut file = read_path(path).map_err(|e| fault(path, &e))?;
    for s in file.skipped.iter().take(NAMED) {
        report::warning(&format!(
            "{}: entity {}, {}, is left out: {}",
            file.path, s.entity, s.name, s.reason
        ));
    }
    if let more @ 1.. = file.skipped.len().saturating_sub(NAMED) {
        report::warning(&format!(
            "{}: {more} more surfaces are left out; `covact inspect` names them",
            file.path
        ));
    }
    if file.patches.is_empty() {
        let text = format!("{}: expected at least one surface, found none", file.path);
        return Err(Stop(text, exit::SCENE));
    }
    if let Some(unit) = unit {
        if file.unit.to_metre.is_none() {
            report::warning(&format!(
                "{} states no length unit; its numbers are taken as {}",
                file.path, unit.name
            ));
            file.unit = unit;
        } else {
            file.convert_to(&unit)
                .map_err(|e| Stop(e.to_string(), exit::SCENE))?;
        }
    }
    Ok(file)
}

fn length_unit(name: &str) -> Result<LengthUnit, Stop> {
    LengthUnit::from_name(name).ok_or_else(|| {
        let known = LengthUnit::names();
        let near = nearest(name, known).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
        let text = format!(
            "--unit: expected one of {}, found `{name}`{near}",
            known.join(", ")
        );
        Stop(text, exit::USAGE)
    })
}

/// What to say when a CAD file cannot be read, and the exit code.
pub(super) fn fault(path: &Path, error: &CadError) -> Stop {
    match error {
        CadError::Read { source, .. } if source.kind() == std::io::ErrorKind::NotFound => {
            let near =
                nearest_file(path).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
            let text = format!("there is no file `{}`{near}", path.display());
            Stop(text, exit::SCENE)
        }
        CadError::Read { .. } => Stop(error.to_string(), exit::IO),
        _ => Stop(error.to_string(), exit::SCENE),
    }
}
