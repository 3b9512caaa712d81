//! What the user writes: the scene as plain data, field for field as in the JSON file.
use super::value::Value;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

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

/// Constitutive law, written `{"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}}`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Material {
    /// Linear law between Green-Lagrange strain and second Piola-Kirchhoff stress: large rotations, small strains.
    StVenantKirchhoff(Elastic),
    /// Compressible neo-Hooke: large strains.
    NeoHooke(Elastic),
}

/// Young's modulus (force / length^2) and Poisson's ratio.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Elastic {
    #[serde(rename = "E")]
    pub e: f64,
    pub nu: f64,
}

/// A deformable body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    pub mesh: MeshSource,
    /// Name of the material.
    pub material: String,
    #[serde(default)]
    pub element: Element,
    /// Further node and face sets, selected by geometry.
    #[serde(default)]
    pub sets: BTreeMap<String, Selection>,
}

/// Element formulation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Element {
    /// 8-node solid-shell: assumed transverse shear and thickness strains, seven enhanced strains.
    #[default]
    H8,
    /// 8-node brick without assumed or enhanced strains (locks when thin; for solids and comparisons).
    H8Displacement,
}

/// Where a body's mesh comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeshSource {
    /// Flat plate; the thickness is along z.
    Plate(Plate),
    /// Part of a cylinder about the y axis; the thickness is radial.
    CylinderPanel(CylinderPanel),
    /// Part of a sphere about the origin; the thickness is radial.
    SpherePanel(SpherePanel),
    /// Box of elements with grading along each axis; layers along z.
    Block(Block),
    /// Mesh file: gmsh `.msh` 4.1 with physical names, or a subset of Abaqus `.inp`.
    File(MeshFile),
}

/// Plate `[x0, x0+lx] x [y0, y0+ly]`, mid-surface at `z0`. Face sets `top` (z max), `bottom`, `x_min`, `x_max`,
/// `y_min`, `y_max`; node sets of the same names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plate {
    /// Lengths along x and y.
    pub size: [f64; 2],
    pub thickness: f64,
    /// Elements along x and y.
    pub elements: [u32; 2],
    /// Elements through the thickness.
    #[serde(default = "one")]
    pub layers: u32,
    /// Corner (x0, y0) and height z0 of the mid-surface.
    #[serde(default)]
    pub origin: [f64; 3],
    /// Spacing of the nodes along x and y.
    #[serde(default)]
    pub spacing: [Spacing; 2],
}

/// Panel of a cylinder about the y axis: `x = r sin(phi)`, `z = r cos(phi)`, phi from `angles[0]` to `angles[1]` in
/// degrees, y from `y[0]` to `y[1]`. Face and node sets `outer`, `inner`, `phi_min`, `phi_max`, `y_min`, `y_max`
/// (a full turn is closed and has no phi sets).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderPanel {
    /// Radius of the mid-surface.
    pub radius: f64,
    pub thickness: f64,
    /// Degrees.
    pub angles: [f64; 2],
    pub y: [f64; 2],
    /// Elements along phi and y.
    pub elements: [u32; 2],
    #[serde(default = "one")]
    pub layers: u32,
    /// Position of the cylinder's centre.
    #[serde(default)]
    pub origin: [f64; 3],
}

/// Panel of a sphere about `origin`, with its poles on the y axis and longitude counted from z towards x: longitude from `longitude[0]` to `[1]`, latitude from `latitude[0]` to `[1]`, both
/// in degrees. Face and node sets `outer`, `inner`, `longitude_min`, `longitude_max`, `latitude_min`, `latitude_max`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpherePanel {
    /// Radius of the mid-surface.
    pub radius: f64,
    pub thickness: f64,
    pub longitude: [f64; 2],
    pub latitude: [f64; 2],
    /// Elements along longitude and latitude.
    pub elements: [u32; 2],
    #[serde(default = "one")]
    pub layers: u32,
    #[serde(default)]
    pub origin: [f64; 3],
}

/// Box from `min` to `max`. Face and node sets `x_min` ... `z_max`, and `bottom`, `top` for z.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Block {
    pub min: [f64; 3],
    pub max: [f64; 3],
    /// Elements along x, y and z.
    pub elements: [u32; 3],
    /// Spacing of the nodes along each axis.
    #[serde(default)]
    pub spacing: [Spacing; 3],
}

/// How nodes are spaced along an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Spacing {
    #[default]
    Uniform,
    /// Every element is `ratio` times as long as the one before it.
    Geometric { ratio: f64 },
    /// `fine` equal elements over `length` at the start of the axis (`from_end: true`: at its end), the rest growing
    /// geometrically with the ratio that fills the axis.
    Fine {
        length: f64,
        fine: u32,
        #[serde(default)]
        from_end: bool,
    },
}

/// A mesh file beside the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshFile {
    /// Path relative to the scene file.
    pub path: PathBuf,
    /// Multiplies every coordinate.
    #[serde(default = "one_f64")]
    pub scale: f64,
}

/// Set selected by geometry, on the undeformed mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Selection {
    /// Nodes inside a box (its borders included).
    NodesInBox { min: [f64; 3], max: [f64; 3] },
    /// Nodes within `tolerance` of a plane.
    NodesNearPlane {
        point: [f64; 3],
        normal: [f64; 3],
        tolerance: f64,
    },
    /// Nodes within `tolerance` of a point.
    NodesNearPoint { point: [f64; 3], tolerance: f64 },
    /// Outer faces whose nodes all lie inside a box.
    FacesInBox { min: [f64; 3], max: [f64; 3] },
    /// Outer faces whose outward normal is within `angle` degrees of `normal`.
    FacesFacing { normal: [f64; 3], angle: f64 },
}

/// A rigid surface: exactly one of `cad`, `sphere`, `cylinder`, `plane`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(extend("oneOf" = [{"required": ["cad"]}, {"required": ["sphere"]}, {"required": ["cylinder"]}, {"required": ["plane"]}]))]
pub struct Surface {
    /// NURBS patches from a CAD file.
    pub cad: Option<CadFile>,
    /// Exact sphere.
    pub sphere: Option<SphereShape>,
    /// Exact circular cylinder.
    pub cylinder: Option<CylinderShape>,
    /// Flat rectangle.
    pub plane: Option<PlaneShape>,
    /// Placement: first rotated, then moved.
    pub placement: Placement,
    /// Which side is outside.
    pub side: Side,
    /// A point deeper than this below the surface is not in contact (length); default: a tenth of the surface's size.
    pub depth: Option<f64>,
    pub motion: Motion,
}

/// A CAD file: IGES (`.igs`, `.iges`) or JSON (Kratos `.cad.json`, geomdl).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CadFile {
    /// Path relative to the scene file.
    pub file: PathBuf,
    /// Use only these entities (IGES: directory sequence numbers, as `covact inspect` prints them; JSON: face ids).
    /// Default: all.
    #[serde(default)]
    pub entities: Vec<u32>,
    /// Go on although the file holds surfaces that cannot be read (they are reported).
    #[serde(default)]
    pub allow_skipped: bool,
    /// Edges of patches closer than this are the same edge (length); default from the file's own resolution.
    #[serde(default)]
    pub tolerance: Option<f64>,
}

/// An exact sphere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereShape {
    pub radius: f64,
    #[serde(default)]
    pub center: [f64; 3],
    /// Axis through the poles of the parametrisation; default y.
    #[serde(default = "axis_y")]
    pub axis: [f64; 3],
}

/// An exact circular cylinder without its ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderShape {
    pub radius: f64,
    pub length: f64,
    /// Centre of the cylinder, in the middle of its length.
    #[serde(default)]
    pub center: [f64; 3],
    #[serde(default = "axis_y")]
    pub axis: [f64; 3],
}

/// A flat rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneShape {
    #[serde(default)]
    pub center: [f64; 3],
    #[serde(default = "axis_z")]
    pub normal: [f64; 3],
    /// Edge lengths of the rectangle.
    pub size: [f64; 2],
}

/// Rigid placement of a surface before it moves, with an optional scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Placement {
    /// Multiplies every coordinate of the file (after its units were converted).
    pub scale: f64,
    /// Rotation axis through the origin.
    pub axis: [f64; 3],
    /// Degrees.
    pub angle: f64,
    pub translation: [f64; 3],
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
    /// The side on which this point lies.
    Point([f64; 3]),
}

/// Prescribed rigid motion: translation (x, y, z) added to a rotation about an axis.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Motion {
    /// Displacement as numbers, tables or expressions in `t`.
    pub translation: [Value; 3],
    pub rotation: Option<Rotation>,
}

/// Rotation about an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// A point of the axis; it moves with the translation.
    #[serde(default)]
    pub center: [f64; 3],
    pub axis: [f64; 3],
    /// Angle in degrees.
    pub angle: Value,
}

/// A contact pair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Face set of a body, `body.set`.
    pub slave: String,
    /// Name of a rigid surface.
    pub master: String,
    #[serde(default)]
    pub points: Points,
    #[serde(default)]
    pub penalty: Penalty,
    #[serde(default)]
    pub tangent: Tangent,
}

/// Where contact is sampled on the slave faces.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Points {
    /// Nodes, each with its tributary area.
    #[default]
    Nodes,
    /// Gauss points, this many along each direction of a face (1 to 10).
    Gauss(u8),
    /// Lobatto points, this many along each direction of a face (2 to 10).
    Lobatto(u8),
}

/// Normal penalty: pressure per penetration (force / length^3).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Penalty {
    /// From the stiffness of the slave's elements; its value is printed.
    #[default]
    Auto,
    /// Given value.
    Value(f64),
    /// This multiple of the automatic value.
    Scaled(f64),
}

/// Tangent matrix of contact.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Tangent {
    /// Consistent at every penetration.
    #[default]
    Exact,
    /// The published form, whose parts beyond the main one can be left out.
    Published {
        #[serde(default = "yes")]
        rotational: bool,
        #[serde(default = "yes")]
        curvature: bool,
    },
}

/// A support: exactly one of `fixed`, `symmetry`, `displacement`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Node or face set, `body.set`.
    pub on: String,
    /// All three components are zero.
    #[serde(default)]
    pub fixed: bool,
    /// The displacement along this axis is zero.
    #[serde(default)]
    pub symmetry: Option<Axis>,
    /// Prescribed components.
    #[serde(default)]
    pub displacement: Option<Components>,
    /// Acts on the mean of both faces of the shell (the mid-surface), which leaves rotation and thickness free: with
    /// all three components a hinge that holds its place, with one a soft support.
    #[serde(default)]
    pub mid_surface: bool,
}

/// A coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    X,
    Y,
    Z,
}

/// Components of a displacement; what is not named stays free. Expressions may use x, y, z (undeformed) and t.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Components {
    pub x: Option<Value>,
    pub y: Option<Value>,
    pub z: Option<Value>,
}

/// A load: exactly one of `force`, `traction`, `pressure`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{"required": ["force"]}, {"required": ["traction"]}, {"required": ["pressure"]}]))]
pub struct Load {
    /// Node or face set, `body.set` (traction and pressure need faces).
    pub on: String,
    /// Total force, spread evenly over the nodes of a node set, over the area of a face set.
    #[serde(default)]
    pub force: Option<[Value; 3]>,
    /// Force per undeformed area, of constant direction. Expressions may use x, y, z and t.
    #[serde(default)]
    pub traction: Option<[Value; 3]>,
    /// Pressure against the outward normal (force / area). Expressions may use x, y, z and t; those of a follower t.
    #[serde(default)]
    pub pressure: Option<Value>,
    /// The pressure follows the deformed faces (their area and normal).
    #[serde(default)]
    pub follower: bool,
}

/// How the problem is solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solution {
    /// The run goes from time 0 to this time.
    pub end_time: f64,
    /// Times at which a step must end, ascending; steps end at the rows of tables in any case.
    pub stops: Vec<f64>,
    pub step: Step,
    pub newton: Newton,
    pub linear_solver: LinearSolver,
    /// Threads; 0 takes what the machine has.
    pub threads: u32,
}

/// Step sizes, in time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Step {
    /// First step.
    pub initial: f64,
    /// A step that would have to be smaller ends the run as not converged.
    pub min: f64,
    pub max: f64,
    /// Adapt the step to the iterations it takes; a step that fails is cut in any case.
    pub adaptive: bool,
}

/// Newton's method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Newton {
    /// Iterations a step may take before it is cut.
    pub max_iterations: u32,
    /// Residual relative to the largest force in the system, or to its round-off floor where that is higher.
    pub tolerance: f64,
    pub line_search: bool,
}

/// Factorization.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LinearSolver {
    /// Cholesky, and LDL^T where the matrix turns out indefinite.
    #[default]
    Auto,
    Llt,
    Ldlt,
}

/// What is written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Write fields at every n-th accepted step (the last is always written); 0 writes none.
    pub every: u32,
    /// Subdivisions of a Bezier piece in the tessellated copy of rigid surfaces.
    pub tessellation: u32,
}

fn one() -> u32 {
    1
}
fn one_f64() -> f64 {
    1.0
}
fn yes() -> bool {
    true
}
fn axis_y() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}
fn axis_z() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

impl Default for Placement {
    fn default() -> Self {
        Placement {
            scale: 1.0,
            axis: [0.0, 0.0, 1.0],
            angle: 0.0,
            translation: [0.0; 3],
        }
    }
}

impl Default for Solution {
    fn default() -> Self {
        Solution {
            end_time: 1.0,
            stops: Vec::new(),
            step: Step::default(),
            newton: Newton::default(),
            linear_solver: LinearSolver::Auto,
            threads: 0,
        }
    }
}

impl Default for Step {
    fn default() -> Self {
        Step {
            initial: 0.1,
            min: 1e-5,
            max: 0.1,
            adaptive: true,
        }
    }
}

impl Default for Newton {
    fn default() -> Self {
        Newton {
            max_iterations: 25,
            tolerance: 1e-8,
            line_search: true,
        }
    }
}

impl Default for Output {
    fn default() -> Self {
        Output {
            every: 1,
            tessellation: 16,
        }
    }
}
