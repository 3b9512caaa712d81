//! A CAD surface as a body.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Faces of a CAD file as a thin shell (Kirchhoff-Love): the exact surface bends, its control points are the unknowns. Every
/// face is raised to degree 3 and its knots are refined to the size asked for, which does not change its shape. Several faces are
/// joined along the edges that they have in common, whether or not their knots match.
///
/// The body has the face sets `top` (where the normal of the face points) and `bottom`, and the node sets `edge.1` (xi1 at its
/// start), `edge.2` (xi1 at its end), `edge.3` (xi2 at its start), `edge.4` and `corner.1` to `corner.4`. Of several faces these
/// sets begin with the number of the face, as in `12.edge.1` and `12.top`; edges that are joined to others all along have none,
/// `rim` holds all others, and `top` and `bottom` are those of all faces, on the side where the first one's normal points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{"required": ["size"]}, {"required": ["elements"]}]))]
pub struct NurbsSurface {
    /// CAD file: STEP (`.step`, `.stp`), IGES (`.igs`, `.iges`) or JSON; relative to the scene file.
    pub file: PathBuf,
    /// The face (STEP: instance name without `#`; IGES: directory sequence number; JSON: face id; as `covact inspect` prints
    /// them). Default: all of the file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faces: Vec<u32>,
    /// Thickness (length); the face is the mid-surface.
    pub thickness: f64,
    /// Longest side of an element (length).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<f64>,
    /// Elements along both directions of every face, in place of `size`; one for each knot span of the file at least.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elements: Option<[u32; 2]>,
    /// Membrane strains are assumed, which keeps thin curved shells from locking; `false` for the plain cubic element.
    #[serde(default = "yes")]
    pub assumed_membrane: bool,
    /// Use what the CAD system hides as well.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub hidden: bool,
}

fn yes() -> bool {
    true
}
