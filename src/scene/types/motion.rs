//! Motion of rigid surfaces: prescribed, and driven by force.
use crate::scene::value::Value;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Rigid motion: a prescribed translation (x, y, z) added to a rotation about an axis, and on top of it what forces drive.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Motion {
    /// Displacement as numbers, tables or expressions in `t`.
    pub translation: [Value; 3],
    /// Rotation about an axis.
    pub rotation: Option<Rotation>,
    /// Components that are unknown and driven by a given force or moment; all others follow what is prescribed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free: Option<FreeMotion>,
}

/// Components of a rigid surface's motion that are unknown, each with the total force or moment that drives it.
///
/// The free motion comes on top of the prescribed one: the surface is first turned about `center`, which moves with the
/// prescribed motion, and then displaced. All axes are those of space.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FreeMotion {
    /// Point of the surface, as placed, about which it turns and to which moments refer; default: the middle of the
    /// surface. It moves with the surface.
    pub center: Option<[f64; 3]>,
    /// Total force on the surface along each free translation.
    pub force: FreeComponents,
    /// Total moment on the surface about each free rotation. Free rotations are the components of one rotation vector,
    /// of which those not named stay zero.
    pub moment: FreeComponents,
}

/// Free components, with their force or moment as numbers, tables or expressions in `t`; those not named are not free. A list of
/// three stands for `x`, `y` and `z`, and `null` in it for a component that is not named.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FreeComponents {
    /// Along or about x.
    pub x: Option<Value>,
    /// Along or about y.
    pub y: Option<Value>,
    /// Along or about z.
    pub z: Option<Value>,
}

impl FreeComponents {
    /// The three components with the names of their axes.
    pub fn axes(&self) -> [(&'static str, Option<&Value>); 3] {
        [
            ("x", self.x.as_ref()),
            ("y", self.y.as_ref()),
            ("z", self.z.as_ref()),
        ]
    }
}

/// Rotation about an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// A point of the axis; it moves with the translation.
    #[serde(default)]
    pub center: [f64; 3],
    /// Direction of the axis, of any length.
    pub axis: [f64; 3],
    /// Angle in degrees.
    pub angle: Value,
}
