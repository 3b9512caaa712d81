//! Biquadratic facets.

use num_dual::DualNum;

use super::FacetError;
use crate::bezier::BezierPiece;
use crate::surface::{Jet, Surface, Vec3};

/// Nine-node facet `rho = sum_ij L_i(xi1) L_j(xi2) x_(i + 3 j)` over `[-1, 1]^2` with the Lagrange polynomials of the nodes -1, 0,
/// 1. The three nodes of an edge may be the same point (a triangle: that edge is a pole).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Biquadratic {
    nodes: [Vec3; 9],
}

/// `L_i`, `L_i'` and `L_i''` of the nodes -1, 0, 1.
#[inline]
fn lagrange<D: DualNum<f64> + Copy>(r: D) -> [[D; 3]; 3] {
    let (half, one, two) = (D::from(0.5), D::one(), D::from(2.0));
    [
        [r * (r - one) * half, one - r * r, r * (r + one) * half],
        [r - half, -r * two, r + half],
        [one, -two, one],
    ]
}

impl Biquadratic {
    /// The facet of nine nodes, xi1 fastest.
    ///
    /// # Errors
    /// [`FacetError::Node`] where a coordinate is not finite.
    pub fn new(nodes: [Vec3; 9]) -> Result<Self, FacetError> {
        super::mesh::finite(&nodes)?;
        Ok(Self { nodes })
    }

    /// The nodes.
    pub fn nodes(&self) -> &[Vec3; 9] {
        &self.nodes
    }

    /// Shape functions `N_k` and their derivatives `N_k,1`, `N_k,2`, `N_k,11`, `N_k,12`, `N_k,22`.
    #[inline]
    pub fn shape<D: DualNum<f64> + Copy>([r, s]: [D; 2]) -> [[D; 9]; 6] {
        let (a, b) = (lagrange(r), lagrange(s));
        [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
            .map(|(m, n)| std::array::from_fn(|k| a[m][k % 3] * b[n][k / 3]))
    }

    /// Jet of any nodes at any parameters, for dual numbers too.
    #[inline]
    pub fn jet_of<D: DualNum<f64> + Copy>(x: &[Vec3<D>; 9], [r, s]: [D; 2]) -> Jet<D> {
        let (half, two) = (D::from(0.5), D::from(2.0));
        // A parabola through three points, in powers of its parameter.
        let powers = |a: Vec3<D>, b: Vec3<D>, c: Vec3<D>| {
            let (middle, slope) = ((a + c) * half - b, (c - a) * half);
            (b, slope, middle)
        };
        let row = |j: usize| {
            let (c0, c1, c2) = powers(x[3 * j], x[3 * j + 1], x[3 * j + 2]);
            [c0 + (c1 + c2 * r) * r, c1 + c2 * (r * two), c2 * two]
        };
        let rows = [row(0), row(1), row(2)];
        let [at, one, two_] =
            [0, 1, 2].map(|order| powers(rows[0][order], rows[1][order], rows[2][order]));
        Jet {
            rho: at.0 + (at.1 + at.2 * s) * s,
            rho_i: [one.0 + (one.1 + one.2 * s) * s, at.1 + at.2 * (s * two)],
            rho_ij: [
                two_.0 + (two_.1 + two_.2 * s) * s,
                one.1 + one.2 * (s * two),
                at.2 * two,
            ],
        }
    }
}

impl Surface for Biquadratic {
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

    /// Lagrange to Bernstein: the ends stay, the middle point becomes `2 b - (a + c) / 2`.
    fn bezier_piece(&self, span: [usize; 2]) -> BezierPiece {
        let mut x = self.nodes;
        let middle = |a: Vec3, b: Vec3, c: Vec3| b * 2.0 - (a + c) * 0.5;
        for j in 0..3 {
            x[3 * j + 1] = middle(x[3 * j], x[3 * j + 1], x[3 * j + 2]);
        }
        for i in 0..3 {
            x[i + 3] = middle(x[i], x[i + 3], x[i + 6]);
        }
        BezierPiece {
            domain: self.domain(),
            span,
            degree: [2, 2],
            points: x.iter().map(|x| [x.x, x.y, x.z, 1.0]).collect(),
        }
    }
}
