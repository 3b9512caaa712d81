//! Lengths, areas, volumes and shape quality of elements.
use super::{ElementKind, Face, Mesh};
use crate::fem::Quad;
use crate::fem::face::shape as shape_functions;
use crate::fem::quadrature::{GAUSS_2, GAUSS_3};
use covact_geometry::Vec3;

/// Smallest, mean and largest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The smallest.
    pub min: f64,
    /// The mean.
    pub mean: f64,
    /// The largest.
    pub max: f64,
}

/// Sizes and shapes of a mesh's elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementSize {
    /// Lengths of the edges along r and s (in the shell's surface).
    pub edge: Range,
    /// Lengths of the edges along t (through the thickness of one layer).
    pub thickness: Range,
    /// Smallest scaled Jacobian of each element: the determinant of the unit edge vectors at a node.
    /// 1 for a right-angled element, 0 for a collapsed one.
    pub shape: Range,
}

/// Node pairs of the edges of H8: four along r, four along s, four along t.
pub const H8_EDGES: [[u8; 2]; 12] = [
    [0, 1],
    [2, 3],
    [4, 5],
    [6, 7],
    [0, 2],
    [1, 3],
    [4, 6],
    [5, 7],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

/// Collects minimum, mean and maximum.
#[derive(Clone, Copy)]
struct Gather {
    min: f64,
    sum: f64,
    max: f64,
    count: usize,
}

impl Gather {
    const EMPTY: Gather = Gather {
        min: f64::INFINITY,
        sum: 0.0,
        max: f64::NEG_INFINITY,
        count: 0,
    };

    fn add(&mut self, value: f64) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum += value;
        self.count += 1;
    }

    fn range(self) -> Range {
        Range {
            min: self.min,
            mean: self.sum / self.count as f64,
            max: self.max,
        }
    }
}

impl Mesh {
    /// Positions of the corners of element `e`.
    pub fn element_positions(&self, e: usize) -> [Vec3; 8] {
        let nodes = self.element(e);
        self.kind.corners().map(|a| self.nodes[nodes[a] as usize])
    }

    /// Position of the centre of element `e`, r = s = t = 0.
    pub fn element_center(&self, e: usize) -> Vec3 {
        match self.kind {
            ElementKind::H8 => self.element_positions(e).iter().sum::<Vec3>() / 8.0,
            ElementKind::Nurbs => {
                let nodes = self.element(e).iter();
                nodes.map(|&n| self.nodes[n as usize]).sum::<Vec3>() / 16.0
            }
            ElementKind::Q18 => {
                let nodes = self.element(e);
                (self.nodes[nodes[4] as usize] + self.nodes[nodes[13] as usize]) * 0.5
            }
        }
    }

    /// Hands over the Jacobian determinant and the scaled Jacobian (the determinant of the unit tangents; 0 where a
    /// tangent has no length) at every node of element `e`.
    pub(super) fn node_shapes(&self, e: usize, mut found: impl FnMut(f64, f64)) {
        match self.kind {
            // Its surface is looked at where it is made.
            ElementKind::Nurbs => found(1.0, 1.0),
            ElementKind::H8 => {
                let x = self.element_positions(e);
                for a in 0..8 {
                    let edge = |bit: usize| (x[a | 1 << bit] - x[a & !(1 << bit)]) * 0.5;
                    let (jacobian, scaled) = shape([edge(0), edge(1), edge(2)]);
                    found(jacobian, scaled);
                }
            }
            ElementKind::Q18 => {
                let [bottom, top] = self.bottom_and_top(e);
                for k in 0..9 {
                    let (r, s) = ((k % 3) as f64 - 1.0, (k / 3) as f64 - 1.0);
                    let t = (top.nodes[k] - bottom.nodes[k]) * 0.5;
                    for side in [&bottom, &top] {
                        let [along_r, along_s] = side.tangents(r, s);
                        let (jacobian, scaled) = shape([along_r, along_s, t]);
                        found(jacobian, scaled);
                    }
                }
            }
        }
    }

    /// Bottom and top of element `e` as surfaces of r and s.
    fn bottom_and_top(&self, e: usize) -> [Quad; 2] {
        let nodes = self.element(e);
        let (bottom, top) = nodes.split_at(nodes.len() / 2);
        [bottom, top].map(|side| {
            let mut quad = Quad {
                nodes: [Vec3::zeros(); 9],
                count: if side.len() == 4 { [2, 2] } else { [3, 3] },
            };
            for (x, &n) in quad.nodes.iter_mut().zip(side) {
                *x = self.nodes[n as usize];
            }
            quad
        })
    }

    /// Area of a face (by 2 x 2 Gauss points: exact for flat bilinear faces; 3 x 3 for quadratic ones) and the outward
    /// unit normal at its centre (zero for a face without area).
    pub fn face_area_normal(&self, face: Face) -> (f64, Vec3) {
        let quad = Quad::new(&self.face_nodes(face), |n| self.nodes[n as usize]);
        let rule = if quad.count == [2, 2] {
            GAUSS_2
        } else {
            GAUSS_3
        };
        let area = quad.weights_with(&rule).iter().sum();
        let normal = quad.area_vector(0.0, 0.0).try_normalize(0.0);
        (area, normal.unwrap_or_else(Vec3::zeros))
    }

    /// Volume of element `e`; of a knot span none, because its thickness is not the mesh's: exact, by as many Gauss points a direction as there are nodes (the Jacobian has the degrees
    /// 2 of H8, 5 and 2 of Q18).
    pub fn element_volume(&self, e: usize) -> f64 {
        if self.kind == ElementKind::Nurbs {
            return 0.0;
        }
        let [bottom, top] = self.bottom_and_top(e);
        let rule = match self.kind {
            ElementKind::H8 => GAUSS_2,
            ElementKind::Q18 | ElementKind::Nurbs => GAUSS_3,
        };
        let mut volume = 0.0;
        for (s, ws) in rule.iter() {
            for (r, wr) in rule.iter() {
                let [low, high] = [&bottom, &top].map(|q| (q.point(r, s), q.tangents(r, s)));
                let along_t = (high.0 - low.0) * 0.5;
                for (t, wt) in GAUSS_2.iter() {
                    let along = |i: usize| low.1[i] * (0.5 - 0.5 * t) + high.1[i] * (0.5 + 0.5 * t);
                    volume += wr * ws * wt * along(0).cross(&along(1)).dot(&along_t);
                }
            }
        }
        volume
    }

    /// Hands over every quadrature point of element `e`, as many a direction as there are nodes: the shape functions of its
    /// nodes, and the volume that it stands for.
    pub fn for_volume_points(&self, e: usize, mut point: impl FnMut(&[f64], f64)) {
        let rule = match self.kind {
            ElementKind::H8 => GAUSS_2,
            ElementKind::Q18 | ElementKind::Nurbs => GAUSS_3,
        };
        let sides = self.bottom_and_top(e);
        let count = sides[0].count;
        let nodes = self.element(e).len();
        let half = nodes / 2;
        let mut weights = [0.0; 18];
        for (s, ws) in rule.iter() {
            for (r, wr) in rule.iter() {
                let [low, high] = [0, 1].map(|i| (sides[i].point(r, s), sides[i].tangents(r, s)));
                let along_t = (high.0 - low.0) * 0.5;
                let shapes = shape_functions(count, r, s);
                for (t, wt) in GAUSS_2.iter() {
                    let parts = [0.5 - 0.5 * t, 0.5 + 0.5 * t];
                    let along = |i: usize| low.1[i] * parts[0] + high.1[i] * parts[1];
                    let volume = wr * ws * wt * along(0).cross(&along(1)).dot(&along_t);
                    for (k, weight) in weights[..nodes].iter_mut().enumerate() {
                        *weight = shapes[k % half] * parts[k / half];
                    }
                    point(&weights[..nodes], volume);
                }
            }
        }
    }

    /// Integral of the shape function of every node over the mesh: the volume that it stands for under a force per volume.
    pub fn nodal_volumes(&self) -> Vec<f64> {
        let mut volumes = vec![0.0; self.nodes.len()];
        if self.kind == ElementKind::Nurbs {
            return volumes;
        }
        for e in 0..self.elements() {
            self.for_volume_points(e, |weights, volume| {
                for (node, weight) in self.element(e).iter().zip(weights) {
                    volumes[*node as usize] += weight * volume;
                }
            });
        }
        volumes
    }

    /// Volume of the whole mesh.
    pub fn volume(&self) -> f64 {
        (0..self.elements()).map(|e| self.element_volume(e)).sum()
    }

    /// Smallest and largest coordinates of the nodes; zeros for an empty mesh.
    pub fn bounds(&self) -> [Vec3; 2] {
        let Some(first) = self.nodes.first() else {
            return [Vec3::zeros(); 2];
        };
        self.nodes
            .iter()
            .fold([*first; 2], |[min, max], x| [min.inf(x), max.sup(x)])
    }

    /// Sizes and shapes of the elements; `None` for a mesh without elements.
    pub fn element_size(&self) -> Option<ElementSize> {
        if self.elements() == 0 {
            return None;
        }
        let mut edge = Gather::EMPTY;
        let mut thickness = Gather::EMPTY;
        let mut shape = Gather::EMPTY;
        for e in 0..self.elements() {
            let x = self.element_positions(e);
            for (i, [a, b]) in H8_EDGES.iter().enumerate() {
                let length = (x[*b as usize] - x[*a as usize]).norm();
                if i < 8 {
                    edge.add(length)
                } else {
                    thickness.add(length)
                }
            }
            let mut smallest = f64::INFINITY;
            self.node_shapes(e, |_, scaled| smallest = smallest.min(scaled));
            shape.add(smallest);
        }
        Some(ElementSize {
            edge: edge.range(),
            thickness: thickness.range(),
            shape: shape.range(),
        })
    }
}

/// Determinant of three tangents and of their unit vectors, 0 where a tangent has no length.
fn shape(g: [Vec3; 3]) -> (f64, f64) {
    let determinant = g[0].cross(&g[1]).dot(&g[2]);
    let lengths = g[0].norm() * g[1].norm() * g[2].norm();
    let scaled = if lengths > 0.0 {
        determinant / lengths
    } else {
        0.0
    };
    (determinant, scaled)
}
