//! Slave points of a contact pair from the faces of a body.
use super::state::PointState;
use crate::contact::points::{ROUNDING, SlavePoint};
use crate::fem::Quad;
use crate::fem::face::shape;
use crate::fem::quadrature::{self, QuadratureError, Rule};
use crate::machine::memory::times;
use crate::mesh::tributary_areas;
use crate::mesh::{Face, Mesh};
use crate::scene::Points;
use crate::shell::STATES;
use std::collections::BTreeMap;

/// Bytes of a slave point beside its own and those of its states: its place in the system, its last touch, what is written.
pub const POINT: u64 = 600;

/// Bytes of so many slave points, with what a run remembers of each.
pub fn bytes(count: u64) -> u64 {
    let states = STATES * size_of::<PointState>();
    times(count, (size_of::<SlavePoint>() + states) as u64 + POINT)
}

/// Samples the faces as the scene asks; node numbers are the mesh's shifted by `offset`.
///
/// Nodes carry their true tributary area `int N dA`; so on a symmetry plane a node stands for the half that is
/// modelled, and its pressure is right.
///
/// Integration segments are made by [`super::segments`], where the master is known; here they are Gauss points.
///
/// # Errors
/// A number of points that no rule has.
pub fn slave_points(
    mesh: &Mesh,
    faces: &[Face],
    points: Points,
    offset: u32,
) -> Result<Vec<SlavePoint>, QuadratureError> {
    let rule = match points {
        Points::Auto | Points::Nodes => return Ok(nodes(mesh, faces, offset)),
        Points::Gauss(n) => quadrature::gauss(n as usize)?,
        Points::Lobatto(n) => quadrature::lobatto(n as usize)?,
        // Not cut by anything: the rule of as high a degree.
        Points::Segments(n) => quadrature::gauss(n as usize / 2 + 1)?,
    };
    Ok(sampled(mesh, faces, &rule, offset))
}

fn nodes(mesh: &Mesh, faces: &[Face], offset: u32) -> Vec<SlavePoint> {
    let mut spacing = BTreeMap::<u32, f64>::new();
    for face in faces {
        let Some(quad) = mesh.quad(*face) else {
            continue;
        };
        let own = quad.spacing();
        for node in mesh.face_nodes(*face).nodes() {
            let narrowest = spacing.entry(*node).or_insert(f64::INFINITY);
            *narrowest = narrowest.min(own);
        }
    }
    let point = |(n, area)| SlavePoint {
        rounding: spacing.get(&n).map_or(0.0, |s| ROUNDING * s),
        ..SlavePoint::at_node(n + offset, area)
    };
    tributary_areas(mesh, faces)
        .into_iter()
        .map(point)
        .collect()
}

fn sampled(mesh: &Mesh, faces: &[Face], rule: &Rule, offset: u32) -> Vec<SlavePoint> {
    let per_face = rule.points().len().pow(2);
    let mut out = Vec::with_capacity(faces.len() * per_face);
    for &f in faces {
        let local = mesh.face_nodes(f);
        let quad = Quad::new(&local, |n| mesh.nodes[n as usize]);
        let face = local.shifted(offset);
        let spacing = quad.spacing();
        for (v, wv) in rule.iter() {
            for (u, wu) in rule.iter() {
                out.push(SlavePoint {
                    nodes: face.nodes,
                    shape: shape(face.count, u, v),
                    count: face.nodes().len() as u8,
                    area: wu * wv * quad.area_vector(u, v).norm(),
                    rounding: ROUNDING * spacing,
                });
            }
        }
    }
    out
}
