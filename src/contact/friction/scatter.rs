//! From the slots of a contact point with friction to the nodes of slave, facet and attraction point.
use super::moving::{Form, Response};
use covact_geometry::moving::MAX;
use covact_geometry::{CurvedRows, ShapeRows};
use nalgebra::{Matrix3, Vector3};

/// Most nodes of a point: of a slave face, the facet at the foot and the one of the attraction point.
pub const MOST: usize = 9 + 2 * MAX;

/// The nodes of a point, each once, with their places in its slots. A buffer that the caller owns.
#[derive(Debug, Clone)]
pub struct PointNodes {
    /// How many.
    count: usize,
    /// How many of them, the first, are the slave's.
    slave: usize,
    nodes: [u32; MOST],
    /// What of the generalised forces acts on a node: its factors in the slots of `dr_s - drho`, `drho_,1`, `drho_,2`, and
    /// of `drho_,11`, `drho_,12`, `drho_,22`.
    rows: [[f64; 6]; MOST],
    /// What a node moves: its factors in the slots at the foot, and in those at the attraction point.
    columns: [[f64; 6]; MOST],
}

impl Default for PointNodes {
    fn default() -> Self {
        PointNodes {
            count: 0,
            slave: 0,
            nodes: [0; MOST],
            rows: [[0.0; 6]; MOST],
            columns: [[0.0; 6]; MOST],
        }
    }
}

impl PointNodes {
    /// Takes the slave's nodes with their shape functions, at the foot and at an attraction point.
    ///
    /// # Panics
    /// If there are more than [`MOST`] nodes.
    pub fn start(&mut self, nodes: &[u32], shape: &[f64]) {
        self.count = nodes.len();
        self.slave = nodes.len();
        for (k, (node, n)) in nodes.iter().zip(shape).enumerate() {
            self.nodes[k] = *node;
            self.rows[k] = [*n, 0.0, 0.0, 0.0, 0.0, 0.0];
            self.columns[k] = [*n, 0.0, 0.0, *n, 0.0, 0.0];
        }
    }

    /// Adds the nodes of the facet at the foot. Where the traction acts on the slave alone (`pushed` is false) they have
    /// columns, but no rows.
    pub fn facet(&mut self, nodes: &[u32], shape: &CurvedRows, pushed: bool) {
        let rows = &shape.rows;
        for (k, node) in nodes.iter().enumerate() {
            let at = self.place(*node);
            let first = [-rows.n[k], rows.n_1[k], rows.n_2[k]];
            add(&mut self.columns[at][..3], &first);
            if pushed {
                add(&mut self.rows[at][..3], &first);
                let second = [shape.n_11[k], shape.n_12[k], shape.n_22[k]];
                add(&mut self.rows[at][3..], &second);
            }
        }
    }

    /// Adds the nodes of the facet of the attraction point.
    pub fn anchor(&mut self, nodes: &[u32], rows: &ShapeRows) {
        for (k, node) in nodes.iter().enumerate() {
            let at = self.place(*node);
            let first = [-rows.n[k], rows.n_1[k], rows.n_2[k]];
            add(&mut self.columns[at][3..], &first);
        }
    }

    /// The nodes.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.count]
    }

    /// Place of a node among those so far, new where it is not among them.
    fn place(&mut self, node: u32) -> usize {
        if let Some(at) = self.nodes().iter().position(|&n| n == node) {
            return at;
        }
        let at = self.count;
        self.count += 1;
        self.nodes[at] = node;
        self.rows[at] = [0.0; 6];
        self.columns[at] = [0.0; 6];
        at
    }

    /// Force on every node per unit of the generalised forces `r`, times `area`.
    pub fn forces<'a>(
        &'a self,
        response: &'a Response,
        area: f64,
    ) -> impl Iterator<Item = (u32, Vector3<f64>)> + 'a {
        let slot = |a: usize| response.residual.fixed_rows::<3>(3 * a).into_owned() * area;
        let slots = [0, 1, 2].map(slot);
        (self.nodes().iter().zip(&self.rows)).map(move |(node, w)| {
            let f = slots[0] * w[0] + slots[1] * w[1] + slots[2] * w[2];
            (*node, f)
        })
    }

    /// Element matrix of the point, column-major with dof `3 * place + component`, unsymmetric.
    ///
    /// # Panics
    /// If `ke` does not have `(3 n)^2` values for `n` nodes.
    pub fn assemble<M: Form>(&self, response: &Response, area: f64, _form: &M, ke: &mut [f64]) {
        let size = 3 * self.count;
        assert_eq!(ke.len(), size * size, "matrix of another size");
        let view = |k: &crate::contact::kernel::SlotMatrix, a: usize, b: usize| -> Matrix3<f64> {
            k.fixed_view::<3, 3>(3 * a, 3 * b).into_owned() * area
        };
        let blocks: [[Matrix3<f64>; 6]; 3] = std::array::from_fn(|a| {
            std::array::from_fn(|b| match b {
                0..3 => view(&response.tangent, a, b),
                _ => view(&response.anchor, a, b - 3),
            })
        });
        let lever = [1, 2].map(|i| response.residual.fixed_rows::<3>(3 * i).into_owned() * area);
        let part = |m: usize, b: usize| -> Vector3<f64> {
            response.travel[m].fixed_rows::<3>(3 * b).into_owned()
        };
        for (j, w) in self.columns[..self.count].iter().enumerate() {
            // What the six slots of the rows feel of the column's node.
            let mut felt: [Matrix3<f64>; 6] = [Matrix3::zeros(); 6];
            for (felt, blocks) in felt.iter_mut().zip(&blocks) {
                for (block, w) in blocks.iter().zip(w) {
                    *felt += block * *w;
                }
            }
            if M::FULL {
                let x = [0, 1].map(|m| part(m, 0) * w[0] + part(m, 1) * w[1] + part(m, 2) * w[2]);
                felt[3] = lever[0] * x[0].transpose();
                felt[4] = lever[0] * x[1].transpose() + lever[1] * x[0].transpose();
                felt[5] = lever[1] * x[1].transpose();
            }
            for c in 0..3 {
                let out = &mut ke[(3 * j + c) * size..][..size];
                let columns = felt.each_ref().map(|f| f.column(c));
                for (rows, w) in out.chunks_exact_mut(3).zip(&self.rows) {
                    for r in 0..3 {
                        let mut sum = columns[0][r] * w[0];
                        for a in 1..if M::FULL { 6 } else { 3 } {
                            sum += columns[a][r] * w[a];
                        }
                        rows[r] = sum;
                    }
                }
            }
        }
    }

    /// How many of the nodes, the first, are the slave's.
    pub fn slave(&self) -> usize {
        self.slave
    }
}

fn add(to: &mut [f64], what: &[f64; 3]) {
    for (to, what) in to.iter_mut().zip(what) {
        *to += what;
    }
}
