//! The tangential traction by its rate law in covariant components, on one patch: a reference for the attraction point.
//!
//! ```text
//! t_i' = (eps_T a_ij + Gamma_ij^k t_k) xi^j'
//! ```
//!
//! is eq. (4) of Konyukhov & Schweizerhof, Comput. Mech. 35 (2005), for the traction on the slave's side (internal force
//! positive, the negative of theirs). The Christoffel symbols carry the traction over the surface in parallel; the term
//! `- h_i^k t_k xi3'` of the paper belongs to components at the slave point, not to those at its foot, and is left out.
//!
//! Nothing that runs uses this: components mean nothing beyond the patch, and steps must be small where its parameters bend.
use covact_geometry::{Frame, Vec3};

/// Traction at a place of a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CovariantTraction {
    /// Surface coordinates of the place.
    pub xi: [f64; 2],
    /// Covariant components `t_i` (force / length).
    pub t: [f64; 2],
}

impl CovariantTraction {
    /// A vector of the tangent plane at `xi`, where the patch has `frame`.
    pub fn new(xi: [f64; 2], frame: &Frame, vector: &Vec3) -> Self {
        CovariantTraction {
            xi,
            t: frame.rho_i.map(|r| r.dot(vector)),
        }
    }

    /// The traction in space (force / length^2); `frame` is that at its place.
    pub fn vector(&self, frame: &Frame) -> Vec3 {
        let up = frame.rho_up();
        up[0] * self.t[0] + up[1] * self.t[1]
    }

    /// The rate law over a straight step in the parameters to `xi`, by the implicit midpoint rule: of second order in the step.
    /// `middle` is the frame half way. Without a penalty this is parallel transport.
    ///
    /// `None` for a step so long that the rule has no solution.
    pub fn moved(&self, xi: [f64; 2], middle: &Frame, eps_t: f64) -> Option<Self> {
        let step = [xi[0] - self.xi[0], xi[1] - self.xi[1]];
        let [a11, a12, a22] = middle.a;
        let stretch = [
            eps_t * (a11 * step[0] + a12 * step[1]),
            eps_t * (a12 * step[0] + a22 * step[1]),
        ];
        // g_i^k = Gamma_ij^k step^j: (I - g / 2) t_1 = (I + g / 2) t_0 + stretch
        let gamma = middle.christoffel();
        let g = [0, 1].map(|i| [0, 1].map(|k| gamma[k][i] * step[0] + gamma[k][i + 1] * step[1]));
        let right = [0, 1]
            .map(|i| self.t[i] + 0.5 * (g[i][0] * self.t[0] + g[i][1] * self.t[1]) + stretch[i]);
        let [m11, m12] = [1.0 - 0.5 * g[0][0], -0.5 * g[0][1]];
        let [m21, m22] = [-0.5 * g[1][0], 1.0 - 0.5 * g[1][1]];
        let det = m11 * m22 - m12 * m21;
        (det > 0.0).then(|| CovariantTraction {
            xi,
            t: [
                (m22 * right[0] - m12 * right[1]) / det,
                (m11 * right[1] - m21 * right[0]) / det,
            ],
        })
    }

    /// Norm `sqrt(a^ij t_i t_j)`; `frame` is that at the traction's place.
    pub fn norm(&self, frame: &Frame) -> f64 {
        let ([a, b, c], [t1, t2]) = (frame.a_inv, self.t);
        (a * t1 * t1 + 2.0 * b * t1 * t2 + c * t2 * t2).sqrt()
    }

    /// Return to Coulomb's limit `mu |N|` (force / length^2), along the traction; whether the point slides.
    pub fn returned(&self, frame: &Frame, limit: f64) -> (Self, bool) {
        let norm = self.norm(frame);
        if norm <= limit {
            return (*self, false);
        }
        let t = self.t.map(|t| t * limit / norm);
        (CovariantTraction { t, ..*self }, true)
    }
}
