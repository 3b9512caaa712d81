//! Mesh generators and the spacing of their nodes.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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

fn one() -> u32 {
    1
}
