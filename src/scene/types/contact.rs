//! Contact pairs.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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

fn yes() -> bool {
    true
}
