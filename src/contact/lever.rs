//! Slave points at a height above a surface: a face of a shell whose mid-surface alone has unknowns.
//!
//! `y = r + z n`, `r = sum N_a x_a`. With `beta_a = N_a,k rho^k` the unit normal changes by `-sum beta_a (n . dx_a)`, so that the
//! row of node a is `N_a I - z beta_a x n` where a point of the surface itself has `N_a I`. A force on the point then acts on the
//! nodes with its moment `z n x F` about the mid-surface: that of friction, and of a pressure that is not along `n`.
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// Nodes of such a point.
pub const NODES: usize = 16;

/// A point at a fixed height above a surface of sixteen nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lever {
    /// Nodes of the surface, by their numbers in the model.
    pub nodes: [u32; NODES],
    /// Shape functions.
    pub n: [f64; NODES],
    /// Their derivatives along both parameters.
    pub n_i: [[f64; NODES]; 2],
    /// Height along the unit normal `rho_1 x rho_2 / |..|` (length); negative on its other side.
    pub height: f64,
}

/// The surface below the point.
struct Base {
    normal: Vec3,
    /// `rho^1, rho^2`.
    up: [Vec3; 2],
}

impl Lever {
    /// `sum_a w_a x_a`.
    #[inline]
    fn combine(&self, w: &[f64; NODES], position: &impl Fn(u32) -> Vec3) -> Vec3 {
        let terms = self.nodes.iter().zip(w);
        terms.fold(Vec3::zeros(), |sum, (n, w)| sum + position(*n) * *w)
    }

    /// Where the point is, of nodes at these positions. Not finite where the surface has no normal.
    #[inline]
    pub fn position(&self, position: impl Fn(u32) -> Vec3) -> Vec3 {
        let [a, b] = self.n_i.each_ref().map(|n| self.combine(n, &position));
        let normal = a.cross(&b);
        self.combine(&self.n, &position) + normal * (self.height / normal.norm())
    }

    /// Unit normal on the side that the point lies on, of nodes at these positions.
    pub fn outward(&self, position: impl Fn(u32) -> Vec3) -> Vec3 {
        self.base(&position).normal * self.height.signum()
    }

    /// The matrix of a point and of other nodes as one of the nodes below the point and those others: `point` is that of
    /// `1 + others` nodes by columns of `3 node + axis`, the point itself the first, on which the force `f` acts; `out` is that of
    /// [`NODES`] and the others.
    ///
    /// # Panics
    /// Where a matrix has another size.
    pub fn expand(
        &self,
        position: impl Fn(u32) -> Vec3,
        f: &Vec3,
        others: usize,
        point: &[f64],
        out: &mut [f64],
    ) {
        let (small, large) = (3 * (1 + others), 3 * (NODES + others));
        assert_eq!([point.len(), out.len()], [small * small, large * large]);
        let at = |r: usize, c: usize| point[c * small + r];
        let own = Matrix3::from_fn(at);
        let mut ke = [0.0; 9 * NODES * NODES];
        self.spread(&position, f, Some((&own, &mut ke)));
        let size = 3 * NODES;
        for (column, own) in ke.chunks_exact(size).enumerate() {
            out[column * large..][..size].copy_from_slice(own);
        }
        let Base { normal, up } = self.base(&position);
        for a in 0..NODES {
            let beta = up[0] * self.n_i[0][a] + up[1] * self.n_i[1][a];
            let row = Matrix3::identity() * self.n[a] - beta * normal.transpose() * self.height;
            for k in 0..others {
                let first = 3 + 3 * k;
                let below = row.tr_mul(&Matrix3::from_fn(|r, c| at(r, first + c)));
                let beside = Matrix3::from_fn(|r, c| at(first + r, c)) * row;
                for c in 0..3 {
                    for r in 0..3 {
                        out[(size + 3 * k + c) * large + 3 * a + r] = below[(r, c)];
                        out[(3 * a + c) * large + size + 3 * k + r] = beside[(r, c)];
                    }
                }
            }
        }
        for c in 0..3 * others {
            for r in 0..3 * others {
                out[(size + c) * large + size + r] = at(3 + r, 3 + c);
            }
        }
    }

    fn base(&self, position: &impl Fn(u32) -> Vec3) -> Base {
        let r = self.n_i.each_ref().map(|n| self.combine(n, position));
        let normal = r[0].cross(&r[1]);
        let area = normal.norm_squared();
        Base {
            up: [r[1].cross(&normal) / area, normal.cross(&r[0]) / area],
            normal: normal / area.sqrt(),
        }
    }

    /// Forces on the nodes from a force `f` on the point; with the derivative `k` of that force by the motion of the point
    /// also their derivative by the nodes, by columns `3 node + axis`.
    pub fn spread(
        &self,
        position: impl Fn(u32) -> Vec3,
        f: &Vec3,
        k: Option<(&Matrix3<f64>, &mut [f64])>,
    ) -> [Vec3; NODES] {
        let Base { normal, up } = self.base(&position);
        let z = self.height;
        let beta: [Vec3; NODES] =
            std::array::from_fn(|a| up[0] * self.n_i[0][a] + up[1] * self.n_i[1][a]);
        let phi = beta.map(|b| b.dot(f));
        let forces = std::array::from_fn(|a| f * self.n[a] - normal * (z * phi[a]));
        let Some((k, out)) = k else {
            return forces;
        };
        let across = f.dot(&normal);
        let rows: [Matrix3<f64>; NODES] = std::array::from_fn(|a| {
            Matrix3::identity() * self.n[a] - beta[a] * normal.transpose() * z
        });
        let size = 3 * NODES;
        for b in 0..NODES {
            let right = k * rows[b];
            for a in 0..NODES {
                let mut block = rows[a].tr_mul(&right);
                block += (normal * beta[a].transpose()) * (z * phi[b]);
                block += (beta[b] * normal.transpose()) * (z * phi[a]);
                block -= (normal * normal.transpose()) * (z * across * beta[a].dot(&beta[b]));
                for c in 0..3 {
                    let column = &mut out[(3 * b + c) * size + 3 * a..][..3];
                    (0..3).for_each(|r| column[r] = block[(r, c)]);
                }
            }
        }
        forces
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use num_dual::{Dual64, DualNum};

    /// Values without a pattern between -1 and 1.
    fn noise(k: usize) -> f64 {
        let x = (12.9898 * k as f64 + 4.1).sin() * 43758.5453;
        2.0 * (x - x.floor()) - 1.0
    }

    /// A point of a bent sheet with derivatives as those of shape functions: they add up to nothing.
    fn lever() -> (Lever, [Vec3; NODES]) {
        let line = |s: f64| {
            let t = 1.0 - s;
            [t * t * t, 3.0 * s * t * t, 3.0 * s * s * t, s * s * s]
        };
        let slope = |s: f64| {
            let t = 1.0 - s;
            [
                -3.0 * t * t,
                3.0 * t * t - 6.0 * s * t,
                6.0 * s * t - 3.0 * s * s,
                3.0 * s * s,
            ]
        };
        let (u, v) = (0.3, 0.6);
        let of = |a: [f64; 4], b: [f64; 4]| std::array::from_fn(|k| a[k % 4] * b[k / 4]);
        let lever = Lever {
            nodes: std::array::from_fn(|k| k as u32),
            n: of(line(u), line(v)),
            n_i: [of(slope(u), line(v)), of(line(u), slope(v))],
            height: -0.17,
        };
        let x = std::array::from_fn(|k| {
            let (i, j) = ((k % 4) as f64 / 3.0, (k / 4) as f64 / 3.0);
            let bump = 0.2 * noise(k);
            Vec3::new(i + 0.1 * bump, j - 0.2 * bump, 0.4 * i * j + bump)
        });
        (lever, x)
    }

    /// The position in dual numbers, written once more.
    fn place(lever: &Lever, x: &[Vector3<Dual64>; NODES]) -> Vector3<Dual64> {
        let sum = |w: &[f64; NODES]| {
            let mut sum = Vector3::from_element(Dual64::from(0.0));
            for (x, w) in x.iter().zip(w) {
                sum += x * Dual64::from(*w);
            }
            sum
        };
        let normal = sum(&lever.n_i[0]).cross(&sum(&lever.n_i[1]));
        let length = normal.dot(&normal).sqrt();
        sum(&lever.n) + normal * (Dual64::from(lever.height) / length)
    }

    /// The force `f + k (y - y_0)` on the point spread over the nodes is the gradient of its work, and the derivative of that is
    /// the tangent: against dual numbers, with an unsymmetric `k` as friction has it.
    #[test]
    fn forces_and_tangent_against_dual_numbers() {
        let (lever, x) = lever();
        let f = Vec3::new(0.3, -1.1, 0.7);
        let k = Matrix3::from_fn(|i, j| noise(31 + 3 * i + j));
        let size = 3 * NODES;
        let mut ke = vec![0.0; size * size];
        let forces = lever.spread(|n| x[n as usize], &f, Some((&k, &mut ke)));
        let norm = ke.iter().map(|k| k * k).sum::<f64>().sqrt();
        assert!(norm > 0.3, "{norm}");
        let rows = |x: &[Vec3; NODES], dof: usize| -> Vec3 {
            let dual: [Vector3<Dual64>; NODES] = std::array::from_fn(|a| {
                Vector3::from_fn(|c, _| {
                    Dual64::new(x[a][c], if 3 * a + c == dof { 1.0 } else { 0.0 })
                })
            });
            place(&lever, &dual).map(|y| y.eps)
        };
        for dof in 0..size {
            let row = rows(&x, dof);
            assert!((row.dot(&f) - forces[dof / 3][dof % 3]).abs() < 1e-14);
            // Central differences of the nodal forces, with the force on the point moved along.
            let h = 1e-5;
            let ends = [h, -h].map(|h| {
                let mut x = x;
                x[dof / 3][dof % 3] += h;
                let f = f + k * (row * h);
                lever.spread(|n| x[n as usize], &f, None)
            });
            for a in 0..NODES {
                for c in 0..3 {
                    let slope = (ends[0][a][c] - ends[1][a][c]) / (2.0 * h);
                    let exact = ke[dof * size + 3 * a + c];
                    assert!(
                        (slope - exact).abs() < 1e-8 * norm,
                        "{dof} {a} {c}: {slope} {exact}"
                    );
                }
            }
        }
    }

    /// A point and two other nodes, with any tangent: the expanded matrix is that of the chain rule, against differences of the
    /// forces.
    #[test]
    fn a_point_and_other_nodes() {
        let (lever, x) = lever();
        let others = 2;
        let f = Vec3::new(0.3, -1.1, 0.7);
        let small: Vec<f64> = (0..81).map(|k| noise(200 + k)).collect();
        let (size, large) = (9, 3 * (NODES + others));
        let mut ke = vec![f64::NAN; large * large];
        lever.expand(|n| x[n as usize], &f, others, &small, &mut ke);
        let norm = ke.iter().map(|k| k * k).sum::<f64>().sqrt();
        assert!(norm > 1.0 && norm.is_finite(), "{norm}");
        let rest = lever.position(|n| x[n as usize]);
        // Linear forces of the point and the others by their motions.
        let forces = |moved: &[f64]| -> Vec<f64> {
            let x: Vec<Vec3> = (x.iter().enumerate())
                .map(|(a, x)| x + Vec3::from_column_slice(&moved[3 * a..][..3]))
                .collect();
            let y = lever.position(|n| x[n as usize]) - rest;
            let mut way = [0.0; 9];
            way[..3].copy_from_slice(y.as_slice());
            way[3..].copy_from_slice(&moved[3 * NODES..]);
            let of = |r: usize| (0..9).map(|c| small[c * size + r] * way[c]).sum::<f64>();
            let own = f + Vec3::from_fn(|r, _| of(r));
            let spread = lever.spread(|n| x[n as usize], &own, None);
            let all = spread.iter().flat_map(|f| f.iter().copied());
            all.chain((3..9).map(of)).collect()
        };
        for column in 0..large {
            let h = 1e-5;
            let ends = [h, -h].map(|h| {
                let mut moved = vec![0.0; large];
                moved[column] = h;
                forces(&moved)
            });
            for row in 0..large {
                let slope = (ends[0][row] - ends[1][row]) / (2.0 * h);
                let exact = ke[column * large + row];
                assert!(
                    (slope - exact).abs() < 1e-8 * norm,
                    "{row} {column}: {slope} {exact}"
                );
            }
        }
    }

    /// Forces on the nodes balance that on the point in force and moment about any place.
    #[test]
    fn forces_and_moments_balance() {
        let (lever, x) = lever();
        let f = Vec3::new(0.3, -1.1, 0.7);
        let forces = lever.spread(|n| x[n as usize], &f, None);
        let total: Vec3 = forces.iter().sum();
        assert!((total - f).norm() < 1e-14);
        let moment: Vec3 = x.iter().zip(&forces).map(|(x, f)| x.cross(f)).sum();
        let y = lever.position(|n| x[n as usize]);
        assert!((moment - y.cross(&f)).norm() < 1e-14);
        // Without the lever the moment of the force about the mid-surface would be missing.
        let flat = Lever {
            height: 0.0,
            ..lever
        };
        assert!(((y - flat.position(|n| x[n as usize])).cross(&f)).norm() > 0.1);
    }
}
