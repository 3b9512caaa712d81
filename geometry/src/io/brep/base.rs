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

/// Says how far patches are from the surface that the file defines; `None` where it is rounding.
pub(in crate::io) fn approximation(patches: &[BasePatch]) -> Option<String> {
    let fitted = patches.iter().any(|p| {
        let [low, high] = p.patch.bounds();
        p.deviation > 1e-12 * (high - low).norm()
    });
    let deviation = patches.iter().fold(0.0, |d: f64, p| d.max(p.deviation));
    fitted.then(|| format!("read as a NURBS surface that differs by up to {deviation:.1e}"))
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
