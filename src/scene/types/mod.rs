//! What the user writes: the scene as plain data, field for field as in the JSON file.
mod body;
mod conditions;
mod contact;
mod mesh;
mod mesh_file;
mod motion;
mod solution;
mod surface;

pub use body::*;
pub use conditions::*;
pub use contact::*;
pub use mesh::*;
pub use mesh_file::*;
pub use motion::*;
pub use solution::*;
pub use surface::*;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

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
    #[serde(default)]
    pub title: String,
    #[serde(default)]
    pub units: Units,
    /// Materials by name.
    pub materials: BTreeMap<String, Material>,
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
    #[serde(default)]
    pub solution: Solution,
    #[serde(default)]
    pub output: Output,
}

/// Units of the scene. CAD files state their own length unit and are converted to the scene's.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Units {
    /// Length unit of the scene.
    pub length: LengthUnit,
}

/// Names of length units.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum LengthUnit {
    #[serde(rename = "nm")]
    Nanometre,
    #[serde(rename = "um")]
    Micrometre,
    #[default]
    #[serde(rename = "mm")]
    Millimetre,
    #[serde(rename = "cm")]
    Centimetre,
    #[serde(rename = "m")]
    Metre,
    #[serde(rename = "km")]
    Kilometre,
    #[serde(rename = "in")]
    Inch,
    #[serde(rename = "ft")]
    Foot,
}

impl LengthUnit {
    /// Metres in one unit.
    pub fn metres(self) -> f64 {
        match self {
            LengthUnit::Nanometre => 1e-9,
            LengthUnit::Micrometre => 1e-6,
            LengthUnit::Millimetre => 1e-3,
            LengthUnit::Centimetre => 1e-2,
            LengthUnit::Metre => 1.0,
            LengthUnit::Kilometre => 1e3,
            LengthUnit::Inch => 0.0254,
            LengthUnit::Foot => 0.3048,
        }
    }

    /// Symbol, as scenes write it.
    pub fn name(self) -> &'static str {
        match self {
            LengthUnit::Nanometre => "nm",
            LengthUnit::Micrometre => "um",
            LengthUnit::Millimetre => "mm",
            LengthUnit::Centimetre => "cm",
            LengthUnit::Metre => "m",
            LengthUnit::Kilometre => "km",
            LengthUnit::Inch => "in",
            LengthUnit::Foot => "ft",
        }
    }
}
