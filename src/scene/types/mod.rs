//! What the user writes: the scene as plain data, field for field as in the JSON file.
mod body;
mod boxes;
mod conditions;
mod contact;
mod dynamics;
mod given;
mod make;
mod material;
mod mesh;
mod mesh_file;
mod metal;
mod motion;
mod mumps;
mod nurbs;
mod placement;
mod probe;
mod set_names;
mod solution;
mod stage;
mod surface;
mod units;

pub use body::*;
pub use boxes::*;
pub use conditions::*;
pub use contact::*;
pub use dynamics::*;
pub use given::{Given, MeshArrays, MeshCells};
pub use material::*;
pub use mesh::*;
pub use mesh_file::*;
pub use metal::*;
pub use motion::*;
pub use mumps::*;
pub use nurbs::*;
pub use placement::*;
pub use probe::*;
pub use set_names::*;
pub use solution::*;
pub use stage::*;
pub use surface::*;
pub use units::*;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A number or text in place of an object.
pub(in crate::scene) struct StandsFor {
    /// Type of the object.
    pub name: &'static str,
    /// The key whose value it is.
    pub key: &'static str,
    /// Numbers do as well as texts.
    pub numbers: bool,
}

/// Where a number or text may stand for an object of one key. Beside these, the only key of a choice need not be written:
/// `{"coulomb": 0.2}` is `{"coulomb": {"mu": 0.2}}`.
pub(in crate::scene) const STANDS_FOR: [StandsFor; 4] = [
    StandsFor {
        name: "Friction",
        key: "coulomb",
        numbers: true,
    },
    StandsFor {
        name: "MeshSource",
        key: "file",
        numbers: false,
    },
    StandsFor {
        name: "MeshFile",
        key: "path",
        numbers: false,
    },
    StandsFor {
        name: "CadFile",
        key: "file",
        numbers: false,
    },
];

/// Objects of `x`, `y` and `z` that may be written as a list, in which `null` stands for a key that is left out.
pub(in crate::scene) const BY_AXIS: [&str; 2] = ["Components", "FreeComponents"];

/// Choices with settings that all have defaults: the name alone will do, `"mumps"` for `{"mumps": {}}`.
pub(in crate::scene) const WITH_DEFAULTS: [&str; 1] = ["mumps"];

/// A contact problem: bodies of finite elements, rigid CAD surfaces, what presses on what, and how to solve it.
/// Units are the user's: any consistent set, e.g. N, mm, MPa.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Path or address of the JSON schema, for editors; not used otherwise.
    #[serde(rename = "$schema", default, skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// Version of the scene format: 1.
    pub covact: u32,
    /// What the scene is about; it heads reports.
    #[serde(default)]
    pub title: String,
    /// Units of the scene. CAD files state their own length unit and are converted to the scene's.
    #[serde(default)]
    pub units: Units,
    /// Materials by name.
    pub materials: BTreeMap<String, MaterialChoice>,
    /// Deformable bodies by name.
    pub bodies: BTreeMap<String, Body>,
    /// Rigid surfaces by name.
    #[serde(default)]
    pub surfaces: BTreeMap<String, Surface>,
    /// Contact pairs by name.
    #[serde(default)]
    pub contacts: BTreeMap<String, Contact>,
    /// Supports and prescribed displacements by name.
    #[serde(default)]
    pub supports: BTreeMap<String, Support>,
    /// Loads by name.
    #[serde(default)]
    pub loads: BTreeMap<String, Load>,
    /// Curves of the history, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub probes: BTreeMap<String, Probe>,
    /// Parts of the run in their order, such as forming and release; without them the run is one part.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<Stage>,
    /// How the problem is solved.
    #[serde(default)]
    pub solution: Solution,
    /// What is written.
    #[serde(default)]
    pub output: Output,
}
