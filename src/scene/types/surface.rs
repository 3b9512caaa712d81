//! Rigid surfaces: CAD files and exact shapes, facets in their place, where they are and which side is outside.
use super::given::Given;
use super::motion::Motion;
use super::placement::Placement;
use covact_geometry::NurbsPatch;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A rigid surface: exactly one of `cad`, `sphere`, `cylinder`, `plane`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(extend("oneOf" = [{"required": ["cad"]}, {"required": ["sphere"]}, {"required": ["cylinder"]}, {"required": ["plane"]}]))]
pub struct Surface {
    /// NURBS patches from a CAD file, or triangles from an STL file.
    pub cad: Option<CadFile>,
    /// Exact sphere.
    pub sphere: Option<SphereShape>,
    /// Exact circular cylinder.
    pub cylinder: Option<CylinderShape>,
    /// Flat rectangle.
    pub plane: Option<PlaneShape>,
    /// NURBS patches that a program gives, in the units of the scene; a scene file names a CAD file in their place.
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub patches: Option<Given<Vec<NurbsPatch>>>,
    /// Facets in place of the exact surface; default: none, the surface is used as it is.
    pub facets: Option<Facets>,
    /// Placement: first rotated, then moved.
    pub placement: Placement,
    /// Which side is outside.
    pub side: Side,
    /// A point deeper than this below the surface is not in contact (length); default: a tenth of the surface's size.
    pub depth: Option<f64>,
    /// Rigid motion over time.
    pub motion: Motion,
}

/// A CAD file: STEP (`.step`, `.stp`), IGES (`.igs`, `.iges`), JSON (Kratos `.cad.json`, geomdl, `covact convert`), or
/// STL, whose triangles are facets already.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CadFile {
    /// Path relative to the scene file.
    pub file: PathBuf,
    /// Use only these entities (STEP: instance names without `#`; IGES: directory sequence numbers; JSON: face ids; as
    /// `covact inspect` prints them). Default: all.
    #[serde(default)]
    pub entities: Vec<u32>,
    /// Use only the bodies of these names, or all of the products and assemblies of these names (STEP; `covact inspect`
    /// lists them). Default: all.
    #[serde(default)]
    pub bodies: Vec<String>,
    /// Go on although the file holds surfaces that cannot be read (they are reported).
    #[serde(default)]
    pub allow_skipped: bool,
    /// Use what the CAD system hides (blanked entities of IGES, invisible items and layers of STEP) as well; otherwise it
    /// counts as not read.
    #[serde(default)]
    pub hidden: bool,
    /// Edges of patches closer than this are the same edge (length), in an STL file vertices; default from the file's own
    /// resolution.
    #[serde(default)]
    pub tolerance: Option<f64>,
}

/// Facets in place of an exact surface, with nodes that lie on it: their kind and exactly one of `chord`, `size`, `count`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{"required": ["chord"]}, {"required": ["size"]}, {"required": ["count"]}]))]
pub struct Facets {
    /// Kind of facets.
    pub kind: FacetKind,
    /// Largest distance from the exact surface (length); with `smooth` that of the quadrilaterals between its nodes.
    #[serde(default)]
    pub chord: Option<f64>,
    /// Longest edge of a facet (length).
    #[serde(default)]
    pub size: Option<f64>,
    /// Facets along both directions of every patch, one for each of its spans at least.
    #[serde(default)]
    pub count: Option<[u32; 2]>,
}

/// What facets are like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FacetKind {
    /// Four nodes, as the faces of linear elements.
    Bilinear,
    /// Nine nodes, as the faces of quadratic elements.
    Biquadratic,
    /// One smooth surface of bicubic patches over quadrilaterals.
    Smooth,
}

impl FacetKind {
    /// As scenes write it.
    pub fn name(self) -> &'static str {
        match self {
            FacetKind::Bilinear => "bilinear",
            FacetKind::Biquadratic => "biquadratic",
            FacetKind::Smooth => "smooth",
        }
    }
}

/// An exact sphere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereShape {
    /// Radius.
    pub radius: f64,
    /// Centre of the sphere; also written `origin`.
    #[serde(default, alias = "origin")]
    pub center: [f64; 3],
    /// Axis through the poles of the parametrisation; default y.
    #[serde(default = "axis_y")]
    pub axis: [f64; 3],
}

/// An exact circular cylinder without its ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderShape {
    /// Radius.
    pub radius: f64,
    /// Length along the axis.
    pub length: f64,
    /// Centre of the cylinder, in the middle of its length; also written `origin`.
    #[serde(default, alias = "origin")]
    pub center: [f64; 3],
    /// Direction of the axis, of any length; default y.
    #[serde(default = "axis_y")]
    pub axis: [f64; 3],
}

/// A flat rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneShape {
    /// Middle of the rectangle.
    #[serde(default)]
    pub center: [f64; 3],
    /// Normal, of any length; default z.
    #[serde(default = "axis_z")]
    pub normal: [f64; 3],
    /// Edge lengths of the rectangle.
    pub size: [f64; 2],
}

/// Which side of a rigid surface is outside (where the bodies are).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Where the slave faces start.
    #[default]
    Auto,
    /// The side of rho_1 x rho_2 of the first patch in the file (the others follow over shared edges).
    AsGiven,
    /// The opposite of `as_given`.
    Reversed,
    /// Away from what the surface encloses or curves around, each connected part by itself: bodies lie outside of a pin.
    Outward,
    /// Towards what the surface encloses or curves around, each connected part by itself: bodies lie inside of a bore.
    Inward,
    /// The side on which this point lies.
    Point([f64; 3]),
}

fn axis_y() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn axis_z() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}
