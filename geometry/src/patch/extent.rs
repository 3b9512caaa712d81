//! Extent, collapsed edges and creases of a patch.

use super::NurbsPatch;
use crate::basis::WIDTH;
use crate::surface::Vec3;

impl NurbsPatch {
    /// Lowest and highest corner of a box around the control points that act on the domain; the patch lies inside
    /// it (convex hull property).
    pub fn bounds(&self) -> [Vec3; 2] {
        let range = |dir: usize| {
            let basis = &self.basis[dir];
            basis.first_function(0)..=basis.first_function(basis.span_count() - 1) + basis.degree()
        };
        let columns = self.basis[0].count();
        let active = range(1).flat_map(|j| range(0).map(move |i| i + columns * j));
        hull(active.map(|k| self.points[k]))
    }

    /// Knots inside the domain of direction `dir` that are repeated as often as the degree: the tangents may jump
    /// there. A surface can still be smooth across such a line (a circle of quadratic arcs); see
    /// [`sharp_knots`](Self::sharp_knots).
    pub fn crease_knots(&self, dir: usize) -> Vec<f64> {
        self.basis(dir).crease_knots()
    }

    /// The [`crease_knots`](Self::crease_knots) of direction `dir` across which the normal turns by more than `angle`
    /// (radians) somewhere. Normals are compared at `degree + 2` points of every span along the line; where one of
    /// them does not exist the point is passed over.
    pub fn sharp_knots(&self, dir: usize, angle: f64) -> Vec<f64> {
        let (dir, along) = (dir.min(1), 1 - dir.min(1));
        let samples = self.basis[along].degree() + 2;
        let normal = |span: [usize; 2], xi: [f64; 2]| {
            crate::Frame::new(&self.jet_in_span(span, xi), 1.0).map(|frame| frame.n)
        };
        let turns = |t: f64| {
            let right = self.basis[dir].find_span(t);
            (0..self.basis[along].span_count()).any(|span| {
                let [a, b] = self.basis[along].span_range(span);
                (0..samples).any(|k| {
                    let s = a + (b - a) * (k as f64 + 0.5) / samples as f64;
                    let (mut xi, mut spans) = ([s; 2], [span; 2]);
                    xi[dir] = t;
                    spans[dir] = right;
                    let after = normal(spans, xi);
                    spans[dir] = right.saturating_sub(1);
                    let before = normal(spans, xi);
                    matches!((before, after), (Some(m), Some(n)) if m.cross(&n).norm().atan2(m.dot(&n)) > angle)
                })
            })
        };
        self.crease_knots(dir)
            .into_iter()
            .filter(|&t| turns(t))
            .collect()
    }

    /// Which edges are one point in space: all control points of the edge curve within `tol` (a length) of each
    /// other. Edge 0 is xi1 = start, 1 is xi1 = end, 2 is xi2 = start, 3 is xi2 = end.
    pub fn degenerate_edges(&self, tol: f64) -> [bool; 4] {
        [0, 1, 2, 3].map(|edge| {
            let (dir, along) = (edge / 2, 1 - edge / 2);
            let basis = &self.basis[dir];
            let (span, t) = match edge % 2 {
                0 => (0, basis.domain()[0]),
                _ => (basis.span_count() - 1, basis.domain()[1]),
            };
            let mut n = [[0.0; WIDTH]];
            basis.evaluate(span, t, &mut n);
            let first = basis.first_function(span);
            let other = &self.basis[along];
            let end = other.first_function(other.span_count() - 1) + other.degree();
            let strides = [1, self.basis[0].count()];
            let curve = (other.first_function(0)..=end).map(|j| {
                let mut sum = [0.0; 4];
                for (r, &f) in n[0].iter().enumerate().take(basis.degree() + 1) {
                    let point = &self.points[(first + r) * strides[dir] + j * strides[along]];
                    for (sum, x) in sum.iter_mut().zip(point) {
                        *sum += f * x;
                    }
                }
                sum
            });
            let [low, high] = hull(curve);
            (high - low).amax() <= tol
        })
    }
}

/// Box around homogeneous points.
fn hull(points: impl Iterator<Item = [f64; 4]>) -> [Vec3; 2] {
    let mut low = Vec3::from_element(f64::INFINITY);
    let mut high = -low;
    for [x, y, z, w] in points {
        let x = Vec3::new(x / w, y / w, z / w);
        low = low.inf(&x);
        high = high.sup(&x);
    }
    [low, high]
}
