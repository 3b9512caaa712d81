//! Cauchy stress from the modified strain.
use super::VOIGT;
use super::kinematics::V;
use super::material::{Collapsed, LawState, MaterialLaw, Metric};
use super::reference::{GP, contravariant, det, sign};
use crate::fem::quadrature::GAUSS_3;
use covact_geometry::Vec3;
use nalgebra::Matrix3;
use num_dual::Dual64;

fn matrix(v: &[V<f64>; 3]) -> Matrix3<f64> {
    Matrix3::from_columns(&v.map(Vec3::from))
}

fn full(v: &[f64; 6], shear: f64) -> Matrix3<f64> {
    let (a, b, c) = (v[3] * shear, v[4] * shear, v[5] * shear);
    Matrix3::new(v[0], a, c, a, v[1], b, c, b, v[2])
}

/// Cauchy stress at one Gauss point with undeformed frame `big`, displacement derivatives `du` and covariant strain.
pub(super) fn cauchy<L: MaterialLaw>(
    law: &L,
    metric: &Metric,
    big: &[V<f64>; 3],
    du: &[V<f64>; 3],
    strain: &[f64; 6],
    old: &L::State,
) -> Result<[f64; 6], Collapsed> {
    let (_, s) = law.stress(metric, strain, old)?;
    let frame = matrix(big);
    let dual = matrix(&contravariant(big, det(big)));
    let stress = frame * full(&s, 1.0) * frame.transpose();
    let c = Matrix3::identity() + dual * full(strain, 0.5) * dual.transpose() * 2.0;
    let eigen = c.symmetric_eigen();
    let ratio = eigen.eigenvalues.product();
    if eigen.eigenvalues.min() <= 0.0 || !ratio.is_finite() {
        return Err(Collapsed { ratio });
    }
    let v = eigen.eigenvectors;
    let u = v * Matrix3::from_diagonal(&eigen.eigenvalues.map(f64::sqrt)) * v.transpose();
    let f = Matrix3::identity() + matrix(du) * dual.transpose();
    let svd = f.svd(true, true);
    let (Some(left), Some(right)) = (svd.u, svd.v_t) else {
        return Err(Collapsed {
            ratio: f.determinant(),
        });
    };
    let f = left * right * u;
    let sigma = f * stress * f.transpose() / ratio.sqrt();
    Ok(VOIGT.map(|(i, j)| sigma[(i, j)]))
}

/// Stress of Hooke's law at one Gauss point with undeformed frame `big`, from the derivative of the covariant strain along the
/// displacement: that of any law at vanishing strain.
pub(super) fn linear<L: MaterialLaw>(
    law: &L,
    metric: &Metric,
    big: &[V<f64>; 3],
    strain: &[Dual64; 6],
) -> Result<[f64; 6], Collapsed> {
    let tangent = law.response(metric, &[0.0; 6], &L::State::UNUSED)?.tangent;
    let s = tangent.map(|row| row.iter().zip(strain).map(|(c, e)| c * e.eps).sum());
    let frame = matrix(big);
    let sigma = frame * full(&s, 1.0) * frame.transpose();
    Ok(VOIGT.map(|(i, j)| sigma[(i, j)]))
}

/// A direction from the undeformed state.
pub(super) fn from_zero<const N: usize>(u: &[V<f64>; N]) -> [V<Dual64>; N] {
    u.map(|u| u.map(|u| Dual64::new(0.0, u)))
}

/// Extends values at the Gauss points of an element to its eight nodes, trilinearly.
pub fn extrapolate<const K: usize>(points: &[[f64; K]; 8]) -> [[f64; K]; 8] {
    let mut nodes = [[0.0; K]; 8];
    for (a, node) in nodes.iter_mut().enumerate() {
        for (g, point) in points.iter().enumerate() {
            // The node lies at -+1/GP in coordinates that put the Gauss points at -+1.
            let w = (0..3).fold(0.125, |w, bit| w * (1.0 + sign(a, bit) * sign(g, bit) / GP));
            for (n, p) in node.iter_mut().zip(point) {
                *n += w * p;
            }
        }
    }
    nodes
}

/// Extends values at the 3 x 3 x 2 Gauss points of a Q18 element to its nodes: linearly along each direction, after the
/// least squares fit that Gauss's weights make of the three points in the plane. That fit passes through the parabola's
/// values at the two-point Gauss points, where the strains of a quadratic element are more accurate than elsewhere
/// (J. Barlow, IJNME 10 (1976)).
pub fn extrapolate_quadratic<const K: usize>(points: &[[f64; K]; 18]) -> [[f64; K]; 18] {
    let line = |node: usize, point: usize| {
        let x = node as f64 - 1.0;
        GAUSS_3.weights()[point] * (0.5 + 1.5 * x * GAUSS_3.points()[point])
    };
    let mut nodes = [[0.0; K]; 18];
    for (a, node) in nodes.iter_mut().enumerate() {
        for (g, point) in points.iter().enumerate() {
            let through = 0.5 * (1.0 + if a / 9 == g / 9 { 1.0 } else { -1.0 } / GP);
            let w = line(a % 3, g % 3) * line(a / 3 % 3, g / 3 % 3) * through;
            for (n, p) in node.iter_mut().zip(point) {
                *n += w * p;
            }
        }
    }
    nodes
}
