//! Rational Bezier pieces: VTK's node order and evaluation.
use covact_geometry::{NurbsPatch, bezier_pieces};

/// Highest degree that VTK's Bezier cells take (`vtkHigherOrderInterpolation::MaxDegree`).
pub const MAX_DEGREE: usize = 10;

/// Why a piece cannot be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BezierError {
    /// Not (p + 1) (q + 1) control points.
    #[error("degree {degree:?} needs {expected} control points, there are {found}")]
    PointCount {
        /// Degrees p and q.
        degree: [usize; 2],
        /// Points needed.
        expected: usize,
        /// Points found.
        found: usize,
    },
    /// A weight that is zero, negative or not a number.
    #[error("control point {point} has weight {weight}, which is not positive")]
    Weight {
        /// Place of the control point, xi1 fastest.
        point: usize,
        /// The weight.
        weight: f64,
    },
    /// A direction of degree zero.
    #[error("degree {0:?} has a zero")]
    Degree([usize; 2]),
}

/// One rational Bezier quadrilateral of a rigid surface.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePiece {
    /// Degrees along xi1 and xi2, at least 1.
    pub degree: [usize; 2],
    /// Homogeneous control points (wx, wy, wz, w), xi1 fastest; `(degree[0] + 1) (degree[1] + 1)` of them.
    pub points: Vec<[f64; 4]>,
    /// Number of the patch that the piece is part of.
    pub patch: u32,
    /// Number of the entity in the CAD file (0 for a surface that is not from a file).
    pub entity: u32,
    /// The outside is against `rho_1 x rho_2`. Such a piece is written with its parameters swapped, so that normals of
    /// the written cells point outside.
    pub reversed: bool,
    /// Quadrilaterals along xi1 and xi2 in the flat copy; `None`: as many as are asked for.
    pub divisions: Option<[u32; 2]>,
}

/// Point with outward unit normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PointNormal {
    pub point: [f64; 3],
    pub normal: [f64; 3],
}

impl SurfacePiece {
    /// The pieces of a NURBS patch: one per pair of non-empty spans, the same surface exactly. Of a trimmed patch those
    /// inside; along its trim curves flat pieces with corners on the curves.
    pub fn of_patch(surface: &NurbsPatch, patch: u32, entity: u32, reversed: bool) -> Vec<Self> {
        if let Some(trim) = surface.trim() {
            return super::trimmed::pieces(surface, trim, patch, entity, reversed);
        }
        bezier_pieces(surface)
            .into_iter()
            .map(|piece| SurfacePiece {
                degree: piece.degree,
                points: piece.points,
                patch,
                entity,
                reversed,
                divisions: None,
            })
            .collect()
    }

    pub(crate) fn check(&self) -> Result<(), BezierError> {
        if self.degree.contains(&0) {
            return Err(BezierError::Degree(self.degree));
        }
        let expected = (self.degree[0] + 1) * (self.degree[1] + 1);
        if self.points.len() != expected {
            return Err(BezierError::PointCount {
                degree: self.degree,
                expected,
                found: self.points.len(),
            });
        }
        match self
            .points
            .iter()
            .position(|p| p[3] <= 0.0 || p[3].is_nan())
        {
            Some(point) => Err(BezierError::Weight {
                point,
                weight: self.points[point][3],
            }),
            None => Ok(()),
        }
    }

    /// The piece with an outward `rho_1 x rho_2`.
    pub(crate) fn oriented(mut self) -> Self {
        if self.reversed {
            let [p, q] = self.degree;
            let swapped = (0..=p)
                .flat_map(|i| (0..=q).map(move |j| i + (p + 1) * j))
                .map(|k| self.points[k])
                .collect();
            self.points = swapped;
            self.degree = [q, p];
            self.divisions = self.divisions.map(|[u, v]| [v, u]);
            self.reversed = false;
        }
        self
    }

    /// Point and outward normal at parameters in [0, 1]; the piece is checked and oriented.
    pub(crate) fn evaluate(&self, u: f64, v: f64) -> PointNormal {
        let (point, cross) = self.point_and_cross(u, v);
        // Where a side of the piece is drawn together to a point, a tangent is zero: take the normal beside it, as near
        // as rounding lets it be seen.
        let normal = unit(cross).or_else(|| {
            [1e-7, 1e-5, 1e-3].iter().find_map(|step| {
                let inside = |t: f64| t + step * (0.5 - t);
                unit(self.point_and_cross(inside(u), inside(v)).1)
            })
        });
        PointNormal {
            point,
            normal: normal.unwrap_or([0.0; 3]),
        }
    }

    /// Point and `rho_1 x rho_2`, the latter divided by the lengths of both where they are not zero.
    fn point_and_cross(&self, u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
        let [p, q] = self.degree;
        let (bu, du) = bernstein(p, u);
        let (bv, dv) = bernstein(q, v);
        let (mut a, mut a1, mut a2) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        for j in 0..=q {
            for i in 0..=p {
                let c = self.points[i + (p + 1) * j];
                for k in 0..4 {
                    a[k] += bu[i] * bv[j] * c[k];
                    a1[k] += du[i] * bv[j] * c[k];
                    a2[k] += bu[i] * dv[j] * c[k];
                }
            }
        }
        let rho = [a[0] / a[3], a[1] / a[3], a[2] / a[3]];
        let size = self.size();
        let tangent = |d: [f64; 4]| {
            let t: [f64; 3] = std::array::from_fn(|k| (d[k] - d[3] * rho[k]) / a[3]);
            let length = norm(t);
            // Round-off of a tangent that is zero is not a direction.
            if length > 1e-12 * size {
                t.map(|x| x / length)
            } else {
                [0.0; 3]
            }
        };
        let (t1, t2) = (tangent(a1), tangent(a2));
        let cross = [
            t1[1] * t2[2] - t1[2] * t2[1],
            t1[2] * t2[0] - t1[0] * t2[2],
            t1[0] * t2[1] - t1[1] * t2[0],
        ];
        (rho, cross)
    }

    /// Largest distance of a control point from the first.
    fn size(&self) -> f64 {
        let project = |c: &[f64; 4]| [c[0] / c[3], c[1] / c[3], c[2] / c[3]];
        let first = project(&self.points[0]);
        self.points
            .iter()
            .map(|c| {
                let x = project(c);
                norm([x[0] - first[0], x[1] - first[1], x[2] - first[2]])
            })
            .fold(0.0, f64::max)
    }
}

/// Numbers of the control points (xi1 fastest) in the node order of VTK's Bezier quadrilateral: corners around, the
/// inner nodes of the edges v = 0, u = 1, v = 1, u = 0 (each by increasing parameter), then the inside, u fastest.
pub(crate) fn vtk_order(degree: [usize; 2]) -> Vec<usize> {
    let [p, q] = degree;
    let at = |i: usize, j: usize| i + (p + 1) * j;
    let mut order = vec![at(0, 0), at(p, 0), at(p, q), at(0, q)];
    order.extend((1..p).map(|i| at(i, 0)));
    order.extend((1..q).map(|j| at(p, j)));
    order.extend((1..p).map(|i| at(i, q)));
    order.extend((1..q).map(|j| at(0, j)));
    order.extend((1..q).flat_map(|j| (1..p).map(move |i| at(i, j))));
    order
}

/// Bernstein polynomials of degree `p` at `u`, and their derivatives.
fn bernstein(p: usize, u: f64) -> (Vec<f64>, Vec<f64>) {
    let mut b = vec![0.0; p + 1];
    let mut d = vec![0.0; p + 1];
    b[0] = 1.0;
    for k in 1..=p {
        if k == p {
            // b holds degree p - 1: B' = p (B_(i-1) - B_i).
            for i in 0..=p {
                let left = if i > 0 { b[i - 1] } else { 0.0 };
                let right = if i < p { b[i] } else { 0.0 };
                d[i] = p as f64 * (left - right);
            }
        }
        for i in (0..=k).rev() {
            let left = if i > 0 { b[i - 1] } else { 0.0 };
            let right = if i < k { b[i] } else { 0.0 };
            b[i] = u * left + (1.0 - u) * right;
        }
    }
    (b, d)
}

fn norm(x: [f64; 3]) -> f64 {
    (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt()
}

/// The unit vector, unless `x` is shorter than 1e-9.
fn unit(x: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(x);
    (length > 1e-9).then(|| x.map(|c| c / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bernstein_sums_to_one_and_its_derivative_matches_differences() {
        for p in 1..=9 {
            let (b, d) = bernstein(p, 0.3);
            assert!((b.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(d.iter().sum::<f64>().abs() < 1e-12);
            let h = 1e-6;
            let (plus, minus) = (bernstein(p, 0.3 + h).0, bernstein(p, 0.3 - h).0);
            for i in 0..=p {
                let difference = (plus[i] - minus[i]) / (2.0 * h);
                assert!((d[i] - difference).abs() < 1e-7, "{p} {i}");
            }
        }
    }

    /// Node numbers of degree (2, 3), read off `vtkHigherOrderQuadrilateral`'s layout by hand.
    #[test]
    fn order_of_a_2_by_3_piece() {
        assert_eq!(vtk_order([2, 3]), [0, 2, 11, 9, 1, 5, 8, 10, 3, 6, 4, 7]);
    }
}
