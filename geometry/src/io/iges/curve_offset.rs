//! Offset curves (130).

use super::curve::{CurvePart, Reader, Stop};
use super::directory::Entry;
use super::transform::Affine;

/// Not read yet beyond its name.
pub fn read(_: &mut Reader, _: &Entry, _: &Affine) -> Result<Vec<CurvePart>, Stop> {
    Err(Stop::Reason("offset curves are not read".to_owned()))
}
