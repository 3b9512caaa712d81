//! Lengths, areas, volumes and shape quality of elements.
use super::{Face, Mesh};
use crate::shell::Quad;
use crate::shell::quadrature::{GAUSS_2, GAUSS_3};
use covact_geometry::Vec3;

/// Smallest, mean and largest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    pub min: f64,
    pub mean: f64,
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

    /// Mean position of the corners of element `e`.
    pub fn element_center(&self, e: usize) -> Vec3 {
        self.element_positions(e).iter().sum::<Vec3>() / 8.0
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

    /// Volume of element `e` (2 x 2 x 2 Gauss points: exact, the Jacobian is quadratic in each direction).
    pub fn element_volume(&self, e: usize) -> f64 {
        let x = self.element_positions(e);
        let g = 1.0 / 3f64.sqrt();
        (0..8)
            .map(|q| {
                let at = |bit: usize| if q >> bit & 1 == 1 { g } else { -g };
                jacobian(&x, [at(0), at(1), at(2)])
            })
            .sum()
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
            let smallest = (0..8)
                .map(|a| corner(&x, a).1)
                .fold(f64::INFINITY, f64::min);
            shape.add(smallest);
        }
        Some(ElementSize {
            edge: edge.range(),
            thickness: thickness.range(),
            shape: shape.range(),
        })
    }
}

/// Determinant of the derivatives of the trilinear map at `xi` in [-1, 1]^3.
pub(super) fn jacobian(x: &[Vec3; 8], xi: [f64; 3]) -> f64 {
    let mut g = [Vec3::zeros(); 3];
    for (a, xa) in x.iter().enumerate() {
        let sign = [0, 1, 2].map(|d| if a >> d & 1 == 1 { 1.0 } else { -1.0 });
        let f = [0, 1, 2].map(|d: usize| 0.5 * (1.0 + sign[d] * xi[d]));
        g[0] += xa * (0.5 * sign[0] * f[1] * f[2]);
        g[1] += xa * (0.5 * sign[1] * f[0] * f[2]);
        g[2] += xa * (0.5 * sign[2] * f[0] * f[1]);
    }
    g[0].cross(&g[1]).dot(&g[2])
}

/// Jacobian determinant and scaled Jacobian at node `a`: both from the three edges that meet there. The scaled one is 0
/// where an edge has no length.
pub(super) fn corner(x: &[Vec3; 8], a: usize) -> (f64, f64) {
    let edge = |bit: usize| {
        let b = a | 1 << bit;
        (x[b] - x[b & !(1 << bit)]) * 0.5
    };
    let g = [edge(0), edge(1), edge(2)];
    let determinant = g[0].cross(&g[1]).dot(&g[2]);
    let lengths = g[0].norm() * g[1].norm() * g[2].norm();
    (
        determinant,
        if lengths > 0.0 {
            determinant / lengths
        } else {
            0.0
        },
    )
}
