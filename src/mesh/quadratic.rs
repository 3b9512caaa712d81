//! Node order of hexahedra with 27 and with 20 nodes.
use super::raw::{NONE, RawMesh};
use covact_geometry::Vec3;
use std::collections::HashMap;

/// Places `i + 3 j + 9 k` of the corners and of the middles of the edges, in the order of Abaqus (and VTK, Nastran).
pub(super) const PLACES: [usize; 20] = [
    0, 2, 8, 6, 18, 20, 26, 24, // corners
    1, 5, 7, 3, 19, 23, 25, 21, 9, 11, 17, 15, // edges
];
/// Places of the middles of the faces and of the element.
const INNER: [usize; 7] = [4, 10, 12, 14, 16, 22, 13];

/// Nodes of a 27-node element by their places. The nodes in the middle of faces and of the element, the last seven, are
/// told apart by where they lie, because programs do not agree on their order. `None` where two lie nearest to the same
/// place.
pub(super) fn tensor_27(nodes: &[u32; 27], positions: &[Vec3]) -> Option<[u32; 27]> {
    let mut tensor = [NONE; 27];
    for (place, &node) in PLACES.into_iter().zip(nodes) {
        tensor[place] = node;
    }
    let expected = INNER.map(|place| serendipity(&tensor, place, positions));
    for &node in &nodes[20..] {
        let x = positions[node as usize];
        let nearest = (0..7).min_by(|&a, &b| {
            let distance = |k: usize| (expected[k] - x).norm_squared();
            distance(a).total_cmp(&distance(b))
        })?;
        if tensor[INNER[nearest]] != NONE {
            return None;
        }
        tensor[INNER[nearest]] = node;
    }
    Some(tensor)
}

/// Where a 20-node element has the middle of a face or its own.
fn serendipity(tensor: &[u32; 27], place: usize, positions: &[Vec3]) -> Vec3 {
    let c = [place % 3, place / 3 % 3, place / 9];
    let (mut sum, mut edges, mut corners) = ([Vec3::zeros(); 2], 0, 0);
    for other in PLACES {
        let o = [other % 3, other / 3 % 3, other / 9];
        if (0..3).any(|d| c[d] != 1 && o[d] != c[d]) {
            continue;
        }
        let is_edge = o.contains(&1);
        sum[usize::from(is_edge)] += positions[tensor[other] as usize];
        edges += usize::from(is_edge);
        corners += usize::from(!is_edge);
    }
    // Both the face's four edges and the element's twelve weigh 2 resp. 3 in all, its corners one less, negative.
    let weight = if edges == 4 { 2.0 } else { 3.0 };
    sum[1] * (weight / edges as f64) - sum[0] * ((weight - 1.0) / corners as f64)
}

impl RawMesh {
    /// Adds the nodes in the middle of faces and elements that 20-node hexahedra do not have; neighbours share those of
    /// their common face.
    pub(super) fn complete_hexahedra(&mut self) {
        let mut faces: HashMap<[u32; 4], u32> = HashMap::new();
        for tensor in &mut self.quadratic {
            for place in INNER {
                if tensor[place] != NONE {
                    continue;
                }
                self.completed = true;
                let x = serendipity(tensor, place, &self.nodes);
                let mut add = || {
                    self.nodes.push(x);
                    self.node_tags.push(0);
                    self.nodes.len() as u32 - 1
                };
                // Steps to two neighbouring corners of the face; the middle of the element has no face.
                let steps = [1, 3, 9].map(|step| (place / step % 3 == 1).then_some(step));
                let node = match steps.iter().flatten().collect::<Vec<_>>()[..] {
                    [&u, &v] => {
                        let corners = [place - u - v, place + u - v, place - u + v, place + u + v];
                        let mut key = corners.map(|corner| tensor[corner]);
                        key.sort_unstable();
                        *faces.entry(key).or_insert_with(add)
                    }
                    _ => add(),
                };
                tensor[place] = node;
            }
        }
    }
}
