//! Mesh generators and the spacing of their nodes.
use super::boxes::{Corners, corners, one_point};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Plate `[x0, x0+lx] x [y0, y0+ly]`, mid-surface at `z0`. Face sets `top` (z max), `bottom`, `x_min`, `x_max`,
/// `y_min`, `y_max`; node sets of the same names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "PlateForm")]
pub struct Plate {
    /// Lengths along x and y.
    pub size: [f64; 2],
    /// Thickness.
    pub thickness: f64,
    /// Elements along x and y.
    pub elements: [u32; 2],
    /// Elements through the thickness.
    pub layers: u32,
    /// Corner (x0, y0) and height z0 of the mid-surface.
    pub origin: [f64; 3],
    /// Spacing of the nodes along x and y.
    pub spacing: [Spacing; 2],
}

/// Plate `[x0, x0+lx] x [y0, y0+ly]`, mid-surface at `z0`. Face sets `top` (z max), `bottom`, `x_min`, `x_max`,
/// `y_min`, `y_max`; node sets of the same names.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Plate")]
struct PlateForm {
    /// Lengths along x and y.
    size: [f64; 2],
    /// Thickness.
    thickness: f64,
    /// Elements along x and y.
    elements: [u32; 2],
    /// Elements through the thickness.
    #[serde(default = "one")]
    layers: u32,
    /// Corner (x0, y0) and height z0 of the mid-surface; default: the origin.
    #[serde(default)]
    origin: Option<[f64; 3]>,
    /// Middle of the mid-surface; in place of `origin`.
    #[serde(default)]
    center: Option<[f64; 3]>,
    /// Spacing of the nodes along x and y.
    #[serde(default)]
    spacing: [Spacing; 2],
}

impl TryFrom<PlateForm> for Plate {
    type Error = &'static str;
    fn try_from(form: PlateForm) -> Result<Plate, &'static str> {
        let [lx, ly] = form.size;
        one_point(form.origin, form.center)?;
        let middle = |[x, y, z]: [f64; 3]| [x - 0.5 * lx, y - 0.5 * ly, z];
        Ok(Plate {
            size: form.size,
            thickness: form.thickness,
            elements: form.elements,
            layers: form.layers,
            origin: (form.origin.or(form.center.map(middle))).unwrap_or_default(),
            spacing: form.spacing,
        })
    }
}

/// Panel of a cylinder about the y axis: `x = r sin(phi)`, `z = r cos(phi)`, phi from `angles[0]` to `angles[1]` in
/// degrees, y from `y[0]` to `y[1]`. Face and node sets `outer`, `inner`, `phi_min`, `phi_max`, `y_min`, `y_max`
/// (a full turn is closed and has no phi sets).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderPanel {
    /// Radius of the mid-surface.
    pub radius: f64,
    /// Thickness.
    pub thickness: f64,
    /// First and last angle phi (degrees).
    pub angles: [f64; 2],
    /// First and last y.
    pub y: [f64; 2],
    /// Elements along phi and y.
    pub elements: [u32; 2],
    /// Elements through the thickness.
    #[serde(default = "one")]
    pub layers: u32,
    /// Position of the cylinder's centre; also written `center`.
    #[serde(default, alias = "center")]
    pub origin: [f64; 3],
}

/// Panel of a sphere about `origin`, with its poles on the y axis and longitude counted from z towards x: longitude
/// from `longitude[0]` to `[1]`, latitude from `latitude[0]` to `[1]`, both in degrees. Face and node sets `outer`, `inner`, `longitude_min`, `longitude_max`, `latitude_min`, `latitude_max`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpherePanel {
    /// Radius of the mid-surface.
    pub radius: f64,
    /// Thickness.
    pub thickness: f64,
    /// First and last longitude (degrees).
    pub longitude: [f64; 2],
    /// First and last latitude (degrees).
    pub latitude: [f64; 2],
    /// Elements along longitude and latitude.
    pub elements: [u32; 2],
    /// Elements through the thickness.
    #[serde(default = "one")]
    pub layers: u32,
    /// Position of the sphere's centre; also written `center`.
    #[serde(default, alias = "center")]
    pub origin: [f64; 3],
}

/// Box of elements. Face and node sets `x_min` ... `z_max`, and `bottom`, `top` for z.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "BlockForm")]
pub struct Block {
    /// Lowest corner.
    pub min: [f64; 3],
    /// Highest corner.
    pub max: [f64; 3],
    /// Elements along x, y and z.
    pub elements: [u32; 3],
    /// Spacing of the nodes along each axis.
    pub spacing: [Spacing; 3],
}

/// Box of elements, from `min` to `max` or of a `size`. Face and node sets `x_min` ... `z_max`, and `bottom`, `top` for z.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Block")]
struct BlockForm {
    /// Lowest corner; with `max`.
    #[serde(default)]
    min: Option<[f64; 3]>,
    /// Highest corner; with `min`.
    #[serde(default)]
    max: Option<[f64; 3]>,
    /// Lengths along x, y and z; in place of `min` and `max`.
    #[serde(default)]
    size: Option<[f64; 3]>,
    /// Lowest corner of a block of `size`; default: the origin.
    #[serde(default)]
    origin: Option<[f64; 3]>,
    /// Middle of a block of `size`; in place of `origin`.
    #[serde(default)]
    center: Option<[f64; 3]>,
    /// Elements along x, y and z.
    elements: [u32; 3],
    /// Spacing of the nodes along each axis.
    #[serde(default)]
    spacing: [Spacing; 3],
}

impl TryFrom<BlockForm> for Block {
    type Error = &'static str;
    fn try_from(form: BlockForm) -> Result<Block, &'static str> {
        let Corners { min, max } =
            corners(form.min, form.max, form.size, form.origin, form.center)?;
        Ok(Block {
            min,
            max,
            elements: form.elements,
            spacing: form.spacing,
        })
    }
}

/// How nodes are spaced along an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Spacing {
    /// All elements are as long.
    #[default]
    Uniform,
    /// Every element is `ratio` times as long as the one before it.
    Geometric {
        /// Length of an element over that of the one before it.
        ratio: f64,
    },
    /// From the middle of the axis to both ends every element is `ratio` times as long as the one before it, the same on both sides.
    FromMiddle {
        /// Length of an element over that of the one before it.
        ratio: f64,
    },
    /// `fine` equal elements over `length` at the start of the axis (`from_end: true`: at its end; `from_middle: true`: around its
    /// middle), the rest growing geometrically with the ratio that fills the axis.
    Fine {
        /// Length of the fine part.
        length: f64,
        /// Elements of the fine part.
        fine: u32,
        /// The fine part lies at the end of the axis.
        #[serde(default)]
        from_end: bool,
        /// The fine part lies around the middle of the axis; as many elements lie on either side of it.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        from_middle: bool,
    },
}

fn one() -> u32 {
    1
}
