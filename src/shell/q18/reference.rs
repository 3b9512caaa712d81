//! What a Q18 element knows once and for all of its undeformed geometry.
use super::super::kinematics::{V, dot};
use super::super::material::Metric;
use super::super::reference::{contravariant, det};
use super::tables::{POINTS, TABLES};
use covact_geometry::Vec3;

/// Enhanced strains: 33 times t, rt, st, rst.
pub(super) const MODES: usize = 4;
/// Functions that the volume strain is projected on: 1, r, s, rs and each of them times t.
pub(super) const VOLUMES: usize = 8;

/// Undeformed geometry of one element.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    /// Mid-surface points and half directors, see the tables.
    pub y: [V<f64>; 18],
    pub metric: [Metric; POINTS],
    /// Volume of every Gauss point.
    pub volume: [f64; POINTS],
    /// In-plane covariant strain (11, 22, 12) of a strain in local Cartesian axes.
    pub from_local: [[[f64; 3]; 3]; POINTS],
    /// The inverse of `from_local`.
    pub to_local: [[[f64; 3]; 3]; POINTS],
    /// Inverse of the moments of 1 and t over the volume.
    pub moments: [[f64; 2]; 2],
    /// Inverse of the products of the volume functions over the volume.
    pub volumes: [[f64; VOLUMES]; VOLUMES],
    /// `enhanced[g][v][m]`: covariant strain v at Gauss point g of enhanced strain m, volume part projected.
    pub enhanced: [[[f64; MODES]; 6]; POINTS],
}

/// Mid-surface points and half directors of 18 nodes (bottom first).
pub(super) fn split(x: &[V<f64>; 18]) -> [V<f64>; 18] {
    std::array::from_fn(|b| {
        let (low, high) = (x[b % 9], x[b % 9 + 9]);
        let sign = if b < 9 { 1.0 } else { -1.0 };
        std::array::from_fn(|k| 0.5 * (high[k] + sign * low[k]))
    })
}

fn frame(y: &[V<f64>; 18], n: &[[f64; 18]; 3]) -> [V<f64>; 3] {
    n.map(|n| {
        let mut sum = [0.0; 3];
        for (n, y) in n.iter().zip(y) {
            for (sum, y) in sum.iter_mut().zip(y) {
                *sum += n * y;
            }
        }
        sum
    })
}

/// Functions of the volume strain at a point.
pub(super) fn volume_functions([r, s, t]: [f64; 3]) -> [f64; VOLUMES] {
    [1.0, r, s, r * s, t, r * t, s * t, r * s * t]
}

/// The metric as a strain: `G_ij` in Voigt order with shears twice.
#[inline(always)]
pub(super) fn as_strain(lower: &[f64; 6]) -> [f64; 6] {
    let [a, b, c, d, e, f] = *lower;
    [a, b, c, 2.0 * d, 2.0 * e, 2.0 * f]
}

impl Reference {
    /// From the nodes; with the smallest Jacobian determinant over the Gauss points and the centre.
    pub fn new(nodes: &[V<f64>; 18]) -> (Reference, f64) {
        let y = split(nodes);
        let tables = &**TABLES;
        let centre = frame(&y, &tables.centre);
        let det0 = det(&centre);
        let dual = contravariant(&centre, det0);
        let axes = Axes::new(&centre);
        let mut smallest = det0;
        let mut re = Reference {
            y,
            metric: [Metric::CARTESIAN; POINTS],
            volume: [0.0; POINTS],
            from_local: [[[0.0; 3]; 3]; POINTS],
            to_local: [[[0.0; 3]; 3]; POINTS],
            moments: [[0.0; 2]; 2],
            volumes: [[0.0; VOLUMES]; VOLUMES],
            enhanced: [[[0.0; MODES]; 6]; POINTS],
        };
        let mut moments = nalgebra::Matrix2::zeros();
        let mut products = nalgebra::SMatrix::<f64, VOLUMES, VOLUMES>::zeros();
        for (g, point) in tables.points.iter().enumerate() {
            let frame = frame(&y, &point.n);
            let jacobian = det(&frame);
            // Written so that NaN stays.
            smallest = if jacobian >= smallest {
                smallest
            } else {
                jacobian
            };
            let volume = jacobian * point.weight;
            let [a, b, c] = frame;
            re.volume[g] = volume;
            re.metric[g] = Metric::new([
                dot(&a, &a),
                dot(&b, &b),
                dot(&c, &c),
                dot(&a, &b),
                dot(&b, &c),
                dot(&a, &c),
            ]);
            let local = axes.local(&frame);
            re.from_local[g] = local;
            re.to_local[g] = inverse3(&local);
            let t = [1.0, point.xi[2]];
            let p = volume_functions(point.xi);
            for k in 0..2 {
                for l in 0..2 {
                    moments[(k, l)] += volume * t[k] * t[l];
                }
            }
            for k in 0..VOLUMES {
                for l in 0..VOLUMES {
                    products[(k, l)] += volume * p[k] * p[l];
                }
            }
            // E_ij = J_i^3 J_j^3 e_33 with J_i^3 = G_i . G_0^3.
            let j = frame.map(|gi| dot(&gi, &dual[2]));
            let [r, s, t] = point.xi;
            for (v, (i, k)) in crate::shell::VOIGT.into_iter().enumerate() {
                let shear = if i == k { 1.0 } else { 2.0 };
                let base = det0 / jacobian * shear * j[i] * j[k] * t;
                re.enhanced[g][v] = [base, base * r, base * s, base * r * s];
            }
        }
        // Both are positive definite wherever all volumes are positive.
        let moments = moments.try_inverse().unwrap_or_default();
        let products = products.try_inverse().unwrap_or_default();
        re.moments = std::array::from_fn(|k| std::array::from_fn(|l| moments[(k, l)]));
        re.volumes = std::array::from_fn(|k| std::array::from_fn(|l| products[(k, l)]));
        for m in 0..MODES {
            let mut column = re.enhanced.map(|rows| rows.map(|row| row[m]));
            super::strain::project_volume(&re, &mut column);
            for (rows, column) in re.enhanced.iter_mut().zip(column) {
                for (row, value) in rows.iter_mut().zip(column) {
                    row[m] = value;
                }
            }
        }
        (re, smallest)
    }
}

/// Cartesian axes in the tangent plane of the element's centre, carried over the curved mid-surface by the smallest
/// rotation that takes one normal to the other.
struct Axes {
    e: [Vec3; 2],
    normal: Vec3,
}

impl Axes {
    fn new(centre: &[V<f64>; 3]) -> Axes {
        let [a, b] = [Vec3::from(centre[0]), Vec3::from(centre[1])];
        let normal = a.cross(&b).normalize();
        let e1 = a.normalize();
        Axes {
            e: [e1, normal.cross(&e1)],
            normal,
        }
    }

    /// Covariant in-plane strain (11, 22, 2 x 12) of Cartesian strain (11, 22, 2 x 12) at a frame.
    fn local(&self, frame: &[V<f64>; 3]) -> [[f64; 3]; 3] {
        let [a, b] = [Vec3::from(frame[0]), Vec3::from(frame[1])];
        let normal = a.cross(&b).normalize();
        let c = self.normal.cross(&normal);
        let f = 1.0 / (1.0 + self.normal.dot(&normal)).max(1e-3);
        let e = self.e.map(|e| {
            let ce = c.cross(&e);
            e + ce + c.cross(&ce) * f
        });
        let [a1, a2] = e.map(|e| a.dot(&e));
        let [b1, b2] = e.map(|e| b.dot(&e));
        [
            [a1 * a1, a2 * a2, a1 * a2],
            [b1 * b1, b2 * b2, b1 * b2],
            [2.0 * a1 * b1, 2.0 * a2 * b2, a1 * b2 + a2 * b1],
        ]
    }
}

fn inverse3(m: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let matrix = nalgebra::Matrix3::from_fn(|i, j| m[i][j]);
    // Singular only where the element is degenerate, which the Jacobian reports.
    let inverse = matrix.try_inverse().unwrap_or_default();
    std::array::from_fn(|i| std::array::from_fn(|j| inverse[(i, j)]))
}
