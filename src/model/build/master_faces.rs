//! Whether faces of a body make one surface with an outside.
use super::super::error::number;
use crate::mesh::{Face, Mesh};
use covact_geometry::Vec3;
use std::collections::BTreeMap;

/// Edges of a face with corners u fastest, so that they run round it.
const EDGES: [[usize; 2]; 4] = [[0, 1], [1, 3], [3, 2], [2, 0]];

/// Refuses faces on both sides of a layer, and edges at which more than two faces meet or which two faces run along in
/// the same direction; returns what is wrong and what to do about it.
pub(crate) fn check(mesh: &Mesh, faces: &[Face], name: &str) -> Result<(), (String, &'static str)> {
    let mut edges: BTreeMap<[u32; 2], Vec<bool>> = BTreeMap::new();
    let mut corners: BTreeMap<[u32; 4], Face> = BTreeMap::new();
    let middle = |nodes: &[u32]| {
        let sum = nodes
            .iter()
            .fold(Vec3::zeros(), |s, &n| s + mesh.nodes[n as usize]);
        let at = sum / nodes.len() as f64;
        format!("({}, {}, {})", number(at.x), number(at.y), number(at.z))
    };
    for &face in faces {
        let around = mesh.face_corners(face);
        let mut key = around;
        key.sort_unstable();
        if corners.insert(key, face).is_some() {
            let message = format!(
                "`{name}` holds both sides of the face near {}, between two elements",
                middle(&around)
            );
            return Err((message, "a master is made of outer faces of the body"));
        }
        for [a, b] in EDGES.map(|e| e.map(|i| around[i])) {
            if a != b {
                edges.entry([a.min(b), a.max(b)]).or_default().push(a < b);
            }
        }
    }
    for (edge, directions) in edges {
        let at = middle(&edge);
        if directions.len() > 2 {
            let message = format!(
                "{} faces of `{name}` meet at the edge near {at}: they make no surface with one outside",
                directions.len()
            );
            let help = "leave out the faces inside the body or those beyond the edge, in a set of their own";
            return Err((message, help));
        }
        if directions.len() == 2 && directions[0] == directions[1] {
            let message = format!(
                "`{name}` folds: two faces that share the edge near {at} have their outsides on different sides"
            );
            let help = "take outer faces of the body that lie side by side";
            return Err((message, help));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::ElementKind;

    /// Bricks of side 1 with the given lower corners, nodes shared where they coincide.
    fn bricks(corners: &[[i32; 3]]) -> Mesh {
        let mut numbers: BTreeMap<[i32; 3], u32> = BTreeMap::new();
        let mut mesh = Mesh {
            kind: ElementKind::H8,
            nodes: Vec::new(),
            connectivity: Vec::new(),
            node_sets: Default::default(),
            face_sets: Default::default(),
        };
        for [x, y, z] in corners {
            for k in 0..8 {
                let at = [x + (k & 1), y + ((k >> 1) & 1), z + (k >> 2)];
                let next = numbers.len() as u32;
                let number = *numbers.entry(at).or_insert(next);
                if number == next {
                    mesh.nodes.push(Vec3::from(at.map(f64::from)));
                }
                mesh.connectivity.push(number);
            }
        }
        mesh
    }

    fn face(element: u32, face: u8) -> Face {
        Face { element, face }
    }

    #[test]
    fn faces_that_make_no_surface_are_named() {
        let two = bricks(&[[0, 0, 0], [1, 0, 0]]);
        assert_eq!(check(&two, &two.outer_faces(), "a.all"), Ok(()));
        let said = |mesh: &Mesh, faces: &[Face]| check(mesh, faces, "a.s").unwrap_err().0;
        let both = said(&two, &[face(0, 1), face(1, 0)]);
        assert!(
            both.contains("both sides of the face near (1, 0.5, 0.5)"),
            "{both}"
        );
        let three = said(&two, &[face(0, 5), face(1, 5), face(0, 1)]);
        assert!(
            three.starts_with("3 faces of `a.s` meet at the edge near (1, 0.5, 1)"),
            "{three}"
        );
        // Joined along an edge only: one face looks to the right, the one above it to the left.
        let diagonal = bricks(&[[0, 0, 0], [1, 0, 1]]);
        let folds = said(&diagonal, &[face(0, 1), face(1, 0)]);
        assert!(
            folds.contains("`a.s` folds: two faces that share the edge near (1, 0.5, 1)"),
            "{folds}"
        );
    }
}
