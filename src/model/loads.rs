//! Loads: nodal forces, dead tractions, dead and follower pressure.
use super::sheet_pressure::FollowingSpan;
use crate::fem::face::{FaceNodes, Quad, shape, shape_derivatives};
use crate::fem::quadrature::{GAUSS_2, GAUSS_3, Rule};
use crate::mesh::nurbs::side;
use crate::mesh::{Face, Mesh, NurbsSheet};
use crate::scene::{TimeFunction, ValueError};
use covact_geometry::Vec3;
use nalgebra::{Matrix3, Vector3};
use num_dual::DualNum;

/// A load of constant direction, as weights of one vector value.
#[derive(Debug, Clone)]
pub enum DeadLoad {
    /// The same force everywhere: each node takes its share of the total.
    Force {
        /// Nodes and their shares, which add up to 1.
        shares: Vec<(u32, f64)>,
        /// The total force over time, by components.
        value: [TimeFunction; 3],
    },
    /// Force per undeformed area, sampled at points of the faces.
    Traction {
        /// Quadrature points of the loaded faces.
        points: Vec<LoadPoint>,
        /// The traction over time, by components (force / length^2).
        value: [TimeFunction; 3],
    },
    /// Pressure against the undeformed outward normal.
    Pressure {
        /// Quadrature points of the loaded faces.
        points: Vec<LoadPoint>,
        /// The pressure over time (force / length^2).
        value: TimeFunction,
    },
    /// Forces on degrees of freedom, all of them times one factor.
    Nodal {
        /// Degrees of freedom and their forces under a factor of 1.
        forces: Vec<(u32, f64)>,
        /// The factor over time.
        factor: TimeFunction,
    },
}

/// A quadrature point of a loaded face on the undeformed mesh.
#[derive(Debug, Clone, Copy)]
pub struct LoadPoint {
    face: FaceNodes,
    shape: [f64; 9],
    /// Weight times area (length^2).
    area: f64,
    normal: Vec3,
    position: Vec3,
}

impl LoadPoint {
    /// Nodes of the face that it lies on.
    pub fn nodes(&self) -> &[u32] {
        self.face.nodes()
    }
}

/// Pressure that follows the deformed faces, or a couple that follows edges of sheets.
#[derive(Debug, Clone)]
pub struct FollowerPressure {
    /// Faces of solid elements under the pressure.
    pub faces: Vec<FaceNodes>,
    /// Faces of sheets under the pressure, or edges under a couple per length in its place.
    pub spans: Vec<FollowingSpan>,
    /// Lines of nodes around those faces; none where that is not known.
    pub rims: Option<Vec<Vec<u32>>>,
    /// The pressure over time (force / length^2), or the couple per length (force).
    pub value: TimeFunction,
}

/// As many Gauss points a direction as a face has nodes; they integrate its forces exactly for constant pressure.
pub fn load_points(mesh: &Mesh, faces: &[Face], offset: u32) -> Vec<LoadPoint> {
    let mut out = Vec::with_capacity(4 * faces.len());
    for &f in faces {
        let local = mesh.face_nodes(f);
        let quad = Quad::new(&local, |n| mesh.nodes[n as usize]);
        let face = local.shifted(offset);
        let [along_u, along_v] = face.count.map(rule);
        for (v, wv) in along_v.iter() {
            for (u, wu) in along_u.iter() {
                let area = quad.area_vector(u, v);
                out.push(LoadPoint {
                    face,
                    shape: shape(face.count, u, v),
                    area: wu * wv * area.norm(),
                    normal: area.normalize(),
                    position: quad.point(u, v),
                });
            }
        }
    }
    out
}

/// As [`load_points`] on faces of a sheet, whose first node has the number `offset`. A point of sixteen nodes is two of eight.
pub fn sheet_load_points(sheet: &NurbsSheet, faces: &[Face], offset: u32) -> Vec<LoadPoint> {
    let rule = crate::fem::gauss(4).expect("a rule of four points exists");
    let mut out = Vec::with_capacity(32 * faces.len());
    for face in faces {
        let Some(sign) = side(*face) else { continue };
        for p in sheet.sampled(std::iter::once(face.element as usize), &rule) {
            for half in [0, 8] {
                let mut face = FaceNodes {
                    nodes: [0; 9],
                    count: [4, 2],
                };
                let mut shape = [0.0; 9];
                let nodes = p.nodes[half..half + 8].iter();
                for (node, own) in face.nodes.iter_mut().zip(nodes) {
                    *node = own + offset;
                }
                shape[..8].copy_from_slice(&p.n[half..half + 8]);
                out.push(LoadPoint {
                    face,
                    shape,
                    area: p.area,
                    normal: p.normal * sign,
                    position: p.position,
                });
            }
        }
    }
    out
}

/// The Gauss rule for a direction with `count` nodes. With n nodes the forces of a constant pressure are polynomials of
/// degree 2 (n - 1) + n - 2 at most, which n points integrate exactly.
fn rule(count: u8) -> &'static Rule {
    if count == 2 { &GAUSS_2 } else { &GAUSS_3 }
}

impl LoadPoint {
    fn terms(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.face.nodes().iter().copied().zip(self.shape)
    }
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
                    p.terms().for_each(|(n, w)| put(n, f * w));
                }
            }
            DeadLoad::Nodal { forces, factor } => {
                let factor = factor.eval(t)?;
                (forces.iter()).for_each(|&(dof, f)| force[dof as usize] += factor * f);
            }
            DeadLoad::Pressure { points, value } => {
                for p in points {
                    let f = p.normal * (-value.eval_at(&p.position, t)? * p.area);
                    p.terms().for_each(|(n, w)| put(n, f * w));
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
            DeadLoad::Nodal { factor, .. } => std::slice::from_ref(factor),
        }
    }
}

/// Nodal forces of a follower pressure `p` on a face of `count` nodes along u and v, deformed positions `x`:
/// `-p int N (x_,u x x_,v)`. `f` receives `3 node + axis`.
pub fn follower_force<D: DualNum<f64> + Copy>(
    x: &[Vector3<D>; 9],
    count: [u8; 2],
    p: f64,
    f: &mut [D; 27],
) {
    f.fill(D::zero());
    match count {
        [2, 2] => force::<D, 2, 2>(x, p, f),
        [3, 2] => force::<D, 3, 2>(x, p, f),
        [2, 3] => force::<D, 2, 3>(x, p, f),
        _ => force::<D, 3, 3>(x, p, f),
    }
}

/// Derivative of [`follower_force`] with respect to the positions, by columns: `k` receives the `3 n x 3 n` numbers of
/// the face's n nodes, the rest is left as it is. It is unsymmetric by terms on the border of the loaded area, which
/// vanish where that border is held.
pub fn follower_stiffness(x: &[Vec3; 9], count: [u8; 2], p: f64, k: &mut [f64; 729]) {
    match count {
        [2, 2] => stiffness::<2, 2>(x, p, k),
        [3, 2] => stiffness::<3, 2>(x, p, k),
        [2, 3] => stiffness::<2, 3>(x, p, k),
        _ => stiffness::<3, 3>(x, p, k),
    }
}

#[inline(always)]
fn force<D: DualNum<f64> + Copy, const NU: usize, const NV: usize>(
    x: &[Vector3<D>; 9],
    p: f64,
    f: &mut [D; 27],
) {
    for_gauss::<NU, NV>(|w, n, nu, nv| {
        let (xu, xv) = (combine::<D>(x, nu), combine::<D>(x, nv));
        let area = xu.cross(&xv) * D::from(-p * w);
        for k in 0..NU * NV {
            (0..3).for_each(|c| f[3 * k + c] += area[c] * n[k]);
        }
    });
}

#[inline(always)]
fn stiffness<const NU: usize, const NV: usize>(x: &[Vec3; 9], p: f64, k: &mut [f64; 729]) {
    let size = 3 * NU * NV;
    k[..size * size].fill(0.0);
    for_gauss::<NU, NV>(|w, n, nu, nv| {
        let (xu, xv) = (combine::<f64>(x, nu), combine::<f64>(x, nv));
        let (xu, xv) = (xu.cross_matrix() * (-p * w), xv.cross_matrix() * (-p * w));
        for l in 0..NU * NV {
            let turn: Matrix3<f64> = xu * nv[l] - xv * nu[l];
            for c in 0..3 {
                let column = &mut k[(3 * l + c) * size..][..size];
                for (i, rows) in column.chunks_exact_mut(3).enumerate() {
                    (0..3).for_each(|r| rows[r] += turn[(r, c)] * n[i]);
                }
            }
        }
    });
}

#[inline(always)]
fn combine<D: DualNum<f64> + Copy>(x: &[Vector3<D>; 9], n: &[f64]) -> Vector3<D> {
    let mut sum = x[0] * D::from(n[0]);
    for (x, n) in x.iter().zip(n).skip(1) {
        sum += x * D::from(*n);
    }
    sum
}

/// Weight, shape functions and derivatives at the Gauss points of a face.
#[inline(always)]
fn for_gauss<const NU: usize, const NV: usize>(mut f: impl FnMut(f64, &[f64], &[f64], &[f64])) {
    let count = [NU as u8, NV as u8];
    let nodes = NU * NV;
    for (v, wv) in rule(NV as u8).iter() {
        for (u, wu) in rule(NU as u8).iter() {
            let [nu, nv] = shape_derivatives(count, u, v);
            f(
                wu * wv,
                &shape(count, u, v)[..nodes],
                &nu[..nodes],
                &nv[..nodes],
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::Dual64;

    /// A warped quadratic face; faces with fewer nodes take its first ones, in an order that stays a face.
    fn warped(count: [u8; 2]) -> [Vec3; 9] {
        let [nu, nv] = count.map(usize::from);
        std::array::from_fn(|k| {
            let (u, v) = ((k % nu) as f64, (k / nu) as f64);
            let bump = 0.1 * (2.3 * k as f64).sin();
            let inside = if k < nu * nv { 1.0 } else { 0.0 };
            Vec3::new(u + bump, 0.9 * v - 0.7 * bump, 0.3 * u * v - bump) * inside
        })
    }

    #[test]
    fn follower_stiffness_against_dual_numbers() {
        for count in [[2, 2], [3, 2], [2, 3], [3, 3]] {
            let x = warped(count);
            let size = 3 * count[0] as usize * count[1] as usize;
            let mut k = [0.0; 729];
            follower_stiffness(&x, count, 2.5, &mut k);
            let norm = k.iter().map(|k| k * k).sum::<f64>().sqrt();
            assert!(norm > 1.0);
            for dof in 0..size {
                let x: [Vector3<Dual64>; 9] = std::array::from_fn(|i| {
                    Vector3::from_fn(|c, _| {
                        Dual64::new(x[i][c], if 3 * i + c == dof { 1.0 } else { 0.0 })
                    })
                });
                let mut f = [Dual64::from(0.0); 27];
                follower_force(&x, count, 2.5, &mut f);
                for row in 0..size {
                    assert!((f[row].eps - k[dof * size + row]).abs() < 1e-14 * norm);
                }
            }
        }
    }

    /// On a flat square the force is the pressure times the area, shared as the shape functions' integrals.
    #[test]
    fn follower_pressure_on_a_square_pushes_down() {
        for count in [[2, 2], [3, 2], [2, 3], [3, 3]] {
            let [nu, nv] = count.map(usize::from);
            let x: [Vec3; 9] = std::array::from_fn(|k| {
                let (u, v) = (k % nu, k / nu);
                Vec3::new(
                    2.0 * u as f64 / (nu - 1) as f64,
                    2.0 * v as f64 / (nv - 1) as f64,
                    0.0,
                )
            });
            let quad = Quad { nodes: x, count };
            let mut f = [0.0; 27];
            follower_force(&x, count, 4.0, &mut f);
            for (k, w) in quad.weights().iter().enumerate() {
                assert!((f[3 * k + 2] + 4.0 * w).abs() < 1e-14);
            }
            assert!((f.iter().sum::<f64>() + 16.0).abs() < 1e-13);
        }
    }

    /// The resultant of a pressure on a closed surface vanishes; on a warped face it is the pressure times the area
    /// vector, which depends on the border only: three points a direction or more give the same.
    #[test]
    fn resultant_on_a_warped_face() {
        for count in [[2, 2], [3, 2], [2, 3], [3, 3]] {
            let x = warped(count);
            let quad = Quad { nodes: x, count };
            let mut f = [0.0; 27];
            follower_force(&x, count, 1.0, &mut f);
            let rule = crate::fem::gauss(6).unwrap();
            let mut area = Vec3::zeros();
            for (v, wv) in rule.iter() {
                for (u, wu) in rule.iter() {
                    area += quad.area_vector(u, v) * (wu * wv);
                }
            }
            for c in 0..3 {
                let sum: f64 = f.iter().skip(c).step_by(3).sum();
                assert!((sum + area[c]).abs() < 1e-14 * area.norm());
            }
        }
    }
}
