//! Slave points of a contact pair from the faces of a body.
use crate::contact::points::SlavePoint;
use crate::mesh::{Face, H8_FACES, Mesh};
use crate::scene::Points;
use crate::shell::face::{self, FacePoint};
use crate::shell::quadrature;
use covact_geometry::Vec3;
use std::collections::BTreeMap;

/// Node numbers of a face, ordered so that face parameters give the outward normal.
pub fn face_nodes(mesh: &Mesh, f: Face) -> [u32; 4] {
    let conn = mesh.element(f.element as usize);
    H8_FACES[f.face as usize].map(|k| conn[k as usize])
}

/// Positions of a face's nodes on the undeformed mesh.
pub fn face_positions(mesh: &Mesh, f: Face) -> [Vec3; 4] {
    face_nodes(mesh, f).map(|n| mesh.nodes[n as usize])
}

/// Samples the faces as the scene asks; node numbers are the mesh's shifted by `offset`.
///
/// Nodes carry their true tributary area `int N dA`; so on a symmetry plane a node stands for the half that is
/// modelled, and its pressure is right.
pub fn slave_points(mesh: &Mesh, faces: &[Face], points: Points, offset: u32) -> Vec<SlavePoint> {
    let (abscissae, weights) = match points {
        Points::Nodes => return nodes(mesh, faces, offset),
        Points::Gauss(n) => quadrature::gauss(n as usize),
        Points::Lobatto(n) => quadrature::lobatto(n as usize),
    };
    let mut out = Vec::with_capacity(faces.len() * abscissae.len() * abscissae.len());
    for &f in faces {
        let numbers = face_nodes(mesh, f).map(|n| n + offset);
        let x = face_positions(mesh, f);
        for (v, wv) in abscissae.iter().zip(&weights) {
            for (u, wu) in abscissae.iter().zip(&weights) {
                let p = FacePoint::bilinear(&x, *u, *v);
                out.push(SlavePoint {
                    nodes: numbers,
                    shape: p.n,
                    count: 4,
                    area: wu * wv * p.area,
                });
            }
        }
    }
    out
}

fn nodes(mesh: &Mesh, faces: &[Face], offset: u32) -> Vec<SlavePoint> {
    let mut area: BTreeMap<u32, f64> = BTreeMap::new();
    for &f in faces {
        let shares = face::tributary_areas(&face_positions(mesh, f));
        for (n, a) in face_nodes(mesh, f).into_iter().zip(shares) {
            *area.entry(n).or_default() += a;
        }
    }
    (area.into_iter())
        .map(|(n, a)| SlavePoint::at_node(n + offset, a))
        .collect()
}
