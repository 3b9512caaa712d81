//! Offset surfaces (140).

use super::super::curve::{Stop, describe};
use super::super::transform::Affine;
use super::{Found, SurfaceReader};

/// Not read yet beyond its name.
pub fn read(reader: SurfaceReader, _: &Affine) -> Found {
    let base = reader.pointer(5, "the surface of an offset surface (140)")?;
    Err(Stop::Reason(format!(
        "offset of entity {} ({}); offset surfaces are not read",
        base.number,
        describe(base)
    )))
}
