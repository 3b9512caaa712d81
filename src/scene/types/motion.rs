//! Motion of rigid surfaces.
use crate::scene::value::Value;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
