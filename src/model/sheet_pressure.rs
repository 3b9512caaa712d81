//! Pressure that follows the faces of a sheet.
use super::edge_couple::CoupleSpan;
use crate::mesh::{Face, NurbsSheet, nurbs::side};
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// Nodes of an element.
pub const NODES: usize = 16;
/// Its degrees of freedom.
pub const DOFS: usize = 3 * NODES;
/// Points along each direction of an element.
const POINTS: usize = 4;

/// A load on an element of a sheet that follows it.
#[derive(Debug, Clone)]
pub enum FollowingSpan {
    /// Pressure on a face.
    Pressure(PressedSpan),
    /// A couple along an edge.
    Couple(CoupleSpan),
}

impl FollowingSpan {
    /// Nodes of the model.
    pub fn nodes(&self) -> &[u32; NODES] {
        match self {
            FollowingSpan::Pressure(span) => &span.nodes,
            FollowingSpan::Couple(span) => &span.nodes,
        }
    }

    /// Nodal forces at positions `x`, and their derivative by the positions, by columns.
    pub fn force(
        &self,
        x: &[Vec3; NODES],
        value: f64,
        f: &mut [f64; DOFS],
        k: Option<&mut [f64; DOFS * DOFS]>,
    ) {
        match self {
            FollowingSpan::Pressure(span) => span.force(x, value, f, k),
            FollowingSpan::Couple(span) => span.force(x, value, f, k),
        }
    }
}

/// A loaded face of an element of a sheet.
#[derive(Debug, Clone)]
pub struct PressedSpan {
    /// Nodes of the model.
    pub nodes: [u32; NODES],
    points: Vec<PressedPoint>,
}

#[derive(Debug, Clone)]
struct PressedPoint {
    n: [f64; NODES],
    n_i: [[f64; NODES]; 2],
    /// Weight in parameters; negative on the bottom, whose outward normal is the other one.
    weight: f64,
}

impl PressedSpan {
    /// The faces of a sheet whose first node has this number.
    pub fn all(sheet: &NurbsSheet, faces: &[Face], first_node: u32) -> Vec<PressedSpan> {
        let rule = crate::fem::gauss(POINTS).expect("a rule of four points exists");
        (faces.iter())
            .filter_map(|face| {
                let sign = side(*face)?;
                let sampled = sheet.sampled(std::iter::once(face.element as usize), &rule);
                Some(PressedSpan {
                    nodes: sampled.first()?.nodes.map(|n| n + first_node),
                    points: (sampled.iter())
                        .map(|p| PressedPoint {
                            n: p.n,
                            n_i: p.n_i,
                            weight: sign * p.weight,
                        })
                        .collect(),
                })
            })
            .collect()
    }

    /// Nodal forces of a pressure, `-p int N (rho_1 x rho_2)` towards the body, at positions `x`; and their derivative by the
    /// positions, by columns. It is unsymmetric by terms on the border of the loaded area.
    pub fn force(
        &self,
        x: &[Vec3; NODES],
        pressure: f64,
        f: &mut [f64; DOFS],
        k: Option<&mut [f64; DOFS * DOFS]>,
    ) {
        f.fill(0.0);
        let mut k = k;
        if let Some(k) = &mut k {
            k.fill(0.0);
        }
        for p in &self.points {
            let w = -pressure * p.weight;
            let r = p.n_i.each_ref().map(|n| -> Vec3 {
                let terms = x.iter().zip(n);
                terms.map(|(x, n)| x * *n).sum()
            });
            let area = r[0].cross(&r[1]) * w;
            for (f, n) in f.chunks_exact_mut(3).zip(p.n) {
                (0..3).for_each(|c| f[c] += n * area[c]);
            }
            let Some(k) = &mut k else {
                continue;
            };
            let [r1, r2] = r.map(|r| r.cross_matrix() * w);
            for b in 0..NODES {
                let turn: Matrix3<f64> = r1 * p.n_i[1][b] - r2 * p.n_i[0][b];
                for c in 0..3 {
                    let column = &mut k[(3 * b + c) * DOFS..][..DOFS];
                    for (rows, n) in column.chunks_exact_mut(3).zip(p.n) {
                        (0..3).for_each(|r| rows[r] += n * turn[(r, c)]);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::nurbs::Fineness;
    use covact_geometry::NurbsPatch;

    fn sheet() -> NurbsSheet {
        let points: Vec<Vec3> = (0..9)
            .map(|k| {
                let (i, j) = ((k % 3) as f64, (k / 3) as f64);
                Vec3::new(i, j + 0.1 * i, 0.3 * i * j - 0.2 * i)
            })
            .collect();
        let knots = || vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let patch = NurbsPatch::new([2, 2], [knots(), knots()], [3, 3], &points, None).unwrap();
        NurbsSheet::new(&patch, 0.1, Fineness::Elements([2, 1]), true).unwrap()
    }

    /// The tangent against central differences, which are exact up to rounding for quadratics; pressures on both faces cancel.
    #[test]
    fn tangent_of_a_follower() {
        let sheet = sheet();
        let faces = [4, 5].map(|face| Face { element: 1, face });
        let spans = PressedSpan::all(&sheet, &faces, 0);
        let positions = sheet.positions();
        let x = spans[1].nodes.map(|n| positions[n as usize]);
        let (mut f, mut k) = ([0.0; DOFS], [0.0; DOFS * DOFS]);
        spans[1].force(&x, 2.5, &mut f, Some(&mut k));
        let norm = k.iter().map(|k| k * k).sum::<f64>().sqrt();
        assert!(norm > 0.5, "{norm}");
        for dof in 0..DOFS {
            let ends = [0.125, -0.125].map(|h| {
                let (mut x, mut f) = (x, [0.0; DOFS]);
                x[dof / 3][dof % 3] += h;
                spans[1].force(&x, 2.5, &mut f, None);
                f
            });
            for row in 0..DOFS {
                let slope = (ends[0][row] - ends[1][row]) / 0.25;
                assert!((slope - k[dof * DOFS + row]).abs() < 1e-13 * norm);
            }
        }
        let mut below = [0.0; DOFS];
        spans[0].force(&x, 2.5, &mut below, None);
        assert!(f.iter().zip(&below).all(|(a, b)| (a + b).abs() < 1e-14));
        assert!(f.iter().any(|f| f.abs() > 0.1));
    }
}
