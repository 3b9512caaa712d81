//! Faces as tensor products of nodes.
use super::{ElementKind, Face, H8_FACES, Mesh};
use crate::fem::{FaceNodes, Quad};

/// Local nodes of the faces of an element shape.
struct LocalFaces {
    nodes: [[u8; 9]; 6],
    count: [[u8; 2]; 6],
}

const H8: LocalFaces = local_faces(2);
const Q18: LocalFaces = local_faces(3);

/// The faces of [`H8_FACES`] for elements of `n` nodes along r and s and two along t.
const fn local_faces(n: usize) -> LocalFaces {
    let size = [n, n, 2];
    let stride = [1, n, n * n];
    let mut out = LocalFaces {
        nodes: [[0; 9]; 6],
        count: [[0; 2]; 6],
    };
    let mut face = 0;
    while face < 6 {
        let [first, along_u, along_v, _] = H8_FACES[face];
        // The corner's number has one bit for each direction.
        let u = (first ^ along_u).trailing_zeros() as usize;
        let v = (first ^ along_v).trailing_zeros() as usize;
        let normal = 3 - u - v;
        let start = if face % 2 == 1 {
            (size[normal] - 1) * stride[normal]
        } else {
            0
        };
        out.count[face] = [size[u] as u8, size[v] as u8];
        let mut k = 0;
        while k < size[u] * size[v] {
            let node = start + (k % size[u]) * stride[u] + (k / size[u]) * stride[v];
            out.nodes[face][k] = node as u8;
            k += 1;
        }
        face += 1;
    }
    out
}

impl Mesh {
    /// Nodes of a face, u fastest, so that `u x v` points outward. The face must be one of the mesh's (see
    /// [`Mesh::has_face`]). Of a knot span they are the corners of its control net, beside the surface itself.
    #[inline]
    pub fn face_nodes(&self, face: Face) -> FaceNodes {
        if self.kind == ElementKind::Nurbs {
            return FaceNodes::bilinear(self.face_corners(face));
        }
        let element = self.element(face.element as usize);
        let faces = match self.kind {
            ElementKind::Q18 => &Q18,
            ElementKind::H8 | ElementKind::Nurbs => &H8,
        };
        let count = faces.count[face.face as usize];
        let n = count[0] as usize * count[1] as usize;
        let mut nodes = [0; 9];
        for (node, local) in nodes[..n].iter_mut().zip(&faces.nodes[face.face as usize]) {
            *node = element[*local as usize];
        }
        FaceNodes { nodes, count }
    }

    /// Corners of a face, u fastest, so that `u x v` points outward.
    #[inline]
    pub fn face_corners(&self, face: Face) -> [u32; 4] {
        let nodes = self.element(face.element as usize);
        let corners = self.kind.corners();
        H8_FACES[face.face as usize].map(|a| nodes[corners[a as usize]])
    }

    /// A face with the positions of its nodes; `None` if the mesh has no such face.
    pub fn quad(&self, face: Face) -> Option<Quad> {
        if !self.has_face(face) {
            return None;
        }
        let nodes = self.face_nodes(face);
        let known = |n: &u32| (*n as usize) < self.nodes.len();
        (nodes.nodes().iter().all(known)).then(|| Quad::new(&nodes, |n| self.nodes[n as usize]))
    }

    /// Whether the mesh has this face.
    pub fn has_face(&self, face: Face) -> bool {
        (face.element as usize) < self.elements() && (face.face as usize) < H8_FACES.len()
    }
}

/// Tributary areas `sum over faces of int N dA` of the nodes of a face set, as pairs (node, area) in ascending node
/// order. Faces that the mesh does not have are left out.
pub fn tributary_areas(mesh: &Mesh, faces: &[Face]) -> Vec<(u32, f64)> {
    let mut areas = std::collections::BTreeMap::new();
    for face in faces {
        if let Some(quad) = mesh.quad(*face) {
            for (node, area) in mesh.face_nodes(*face).nodes().iter().zip(quad.weights()) {
                *areas.entry(*node).or_insert(0.0) += area;
            }
        }
    }
    areas.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use covact_geometry::Vec3;

    /// H8's faces are the table; those of Q18 have its corners and between them the nodes of its own grid.
    #[test]
    fn faces_of_both_shapes() {
        for (face, corner) in H8_FACES.into_iter().enumerate() {
            assert_eq!(H8.nodes[face][..4], corner);
            assert_eq!(H8.count[face], [2, 2]);
            let [nu, nv] = Q18.count[face].map(usize::from);
            assert_eq!((nu, nv) == (3, 3), face >= 4);
            let nodes = &Q18.nodes[face][..nu * nv];
            let corners = [0, nu - 1, nu * (nv - 1), nu * nv - 1].map(|k| nodes[k] as usize);
            let places = ElementKind::Q18.corners();
            assert_eq!(corners, corner.map(|a| places[a as usize]));
            // Position of a node in its grid, twice: straight lines are evenly divided.
            let at = |n: u8| [n % 3, n / 3 % 3, 2 * (n / 9)].map(i32::from);
            for (k, &n) in nodes.iter().enumerate() {
                let (u, v) = ((k % nu) as i32, (k / nu) as i32);
                let (u, v) = (u * 2 / (nu as i32 - 1), v * 2 / (nv as i32 - 1));
                for c in 0..3 {
                    let [a, b, d] = [0, nu - 1, nu * (nv - 1)].map(|k| at(nodes[k])[c]);
                    assert_eq!(2 * at(n)[c], 2 * a + u * (b - a) + v * (d - a));
                }
            }
        }
    }

    /// Unit cube: outward normals, unit areas, and a quarter of the area at every corner of a face.
    #[test]
    fn faces_of_a_cube() {
        let nodes =
            (0..8).map(|a| Vec3::new((a & 1) as f64, ((a >> 1) & 1) as f64, (a >> 2) as f64));
        let mesh = Mesh {
            kind: ElementKind::H8,
            nodes: nodes.collect(),
            connectivity: (0..8).collect(),
            node_sets: Default::default(),
            face_sets: Default::default(),
        };
        for face in 0..6 {
            let quad = mesh.quad(Face { element: 0, face }).unwrap();
            let mut outward = Vec3::zeros();
            outward[face as usize / 2] = if face % 2 == 1 { 4.0 } else { -4.0 };
            // The area of the parameter square is 4.
            assert!(
                (quad.area_vector(0.3, -0.2) * 16.0 - outward).norm() < 1e-14,
                "face {face}"
            );
            assert!(quad.weights()[..4].iter().all(|w| (w - 0.25).abs() < 1e-15));
            assert_eq!(quad.weights()[4..], [0.0; 5]);
            let centre = quad.point(0.0, 0.0) - Vec3::repeat(0.5);
            assert!((centre - outward / 8.0).norm() < 1e-15);
        }
        assert!(
            mesh.quad(Face {
                element: 1,
                face: 0
            })
            .is_none()
        );
        assert!(
            mesh.quad(Face {
                element: 0,
                face: 6
            })
            .is_none()
        );
        let both = [
            Face {
                element: 0,
                face: 4,
            },
            Face {
                element: 0,
                face: 1,
            },
        ];
        let areas = tributary_areas(&mesh, &both);
        assert_eq!(
            areas.iter().map(|a| a.0).collect::<Vec<_>>(),
            [0, 1, 2, 3, 5, 7]
        );
        assert!((areas[1].1 - 0.5).abs() < 1e-15 && (areas[0].1 - 0.25).abs() < 1e-15);
    }

    /// Simpson's weights on a plane face, and the outward normals of a Q18 box.
    #[test]
    fn faces_of_a_quadratic_box() {
        let nodes = (0..18).map(|a| {
            let (i, j, k) = (a % 3, a / 3 % 3, a / 9);
            Vec3::new(1.5 * i as f64, 0.5 * j as f64, 2.0 * k as f64)
        });
        let mesh = Mesh {
            kind: ElementKind::Q18,
            nodes: nodes.collect(),
            connectivity: (0..18).collect(),
            node_sets: Default::default(),
            face_sets: Default::default(),
        };
        let size = Vec3::new(3.0, 1.0, 2.0);
        for face in 0..6 {
            let quad = mesh.quad(Face { element: 0, face }).unwrap();
            let axis = face as usize / 2;
            let area = size.product() / size[axis];
            let mut outward = Vec3::zeros();
            outward[axis] = if face % 2 == 1 { area } else { -area };
            assert!((quad.area_vector(0.3, -0.2) * 4.0 - outward).norm() < 1e-14);
            let line = |n: u8| {
                if n == 2 {
                    [0.5, 0.5, 0.0]
                } else {
                    [1.0, 4.0, 1.0].map(|w| w / 6.0)
                }
            };
            let [nu, nv] = quad.count.map(usize::from);
            let (along_u, along_v) = (line(quad.count[0]), line(quad.count[1]));
            for (k, w) in quad.weights()[..nu * nv].iter().enumerate() {
                let expected = along_u[k % nu] * along_v[k / nu];
                assert!((w - expected * area).abs() < 1e-14, "face {face}");
            }
            let mut centre = 0.5 * size;
            centre[axis] += 0.5 * size[axis] * outward[axis].signum();
            assert!((quad.point(0.0, 0.0) - centre).norm() < 1e-14);
        }
        let areas = tributary_areas(
            &mesh,
            &[Face {
                element: 0,
                face: 5,
            }],
        );
        assert_eq!(areas.len(), 9);
        assert!((areas[4].1 - 3.0 * 16.0 / 36.0).abs() < 1e-14);
    }
}
