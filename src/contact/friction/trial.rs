//! From the position of a slave point to its tangential traction.
use super::law::{FrictionLaw, Slip, diagonal};
use crate::contact::kernel::Normal;
use nalgebra::{Matrix3, Vector3};
use num_dual::DualNum;

/// What the trial traction is made of, all in the same coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attraction<D = f64> {
    /// Tangential penalty (force / length^3).
    pub eps_t: f64,
    /// The attraction point.
    pub base: Vector3<D>,
    /// Traction at the base, or multiplier (force / length^2).
    pub lambda: Vector3<D>,
    /// Gap at the last accepted step of a point that touches from it evenly, else zero (length).
    pub approach: f64,
}

/// Part of a step that a point spends in contact, `g / (g - approach)` for a gap that passes evenly from `approach > 0` to
/// `g < 0`, and its derivative with respect to `g`.
pub(super) fn after_impact<D: DualNum<f64> + Copy>(approach: f64, gap: D) -> (D, D) {
    if approach == 0.0 {
        return (D::one(), D::zero());
    }
    // A point that the augmentation holds at a gap it does not resolve any more, or one that came from nowhere.
    if gap.re() >= 0.0 || !approach.is_finite() {
        return (D::zero(), D::zero());
    }
    let over = (gap - approach).recip();
    (gap * over, -over * over * approach)
}

impl Attraction {
    /// Traction of a point at `x` before it is projected, in contact throughout the step.
    pub fn unprojected(&self, x: &Vector3<f64>) -> Vector3<f64> {
        self.lambda + (x - self.base) * self.eps_t
    }
}

impl<D: DualNum<f64> + Copy> Attraction<D> {
    /// Traction of a slave point at `x` with unit normal `n`, under the law; with its derivative with respect to `x` where
    /// the attraction point stands still: `turn = dn/dx`, and the pressure `-N` changes by `-dn_dg n . dx`.
    #[inline]
    pub fn traction<F: FrictionLaw>(
        &self,
        law: &F,
        x: &Vector3<D>,
        n: &Vector3<D>,
        turn: &Matrix3<D>,
        gap: D,
        normal: &Normal<D>,
    ) -> Traction<D> {
        self.traction_towards(law, x, n, n, turn, gap, normal)
    }

    /// [`Self::traction`] where the gap does not grow along the normal but along `gradient = dxi3/dx`: next to an edge or a
    /// vertex, whose pseudo-normal stands in for the direction of the distance.
    #[inline]
    #[expect(clippy::too_many_arguments)]
    pub fn traction_towards<F: FrictionLaw>(
        &self,
        law: &F,
        x: &Vector3<D>,
        n: &Vector3<D>,
        gradient: &Vector3<D>,
        turn: &Matrix3<D>,
        gap: D,
        normal: &Normal<D>,
    ) -> Traction<D> {
        let (phi, d_phi) = after_impact(self.approach, gap);
        let eps_t = D::from(self.eps_t);
        let chord = x - self.base;
        let v = self.lambda + chord * (eps_t * phi);
        let along = v.dot(n);
        let trial = v - n * along;
        let slip = law.slip(&trial, n, -normal.n);
        // dT_tr = P dv - (n.v) dn - n (v.dn)
        let project = |m: Matrix3<D>| m - n * (n.transpose() * m);
        let mut moved = diagonal(eps_t * phi);
        moved += chord * gradient.transpose() * (eps_t * d_phi);
        let d_trial = project(moved) - turn * along - n * (v.transpose() * turn);
        let tangent = slip.d_trial * d_trial + slip.d_normal * turn
            - slip.d_pressure * gradient.transpose() * normal.dn;
        Traction {
            trial,
            slip,
            tangent,
        }
    }
}

/// Tangential traction of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traction<D = f64> {
    /// The trial traction (force / length^2).
    pub trial: Vector3<D>,
    /// What the law makes of it.
    pub slip: Slip<D>,
    /// `dT/dx`.
    pub tangent: Matrix3<D>,
}

impl Traction<f64> {
    /// What of the motion since the base was set is slip (length, a vector in the tangent plane).
    pub fn slid(&self, eps_t: f64) -> Vector3<f64> {
        (self.trial - self.slip.t) / eps_t
    }
}
