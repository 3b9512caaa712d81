//! Friction of a pair with averaged gaps, summed up: every point of a face around a closed node has a history of its own, and the normal
//! traction that the nodes make of it ([`crate::contact::friction::given`]).
//!
//! The rank-one part of a node loses its symmetry: its traction changes by `N' / m_A c_A`, as without friction, and moves the residual
//! by the points around it, those that slide with their friction:
//!
//! ```text
//! K += sum_A N'(g_A) / m_A  f_A x c_A      f_A = sum_q w_q N_A(q) dr_q/dlambda
//! ```
use super::super::driven::DrivenBlock;
use super::super::touched;
use super::super::{Assembler, Totals};
use super::rubs::Rubs;
use super::{At, Averaged, NEAR, SurfaceForce};
use crate::contact::carried::carried_with_friction;
use crate::contact::friction::moving::Full;
use crate::contact::kernel::assemble_force;
use crate::contact::kind::TangentKind;
use crate::contact::law::PairLaw;
use crate::contact::moving::master_row;
use crate::contact::points::SlavePoint;
use crate::model::averaged::SlaveNodes;
use crate::model::driven::press;
use covact_geometry::Vec3;
use nalgebra::{Matrix3, Vector6};

impl<L: PairLaw> Assembler<'_, L> {
    /// Forces of the points with friction, and the part of the tangent under tractions of the nodes that stay.
    pub(super) fn rub_points<const TANGENT: bool>(
        &mut self,
        at: &At,
        own: &mut Averaged,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) {
        let (model, index, u) = (self.model, at.index, at.u);
        let pair = &model.pairs[index];
        let surface = pair.rigid_master();
        if let Some(ran) = &mut self.ran[index] {
            ran.tangent = TangentKind::Exact;
        }
        let Some(mut rubbing) = own.rubbing.take() else {
            return;
        };
        for (i, p) in pair.points.iter().enumerate() {
            let mut add = |node: usize, f: &Vec3| {
                for c in 0..3 {
                    residual[3 * node + c] += f[c];
                    self.contact[3 * node + c] += f[c];
                }
            };
            if let Some(given) = rubbing.rigid.get(i).and_then(touched::of) {
                let touch = &given.touch.touch;
                let (r, k) = (touch.residual * p.area, touch.tangent * p.area);
                if let Ok(Some(met)) = &own.met[i] {
                    own.directions[i] = met.steady(NEAR * pair.element_size).normal();
                }
                for (node, w) in p.terms() {
                    add(node, &(r * w));
                }
                if let Some(number) = surface {
                    totals.surfaces[number].add(&touch.x, &r);
                }
                let mut borders = self.borders.iter_mut();
                if let Some(border) = borders.find(|b| surface == Some(b.surface())) {
                    border.carry_rubbing::<TANGENT>(p, &r, &k, &(touch.x - at.center));
                }
                if TANGENT {
                    let count = p.count as usize;
                    let (nodes, shape) = (&p.nodes[..count], &p.shape[..count]);
                    self.put_point([index, i], nodes, shape, &k, at.increments, rhs);
                }
                continue;
            }
            let (Some(given), Some(body)) = (
                rubbing.moving.get(i).and_then(touched::of),
                self.masters.surface(index),
            ) else {
                continue;
            };
            let (touch, facets) = (&given.touch, &body.facets);
            own.directions[i] = touch.normal;
            let point = &mut rubbing.nodes;
            let count = p.count as usize;
            point.start(&p.nodes[..count], &p.shape[..count]);
            facets.curved_shape(touch.foot.patch, touch.foot.xi, &mut rubbing.shape);
            own.rows[i] = rubbing.shape.rows;
            point.facet(facets.nodes(touch.foot.patch), &rubbing.shape, true);
            let [slave, master] = totals.pairs[index].sides();
            for (k, (node, f)) in point.forces(&touch.response, p.area).enumerate() {
                add(node as usize, &f);
                let side: &mut SurfaceForce = match k < point.slave() {
                    true => slave,
                    false => master,
                };
                side.add(&model.position(node as usize, u), &f);
            }
            if TANGENT {
                if let Some(place) = touch.anchor {
                    facets.shape(place.patch, place.xi, &mut rubbing.anchor);
                    point.anchor(facets.nodes(place.patch), &rubbing.anchor);
                }
                let n = 3 * point.nodes().len();
                own.ke.resize(n * n, 0.0);
                point.assemble(&touch.response, p.area, &Full, &mut own.ke);
                own.keys.clear();
                own.keys.extend_from_slice(point.nodes());
                self.put_averaged(own, at.increments, rhs);
            }
        }
        own.rubbing = Some(rubbing);
    }

    /// The rank-one part of every closed node, which friction takes the symmetry from.
    pub(super) fn rub_nodes(
        &mut self,
        at: &At,
        (own, rubbing): (&mut Averaged, &mut Rubs),
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
            rubbing.forces.clear();
            // By translation and spin of a rigid master, and on them.
            let (mut motion, mut push) = (Vector6::zeros(), Vector6::zeros());
            for around in nodes.around(place) {
                let i = around.point as usize;
                if !own.carries[i] {
                    continue;
                }
                let p = &pair.points[i];
                let weight = around.shape * p.area;
                let g3 = own.directions[i] * weight;
                if let Some(given) = rubbing.rigid.get(i).and_then(touched::of) {
                    let f = given.by_traction * weight;
                    for (node, w) in p.terms() {
                        own.row.add(node as u32, g3 * w);
                        rubbing.forces.add(node as u32, f * w);
                    }
                    let arm = given.touch.touch.x - at.center;
                    press::add(&mut motion, &-g3, &g3.cross(&arm));
                    press::add(&mut push, &-f, &f.cross(&arm));
                    continue;
                }
                let (Some(given), Some(body)) = (
                    rubbing.moving.get(i).and_then(touched::of),
                    self.masters.surface(index),
                ) else {
                    continue;
                };
                let f = given.by_traction * weight;
                for (node, w) in p.terms() {
                    own.row.add(node as u32, g3 * w);
                    let force = assemble_force(&f, &[w, 0.0, 0.0]);
                    rubbing.forces.add(node as u32, force);
                }
                let masters = body.facets.nodes(given.touch.foot.patch).iter();
                for (k, node) in masters.enumerate() {
                    let row = master_row(&own.rows[i], k);
                    own.row.add(*node, g3 * row[0]);
                    rubbing.forces.add(*node, assemble_force(&f, &row));
                }
            }
            own.row.finish();
            rubbing.forces.finish();
            let scale = own.normals[place].dn / own.gaps[place].area;
            // Of the same nodes, in the same order.
            let (gaps, forces) = (own.row.entries(), rubbing.forces.entries());
            own.keys.clear();
            own.keys.extend(gaps.iter().map(|e| e.0));
            own.ke.clear();
            for column in 0..3 * gaps.len() {
                let by = scale * gaps[column / 3].1[column % 3];
                let rows = forces.iter().flat_map(|e| (0..3).map(move |c| by * e.1[c]));
                own.ke.extend(rows);
            }
            let mut borders = self.borders.iter_mut();
            if let Some(border) = borders.find(|b| surface == Some(b.surface())) {
                border.rubbed([gaps, forces], [&motion, &push], scale);
            }
            self.put_averaged(own, at.increments, rhs);
        }
    }
}

impl DrivenBlock {
    /// Adds a point with residual `r` and tangent `k`, which has no symmetry, at `arm` from the centre.
    fn carry_rubbing<const TANGENT: bool>(
        &mut self,
        p: &SlavePoint,
        r: &Vec3,
        k: &Matrix3<f64>,
        arm: &Vec3,
    ) {
        self.active += 1;
        let c = carried_with_friction(r, k, arm);
        press::add(&mut self.residual, &-r, &c.spin);
        if TANGENT {
            press::add_tangent(&mut self.tangent, k, &c);
            for (node, w) in p.terms() {
                let [translation, spin] = self.block(node);
                *translation -= k * w;
                *spin += c.point_spin * w;
                let [translation, spin] = self.below(node);
                *translation -= (k - k.transpose()) * w;
                *spin += (c.spin_point - c.point_spin.transpose()) * w;
            }
        }
    }

    /// Adds `scale f x c` with the entries of `c` and `f` at the slave's nodes, and the surface's own.
    fn rubbed(
        &mut self,
        [gaps, forces]: [&[(u32, Vec3)]; 2],
        [motion, push]: [&Vector6<f64>; 2],
        scale: f64,
    ) {
        let parts =
            |of: &Vector6<f64>| [0, 3].map(|i| Vec3::new(of[i], of[i + 1], of[i + 2]) * scale);
        let ([t, s], [force, moment]) = (parts(motion), parts(push));
        for ((node, c), (_, f)) in gaps.iter().zip(forces) {
            let [translation, spin] = self.block(*node as usize);
            *translation += f * t.transpose();
            *spin += f * s.transpose();
            let [translation, spin] = self.below(*node as usize);
            *translation += force * c.transpose() - t * f.transpose();
            *spin += moment * c.transpose() - s * f.transpose();
        }
        self.tangent += push * motion.transpose() * scale;
    }
}
