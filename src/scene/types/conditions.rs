//! Supports and loads.
use super::SetNames;
use crate::scene::value::Value;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A support: exactly one of `fixed`, `clamped`, `symmetry`, `plane_strain`, `displacement`; the last may also stand beside `clamped`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Node or face set, `body.set`, a whole body, `body`, or a list of them.
    pub on: SetNames,
    /// All three components are zero.
    #[serde(default)]
    pub fixed: bool,
    /// All three components are zero, and the sheet does not turn about the edge; only for edges and curves of trims of a body of kind
    /// `nurbs`, which `fixed` leaves hinged. With `displacement` beside it the clamp moves as that says, without turning.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub clamped: bool,
    /// The displacement along this axis is zero; at an edge of a body of kind `nurbs` the sheet also stays at right angles to the
    /// plane.
    #[serde(default)]
    pub symmetry: Option<Axis>,
    /// The displacement along this axis is zero. Of whole bodies: what they do is the same at all places along it. A body of kind
    /// `nurbs` is extruded along the axis, and its other displacements do not change along it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane_strain: Option<Axis>,
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
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    Z,
}

/// Components of a displacement; what is not named stays free. Expressions may use x, y, z (undeformed) and t. A list of three
/// stands for `x`, `y` and `z`, and `null` in it for a component that is not named.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Components {
    /// Along x.
    pub x: Option<Value>,
    /// Along y.
    pub y: Option<Value>,
    /// Along z.
    pub z: Option<Value>,
}

/// A load: exactly one of `force`, `traction`, `pressure`, `couple`, `gravity`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{"required": ["force"]}, {"required": ["traction"]}, {"required": ["pressure"]}, {"required": ["couple"]}, {"required": ["gravity"]}]))]
pub struct Load {
    /// Node or face set, `body.set`, or a list of them (traction and pressure need faces); for gravity a body, or a list.
    pub on: SetNames,
    /// Total force, spread evenly over the nodes of a node set, over the area of a face set.
    #[serde(default)]
    pub force: Option<[Value; 3]>,
    /// Force per undeformed area, of constant direction. Expressions may use x, y, z and t.
    #[serde(default)]
    pub traction: Option<[Value; 3]>,
    /// Pressure against the outward normal (force / area). Expressions may use x, y, z and t; those of a follower t.
    #[serde(default)]
    pub pressure: Option<Value>,
    /// Couple per undeformed length along edges or curves of trims of a body of kind `nurbs`, which turns with them (force); positive where it lifts
    /// what would lie beyond the edge towards the top. Expressions may use t.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub couple: Option<Value>,
    /// Acceleration that acts on the mass of whole bodies (length / time^2): `[0, 0, -9810]` in mm and s. Their materials need a
    /// `density`.
    #[serde(default)]
    pub gravity: Option<[Value; 3]>,
    /// The pressure follows the deformed faces (their area and normal).
    #[serde(default)]
    pub follower: bool,
}
