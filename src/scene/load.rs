//! Reading a scene file.
use super::check;
use super::document::{self, Document, Form};
use super::problem::{Problem, SceneError};
use super::types::{Scene, Step};
use std::ops::{Deref, DerefMut};
use std::path::Path;

/// Version of the scene format that this program reads.
pub const FORMAT: u32 = 1;

impl Form for Scene {
    const NAME: &'static str = "scene";
    const KEY: &'static str = "covact";
    const VERSION: u32 = FORMAT;
    const START: &'static str = "`covact new` writes a scene to start from";

    fn problems(&self, document: &Document) -> Vec<Problem> {
        check::problems(self, document)
    }
}

/// A scene with its text, so that everything found later can point into the file.
#[derive(Debug, Clone)]
pub struct LoadedScene {
    /// The scene.
    pub scene: Scene,
    pub(super) document: Document,
}

impl Deref for LoadedScene {
    type Target = Document;
    fn deref(&self) -> &Document {
        &self.document
    }
}

impl LoadedScene {
    /// The sizes of steps: what the scene gives, and what follows from it for the rest.
    pub fn steps(&self) -> Step {
        (self.scene.solution).steps(|key| self.has(&format!("/solution/step/{key}")))
    }

    /// Size of the first step, as long as nothing that is prescribed ends it.
    pub fn first_step(&self) -> f64 {
        let step = self.steps();
        step.initial.min(step.max).min(self.scene.solution.end_time)
    }

    /// The text with the places of everything in it.
    pub(super) fn document(&self) -> &Document {
        &self.document
    }
}

impl DerefMut for LoadedScene {
    fn deref_mut(&mut self) -> &mut Document {
        &mut self.document
    }
}

/// Reads a scene file. What needs more than the format is left to [`super::check`].
///
/// # Errors
/// [`SceneError`]: the file cannot be read, is not JSON, or does not have the form of a scene.
pub fn load(path: impl AsRef<Path>) -> Result<LoadedScene, SceneError> {
    of_file(path.as_ref())
}

/// [`load`] without a type parameter: who calls it does not compile the reading of scenes once more.
fn of_file(path: &Path) -> Result<LoadedScene, SceneError> {
    let (scene, document) = document::load::<Scene>(path)?;
    Ok(LoadedScene { scene, document })
}

/// Reads a scene from text; `name` stands for the file in messages. Paths in the scene are relative to the current
/// folder.
///
/// # Errors
/// [`SceneError::Wrong`] with all that is wrong with the form, and all that [`super::check`] finds beside it.
///
/// ```
/// use covact::scene::parse;
/// let text = r#"{
///     "covact": 1,
///     "materials": { "rubber": { "neo_hooke": { "E": 2, "nu": 0.45 } } },
///     "bodies": { "sheet": { "mesh": { "plate": { "size": [50, 40], "thickness": 1, "elements": [20, 16] } }, "material": "ruber" } },
///     "supports": { "held": { "on": "sheet.x_min", "fixed": true } }
/// }"#;
/// let wrong = parse(text, "sheet.json").map(|scene| covact::scene::check(&scene));
/// // A name that there is not, with its place and the nearest one.
/// assert!(format!("{wrong:?}").contains("rubber"));
/// let scene = parse(&text.replace("ruber", "rubber"), "sheet.json")?;
/// assert!(covact::scene::check(&scene).is_empty());
/// # Ok::<(), covact::scene::SceneError>(())
/// ```
pub fn parse(text: &str, name: &str) -> Result<LoadedScene, SceneError> {
    let (scene, document) = document::parse::<Scene>(text, name)?;
    Ok(LoadedScene { scene, document })
}
