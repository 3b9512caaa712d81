//! Levels and colours of entities, which stand for layers and colours of CAD systems.

use super::super::error::Fail;
use super::super::report::CadTags;
use super::Model;
use super::directory::Entry;

/// Colours that have numbers, from 1.
const COLOURS: [&str; 8] = [
    "black", "red", "green", "blue", "yellow", "magenta", "cyan", "white",
];

/// Level and colour of a face; what points to nothing of use gives none.
pub fn tags(model: &Model, entry: &Entry) -> CadTags {
    CadTags {
        body: None,
        layer: layer(model, entry),
        colour: colour(model, entry),
    }
}

/// The entity that a negative number of a directory field points to, if it is of that type.
fn pointed<'a>(model: &'a Model, field: i64, type_number: u32) -> Option<&'a Entry> {
    let number = usize::try_from(field.checked_neg()?).ok()?;
    let entry = model.entries.get(number.checked_sub(1)? / 2)?;
    (number % 2 == 1 && entry.type_number == type_number).then_some(entry)
}

fn layer(model: &Model, entry: &Entry) -> Option<String> {
    if entry.level >= 0 {
        return (entry.level > 0).then(|| entry.level.to_string());
    }
    let property = pointed(model, entry.level, 406).filter(|e| e.form == 1)?;
    let levels = || -> Result<Vec<String>, Fail> {
        let params = model.params(property)?;
        let count = params.count(1, "a number of levels")?;
        let count = count.min(params.len().saturating_sub(2));
        (0..count)
            .map(|k| Ok(params.integer(2 + k, "a level")?.to_string()))
            .collect()
    };
    let levels = levels().ok()?;
    (!levels.is_empty()).then(|| levels.join(","))
}

fn colour(model: &Model, entry: &Entry) -> Option<String> {
    if entry.colour >= 0 {
        let number = usize::try_from(entry.colour).ok()?.checked_sub(1)?;
        return COLOURS.get(number).map(|&name| name.to_owned());
    }
    let definition = pointed(model, entry.colour, 314)?;
    let params = model.params(definition).ok()?;
    let name = params.string(4, "the name of a colour").ok().flatten();
    if let Some(name) = name.filter(|name| !name.trim().is_empty()) {
        return Some(name.trim().to_owned());
    }
    let mut text = "#".to_owned();
    for k in 1..=3 {
        // Percent of the full intensity.
        let share = params.real(k, "the intensity of a colour").ok()? / 100.0;
        let byte = (255.0 * share.clamp(0.0, 1.0)).round() as u8;
        text.push_str(&format!("{byte:02x}"));
    }
    Some(text)
}
