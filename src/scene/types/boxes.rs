//! Boxes along the axes, and the ways to write them.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A box: `min` and `max`, or `size` with `origin` (its lowest corner) or `center`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "CornersForm")]
pub struct Corners {
    /// Lowest corner.
    pub min: [f64; 3],
    /// Highest corner.
    pub max: [f64; 3],
}

/// A box as scenes write it: `min` and `max`, or `size` with `origin` (its lowest corner) or `center`.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Corners")]
struct CornersForm {
    /// Lowest corner; with `max`.
    #[serde(default)]
    min: Option<[f64; 3]>,
    /// Highest corner; with `min`.
    #[serde(default)]
    max: Option<[f64; 3]>,
    /// Lengths along x, y and z; in place of `min` and `max`.
    #[serde(default)]
    size: Option<[f64; 3]>,
    /// Lowest corner of a box of `size`; default: the origin.
    #[serde(default)]
    origin: Option<[f64; 3]>,
    /// Middle of a box of `size`; in place of `origin`.
    #[serde(default)]
    center: Option<[f64; 3]>,
}

impl TryFrom<CornersForm> for Corners {
    type Error = &'static str;
    fn try_from(form: CornersForm) -> Result<Corners, &'static str> {
        corners(form.min, form.max, form.size, form.origin, form.center)
    }
}

/// The corners of a box that is written in one of the ways.
pub(super) fn corners(
    min: Option<[f64; 3]>,
    max: Option<[f64; 3]>,
    size: Option<[f64; 3]>,
    origin: Option<[f64; 3]>,
    center: Option<[f64; 3]>,
) -> Result<Corners, &'static str> {
    let sum = |a: [f64; 3], b: [f64; 3], s: f64| std::array::from_fn(|i| a[i] + s * b[i]);
    match (min, max, size, origin, center) {
        (Some(min), Some(max), None, None, None) => Ok(Corners { min, max }),
        (None, None, Some(size), origin, None) => {
            let min = origin.unwrap_or_default();
            let max = sum(min, size, 1.0);
            Ok(Corners { min, max })
        }
        (None, None, Some(size), None, Some(center)) => Ok(Corners {
            min: sum(center, size, -0.5),
            max: sum(center, size, 0.5),
        }),
        _ => Err(
            "a box is given by `min` and `max`, or by `size` with one of `origin` (its lowest corner) and `center`",
        ),
    }
}

/// The point that `origin` or `center` names, of which one at most may be given.
pub(super) fn one_point(
    origin: Option<[f64; 3]>,
    center: Option<[f64; 3]>,
) -> Result<Option<[f64; 3]>, &'static str> {
    match (origin, center) {
        (Some(_), Some(_)) => Err("`origin` and `center` are both given: take one of them"),
        (one, other) => Ok(one.or(other)),
    }
}
