//! The published tangent of normal contact, kept as a reference to compare with.
//!
//! Main, rotational and curvature part as in Konyukhov & Schweizerhof, Comput. Mech. 35 (2005), written in the slots of
//! [`super::kernel`]. It equals the exact tangent at `xi3 = 0`; at a finite penetration its geometric part is off by
//! about `|xi3 kappa|`, and for pure penalty (`N = eps_n xi3`) the whole matrix by its square.
use super::kernel::{Normal, SlotMatrix, Slots, main_and_curvature};
use covact_geometry::Frame;
use nalgebra::{Matrix3, Vector3};
use num_dual::DualNum;

/// Which parts beyond the main one are included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// The part of turning normals.
    pub rotational: bool,
    /// The part of the curvature `h^ij`.
    pub curvature: bool,
}

impl Parts {
    /// The whole published form.
    pub const ALL: Parts = Parts {
        rotational: true,
        curvature: true,
    };
}

/// Published tangent on a master that moves or deforms:
///
/// ```text
/// main       + dN A^T n n^T A
/// rotational - N a^ij ( B_j^T n rho_i^T A + A^T rho_j n^T B_i )
/// curvature  - N h^ij A^T rho_i rho_j^T A
/// ```
pub fn normal_tangent<D: DualNum<f64> + Copy>(
    frame: &Frame<D>,
    normal: &Normal<D>,
    parts: Parts,
) -> SlotMatrix<D> {
    let mut k = SlotMatrix::from_element(D::zero());
    let first = normal_tangent_rigid(frame, normal, parts);
    k.fixed_view_mut::<3, 3>(0, 0).copy_from(&first);
    if parts.rotational {
        let slot = |s: usize, v: &Vector3<D>| {
            let mut out = Slots::from_element(D::zero());
            (0..3).for_each(|i| out[3 * s + i] = v[i]);
            out
        };
        let a = &frame.a_inv;
        let contravariant = [
            frame.rho_i[0] * a[0] + frame.rho_i[1] * a[1],
            frame.rho_i[0] * a[1] + frame.rho_i[1] * a[2],
        ];
        for (j, rho_up) in contravariant.iter().enumerate() {
            let c = slot(j + 1, &frame.n);
            let y = slot(0, rho_up);
            k -= (c * y.transpose() + y * c.transpose()) * normal.n;
        }
    }
    k
}

/// Published tangent on a rigid master: main and curvature part (a rigid master has no rotational part).
pub fn normal_tangent_rigid<D: DualNum<f64> + Copy>(
    frame: &Frame<D>,
    normal: &Normal<D>,
    parts: Parts,
) -> Matrix3<D> {
    if parts.curvature {
        main_and_curvature(frame, &frame.h_inv(), normal)
    } else {
        frame.n * frame.n.transpose() * normal.dn
    }
}
