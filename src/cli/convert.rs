//! `covact convert`.
use super::cad::{self, Stop};
use super::{ConvertArgs, exit, print, report};
use crate::output::atomic::write_through;
use covact_geometry::io::write_json;

pub(super) fn convert(args: &ConvertArgs) -> u8 {
    let done = run(args);
    done.unwrap_or_else(|Stop(text, code)| {
        report::error(&text);
        code
    })
}

fn run(args: &ConvertArgs) -> Result<u8, Stop> {
    let file = cad::read(&args.file, args.unit.as_deref())?;
    let text = write_json(&file)
        .map_err(|e| Stop(format!("cannot write the patches as JSON: {e}"), exit::BUG))?;
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
