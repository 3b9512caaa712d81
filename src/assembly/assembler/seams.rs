//! Seams between the patches of a body, one after the other, and springs that hold curves of trims.
use super::elements::pairs;
use super::{Assembler, Totals, put};
use crate::contact::law::PairLaw;
use crate::model::Model;
use crate::model::state::heap;
use crate::shell::{SEAM_DOFS, SEAM_NODES};
use covact_geometry::Vec3;

/// Places of the seams of all bodies in the matrix, then of all springs, and room for one.
#[derive(Debug, Default)]
pub(super) struct Seams {
    maps: Vec<u32>,
    tangent: Vec<f64>,
    /// Of a spring: nodes of the model, their displacements, forces.
    nodes: Vec<u32>,
    u: Vec<Vec3>,
    f: Vec<f64>,
}

/// Most nodes of a seam or a spring, and of a spring alone.
fn most(model: &Model) -> [usize; 2] {
    let bodies = || model.bodies.iter();
    let springs = bodies().flat_map(|b| b.block.anchors());
    let spring = springs.map(|s| s.nodes().len()).max().unwrap_or(0);
    let seams = bodies().any(|b| !b.block.seams().is_empty());
    [spring.max(if seams { SEAM_NODES } else { 0 }), spring]
}

impl Seams {
    pub fn new(model: &Model, maps: Vec<u32>) -> Seams {
        let [all, springs] = most(model);
        Seams {
            maps,
            tangent: vec![0.0; 9 * all * all],
            nodes: Vec::with_capacity(springs),
            u: Vec::with_capacity(springs),
            f: vec![0.0; 3 * springs],
        }
    }

    /// Bytes of heap for those of a model.
    pub fn size(model: &Model) -> usize {
        let [all, springs] = most(model);
        let places = model.bodies.iter().map(|b| {
            let own = b.block.anchors().iter().map(|s| pairs(s.nodes().len()));
            b.block.seams().len() * pairs(SEAM_NODES) + own.sum::<usize>()
        });
        let of_spring = size_of::<u32>() + size_of::<Vec3>() + 3 * size_of::<f64>();
        places.sum::<usize>() * size_of::<u32>()
            + 9 * all * all * size_of::<f64>()
            + springs * of_spring
    }

    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        heap(&self.maps) + heap(&self.tangent) + heap(&self.nodes) + heap(&self.u) + heap(&self.f)
    }

    /// Places on another pattern.
    pub fn place(&mut self, maps: Vec<u32>) {
        self.maps = maps;
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Adds forces, energy and, where asked for, the tangent of all seams and springs.
    pub(super) fn seams<const TANGENT: bool>(
        &mut self,
        u: &[f64],
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) {
        let mut at = 0;
        let mut f = [0.0; SEAM_DOFS];
        for body in &self.model.bodies {
            for seam in body.block.seams() {
                let nodes = seam.nodes.map(|n| n + body.first_node);
                let tangent = TANGENT.then_some(&mut self.seams.tangent[..]);
                totals.internal_energy += seam.evaluate(&displacements(u, &nodes), &mut f, tangent);
                let room = SEAM_DOFS * SEAM_DOFS;
                self.couple::<TANGENT>((&nodes, &f), (room, &mut at), increments, residual, rhs);
            }
        }
        let mut nodes = std::mem::take(&mut self.seams.nodes);
        let mut own = std::mem::take(&mut self.seams.u);
        let mut f = std::mem::take(&mut self.seams.f);
        for body in &self.model.bodies {
            for spring in body.block.anchors() {
                nodes.clear();
                nodes.extend(spring.nodes().iter().map(|n| n + body.first_node));
                own.clear();
                own.extend(
                    (nodes.iter()).map(|n| Vec3::from_column_slice(&u[3 * *n as usize..][..3])),
                );
                let dofs = 3 * nodes.len();
                let room = dofs * dofs;
                let tangent = TANGENT.then(|| &mut self.seams.tangent[..room]);
                totals.internal_energy += spring.evaluate(&own, &mut f[..dofs], tangent);
                let parts = (&nodes[..], &f[..dofs]);
                self.couple::<TANGENT>(parts, (room, &mut at), increments, residual, rhs);
            }
        }
        (self.seams.nodes, self.seams.u, self.seams.f) = (nodes, own, f);
    }

    /// Adds the forces `f` at `nodes` and the tangent of so much room; `at` is its place among all places in the matrix, and goes on
    /// to the next one.
    fn couple<const TANGENT: bool>(
        &mut self,
        (nodes, f): (&[u32], &[f64]),
        (room, at): (usize, &mut usize),
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
    ) {
        for (f, &n) in f.chunks_exact(3).zip(nodes) {
            (0..3).for_each(|c| residual[3 * n as usize + c] += f[c]);
        }
        if !TANGENT {
            return;
        }
        let count = pairs(nodes.len());
        let map = &self.seams.maps[*at..*at + count];
        *at += count;
        put(
            &mut self.matrix,
            self.dofs,
            &mut self.work,
            nodes,
            map,
            &mut self.seams.tangent[..room],
            increments,
            rhs,
        );
    }
}

/// Displacements of nodes.
fn displacements<const N: usize>(u: &[f64], nodes: &[u32; N]) -> [Vec3; N] {
    nodes.map(|n| Vec3::from_column_slice(&u[3 * n as usize..][..3]))
}
