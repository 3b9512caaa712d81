//! What a study file says.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A study: a scene, the choices to run it with, and what is measured of every run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// Version of the format of study files.
    pub covact_study: u32,
    /// For editors.
    #[serde(rename = "$schema", default, skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// What the study is about; it heads the report.
    #[serde(default)]
    pub title: String,
    /// What the study asks, in a sentence or two; the report begins with it.
    #[serde(default)]
    pub question: String,
    /// The scene, relative to the folder of the study file.
    pub scene: PathBuf,
    /// Changes for every run: JSON pointers into the scene and their new values; null removes a key.
    #[serde(default)]
    pub set: BTreeMap<String, Json>,
    /// Every grid gives a run per combination of its choices; equal runs are done once.
    pub grids: Vec<Grid>,
    /// Sequences of refinement whose last run is held for the truth.
    #[serde(default)]
    pub references: BTreeMap<String, Refinement>,
    /// What is measured; the first one is what the report's sentences are about.
    pub quantities: Vec<Quantity>,
    /// How often every run is done, on how many threads and for how long at most.
    #[serde(default)]
    pub timing: Timing,
    /// Relative errors that the report says the cost of.
    #[serde(default = "targets")]
    pub targets: Vec<f64>,
    /// Runs that fail are told, but are no failure of the study.
    #[serde(default)]
    pub may_fail: bool,
}

impl Study {
    /// File name of the scene, as records have it.
    pub(super) fn scene_name(&self) -> String {
        let name = self.scene.file_name().unwrap_or(self.scene.as_os_str());
        name.to_string_lossy().into_owned()
    }
}

fn targets() -> Vec<f64> {
    vec![0.1, 0.03, 0.01, 0.003, 0.001]
}

/// All combinations of some choices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// Changes for every run of this grid, made before those of its choices.
    #[serde(default)]
    pub set: BTreeMap<String, Json>,
    /// The last one varies fastest.
    pub choices: Vec<Choice>,
}

/// One thing that varies, with its values. `surface`, `body` and `contact` name a part of the scene; they may be left out
/// where there is only one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Choice {
    /// What stands for a rigid surface.
    Master {
        /// Name of the rigid surface.
        #[serde(default)]
        surface: Option<String>,
        /// The values.
        values: Vec<MasterChoice>,
    },
    /// Element and number of elements of a body with a generated mesh.
    Shell {
        /// Name of the body.
        #[serde(default)]
        body: Option<String>,
        /// The values.
        values: Vec<BTreeMap<String, Vec<u32>>>,
    },
    /// Slave points: `"nodes"`, `{"gauss": 3}`, `{"lobatto": 3}`, `{"segments": 3}`, `{"averaged": {"gauss": 3}}`.
    Points {
        /// Name of the contact.
        #[serde(default)]
        contact: Option<String>,
        /// The values.
        values: Vec<PointsChoice>,
    },
    /// Tangent of contact.
    Tangent {
        /// Name of the contact.
        #[serde(default)]
        contact: Option<String>,
        /// The values.
        values: Vec<TangentChoice>,
    },
    /// Normal penalty, as in a scene.
    Penalty {
        /// Name of the contact.
        #[serde(default)]
        contact: Option<String>,
        /// The values.
        values: Vec<crate::scene::Penalty>,
    },
    /// Augmentation: `"none"` or as in a scene.
    Augmentation {
        /// Name of the contact.
        #[serde(default)]
        contact: Option<String>,
        /// The values.
        values: Vec<Json>,
    },
    /// Fixed step size.
    Step {
        /// The values.
        values: Vec<f64>,
    },
    /// Newton's tolerance.
    Tolerance {
        /// The values.
        values: Vec<f64>,
    },
    /// Any keys of the scene, by JSON pointer: all get the value.
    Key {
        /// Name of the choice in tables.
        name: String,
        /// JSON pointers of the keys.
        at: Vec<String>,
        /// The values.
        values: Vec<Json>,
    },
    /// Named sets of changes.
    Variants {
        /// Name of the choice in tables.
        name: String,
        /// The values.
        values: Vec<Variant>,
    },
}

/// What stands for a rigid surface: `"exact"`, `{"bilinear": {"chord": 0.1}}`, `{"stl": {"chord": 0.1}}`,
/// `{"stl": {"file": "tool.stl"}}`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MasterChoice {
    /// The surface as the scene describes it, facets removed.
    Exact,
    /// Facets of four nodes.
    Bilinear(Fineness),
    /// Facets of nine nodes.
    Biquadratic(Fineness),
    /// A smooth bicubic surface through the nodes of facets.
    Smooth(Fineness),
    /// Flat triangles, as an STL file has them.
    Stl(StlSource),
}

/// How fine facets are: one of the three.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Fineness {
    /// Distance from the exact surface (length).
    Chord(f64),
    /// Longest edge (length).
    Size(f64),
    /// Facets along both directions of every patch.
    Count([u32; 2]),
}

/// Where the triangles come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum StlSource {
    /// A file, relative to the folder of the study file.
    File(PathBuf),
    /// Made of the exact surface, this far from it (length).
    Chord(f64),
    /// Made of the exact surface, with edges of this length.
    Size(f64),
    /// Made of the exact surface, two triangles per facet.
    Count([u32; 2]),
}

/// Slave points, and whether gaps are averaged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum PointsChoice {
    /// The nodes of the slave faces.
    Nodes,
    /// Gauss points, this number along both directions of a face.
    Gauss(u8),
    /// Lobatto points, this number along both directions of a face.
    Lobatto(u8),
    /// The faces cut by the facets of the master, with a rule of this degree on every piece.
    Segments(u8),
    /// The same points with averaged gaps.
    Averaged(crate::scene::Points),
}

/// Tangent of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TangentChoice {
    /// Consistent at every penetration.
    Exact,
    /// The published form with all its parts.
    Published,
    /// The published form without its rotational part.
    WithoutRotational,
    /// The published form without its curvature part.
    WithoutCurvature,
    /// The main part alone.
    Main,
}

/// A named set of changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Variant {
    /// Name of the variant in tables.
    pub label: String,
    /// JSON pointers and their values; null removes a key.
    #[serde(default)]
    pub set: BTreeMap<String, Json>,
    /// Variants of one series are joined by a line; default: a series of its own.
    #[serde(default)]
    pub series: Option<String>,
    /// What makes variants of one series finer as it becomes smaller.
    #[serde(default)]
    pub size: Option<f64>,
}

/// A sequence of ever finer runs; the last one is the reference, the others tell how far it is from the limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Refinement {
    /// Changes of the scene, coarse to fine: two or three.
    pub runs: Vec<BTreeMap<String, Json>>,
    /// Ratio of mesh sizes from one run to the next.
    #[serde(default = "two")]
    pub ratio: f64,
    /// Order of convergence; default: from three runs, as observed.
    #[serde(default)]
    pub order: Option<f64>,
}

fn two() -> f64 {
    2.0
}

/// What is measured of a run, and what it is compared with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Quantity {
    /// Name of the quantity in tables.
    pub name: String,
    /// What is measured.
    pub of: Measure,
    /// Default: none; the value alone is shown.
    #[serde(default)]
    pub reference: Option<Reference>,
    /// What errors are divided by; default: the size of the reference.
    #[serde(default)]
    pub scale: Option<f64>,
    /// For axes, e.g. "N".
    #[serde(default)]
    pub unit: String,
}

/// Something to measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Measure {
    /// Of a column of `history.csv`.
    Column {
        /// Name of the column.
        name: String,
        /// What is taken of it.
        #[serde(default)]
        take: Take,
        /// Only rows whose time lies between these; default: all.
        #[serde(default)]
        between: Option<[f64; 2]>,
        /// The independent variable; default: time.
        #[serde(default)]
        over: Option<String>,
    },
    /// A field of a body in the last results. Its error is the L2 norm of the difference over the reference
    /// configuration of the body.
    Field {
        /// Name of the body.
        body: String,
        /// Name of the field.
        name: String,
    },
    /// A number of `summary.json`.
    Summary {
        /// Name of the number; a dot leads into an object.
        name: String,
    },
}

/// What is taken of a column.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Take {
    /// The last value.
    #[default]
    End,
    /// The largest value.
    Max,
    /// The smallest value.
    Min,
    /// Over time.
    Mean,
    /// At a time, between rows linearly.
    At(f64),
    /// Peak to peak after the straight line through the values is taken off, relative to the mean: the noise of a force that
    /// should be smooth.
    Swing,
    /// The whole curve; its error is the root of the mean square of the difference.
    Curve,
}

/// What a quantity is compared with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Reference {
    /// A number: a closed form or a published value, with its source in words.
    Value {
        /// The number.
        value: f64,
        /// Where it is from, in words.
        source: String,
    },
    /// A curve in a CSV file with a line of names, relative to the folder of the study file.
    Curve {
        /// The file.
        file: PathBuf,
        /// Name of the column of the independent variable.
        x: String,
        /// Name of the column of the values.
        y: String,
        /// Where it is from, in words.
        source: String,
    },
    /// The last run of one of the study's `references`, by name.
    Finest(String),
}

/// How runs are timed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Timing {
    /// Times that every run is done, round after round, so that a slow moment of the machine meets all of them.
    pub repeats: u32,
    /// Do one run at a time, so that none slows another down; else as many as there are cores.
    pub one_at_a_time: bool,
    /// Threads of a run.
    pub threads: u32,
    /// Seconds after which a run is stopped, and counts as failed.
    pub limit: f64,
}

impl Default for Timing {
    fn default() -> Self {
        Timing {
            repeats: 1,
            one_at_a_time: false,
            threads: 1,
            limit: 3600.0,
        }
    }
}
