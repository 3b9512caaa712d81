//! Scenes made in a program, checked as those of files are.
use super::LoadedScene;
use super::check;
use super::document::{self, pointer};
use super::load::FORMAT;
use super::problem::SceneError;
use super::types::*;
use serde::Serialize;
use serde_json::Value as Json;
use std::collections::BTreeMap;

/// Puts a scene together, part by part. Parts refer to each other by name, in any order; whatever is wrong is found by
/// [`Self::build`], or when the model is built, and is told with the JSON pointer of the field at fault, e.g.
/// `/contacts/press/slave`.
///
/// ```
/// use covact::scene::{Block, Body, Elastic, MaterialChoice, SceneBuilder, Support};
/// let block = Block { min: [0.0; 3], max: [1.0; 3], elements: [2; 3], spacing: Default::default() };
/// let scene = SceneBuilder::new("A block pulled by a tenth")
///     .material("rubber", MaterialChoice::NeoHooke(Elastic::new(5.0, 0.4)))
///     .body("block", Body::new(block, "rubber"))
///     .support("below", Support::fixed("block.bottom"))
///     .support("above", Support::displacement("block.top", [None, None, Some("0.1*t".into())]))
///     .build()?;
/// # Ok::<(), covact::scene::SceneError>(())
/// ```
#[derive(Debug, Clone)]
#[must_use]
pub struct SceneBuilder {
    scene: Scene,
    /// Pointers of names that were given twice.
    repeated: Vec<String>,
}

/// Adds a part under its name.
fn add<T>(
    section: &str,
    parts: &mut BTreeMap<String, T>,
    (name, part): (String, T),
    repeated: &mut Vec<String>,
) {
    let at = pointer(&[section, &name]);
    if parts.insert(name, part).is_some() {
        repeated.push(at);
    }
}

macro_rules! parts {
    ($($(#[$doc:meta])* $method:ident: $section:ident of $type:ty;)*) => {
        $($(#[$doc])*
        pub fn $method(mut self, name: impl Into<String>, part: impl Into<$type>) -> Self {
            let named = (name.into(), part.into());
            add(stringify!($section), &mut self.scene.$section, named, &mut self.repeated);
            self
        })*
    };
}

impl SceneBuilder {
    /// An empty scene.
    pub fn new(title: impl Into<String>) -> Self {
        SceneBuilder {
            scene: Scene {
                schema: None,
                covact: FORMAT,
                title: title.into(),
                units: Units::default(),
                materials: BTreeMap::new(),
                bodies: BTreeMap::new(),
                surfaces: BTreeMap::new(),
                contacts: BTreeMap::new(),
                supports: BTreeMap::new(),
                loads: BTreeMap::new(),
                probes: BTreeMap::new(),
                stages: Vec::new(),
                solution: Solution::default(),
                output: Output::default(),
            },
            repeated: Vec::new(),
        }
    }

    parts! {
        /// Adds a material.
        material: materials of MaterialChoice;
        /// Adds a deformable body.
        body: bodies of Body;
        /// Adds a rigid surface: a shape, a CAD file, or NURBS patches.
        surface: surfaces of Surface;
        /// Adds a contact.
        contact: contacts of Contact;
        /// Adds a support.
        support: supports of Support;
        /// Adds a load.
        load: loads of Load;
        /// Adds a probe.
        probe: probes of Probe;
    }

    /// The units of all numbers; materials that are taken by name need them.
    pub fn units(mut self, units: Units) -> Self {
        self.scene.units = units;
        self
    }

    /// Adds a stage behind those that there are.
    pub fn stage(mut self, stage: Stage) -> Self {
        self.scene.stages.push(stage);
        self
    }

    /// How the problem is solved.
    pub fn solution(mut self, solution: Solution) -> Self {
        self.scene.solution = solution;
        self
    }

    /// What sinks write.
    pub fn output(mut self, output: Output) -> Self {
        self.scene.output = output;
        self
    }

    /// Checks the scene. Paths of files in it are relative to the current folder.
    ///
    /// # Errors
    /// [`SceneError::Wrong`] with all that is wrong; places are those in [`LoadedScene::text`](super::Document::text), the
    /// scene as a file would hold it.
    pub fn build(self) -> Result<LoadedScene, SceneError> {
        let SceneBuilder { scene, repeated } = self;
        let json = brief(&scene);
        let text = serde_json::to_string_pretty(&json).unwrap_or_default();
        let name = match scene.title.as_str() {
            "" => "scene",
            title => title,
        };
        let document = document::of_program::<Scene>(&text, name)?;
        let mut problems = check::problems(&scene, &document);
        problems.extend(repeated.iter().map(|at| {
            let message = "two parts of the scene have this name".to_owned();
            document.problem(at, message, Some("choose another name".to_owned()))
        }));
        match problems.is_empty() {
            true => Ok(LoadedScene { scene, document }),
            false => Err(document.error(problems)),
        }
    }
}

/// The scene as JSON without what is as by default: as somebody would write it.
fn brief(scene: &Scene) -> Json {
    let whole = json(scene);
    let mut brief = whole.clone();
    without(&mut brief, &json(&SceneBuilder::new("").scene));
    let parts = [
        ("bodies", json(&Body::new(MeshArrays::default(), ""))),
        ("surfaces", json(&Surface::default())),
        ("contacts", json(&Contact::new("", ""))),
        ("supports", json(&Support::on(""))),
        ("loads", json(&Load::on(""))),
    ];
    for (section, default) in parts {
        let parts = brief.get_mut(section).and_then(Json::as_object_mut);
        for part in parts.into_iter().flat_map(|parts| parts.values_mut()) {
            without(part, &default);
        }
    }
    // What every file has, and units, which are given as a whole.
    let mut always = vec!["covact", "materials", "bodies"];
    always.extend(brief.get("units").map(|_| "units"));
    if let Some(brief) = brief.as_object_mut() {
        for key in always {
            let value = (brief.get(key)).filter(|_| key != "units");
            if value.is_none() {
                brief.insert(key.to_owned(), whole[key].clone());
            }
        }
    }
    brief
}

/// Numbers that are not finite become null, which nobody reads: the check looks at the scene itself.
fn json(value: &impl Serialize) -> Json {
    serde_json::to_value(value).unwrap_or_default()
}

/// Takes from an object what is as in `default`.
fn without(json: &mut Json, default: &Json) {
    let (Json::Object(json), Json::Object(default)) = (json, default) else {
        return;
    };
    json.retain(|key, value| default.get(key) != Some(value));
    for (key, value) in json.iter_mut() {
        if let Some(default) = default.get(key) {
            without(value, default);
        }
    }
}
