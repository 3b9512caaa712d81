//! Seams between the patches of a body, one after the other, and springs that hold curves of trims.
use super::elements::pairs;
use super::{Assembler, Totals, put};
use crate::contact::law::PairLaw;
use crate::model::state::heap;
use crate::shell::{ANCHOR_DOFS, ANCHOR_NODES, SEAM_DOFS, SEAM_NODES};
use covact_geometry::Vec3;

/// Places of the seams of all bodies in the matrix, then of all springs, and room for one.
#[derive(Debug, Default)]
pub(super) struct Seams {
    maps: Vec<u32>,
    tangent: Vec<f64>,
}

impl Seams {
    pub fn new(maps: Vec<u32>) -> Seams {
        let size = if maps.is_empty() {
            0
        } else {
            SEAM_DOFS * SEAM_DOFS
        };
        Seams {
            maps,
            tangent: vec![0.0; size],
        }
    }

    /// Bytes of heap for so many seams and springs.
    pub fn size(count: usize, springs: usize) -> usize {
        let room = if count + springs > 0 {
            SEAM_DOFS * SEAM_DOFS
        } else {
            0
        };
        let places = count * pairs(SEAM_NODES) + springs * pairs(ANCHOR_NODES);
        places * size_of::<u32>() + room * size_of::<f64>()
    }

    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        heap(&self.maps) + heap(&self.tangent)
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
        let mut f = [0.0; ANCHOR_DOFS];
        for body in &self.model.bodies {
            for spring in body.block.anchors() {
                let nodes = spring.nodes.map(|n| n + body.first_node);
                let room = ANCHOR_DOFS * ANCHOR_DOFS;
                let tangent = TANGENT.then(|| &mut self.seams.tangent[..room]);
                totals.internal_energy +=
                    spring.evaluate(&displacements(u, &nodes), &mut f, tangent);
                self.couple::<TANGENT>((&nodes, &f), (room, &mut at), increments, residual, rhs);
            }
        }
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
