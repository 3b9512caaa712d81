//! STEP files (ISO 10303-21) with shapes of AP203, AP214 and AP242.
//!
//! The layers, one file each: tokens and values (`scan`, `text`), the file and where its instances stand (`exchange`),
//! instances with attributes by type and number (`schema`, `entity`). On these stand geometry (`place`, `units`, `curve*`,
//! `spline`, `profile`, `surface*`), faces with what bounds them (`bounds`, `face`), bodies (`shells`), products and where they stand
//! (`assembly`, `copies`), what is shown and how (`labels`, `hidden`), and `bodies`, which decides what every face becomes.

mod assembly;
mod bodies;
mod bounds;
mod capitals;
mod copies;
mod curve;
mod curve_read;
mod entity;
mod exchange;
mod face;
mod hidden;
mod labels;
mod place;
mod profile;
mod scan;
mod schema;
mod scope;
mod shells;
mod spline;
mod surface;
mod surface_read;
mod text;
mod units;

use super::error::Fail;
use super::healing::{Healing, heal};
use super::report::{CadFile, CadFormat, EntityCount};
use super::{CadError, ReadOptions, ReadProgress};
use capitals::capitals;
use exchange::Exchange;
use std::collections::BTreeMap;

/// Whether a file begins as STEP files do: comments may come first.
pub fn is_step(bytes: &[u8]) -> bool {
    let mut scan = scan::Scanner::new(bytes, 0);
    let start = scan.keyword("").ok();
    start.is_some_and(|start| start.eq_ignore_ascii_case(b"ISO-10303-21"))
}

/// Reads a STEP file. `name` stands for the file in messages.
///
/// Solids with their voids, shells, faces and single surfaces become patches, every one trimmed by the bounds of its face, with
/// the normal that the face has in its body, and where the assembly puts it. A face that is not read is listed as skipped, and
/// none is ever read without its bounds.
///
/// # Errors
/// [`CadError::Content`] with the place where the structure of the file is damaged. Wrong values and references cost the faces
/// that need them; a sound file that holds no surface is no error.
pub fn read_step(bytes: &[u8], name: &str) -> Result<CadFile, CadError> {
    read_step_with(bytes, name, &ReadOptions::default())
}

/// Reads a STEP file as [`read_step`] does, with options.
///
/// # Errors
/// As [`read_step`].
pub fn read_step_with(
    bytes: &[u8],
    name: &str,
    options: &ReadOptions,
) -> Result<CadFile, CadError> {
    read_step_watched(bytes, name, options, &mut |_| {})
}

/// Reads a STEP file as [`read_step_with`] does and calls `watch` after every face.
///
/// # Errors
/// As [`read_step`].
pub fn read_step_watched(
    bytes: &[u8],
    name: &str,
    options: &ReadOptions,
    watch: &mut dyn FnMut(ReadProgress),
) -> Result<CadFile, CadError> {
    read(bytes, name, options, watch).map_err(|fail| fail.in_file(name))
}

fn read(
    bytes: &[u8],
    name: &str,
    options: &ReadOptions,
    watch: &mut dyn FnMut(ReadProgress),
) -> Result<CadFile, Fail> {
    let mut exchange = Exchange::read(bytes)?;
    let mut notes = Vec::new();
    let upper;
    if exchange.small_letters {
        upper = capitals(bytes);
        exchange = Exchange::read(&upper)?;
        notes.push("types of instances in small letters were read as if in capitals".to_owned());
    }
    if let Some(end) = exchange.unended {
        notes.push(format!("{end} is missing"));
    }
    let read = bodies::read(&exchange, options, &mut notes, watch);
    let mut file = CadFile {
        path: name.to_owned(),
        format: CadFormat::Step,
        unit: read.units.length,
        resolution: read.units.uncertainty,
        patches: read.patches,
        bodies: read.bodies,
        entities: counts(&exchange),
        skipped: read.skipped,
        trims: read.trims,
        healing: Healing::default(),
        notes,
    };
    heal(&mut file, &read.grant);
    Ok(file)
}

/// How often each type of entity occurs.
fn counts(exchange: &Exchange) -> Vec<EntityCount> {
    let mut counts: BTreeMap<Vec<&[u8]>, usize> = BTreeMap::new();
    for index in 0..exchange.len() as u32 {
        *counts.entry(exchange.keywords(index)).or_insert(0) += 1;
    }
    let counts = counts.into_iter().map(|(keywords, count)| EntityCount {
        type_number: 0,
        form: 0,
        name: entity::kind_of(keywords.into_iter()),
        count,
    });
    counts.collect()
}

/// The number by which reports name an instance: that of its name, or its place in the file from 1 where names do not fit.
fn number_of(exchange: &Exchange, index: u32) -> u32 {
    match u32::try_from(exchange.largest_name()) {
        Ok(_) => exchange.name(index) as u32,
        Err(_) => index + 1,
    }
}
