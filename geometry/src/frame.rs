//! Local frame of a surface point: normal, metric, curvature and Christoffel symbols.
//!
//! Notation and signs follow A. Konyukhov and K. Schweizerhof, "Computational Contact Mechanics" (Springer, 2013),
//! chapter 2: `n` points out of the master, `h_ij = rho_ij . n`, so a convex master has negative curvatures.

use num_dual::DualNum;

use crate::surface::{Jet, Vec3};

/// A frame is refused where `|rho_1 x rho_2|` is below this fraction of the larger squared tangent.
pub(crate) const DEGENERATE: f64 = 1e-12;

/// The local frame of a surface point: everything the covariant contact formulas ask of a surface.
///
/// ```
/// use covact_geometry::{Frame, NurbsPatch, Surface, Vec3};
/// // A quarter of a cylinder of radius 2 about the z axis.
/// let points = [[2., 0., 0.], [2., 2., 0.], [0., 2., 0.], [2., 0., 3.], [2., 2., 3.], [0., 2., 3.]].map(Vec3::from);
/// let (w, knots) = (0.5f64.sqrt(), [vec![0., 0., 0., 1., 1., 1.], vec![0., 0., 1., 1.]]);
/// let patch = NurbsPatch::new([2, 1], knots, [3, 2], &points, Some(&[1., w, 1., 1., w, 1.]))?;
/// let frame = Frame::new(&patch.jet([0.5, 0.5]), 1.0).expect("tangents that span a plane");
/// // The normal points away from the axis, and the surface curves away from it by 1 / R.
/// let outward = Vec3::new(1.0, 1.0, 0.0).normalize();
/// assert!((frame.n - outward).norm() < 1e-12);
/// assert!((frame.h[0] / frame.a[0] + 0.5).abs() < 1e-12 && frame.h[2].abs() < 1e-12);
/// # Ok::<(), covact_geometry::PatchError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<D = f64> {
    /// Surface point.
    pub rho: Vec3<D>,
    /// Tangents rho_1, rho_2.
    pub rho_i: [Vec3<D>; 2],
    /// Second derivatives rho_11, rho_12, rho_22.
    pub rho_ij: [Vec3<D>; 3],
    /// Outward unit normal `side * (rho_1 x rho_2) / |..|`.
    pub n: Vec3<D>,
    /// Metric a_11, a_12, a_22.
    pub a: [D; 3],
    /// Inverse metric a^11, a^12, a^22.
    pub a_inv: [D; 3],
    /// Curvature h_ij = rho_ij . n: h_11, h_12, h_22 (negative on a convex master with outward normal).
    pub h: [D; 3],
    /// `sqrt(det a)`.
    pub area: D,
}

impl<D: DualNum<f64> + Copy> Frame<D> {
    /// Frame of a jet; `side` is +1 where `rho_1 x rho_2` points out of the master and -1 where it points in.
    /// `None` where the tangents do not span a plane (a pole, a collapsed edge, parallel tangents) or are not finite:
    /// `|rho_1 x rho_2| <= 1e-12 max(a_11, a_22)`.
    #[inline(always)]
    pub fn new(jet: &Jet<D>, side: f64) -> Option<Self> {
        let [r1, r2] = jet.rho_i;
        let a = [r1.dot(&r1), r1.dot(&r2), r2.dot(&r2)];
        let cross = r1.cross(&r2);
        // det a = |rho_1 x rho_2|^2; the cross product loses fewer digits than a_11 a_22 - a_12^2.
        let det = cross.dot(&cross);
        let largest = a[0].re().max(a[2].re());
        let (area, limit) = (det.re().sqrt(), DEGENERATE * largest);
        if !(area > limit && area.is_finite() && largest.is_finite()) {
            return None;
        }
        let area = det.sqrt();
        let inv_det = det.recip();
        let n = cross * (area.recip() * side);
        Some(Self {
            rho: jet.rho,
            rho_i: jet.rho_i,
            rho_ij: jet.rho_ij,
            n,
            a,
            a_inv: [a[2] * inv_det, -a[1] * inv_det, a[0] * inv_det],
            h: [
                jet.rho_ij[0].dot(&n),
                jet.rho_ij[1].dot(&n),
                jet.rho_ij[2].dot(&n),
            ],
            area,
        })
    }

    /// Contravariant tangents `rho^i = a^ij rho_j`.
    pub fn rho_up(&self) -> [Vec3<D>; 2] {
        let [r1, r2] = self.rho_i;
        let [a11, a12, a22] = self.a_inv;
        [r1 * a11 + r2 * a12, r1 * a12 + r2 * a22]
    }

    /// Christoffel symbols `Gamma^k_ij = rho_ij . rho^k`: `[k][11, 12, 22]`.
    pub fn christoffel(&self) -> [[D; 3]; 2] {
        self.rho_up().map(|up| self.rho_ij.map(|r| r.dot(&up)))
    }

    /// Mixed curvature `h_i^k = h_ij a^jk`: `[i][k]`.
    pub fn h_mixed(&self) -> [[D; 2]; 2] {
        let [h11, h12, h22] = self.h;
        let [a11, a12, a22] = self.a_inv;
        [
            [h11 * a11 + h12 * a12, h11 * a12 + h12 * a22],
            [h12 * a11 + h22 * a12, h12 * a12 + h22 * a22],
        ]
    }

    /// Contravariant curvature `h^ij = a^ik a^jl h_kl`: 11, 12, 22.
    pub fn h_inv(&self) -> [D; 3] {
        let mixed = self.h_mixed();
        let [a11, a12, a22] = self.a_inv;
        [
            a11 * mixed[0][0] + a12 * mixed[1][0],
            a11 * mixed[0][1] + a12 * mixed[1][1],
            a12 * mixed[0][1] + a22 * mixed[1][1],
        ]
    }

    /// Derivatives of the normal, `n_,i = -h_i^k rho_k` (Weingarten).
    pub fn n_i(&self) -> [Vec3<D>; 2] {
        self.h_mixed()
            .map(|row| -(self.rho_i[0] * row[0] + self.rho_i[1] * row[1]))
    }

    /// Principal curvatures, the smaller first: eigenvalues of `h_i^k`, taken in an orthonormal basis of the tangent
    /// plane so that both are real whatever the rounding. With dual numbers their derivatives are not finite at an
    /// umbilic, where both are equal.
    pub fn principal_curvatures(&self) -> [D; 2] {
        // Basis e_1 = rho_1 / |rho_1|, e_2 = (rho_2 - (rho_2 . e_1) e_1) / |..| with |..| = area / |rho_1|.
        let [a11, a12, _] = self.a;
        let [h11, h12, h22] = self.h;
        let c = a12 / a11;
        let first = h11 / a11;
        let mixed = (h12 - h11 * c) / self.area;
        let second = (h22 - h12 * c * 2.0 + h11 * c * c) * a11 / (self.area * self.area);
        let mean = (first + second) * 0.5;
        let half = (first - second) * 0.5;
        let radius = (half * half + mixed * mixed).sqrt();
        [mean - radius, mean + radius]
    }
}
