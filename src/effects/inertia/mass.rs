//! Consistent mass: a number for every pair of nodes of an element, the same along all axes and throughout a run.
use crate::effects::Tangent;
use crate::model::state::heap;
use crate::model::{BodyModel, Model};

/// Nodes of the largest element.
const MOST: usize = 18;

/// Pairs of `n` nodes, each counted once.
const fn pairs(n: usize) -> usize {
    n * (n + 1) / 2
}

/// Mass of all bodies: `rho int N_a N_b dV` over the undeformed elements.
#[derive(Debug, Clone, PartialEq)]
pub struct Mass {
    /// Element after element, the pairs of each in the order of the lower triangle by columns, as in maps of elements.
    pairs: Vec<f64>,
}

impl Mass {
    /// Of bodies with these densities.
    pub fn new(model: &Model, densities: &[f64]) -> Mass {
        let mut all = Vec::with_capacity(model.bodies.iter().map(numbers).sum());
        for (body, density) in model.bodies.iter().zip(densities) {
            let mesh = &body.mesh;
            for e in 0..mesh.elements() {
                let first = all.len();
                all.resize(first + pairs(mesh.kind.nodes()), 0.0);
                mesh.for_volume_points(e, |shapes, volume| {
                    let mut own = all[first..].iter_mut();
                    for (b, column) in shapes.iter().enumerate() {
                        for (row, m) in shapes[b..].iter().zip(&mut own) {
                            *m += density * volume * row * column;
                        }
                    }
                });
            }
        }
        Mass { pairs: all }
    }

    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        heap(&self.pairs)
    }

    /// Bytes that an element of a body takes.
    pub fn of_element(body: &BodyModel) -> usize {
        size_of::<f64>() * pairs(body.mesh.kind.nodes())
    }

    /// `out += M x`.
    pub fn add_product(&self, model: &Model, x: &[f64], out: &mut [f64]) {
        self.for_elements(model, |nodes, own| {
            let mut at = own.iter();
            for b in 0..nodes.len() {
                let j = 3 * nodes[b] as usize;
                for (a, m) in (b..nodes.len()).zip(&mut at) {
                    let i = 3 * nodes[a] as usize;
                    for c in 0..3 {
                        out[i + c] += m * x[j + c];
                        if a != b {
                            out[j + c] += m * x[i + c];
                        }
                    }
                }
            }
        });
    }

    /// Adds `factor M` to a tangent, with what prescribed increments make of it.
    pub fn add_tangent(&self, model: &Model, factor: f64, to: &mut Tangent<'_>) {
        let mut dense = Vec::new();
        let mut first = 0;
        let maps = to.maps;
        self.for_elements(model, |nodes, own| {
            let map = &maps[first..first + own.len()];
            first += own.len();
            if !to.dofs.constrains(nodes) {
                to.matrix.scatter_scalars(map, own, factor);
                return;
            }
            let size = 3 * nodes.len();
            dense.clear();
            dense.resize(size * size, 0.0);
            let mut at = own.iter();
            for b in 0..nodes.len() {
                for (a, m) in (b..nodes.len()).zip(&mut at) {
                    for c in 0..3 {
                        dense[(3 * b + c) * size + 3 * a + c] = factor * m;
                        dense[(3 * a + c) * size + 3 * b + c] = factor * m;
                    }
                }
            }
            if let Some(g) = to.increments {
                to.dofs.subtract_prescribed(nodes, &dense, g, to.rhs);
            }
            (to.matrix)
                .scatter_constrained(nodes, &dense, to.dofs, to.work)
                .expect("the pattern holds every element with what it is tied to");
        });
    }

    /// Calls `with` with the nodes and the numbers of every element.
    fn for_elements(&self, model: &Model, mut with: impl FnMut(&[u32], &[f64])) {
        let mut nodes = [0; MOST];
        let mut first = 0;
        for body in &model.bodies {
            let count = body.mesh.kind.nodes();
            for e in 0..body.mesh.elements() {
                for (node, own) in nodes.iter_mut().zip(body.element_nodes(e)) {
                    *node = own;
                }
                let own = &self.pairs[first..first + pairs(count)];
                first += own.len();
                with(&nodes[..count], own);
            }
        }
    }
}

/// Numbers that the elements of a body take.
fn numbers(body: &BodyModel) -> usize {
    pairs(body.mesh.kind.nodes()) * body.mesh.elements()
}
