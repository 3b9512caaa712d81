//! Couples along edges of sheets that turn with them.
//!
//! A couple M per undeformed length works on the turn of the normal towards the inside: `dW = int M nu^k omega_k dL` with
//! `omega_k = n . drho_k` and the outward conormal `nu = m_i rho^i / |m_i rho^i|` of a curve along which `m_i dxi^i` is zero: of an edge
//! along which xi^i is constant m is one of its numbers. Positive ones lift
//! what would lie beyond the edge towards the top.
use super::sheet_pressure::{DOFS, NODES};
use crate::mesh::nurbs::DEGREE;
use crate::mesh::{Border, NurbsSheet};
use covact_geometry::{Frame, Jet, Vec3};
use nalgebra::Matrix3;

/// What bounds an element.
#[derive(Debug, Clone)]
pub struct CoupleSpan {
    /// Nodes of the model.
    pub nodes: [u32; NODES],
    /// Derivatives of the shape functions, undeformed length and `m_i` at Gauss points.
    points: Vec<([[f64; NODES]; 2], f64, [f64; 2])>,
}

impl CoupleSpan {
    /// The elements along a border of a sheet whose first node has this number.
    pub fn all(sheet: &NurbsSheet, border: Border, first_node: u32) -> Vec<CoupleSpan> {
        (sheet.border_points(border, DEGREE + 1).into_iter())
            .map(|points| CoupleSpan {
                nodes: points[0].at.nodes.map(|n| n + first_node),
                points: (points.iter())
                    .map(|p| (p.at.n_i, p.length, p.outward))
                    .collect(),
            })
            .collect()
    }

    /// Nodal forces of a couple at positions `x`; and their derivative by the positions, by columns, which is unsymmetric.
    pub fn force(
        &self,
        x: &[Vec3; NODES],
        couple: f64,
        f: &mut [f64; DOFS],
        mut k: Option<&mut [f64; DOFS * DOFS]>,
    ) {
        f.fill(0.0);
        if let Some(k) = &mut k {
            k.fill(0.0);
        }
        for (n_i, length, out) in &self.points {
            let rho_i = n_i.each_ref().map(|n| -> Vec3 {
                let terms = x.iter().zip(n);
                terms.map(|(x, n)| x * *n).sum()
            });
            let jet = Jet {
                rho: Vec3::zeros(),
                rho_i,
                rho_ij: [Vec3::zeros(); 3],
            };
            // An element without a normal cannot be evaluated either, which is told there.
            let Some(frame) = Frame::new(&jet, 1.0) else {
                continue;
            };
            let (up, n) = (frame.rho_up(), frame.n);
            let upper = |i: usize, j: usize| frame.a_inv[i + j];
            // m_i rho^i and its components.
            let m = up[0] * out[0] + up[1] * out[1];
            let upper_m = [0, 1].map(|k| upper(0, k) * out[0] + upper(1, k) * out[1]);
            let size = m.norm();
            let w = couple * length;
            let nu = upper_m.map(|u| u / size);
            let along: [f64; NODES] =
                std::array::from_fn(|a| nu[0] * n_i[0][a] + nu[1] * n_i[1][a]);
            for (f, along) in f.chunks_exact_mut(3).zip(along) {
                (0..3).for_each(|c| f[c] += w * along * n[c]);
            }
            let Some(k) = &mut k else {
                continue;
            };
            for b in 0..NODES {
                // The change of nu^k is this vector times that of node b.
                let turned: [Vec3; 2] = std::array::from_fn(|k| {
                    (0..2).fold(Vec3::zeros(), |sum, l| {
                        let first = (m * upper(l, k) + up[k] * upper_m[l]) * (-1.0 / size);
                        let second = m * (nu[k] * upper_m[l] / (size * size));
                        sum + (first + second) * n_i[l][b]
                    })
                });
                let beta = up[0] * n_i[0][b] + up[1] * n_i[1][b];
                for a in 0..NODES {
                    let change = turned[0] * n_i[0][a] + turned[1] * n_i[1][a];
                    let block: Matrix3<f64> =
                        (n * change.transpose() - beta * n.transpose() * along[a]) * w;
                    for c in 0..3 {
                        let column = &mut k[(3 * b + c) * DOFS + 3 * a..][..3];
                        (0..3).for_each(|r| column[r] += block[(r, c)]);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Edge;
    use crate::mesh::nurbs::Fineness;
    use covact_geometry::NurbsPatch;

    /// The tangent against central differences at a skewed, curved edge; the forces are a couple: no force, and the moment is
    /// that of M along the edge.
    #[test]
    fn tangent_and_moment_of_a_couple() {
        let points: Vec<Vec3> = (0..9)
            .map(|k| {
                let (i, j) = ((k % 3) as f64, (k / 3) as f64);
                Vec3::new(
                    i + 0.2 * j,
                    j + 0.1 * i * i,
                    0.3 * i * j - 0.2 * i + 0.1 * j * j,
                )
            })
            .collect();
        let knots = || vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let patch = NurbsPatch::new([2, 2], [knots(), knots()], [3, 3], &points, None).unwrap();
        let sheet = NurbsSheet::new(&patch, 0.1, Fineness::Elements([2, 2]), true).unwrap();
        let positions = sheet.positions();
        for edge in Edge::ALL {
            let spans = CoupleSpan::all(&sheet, Border::Edge(edge), 0);
            assert_eq!(spans.len(), 2);
            let x = spans[1].nodes.map(|n| positions[n as usize]);
            let (mut f, mut k) = ([0.0; DOFS], Box::new([0.0; DOFS * DOFS]));
            spans[1].force(&x, 2.5, &mut f, Some(&mut k));
            let norm = k.iter().map(|k| k * k).sum::<f64>().sqrt();
            assert!(norm > 0.5, "{norm}");
            for dof in 0..DOFS {
                let ends = [1e-5, -1e-5].map(|h| {
                    let (mut x, mut f) = (x, [0.0; DOFS]);
                    x[dof / 3][dof % 3] += h;
                    spans[1].force(&x, 2.5, &mut f, None);
                    f
                });
                for row in 0..DOFS {
                    let slope = (ends[0][row] - ends[1][row]) / 2e-5;
                    let exact = k[dof * DOFS + row];
                    assert!((slope - exact).abs() < 1e-8 * norm, "{slope} {exact}");
                }
            }
            let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
            for (x, f) in x.iter().zip(f.chunks_exact(3)) {
                let f = Vec3::from_column_slice(f);
                force += f;
                moment += x.cross(&f);
            }
            assert!(force.norm() < 1e-13, "{force}");
            // `M nu x n`, integrated: along the edge, against its sense where the outside is on its left.
            let expected: Vec3 = (spans[1].points.iter())
                .map(|(n_i, length, _)| {
                    let r = n_i
                        .each_ref()
                        .map(|n| -> Vec3 { x.iter().zip(n).map(|(x, n)| x * *n).sum() });
                    let n = r[0].cross(&r[1]).normalize();
                    let along = r[1 - edge.direction()].normalize();
                    let nu = along.cross(&n);
                    let outward = r[edge.direction()] * if edge.at_end() { 1.0 } else { -1.0 };
                    let nu = nu * nu.dot(&outward).signum();
                    nu.cross(&n) * (2.5 * length)
                })
                .sum();
            assert!((moment - expected).norm() < 1e-12 * expected.norm());
        }
    }
}
