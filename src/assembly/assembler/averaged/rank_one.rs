//! The rank-one part of closed nodes: all nodes that a gap hangs on, with each other.
use super::super::driven::DrivenBlock;
use super::super::{Assembler, put};
use super::{At, Averaged, facet};
use crate::contact::law::PairLaw;
use crate::model::averaged::SlaveNodes;
use crate::model::driven::press;
use covact_geometry::Vec3;
use nalgebra::Vector6;

impl<L: PairLaw> Assembler<'_, L> {
    /// The rank-one part of every closed node.
    pub(super) fn rank_one(
        &mut self,
        at: &At,
        own: &mut Averaged,
        nodes: &SlaveNodes,
        rhs: &mut [f64],
    ) {
        let (model, index) = (self.model, at.index);
        let pair = &model.pairs[index];
        let surface = pair.rigid_master();
        for place in 0..nodes.len() {
            if !own.closed(place) {
                continue;
            }
            own.row.clear();
            // Derivative by translation and spin of a rigid master.
            let mut motion = Vector6::zeros();
            for around in nodes.around(place) {
                let i = around.point as usize;
                let (true, Ok(Some(met))) = (own.carries[i], &own.met[i]) else {
                    continue;
                };
                let p = &pair.points[i];
                let g3 = own.directions[i] * (around.shape * p.area);
                for (node, w) in p.terms() {
                    own.row.add(node as u32, g3 * w);
                }
                match (facet(met), self.masters.surface(index)) {
                    (Some(facet), Some(body)) => {
                        let masters = body.facets.nodes(facet).iter();
                        for (node, w) in masters.zip(&own.rows[i].n) {
                            own.row.add(*node, g3 * -w);
                        }
                    }
                    _ => {
                        let arm = model.point_position(p, at.u) - at.center;
                        press::add(&mut motion, &-g3, &g3.cross(&arm));
                    }
                }
            }
            own.row.finish();
            let scale = own.normals[place].dn / own.gaps[place].area;
            let entries = own.row.entries();
            own.keys.clear();
            own.keys.extend(entries.iter().map(|e| e.0));
            let n = 3 * entries.len();
            own.ke.clear();
            for column in 0..n {
                let by = scale * entries[column / 3].1[column % 3];
                own.ke
                    .extend(entries.iter().flat_map(|e| (0..3).map(|c| by * e.1[c])));
            }
            let mut borders = self.borders.iter_mut();
            if let Some(border) = borders.find(|b| surface == Some(b.surface())) {
                border.rank_one(entries, &motion, scale);
            }
            self.put_averaged(own, at.increments, rhs);
        }
    }

    /// Scatters the matrix of the nodes in `keys`.
    pub(super) fn put_averaged(
        &mut self,
        own: &mut Averaged,
        increments: Option<&[f64]>,
        rhs: &mut [f64],
    ) {
        own.map.clear();
        (self.matrix.pattern())
            .element_map(&own.keys, &mut own.map)
            .expect("the pattern was built with every facet that the points around a node meet");
        put(
            &mut self.matrix,
            self.dofs,
            &mut self.work,
            &own.keys,
            &own.map,
            &mut own.ke,
            increments,
            rhs,
        );
    }
}

impl DrivenBlock {
    /// Adds `scale c x c` with the entries of `c` at the slave's nodes and the surface's own.
    fn rank_one(&mut self, entries: &[(u32, Vec3)], motion: &Vector6<f64>, scale: f64) {
        let [t, s] = [0, 3].map(|i| Vec3::new(motion[i], motion[i + 1], motion[i + 2]) * scale);
        for (node, v) in entries {
            let [translation, spin] = self.block(*node as usize);
            *translation += v * t.transpose();
            *spin += v * s.transpose();
        }
        self.tangent += motion * motion.transpose() * scale;
    }
}
