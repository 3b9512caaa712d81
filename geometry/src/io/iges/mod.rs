//! IGES 5.3 files (ANS US PRO/IPO-100-1996), fixed-length ASCII form.
//!
//! The layers, one file each: 80-column `records` in their sections, `params` (free-format values with their places in
//! the file), the `global` section, the `directory`, then entities: `transform` (124), `curve*` and `surfaces` (what they
//! are as NURBS), `trimmed` and `brep` (faces as the file describes them), `groups` (who holds whom, and where copies
//! stand), and `faces`, which decides what every surface entity becomes (`bridging` holds what waits for the size of the part,
//! `drawing` says what a file without surfaces is). What boundaries do to a surface is in `io::brep`.

mod base;
mod brep;
mod bridging;
mod curve;
mod curve_conic;
mod curve_offset;
mod curve_points;
mod curve_spline;
mod directory;
mod drawing;
mod faces;
mod global;
mod groups;
mod labels;
mod names;
mod number;
mod params;
mod piece;
mod records;
mod rivals;
mod surface;
mod surfaces;
mod tags;
mod transform;
mod trimmed;
mod write;

pub use super::brep::{BasePatch, ParameterMap, Reparametrise};
pub use base::{IgesCurve, IgesGeometry, IgesSurface, read_iges_geometry};
pub use names::entity_name;
pub use surfaces::{BaseSurface, Border, Unbounded};
pub use write::{IgesWriteError, write_iges};

use super::CadError;
use super::ReadOptions;
use super::brep::Grant;
use super::error::Fail;
use super::healing::{Healing, heal};
use super::report::{CadFile, CadFormat, EntityCount};
use std::collections::BTreeMap;

/// What all layers above the directory look at.
struct Model<'a> {
    sections: records::Sections<'a>,
    global: global::Global,
    entries: Vec<directory::Entry>,
    /// Hidden (blanked) surfaces are read as well.
    hidden: bool,
    /// The work and memory that a file of this length is granted.
    grant: Grant,
}

impl<'a> Model<'a> {
    /// Smallest distance that the writer tells apart, in the file's unit; `None` where it does not say.
    fn resolution(&self) -> Option<f64> {
        self.global.resolution.map(|r| r / self.global.scale)
    }

    /// The values of an entity.
    fn params(&'a self, entry: &directory::Entry) -> Result<params::Params<'a>, Fail> {
        entry.params(&self.sections, self.global.delimiters)
    }

    /// Index of the entity with directory number `pointer` in `entries`.
    fn index(&self, pointer: i64, place: (usize, usize), what: &str) -> Result<usize, Fail> {
        let index = usize::try_from(pointer)
            .ok()
            .filter(|p| p % 2 == 1)
            .map(|p| p / 2);
        index.filter(|&i| i < self.entries.len()).ok_or_else(|| {
            let last = 2 * self.entries.len();
            let expected = format!("{what}: an odd directory number from 1 to {last}");
            Fail::new(place, expected, pointer.to_string())
        })
    }

    /// The entity with directory number `pointer`.
    fn entry(
        &self,
        pointer: i64,
        place: (usize, usize),
        what: &str,
    ) -> Result<&directory::Entry, Fail> {
        Ok(&self.entries[self.index(pointer, place, what)?])
    }
}

/// Reads an IGES file. `name` stands for the file in messages.
///
/// Surfaces are read where they stand alone or carry a face (144, 143, 510), with the boundaries of the face as the
/// patch's trim, and with all matrices (124), groups (402), subfigures (308, 408), shells and solids (514, 186, 430) around
/// them. What is not read is listed as skipped, and no face is ever read without its boundaries.
///
/// # Errors
/// [`CadError::Content`] with the place of the damage. A sound file that holds no surface is no error.
pub fn read_iges(bytes: &[u8], name: &str) -> Result<CadFile, CadError> {
    read_iges_with(bytes, name, &ReadOptions::default())
}

/// Reads an IGES file as [`read_iges`] does, with options.
///
/// # Errors
/// As [`read_iges`].
pub fn read_iges_with(
    bytes: &[u8],
    name: &str,
    options: &ReadOptions,
) -> Result<CadFile, CadError> {
    read(bytes, name, options).map_err(|fail| fail.in_file(name))
}

fn read(bytes: &[u8], name: &str, options: &ReadOptions) -> Result<CadFile, Fail> {
    let mut notes = Vec::new();
    let mut model = model_of(bytes, &mut notes)?;
    model.hidden = options.hidden;
    let mut counts = BTreeMap::new();
    for entry in &model.entries {
        *counts.entry((entry.type_number, entry.form)).or_insert(0) += 1;
    }
    let entities = counts
        .into_iter()
        .map(|((type_number, form), count)| EntityCount {
            type_number,
            form,
            name: entity_name(type_number, form).to_owned(),
            count,
        })
        .collect();
    let read = faces::read(&model, &mut notes)?;
    if read.patches.is_empty() && read.skipped.is_empty() {
        notes.push(drawing::account(&model.entries));
    }
    let mut file = CadFile {
        path: name.to_owned(),
        format: CadFormat::Iges,
        unit: model.global.unit.clone(),
        resolution: model.resolution(),
        patches: read.patches,
        bodies: Vec::new(),
        entities,
        skipped: read.skipped,
        trims: read.trims,
        healing: Healing::default(),
        notes,
    };
    heal(&mut file, &model.grant);
    Ok(file)
}

/// Everything below the entities.
fn model_of<'a>(bytes: &'a [u8], notes: &mut Vec<String>) -> Result<Model<'a>, Fail> {
    let sections = records::split(bytes, notes)?;
    let global = global::read(&sections, notes)?;
    let entries = directory::read(&sections, notes)?;
    let parameter = sections.parameter.len();
    let grant = Grant::of_lines(parameter, parameter + sections.directory.len());
    Ok(Model {
        sections,
        global,
        entries,
        hidden: false,
        grant,
    })
}

/// The label of an entity, or else the name of its type.
fn describe_entity(entry: &directory::Entry) -> String {
    if entry.label.is_empty() {
        entity_name(entry.type_number, entry.form).to_owned()
    } else {
        entry.label.clone()
    }
}
