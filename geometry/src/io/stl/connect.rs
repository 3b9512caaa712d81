//! Corners of triangles that are the same point.
use super::{Record, Stl, StlError, StlReport};
use crate::surface::Vec3;
use std::collections::HashMap;

/// Merges vertices and finds what hangs together.
pub(super) fn connect(
    records: &[Record],
    binary: bool,
    path: &str,
    merge: Option<f64>,
) -> Result<Stl, StlError> {
    if records.len() > (u32::MAX / 6) as usize {
        return Err(StlError::TooLarge {
            path: path.to_owned(),
            triangles: records.len(),
        });
    }
    let vertices = || records.iter().flat_map(|r| &r[1..]);
    let largest = vertices().map(|x| x.amax()).fold(0.0, f64::max);
    let tolerance = merge.unwrap_or(largest * 2f64.powi(-21));
    let mut merger = Merger::new(tolerance);
    let mut out = Stl {
        nodes: Vec::new(),
        triangles: Vec::new(),
        numbers: Vec::new(),
        report: StlReport {
            binary,
            triangles: records.len(),
            merged: 0,
            tolerance,
            degenerate: Vec::new(),
            flipped: 0,
            free: 0,
            branching: 0,
            normals_against: 0,
        },
    };
    for (k, [normal, a, b, c]) in records.iter().enumerate() {
        let nodes = [a, b, c].map(|x| merger.node(x, &mut out.nodes));
        let [a, b, c] = nodes.map(|n| out.nodes[n as usize]);
        let cross = (b - a).cross(&(c - a));
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let [i, j, l] = nodes;
        let flat = cross.norm() <= longest * tolerance.max(1e-12 * longest);
        if i == j || j == l || l == i || flat {
            out.report.degenerate.push(k);
            continue;
        }
        out.report.normals_against += usize::from(normal.dot(&cross) < 0.0);
        out.triangles.push(nodes);
        out.numbers.push(k as u32);
    }
    if out.triangles.is_empty() {
        return Err(StlError::Empty {
            path: path.to_owned(),
            triangles: records.len(),
        });
    }
    out.report.merged = 3 * records.len() - out.nodes.len();
    // Edges by their nodes; the sense in which they are run through.
    let mut edges: Vec<([u32; 2], bool)> = (out.triangles.iter())
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| ([a.min(b), a.max(b)], a < b))
        .collect();
    edges.sort_unstable();
    for group in edges.chunk_by(|a, b| a.0 == b.0) {
        match group {
            [_] => out.report.free += 1,
            [a, b] => out.report.flipped += usize::from(a.1 == b.1),
            _ => out.report.branching += 1,
        }
    }
    Ok(out)
}

/// Finds the node of a point in boxes as wide as the tolerance.
pub(super) struct Merger {
    tolerance: f64,
    boxes: HashMap<[i64; 3], Vec<u32>>,
    exact: HashMap<[u64; 3], u32>,
}

impl Merger {
    pub(super) fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            boxes: HashMap::new(),
            exact: HashMap::new(),
        }
    }

    fn node(&mut self, x: &Vec3, nodes: &mut Vec<Vec3>) -> u32 {
        // Adding zero makes one of the two zeros.
        let bits = [x.x, x.y, x.z].map(|x| (x + 0.0).to_bits());
        if let Some(&node) = self.exact.get(&bits) {
            return node;
        }
        let mut found = None;
        let mut place = [0; 3];
        if self.tolerance > 0.0 {
            place = [x.x, x.y, x.z].map(|x| interval(x / self.tolerance));
            for k in 0..27i64 {
                let step = [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1];
                let key: [i64; 3] = std::array::from_fn(|i| place[i].saturating_add(step[i]));
                for &node in self.boxes.get(&key).into_iter().flatten() {
                    let distance = (nodes[node as usize] - x).norm();
                    let nearer = found.is_none_or(|(d, _)| distance < d);
                    if distance <= self.tolerance && nearer {
                        found = Some((distance, node));
                    }
                }
            }
        }
        let node = match found {
            Some((_, node)) => node,
            None => {
                let node = nodes.len() as u32;
                nodes.push(*x);
                if self.tolerance > 0.0 {
                    self.boxes.entry(place).or_default().push(node);
                }
                node
            }
        };
        self.exact.insert(bits, node);
        node
    }
}

/// Number of the unit interval that holds `x`. Where numbers lie farther apart than that, each has one of its own; an order
/// by size is kept, so that neighbours have neighbouring numbers.
pub(super) fn interval(x: f64) -> i64 {
    const WHOLE: f64 = (1i64 << 53) as f64;
    if x.abs() < WHOLE {
        return x.floor() as i64;
    }
    let past = (x.abs().to_bits() - WHOLE.to_bits()) as i64;
    let number = (1i64 << 53) + past;
    if x > 0.0 { number } else { -number }
}
