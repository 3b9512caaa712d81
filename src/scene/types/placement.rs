//! Where surfaces and meshes are put, and the ways to write it.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Rigid placement of a surface before it moves, or of a mesh, with an optional scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "PlacementForm", into = "PlacementForm")]
pub struct Placement {
    /// Multiplies every coordinate (of a CAD file after its units were converted).
    pub scale: f64,
    /// Direction of the rotation axis, of any length.
    pub axis: [f64; 3],
    /// Degrees.
    pub angle: f64,
    /// A point of the rotation axis, in scaled coordinates.
    pub center: [f64; 3],
    /// Displacement, after the rotation.
    pub translation: [f64; 3],
}

impl Default for Placement {
    fn default() -> Self {
        Placement {
            scale: 1.0,
            axis: axis_z(),
            angle: 0.0,
            center: [0.0; 3],
            translation: [0.0; 3],
        }
    }
}

/// Rigid placement of a surface before it moves, or of a mesh, with an optional scale. The rotation is written as `axis` and
/// `angle`, or as `rotation`.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Placement", extend("not" = {"anyOf": [{"required": ["rotation", "axis"]}, {"required": ["rotation", "angle"]}]}))]
struct PlacementForm {
    /// Multiplies every coordinate (of a CAD file after its units were converted).
    #[serde(default = "one")]
    scale: f64,
    /// Rotation axis through the origin; default z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    axis: Option<[f64; 3]>,
    /// Degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    angle: Option<f64>,
    /// Rotation about an axis through any point; in place of `axis` and `angle`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rotation: Option<PlacementRotation>,
    /// Displacement, after the rotation.
    #[serde(default)]
    translation: [f64; 3],
}

/// Rotation of a placement, written as that of a motion.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PlacementRotation {
    /// A point of the axis, in scaled coordinates.
    #[serde(default)]
    center: [f64; 3],
    /// Direction of the axis, of any length.
    axis: [f64; 3],
    /// Angle in degrees.
    angle: f64,
}

impl TryFrom<PlacementForm> for Placement {
    type Error = &'static str;
    fn try_from(form: PlacementForm) -> Result<Placement, &'static str> {
        let (center, axis, angle) = match (form.rotation, form.axis, form.angle) {
            (None, axis, angle) => (
                [0.0; 3],
                axis.unwrap_or_else(axis_z),
                angle.unwrap_or_default(),
            ),
            (Some(rotation), None, None) => (rotation.center, rotation.axis, rotation.angle),
            (Some(_), _, _) => {
                return Err(
                    "the rotation is given twice, by `rotation` and by `axis` or `angle`: leave one of them out",
                );
            }
        };
        Ok(Placement {
            scale: form.scale,
            axis,
            angle,
            center,
            translation: form.translation,
        })
    }
}

impl From<Placement> for PlacementForm {
    fn from(placement: Placement) -> PlacementForm {
        let Placement {
            scale,
            axis,
            angle,
            center,
            translation,
        } = placement;
        let through_origin = center == [0.0; 3];
        PlacementForm {
            scale,
            axis: through_origin.then_some(axis),
            angle: through_origin.then_some(angle),
            rotation: (!through_origin).then_some(PlacementRotation {
                center,
                axis,
                angle,
            }),
            translation,
        }
    }
}

fn one() -> f64 {
    1.0
}

fn axis_z() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}
