//! Steps of a surface towards equilibrium, and what resists it.
use super::{PressFault, Presser};
use crate::contact::law::PairLaw;
use nalgebra::{Matrix6, SymmetricEigen, Vector6};

/// Square of the sine of the angle between the normals of points and the lines to the center above which they resist a turn: their
/// stiffness against it over what it would be along their way. Facets of a pulley have as much as half the angle between them.
const RESISTS: f64 = 0.05;

impl<L: PairLaw> Presser<'_, L> {
    /// Whether friction may be all that works against what drives the surface: no translation is free.
    pub fn turns_with_friction(&self) -> bool {
        self.slides && self.driven.free()[..3].iter().all(|free| !free)
    }

    /// Whether normal tractions resist a motion in direction `e` one stride beyond `q`, as a lid that closes and no pulley is
    /// resisted: what turns does not press on what it turns past.
    ///
    /// # Errors
    /// A motion without a value, or a point that cannot be evaluated.
    pub fn resists(
        &mut self,
        t: f64,
        q: &Vector6<f64>,
        e: &Vector6<f64>,
    ) -> Result<bool, PressFault> {
        let press = self.press(t, &(q + e * self.stride))?;
        let turn = e.fixed_rows::<3>(3) / self.driven.lever;
        let swept = turn.dot(&(press.swept * turn));
        Ok(e.dot(&(press.tangent * e)) > RESISTS * swept)
    }
}

/// Step against the forces `f` with the magnitudes of the stiffness's eigenvalues: downhill also where it is indefinite
/// or zero.
pub(super) fn modified_step(
    tangent: &Matrix6<f64>,
    free: &[bool; 6],
    f: &Vector6<f64>,
) -> Vector6<f64> {
    let k = Matrix6::from_fn(|i, j| {
        if free[i] && free[j] {
            tangent[(i, j)]
        } else {
            0.0
        }
    });
    let eigen = SymmetricEigen::new(k);
    let largest = eigen.eigenvalues.amax();
    if largest <= 0.0 {
        // No contact: any length, the caller bounds it.
        return f * (1e100 / f.norm());
    }
    let mut step = Vector6::zeros();
    for i in 0..6 {
        let v = eigen.eigenvectors.column(i);
        step += v * (v.dot(f) / eigen.eigenvalues[i].abs().max(1e-8 * largest));
    }
    step
}

/// The part of forces that works along directions which have stiffness.
pub(super) fn resisted(tangent: &Matrix6<f64>, free: &[bool; 6], f: &Vector6<f64>) -> Vector6<f64> {
    let masked = |i: usize, j: usize| match free[i] && free[j] {
        true => tangent[(i, j)],
        false => 0.0,
    };
    let eigen = SymmetricEigen::new(Matrix6::from_fn(masked));
    let smallest = 1e-6 * eigen.eigenvalues.amax();
    let stiff = (0..6).filter(|&i| eigen.eigenvalues[i].abs() > smallest);
    stiff.fold(Vector6::zeros(), |sum, i| {
        let v = eigen.eigenvectors.column(i);
        sum + v * v.dot(f)
    })
}
