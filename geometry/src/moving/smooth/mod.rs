//! One smooth surface over a finite-element mesh: a bicubic Bezier piece on every quadrilateral.
//!
//! Every tangent at a node is a fixed combination of nodes around it, computed once on the reference positions, and so is
//! every twist. The surface is therefore **linear in the nodes**: its shape functions are constant, a consistent tangent of
//! contact needs no derivative of the construction, and a rigid motion of the nodes is one of the surface. That is why it is
//! none of the patches that take their normals from the nodes' current ones (T. Nagata, "Simple local interpolation of
//! surfaces using normal vectors", CAGD 22, 2005): those depend on the nodes in a nonlinear way.
//!
//! - Lines of nodes run on through nodes where four facets meet. Along them tangents are those of the parabola through
//!   three nodes (Catmull-Rom where they are equally spaced); the spacing is the mean length of the edges that a strip of
//!   facets has across it, the same all along the strip. So on a structured mesh the surface is a piecewise bicubic Hermite
//!   tensor product and has continuous tangent planes everywhere.
//! - At other nodes a quadratic is fitted to the nodes around, and all edges leave in its tangent plane.
//! - At borders, and on either side of sharp edges, which stay sharp, lines end with the parabola of their last three nodes.
//! - Twists come from the tensor product where lines cross, else from the bilinearly blended Coons patch of the four
//!   edges (Adini's twist). Only there, around nodes where not four facets meet, tangent planes differ a little across
//!   edges away from the nodes.

mod fit;
mod lines;
mod sectors;
mod tangents;
mod twist;

use std::collections::HashMap;

use super::build::{Parts, check};
use super::extraction::Operator;
use super::topology::{EDGES_AT, ENDS, Outline, Topology};
use super::{MovingError, MovingFacets};
use crate::surface::Vec3;
use tangents::Tangents;

/// Edges whose facets turn by more than this on the reference positions stay sharp (radians): 50 degrees, so that eight
/// facets around a circle are round.
pub const CREASE: f64 = std::f64::consts::PI / 3.6;

impl MovingFacets {
    /// One smooth surface over the mesh, through its nodes: bicubic, tangent planes at the nodes from fixed weights of the
    /// neighbours computed on the reference positions. Edges whose facets turn by more than 50 degrees stay sharp.
    ///
    /// Where a direction of a facet has three nodes it is cut at the middle one: a 3 x 3 facet becomes four, numbered one
    /// after the other with xi1 fastest; [`source`](Self::source) tells which facet they come from.
    ///
    /// # Errors
    /// As for [`new`](Self::new); positions that are not finite; a facet that depends on more than [`MAX`](super::MAX) nodes,
    /// as where very many elements meet at one node.
    pub fn smooth(
        facets: &[(&[u32], [u8; 2])],
        position: impl Fn(u32) -> Vec3,
    ) -> Result<Self, MovingError> {
        Self::smooth_with(facets, position, CREASE)
    }

    /// [`smooth`](Self::smooth) with another angle (radians) above which edges stay sharp.
    ///
    /// # Errors
    /// As for [`smooth`](Self::smooth).
    pub fn smooth_with(
        facets: &[(&[u32], [u8; 2])],
        position: impl Fn(u32) -> Vec3,
        crease: f64,
    ) -> Result<Self, MovingError> {
        check(facets)?;
        let (quads, source) = cut(facets);
        let outlines: Vec<Outline> = (quads.iter())
            .map(|&corners| Outline {
                corners,
                middles: [None; 4],
            })
            .collect();
        let topology = Topology::new(&outlines).map_err(|error| match error {
            MovingError::Flipped(a, b) => MovingError::Flipped(source[a], source[b]),
            other => other,
        })?;
        let mut numbers = vec![0; topology.node_count()];
        for (facet, quad) in quads.iter().enumerate() {
            for (corner, &number) in quad.iter().enumerate() {
                numbers[topology.node(facet as u32, corner) as usize] = number;
            }
        }
        let mut points = Vec::with_capacity(numbers.len());
        for &number in &numbers {
            let x = position(number);
            if !x.iter().all(|x| x.is_finite()) {
                return Err(MovingError::Position(number));
            }
            points.push(x);
        }
        let mesh = Mesh::new(topology, points, crease);
        let tangents = Tangents::new(&mesh);
        let mut set = Parts::default();
        for (facet, &source) in source.iter().enumerate() {
            let (nodes, operator) = extraction(&mesh, &tangents, facet as u32);
            let nodes: Vec<u32> = nodes.iter().map(|&n| numbers[n as usize]).collect();
            set.push(source, &nodes, operator)?;
        }
        Ok(set.finish(3, mesh.topology))
    }
}

/// Facets of four nodes each, and the facet given that they come from.
fn cut(facets: &[(&[u32], [u8; 2])]) -> (Vec<[u32; 4]>, Vec<usize>) {
    let (mut quads, mut source) = (Vec::new(), Vec::new());
    for (number, &(nodes, count)) in facets.iter().enumerate() {
        let [n, m] = count.map(usize::from);
        for j in 0..m - 1 {
            for i in 0..n - 1 {
                let k = i + n * j;
                quads.push([nodes[k], nodes[k + 1], nodes[k + n], nodes[k + n + 1]]);
                source.push(number);
            }
        }
    }
    (quads, source)
}

/// A vector as a fixed combination of nodes.
#[derive(Debug, Clone, Default, PartialEq)]
struct Combination(Vec<(u32, f64)>);

impl Combination {
    fn of(terms: &[(u32, f64)]) -> Self {
        let mut out = Self::default();
        for &(node, factor) in terms {
            out.add_node(node, factor);
        }
        out
    }

    fn add_node(&mut self, node: u32, factor: f64) {
        match self.0.iter_mut().find(|t| t.0 == node) {
            Some(term) => term.1 += factor,
            None => self.0.push((node, factor)),
        }
    }

    fn add(&mut self, other: &Self, factor: f64) {
        for &(node, f) in &other.0 {
            self.add_node(node, f * factor);
        }
    }

    fn scaled(&self, factor: f64) -> Self {
        Self(self.0.iter().map(|&(n, f)| (n, f * factor)).collect())
    }

    /// What it is on the reference positions.
    fn on(&self, points: &[Vec3]) -> Vec3 {
        (self.0.iter()).fold(Vec3::zeros(), |s, &(n, f)| s + points[n as usize] * f)
    }
}

/// The mesh on its reference positions.
struct Mesh {
    topology: Topology,
    points: Vec<Vec3>,
    /// Of each edge: whether the surface ends or has a sharp bend there.
    hard: Vec<bool>,
    /// Of each edge: logarithm of the knot interval along it, a multiple of [`GRAIN`].
    interval: Vec<i64>,
}

/// Logarithms of intervals are rounded to this, so that equal ones give the same factors to the last digit.
const GRAIN: f64 = 1e-9;

impl Mesh {
    fn new(topology: Topology, points: Vec<Vec3>, crease: f64) -> Self {
        let mut mesh = Mesh {
            hard: vec![true; topology.edge_count()],
            interval: vec![0; topology.edge_count()],
            topology,
            points,
        };
        for edge in 0..mesh.hard.len() as u32 {
            if let [a, b] = *mesh.topology.edge_members(edge) {
                let [n, m] = [a, b].map(|(facet, edge)| mesh.normal_at(facet, edge as usize));
                mesh.hard[edge as usize] =
                    a.0 == b.0 || n.cross(&m).norm().atan2(n.dot(&m)) > crease;
            }
        }
        mesh.interval = lines::intervals(&mesh);
        mesh
    }

    fn node(&self, facet: u32, corner: usize) -> u32 {
        self.topology.node(facet, corner)
    }

    fn point(&self, node: u32) -> &Vec3 {
        &self.points[node as usize]
    }

    /// Nodes at the ends of an edge of a facet.
    fn ends(&self, facet: u32, edge: usize) -> [u32; 2] {
        ENDS[edge].map(|corner| self.node(facet, corner))
    }

    /// Normal of the bilinear facet in the middle of an edge, not normalised.
    fn normal_at(&self, facet: u32, edge: usize) -> Vec3 {
        let x: [Vec3; 4] = std::array::from_fn(|c| *self.point(self.node(facet, c)));
        let (one, two) = match edge {
            0 => (x[1] - x[0] + x[3] - x[2], x[2] - x[0]),
            1 => (x[1] - x[0] + x[3] - x[2], x[3] - x[1]),
            2 => (x[1] - x[0], x[2] - x[0] + x[3] - x[1]),
            _ => (x[3] - x[2], x[2] - x[0] + x[3] - x[1]),
        };
        one.cross(&two)
    }

    /// Ratio of the knot intervals of two edges.
    fn ratio(&self, a: u32, b: u32) -> f64 {
        let difference = self.interval[a as usize] - self.interval[b as usize];
        (difference as f64 * GRAIN).exp()
    }
}

/// Nodes that a facet depends on, its corners first, and its control points as combinations of them.
fn extraction(mesh: &Mesh, tangents: &Tangents, facet: u32) -> (Vec<u32>, Operator) {
    let third = 1.0 / 3.0;
    let mut rows: [Combination; 16] = Default::default();
    for (corner, [edge2, edge1]) in EDGES_AT.into_iter().enumerate() {
        let node = mesh.node(facet, corner);
        let own = Combination::of(&[(node, 1.0)]);
        let [along1, along2] = [edge1, edge2].map(|edge| tangents.of(mesh, facet, edge, corner));
        let twist = twist::twist(mesh, tangents, facet, corner);
        // Places of the four control points of the corner.
        let at = |i: usize, j: usize| {
            let i = if corner & 1 == 0 { i } else { 3 - i };
            let j = if corner >> 1 == 0 { j } else { 3 - j };
            i + 4 * j
        };
        let (mut p1, mut p2, mut p12) = (own.clone(), own.clone(), own.clone());
        p1.add(along1, third);
        p2.add(along2, third);
        p12.add(along1, third);
        p12.add(along2, third);
        p12.add(&twist, third * third);
        rows[at(0, 0)] = own;
        rows[at(1, 0)] = p1;
        rows[at(0, 1)] = p2;
        rows[at(1, 1)] = p12;
    }
    let mut nodes: Vec<u32> = Vec::with_capacity(16);
    let mut places: HashMap<u32, u16> = HashMap::new();
    let mut place = |node: u32| {
        *places.entry(node).or_insert_with(|| {
            nodes.push(node);
            (nodes.len() - 1) as u16
        })
    };
    (0..4).for_each(|corner| {
        place(mesh.node(facet, corner));
    });
    let rows: Vec<Vec<(u16, f64)>> = (rows.iter())
        .map(|row| {
            // What cancels leaves rounding.
            let terms = row.0.iter().filter(|t| t.1.abs() > 1e-14);
            terms.map(|&(node, factor)| (place(node), factor)).collect()
        })
        .collect();
    (nodes, Operator::new(rows))
}
