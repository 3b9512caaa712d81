//! How far and where to the surface goes at each node, so that every element around it gets its thickness.
use super::SurfaceError;
use super::cells::Cells;
use crate::fem::Quad;
use crate::mesh::raw::NONE;
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// Weight of the averaged normal against the elements' own: it decides the direction where the elements around a node are
/// too even to do so, and is small against folds of a few degrees.
const EVEN: f64 = 1e-4;

/// Corrections after the first solution: each takes the part of the deviation that `EVEN` left, about `EVEN` over the
/// variance of the normals.
const CORRECTIONS: usize = 4;

/// A node may be farther from the surface than the thickness by this factor (a fold of 151 degrees).
const FARTHEST: f64 = 4.0;

/// The vectors from bottom to top at every node.
pub(super) struct Normals {
    /// Through the thickness: its part along the normal of each element around is that element's thickness.
    pub through: Vec<Vec3>,
    /// Nodes at which elements of one thickness cannot all have it by more than [`TOLERATED`], and the largest deviation as a
    /// part of it.
    pub uneven: (usize, f64),
}

/// Deviations of the thickness below this part of it are not told.
const TOLERATED: f64 = 0.02;

/// Sums over the elements around a node.
#[derive(Clone, Copy)]
struct Sums {
    weight: f64,
    normal: Vec3,
    /// Normals times thickness.
    right: Vec3,
    /// Products of normals with themselves.
    matrix: Matrix3<f64>,
}

impl Normals {
    /// Finds the vectors `v` at all nodes that solve `n_i . v = t_i` for the normals and thicknesses of the elements around
    /// in the sense of least squares, each with the angle that it spans as its weight. At folds of up to three planes the
    /// solution is exact, so that every face keeps its distance. In directions in which the normals hardly differ the
    /// averaged normal decides.
    pub fn new(nodes: &[Vec3], cells: &Cells) -> Result<Normals, SurfaceError> {
        let zero = Sums {
            weight: 0.0,
            normal: Vec3::zeros(),
            right: Vec3::zeros(),
            matrix: Matrix3::zeros(),
        };
        let mut sums = vec![zero; nodes.len()];
        cells.corners(nodes, |node, normal, angle, thickness, _| {
            let s = &mut sums[node as usize];
            s.weight += angle;
            s.normal += normal * angle;
            s.right += normal * (angle * thickness);
            s.matrix += normal * normal.transpose() * angle;
        })?;
        let through: Vec<Vec3> = sums.iter().map(Sums::solve).collect();
        let mut thick = vec![[f64::INFINITY, 0.0]; nodes.len()];
        cells.corners(nodes, |node, _, _, thickness, _| {
            let [low, high] = &mut thick[node as usize];
            *low = low.min(thickness);
            *high = high.max(thickness);
        })?;
        let mut sharp = NONE;
        let mut off = vec![0.0f64; nodes.len()];
        cells.corners(nodes, |node, normal, _, thickness, _| {
            let v = through[node as usize];
            let [low, high] = thick[node as usize];
            let along = normal.dot(&v);
            // NaN, where all normals cancel each other, counts as sharp.
            let fits = along > low / FARTHEST && v.norm() < high * FARTHEST;
            if !fits && sharp == NONE {
                sharp = node;
            }
            if low == high {
                off[node as usize] = off[node as usize].max((along / thickness - 1.0).abs());
            }
        })?;
        if sharp != NONE {
            return Err(SurfaceError::SharpFold {
                angle: fold(nodes, cells, sharp)?,
                position: nodes[sharp as usize].into(),
            });
        }
        let far = off.iter().filter(|off| **off > TOLERATED);
        Ok(Normals {
            through,
            uneven: (far.clone().count(), far.copied().fold(0.0, f64::max)),
        })
    }
}

impl Sums {
    fn solve(&self) -> Vec3 {
        let mean = self.normal.normalize();
        let flat = Matrix3::identity() - mean * mean.transpose();
        let (matrix, right) = (self.matrix / self.weight, self.right / self.weight);
        let Some(inverse) = (matrix + flat * EVEN).try_inverse() else {
            return Vec3::from_element(f64::NAN);
        };
        let mut v = Vec3::zeros();
        for _ in 0..CORRECTIONS {
            v += inverse * (right - matrix * v);
        }
        v
    }
}

/// The largest angle between the normals around a node, degrees.
fn fold(nodes: &[Vec3], cells: &Cells, at: u32) -> Result<f64, SurfaceError> {
    let mut around = Vec::new();
    cells.corners(nodes, |node, normal, _, _, _| {
        // Every pair is compared.
        if node == at && around.len() < 1000 {
            around.push(normal);
        }
    })?;
    let mut angle = 0.0f64;
    for (i, a) in around.iter().enumerate() {
        for b in &around[i + 1..] {
            angle = angle.max(a.cross(b).norm().atan2(a.dot(b)));
        }
    }
    Ok(angle.to_degrees())
}

impl Cells {
    /// Hands over every node of every element with the element's unit normal there, the angle that it spans, the thickness
    /// there and the element's number.
    fn corners(
        &self,
        nodes: &[Vec3],
        mut take: impl FnMut(u32, Vec3, f64, f64, usize),
    ) -> Result<(), SurfaceError> {
        let n = self.side();
        for (e, cell) in self.nodes.chunks_exact(n * n).enumerate() {
            let mut quad = Quad {
                nodes: [Vec3::zeros(); 9],
                count: [n as u8; 2],
            };
            for (x, &node) in quad.nodes.iter_mut().zip(cell) {
                *x = nodes[node as usize];
            }
            let middle = quad.area_vector(0.0, 0.0);
            for (k, &node) in cell.iter().enumerate() {
                let place = |i: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
                let (r, s) = (place(k % n), place(k / n));
                let [a, b] = quad.tangents(r, s);
                let area = a.cross(&b);
                // The opposite of two tangents points into the element at a corner.
                let angle = match (r != 0.0, s != 0.0) {
                    (true, true) => area.norm().atan2(r * s * a.dot(&b)),
                    (false, false) => std::f64::consts::TAU,
                    _ => std::f64::consts::PI,
                };
                let normal = area / area.norm();
                let sound = normal.dot(&middle) > 0.0;
                if !sound {
                    return Err(SurfaceError::Flat {
                        element: self.tags[e],
                        position: quad.point(0.0, 0.0).into(),
                    });
                }
                let thickness = self.at_nodes.get(node as usize);
                let thickness = thickness.copied().unwrap_or(self.thickness[e]);
                take(node, normal, angle, thickness, e);
            }
        }
        Ok(())
    }
}
