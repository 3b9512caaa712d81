//! Pairs of slave face and master: their nodes, their slave points, and residual and tangent assembled as a program
//! would, next to the same in dual numbers.
use crate::support::{self, V};
use crate::surface::{Held, Surface};
use covact::contact::kernel::{self, NodeRow, Normal, SlotMatrix, Slots};
use covact::contact::law::NormalLaw;
use covact::contact::moving::{MovingMaster, master_row};
use covact::contact::point::{PointGeometry, respond};
use covact::contact::rigid::{Exact, Overhang};
use covact::fem::quadrature::{self, Rule};
use covact_geometry::{Bilinear, Biquadratic, Frame, MovingFacets, ShapeRows};
use nalgebra::{DMatrix, DVector};
use num_dual::{Dual64, DualNum};

/// `N = eps xi3 (1 + b xi3^2)`: not proportional to the gap, so that `N'` and `N / xi3` differ.
pub struct Hardening;
pub const EPS_N: f64 = 3.0;
const B: f64 = 20.0;

impl NormalLaw for Hardening {
    fn response(&self, xi3: f64) -> Normal {
        Normal {
            n: EPS_N * xi3 * (1.0 + B * xi3 * xi3),
            dn: EPS_N * (1.0 + 3.0 * B * xi3 * xi3),
        }
    }
    fn energy(&self, xi3: f64) -> f64 {
        energy(xi3 * xi3)
    }
}

/// `N / xi3` of the law from the squared distance.
fn secant<D: DualNum<f64> + Copy>(d2: D) -> D {
    (d2 * B + 1.0) * EPS_N
}

/// Energy of the law from the squared distance.
pub fn energy<D: DualNum<f64> + Copy>(d2: D) -> D {
    (d2 * 0.5 + d2 * d2 * (0.25 * B)) * EPS_N
}

/// A point of the slave face: shape functions of all nodes of the face, and the area it stands for.
#[derive(Clone)]
pub struct Point {
    pub shape: Vec<f64>,
    pub area: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    Nodes,
    Gauss(usize),
    Lobatto(usize),
}

/// Shape functions of a slave face with 4 or 9 nodes.
fn slave_shape(nodes: usize, xi: [f64; 2]) -> Vec<[f64; 3]> {
    if nodes == 4 {
        let s = Bilinear::shape(xi);
        (0..4).map(|k| [s[0][k], s[1][k], s[2][k]]).collect()
    } else {
        let s = Biquadratic::shape(xi);
        (0..9).map(|k| [s[0][k], s[1][k], s[2][k]]).collect()
    }
}

/// The points of a slave face, with areas of the face as it lies.
pub fn slave_points(x: &[V<f64>], scheme: Scheme) -> Vec<Point> {
    let area = |xi| {
        let s = slave_shape(x.len(), xi);
        let t = [1, 2].map(|o| (x.iter().zip(&s)).fold(V::zeros(), |t, (x, s)| t + x * s[o]));
        t[0].cross(&t[1]).norm()
    };
    let rule = |rule: Rule| {
        let mut points = Vec::new();
        for (v, wv) in rule.iter() {
            for (u, wu) in rule.iter() {
                points.push(Point {
                    shape: slave_shape(x.len(), [u, v]).iter().map(|s| s[0]).collect(),
                    area: wu * wv * area([u, v]),
                });
            }
        }
        points
    };
    match scheme {
        Scheme::Gauss(n) => rule(quadrature::gauss(n).unwrap()),
        Scheme::Lobatto(n) => rule(quadrature::lobatto(n).unwrap()),
        Scheme::Nodes => {
            // Tributary areas by a rule that is good enough.
            let by_gauss = rule(quadrature::gauss(3).unwrap());
            (0..x.len())
                .map(|k| Point {
                    shape: (0..x.len()).map(|j| f64::from(j == k)).collect(),
                    area: by_gauss.iter().map(|p| p.shape[k] * p.area).sum(),
                })
                .collect()
        }
    }
}

/// A slave face over a master surface; degrees of freedom are those of the slave nodes, then of the master nodes.
pub struct Case {
    pub name: String,
    pub slave: Vec<V<f64>>,
    pub master: Vec<V<f64>>,
    pub surface: Surface,
    pub points: Vec<Point>,
}

/// Where a slave point meets the master, with the core's answer.
pub struct Evaluated {
    pub facet: u32,
    pub xi: [f64; 2],
    pub held: Held,
    pub residual: Slots,
    pub tangent: SlotMatrix,
}

impl Case {
    pub fn all_nodes(&self) -> Vec<V<f64>> {
        self.slave.iter().chain(&self.master).copied().collect()
    }

    /// Evaluates the points through the core.
    pub fn evaluate(&self) -> Vec<Evaluated> {
        (self.points.iter())
            .map(|p| {
                let q = combine(&self.slave, &p.shape);
                let out = match &self.surface {
                    Surface::Facets { facets, .. } => on_facets(facets, &q),
                    Surface::Patch { weights } => {
                        let points = std::array::from_fn(|k| self.master[k]);
                        on_patch(&points, weights, &q)
                    }
                };
                out.unwrap_or_else(|| panic!("{}: no contact at {q:?}", self.name))
            })
            .collect()
    }

    /// Rows of all nodes that take part in a point: index and place in the slots.
    fn rows(&self, point: &Point, at: &Evaluated) -> Vec<(usize, NodeRow)> {
        let slave = (point.shape.iter().enumerate()).map(|(k, n)| (k, [*n, 0.0, 0.0]));
        let first = self.slave.len();
        let mut rows: Vec<_> = slave.collect();
        match &self.surface {
            Surface::Facets { facets, .. } => {
                let mut shape = ShapeRows::default();
                facets.shape(at.facet, at.xi, &mut shape);
                for (k, node) in self.surface.nodes(at.facet).into_iter().enumerate() {
                    rows.push((first + node, master_row(&shape, k)));
                }
            }
            Surface::Patch { weights } => {
                let b = support::basis(weights, at.xi);
                rows.extend((0..16).map(|k| (first + k, [-b[0][k], b[1][k], b[2][k]])));
            }
        }
        rows
    }

    /// Residual and tangent of all degrees of freedom: shape functions enter here and nowhere else.
    pub fn assemble(&self, at: &[Evaluated]) -> (DVector<f64>, DMatrix<f64>) {
        let n = 3 * (self.slave.len() + self.master.len());
        let (mut r, mut k) = (DVector::zeros(n), DMatrix::zeros(n, n));
        for (point, at) in self.points.iter().zip(at) {
            let rows = self.rows(point, at);
            for (i, row) in &rows {
                let f = kernel::assemble_force(&at.residual, row) * point.area;
                (0..3).for_each(|c| r[3 * i + c] += f[c]);
                for (j, column) in &rows {
                    let block = kernel::assemble_block(&at.tangent, row, column) * point.area;
                    let mut view = k.fixed_view_mut::<3, 3>(3 * i, 3 * j);
                    view += block;
                }
            }
        }
        (r, k)
    }

    /// Energy and residual in any scalar, the closest points solved again: the force is the secant of the law times the
    /// distance vector, whatever holds the foot.
    fn in_scalar<D: DualNum<f64> + Copy>(&self, at: &[Evaluated], x: &[V<D>]) -> (D, Vec<V<D>>) {
        let (slave, master) = x.split_at(self.slave.len());
        let mut forces = vec![V::from_element(D::zero()); x.len()];
        let mut total = D::zero();
        for (point, at) in self.points.iter().zip(at) {
            let q = (slave.iter().zip(&point.shape))
                .fold(V::from_element(D::zero()), |s, (x, n)| s + x * D::from(*n));
            let xi = self
                .surface
                .project(at.facet, master, &q, at.xi, at.held, 3);
            let d = q - self.surface.jet(at.facet, master, xi).rho;
            let d2 = d.dot(&d);
            total += energy(d2) * point.area;
            let f = d * (secant(d2) * point.area);
            for (k, n) in point.shape.iter().enumerate() {
                forces[k] += f * D::from(*n);
            }
            let basis = self.surface.basis(at.facet, xi);
            for (node, b) in self.surface.nodes(at.facet).into_iter().zip(basis) {
                forces[self.slave.len() + node] -= f * b[0];
            }
        }
        (total, forces)
    }

    /// Gradient of the energy and derivative of the residual by dual numbers.
    pub fn reference(&self, at: &[Evaluated]) -> (DVector<f64>, DMatrix<f64>) {
        let x = self.all_nodes();
        let n = 3 * x.len();
        let (mut gradient, mut k) = (DVector::zeros(n), DMatrix::zeros(n, n));
        // Nodes of facets that no point meets have no part in it.
        let mut takes_part = vec![false; x.len()];
        takes_part[..self.slave.len()].fill(true);
        for node in at.iter().flat_map(|p| self.surface.nodes(p.facet)) {
            takes_part[self.slave.len() + node] = true;
        }
        for dof in (0..n).filter(|dof| takes_part[dof / 3]) {
            let seeded: Vec<V<Dual64>> = (x.iter().enumerate())
                .map(|(i, x)| {
                    V::from_fn(|c, _| Dual64::new(x[c], f64::from(u8::from(3 * i + c == dof))))
                })
                .collect();
            let (energy, forces) = self.in_scalar(at, &seeded);
            gradient[dof] = energy.eps;
            for (i, f) in forces.iter().enumerate() {
                (0..3).for_each(|c| k[(3 * i + c, dof)] = f[c].eps);
            }
        }
        (gradient, k)
    }
}

pub fn combine(x: &[V<f64>], shape: &[f64]) -> V<f64> {
    (x.iter().zip(shape)).fold(V::zeros(), |s, (x, n)| s + x * *n)
}

fn on_facets(facets: &MovingFacets, q: &V<f64>) -> Option<Evaluated> {
    let master = MovingMaster {
        facets,
        undeformed: facets,
        depth: 1.0,
        keep: false,
    };
    let touch = (master.touch(
        q,
        (&mut None, Overhang::default()),
        &Hardening,
        &Exact,
        |_| true,
    ))
    .unwrap()?;
    let meeting = (master.meet(q, (&mut None, 0.0), 1.0, |_| true))
        .unwrap()
        .unwrap();
    let held = match meeting.geometry {
        PointGeometry::Edge { direction, .. } => Held::Edge(usize::from(direction[0] == 0.0)),
        PointGeometry::Vertex { .. } => Held::Vertex,
        _ => Held::Face,
    };
    Some(Evaluated {
        facet: touch.facet,
        xi: touch.xi,
        held,
        residual: touch.residual,
        tangent: touch.tangent,
    })
}

fn on_patch(points: &[V<f64>; 16], weights: &[f64; 16], q: &V<f64>) -> Option<Evaluated> {
    let xi = support::project(points, weights, q, [0.5; 2]);
    assert!(xi.iter().all(|x| (0.0..=1.0).contains(x)), "{xi:?}");
    let frame = Frame::new(&support::jet(points, weights, xi), 1.0)?;
    let xi3 = (q - frame.rho).dot(&frame.n);
    let geometry = PointGeometry::Face { frame, xi3 };
    let (residual, tangent) = respond(&geometry, &Hardening.response(xi3), &Exact);
    (xi3 < 0.0).then_some(Evaluated {
        facet: 0,
        xi,
        held: Held::Face,
        residual,
        tangent,
    })
}

/// A mesh of `count` x `count` facets with `order` + 1 nodes along their sides over the square [-1, 1]^2, nodes moved by
/// `shape`; node numbers with x fastest.
pub fn mesh(
    count: usize,
    order: usize,
    shape: impl Fn(f64, f64) -> V<f64>,
) -> (Vec<V<f64>>, Vec<Vec<u32>>) {
    let n = count * order + 1;
    let at = |i: usize| -1.0 + 2.0 * i as f64 / (n - 1) as f64;
    let nodes = (0..n * n).map(|k| shape(at(k % n), at(k / n))).collect();
    let m = order + 1;
    let facet = |e: usize| {
        let corner = order * (e % count) + n * order * (e / count);
        (0..m * m)
            .map(|k| (corner + k % m + n * (k / m)) as u32)
            .collect()
    };
    (nodes, (0..count * count).map(facet).collect())
}

/// The point at (u, v) in [-1, 1]^2 of a mesh of `count` x `count` facets, and `depth` below it along the mean normal of
/// the facets there: its foot is that point.
pub fn below(facets: &MovingFacets, count: u32, u: f64, v: f64, depth: f64) -> V<f64> {
    let places = |t: f64| {
        let along = 0.5 * (t + 1.0) * f64::from(count);
        (0..count)
            .map(move |i| (i, 2.0 * (along - f64::from(i)) - 1.0))
            .filter(|(_, xi)| xi.abs() <= 1.0)
    };
    let (mut rho, mut normal) = (V::zeros(), V::zeros());
    for (j, xi2) in places(v) {
        for (i, xi1) in places(u) {
            let jet = facets.jet(i + count * j, [xi1, xi2]);
            rho = jet.rho;
            normal += jet.rho_i[0].cross(&jet.rho_i[1]).normalize();
        }
    }
    rho - normal.normalize() * depth
}

/// Facets as they are.
pub fn plain(nodes: &[V<f64>], facets: &[Vec<u32>], order: usize) -> MovingFacets {
    let side = order as u8 + 1;
    let list: Vec<(&[u32], [u8; 2])> = facets.iter().map(|f| (&f[..], [side; 2])).collect();
    let mut facets = MovingFacets::new(&list).expect("a mesh");
    facets.update(|n| nodes[n as usize]);
    facets
}

/// `|a - b| / |b|` with a reference that must not vanish.
pub fn relative(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    let scale = b.norm();
    assert!(scale > 1e-3, "compared with nothing: {scale:e}");
    (a - b).norm() / scale
}
