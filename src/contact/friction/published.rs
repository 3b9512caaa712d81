//! The published tangents of sticking and sliding (Konyukhov & Schweizerhof, Comput. Mech. 35 (2005)), for comparison with the
//! exact ones, in the nine slots of [`kernel`](crate::contact::kernel).
//!
//! With `t = t_i rho^i` the traction on the slave's side (internal force positive; the paper's `T` is its negative), the
//! rows `A` = slot 0 and `B_j` = slot `j`, and the direction of sliding `s = t / |t|`:
//!
//! ```text
//! stick  main              + eps_T a^ij A^T rho_i rho_j^T A
//! slip   main              - mu dN A^T s n^T A  +  mu |N| eps_T / |t_tr| A^T ( a^ij rho_i rho_j^T - s s^T ) A
//! both   rotational        - ( A^T rho^j t^T B_j + B_j^T t rho^jT A )
//!        curvature         + t_i h^ij A^T ( rho_j n^T + n rho_j^T ) A
//!        normal-rotational + t_i a^ij ( A^T n n^T B_j + B_j^T n n^T A )
//! slip   metric-rotational + mu |N| A^T s s^k s^T B_k
//! ```
//!
//! The published parts are the exact tangent of the rate law
//! `t_i' = (eps_T a_ij + Gamma_ij^k t_k) xi^j'` as `xi3` goes to zero on a fixed rigid master. On a master that moves the last
//! two lines are missing from them, whatever `xi3` is.
use crate::contact::kernel::{Normal, SlotMatrix, in_slot};
use covact_geometry::Frame;
use nalgebra::{Matrix3, Vector3};
use num_dual::DualNum;

/// Which parts beyond the main one are included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrictionParts {
    /// The part of turning tangents.
    pub rotational: bool,
    /// The part of the curvature `h^ij`.
    pub curvature: bool,
    /// Not published: what a change of the tangents along the normal does.
    pub normal_rotational: bool,
    /// Not published: how the norm of the traction changes with the tangents while the point slides.
    pub metric_rotational: bool,
}

impl FrictionParts {
    /// The main part alone.
    pub const MAIN: FrictionParts = FrictionParts {
        rotational: false,
        curvature: false,
        normal_rotational: false,
        metric_rotational: false,
    };
    /// The published form.
    pub const PUBLISHED: FrictionParts = FrictionParts {
        rotational: true,
        curvature: true,
        ..FrictionParts::MAIN
    };
    /// The published form with what it leaves out on a master that moves.
    pub const COMPLETE: FrictionParts = FrictionParts {
        normal_rotational: true,
        metric_rotational: true,
        ..FrictionParts::PUBLISHED
    };
}

/// Tangent of a point of unit weight that sticks with the traction `t` in the tangent plane, under the tangential penalty
/// `eps_t`. Symmetric; the metric-rotational part belongs to sliding.
pub fn stick_tangent<D: DualNum<f64> + Copy>(
    frame: &Frame<D>,
    t: &Vector3<D>,
    eps_t: D,
    parts: FrictionParts,
) -> SlotMatrix<D> {
    main(&(metric(frame) * eps_t)) + geometric(frame, t, parts)
}

/// Tangent of a point of unit weight that slides under Coulomb's law with coefficient `mu`, towards the trial traction
/// `trial` in the tangent plane (not zero), under the tangential penalty `eps_t`. Unsymmetric.
pub fn slip_tangent<D: DualNum<f64> + Copy>(
    frame: &Frame<D>,
    trial: &Vector3<D>,
    normal: &Normal<D>,
    mu: D,
    eps_t: D,
    parts: FrictionParts,
) -> SlotMatrix<D> {
    let norm = trial.dot(trial).sqrt();
    let s = trial * norm.recip();
    let limit = -mu * normal.n;
    let across = metric(frame) - s * s.transpose();
    let block = across * (limit * eps_t / norm) - s * frame.n.transpose() * (mu * normal.dn);
    let mut k = main(&block) + geometric(frame, &(s * limit), parts);
    if parts.metric_rotational {
        let a = in_slot(0, &s);
        for (k_index, up) in frame.rho_up().iter().enumerate() {
            let b = in_slot(k_index + 1, &(s * up.dot(&s)));
            k += a * b.transpose() * limit;
        }
    }
    k
}

/// `a^ij rho_i x rho_j`, which is `I - n x n`.
fn metric<D: DualNum<f64> + Copy>(frame: &Frame<D>) -> Matrix3<D> {
    let up = frame.rho_up();
    up[0] * frame.rho_i[0].transpose() + up[1] * frame.rho_i[1].transpose()
}

fn main<D: DualNum<f64> + Copy>(block: &Matrix3<D>) -> SlotMatrix<D> {
    let mut k = SlotMatrix::from_element(D::zero());
    k.fixed_view_mut::<3, 3>(0, 0).copy_from(block);
    k
}

fn geometric<D: DualNum<f64> + Copy>(
    frame: &Frame<D>,
    t: &Vector3<D>,
    parts: FrictionParts,
) -> SlotMatrix<D> {
    let mut k = SlotMatrix::from_element(D::zero());
    let g3 = in_slot(0, &frame.n);
    let up = frame.rho_up();
    if parts.rotational {
        for (j, up) in up.iter().enumerate() {
            let (y, turned) = (in_slot(0, up), in_slot(j + 1, t));
            k -= y * turned.transpose() + turned * y.transpose();
        }
    }
    if parts.curvature {
        // t_i h^ij rho_j
        let [h11, h12, h22] = frame.h;
        let of = [up[0].dot(t), up[1].dot(t)];
        let bent = up[0] * (h11 * of[0] + h12 * of[1]) + up[1] * (h12 * of[0] + h22 * of[1]);
        let bent = in_slot(0, &bent);
        k += bent * g3.transpose() + g3 * bent.transpose();
    }
    if parts.normal_rotational {
        for (j, up) in up.iter().enumerate() {
            let c = in_slot(j + 1, &(frame.n * up.dot(t)));
            k += g3 * c.transpose() + c * g3.transpose();
        }
    }
    k
}
