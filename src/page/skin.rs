//! The outside of a body: faces that belong to one element only, with the edges of elements on them.
use crate::mesh::{ElementKind, H8_FACES, Mesh};
use std::collections::HashMap;

/// Faces of a body's outside on nodes of their own.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Skin {
    /// Nodes of the mesh that the faces use, in ascending order.
    pub nodes: Vec<u32>,
    /// Corners of the faces, as places in `nodes`.
    pub quads: Vec<[u32; 4]>,
    /// Edges of elements on them, each once.
    pub edges: Vec<[u32; 2]>,
}

/// A face of a linear cell, and which of its sides are edges of the element.
struct Face {
    corners: [u32; 4],
    edges: [bool; 4],
}

/// The outside of a mesh. An element of 18 nodes is shown as four linear cells.
pub(super) fn skin(mesh: &Mesh) -> Skin {
    let mut faces: Vec<Face> = Vec::new();
    // Per set of corners: the place of its only face, or none where there are two.
    let mut seen: HashMap<[u32; 4], Option<usize>> = HashMap::new();
    let cells: &[[usize; 2]] = match mesh.kind {
        ElementKind::H8 | ElementKind::Nurbs => &[[0, 0]],
        ElementKind::Q18 => &[[0, 0], [1, 0], [0, 1], [1, 1]],
    };
    // Nodes along a side of the element.
    let row = match mesh.kind {
        ElementKind::H8 | ElementKind::Nurbs => 2,
        ElementKind::Q18 => 3,
    };
    for e in 0..mesh.elements() {
        let element = mesh.element(e);
        for [i, j] in cells {
            // Place of a corner of the cell in the grid of the element's nodes.
            let at = |k: usize| [i + k % 2, j + k / 2 % 2, k / 4];
            let node = |k: usize| {
                let [a, b, c] = at(k);
                element[a + row * b + row * row * c]
            };
            // Along a border of the element: two places that share an outer value of one of its two directions, or one
            // corner above the other.
            let border = |p: usize, q: usize| {
                let (p, q) = (at(p), at(q));
                let outer = |d: usize| p[d] == q[d] && (p[d] == 0 || p[d] == row - 1);
                match p[2] == q[2] {
                    true => outer(0) || outer(1),
                    false => outer(0) && outer(1),
                }
            };
            for [a, b, c, d] in H8_FACES.map(|face| face.map(usize::from)) {
                // Around the face, counter-clockwise seen from outside.
                let face = [a, b, d, c];
                let corners = face.map(node);
                let mut key = corners;
                key.sort_unstable();
                let place = faces.len();
                (seen.entry(key))
                    .and_modify(|one| *one = None)
                    .or_insert(Some(place));
                let edges = std::array::from_fn(|s| border(face[s], face[(s + 1) % 4]));
                faces.push(Face { corners, edges });
            }
        }
    }
    let mut outer: Vec<usize> = seen.into_values().flatten().collect();
    outer.sort_unstable();
    let corners = outer.iter().flat_map(|&f| faces[f].corners);
    let mut nodes: Vec<u32> = corners.collect();
    nodes.sort_unstable();
    nodes.dedup();
    let mut place = vec![0u32; mesh.nodes.len()];
    for (k, &node) in nodes.iter().enumerate() {
        place[node as usize] = k as u32;
    }
    let mut edges = Vec::new();
    let mut quads = Vec::with_capacity(outer.len());
    for face in outer.iter().map(|&f| &faces[f]) {
        let quad = face.corners.map(|n| place[n as usize]);
        for s in (0..4).filter(|&s| face.edges[s]) {
            let (a, b) = (quad[s], quad[(s + 1) % 4]);
            edges.push([a.min(b), a.max(b)]);
        }
        quads.push(quad);
    }
    edges.sort_unstable();
    edges.dedup();
    Skin {
        nodes,
        quads,
        edges,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use covact_geometry::Vec3;
    use std::collections::BTreeMap;

    /// A row of elements along x, `n` nodes to a side of each.
    fn row(kind: ElementKind, n: u32) -> Mesh {
        let length = 2 * (n - 1) + 1;
        let number = |i: u32, j: u32, k: u32| i + length * (j + n * k);
        let mut nodes = Vec::new();
        for k in 0..2 {
            for j in 0..n {
                nodes.extend((0..length).map(|i| Vec3::new(i.into(), j.into(), k.into())));
            }
        }
        let mut connectivity = Vec::new();
        for e in 0..2 {
            for k in 0..2 {
                for j in 0..n {
                    connectivity.extend((0..n).map(|i| number(e * (n - 1) + i, j, k)));
                }
            }
        }
        Mesh {
            kind,
            nodes,
            connectivity,
            node_sets: BTreeMap::new(),
            face_sets: BTreeMap::new(),
        }
    }

    /// Area by the normals of faces, and their flow of the position: three times the volume where all point outside.
    fn measure(mesh: &Mesh, skin: &Skin) -> (f64, f64) {
        let x = |k: u32| mesh.nodes[skin.nodes[k as usize] as usize];
        let (mut area, mut flow) = (0.0, 0.0);
        for q in &skin.quads {
            let normal = (x(q[2]) - x(q[0])).cross(&(x(q[3]) - x(q[1]))) * 0.5;
            area += normal.norm();
            flow += normal.dot(&((x(q[0]) + x(q[2])) * 0.5));
        }
        (area, flow)
    }

    #[test]
    fn two_linear_elements_have_ten_faces_and_twenty_edges() {
        let mesh = row(ElementKind::H8, 2);
        let skin = skin(&mesh);
        assert_eq!(skin.quads.len(), 10);
        assert_eq!((skin.nodes.len(), skin.edges.len()), (12, 20));
        assert_eq!(measure(&mesh, &skin), (10.0, 6.0));
    }

    #[test]
    fn two_quadratic_elements_show_no_lines_inside() {
        let mesh = row(ElementKind::Q18, 3);
        let skin = skin(&mesh);
        // Two times 4 x 2 faces on top and bottom, 2 x (4 + 2) around.
        assert_eq!(skin.quads.len(), 28);
        assert_eq!(measure(&mesh, &skin), (4.0 * 2.0 * 2.0 + 12.0, 24.0));
        // On top and bottom 2 x 4 along x and 3 x 2 along y, 6 upright ones.
        assert_eq!(skin.edges.len(), 2 * (8 + 6) + 6);
    }
}
