//! Reading a study file.
use super::file::Study;
use crate::scene::{Document, Form, SceneError, load_document, parse_document, printed_schema};
use std::ops::{Deref, DerefMut};
use std::path::Path;

/// Version of the study format that this program reads.
pub const FORMAT: u32 = 1;

impl Form for Study {
    const NAME: &'static str = "study";
    const KEY: &'static str = "covact_study";
    const VERSION: u32 = FORMAT;
    const START: &'static str = "a study names a scene, and what to vary in it";
}

/// A study with its text, so that everything found later can point into the file.
#[derive(Debug, Clone)]
pub struct LoadedStudy {
    /// The study.
    pub study: Study,
    document: Document,
}

impl Deref for LoadedStudy {
    type Target = Document;
    fn deref(&self) -> &Document {
        &self.document
    }
}

impl DerefMut for LoadedStudy {
    fn deref_mut(&mut self) -> &mut Document {
        &mut self.document
    }
}

/// Reads a study file. What needs more than the format is left to [`super::expand`].
///
/// # Errors
/// [`SceneError`]: the file cannot be read, is not JSON, or does not have the form of a study.
pub fn load(path: impl AsRef<Path>) -> Result<LoadedStudy, SceneError> {
    of_file(path.as_ref())
}

/// [`load`] without a type parameter, as for scenes.
fn of_file(path: &Path) -> Result<LoadedStudy, SceneError> {
    let (study, document) = load_document::<Study>(path)?;
    Ok(LoadedStudy { study, document })
}

/// Reads a study from text; `name` stands for the file in messages. Paths in it are relative to the current folder.
///
/// # Errors
/// As [`load`], but for the file.
pub fn parse(text: &str, name: &str) -> Result<LoadedStudy, SceneError> {
    let (study, document) = parse_document::<Study>(text, name)?;
    Ok(LoadedStudy { study, document })
}

/// The JSON schema of studies, pretty-printed with a line break at its end.
pub fn schema() -> String {
    printed_schema(schemars::schema_for!(Study))
}
