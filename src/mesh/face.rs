//! Faces as tensor products of nodes.
use super::{ElementKind, Face, H8_FACES, Mesh};

/// Nodes of a face: `count[0]` along u times `count[1]` along v, each 2 or 3, u fastest, `u x v` outward. Faces of H8 are
/// 2 x 2; the bottom and top of Q18 are 3 x 3, its sides 3 x 2 or 2 x 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct FaceNodes {
    /// The nodes; only the first `count[0] * count[1]` are used, the others are 0.
    pub nodes: [u32; 9],
    /// Nodes along u and along v.
    pub count: [u8; 2],
}

impl FaceNodes {
    /// A bilinear face.
    pub fn bilinear(nodes: [u32; 4]) -> FaceNodes {
        let [a, b, c, d] = nodes;
        FaceNodes {
            nodes: [a, b, c, d, 0, 0, 0, 0, 0],
            count: [2, 2],
        }
    }

    /// The nodes, u fastest.
    #[inline]
    pub fn nodes(&self) -> &[u32] {
        let [nu, nv] = self.count;
        &self.nodes[..nu as usize * nv as usize]
    }

    /// The four corners, u fastest.
    #[inline]
    pub fn corners(&self) -> [u32; 4] {
        let [nu, nv] = self.count.map(usize::from);
        [0, nu - 1, nu * (nv - 1), nu * nv - 1].map(|k| self.nodes[k])
    }

    /// The same face with every node number raised by `offset`.
    #[inline]
    pub fn shifted(mut self, offset: u32) -> FaceNodes {
        let n = self.nodes().len();
        self.nodes[..n].iter_mut().for_each(|n| *n += offset);
        self
    }
}

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
    /// [`Mesh::has_face`]).
    #[inline]
    pub fn face_nodes(&self, face: Face) -> FaceNodes {
        let element = self.element(face.element as usize);
        let faces = match self.kind {
            ElementKind::H8 => &H8,
            ElementKind::Q18 => &Q18,
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

    /// Whether the mesh has this face.
    pub fn has_face(&self, face: Face) -> bool {
        (face.element as usize) < self.elements() && (face.face as usize) < H8_FACES.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
