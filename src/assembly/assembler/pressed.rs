//! Slave points in contact with a rigid surface, summed one after the other.
use super::maps::PointMaps;
use super::{Assembler, SurfaceForce, Totals};
use crate::contact::law::{NormalLaw, PairLaw};
use crate::contact::lever;
use crate::contact::points::SlavePoint;
use crate::contact::rigid::Touch;
use crate::model::Model;
use crate::system::{ConstrainedScatter, DofMap, SystemMatrix};
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// Degrees of freedom of a point at a height above a mid-surface.
const LEVER: usize = 3 * lever::NODES;

/// Where the points of a pair go.
pub(super) struct Pressed<'a, L> {
    /// Between gap and traction.
    pub law: L,
    pub residual: &'a mut [f64],
    /// Contact forces alone.
    pub contact: &'a mut [f64],
    pub matrix: &'a mut SystemMatrix,
    pub maps: &'a PointMaps,
    pub dofs: &'a DofMap,
    pub work: &'a mut ConstrainedScatter,
    pub increments: Option<&'a [f64]>,
    pub rhs: &'a mut [f64],
    pub sums: PressedSums,
    pub model: &'a Model,
    /// Displacements.
    pub u: &'a [f64],
}

/// What the points of a pair sum up to.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PressedSums {
    pub on: SurfaceForce,
    pub energy: f64,
    /// Deepest penetration, `>= 0`.
    pub deepest: f64,
    pub active: usize,
}

impl PressedSums {
    /// Ends a pair whose master is surface `number`.
    pub fn note(&self, number: usize, totals: &mut Totals) {
        let on = &mut totals.surfaces[number];
        on.force += self.on.force;
        on.moment += self.on.moment;
        totals.contact_energy += self.energy;
        totals.active += self.active;
        totals.penetration.push(self.deepest);
        totals.touching.push(self.active > 0);
    }
}

impl<L: NormalLaw> Pressed<'_, L> {
    /// Adds point `index` of the pair. The number of its nodes is known to the compiler for all faces but rare ones, so that
    /// the loops over nodes are none.
    #[inline(always)]
    pub fn add<const TANGENT: bool>(&mut self, index: usize, p: &SlavePoint, touch: &Touch) {
        match p.count {
            1 => self.add_nodes::<TANGENT>(index, p, 1, touch),
            4 => self.add_nodes::<TANGENT>(index, p, 4, touch),
            9 => self.add_nodes::<TANGENT>(index, p, 9, touch),
            0 => self.add_lever::<TANGENT>(index, p, touch),
            n => self.add_nodes::<TANGENT>(index, p, n as usize, touch),
        }
    }

    #[inline(always)]
    fn add_nodes<const TANGENT: bool>(
        &mut self,
        index: usize,
        p: &SlavePoint,
        count: usize,
        touch: &Touch,
    ) {
        let (nodes, shape) = (&p.nodes[..count], &p.shape[..count]);
        let force = self.count(p, touch);
        for (node, w) in nodes.iter().zip(shape) {
            let at = 3 * *node as usize;
            let f = force * *w;
            for (out, f) in self.residual[at..at + 3].iter_mut().zip(f.iter()) {
                *out += f;
            }
            for (out, f) in self.contact[at..at + 3].iter_mut().zip(f.iter()) {
                *out += f;
            }
        }
        if !TANGENT {
            return;
        }
        let k = touch.tangent * p.area;
        match self.maps.plain(index, count) {
            Some(places) => self.matrix.scatter_point(places, shape, &k),
            None => add_constrained(
                self.matrix,
                self.dofs,
                self.work,
                nodes,
                shape,
                &k,
                self.increments,
                self.rhs,
            ),
        }
    }
}

impl<L: NormalLaw> Pressed<'_, L> {
    /// Takes a point into the sums; returns its force.
    #[inline(always)]
    fn count(&mut self, p: &SlavePoint, touch: &Touch) -> Vec3 {
        let force = touch.residual * p.area;
        let sums = &mut self.sums;
        sums.active += 1;
        sums.deepest = sums.deepest.max(-touch.gap);
        sums.energy += self.law.energy(touch.gap) * p.area;
        sums.on.force -= force;
        sums.on.moment -= touch.x.cross(&force);
        force
    }

    /// Adds a point at a height above a mid-surface.
    #[cold]
    #[inline(never)]
    fn add_lever<const TANGENT: bool>(&mut self, index: usize, p: &SlavePoint, touch: &Touch) {
        let force = self.count(p, touch);
        let lever = &self.model.levers[p.nodes[0] as usize];
        let position = |n: u32| self.model.position(n as usize, self.u);
        let k = touch.tangent * p.area;
        let mut ke = [0.0; LEVER * LEVER];
        let tangent = TANGENT.then_some((&k, &mut ke[..]));
        let forces = lever.spread(position, &force, tangent);
        for (node, f) in lever.nodes.iter().zip(&forces) {
            let at = 3 * *node as usize;
            for (c, f) in f.iter().enumerate() {
                self.residual[at + c] += f;
                self.contact[at + c] += f;
            }
        }
        if !TANGENT {
            return;
        }
        match self.maps.plain(index, lever.nodes.len()) {
            Some(map) => self.matrix.scatter(map, &ke),
            None => {
                if let Some(g) = self.increments {
                    (self.dofs).subtract_prescribed(&lever.nodes, &ke, g, self.rhs);
                }
                self.matrix
                    .scatter_constrained(&lever.nodes, &ke, self.dofs, self.work)
                    .expect("the pattern holds the element whose face the point is on");
            }
        }
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Adds the tangent `k` of point `index` of a pair, whose master is rigid.
    pub(super) fn put_point(
        &mut self,
        [pair, index]: [usize; 2],
        nodes: &[u32],
        shape: &[f64],
        k: &Matrix3<f64>,
        increments: Option<&[f64]>,
        rhs: &mut [f64],
    ) {
        let maps = self.point_maps.get(pair);
        match maps.and_then(|maps| maps.plain(index, nodes.len())) {
            Some(places) => self.matrix.scatter_point(places, shape, k),
            None => add_constrained(
                &mut self.matrix,
                self.dofs,
                &mut self.work,
                nodes,
                shape,
                k,
                increments,
                rhs,
            ),
        }
    }
}

/// Adds the tangent of a point with nodes that are prescribed or tied, or with a node that occurs twice.
#[cold]
#[inline(never)]
#[expect(clippy::too_many_arguments)]
fn add_constrained(
    matrix: &mut SystemMatrix,
    dofs: &DofMap,
    work: &mut ConstrainedScatter,
    nodes: &[u32],
    shape: &[f64],
    k: &Matrix3<f64>,
    increments: Option<&[f64]>,
    rhs: &mut [f64],
) {
    let size = 3 * nodes.len();
    let mut ke = [0.0; 729];
    for (b, wb) in shape.iter().enumerate() {
        for (a, wa) in shape.iter().enumerate() {
            for c in 0..3 {
                for r in 0..3 {
                    ke[(3 * b + c) * size + 3 * a + r] = wa * wb * k[(r, c)];
                }
            }
        }
    }
    let ke = &mut ke[..size * size];
    if let Some(g) = increments {
        dofs.subtract_prescribed(nodes, ke, g, rhs);
    }
    matrix
        .scatter_constrained(nodes, ke, dofs, work)
        .expect("the pattern holds faces, which lie in elements, and what contact couples");
}
