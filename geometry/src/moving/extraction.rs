//! Control points as linear combinations of nodes.

use super::net::bernstein;
use super::{CurvedRows, ShapeRows};
use crate::surface::Vec3;

/// The control points of a facet as combinations of its nodes: a sparse matrix by rows. Facets with the same matrix share
/// one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Operator {
    /// Start of each row, and one past the last.
    starts: Vec<u16>,
    entries: Vec<(u16, f64)>,
    /// Weights of the control points. Empty where all of them are 1.
    weights: Vec<f64>,
}

impl Operator {
    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        super::heap(&self.starts) + super::heap(&self.entries) + super::heap(&self.weights)
    }

    /// Of rows of nodes (by place among the facet's) with factors.
    pub fn new(rows: impl IntoIterator<Item = Vec<(u16, f64)>>) -> Self {
        let mut out = Operator {
            starts: vec![0],
            entries: Vec::new(),
            weights: Vec::new(),
        };
        for row in rows {
            out.entries.extend(row.into_iter().filter(|e| e.1 != 0.0));
            out.starts.push(out.entries.len() as u16);
        }
        out
    }

    /// Of nodes with weights, which the factors contain: the control points become homogeneous, and the weight of each is
    /// the sum of its factors.
    pub fn rational(rows: impl IntoIterator<Item = Vec<(u16, f64)>>) -> Self {
        let mut out = Self::new(rows);
        let rows = out.starts.windows(2);
        let weight = |row: &[u16]| {
            let row = &out.entries[row[0] as usize..row[1] as usize];
            row.iter().map(|e| e.1).sum()
        };
        out.weights = rows.map(weight).collect();
        out
    }

    /// Whether control points have weights.
    pub fn is_rational(&self) -> bool {
        !self.weights.is_empty()
    }

    /// What makes two operators the same: their bits.
    pub fn key(&self) -> Vec<u64> {
        let starts = self.starts.iter().map(|&s| u64::from(s));
        let entries = self.entries.iter();
        starts
            .chain(entries.flat_map(|&(k, f)| [u64::from(k), f.to_bits()]))
            .chain(self.weights.iter().map(|w| w.to_bits()))
            .collect()
    }

    /// Of a Lagrange facet with `count` (2 or 3) nodes in each direction, for Bezier pieces of the given degree.
    pub fn lagrange(count: [u8; 2], degree: usize) -> Self {
        let one = [0, 1].map(|k| lines(count[k], degree));
        let mut rows = Vec::new();
        for second in &one[1] {
            for first in &one[0] {
                let n = first.len();
                let row = (0..n * second.len()).map(|k| (k as u16, first[k % n] * second[k / n]));
                rows.push(row.collect());
            }
        }
        Self::new(rows)
    }

    /// Control points (homogeneous) from the positions of the facet's nodes.
    #[inline]
    pub fn apply(&self, places: &[u32], positions: &[Vec3], net: &mut [[f64; 4]]) {
        for (c, (point, range)) in net.iter_mut().zip(self.starts.windows(2)).enumerate() {
            let mut sum = Vec3::zeros();
            for &(k, factor) in &self.entries[range[0] as usize..range[1] as usize] {
                sum += positions[places[k as usize] as usize] * factor;
            }
            let weight = self.weights.get(c).copied().unwrap_or(1.0);
            *point = [sum.x, sum.y, sum.z, weight];
        }
    }

    /// Shape functions of the nodes; `out.count` says how many there are.
    #[inline]
    pub fn shape<const M: usize>(&self, xi: [f64; 2], out: &mut ShapeRows) {
        let [u, v] = xi.map(bernstein::<f64, M>);
        out.n[..out.count].fill(0.0);
        out.n_1[..out.count].fill(0.0);
        out.n_2[..out.count].fill(0.0);
        for (c, range) in self.starts.windows(2).enumerate() {
            let (i, j) = (c % M, c / M);
            let b = [u[0][i] * v[0][j], u[1][i] * v[0][j], u[0][i] * v[1][j]];
            for &(k, factor) in &self.entries[range[0] as usize..range[1] as usize] {
                let k = k as usize;
                out.n[k] += factor * b[0];
                out.n_1[k] += factor * b[1];
                out.n_2[k] += factor * b[2];
            }
        }
        if self.is_rational() {
            let [w, w1, w2] =
                [[&u[0], &v[0]], [&u[1], &v[0]], [&u[0], &v[1]]].map(|[u, v]| self.weight(u, v));
            for k in 0..out.count {
                out.n[k] /= w;
                out.n_1[k] = (out.n_1[k] - w1 * out.n[k]) / w;
                out.n_2[k] = (out.n_2[k] - w2 * out.n[k]) / w;
            }
        }
    }

    /// The weight function, or a derivative of it, by the polynomials of both directions.
    fn weight<const M: usize>(&self, u: &[f64; M], v: &[f64; M]) -> f64 {
        let terms = self.weights.iter().enumerate();
        terms.map(|(c, w)| w * u[c % M] * v[c / M]).sum()
    }

    /// Second derivatives of the shape functions; `out.rows` has the functions and their first ones.
    #[inline]
    pub fn second<const M: usize>(&self, xi: [f64; 2], out: &mut CurvedRows) {
        let [u, v] = xi.map(bernstein::<f64, M>);
        let count = out.rows.count;
        out.n_11[..count].fill(0.0);
        out.n_12[..count].fill(0.0);
        out.n_22[..count].fill(0.0);
        for (c, range) in self.starts.windows(2).enumerate() {
            let (i, j) = (c % M, c / M);
            let b = [u[2][i] * v[0][j], u[1][i] * v[1][j], u[0][i] * v[2][j]];
            for &(k, factor) in &self.entries[range[0] as usize..range[1] as usize] {
                let k = k as usize;
                out.n_11[k] += factor * b[0];
                out.n_12[k] += factor * b[1];
                out.n_22[k] += factor * b[2];
            }
        }
        if self.is_rational() {
            let of = |a: usize, b: usize| self.weight(&u[a], &v[b]);
            let (w, w1, w2) = (of(0, 0), of(1, 0), of(0, 1));
            let [w11, w12, w22] = [of(2, 0), of(1, 1), of(0, 2)];
            let ShapeRows { n, n_1, n_2, .. } = &out.rows;
            for k in 0..count {
                let (n, n1, n2) = (n[k], n_1[k], n_2[k]);
                out.n_11[k] = (out.n_11[k] - 2.0 * w1 * n1 - w11 * n) / w;
                out.n_12[k] = (out.n_12[k] - w1 * n2 - w2 * n1 - w12 * n) / w;
                out.n_22[k] = (out.n_22[k] - 2.0 * w2 * n2 - w22 * n) / w;
            }
        }
    }
}

/// Bezier points of a line of 2 or 3 equally spaced nodes, raised to the degree: a row of factors each.
fn lines(count: u8, degree: usize) -> Vec<Vec<f64>> {
    let rows: &[&[f64]] = match (count, degree) {
        (2, 1) => &[&[1.0, 0.0], &[0.0, 1.0]],
        (2, _) => &[&[1.0, 0.0], &[0.5, 0.5], &[0.0, 1.0]],
        _ => &[&[1.0, 0.0, 0.0], &[-0.5, 2.0, -0.5], &[0.0, 0.0, 1.0]],
    };
    rows.iter().map(|row| row.to_vec()).collect()
}
