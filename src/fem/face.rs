//! Faces of elements, over which loads and contact integrate: bilinear quadrilaterals, biquadratic ones, and the sides
//! of Q18, which are quadratic one way and linear the other.
use super::quadrature::{GAUSS_3, Rule};
use covact_geometry::Vec3;

/// Nodes of a face: `count[0]` along u times `count[1]` along v, each 2 or 3, u fastest, `u x v` outward. Faces of H8 are
/// 2 x 2; the bottom and top of Q18 are 3 x 3, its sides 3 x 2 or 2 x 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct FaceNodes {
    /// The nodes; only the first `count[0] * count[1]` are used, the others are 0.
    pub nodes: [u32; 9],
    /// Nodes along u and along v.
    pub count: [u8; 2],
}

impl FaceNodes {
    /// A bilinear face.
    pub fn bilinear(nodes: [u32; 4]) -> FaceNodes {
        let [a, b, c, d] = nodes;
        FaceNodes {
            nodes: [a, b, c, d, 0, 0, 0, 0, 0],
            count: [2, 2],
        }
    }

    /// The nodes, u fastest.
    #[inline]
    pub fn nodes(&self) -> &[u32] {
        let [nu, nv] = self.count;
        &self.nodes[..nu as usize * nv as usize]
    }

    /// The four corners, u fastest.
    #[inline]
    pub fn corners(&self) -> [u32; 4] {
        let [nu, nv] = self.count.map(usize::from);
        [0, nu - 1, nu * (nv - 1), nu * nv - 1].map(|k| self.nodes[k])
    }

    /// The same face with every node number raised by `offset`.
    #[inline]
    pub fn shifted(mut self, offset: u32) -> FaceNodes {
        let n = self.nodes().len();
        self.nodes[..n].iter_mut().for_each(|n| *n += offset);
        self
    }
}

/// The functions of `count` nodes (2 or 3) at -1, (0,) 1, evaluated at `x`.
#[inline(always)]
fn line(count: u8, x: f64) -> [f64; 3] {
    if count == 2 {
        [0.5 * (1.0 - x), 0.5 * (1.0 + x), 0.0]
    } else {
        [
            0.5 * x * (x - 1.0),
            (1.0 - x) * (1.0 + x),
            0.5 * x * (x + 1.0),
        ]
    }
}

/// Derivatives of [`line`].
#[inline(always)]
fn line_derivatives(count: u8, x: f64) -> [f64; 3] {
    if count == 2 {
        [-0.5, 0.5, 0.0]
    } else {
        [x - 0.5, -2.0 * x, x + 0.5]
    }
}

/// Products of functions along u and along v, u fastest.
#[inline(always)]
fn product([nu, nv]: [u8; 2], along_u: [f64; 3], along_v: [f64; 3]) -> [f64; 9] {
    let mut n = [0.0; 9];
    let mut k = 0;
    for b in &along_v[..nv as usize] {
        for a in &along_u[..nu as usize] {
            n[k] = a * b;
            k += 1;
        }
    }
    n
}

/// Shape functions at (u, v) in [-1, 1]^2 of a face with `count` nodes along u and v, in the order of
/// [`FaceNodes`]; zero past the last node.
#[inline]
pub fn shape(count: [u8; 2], u: f64, v: f64) -> [f64; 9] {
    product(count, line(count[0], u), line(count[1], v))
}

/// Derivatives of the shape functions along u and v.
#[inline]
pub fn shape_derivatives(count: [u8; 2], u: f64, v: f64) -> [[f64; 9]; 2] {
    let [nu, nv] = count;
    [
        product(count, line_derivatives(nu, u), line(nv, v)),
        product(count, line(nu, u), line_derivatives(nv, v)),
    ]
}

/// A face given by the positions of its nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quad {
    /// Positions in the order of [`FaceNodes`]; only the first `count[0] * count[1]` are used.
    pub nodes: [Vec3; 9],
    /// Nodes along u and v, 2 or 3.
    pub count: [u8; 2],
}

impl Quad {
    /// The face with its nodes at the given positions.
    #[inline]
    pub fn new(face: &FaceNodes, position: impl Fn(u32) -> Vec3) -> Quad {
        let mut nodes = [Vec3::zeros(); 9];
        for (x, &node) in nodes.iter_mut().zip(face.nodes()) {
            *x = position(node);
        }
        Quad {
            nodes,
            count: face.count,
        }
    }

    /// A bilinear quadrilateral with its corners in the order (-,-), (+,-), (-,+), (+,+).
    pub fn bilinear(corners: [Vec3; 4]) -> Quad {
        let mut nodes = [Vec3::zeros(); 9];
        nodes[..4].copy_from_slice(&corners);
        Quad {
            nodes,
            count: [2, 2],
        }
    }

    /// Point at (u, v).
    pub fn point(&self, u: f64, v: f64) -> Vec3 {
        self.combine(&shape(self.count, u, v))
    }

    /// Tangents along u and v.
    pub fn tangents(&self, u: f64, v: f64) -> [Vec3; 2] {
        shape_derivatives(self.count, u, v).map(|d| self.combine(&d))
    }

    /// Outward normal times the area element: `x_,u x x_,v` (length^2).
    pub fn area_vector(&self, u: f64, v: f64) -> Vec3 {
        let [a, b] = self.tangents(u, v);
        a.cross(&b)
    }

    /// Integral of every shape function over the face, `int N_k dA` (length^2); with the 3 x 3 Gauss rule it is exact for
    /// plane parallelograms and plane bilinear faces, and an approximation on warped and curved ones. On a plane
    /// parallelogram a biquadratic face's are 1/36, 4/36 and 16/36 of the area for corners, edges and centre.
    pub fn weights(&self) -> [f64; 9] {
        self.weights_with(&GAUSS_3)
    }

    /// As [`Quad::weights`], with the given rule in both directions.
    pub fn weights_with(&self, rule: &Rule) -> [f64; 9] {
        let mut sum = [0.0; 9];
        for (v, wv) in rule.iter() {
            for (u, wu) in rule.iter() {
                let da = wu * wv * self.area_vector(u, v).norm();
                for (s, n) in sum.iter_mut().zip(shape(self.count, u, v)) {
                    *s += n * da;
                }
            }
        }
        sum
    }

    /// Shortest distance of neighbouring nodes (length).
    pub fn spacing(&self) -> f64 {
        let [nu, nv] = self.count.map(usize::from);
        let between = |a: usize, b: usize| (self.nodes[a] - self.nodes[b]).norm();
        let along_u = (0..nu * nv)
            .filter(|k| k % nu > 0)
            .map(|k| between(k, k - 1));
        let along_v = (nu..nu * nv).map(|k| between(k, k - nu));
        along_u.chain(along_v).fold(f64::INFINITY, f64::min)
    }

    /// Area (length^2).
    pub fn area(&self) -> f64 {
        self.weights().iter().sum()
    }

    fn combine(&self, weights: &[f64; 9]) -> Vec3 {
        let n = self.count[0] as usize * self.count[1] as usize;
        let mut sum = Vec3::zeros();
        for (x, w) in self.nodes[..n].iter().zip(weights) {
            sum += x * *w;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A trapezoid with parallel sides 1 and 2 at distance 1: the shape functions' integrals by hand.
    #[test]
    fn tributary_areas_of_a_trapezoid() {
        let corners =
            [[0.0, 0.0], [2.0, 0.0], [0.5, 1.0], [1.5, 1.0]].map(|p| Vec3::new(p[0], p[1], 0.0));
        let weights = Quad::bilinear(corners).weights();
        // Width 2 - y: int (1 - y)(2 - y)/2 dy = 5/12, int y (2 - y)/2 dy = 1/3.
        for (found, expected) in weights
            .iter()
            .zip([5.0 / 12.0, 5.0 / 12.0, 1.0 / 3.0, 1.0 / 3.0])
        {
            assert!((found - expected).abs() < 1e-15, "{weights:?}");
        }
    }

    /// Shape functions are one at their own node and nothing at the others, and add up to one; their derivatives against
    /// dual numbers' worth of differences of polynomials: central differences are exact for quadratics.
    #[test]
    fn shape_functions_of_all_faces() {
        for count in [[2, 2], [3, 2], [2, 3], [3, 3]] {
            let [nu, nv] = count.map(usize::from);
            let place = |k: usize, n: usize| 2.0 * k as f64 / (n - 1) as f64 - 1.0;
            for k in 0..nu * nv {
                let n = shape(count, place(k % nu, nu), place(k / nu, nv));
                for (l, n) in n.iter().enumerate() {
                    assert_eq!(*n, if l == k { 1.0 } else { 0.0 });
                }
            }
            let (u, v, h) = (0.3, -0.7, 0.125);
            assert!((shape(count, u, v).iter().sum::<f64>() - 1.0).abs() < 1e-15);
            let [du, dv] = shape_derivatives(count, u, v);
            let along_u = [shape(count, u + h, v), shape(count, u - h, v)];
            let along_v = [shape(count, u, v + h), shape(count, u, v - h)];
            for k in 0..9 {
                assert!(((along_u[0][k] - along_u[1][k]) / (2.0 * h) - du[k]).abs() < 1e-14);
                assert!(((along_v[0][k] - along_v[1][k]) / (2.0 * h) - dv[k]).abs() < 1e-14);
                assert_eq!(du[k] == 0.0, k >= nu * nv);
            }
        }
    }
}
