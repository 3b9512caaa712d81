//! What an element knows once and for all: tables of the parent cube, and its undeformed geometry.
use super::kinematics::{Fields, V, dot};
use super::material::Metric;

/// Coordinate of the Gauss points, 1/sqrt(3).
pub(super) const GP: f64 = 0.577_350_269_189_625_8;

/// Sign of bit `bit` of a node or Gauss point number: -1 or +1.
pub(super) const fn sign(number: usize, bit: usize) -> f64 {
    if (number >> bit) & 1 == 0 { -1.0 } else { 1.0 }
}

/// Linear shape functions at -GP and +GP: `LINE[point][end]`.
pub(super) const LINE: [[f64; 2]; 2] = [
    [0.5 * (1.0 + GP), 0.5 * (1.0 - GP)],
    [0.5 * (1.0 - GP), 0.5 * (1.0 + GP)],
];

/// Parameters of the strain interpolation, in this order: eight tying points of assumed strains (33 at the four
/// corners, 23 at r = -1 and r = +1, 13 at s = -1 and s = +1), up to seven enhanced modes (33: t, rt, st; 11: r;
/// 22: s; 12: r, s), and one slot for forces. Elements with six layers have an eighth mode (33: t^2 - 1/3) before it.
pub(super) const PARAMETERS: usize = 16;
pub(super) const TYING: usize = 8;

/// Base strain of every parameter: 0..3 assumed 33, 23, 13, 3..7 enhanced 33 (times t), 11, 22, 12, then those that have a base of
/// their own, forces at last.
pub(super) const BASE: [usize; PARAMETERS + 1] =
    [0, 0, 0, 0, 1, 1, 2, 2, 3, 3, 3, 4, 5, 6, 6, 7, 8];

/// In-plane weight of every parameter at the four in-plane Gauss points.
pub(super) const WEIGHT: [[f64; PARAMETERS + 1]; 4] =
    [weights(0), weights(1), weights(2), weights(3)];

const fn weights(q: usize) -> [f64; PARAMETERS + 1] {
    let (ir, is) = (q & 1, q >> 1);
    let (r, s) = (GP * sign(q, 0), GP * sign(q, 1));
    [
        LINE[ir][0] * LINE[is][0],
        LINE[ir][1] * LINE[is][0],
        LINE[ir][0] * LINE[is][1],
        LINE[ir][1] * LINE[is][1],
        LINE[ir][0],
        LINE[ir][1],
        LINE[is][0],
        LINE[is][1],
        1.0,
        r,
        s,
        r,
        s,
        r,
        s,
        1.0,
        1.0,
    ]
}

/// Undeformed geometry of one element. Gauss points are numbered `i + 2 j + 4 k`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reference {
    pub nodes: [V<f64>; 8],
    pub metric: [Metric; 8],
    /// Volume of every Gauss point, det J times its weight.
    pub volume: [f64; 8],
    /// `enhanced[g][v][m]`: covariant strain v at Gauss point g of a unit strain 33, 11, 22, 12 in the frame of the
    /// element centre, times `det J_0 / det J`.
    pub enhanced: [[[f64; 4]; 6]; 8],
}

impl Reference {
    /// From the nodes; with the smallest Jacobian determinant over the Gauss points and the centre.
    pub fn new(nodes: [V<f64>; 8]) -> (Reference, f64) {
        let fields = Fields::new(&nodes);
        let centre = fields.centre();
        let det0 = det(&centre);
        let mut smallest = det0;
        let dual = contravariant(&centre, det0);
        let mut volume = [0.0; 8];
        let mut metric = [Metric::CARTESIAN; 8];
        let mut enhanced = [[[0.0; 4]; 6]; 8];
        for g in 0..8 {
            let frame = fields.at(g);
            volume[g] = det(&frame);
            smallest = smallest.min(volume[g]);
            metric[g] = metric_of(&frame);
            enhanced[g] = self::enhanced(&frame, &dual, det0 / volume[g]);
        }
        (
            Reference {
                nodes,
                metric,
                volume,
                enhanced,
            },
            smallest,
        )
    }
}

/// The metric of a frame.
pub(super) fn metric_of([a, b, c]: &[V<f64>; 3]) -> Metric {
    Metric::new([
        dot(a, a),
        dot(b, b),
        dot(c, c),
        dot(a, b),
        dot(b, c),
        dot(a, c),
    ])
}

/// Covariant strains at a frame of unit strains 33, 11, 22, 12 in the frame of the element centre, whose contravariant
/// vectors are `dual`; times `f = det J_0 / det J`.
pub(super) fn enhanced(frame: &[V<f64>; 3], dual: &[V<f64>; 3], f: f64) -> [[f64; 4]; 6] {
    // E_ij = J_i^k J_j^l e_kl with J_i^k = G_i . G_0^k.
    let j = frame.map(|gi| dual.map(|gk| dot(&gi, &gk)));
    let mut strains = [[0.0; 4]; 6];
    for (v, (i, k)) in super::VOIGT.into_iter().enumerate() {
        let shear = if i == k { 1.0 } else { 2.0 };
        for (m, n) in [2, 0, 1].into_iter().enumerate() {
            strains[v][m] = f * shear * j[i][n] * j[k][n];
        }
        strains[v][3] = f * shear * 0.5 * (j[i][0] * j[k][1] + j[i][1] * j[k][0]);
    }
    strains
}

/// Triple product of a frame.
pub(super) fn det([a, b, c]: &[V<f64>; 3]) -> f64 {
    dot(&cross(a, b), c)
}

fn cross(a: &V<f64>, b: &V<f64>) -> V<f64> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Contravariant vectors `G^i` of a frame with determinant `det`.
pub(super) fn contravariant([a, b, c]: &[V<f64>; 3], det: f64) -> [V<f64>; 3] {
    [cross(b, c), cross(c, a), cross(a, b)].map(|v| v.map(|x| x / det))
}
