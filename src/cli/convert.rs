//! `covact convert`: JSON without loss, or faces of IGES.
use super::cad::{self, Stop};
use super::{ConvertArgs, exit, print, report};
use crate::output::atomic::write_through;
use covact_geometry::io::{IgesWriteError, write_iges, write_json};

pub(super) fn convert(args: &ConvertArgs) -> u8 {
    let done = run(args);
    done.unwrap_or_else(|Stop(text, code)| {
        report::error(&text);
        code
    })
}

fn run(args: &ConvertArgs) -> Result<u8, Stop> {
    let file = cad::read(&args.file, args.unit.as_deref())?;
    let ending = args.out.extension().unwrap_or_default().to_string_lossy();
    let text = match ending.to_lowercase().as_str() {
        "igs" | "iges" => write_iges(&file).map_err(|e| {
            let help = match e {
                IgesWriteError::Unit { .. } | IgesWriteError::UnknownUnit { .. } => {
                    "; --unit names one, for instance `--unit mm`"
                }
                _ => "",
            };
            Stop(format!("{e}{help}"), exit::SCENE)
        })?,
        "step" | "stp" => {
            let text = "STEP is read, not written: expected a file `.igs` or `.json` after --out";
            return Err(Stop(text.to_owned(), exit::USAGE));
        }
        _ => write_json(&file)
            .map_err(|e| Stop(format!("cannot write the patches as JSON: {e}"), exit::BUG))?,
    };
    if args.out.as_os_str() == "-" {
        return Ok(print(&text));
    }
    write_through(&args.out, text.as_bytes())?;
    let count = file.summary();
    report::stderr(&format!(
        "{} patch{} ({} trimmed), unit {}, in {}\n",
        count.patches,
        if count.patches == 1 { "" } else { "es" },
        count.trimmed,
        file.unit.name,
        args.out.display()
    ));
    Ok(0)
}
