//! Cells as tensor products: bricks that are linear through the thickness, and faces.
use crate::fem::FaceNodes;
use crate::fem::face::{shape, shape_derivatives};
use crate::mesh::ElementKind;
use covact_geometry::Vec3;

/// Most nodes of a cell.
pub(super) const NODES: usize = 18;
/// Steps that the inverse mapping takes at most. Inside of a cell a few do; far off a strongly bent one they converge linearly.
const STEPS: usize = 100;
/// Halvings of a step that brings no descent.
const HALVINGS: usize = 30;

/// Nodes of a cell, r fastest, then s, then t.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cell {
    nodes: [u32; NODES],
    pub kind: Kind,
}

/// Nodes along r and s (2 or 3), and along t: 2 of a brick, 1 of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Kind {
    pub plane: [u8; 2],
    pub layers: u8,
}

/// Shape functions of a cell at a point, and their derivatives along r, s, t; zero past the last node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub n: [f64; NODES],
    pub d: [[f64; NODES]; 3],
}

impl Kind {
    pub fn nodes(self) -> usize {
        self.plane[0] as usize * self.plane[1] as usize * self.layers as usize
    }

    /// Directions it extends along.
    pub fn dimension(self) -> usize {
        1 + self.layers as usize
    }

    /// Shape functions at (r, s, t), each in [-1, 1]; a face has no t.
    pub fn at(self, [r, s, t]: [f64; 3]) -> Shape {
        let (n, [dr, ds]) = (shape(self.plane, r, s), shape_derivatives(self.plane, r, s));
        let mut out = Shape {
            n: [0.0; NODES],
            d: [[0.0; NODES]; 3],
        };
        let size = self.plane[0] as usize * self.plane[1] as usize;
        if self.layers == 1 {
            out.n[..size].copy_from_slice(&n[..size]);
            out.d[0][..size].copy_from_slice(&dr[..size]);
            out.d[1][..size].copy_from_slice(&ds[..size]);
            return out;
        }
        for (k, (w, dw)) in [(0.5 * (1.0 - t), -0.5), (0.5 * (1.0 + t), 0.5)]
            .into_iter()
            .enumerate()
        {
            for a in 0..size {
                let node = k * size + a;
                out.n[node] = w * n[a];
                out.d[0][node] = w * dr[a];
                out.d[1][node] = w * ds[a];
                out.d[2][node] = dw * n[a];
            }
        }
        out
    }
}

impl Cell {
    /// An element, with its nodes as the mesh has them.
    pub fn brick(kind: ElementKind, element: &[u32]) -> Cell {
        let plane = match kind {
            ElementKind::H8 => [2, 2],
            ElementKind::Q18 | ElementKind::Nurbs => [3, 3],
        };
        Cell::new(Kind { plane, layers: 2 }, element)
    }

    pub fn face(face: &FaceNodes) -> Cell {
        let kind = Kind {
            plane: face.count,
            layers: 1,
        };
        Cell::new(kind, face.nodes())
    }

    fn new(kind: Kind, from: &[u32]) -> Cell {
        let mut nodes = [0; NODES];
        nodes
            .iter_mut()
            .zip(from)
            .for_each(|(to, from)| *to = *from);
        Cell { nodes, kind }
    }

    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.kind.nodes()]
    }

    /// The cell in its place.
    pub fn placed(&self, points: &[Vec3]) -> Placed {
        let mut x = [Vec3::zeros(); NODES];
        for (x, &node) in x.iter_mut().zip(self.nodes()) {
            *x = points[node as usize];
        }
        Placed { x, kind: self.kind }
    }
}

/// A cell by the positions of its nodes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    x: [Vec3; NODES],
    kind: Kind,
}

impl Placed {
    pub fn position(&self, shape: &Shape) -> Vec3 {
        self.combine(&shape.n)
    }

    /// Volume of a brick, or area of a face, per volume of the parent.
    pub fn measure(&self, shape: &Shape) -> f64 {
        let [a, b] = [0, 1].map(|i| self.combine(&shape.d[i]));
        let normal = a.cross(&b);
        match self.kind.layers {
            1 => normal.norm(),
            _ => normal.dot(&self.combine(&shape.d[2])),
        }
    }

    fn combine(&self, weights: &[f64; NODES]) -> Vec3 {
        let mut sum = Vec3::zeros();
        for (x, w) in self.x[..self.kind.nodes()].iter().zip(weights) {
            sum += x * *w;
        }
        sum
    }

    /// A box that holds all of the cell: that of its Bezier points.
    pub fn bounds(&self) -> [Vec3; 2] {
        let mut x = self.x;
        let [nu, nv] = self.kind.plane.map(usize::from);
        let middle = |x: &mut [Vec3; NODES], [a, b, c]: [usize; 3]| {
            x[b] = x[b] * 2.0 - (x[a] + x[c]) * 0.5;
        };
        for layer in 0..self.kind.layers as usize {
            let first = layer * nu * nv;
            if nu == 3 {
                (0..nv).for_each(|j| middle(&mut x, [0, 1, 2].map(|i| first + i + nu * j)));
            }
            if nv == 3 {
                (0..nu).for_each(|i| middle(&mut x, [0, 1, 2].map(|j| first + i + nu * j)));
            }
        }
        let x = &x[..self.kind.nodes()];
        [
            x.iter().fold(x[0], |a, b| a.inf(b)),
            x.iter().fold(x[0], |a, b| a.sup(b)),
        ]
    }

    /// The place of the cell that is nearest to `p`, and its distance: Gauss-Newton steps within the parent, which end where
    /// no direction along or into it comes nearer. A point within the cell is found with distance zero up to rounding; to a
    /// point about as far away as the cell is large, a bent cell may have several such places.
    pub fn nearest(&self, p: &Vec3, close: f64) -> ([f64; 3], f64) {
        let mut xi = [0.0; 3];
        let mut shape = self.kind.at(xi);
        let mut r = p - self.position(&shape);
        for _ in 0..STEPS {
            // Well below, so that the place is as sharp as it can be.
            if r.norm() <= 0.01 * close {
                break;
            }
            let frame = [0, 1, 2].map(|i| self.combine(&shape.d[i]));
            let Some(step) = step(&frame, &r, &xi, self.kind.dimension()) else {
                break;
            };
            // The way to the first face of the parent, if that is nearer than the end of the step: cutting off single
            // coordinates behind it would change the direction, and slanted cells would not be left along their faces.
            let reach = |i: usize| (step[i].signum() - xi[i]) / step[i];
            let first = (0..3)
                .filter(|&i| step[i] != 0.0 && reach(i) < 1.0)
                .min_by(|&i, &j| reach(i).total_cmp(&reach(j)));
            let mut share = first.map_or(1.0, reach);
            let better = (0..HALVINGS).find_map(|halving| {
                let mut next: [f64; 3] =
                    std::array::from_fn(|i| (xi[i] + share * step[i]).clamp(-1.0, 1.0));
                if let Some(i) = first.filter(|_| halving == 0) {
                    next[i] = step[i].signum();
                }
                let shape = self.kind.at(next);
                let rest = p - self.position(&shape);
                share *= 0.5;
                (rest.norm_squared() < r.norm_squared()).then_some((next, shape, rest))
            });
            let Some((next, s, rest)) = better else { break };
            let gain = r.norm() - rest.norm();
            (xi, shape, r) = (next, s, rest);
            if gain <= 1e-3 * close {
                break;
            }
        }
        (xi, r.norm())
    }
}

/// Least squares step towards a remainder `r` along those directions that do not leave the parent; none where there is no
/// way to come nearer.
fn step(frame: &[Vec3; 3], r: &Vec3, xi: &[f64; 3], dimension: usize) -> Option<[f64; 3]> {
    let leaves = |i: usize, d: f64| (xi[i] >= 1.0 && d > 0.0) || (xi[i] <= -1.0 && d < 0.0);
    let pull: [f64; 3] = std::array::from_fn(|i| frame[i].dot(r));
    let mut free: [bool; 3] =
        std::array::from_fn(|i| i < dimension && pull[i] != 0.0 && !leaves(i, pull[i]));
    let steepest = (0..3).filter(|&i| free[i]).max_by(|&i, &j| {
        (pull[i].abs() / frame[i].norm()).total_cmp(&(pull[j].abs() / frame[j].norm()))
    })?;
    // A direction that points inwards alone may point outwards beside others: it is held then.
    while free.iter().any(|f| *f) {
        let Some(d) = solve(frame, r, free) else {
            break;
        };
        match (0..3).find(|&i| free[i] && leaves(i, d[i])) {
            Some(i) => free[i] = false,
            None => return Some(d),
        }
    }
    let mut d = [0.0; 3];
    d[steepest] = pull[steepest] / frame[steepest].norm_squared();
    Some(d)
}

/// Least squares solution of `sum d_i frame_i = r` over the free directions; none where these depend on each other.
fn solve(frame: &[Vec3; 3], r: &Vec3, free: [bool; 3]) -> Option<[f64; 3]> {
    let mut d = [0.0; 3];
    let [a, b, c] = frame;
    let which: [usize; 3] =
        std::array::from_fn(|k| (0..3).filter(|&i| free[i]).nth(k).unwrap_or(3));
    match free.iter().filter(|f| **f).count() {
        3 => {
            let dual = [b.cross(c), c.cross(a), a.cross(b)];
            let det = a.dot(&dual[0]);
            for i in 0..3 {
                d[i] = r.dot(&dual[i]) / det;
            }
        }
        2 => {
            let (i, j) = (which[0], which[1]);
            let (a, b) = (frame[i], frame[j]);
            let normal = a.cross(&b);
            let det = normal.norm_squared();
            d[i] = r.dot(&b.cross(&normal)) / det;
            d[j] = r.dot(&normal.cross(&a)) / det;
        }
        1 => {
            let i = which[0];
            d[i] = frame[i].dot(r) / frame[i].norm_squared();
        }
        _ => return None,
    }
    d.iter().all(|d| d.is_finite()).then_some(d)
}
