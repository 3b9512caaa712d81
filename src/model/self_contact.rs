//! Self contact: which facets of a body do not exist for its own slave points.
//!
//! A point lies on, or close to, facets of its own neighbourhood whatever happens, and behind the facets of the other
//! side of its own wall. Neither is contact. Two rules tell what is:
//!
//! - On the undeformed mesh, along the edges of the elements (those through the thickness included), the facet is
//!   farther from the faces of the point than a given distance. This leaves out the faces around the point and the
//!   opposite side of its wall.
//! - Now, the outward normals of the point's faces and of the facet oppose each other. This leaves out the back of a wall
//!   whose front the point meets.
use crate::contact::kind::MasterKind;
use crate::contact::lever::Lever;
use crate::contact::points::SlavePoint;
use crate::mesh::{Face, Mesh};
use crate::shell::SeamSpan;
use covact_geometry::{MovingFacets, Vec3};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// Which facets a batch of slave points may touch: a type, so that pairs of different bodies pay nothing for it.
pub trait Accept: Sync {
    /// What the facets are.
    const KIND: MasterKind;
    /// What is looked up once for a point.
    type Point: Copy;

    /// For slave point `i`.
    fn point(&self, i: usize) -> Self::Point;

    /// Whether the facet exists for the point.
    fn facet(&self, point: Self::Point, facet: u32) -> bool;
}

/// All facets.
#[derive(Debug, Clone, Copy)]
pub struct All;

impl Accept for All {
    const KIND: MasterKind = MasterKind::Faces;
    type Point = ();

    #[inline]
    fn point(&self, _: usize) {}

    #[inline]
    fn facet(&self, (): (), _: u32) -> bool {
        true
    }
}

/// Of a pair whose slave and master are faces of the same body: what never changes.
#[derive(Debug)]
pub struct OwnFacets {
    /// Distance along the undeformed mesh up to which facets are left out (length).
    pub distance: f64,
    /// Cell of each point: points with the same nodes share one.
    cell_of: Vec<u32>,
    /// Start of each cell's facets in `facets`, and one past the last.
    starts: Vec<u32>,
    /// Facets left out, ascending for each cell.
    facets: Vec<u32>,
    /// Start of each cell's faces in `corners`, and one past the last.
    corner_starts: Vec<u32>,
    /// Corners of the slave faces around each cell, by node of the model.
    corners: Vec<[u32; 4]>,
}

/// [`OwnFacets`] at a state.
#[derive(Debug, Clone, Copy)]
pub struct Opposing<'a, P> {
    pub own: &'a OwnFacets,
    /// Normals of the facets at their middles.
    pub normals: &'a [Vec3],
    /// Deformed positions of the nodes of the model.
    pub position: P,
}

impl<P: Fn(u32) -> Vec3 + Sync> Accept for Opposing<'_, P> {
    const KIND: MasterKind = MasterKind::OwnFaces;
    /// The point and the normal of its faces.
    type Point = (usize, Vec3);

    #[inline]
    fn point(&self, i: usize) -> (usize, Vec3) {
        let own = self.own;
        let cell = own.cell_of[i] as usize;
        let range = own.corner_starts[cell] as usize..own.corner_starts[cell + 1] as usize;
        let normal = own.corners[range].iter().fold(Vec3::zeros(), |sum, c| {
            let [a, b, c, d] = c.map(&self.position);
            sum + (d - a).cross(&(c - b))
        });
        (i, normal)
    }

    #[inline]
    fn facet(&self, (i, normal): (usize, Vec3), facet: u32) -> bool {
        normal.dot(&self.normals[facet as usize]) < 0.0 && !self.own.leaves_out(i, facet)
    }
}

impl OwnFacets {
    /// For the slave points of `slave` faces and the facets over `master` faces of one mesh, whose nodes are numbered from
    /// `first` in the model. Facets within `distance` of a point's faces along the undeformed mesh are left out.
    pub fn new(
        mesh: &Mesh,
        first: u32,
        points: &[SlavePoint],
        slave: &[Face],
        master: &[Face],
        facets: &MovingFacets,
        distance: f64,
    ) -> Self {
        let graph = Graph::new(mesh, &[]);
        let corners = |f: &Face| mesh.face_corners(*f);
        // Which slave faces a set of nodes belongs to, and which facets a node.
        let mut faces_at: HashMap<u32, Vec<u32>> = HashMap::new();
        for (k, face) in slave.iter().enumerate() {
            for &n in mesh.face_nodes(*face).nodes() {
                faces_at.entry(n).or_default().push(k as u32);
            }
        }
        let mut facets_at: HashMap<u32, Vec<u32>> = HashMap::new();
        for facet in 0..facets.len() as u32 {
            for n in corners(&master[facets.source(facet) as usize]) {
                facets_at.entry(n).or_default().push(facet);
            }
        }
        let mut out = OwnFacets::empty(distance, points.len());
        let mut search = Search::new(mesh.nodes.len());
        let mut last: &[u32] = &[];
        let (mut around, mut near) = (Vec::new(), Vec::new());
        for p in points {
            let nodes = &p.nodes[..p.count as usize];
            if nodes != last {
                last = nodes;
                around.clear();
                for &k in faces_at.get(&(nodes[0] - first)).into_iter().flatten() {
                    let face = mesh.face_nodes(slave[k as usize]);
                    if nodes.iter().all(|n| face.nodes().contains(&(n - first))) {
                        around.push(corners(&slave[k as usize]));
                    }
                }
                near.clear();
                search.run(&graph, around.as_flattened(), distance, |node| {
                    near.extend(facets_at.get(&node).into_iter().flatten());
                });
                out.push(&mut near, around.iter().map(|c| c.map(|n| n + first)));
            }
            out.cell_of.push(out.starts.len() as u32 - 2);
        }
        out
    }

    /// The same for a face of a sheet, whose points have levers. Distances go along its control net and over its seams, between the four
    /// control points in the middle of the nets of both elements.
    pub fn of_sheet(
        (mesh, seams): (&Mesh, &[SeamSpan]),
        first: u32,
        points: &[SlavePoint],
        levers: &[Lever],
        facets: &MovingFacets,
        distance: f64,
    ) -> Self {
        let graph = Graph::new(mesh, seams);
        let mut facets_at: HashMap<u32, Vec<u32>> = HashMap::new();
        for facet in 0..facets.len() as u32 {
            let nodes = facets.nodes(facet);
            for n in MIDDLE.into_iter().filter_map(|a| nodes.get(a)) {
                facets_at.entry(n - first).or_default().push(facet);
            }
        }
        let mut out = OwnFacets::empty(distance, points.len());
        let mut search = Search::new(mesh.nodes.len());
        let mut last = None;
        let mut near = Vec::new();
        for lever in (points.iter()).filter_map(|p| levers.get(p.lever_number()?)) {
            if last != Some(lever.nodes) {
                last = Some(lever.nodes);
                let [a, b, c, d] = MIDDLE.map(|a| lever.nodes[a]);
                near.clear();
                let from = [a, b, c, d].map(|n| n - first);
                search.run(&graph, &from, distance, |node| {
                    near.extend(facets_at.get(&node).into_iter().flatten());
                });
                let top = lever.height > 0.0;
                out.push(&mut near, [if top { [a, b, c, d] } else { [b, a, d, c] }]);
            }
            out.cell_of.push(out.starts.len() as u32 - 2);
        }
        out
    }

    /// Of no cell yet.
    fn empty(distance: f64, points: usize) -> Self {
        OwnFacets {
            distance,
            cell_of: Vec::with_capacity(points),
            starts: vec![0],
            facets: Vec::new(),
            corner_starts: vec![0],
            corners: Vec::new(),
        }
    }

    /// One more cell: the facets that are left out for it, in any order, and the corners of the faces around it.
    fn push(&mut self, near: &mut Vec<u32>, corners: impl IntoIterator<Item = [u32; 4]>) {
        near.sort_unstable();
        near.dedup();
        self.facets.extend_from_slice(near);
        self.starts.push(self.facets.len() as u32);
        self.corners.extend(corners);
        self.corner_starts.push(self.corners.len() as u32);
    }

    /// Whether a facet is left out for a point whatever the state.
    #[inline]
    pub fn leaves_out(&self, point: usize, facet: u32) -> bool {
        let cell = self.cell_of[point] as usize;
        let range = self.starts[cell] as usize..self.starts[cell + 1] as usize;
        self.facets[range].binary_search(&facet).is_ok()
    }
}

/// Control points in the middle of the net of a bicubic element, xi1 fastest.
const MIDDLE: [usize; 4] = [5, 6, 9, 10];

/// Nodes that share an element or a seam, with their undeformed distance.
struct Graph {
    starts: Vec<u32>,
    next: Vec<(u32, f64)>,
}

impl Graph {
    fn new(mesh: &Mesh, seams: &[SeamSpan]) -> Self {
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        let elements = (0..mesh.elements()).map(|e| mesh.element(e));
        for nodes in elements.chain(seams.iter().map(|s| &s.nodes[..])) {
            for &a in nodes {
                pairs.extend(nodes.iter().filter(|b| **b != a).map(|&b| (a, b)));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut starts = vec![0u32; mesh.nodes.len() + 1];
        for (a, _) in &pairs {
            starts[*a as usize + 1] += 1;
        }
        for i in 0..mesh.nodes.len() {
            starts[i + 1] += starts[i];
        }
        let length = |a: u32, b: u32| (mesh.nodes[a as usize] - mesh.nodes[b as usize]).norm();
        Graph {
            starts,
            next: pairs.iter().map(|&(a, b)| (b, length(a, b))).collect(),
        }
    }
}

/// Shortest ways from some nodes (E. W. Dijkstra, 1959), up to a length.
struct Search {
    distance: Vec<f64>,
    reached: Vec<u32>,
    /// Bits of distances that are not negative, whose order is theirs.
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Search {
    fn new(nodes: usize) -> Self {
        Search {
            distance: vec![f64::INFINITY; nodes],
            reached: Vec::new(),
            queue: BinaryHeap::new(),
        }
    }

    fn run(&mut self, graph: &Graph, from: &[u32], limit: f64, mut found: impl FnMut(u32)) {
        for &n in from {
            self.reach(n, 0.0);
        }
        while let Some(Reverse((bits, node))) = self.queue.pop() {
            let at = f64::from_bits(bits);
            if at > self.distance[node as usize] {
                continue;
            }
            let range =
                graph.starts[node as usize] as usize..graph.starts[node as usize + 1] as usize;
            for &(next, length) in &graph.next[range] {
                if at + length <= limit {
                    self.reach(next, at + length);
                }
            }
        }
        for node in self.reached.drain(..) {
            self.distance[node as usize] = f64::INFINITY;
            found(node);
        }
    }

    fn reach(&mut self, node: u32, distance: f64) {
        let known = &mut self.distance[node as usize];
        if distance < *known {
            if known.is_infinite() {
                self.reached.push(node);
            }
            *known = distance;
            self.queue.push(Reverse((distance.to_bits(), node)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::ElementKind;
    use crate::model::slave::slave_points;
    use crate::scene::{Plate, Points};

    /// A flat plate, all outer faces: what is left out of a point in the middle is what lies within the distance, on
    /// both sides, and after the plate is folded the far end is found, by its inner side alone.
    #[test]
    fn neighbours_and_the_own_back_are_left_out() {
        let plate = Plate {
            size: [10.0, 1.0],
            thickness: 0.2,
            elements: [10, 1],
            layers: 1,
            origin: [0.0; 3],
            spacing: Default::default(),
        };
        let mesh = crate::mesh::plate(&plate, ElementKind::H8).unwrap();
        let faces = mesh.outer_faces();
        let nodes: Vec<_> = faces.iter().map(|&f| mesh.face_nodes(f)).collect();
        let given: Vec<_> = nodes.iter().map(|n| (n.nodes(), n.count)).collect();
        let mut facets = MovingFacets::new(&given).unwrap();
        let top = mesh.face_set("top").unwrap();
        let points = slave_points(&mesh, top, Points::Gauss(2), 0).unwrap();
        let own = OwnFacets::new(&mesh, 0, &points, top, &faces, &facets, 2.5);
        for (i, p) in points.iter().enumerate() {
            let x = p.terms().fold(0.0, |x, (n, w)| x + mesh.nodes[n].x * w);
            let (low, high) = (x.floor() - 2.0, x.floor() + 3.0);
            for facet in 0..facets.len() as u32 {
                let corners = mesh.face_corners(faces[facet as usize]);
                let near = |n: u32| (low - 1e-9..high + 1e-9).contains(&mesh.nodes[n as usize].x);
                let expected = corners.into_iter().any(near);
                assert_eq!(own.leaves_out(i, facet), expected, "{x} {corners:?}");
            }
        }
        // Folded about x = 5: the right half lies upside down above the left one.
        let position = |n: u32| {
            let x = mesh.nodes[n as usize];
            if x.x > 5.0 {
                Vec3::new(10.0 - x.x, x.y, 0.3 - x.z)
            } else {
                x
            }
        };
        facets.update(position);
        let normals: Vec<Vec3> = (0..facets.len() as u32)
            .map(|f| {
                let jet = facets.jet(f, [0.0; 2]);
                jet.rho_i[0].cross(&jet.rho_i[1])
            })
            .collect();
        let opposing = Opposing {
            own: &own,
            normals: &normals,
            position,
        };
        let q = &points[0];
        let x = q
            .terms()
            .fold(Vec3::zeros(), |x, (n, w)| x + position(n as u32) * w);
        let at = opposing.point(0);
        let foot = facets
            .project(&x, None, 1.0, |f| opposing.facet(at, f))
            .expect("the folded half");
        assert!(top.contains(&faces[foot.facet as usize]));
        assert!((foot.signed_distance - 0.1).abs() < 1e-12, "{foot:?}");
        let back = (0..facets.len() as u32).find(|&f| {
            faces[f as usize].face == 4
                && faces[f as usize].element == faces[foot.facet as usize].element
        });
        assert!(!opposing.facet(at, back.expect("the back of that element")));
    }
}
