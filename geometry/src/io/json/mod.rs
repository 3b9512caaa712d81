//! NURBS surfaces in JSON: Kratos' `*.cad.json` and geomdl's export, told apart by their keys.
//!
//! Neither format states a length unit.

mod geomdl;
mod kratos;

use super::error::Fail;
use super::report::{CadFile, CadFormat, CadPatch, EntityCount, Skipped, TrimReport};
use super::{CadError, LengthUnit};
use serde::de::{DeserializeOwned, IgnoredAny};
use std::collections::BTreeMap;

/// What the reader of one format returns.
#[derive(Default)]
struct Content {
    patches: Vec<CadPatch>,
    entities: Vec<EntityCount>,
    skipped: Vec<Skipped>,
    notes: Vec<String>,
    resolution: Option<f64>,
}

/// Reads a JSON file of Kratos (key `breps`) or geomdl (key `shape`). `name` stands for the file in messages.
///
/// # Errors
/// [`CadError::Content`]. Where the JSON is sound but a surface is not (control points and knots that do not fit), line
/// and column are those of the end of that surface's object.
pub fn read_json(bytes: &[u8], name: &str) -> Result<CadFile, CadError> {
    let read = || {
        let keys: BTreeMap<String, IgnoredAny> = parse(bytes, "a JSON object")?;
        let (format, content) = if keys.contains_key("breps") {
            (CadFormat::Kratos, kratos::read(bytes)?)
        } else if keys.contains_key("shape") {
            (CadFormat::Geomdl, geomdl::read(bytes)?)
        } else {
            let keys: Vec<_> = keys.keys().take(10).map(String::as_str).collect();
            let expected = "the key \"breps\" (Kratos) or \"shape\" (geomdl)";
            return Err(Fail::new(
                (1, 1),
                expected,
                format!("the keys [{}]", keys.join(", ")),
            ));
        };
        Ok((format, content))
    };
    let (format, content) = read().map_err(|fail| fail.in_file(name))?;
    Ok(CadFile {
        path: name.to_owned(),
        format,
        unit: LengthUnit::unspecified(),
        resolution: content.resolution,
        patches: content.patches,
        entities: content.entities,
        skipped: content.skipped,
        trims: TrimReport::default(),
        notes: content.notes,
    })
}

/// Deserialises, with the place of an error.
fn parse<T: DeserializeOwned>(bytes: &[u8], expected: &str) -> Result<T, Fail> {
    serde_json::from_slice(bytes).map_err(|e| {
        let place = (e.line().max(1), e.column().max(1));
        let text = e.to_string();
        // serde_json ends its messages with the place, which stands in front of ours.
        let text = text
            .rsplit_once(" at line ")
            .map_or(text.as_str(), |(message, _)| message);
        let (found, wanted) = match text.split_once(", expected ") {
            Some((found, wanted)) => (found, format!("{wanted} (in {expected})")),
            None => (text, expected.to_owned()),
        };
        Fail::new(place, wanted, found)
    })
}

/// Counts as a list, without those that are zero.
fn counts(list: &[(&str, usize)]) -> Vec<EntityCount> {
    list.iter()
        .filter(|(_, count)| *count > 0)
        .map(|&(name, count)| EntityCount {
            type_number: 0,
            form: 0,
            name: name.to_owned(),
            count,
        })
        .collect()
}
