//! Energies that say nothing: what rounding makes of a body at rest.
use super::Work;
use crate::model::Model;
use crate::model::penalty::modulus;

/// Energy over Young's modulus times the cube around a body below which it is rounding: a sheet a thousandth as thick as it is long
/// has it at strains of 1e-9.
const ROUNDING: f64 = 1e-21;

/// The energy that rounding makes of all bodies at most.
pub(super) fn faint(model: &Model) -> f64 {
    let of = |body: &crate::model::BodyModel| {
        let [low, high] = body.mesh.bounds();
        ROUNDING * modulus(&body.material) * (high - low).norm().powi(3)
    };
    model.bodies.iter().map(of).sum()
}

impl Work {
    /// None yet, where energies below `faint` are nothing.
    pub(super) fn beyond(faint: f64) -> Self {
        Work {
            coarse: faint,
            ..Work::default()
        }
    }
}
