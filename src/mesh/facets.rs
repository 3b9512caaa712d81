//! Faces of a mesh as facets of a surface.
use super::{Face, Mesh};
use covact_geometry::FacetMesh;

/// Faces as bilinear facets over their corners, with what they are in the mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFacets {
    /// The facets; `rho_1 x rho_2` points out of the body, and neighbours share nodes as the elements do.
    pub facets: FacetMesh<4>,
    /// Node of the mesh of every node of the facets, ascending.
    pub nodes: Vec<u32>,
    /// Face of the mesh of every facet.
    pub faces: Vec<Face>,
}

impl Mesh {
    /// Some faces as facets, for a set of patches of its own or as nodes that move with the body. The parameters of a facet
    /// are those of the face.
    pub fn facets(&self, faces: &[Face]) -> MeshFacets {
        let mut nodes: Vec<u32> = faces.iter().flat_map(|&f| self.face_corners(f)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut place = vec![0; self.nodes.len()];
        for (k, &node) in nodes.iter().enumerate() {
            place[node as usize] = k as u32;
        }
        let facet = |&face: &Face| self.face_corners(face).map(|node| place[node as usize]);
        MeshFacets {
            facets: FacetMesh {
                nodes: nodes.iter().map(|&n| self.nodes[n as usize]).collect(),
                facets: faces.iter().map(facet).collect(),
            },
            nodes,
            faces: faces.to_vec(),
        }
    }

    /// [`Mesh::facets`] of all [`Mesh::outer_faces`]: the closed surface of the body.
    pub fn outer_facets(&self) -> MeshFacets {
        self.facets(&self.outer_faces())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::ElementKind;
    use covact_geometry::{PatchSet, Vec3};

    /// Two elements side by side, a box of 2 x 1 x 1: ten outer faces over twelve nodes, distances with the right sign
    /// inside and outside, and the first element's alone with its own nodes.
    #[test]
    fn outer_faces_have_an_inside() {
        let mesh = Mesh {
            kind: ElementKind::H8,
            nodes: (0..12)
                .map(|k| Vec3::new((k % 3) as f64, (k / 3 % 2) as f64, (k / 6) as f64))
                .collect(),
            connectivity: vec![0, 1, 3, 4, 6, 7, 9, 10, 1, 2, 4, 5, 7, 8, 10, 11],
            node_sets: Default::default(),
            face_sets: Default::default(),
        };
        let outer = mesh.outer_facets();
        assert_eq!((outer.facets.facets.len(), outer.nodes.len()), (10, 12));
        let set = PatchSet::new(outer.facets.surfaces().unwrap(), None).unwrap();
        assert!(set.edges().free.is_empty());
        // 16 edges of elements lie along edges of the box, 4 in its faces.
        assert_eq!((set.edges().sharp, set.edges().smooth), (16, 4));
        assert!(set.sides().iter().all(|&s| s == 1.0));
        let distance = |x, y, z| {
            let q = Vec3::new(x, y, z);
            let foot = set.project(&q, None, f64::INFINITY).unwrap();
            foot.signed_distance
        };
        assert!((distance(0.7, 0.5, 0.6) + 0.4).abs() < 1e-14);
        assert!((distance(1.2, 0.5, 1.5) - 0.5).abs() < 1e-14);
        assert!((distance(2.3, 1.4, 0.5) - 0.5).abs() < 1e-14);
        let faces: Vec<Face> = (outer.faces.iter().copied())
            .filter(|f| f.element == 1)
            .collect();
        let right = mesh.facets(&faces);
        assert_eq!(
            (right.facets.facets.len(), &right.nodes[..2]),
            (5, &[1, 2][..])
        );
        assert_eq!(right.facets.nodes[0], Vec3::new(1.0, 0.0, 0.0));
    }
}
