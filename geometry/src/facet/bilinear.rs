//! Bilinear facets.

use num_dual::DualNum;

use super::FacetError;
use crate::bezier::BezierPiece;
use crate::surface::{Jet, Surface, Vec3};

/// Four-node facet `rho = sum_k N_k x_k`, `N_k = (1 +- xi1) (1 +- xi2) / 4`, over `[-1, 1]^2`; nodes (-,-), (+,-), (-,+),
/// (+,+). Two neighbouring nodes may be the same point (a triangle: that edge is a pole).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bilinear {
    nodes: [Vec3; 4],
}

impl Bilinear {
    /// The facet of four nodes, xi1 fastest.
    ///
    /// # Errors
    /// [`FacetError::Node`] where a coordinate is not finite.
    pub fn new(nodes: [Vec3; 4]) -> Result<Self, FacetError> {
        super::mesh::finite(&nodes)?;
        Ok(Self { nodes })
    }

    /// The nodes.
    pub fn nodes(&self) -> &[Vec3; 4] {
        &self.nodes
    }

    /// Shape functions `N_k` and their derivatives `N_k,1`, `N_k,2`, `N_k,12`; the other second derivatives are zero.
    #[inline]
    pub fn shape<D: DualNum<f64> + Copy>([r, s]: [D; 2]) -> [[D; 4]; 4] {
        let one = D::one();
        let quarter = D::from(0.25);
        let (a, b) = ([one - r, one + r], [one - s, one + s]);
        let n = |i: usize, j: usize| a[i] * b[j] * quarter;
        let (b0, b1, a0, a1) = (
            b[0] * quarter,
            b[1] * quarter,
            a[0] * quarter,
            a[1] * quarter,
        );
        [
            [n(0, 0), n(1, 0), n(0, 1), n(1, 1)],
            [-b0, b0, -b1, b1],
            [-a0, -a1, a0, a1],
            [quarter, -quarter, -quarter, quarter],
        ]
    }

    /// Jet of any nodes at any parameters, for dual numbers too.
    #[inline]
    pub fn jet_of<D: DualNum<f64> + Copy>(x: &[Vec3<D>; 4], [r, s]: [D; 2]) -> Jet<D> {
        let half = D::from(0.5);
        // Weights that are 0 and 1 at the ends, so that the corners are the nodes to the last digit.
        let ends = |t: D| [(D::one() - t) * half, (D::one() + t) * half];
        let ([left, right], [below, above]) = (ends(r), ends(s));
        let (d0, d1) = ((x[1] - x[0]) * half, (x[3] - x[2]) * half);
        let (low, high) = (x[0] * left + x[1] * right, x[2] * left + x[3] * right);
        let zero = Vec3::from_element(D::zero());
        Jet {
            rho: low * below + high * above,
            rho_i: [d0 * below + d1 * above, (high - low) * half],
            rho_ij: [zero, (d1 - d0) * half, zero],
        }
    }
}

impl Surface for Bilinear {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[-1.0, 1.0]; 2]
    }

    fn spans(&self, _dir: usize) -> Vec<[f64; 2]> {
        vec![[-1.0, 1.0]]
    }

    #[inline]
    fn find_span(&self, _xi: [f64; 2]) -> [usize; 2] {
        [0, 0]
    }

    #[inline]
    fn jet_in_span(&self, _span: [usize; 2], xi: [f64; 2]) -> Jet {
        Self::jet_of(&self.nodes, xi)
    }

    fn bezier_pieces(&self) -> Vec<BezierPiece> {
        vec![self.bezier_piece([0, 0])]
    }

    fn bezier_piece(&self, span: [usize; 2]) -> BezierPiece {
        BezierPiece {
            domain: self.domain(),
            span,
            degree: [1, 1],
            points: self.nodes.iter().map(|x| [x.x, x.y, x.z, 1.0]).collect(),
        }
    }
}
