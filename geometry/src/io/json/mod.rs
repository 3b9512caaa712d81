//! NURBS surfaces in JSON: Kratos' `*.cad.json`, geomdl's export and a lossless format of our own, told apart by their
//! keys. The first two state no length unit.

mod geomdl;
mod kratos;
mod native;
mod trims;

pub use native::write_json;

use super::error::Fail;
use super::healing::Healing;
use super::report::{CadBody, CadFile, CadFormat, CadPatch, EntityCount, Skipped, TrimReport};
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
    unit: Option<LengthUnit>,
    bodies: Vec<CadBody>,
    trims: TrimReport,
}

/// Reads a JSON file of Kratos (key `breps`), geomdl (key `shape`) or of [`write_json`] (key `covact_geometry`). `name`
/// stands for the file in messages.
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
        } else if keys.contains_key(native::KEY) {
            (CadFormat::Covact, native::read(bytes)?)
        } else {
            let names: Vec<_> = keys.keys().take(10).map(String::as_str).collect();
            let expected = "the key \"breps\" (Kratos), \"shape\" (geomdl) or \"covact_geometry\"";
            let near = keys
                .keys()
                .find_map(|k| Some((k, nearest(k, &["breps", "shape", native::KEY])?)));
            let near = near.map_or(String::new(), |(k, n)| {
                format!("; did you mean `{n}` with `{k}`?")
            });
            return Err(Fail::new(
                (1, 1),
                expected,
                format!("the keys [{}]{near}", names.join(", ")),
            ));
        };
        Ok((format, content))
    };
    let (format, content) = read().map_err(|fail| fail.in_file(name))?;
    Ok(CadFile {
        path: name.to_owned(),
        format,
        unit: content.unit.unwrap_or_else(LengthUnit::unspecified),
        resolution: content.resolution,
        patches: content.patches,
        bodies: content.bodies,
        entities: content.entities,
        skipped: content.skipped,
        trims: content.trims,
        healing: Healing::default(),
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
        let near = misspelt(text);
        let (found, wanted) = match text.split_once(", expected ") {
            Some((found, wanted)) => (found, format!("{wanted} (in {expected})")),
            None => (text, expected.to_owned()),
        };
        Fail::new(place, wanted + &near, found)
    })
}

/// What was probably meant by serde's "unknown field `a`, expected one of `b`, `c`".
fn misspelt(message: &str) -> String {
    let mut names = message
        .strip_prefix("unknown field `")
        .into_iter()
        .flat_map(|rest| rest.split('`').step_by(2));
    let near = names.next().and_then(|written| {
        let known: Vec<&str> = names.collect();
        nearest(written, &known)
    });
    near.map_or(String::new(), |n| format!("; did you mean `{n}`?"))
}

/// The name that differs least from what was written, if by no more than a third of its letters.
fn nearest<'a>(written: &str, names: &[&'a str]) -> Option<&'a str> {
    // Nobody means anything by longer names, and the table below is quadratic.
    let written: Vec<char> = written.chars().take(64).collect();
    let scored = names.iter().map(|name| {
        let letters: Vec<char> = name.chars().collect();
        (distance(&written, &letters), letters.len(), *name)
    });
    scored
        .filter(|(d, length, _)| *d <= (length / 3).max(1))
        .min_by_key(|(d, _, _)| *d)
        .map(|(_, _, name)| name)
}

/// Letters to insert, delete or replace to turn one word into the other (Levenshtein).
fn distance(a: &[char], b: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
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
