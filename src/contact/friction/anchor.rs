//! The attraction point of a slave point on a surface that moves: a material point of it.
//!
//! It is kept as a facet with parameters `xi` and the components, along `rho_1`, `rho_2` and `n` of the facet there, of its
//! distance from the facet; the traction that the base was set with has components of the same kind. Both so turn and
//! stretch with the surface (convected components), and no motion of the pair as a whole leaves a trace in them.
//!
//! Their columns are those of three slots at the attraction point, `dr_s - drho`, `drho_,1` and `drho_,2`: the slots of
//! [`kernel`](crate::contact::kernel), at another place.
use super::trial::after_impact;
use covact_geometry::{Frame, Jet};
use nalgebra::{Matrix3, SMatrix, Vector3};
use num_dual::DualNum;

/// Derivative of a vector with respect to three slots.
pub type Columns<D = f64> = SMatrix<D, 3, 9>;

/// What a facet looks like at an attraction point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor<D = f64> {
    /// The attraction point.
    pub rho: Vector3<D>,
    /// The tangents `rho_1`, `rho_2` there.
    pub rho_i: [Vector3<D>; 2],
    /// `rho^1`, `rho^2`.
    pub dual: [Vector3<D>; 2],
    /// Unit normal.
    pub n: Vector3<D>,
}

impl<D: DualNum<f64> + Copy> Anchor<D> {
    /// Of the jet of a facet; `None` where its tangents span no plane.
    pub fn new(jet: &Jet<D>) -> Option<Self> {
        let frame = Frame::new(jet, 1.0)?;
        Some(Anchor {
            rho: frame.rho,
            rho_i: frame.rho_i,
            dual: dual(&frame),
            n: frame.n,
        })
    }

    /// The vector with the given components along `rho_1`, `rho_2` and `n`.
    pub fn vector(&self, components: &Vector3<f64>) -> Vector3<D> {
        let c = components.map(D::from);
        self.rho_i[0] * c.x + self.rho_i[1] * c.y + self.n * c.z
    }

    /// Components of a vector along `rho_1`, `rho_2` and `n`.
    pub fn components(&self, v: &Vector3<D>) -> Vector3<D> {
        Vector3::new(self.dual[0].dot(v), self.dual[1].dot(v), self.n.dot(v))
    }
}

/// `rho^1`, `rho^2` of a frame.
pub(super) fn dual<D: DualNum<f64> + Copy>(frame: &Frame<D>) -> [Vector3<D>; 2] {
    let ([r1, r2], a) = (&frame.rho_i, &frame.a_inv);
    [r1 * a[0] + r2 * a[1], r1 * a[1] + r2 * a[2]]
}

/// What pulls at a slave point before the law and the tangent plane are asked:
/// `v = lambda + eps_T phi (r_s - base)` (force / length^2), with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pull<D = f64> {
    /// The traction before the law and the tangent plane limit it (force / length^2).
    pub v: Vector3<D>,
    /// With respect to the slots at the attraction point (force / length^3).
    pub columns: Columns<D>,
    /// With respect to the gap (force / length^3).
    pub along_gap: Vector3<D>,
}

impl<D: DualNum<f64> + Copy> Pull<D> {
    /// On a slave point at `x` with gap `gap`, from components of `base` and `lambda` at `anchor`, with a tangential
    /// penalty `eps_t` and the `approach` of [`PointHistory`](super::history::PointHistory).
    pub fn new(
        anchor: &Anchor<D>,
        [base, lambda]: [&Vector3<f64>; 2],
        eps_t: f64,
        approach: f64,
        x: &Vector3<D>,
        gap: D,
    ) -> Self {
        let (phi, d_phi) = after_impact(approach, gap);
        let stiffness = phi * eps_t;
        let chord = x - anchor.rho - anchor.vector(base);
        // v is eps_T phi (r_s - rho) plus the vector with these components.
        let c = lambda.map(D::from) - base.map(D::from) * stiffness;
        let mut columns = Columns::from_element(D::zero());
        columns
            .fixed_columns_mut::<3>(0)
            .copy_from(&super::law::diagonal(stiffness));
        for (i, c_i) in [c.x, c.y].into_iter().enumerate() {
            // dn = -rho^i (n . drho_,i)
            let block: Matrix3<D> =
                super::law::diagonal(c_i) - anchor.dual[i] * anchor.n.transpose() * c.z;
            columns.fixed_columns_mut::<3>(3 + 3 * i).copy_from(&block);
        }
        Pull {
            v: anchor.vector(lambda) + chord * stiffness,
            columns,
            along_gap: chord * (d_phi * eps_t),
        }
    }

    /// Nothing pulls: a point that has met no facet before.
    pub fn none() -> Self {
        Pull {
            v: Vector3::from_element(D::zero()),
            columns: Columns::from_element(D::zero()),
            along_gap: Vector3::from_element(D::zero()),
        }
    }
}
