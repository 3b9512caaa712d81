//! A surface without what bounds a face on it.

use super::reparametrise::Reparametrise;
use crate::NurbsPatch;

/// A patch with the parameters that the file means.
#[derive(Debug, Clone)]
pub struct BasePatch {
    /// The patch.
    pub patch: NurbsPatch,
    /// From the parameters that the file gives the entity to the patch's.
    pub parameters: Reparametrise,
    /// Largest distance of the patch from what the entity defines; 0 where the form is exact.
    pub deviation: f64,
}

impl BasePatch {
    /// A patch with the file's own parameters, exact.
    pub(in crate::io) fn exact(patch: NurbsPatch) -> Self {
        Self {
            parameters: Reparametrise::identity(patch.domain()),
            patch,
            deviation: 0.0,
        }
    }
}
