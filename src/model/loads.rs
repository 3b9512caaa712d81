//! Loads: nodal forces, dead tractions, dead and follower pressure.
use crate::mesh::{Face, Mesh};
use crate::scene::{TimeFunction, ValueError};
use crate::shell::face::{self, Quad};
use covact_geometry::Vec3;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use num_dual::DualNum;

/// A load of constant direction, as weights of one vector value.
#[derive(Debug, Clone)]
pub enum DeadLoad {
    /// The same force everywhere: each node takes its share of the total.
    Force {
        shares: Vec<(u32, f64)>,
        value: [TimeFunction; 3],
    },
    /// Force per undeformed area, sampled at points of the faces.
    Traction {
        points: Vec<LoadPoint>,
        value: [TimeFunction; 3],
    },
    /// Pressure against the undeformed outward normal.
    Pressure {
        points: Vec<LoadPoint>,
        value: TimeFunction,
    },
}

/// A quadrature point of a loaded face on the undeformed mesh.
#[derive(Debug, Clone, Copy)]
pub struct LoadPoint {
    nodes: [u32; 4],
    shape: [f64; 4],
    /// Weight times area (length^2).
    area: f64,
    normal: Vec3,
    position: Vec3,
}

/// Pressure that follows the deformed faces.
#[derive(Debug, Clone)]
pub struct FollowerPressure {
    pub faces: Vec<[u32; 4]>,
    pub value: TimeFunction,
}

/// Two Gauss points a direction integrate a bilinear face's forces exactly for constant values.
pub fn load_points(mesh: &Mesh, faces: &[Face], offset: u32) -> Vec<LoadPoint> {
    let mut out = Vec::with_capacity(4 * faces.len());
    for &f in faces {
        let nodes = mesh.face_nodes(f).map(|n| n + offset);
        let quad = Quad {
            corners: mesh.face_nodes(f).map(|n| mesh.nodes[n as usize]),
        };
        for v in GAUSS_2 {
            for u in GAUSS_2 {
                let area = quad.area_vector(u, v);
                out.push(LoadPoint {
                    nodes,
                    shape: face::shape(u, v),
                    area: area.norm(),
                    normal: area.normalize(),
                    position: quad.point(u, v),
                });
            }
        }
    }
    out
}

impl DeadLoad {
    /// Adds the nodal forces at time `t` to `force` (3 per node).
    pub fn add(&self, t: f64, force: &mut [f64]) -> Result<(), ValueError> {
        let mut put = |node: u32, f: Vec3| {
            let at = 3 * node as usize;
            (0..3).for_each(|c| force[at + c] += f[c]);
        };
        match self {
            DeadLoad::Force { shares, value } => {
                let f = Vec3::new(value[0].eval(t)?, value[1].eval(t)?, value[2].eval(t)?);
                shares.iter().for_each(|&(n, s)| put(n, f * s));
            }
            DeadLoad::Traction { points, value } => {
                for p in points {
                    let at = |i: usize| value[i].eval_at(&p.position, t);
                    let f = Vec3::new(at(0)?, at(1)?, at(2)?) * p.area;
                    (0..4).for_each(|k| put(p.nodes[k], f * p.shape[k]));
                }
            }
            DeadLoad::Pressure { points, value } => {
                for p in points {
                    let f = p.normal * (-value.eval_at(&p.position, t)? * p.area);
                    (0..4).for_each(|k| put(p.nodes[k], f * p.shape[k]));
                }
            }
        }
        Ok(())
    }

    /// Its functions of time.
    pub fn functions(&self) -> &[TimeFunction] {
        match self {
            DeadLoad::Force { value, .. } | DeadLoad::Traction { value, .. } => value,
            DeadLoad::Pressure { value, .. } => std::slice::from_ref(value),
        }
    }
}

/// Nodal forces of a follower pressure `p` on a bilinear face with deformed corners `x`: `-p int N (x_,u x x_,v)`.
pub fn follower_force<D: DualNum<f64> + Copy>(x: &[Vector3<D>; 4], p: f64) -> SVector<D, 12> {
    let mut f = SVector::<D, 12>::from_element(D::zero());
    for_gauss(|n, nu, nv| {
        let (xu, xv) = (combine(x, nu), combine(x, nv));
        let area = xu.cross(&xv) * D::from(-p);
        for k in 0..4 {
            (0..3).for_each(|c| f[3 * k + c] += area[c] * n[k]);
        }
    });
    f
}

/// Derivative of [`follower_force`] with respect to the corners. It is unsymmetric by terms on the border of the
/// loaded area, which vanish where that border is held.
pub fn follower_stiffness(x: &[Vec3; 4], p: f64) -> SMatrix<f64, 12, 12> {
    let mut k = SMatrix::<f64, 12, 12>::zeros();
    for_gauss(|n, nu, nv| {
        let (xu, xv) = (combine(x, nu), combine(x, nv));
        for l in 0..4 {
            let turn: Matrix3<f64> = (xu.cross_matrix() * nv[l] - xv.cross_matrix() * nu[l]) * -p;
            for (i, n) in n.iter().enumerate() {
                let mut block = k.fixed_view_mut::<3, 3>(3 * i, 3 * l);
                block += turn * *n;
            }
        }
    });
    k
}

fn combine<D: DualNum<f64> + Copy>(x: &[Vector3<D>; 4], n: &[f64; 4]) -> Vector3<D> {
    x[0] * D::from(n[0]) + x[1] * D::from(n[1]) + x[2] * D::from(n[2]) + x[3] * D::from(n[3])
}

/// Points of the two-point Gauss rule; its weights are one.
const GAUSS_2: [f64; 2] = [-0.577_350_269_189_625_8, 0.577_350_269_189_625_8];

fn for_gauss(mut f: impl FnMut(&[f64; 4], &[f64; 4], &[f64; 4])) {
    for v in GAUSS_2 {
        for u in GAUSS_2 {
            let [nu, nv] = face::shape_derivatives(u, v);
            f(&face::shape(u, v), &nu, &nv);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::Dual64;

    const X: [[f64; 3]; 4] = [
        [0.0, 0.1, 0.0],
        [1.1, 0.0, 0.2],
        [-0.1, 0.9, 0.1],
        [1.0, 1.2, -0.3],
    ];

    #[test]
    fn follower_stiffness_against_dual_numbers() {
        let k = follower_stiffness(&X.map(Vec3::from), 2.5);
        assert!(k.norm() > 1.0);
        for dof in 0..12 {
            let x: [Vector3<Dual64>; 4] = std::array::from_fn(|i| {
                Vector3::from_fn(|c, _| {
                    Dual64::new(X[i][c], if 3 * i + c == dof { 1.0 } else { 0.0 })
                })
            });
            let f = follower_force(&x, 2.5);
            for row in 0..12 {
                assert!((f[row].eps - k[(row, dof)]).abs() < 1e-14 * k.norm());
            }
        }
    }

    #[test]
    fn follower_pressure_on_a_unit_square_pushes_down() {
        let x = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]].map(Vec3::from);
        let f = follower_force(&x, 4.0);
        for node in 0..4 {
            assert!((f[3 * node + 2] + 1.0).abs() < 1e-15);
        }
    }
}
