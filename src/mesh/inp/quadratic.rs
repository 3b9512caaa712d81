//! Node order of hexahedra with 27 nodes.
use covact_geometry::Vec3;

/// Places `i + 3 j + 9 k` of the file's corners and of the middles of its edges, in the file's order.
const PLACES: [usize; 20] = [
    0, 2, 8, 6, 18, 20, 26, 24, // corners
    1, 5, 7, 3, 19, 23, 25, 21, 9, 11, 17, 15, // edges
];
/// Places of the middles of the faces and of the element.
const INNER: [usize; 7] = [4, 10, 12, 14, 16, 22, 13];

/// Nodes of a 27-node element by their places. The nodes in the middle of faces and of the element, the last seven, are
/// told apart by where they lie, because programs do not agree on their order. `None` where two lie nearest to the same
/// place.
pub(super) fn tensor_27(nodes: &[u32; 27], positions: &[Vec3]) -> Option<[u32; 27]> {
    let mut tensor = [u32::MAX; 27];
    for (place, &node) in PLACES.into_iter().zip(nodes) {
        tensor[place] = node;
    }
    let at = |place: usize| positions[tensor[place] as usize];
    // Where a 20-node element has these places.
    let expected = INNER.map(|place| {
        let c = [place % 3, place / 3 % 3, place / 9];
        let (mut sum, mut edges, mut corners) = ([Vec3::zeros(); 2], 0, 0);
        for other in PLACES {
            let o = [other % 3, other / 3 % 3, other / 9];
            if (0..3).any(|d| c[d] != 1 && o[d] != c[d]) {
                continue;
            }
            let is_edge = o.contains(&1);
            sum[usize::from(is_edge)] += at(other);
            edges += usize::from(is_edge);
            corners += usize::from(!is_edge);
        }
        // Both the face's four edges and the element's twelve weigh 2 resp. 3 in all, its corners one less, negative.
        let weight = if edges == 4 { 2.0 } else { 3.0 };
        sum[1] * (weight / edges as f64) - sum[0] * ((weight - 1.0) / corners as f64)
    });
    for &node in &nodes[20..] {
        let x = positions[node as usize];
        let nearest = (0..7).min_by(|&a, &b| {
            let distance = |k: usize| (expected[k] - x).norm_squared();
            distance(a).total_cmp(&distance(b))
        })?;
        if tensor[INNER[nearest]] != u32::MAX {
            return None;
        }
        tensor[INNER[nearest]] = node;
    }
    Some(tensor)
}
