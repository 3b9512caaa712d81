//! The direction of a law on a master that deforms: a vector that is fixed to its surface.
//!
//! The law is given a direction `D` in space, in the undeformed configuration. At the foot `xi` it has components along the
//! tangents and the normal of the undeformed facet, and the direction there is the vector with the same components now:
//!
//! ```text
//! c^i = D . rho_0^i(xi)     c^3 = D . n_0(xi)        v = c^i rho_i + c^3 n        e = v / |v|
//! ```
//!
//! What lies in the tangent plane, `c^i rho_i`, turns and stretches as a material fibre does; a rigid motion of the master
//! turns all of `e` with it. As on a rigid master the law projects `e` on its own tangent plane, and knows by its slope how much
//! the direction means. At a node or an edge it is the one of the facet that the foot was found on.
//!
//! With `X^m` the way of the foot, and `D` constant,
//!
//! ```text
//! dv = ( c^i I - c^3 rho^i x n ) drho_,i + v_,m X^m      v_,m = c^k_,m rho_k + c^k rho_km + c^3_,m n - c^3 h_mj rho^j
//! c^k_,m = -rho_0^k . ( c^i rho_0,im ) + c^3 h_0,mj a_0^jk        c^3_,m = -n_0 . ( c^i rho_0,im )
//! ```
use super::anchor::{Columns, dual};
use super::law::{FrictionLaw, diagonal};
use crate::contact::kernel::Slots;
use crate::contact::moving::MovingMaster;
use covact_geometry::{Frame, Hint, Jet};
use nalgebra::{Matrix3, Vector3};
use num_dual::DualNum;

/// The direction of a law at the foot of a slave point, with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heading<D = f64> {
    /// Unit vector, in space.
    pub e: Vector3<D>,
    /// Its derivative with respect to the tangents `rho_1` and `rho_2` at a foot that stays (1 / length).
    by_tangents: [Matrix3<D>; 2],
    /// Its derivative with respect to the parameters of the foot.
    by_xi: [Vector3<D>; 2],
}

impl<D: DualNum<f64> + Copy> Heading<D> {
    /// Of a `direction` in the undeformed configuration, not zero, where the facet has these jets. `None` where either has no
    /// tangent plane.
    pub fn new(direction: &Vector3<f64>, undeformed: &Jet<D>, now: &Jet<D>) -> Option<Self> {
        let (before, frame) = (Frame::new(undeformed, 1.0)?, Frame::new(now, 1.0)?);
        let [up_before, up] = [dual(&before), dual(&frame)];
        let direction = direction.map(D::from);
        let c = up_before.map(|up| up.dot(&direction));
        let height = before.n.dot(&direction);
        let v = frame.rho_i[0] * c[0] + frame.rho_i[1] * c[1] + frame.n * height;
        let over = v.dot(&v).sqrt().recip();
        let e = v * over;
        let by_tangents = [0, 1].map(|i| {
            let block: Matrix3<D> = diagonal(c[i]) - up[i] * frame.n.transpose() * height;
            (block - e * (e.transpose() * block)) * over
        });
        let by_xi = [0, 1].map(|m| {
            // What a change of the basis makes of the vector with components `c` and `height`.
            let turned = |frame: &Frame<D>, up: &[Vector3<D>; 2]| {
                frame.rho_ij[m] * c[0] + frame.rho_ij[1 + m] * c[1]
                    - (up[0] * frame.h[m] + up[1] * frame.h[1 + m]) * height
            };
            let back = turned(&before, &up_before);
            let dv = turned(&frame, &up)
                - frame.rho_i[0] * up_before[0].dot(&back)
                - frame.rho_i[1] * up_before[1].dot(&back)
                - frame.n * before.n.dot(&back);
            (dv - e * e.dot(&dv)) * over
        });
        Some(Heading {
            e,
            by_tangents,
            by_xi,
        })
    }

    /// No direction: that of the unit normal, along which a law knows none.
    pub fn none(normal: &Vector3<D>) -> Self {
        Heading {
            e: *normal,
            by_tangents: [Matrix3::from_element(D::zero()); 2],
            by_xi: [Vector3::from_element(D::zero()); 2],
        }
    }

    /// Its derivative with respect to the slots at the foot, which travels by `travel[m]` along the parameter `m`.
    pub fn columns(&self, travel: &[Slots<D>; 2]) -> Columns<D> {
        let mut out = self.by_xi[0] * travel[0].transpose() + self.by_xi[1] * travel[1].transpose();
        for (i, block) in self.by_tangents.iter().enumerate() {
            let mut slot = out.fixed_columns_mut::<3>(3 + 3 * i);
            slot += block;
        }
        out
    }
}

impl MovingMaster<'_> {
    /// The direction of a law at a foot with this unit normal; nothing for laws that know no direction. At the tip of a facet that
    /// is collapsed to a triangle there is no tangent plane and no direction.
    #[inline]
    pub fn heading<F: FrictionLaw>(
        &self,
        law: &F,
        foot: Hint,
        normal: &Vector3<f64>,
    ) -> Option<Heading> {
        law.direction().map(|direction| {
            let [undeformed, now] =
                [self.undeformed, self.facets].map(|facets| facets.jet(foot.patch, foot.xi));
            Heading::new(direction, &undeformed, &now).unwrap_or_else(|| Heading::none(normal))
        })
    }
}
