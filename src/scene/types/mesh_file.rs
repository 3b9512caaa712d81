//! Mesh files: hexahedra as they are, surfaces with the thickness that makes a body of them.
use schemars::JsonSchema;
use serde::de::{self, Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// A mesh file beside the scene. Its format follows from its name: `.msh` (gmsh 2.2 or 4.1), `.inp` (Abaqus, CalculiX),
/// `.bdf` or `.nas` (Nastran), `.vtk`, `.vtu`, `.stl`.
///
/// Without `thickness` the file's hexahedra are the body. With `thickness` its quadrilaterals and triangles are a surface
/// that is extruded along its normals. Such a body has the face and node sets `top` and `bottom` (the side that the
/// normals point to, and the other), `border` (all borders of the surface), `border_1`, `border_2`, ... (each border by
/// itself, the longest first), and `x_min` to `z_max` where the border lies on that side of the surface's bounding box. A
/// set `name` of the file becomes the node set `name` through the whole thickness; a set of elements also gives the face
/// sets `name_top` and `name_bottom`, a set of lines along the border the face set `name`. A quadrilateral becomes one
/// element a layer. In a surface with triangles each triangle becomes three elements and each quadrilateral four.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshFile {
    /// Path relative to the scene file.
    pub path: PathBuf,
    /// Multiplies every coordinate of the file. `thickness` is not multiplied.
    #[serde(default = "one")]
    pub scale: f64,
    /// Thickness of a surface, in the scene's unit of length: a number, one for each of some element sets of the file, or
    /// an expression of the place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<Thickness>,
    /// Where the file's surface lies in the thickness: `mid` (default), `top` or `bottom`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset: Option<Offset>,
    /// Elements through the thickness of a surface, 1 by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layers: Option<u32>,
    /// Takes only the elements of this set, part or instance of the file, so that two bodies can come from one file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub only: Option<String>,
    /// Nodes of one part of the file that lie at the same place are the two sides of a slit, and are kept apart. Without it such a
    /// mesh is refused, since most of them are borders that were not joined.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slits: bool,
}

impl MeshFile {
    /// The file at `path` with all other fields at their defaults.
    pub fn new(path: impl Into<PathBuf>) -> MeshFile {
        MeshFile {
            path: path.into(),
            scale: one(),
            thickness: None,
            offset: None,
            layers: None,
            only: None,
            slits: false,
        }
    }
}

/// Thickness of a surface mesh: a number; `{"set": number, ...}` with element sets of the file that hold every element
/// between them; or an expression such as `"1.5 - 0.01*x"` in x, y and z, the node's coordinates in the file times
/// `scale`, before `placement`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Thickness {
    /// The same everywhere.
    Uniform(f64),
    /// By the element sets of the file.
    BySet(BTreeMap<String, f64>),
    /// An expression of the place.
    Field(String),
}

impl Thickness {
    /// Variables of the expression.
    pub const VARIABLES: [&str; 3] = ["x", "y", "z"];
}

/// Where the surface of a file lies in the thickness that it gets.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Offset {
    /// Half of the thickness lies on either side.
    #[default]
    Mid,
    /// The file's surface is the top; the body lies below it, against the normals.
    Top,
    /// The file's surface is the bottom; the body lies above it, along the normals.
    Bottom,
}

// serde's own reading of untagged enums forgets where a fault was.
impl<'de> Deserialize<'de> for Thickness {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Thickness, D::Error> {
        deserializer.deserialize_any(ThicknessVisitor)
    }
}

struct ThicknessVisitor;

impl<'de> Visitor<'de> for ThicknessVisitor {
    type Value = Thickness;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, `{\"set\": number, ...}` or an expression between double quotes")
    }
    fn visit_f64<E: de::Error>(self, number: f64) -> Result<Thickness, E> {
        Ok(Thickness::Uniform(number))
    }
    fn visit_i64<E: de::Error>(self, number: i64) -> Result<Thickness, E> {
        Ok(Thickness::Uniform(number as f64))
    }
    fn visit_u64<E: de::Error>(self, number: u64) -> Result<Thickness, E> {
        Ok(Thickness::Uniform(number as f64))
    }
    fn visit_str<E: de::Error>(self, text: &str) -> Result<Thickness, E> {
        Ok(Thickness::Field(text.to_string()))
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Thickness, A::Error> {
        let mut sets = BTreeMap::new();
        while let Some((name, thickness)) = map.next_entry::<String, f64>()? {
            sets.insert(name, thickness);
        }
        Ok(Thickness::BySet(sets))
    }
}

fn one() -> f64 {
    1.0
}
