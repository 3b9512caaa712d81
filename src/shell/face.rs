//! Bilinear quadrilaterals: the faces of H8 elements, over which loads and contact integrate.
use super::quadrature::{GAUSS_3, Rule};
use crate::mesh::{ElementKind, Face, H8_FACES, Mesh};
use covact_geometry::Vec3;

/// Signs of the four corners, u fastest: (-,-), (+,-), (-,+), (+,+).
const CORNERS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];

/// Bilinear shape functions at (u, v) in [-1, 1]^2, in the node order of [`H8_FACES`].
pub fn shape(u: f64, v: f64) -> [f64; 4] {
    CORNERS.map(|(a, b)| 0.25 * (1.0 + a * u) * (1.0 + b * v))
}

/// Derivatives of the shape functions along u and v.
pub fn shape_derivatives(u: f64, v: f64) -> [[f64; 4]; 2] {
    [
        CORNERS.map(|(a, b)| 0.25 * a * (1.0 + b * v)),
        CORNERS.map(|(a, b)| 0.25 * b * (1.0 + a * u)),
    ]
}

/// Mesh nodes of a face of an H8 mesh, ordered so that u x v points outward; `None` if the mesh has no such face, or faces of
/// more than four nodes.
pub fn face_nodes(mesh: &Mesh, face: Face) -> Option<[u32; 4]> {
    if mesh.kind != ElementKind::H8 {
        return None;
    }
    let local = H8_FACES.get(face.face as usize)?;
    let n = mesh.kind.nodes();
    let nodes = mesh
        .connectivity
        .get(face.element as usize * n..(face.element as usize + 1) * n)?;
    Some(local.map(|i| nodes[i as usize]))
}

/// A bilinear quadrilateral given by its four corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quad {
    pub corners: [Vec3; 4],
}

impl Quad {
    /// The face with corners at the mesh's own nodes; `None` if the mesh has no such face.
    pub fn of(mesh: &Mesh, face: Face) -> Option<Quad> {
        let nodes = face_nodes(mesh, face)?;
        let mut corners = [Vec3::zeros(); 4];
        for (corner, node) in corners.iter_mut().zip(nodes) {
            *corner = *mesh.nodes.get(node as usize)?;
        }
        Some(Quad { corners })
    }

    /// Point at (u, v).
    pub fn point(&self, u: f64, v: f64) -> Vec3 {
        combine(&self.corners, &shape(u, v))
    }

    /// Tangents along u and v.
    pub fn tangents(&self, u: f64, v: f64) -> [Vec3; 2] {
        shape_derivatives(u, v).map(|d| combine(&self.corners, &d))
    }

    /// Outward normal times the area element: `x_,u x x_,v` (length^2).
    pub fn area_vector(&self, u: f64, v: f64) -> Vec3 {
        let [a, b] = self.tangents(u, v);
        a.cross(&b)
    }

    /// Integral of every shape function over the face, `int N_k dA`; with the 3 x 3 Gauss rule it is exact for plane
    /// faces (there the area element is linear) and an approximation on warped ones.
    pub fn weights(&self) -> [f64; 4] {
        self.weights_with(&GAUSS_3)
    }

    /// As [`Quad::weights`], with the given rule in both directions.
    pub fn weights_with(&self, rule: &Rule) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for (v, wv) in rule.iter() {
            for (u, wu) in rule.iter() {
                let da = wu * wv * self.area_vector(u, v).norm();
                for (s, n) in sum.iter_mut().zip(shape(u, v)) {
                    *s += n * da;
                }
            }
        }
        sum
    }

    /// Area (length^2).
    pub fn area(&self) -> f64 {
        self.weights().iter().sum()
    }
}

fn combine(corners: &[Vec3; 4], weights: &[f64; 4]) -> Vec3 {
    let mut sum = Vec3::zeros();
    for (c, w) in corners.iter().zip(weights) {
        sum += c * *w;
    }
    sum
}

/// Tributary areas `sum over faces of int N dA` of the nodes of a face set, as pairs (node, area) in ascending node
/// order. Faces that the mesh does not have are left out.
pub fn tributary_areas(mesh: &Mesh, faces: &[Face]) -> Vec<(u32, f64)> {
    let mut areas = std::collections::BTreeMap::new();
    for face in faces {
        if let (Some(nodes), Some(quad)) = (face_nodes(mesh, *face), Quad::of(mesh, *face)) {
            for (node, area) in nodes.into_iter().zip(quad.weights()) {
                *areas.entry(node).or_insert(0.0) += area;
            }
        }
    }
    areas.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let quad = Quad::of(&mesh, Face { element: 0, face }).unwrap();
            let mut outward = Vec3::zeros();
            outward[face as usize / 2] = if face % 2 == 1 { 4.0 } else { -4.0 };
            // The area of the parameter square is 4.
            assert!(
                (quad.area_vector(0.3, -0.2) * 16.0 - outward).norm() < 1e-14,
                "face {face}"
            );
            assert!(quad.weights().iter().all(|w| (w - 0.25).abs() < 1e-15));
            let centre = quad.point(0.0, 0.0) - Vec3::repeat(0.5);
            assert!((centre - outward / 8.0).norm() < 1e-15);
        }
        assert!(
            Quad::of(
                &mesh,
                Face {
                    element: 1,
                    face: 0
                }
            )
            .is_none()
        );
        assert!(
            Quad::of(
                &mesh,
                Face {
                    element: 0,
                    face: 6
                }
            )
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

    /// A trapezoid with parallel sides 1 and 2 at distance 1: the shape functions' integrals by hand.
    #[test]
    fn tributary_areas_of_a_trapezoid() {
        let corners =
            [[0.0, 0.0], [2.0, 0.0], [0.5, 1.0], [1.5, 1.0]].map(|p| Vec3::new(p[0], p[1], 0.0));
        let weights = Quad { corners }.weights();
        // Width 2 - y: int (1 - y)(2 - y)/2 dy = 5/12, int y (2 - y)/2 dy = 1/3.
        for (found, expected) in weights
            .iter()
            .zip([5.0 / 12.0, 5.0 / 12.0, 1.0 / 3.0, 1.0 / 3.0])
        {
            assert!((found - expected).abs() < 1e-15, "{weights:?}");
        }
    }
}
