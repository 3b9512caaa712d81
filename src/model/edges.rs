//! Sharp convex edges of a master body as slaves. Between two slave points such an edge sinks into the slave's faces unseen: no
//! slave point lies on it, and those beside it pass by. Where a contact asks for it, the nodes on these edges are slave points
//! once more, with the slave's faces as their master.
use super::master::moving_facets;
use super::{Model, PairModel};
use crate::mesh::{Face, Mesh};
use covact_geometry::{EdgeKind, MovingFacets, MovingFoot, MovingPlace, Vec3};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Angle between the normals of both faces from which on their edge is sharp (radians), as of rigid surfaces
/// ([`super::sharp`]).
const ANGLE: f64 = 0.5;
/// An edge no farther from the border of the slave's faces than this part of their elements, measured along them, is flush with
/// it: both sides end there together, and nothing sinks in.
const FLUSH: f64 = 0.3;

/// Cosine of the angle between a line and the way out of a border from which on the line crosses it.
const CROSSES: f64 = 0.7;

/// A node on such an edge lies on the slave where it is no farther from it than this part of the slave's elements.
const NEAR: f64 = 0.5;

/// An edge of faces: its nodes, and the outer faces that meet there.
struct Edge {
    nodes: Vec<u32>,
    /// Whether one of the faces is among those of the master.
    of_master: bool,
    /// Unit normal and middle of each face.
    faces: Vec<[Vec3; 2]>,
}

impl Edge {
    /// Two outer faces that meet at an angle, with the body inside of it.
    fn sharp(&self) -> bool {
        match self.faces[..] {
            [[n, at], [m, other]] => {
                let turned = n.dot(&m).clamp(-1.0, 1.0).acos();
                turned > ANGLE && (other - at).dot(&n) < 0.0
            }
            _ => false,
        }
    }
}

/// Outward unit normal and middle of a face; `position` gives the place of a node. Nothing for one without area.
fn facing(mesh: &Mesh, face: Face, position: impl Fn(u32) -> Vec3) -> Option<[Vec3; 2]> {
    let corners = mesh.face_corners(face).map(position);
    let [a, b, c, d] = corners;
    let normal = (d - a).cross(&(c - b)).try_normalize(0.0)?;
    Some([normal, corners.iter().sum::<Vec3>() / 4.0])
}

/// The ends of a line of nodes, whichever way it is gone.
fn ends(nodes: &[u32]) -> [u32; 2] {
    let [a, b] = [nodes[0], nodes[nodes.len() - 1]];
    [a.min(b), a.max(b)]
}

/// The edges that belong to one of these faces only, by their end nodes, with the outward unit normal and the middle of that face.
pub fn border(mesh: &Mesh, faces: &[Face]) -> HashMap<[u32; 2], [Vec3; 2]> {
    let mut edges: HashMap<[u32; 2], Option<[Vec3; 2]>> = HashMap::new();
    for &face in faces {
        let here = facing(mesh, face, |n| mesh.nodes[n as usize]);
        for nodes in sides(mesh, face) {
            let edge = edges.entry(ends(&nodes));
            edge.and_modify(|face| *face = None).or_insert(here);
        }
    }
    let once = edges.into_iter();
    once.filter_map(|(edge, face)| Some((edge, face?)))
        .collect()
}

/// The lines of nodes around a face.
fn sides(mesh: &Mesh, face: Face) -> [Vec<u32>; 4] {
    let all = mesh.face_nodes(face);
    let [nu, nv] = all.count.map(usize::from);
    let at = |i: usize, j: usize| all.nodes[i + nu * j];
    [
        (0..nu).map(|i| at(i, 0)).collect(),
        (0..nu).map(|i| at(i, nv - 1)).collect(),
        (0..nv).map(|j| at(0, j)).collect(),
        (0..nv).map(|j| at(nu - 1, j)).collect(),
    ]
}

/// Whether a place on a line is at the free border of the slave's faces, within [`FLUSH`] of their elements either way along them,
/// and the line does not cross the border; `line` is its direction.
pub fn flush_with(place: &Vec3, line: &Vec3, slave: &MovingFacets, size: f64) -> bool {
    let foot = |q: &Vec3| slave.project(q, None, f64::INFINITY, |_| true);
    let Some(at) = foot(place) else {
        return false;
    };
    let rho_i = &at.jet.rho_i;
    let n = rho_i[0].cross(&rho_i[1]);
    let away = place - at.jet.rho;
    let along = away - n * (away.dot(&n) / n.norm_squared());
    if along.norm() > FLUSH * size {
        return false;
    }
    // An element is two long in its parameters.
    let ways = rho_i
        .iter()
        .flat_map(|t| [2.0 * FLUSH, -2.0 * FLUSH].map(|by| t * by));
    let mut places = ways.map(|way| place + way);
    let beside = |foot: &MovingFoot| match foot.place {
        MovingPlace::Face => false,
        MovingPlace::Corner { kind } => kind == EdgeKind::Free,
        MovingPlace::Edge { direction, kind } => {
            let [a, b] = &foot.jet.rho_i;
            let border = a * direction[0] + b * direction[1];
            let out = border.cross(&a.cross(b));
            let crosses = out.dot(line).abs() > CROSSES * out.norm() * line.norm();
            kind == EdgeKind::Free && !crosses
        }
    };
    places.any(|q| foot(&q).is_some_and(|foot| beside(&foot)))
}

/// Whether a foot lies on the free border of its faces.
pub fn at_border(foot: &MovingFoot) -> bool {
    match foot.place {
        MovingPlace::Face => false,
        MovingPlace::Edge { kind, .. } | MovingPlace::Corner { kind } => kind == EdgeKind::Free,
    }
}

/// Nodes of the mesh on the sharp convex edges of some of its faces, without the edges that are flush with the border of the
/// slave's faces. `position` gives the place of a node; `size` is that of the slave's elements (length).
pub fn sharp_nodes(
    mesh: &Mesh,
    faces: &[Face],
    position: impl Fn(u32) -> Vec3,
    slave: &MovingFacets,
    size: f64,
) -> BTreeSet<u32> {
    let beside = |edge: &Vec<u32>| {
        let ends = [edge[0], edge[edge.len() - 1]].map(&position);
        !flush_with(
            &((ends[0] + ends[1]) * 0.5),
            &(ends[1] - ends[0]),
            slave,
            size,
        )
    };
    let edges = sharp_edges(mesh, faces, &position);
    edges.into_iter().filter(beside).flatten().collect()
}

/// The sharp convex edges of some faces of a mesh, each by its nodes in a row; `position` gives the place of a node.
pub fn sharp_edges(mesh: &Mesh, faces: &[Face], position: impl Fn(u32) -> Vec3) -> Vec<Vec<u32>> {
    let own: BTreeSet<Face> = faces.iter().copied().collect();
    let mut edges: BTreeMap<[u32; 2], Edge> = BTreeMap::new();
    for face in mesh.outer_faces() {
        let Some(facing) = facing(mesh, face, &position) else {
            continue;
        };
        for nodes in sides(mesh, face) {
            let edge = edges.entry(ends(&nodes)).or_insert(Edge {
                nodes,
                of_master: false,
                faces: Vec::new(),
            });
            edge.of_master |= own.contains(&face);
            edge.faces.push(facing);
        }
    }
    (edges.into_values())
        .filter(|edge| edge.of_master && edge.sharp())
        .map(|edge| edge.nodes)
        .collect()
}

/// Whether a sharp edge of the master of a pair lies on the faces of its slave as they are now; `u` holds the displacements
/// (length). Never so where the edges are slaves already, and for masters that are rigid or the slave's own body.
pub fn on_slave(model: &Model, pair: &PairModel, u: &[f64]) -> bool {
    let Some(master) = pair.body_master() else {
        return false;
    };
    let index = |p: &PairModel| std::ptr::eq(p, pair);
    let has = model.pairs.iter().position(index);
    let asked = model
        .pairs
        .iter()
        .any(|p| p.edges_of.is_some() && p.edges_of == has);
    if asked || pair.half.is_some() || pair.edges_of.is_some() || master.body == pair.body {
        return false;
    }
    let [body, slave] = [&model.bodies[master.body], &model.bodies[pair.body]];
    let start = |n: u32| model.nodes[n as usize];
    let now = |n: u32| model.position(n as usize, u);
    let facets = moving_facets(&slave.mesh, slave.first_node, &pair.faces, false, start);
    let Ok(mut facets) = facets else {
        return false;
    };
    let first = body.first_node;
    let position = |n: u32| start(n + first);
    let size = pair.element_size;
    let nodes = sharp_nodes(&body.mesh, &master.faces, position, &facets, size);
    facets.update(now);
    let near = |n: &u32| (facets.project(&now(n + first), None, NEAR * size, |_| true)).is_some();
    nodes.iter().any(near)
}
