//! A rigid body in the slots of a contact point: its translation and spin instead of nodes.
//!
//! A rigid master that moves by `dc` and turns by `exp(dtheta)` about the point `c` carries its surface along:
//!
//! ```text
//! drho = dc + dtheta x p,   drho_,i = dtheta x rho_,i        p = rho - c
//! slots = B (dc, dtheta),   B = [ -I  [p] ;  0  -[rho_1] ;  0  -[rho_2] ]     [p] v = p x v
//! ```
//!
//! so its generalised force is `B^T R` and its tangent `B^T K B`, plus what the rotation's second order does to the
//! residual: with `exp(theta) p = p + theta x p + 1/2 theta x (theta x p) + ..` the second derivative is
//! `D^2 p [theta, eta] = 1/2 (theta x (eta x p) + eta x (theta x p))`, and a vector `f` that works on `p` adds
//!
//! ```text
//! f . D^2 p [theta, eta] = theta . S(f, p) eta,    S(f, p) = 1/2 (p x f + f x p) - (f . p) I      (dyads)
//! ```
//!
//! The tangent is that of the work in the coordinates `(dc, dtheta)` at zero, and symmetric. The moment itself, which is
//! what a balance of moments equates, changes by [`moment_turn`] more (see there).
use super::kernel::{NodeRow, SlotMatrix, Slots};
use super::point::PointGeometry;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use num_dual::DualNum;

/// Vector over the motion of a rigid body: translation, spin.
pub type Motion<D = f64> = SVector<D, 6>;
/// Tangent over the motion of a rigid body.
pub type MotionMatrix<D = f64> = SMatrix<D, 6, 6>;
/// A contact tangent with columns of a rigid body's motion and rows in the slots, `K B`.
pub type MotionColumns<D = f64> = SMatrix<D, 9, 6>;

/// A rigid body's place in the slots of a contact point, in space coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidRows<D = f64> {
    /// `rho - c`: from the body's centre to the foot (length).
    pub arm: Vector3<D>,
    /// Tangents `rho_1`, `rho_2` of the surface at the foot.
    pub rho_i: [Vector3<D>; 2],
}

impl<D: DualNum<f64> + Copy> RigidRows<D> {
    /// Rows of the body that carries the master surface. On an edge only the tangent along it matters, and at a vertex or
    /// a pole none.
    pub fn new(arm: Vector3<D>, geometry: &PointGeometry<D>) -> Self {
        let zero = Vector3::from_element(D::zero());
        let rho_i = match geometry {
            PointGeometry::Face { frame, .. } => frame.rho_i,
            // Any pair with direction_i rho_i = rho'.
            PointGeometry::Edge {
                direction: [a, b],
                rho_s,
                ..
            } => {
                let scale = (*a * *a + *b * *b).recip();
                [rho_s * (*a * scale), rho_s * (*b * scale)]
            }
            PointGeometry::Vertex { .. } | PointGeometry::Pole { .. } => [zero; 2],
        };
        RigidRows { arm, rho_i }
    }

    /// Generalised forces on the body: force and moment about its centre, internal forces positive (a body pressed upon
    /// feels their negative).
    pub fn force(&self, r: &Slots<D>) -> Motion<D> {
        let [r0, r1, r2] = parts(r);
        let moment = r0.cross(&self.arm) + self.rho_i[0].cross(&r1) + self.rho_i[1].cross(&r2);
        let mut out = Motion::from_element(D::zero());
        for k in 0..3 {
            out[k] = -r0[k];
            out[3 + k] = moment[k];
        }
        out
    }

    /// `K B`: columns of the body's motion, rows in the slots. A node's 3 x 6 block follows with [`node_block`].
    pub fn columns(&self, k: &SlotMatrix<D>) -> MotionColumns<D> {
        // Every row of K is a residual by columns.
        let mut out = MotionColumns::from_element(D::zero());
        for row in 0..9 {
            let r = Slots::from_fn(|c, _| k[(row, c)]);
            let f = self.force(&r);
            (0..6).for_each(|c| out[(row, c)] = f[c]);
        }
        out
    }

    /// Tangent of the body's own motion, 6 x 6, from the residual and from [`Self::columns`].
    pub fn tangent(&self, r: &Slots<D>, columns: &MotionColumns<D>) -> MotionMatrix<D> {
        let mut out = MotionMatrix::from_element(D::zero());
        for c in 0..6 {
            let column = Slots::from_fn(|row, _| columns[(row, c)]);
            let f = self.force(&column);
            (0..6).for_each(|row| out[(row, c)] = f[row]);
        }
        let [r0, r1, r2] = parts(r);
        let second = second_order(&-r0, &self.arm)
            + second_order(&r1, &self.rho_i[0])
            + second_order(&r2, &self.rho_i[1]);
        for i in 0..3 {
            for j in 0..3 {
                out[(3 + i, 3 + j)] += second[(i, j)];
            }
        }
        out
    }
}

/// Rows of a node against the columns of a body's motion: the derivative of the node's force, 3 x 6. Where the tangent is
/// symmetric the transposed block couples the body's force with the node.
pub fn node_block(columns: &MotionColumns, row: &NodeRow) -> SMatrix<f64, 3, 6> {
    (0..3).fold(SMatrix::zeros(), |block, a| {
        block + columns.fixed_rows::<3>(3 * a) * row[a]
    })
}

/// What the derivative of a moment in space has over that of its coordinates in `exp(dtheta)`: `-1/2 [m]`, so that
/// `dm = (K_theta,theta + moment_turn(m)) dtheta + ..`. It is antisymmetric, and the sum over all moments that act on the
/// body vanishes at equilibrium where these derive from a potential; a moment kept constant in space does not, and leaves
/// the exact tangent of the balance unsymmetric.
pub fn moment_turn<D: DualNum<f64> + Copy>(moment: &Vector3<D>) -> Matrix3<D> {
    let m = moment * D::from(-0.5);
    let zero = D::zero();
    Matrix3::new(
        zero, -m.z, m.y, //
        m.z, zero, -m.x, //
        -m.y, m.x, zero,
    )
}

/// `S(f, p)`.
fn second_order<D: DualNum<f64> + Copy>(f: &Vector3<D>, p: &Vector3<D>) -> Matrix3<D> {
    let dyad = p * f.transpose();
    let mut s = (dyad + dyad.transpose()) * D::from(0.5);
    let dot = f.dot(p);
    (0..3).for_each(|k| s[(k, k)] -= dot);
    s
}

fn parts<D: DualNum<f64> + Copy>(r: &Slots<D>) -> [Vector3<D>; 3] {
    [0, 3, 6].map(|k| Vector3::new(r[k], r[k + 1], r[k + 2]))
}
