//! The response of a contact point with friction on a master that moves, in the slots of [`kernel`].
//!
//! The virtual work of a tangential traction `T` on the slave is
//!
//! ```text
//! T . (dr_s - drho) + xi3 (rho^i . T) n . drho_,i
//! ```
//!
//! conjugate to the slip at the slave point. Its first part acts in slot 0 like the normal traction, as a pair of opposite
//! forces at the slave point and at its foot; these are `xi3` apart and leave a moment `xi3 n x T`, which the second part,
//! `xi3 (rho^i . T) n` in slots 1 and 2, takes up. This is the [`Full`] form, whose two sides balance in force and moment;
//! the [`Reduced`] form leaves the second part out, as is usual where `xi3` is small.
//!
//! On an edge of the master, where a foot has a line and no plane around it, the slip along the line is conjugate to
//! `xi3 tau n . drho'`, `tau = T . rho' / |rho'|^2`: what is left of the second part, so that a point at the border of a face
//! does the same work on either side of it. A moment of `|xi3|` times the traction across the edge is left there, and
//! at a vertex one of `|xi3| |T|`, per area.
//!
//! ```text
//! T_tr = P v,  P = I - n x n       dT_tr = P dv - (n . v) dn - n (v . dn)       dn = -rho^i q_i
//! dT   = T,trial dT_tr + T,n dn - T,p dN + T,e de        v = lambda + eps_T phi (r_s - base), see [`Pull`];  e: [`Heading`]
//! tau^i = rho^i . T        dtau^i = rho^i . dT - tau^j rho^i . (drho_,j + rho_,jk X^k)
//! ```
//!
//! The foot travels over the shape functions of the master by `X^m`, and what acts there with it: rows `-T x X^m` in
//! slot `m` and, in the full form, `xi3 tau^i n x X^m` in the slots of `drho_,im` ([`Response::travel`]). The published
//! tangents (Konyukhov & Schweizerhof, Comput. Mech. 35 (2005)) are those of a master that stands still, at `xi3 = 0`.
use super::anchor::{Columns, Pull, dual};
use super::heading::Heading;
use super::law::{FrictionLaw, Slip};
use crate::contact::corner;
use crate::contact::kernel::{self, Normal, SlotMatrix, Slots, in_slot};
use crate::contact::point::{PointGeometry, respond};
use crate::contact::rigid::Exact;
use nalgebra::Vector3;
use num_dual::DualNum;

/// Which virtual work the tangential traction does: a type, so that the choice is made outside the loop over points.
pub trait Form: Sync {
    /// Whether slots 1 and 2 take up the moment of the traction about the foot.
    const FULL: bool;
}

/// Balances force and moment of the two sides.
#[derive(Debug, Clone, Copy)]
pub struct Full;
/// Balances forces only; a moment `|xi3| |T|` per area is left. For passes that act on their slave alone nothing is lost.
#[derive(Debug, Clone, Copy)]
pub struct Reduced;

impl Form for Full {
    const FULL: bool = true;
}
impl Form for Reduced {
    const FULL: bool = false;
}

/// Response of a contact point of unit weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<D = f64> {
    /// Generalised forces of both tractions in the nine slots (force / length^2; times length in slots 1 and 2).
    pub residual: Slots<D>,
    /// Their derivative with respect to the slots at the foot. It has no symmetry.
    pub tangent: SlotMatrix<D>,
    /// Their derivative with respect to the slots at the attraction point.
    pub anchor: SlotMatrix<D>,
    /// How the foot travels: `dxi^m = travel[m] . slots`. With the residual `R_i` in slots 1 and 2 the rows in the slots of
    /// `drho_,11`, `drho_,12` and `drho_,22` are `R_1 x X^1`, `R_1 x X^2 + R_2 x X^1` and `R_2 x X^2`.
    pub travel: [Slots<D>; 2],
    /// Trial traction.
    pub trial: Vector3<D>,
    /// Tangential traction under the law.
    pub slip: Slip<D>,
}

/// Residual and exact tangent of a contact point with friction. `pull` is what the history makes of its position,
/// `heading` the direction there of a law that knows one.
#[inline]
pub fn respond_with_friction<D: DualNum<f64> + Copy, F: FrictionLaw, M: Form>(
    geometry: &PointGeometry<D>,
    normal: &Normal<D>,
    law: &F,
    pull: &Pull<D>,
    heading: Option<&Heading<D>>,
    _form: &M,
) -> Response<D> {
    let (mut residual, mut tangent) = respond(geometry, normal, &Exact);
    let n = geometry.normal();
    let g3 = in_slot(0, &n);
    let (turn, travel) = follow(geometry, &n);
    let v = &pull.v;
    let along = v.dot(&n);
    let trial = v - n * along;
    // Nothing of it is left for laws without a direction.
    let heading = law.direction().and(heading);
    let (slip, headed) = match heading {
        None => (law.slip(&trial, &n, -normal.n), None),
        Some(heading) => {
            let (slip, by_direction) = law.slip_along(&trial, &n, -normal.n, &heading.e);
            (slip, Some(by_direction * heading.columns(&travel)))
        }
    };
    let t = slip.t;
    let project = |m: &Columns<D>| m - n * (n.transpose() * m);
    let d_trial =
        project(&(pull.along_gap * g3.transpose())) - turn * along - n * (v.transpose() * turn);
    let mut dt = slip.d_trial * d_trial + slip.d_normal * turn
        - slip.d_pressure * g3.transpose() * normal.dn;
    if let Some(headed) = headed {
        dt += headed;
    }
    let dt_anchor = slip.d_trial * project(&pull.columns);
    let mut anchor = SlotMatrix::from_element(D::zero());

    add_rows(&mut residual, 0, &t);
    add(&mut tangent, 0, &dt);
    add(&mut anchor, 0, &dt_anchor);
    for (m, x) in travel.iter().enumerate() {
        add(&mut tangent, 1 + m, &(-t * x.transpose()));
    }
    if M::FULL
        && let PointGeometry::Edge {
            d,
            xi3,
            direction,
            rho_s,
            rho_ss,
        } = geometry
    {
        let ds = travel_along(d, direction, rho_s, rho_ss);
        let shorter = rho_s.dot(rho_s).recip();
        let tau = rho_s.dot(&t) * shorter;
        // d(T . rho' - tau rho' . rho')
        let stretch = t - rho_s * (tau * 2.0);
        let mut drho_s = ds * rho_ss.dot(&stretch);
        for (i, part) in direction.iter().enumerate() {
            drho_s += in_slot(1 + i, &stretch) * *part;
        }
        let dtau = (dt.transpose() * rho_s + drho_s) * shorter;
        let dtau_anchor = dt_anchor.transpose() * rho_s * shorter;
        let rows = n * (g3 * tau + dtau * *xi3).transpose() + turn * (*xi3 * tau);
        let rows_anchor = n * (dtau_anchor * *xi3).transpose();
        for (i, part) in direction.iter().enumerate() {
            add_rows(&mut residual, 1 + i, &(n * (*xi3 * tau * *part)));
            add(&mut tangent, 1 + i, &(rows * *part));
            add(&mut anchor, 1 + i, &(rows_anchor * *part));
        }
    }
    if M::FULL
        && let PointGeometry::Face { frame, xi3 } = geometry
    {
        let up = dual(frame);
        let tau = [up[0].dot(&t), up[1].dot(&t)];
        // Second derivatives rho_,jk.
        let second = |j: usize, k: usize| &frame.rho_ij[j + k];
        for i in 0..2 {
            let mut dtau: Slots<D> = dt.transpose() * up[i];
            for (j, tau) in tau.iter().enumerate() {
                let mut stretch = in_slot(1 + j, &up[i]);
                for (k, x) in travel.iter().enumerate() {
                    stretch += x * up[i].dot(second(j, k));
                }
                dtau -= stretch * *tau;
            }
            add_rows(&mut residual, 1 + i, &(n * (*xi3 * tau[i])));
            let rows = n * (g3 * tau[i] + dtau * *xi3).transpose() + turn * (*xi3 * tau[i]);
            add(&mut tangent, 1 + i, &rows);
            let rows = n * (dt_anchor.transpose() * up[i] * *xi3).transpose();
            add(&mut anchor, 1 + i, &rows);
        }
    }
    Response {
        residual,
        tangent,
        anchor,
        travel,
        trial,
        slip,
    }
}

/// How the unit normal turns and how the foot travels.
fn follow<D: DualNum<f64> + Copy>(
    geometry: &PointGeometry<D>,
    n: &Vector3<D>,
) -> (Columns<D>, [Slots<D>; 2]) {
    let still = [Slots::from_element(D::zero()); 2];
    match geometry {
        PointGeometry::Face { frame, xi3 } => {
            let kernel::Rows { x, q, .. } = kernel::rows(frame, *xi3);
            let up = dual(frame);
            let turn = -(up[0] * q[0].transpose() + up[1] * q[1].transpose());
            (turn, x)
        }
        PointGeometry::Edge {
            d,
            xi3,
            direction,
            rho_s,
            rho_ss,
        } => {
            let ds = travel_along(d, direction, rho_s, rho_ss);
            let turn = (across(n) - rho_s * ds.transpose()) * xi3.recip();
            (turn, direction.map(|t| ds * t))
        }
        PointGeometry::Vertex { xi3, .. } => (across(n) * xi3.recip(), still),
        PointGeometry::Pole { .. } => (Columns::from_element(D::zero()), still),
    }
}

/// How the foot travels along an edge.
fn travel_along<D: DualNum<f64> + Copy>(
    d: &Vector3<D>,
    direction: &[D; 2],
    rho_s: &Vector3<D>,
    rho_ss: &Vector3<D>,
) -> Slots<D> {
    corner::along_edge(d, direction, rho_s) * corner::curvature(d, rho_s, rho_ss).recip()
}

/// `I - n x n` in slot 0.
fn across<D: DualNum<f64> + Copy>(n: &Vector3<D>) -> Columns<D> {
    let block = super::law::diagonal(D::one()) - n * n.transpose();
    let mut out = Columns::from_element(D::zero());
    out.fixed_columns_mut::<3>(0).copy_from(&block);
    out
}

fn add_rows<D: DualNum<f64> + Copy>(r: &mut Slots<D>, slot: usize, v: &Vector3<D>) {
    for k in 0..3 {
        r[3 * slot + k] += v[k];
    }
}

fn add<D: DualNum<f64> + Copy>(k: &mut SlotMatrix<D>, slot: usize, rows: &Columns<D>) {
    let mut view = k.fixed_rows_mut::<3>(3 * slot);
    view += rows;
}
