//! Friction of a slave point whose normal and foot stay what they are at the start: displacements are small.
//!
//! Slip is measured by the displacement `w` of the point relative to its master. With a constant normal `n` the traction and its
//! derivative are those of [`Attraction::traction`] with `dn = 0`:
//!
//! ```text
//! T_tr = P (lambda + eps_T phi (w - w_0))        dT/dw = T,trial eps_T P (phi I + (w - w_0) x n phi') - T,p x n dN
//! ```
//!
//! [`Attraction::traction`]: super::trial::Attraction::traction
use super::history::PointHistory;
use super::law::{FrictionLaw, Slip};
use super::rigid::Friction;
use super::trial::Traction;
use crate::contact::kernel::Normal;
use covact_geometry::Vec3;
use nalgebra::{Matrix3, Vector3};
use num_dual::DualNum;

/// A law whose direction, where it knows one, is a unit vector of space that stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Directed<F> {
    /// The law itself.
    pub law: F,
    /// Its direction in space; none for a law without direction.
    pub e: Option<Vec3>,
}

impl<F: FrictionLaw> Directed<F> {
    /// The law, its direction turned into space.
    pub fn new(law: F, turn: impl Fn(&Vec3) -> Vec3) -> Self {
        let e = law.direction().map(turn);
        Directed { law, e }
    }
}

impl<F: FrictionLaw> FrictionLaw for Directed<F> {
    #[inline]
    fn slip<D: DualNum<f64> + Copy>(
        &self,
        trial: &Vector3<D>,
        normal: &Vector3<D>,
        pressure: D,
    ) -> Slip<D> {
        match &self.e {
            None => self.law.slip(trial, normal, pressure),
            Some(e) => {
                let e = e.map(D::from);
                self.law.slip_along(trial, normal, pressure, &e).0
            }
        }
    }
}

impl<F: FrictionLaw> Friction<F> {
    /// Traction of a point that is displaced by `w` (length) relative to its master, at a gap and under a normal traction, and
    /// its derivative with respect to `w`. `n` is its unit normal.
    #[inline]
    pub fn steady(
        &self,
        history: &PointHistory,
        w: &Vec3,
        n: &Vec3,
        gap: f64,
        normal: &Normal,
    ) -> Traction {
        let still = Matrix3::zeros();
        (history.attraction(self.eps_t)).traction(&self.law, w, n, &still, gap, normal)
    }
}
