//! CAD surfaces as thin shells: one NURBS patch is the mid-surface, its knot spans are the elements, its control points the
//! nodes.
mod error;
mod refine;
mod select;

use super::{ElementKind, Face, Mesh};
use covact_geometry::{NurbsPatch, PatchShape, Vec3};
pub use error::NurbsError;
pub use refine::Fineness;
use std::collections::BTreeMap;

/// Degree of the elements along both directions.
pub const DEGREE: usize = 3;

/// An edge of a patch: 0 is xi1 = start, 1 is xi1 = end, 2 is xi2 = start, 3 is xi2 = end. Scenes count from one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Edge(u8);

impl Edge {
    /// All four.
    pub const ALL: [Edge; 4] = [Edge(0), Edge(1), Edge(2), Edge(3)];

    /// The direction that is constant along it.
    pub const fn direction(self) -> usize {
        self.0 as usize / 2
    }

    /// Whether that is at its end, not at its start.
    pub const fn at_end(self) -> bool {
        self.0 % 2 == 1
    }

    /// The name of its set.
    pub fn name(self) -> String {
        format!("edge.{}", self.0 + 1)
    }
}

/// A patch that stands for a shell of constant thickness, bicubic and as fine as the elements are to be.
#[derive(Debug, Clone, PartialEq)]
pub struct NurbsSheet {
    /// The mid-surface, without a trim. `rho_1 x rho_2` points to the top.
    pub patch: NurbsPatch,
    /// Half of it lies on either side.
    pub thickness: f64,
    /// Membrane strains are assumed.
    pub assumed_membrane: bool,
    /// Edges that each set of nodes is made of, where it is made of edges.
    pub edge_sets: BTreeMap<String, Vec<Edge>>,
}

/// Sign of a face of a sheet: its outward normal along the normal of the mid-surface. None for other numbers than 4, the bottom,
/// and 5, the top.
pub fn side(face: Face) -> Option<f64> {
    match face.face {
        4 => Some(-1.0),
        5 => Some(1.0),
        _ => None,
    }
}

/// A point of a sheet's mid-surface with the shape functions of the control points that act on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheetPoint {
    /// Control points, numbered in the patch.
    pub nodes: [u32; 16],
    pub n: [f64; 16],
    /// Derivatives along xi1 and xi2.
    pub n_i: [[f64; 16]; 2],
    /// Undeformed area that it stands for.
    pub area: f64,
    /// Weight of the rule, in parameters.
    pub weight: f64,
    /// Unit normal of the undeformed mid-surface.
    pub normal: Vec3,
    /// Position on the undeformed mid-surface.
    pub position: Vec3,
}

impl NurbsSheet {
    /// Knot spans along both directions.
    pub fn spans(&self) -> [usize; 2] {
        [0, 1].map(|dir| self.patch.spans(dir).len())
    }

    /// Ranges of parameters of element `e`.
    pub fn range(&self, e: usize) -> [[f64; 2]; 2] {
        let [nu, _] = self.spans();
        let at = [e % nu, e / nu];
        [0, 1].map(|dir| self.patch.spans(dir)[at[dir]])
    }

    /// Control points along an edge, `row` rows away from it.
    pub fn row(&self, edge: Edge, row: usize) -> Vec<u32> {
        let counts = self.patch.counts();
        let across = edge.direction();
        let at = match edge.at_end() {
            false => row,
            true => counts[across] - 1 - row,
        };
        (0..counts[1 - across])
            .map(|k| match across {
                0 => (at + counts[0] * k) as u32,
                _ => (k + counts[0] * at) as u32,
            })
            .collect()
    }

    /// Gauss points along an edge, element after element, with the undeformed length that each stands for.
    pub fn edge_points(&self, edge: Edge) -> Vec<Vec<(SheetPoint, f64)>> {
        let across = edge.direction();
        let spans = [0, 1].map(|dir| self.patch.spans(dir));
        let last = spans[across].len() - 1;
        let (end, at) = match edge.at_end() {
            false => (0, spans[across][0][0]),
            true => (last, spans[across][last][1]),
        };
        let rule = crate::fem::gauss(DEGREE + 1).expect("a rule of four points exists");
        let positions = self.patch.points();
        let mut room = PatchShape::default();
        let mut of = |k: usize, [a, b]: [f64; 2]| {
            let mut span = [end; 2];
            span[1 - across] = k;
            let points = rule.iter().map(|(s, w)| {
                let mut xi = [at; 2];
                xi[1 - across] = 0.5 * (a + b) + 0.5 * s * (b - a);
                let p = self.point(span, xi, 0.5 * w * (b - a), &positions, &mut room);
                let tangent: Vec3 = (p.nodes.iter().zip(p.n_i[1 - across]))
                    .map(|(n, d)| positions[*n as usize] * d)
                    .sum();
                (p, p.weight * tangent.norm())
            });
            points.collect()
        };
        let along = spans[1 - across].iter().enumerate();
        along.map(|(k, range)| of(k, *range)).collect()
    }

    /// Integral of every control point's shape function along an edge (length).
    pub fn edge_lengths(&self, edge: Edge) -> Vec<(u32, f64)> {
        let mut lengths: BTreeMap<u32, f64> = BTreeMap::new();
        for (p, length) in self.edge_points(edge).iter().flatten() {
            for (node, n) in p.nodes.iter().zip(p.n).filter(|(_, n)| *n != 0.0) {
                *lengths.entry(*node).or_default() += n * length;
            }
        }
        lengths.into_iter().collect()
    }

    /// The control points at the corners: xi1 fastest, as four numbers.
    pub fn corners(&self) -> [u32; 4] {
        let [nu, nv] = self.patch.counts();
        [0, nu - 1, nu * (nv - 1), nu * nv - 1].map(|k| k as u32)
    }

    /// `n x n` Gauss points of some elements, element after element, xi1 fastest.
    ///
    /// # Errors
    /// A number of points that no rule has.
    pub fn points(
        &self,
        elements: impl Iterator<Item = usize>,
        n: usize,
    ) -> Result<Vec<SheetPoint>, crate::fem::quadrature::QuadratureError> {
        let rule = crate::fem::gauss(n)?;
        Ok(self.sampled(elements, &rule))
    }

    /// As [`Self::points`] with any rule.
    pub fn sampled(
        &self,
        elements: impl Iterator<Item = usize>,
        rule: &crate::fem::Rule,
    ) -> Vec<SheetPoint> {
        let mut room = PatchShape::default();
        let spans = [0, 1].map(|dir| self.patch.spans(dir));
        let nu = spans[0].len();
        let positions = self.patch.points();
        let mut out = Vec::new();
        for e in elements {
            let span = [e % nu, e / nu];
            let [u, v] = [spans[0][span[0]], spans[1][span[1]]];
            for (t, wt) in rule.iter() {
                for (s, ws) in rule.iter() {
                    let xi = [
                        0.5 * (u[0] + u[1]) + 0.5 * s * (u[1] - u[0]),
                        0.5 * (v[0] + v[1]) + 0.5 * t * (v[1] - v[0]),
                    ];
                    let weight = 0.25 * ws * wt * (u[1] - u[0]) * (v[1] - v[0]);
                    out.push(self.point(span, xi, weight, &positions, &mut room));
                }
            }
        }
        out
    }

    /// A point of a span that stands for `weight` of its parameters; `positions` are the control points.
    fn point(
        &self,
        span: [usize; 2],
        xi: [f64; 2],
        weight: f64,
        positions: &[Vec3],
        room: &mut PatchShape,
    ) -> SheetPoint {
        self.patch.shape_in_span(span, xi, room);
        let mut out = SheetPoint {
            nodes: [0; 16],
            n: [0.0; 16],
            n_i: [[0.0; 16]; 2],
            area: 0.0,
            weight,
            normal: Vec3::zeros(),
            position: Vec3::zeros(),
        };
        let mut tangents = [Vec3::zeros(); 2];
        for a in 0..16 {
            out.nodes[a] = room.indices[a];
            out.n[a] = room.n[a];
            let x = positions[room.indices[a] as usize];
            out.position += x * room.n[a];
            for (k, tangent) in tangents.iter_mut().enumerate() {
                out.n_i[k][a] = room.n_i[a][k];
                *tangent += x * room.n_i[a][k];
            }
        }
        let normal = tangents[0].cross(&tangents[1]);
        out.area = weight * normal.norm();
        out.normal = normal.normalize();
        out
    }

    /// Integral of every control point's shape function over the mid-surface.
    pub fn tributary_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.patch.homogeneous().len()];
        let elements = self.spans().iter().product();
        let rule = crate::fem::gauss(DEGREE + 1).expect("a rule of four points exists");
        for p in self.sampled(0..elements, &rule) {
            for (node, n) in p.nodes.iter().zip(p.n) {
                areas[*node as usize] += n * p.area;
            }
        }
        areas
    }

    /// Control points and knot spans as a mesh, with the sets `top`, `bottom`, `edge.1` to `edge.4` and `corner.1` to
    /// `corner.4`.
    pub fn mesh(&mut self) -> Mesh {
        let spans = self.spans();
        let mut room = PatchShape::default();
        let mut connectivity = Vec::with_capacity(16 * spans[0] * spans[1]);
        for j in 0..spans[1] {
            for i in 0..spans[0] {
                let [u, v] = [self.patch.spans(0)[i], self.patch.spans(1)[j]];
                let middle = [0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1])];
                self.patch.shape_in_span([i, j], middle, &mut room);
                connectivity.extend_from_slice(&room.indices);
            }
        }
        let elements = (spans[0] * spans[1]) as u32;
        let faces = |face: u8| -> Vec<Face> {
            (0..elements)
                .map(|element| Face { element, face })
                .collect()
        };
        let nodes = self.patch.points();
        let all: Vec<u32> = (0..nodes.len() as u32).collect();
        let mut node_sets = BTreeMap::new();
        for name in ["top", "bottom"] {
            node_sets.insert(name.to_owned(), all.clone());
        }
        for edge in Edge::ALL {
            node_sets.insert(edge.name(), sorted(self.row(edge, 0)));
            self.edge_sets.insert(edge.name(), vec![edge]);
        }
        for (k, corner) in self.corners().into_iter().enumerate() {
            node_sets.insert(format!("corner.{}", k + 1), vec![corner]);
        }
        Mesh {
            kind: ElementKind::Nurbs,
            nodes,
            connectivity,
            node_sets,
            face_sets: BTreeMap::from([
                ("bottom".to_owned(), faces(4)),
                ("top".to_owned(), faces(5)),
            ]),
        }
    }

    /// Smallest and largest coordinates of the control points.
    pub fn bounds(&self) -> [Vec3; 2] {
        self.patch.bounds()
    }

    /// Shortest and longest side of the elements.
    pub fn span_lengths(&self) -> [f64; 2] {
        let both = [0, 1].map(|dir| refine::lengths(&self.patch, dir));
        let all = || both.iter().flatten().copied();
        [
            all().fold(f64::INFINITY, f64::min),
            all().fold(0.0, f64::max),
        ]
    }

    /// Mean length of the spans' sides.
    pub fn span_length(&self) -> f64 {
        let [nu, nv] = self.spans();
        let both = [0, 1].map(|dir| refine::lengths(&self.patch, dir).iter().sum::<f64>());
        0.5 * (both[0] / nu as f64 + both[1] / nv as f64)
    }
}

fn sorted(mut nodes: Vec<u32>) -> Vec<u32> {
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
