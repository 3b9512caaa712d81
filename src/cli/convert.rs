//! `covact convert`: JSON without loss, faces of IGES, or triangles.

use super::cad::{self, Stop};
use super::{ConvertArgs, exit, print, report};
use crate::output::atomic::write_through;
use covact_geometry::io::{CadFile, IgesWriteError, write_iges, write_json, write_stl};
use covact_geometry::tessellate::TessellateError;

/// Distance of triangles from the surface as a share of its size, where none is given.
const TOLERANCE: f64 = 5e-4;

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
    let ending = ending.to_lowercase();
    if ending == "stl" {
        return triangles(args, file);
    }
    if args.tolerance.is_some() {
        let text = "--tolerance is for triangles: expected a file `.stl` after --out";
        return Err(Stop(text.to_owned(), exit::USAGE));
    }
    let text = match ending.as_str() {
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
            let text =
                "STEP is read, not written: expected a file `.igs`, `.stl` or `.json` after --out";
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

/// Triangles that keep to the surface within a tolerance, as a binary STL file.
fn triangles(args: &ConvertArgs, file: CadFile) -> Result<u8, Stop> {
    let unit = file.unit.name.clone();
    let surface = file
        .into_surface()
        .map_err(|e| Stop(e.to_string(), exit::SCENE))?;
    let set = surface.set();
    let tolerance = args.tolerance.unwrap_or(TOLERANCE * set.size());
    let found = set.tessellate(tolerance).map_err(|e| {
        let code = match e {
            TessellateError::Tolerance(_) => exit::USAGE,
            _ => exit::SCENE,
        };
        Stop(format!("{}: {e}", args.file.display()), code)
    })?;
    write_through(&args.out, &write_stl(found.nodes(), found.triangles()))?;
    report::stderr(&format!(
        "{} triangles within {:.2e} {unit} of the surface, {}, in {}\n",
        found.triangles().len(),
        found.deviation(),
        match found.open_sides() {
            0 => "closed".to_owned(),
            n => format!("{n} sides at free borders"),
        },
        args.out.display()
    ));
    for &patch in found.crossed() {
        report::warning(&format!(
            "entity {}: its boundary crosses itself, so its triangles may leave gaps",
            surface.entity(patch)
        ));
    }
    Ok(0)
}
