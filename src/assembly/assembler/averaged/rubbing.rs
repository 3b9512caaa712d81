//! Friction of a pair with averaged gaps: every point of a face around a closed node has a history of its own, and the normal
//! traction that the nodes make of it ([`crate::contact::friction::given`]).
//!
//! The rank-one part of a node loses its symmetry: its traction changes by `N' / m_A c_A`, as without friction, and moves the residual
//! by the points around it, those that slide with their friction:
//!
//! ```text
//! K += sum_A N'(g_A) / m_A  f_A x c_A      f_A = sum_q w_q N_A(q) dr_q/dlambda
//! ```
use super::super::driven::DrivenBlock;
use super::super::sliding::Slides;
use super::super::touched;
use super::super::{Assembler, Fault, Totals};
use super::{At, Averaged, NEAR, SurfaceForce, facet};
use crate::contact::averaged::{self, GapRow};
use crate::contact::carried::carried_with_friction;
use crate::contact::fault::PointFault;
use crate::contact::friction::given::{Drawn, GivenMoving, GivenRigid, Pressed};
use crate::contact::friction::history::PointHistory;
use crate::contact::friction::law::{FrictionLaw, Slip};
use crate::contact::friction::moving::Full;
use crate::contact::friction::rigid::Friction;
use crate::contact::friction::scatter::PointNodes;
use crate::contact::friction::turning::Turning;
use crate::contact::kernel::assemble_force;
use crate::contact::kind::TangentKind;
use crate::contact::law::PairLaw;
use crate::contact::meeting::Meeting;
use crate::contact::moving::{MovingMaster, master_row};
use crate::contact::points::SlavePoint;
use crate::model::averaged::{Share, SlaveNodes};
use crate::model::driven::press;
use crate::model::friction::{LawNow, with_law};
use crate::model::state::heap;
use crate::model::{Model, PairModel};
use covact_geometry::{CurvedRows, Hint, ShapeRows, Vec3};
use nalgebra::{Isometry3, Matrix3, Vector6};
use rayon::prelude::*;

/// A point that carries; nothing where it does not.
type Found<T> = Result<Option<T>, PointFault>;

/// The points of a pair at the state evaluated last: those that carry. One of the lists is empty, by the kind of the master.
#[derive(Default)]
pub(in crate::assembly::assembler) struct Rubs {
    rigid: Vec<Found<GivenRigid>>,
    moving: Vec<Found<GivenMoving>>,
    nodes: PointNodes,
    shape: CurvedRows,
    anchor: ShapeRows,
    /// What a node's traction makes of the residual.
    forces: GapRow,
}

impl Rubs {
    /// Bytes of heap for each point of a pair, and for all of it at the start; nothing where this is not for the pair.
    pub fn sizes(pair: &PairModel) -> Option<[usize; 2]> {
        (pair.averaged.as_ref()).and(pair.friction.as_ref())?;
        let point = match pair.body_master() {
            None => size_of::<Found<GivenRigid>>(),
            Some(_) => size_of::<Found<GivenMoving>>(),
        };
        Some([point, size_of::<Rubs>()])
    }

    /// Bytes of heap that it holds, and its own.
    pub fn bytes(&self) -> usize {
        let Rubs {
            rigid,
            moving,
            nodes: _,
            shape: _,
            anchor: _,
            forces,
        } = self;
        size_of::<Rubs>() + heap(rigid) + heap(moving) + forces.bytes()
    }

    /// Room for a pair; nothing without friction.
    pub fn new(pair: &PairModel) -> Option<Box<Self>> {
        pair.friction.as_ref()?;
        let points = pair.points.len();
        let mut out = Rubs::default();
        match pair.body_master() {
            None => out.rigid = vec![Ok(None); points],
            Some(_) => out.moving = vec![Ok(None); points],
        }
        Some(Box::new(out))
    }
}

/// The slave points of a pair at a state whose nodes are known.
struct Batch<'a> {
    model: &'a Model,
    pair: &'a PairModel,
    u: &'a [f64],
    own: &'a Averaged,
    eps_t: f64,
    slides: Slides,
}

impl Batch<'_> {
    /// Evaluates every point that carries.
    fn each<F: FrictionLaw, T: Send + Sync>(
        &self,
        law: F,
        histories: &[PointHistory],
        (found, slips): (&mut [Found<T>], &mut [Turning]),
        touch: impl Touching<T>,
        slip_of: impl Fn(&T) -> &Slip + Sync,
    ) {
        let Some(nodes) = &self.pair.averaged else {
            return;
        };
        let (own, small) = (self.own, NEAR * self.pair.element_size);
        let friction = Friction {
            law,
            eps_t: self.eps_t,
        };
        let drawn = Friction {
            law: Drawn,
            eps_t: self.eps_t,
        };
        (self.pair.points.par_iter())
            .zip(found.par_iter_mut())
            .zip(slips.par_iter_mut())
            .zip(histories)
            .enumerate()
            .with_min_len(32)
            .for_each(|(i, (((p, out), slip), history))| {
                let (true, Share::Gap(gap), Ok(Some(met))) =
                    (own.carries[i], own.shares[i], &own.met[i])
                else {
                    *out = Ok(None);
                    if self.slides.note {
                        slip.note(None);
                    }
                    return;
                };
                let lambda = own.traction(nodes, i, p);
                let pressed = Pressed {
                    x: &self.model.point_position(p, self.u),
                    geometry: &met.steady(small),
                    gap,
                    lambda,
                };
                let presses = lambda < 0.0;
                *out = match presses {
                    true => {
                        let secant = friction.sliding(self.slides.slide, slip);
                        touch.touch(&pressed, met, &secant, history)
                    }
                    false => touch.touch(&pressed, met, &drawn, history),
                }
                .map(Some);
                if self.slides.note {
                    slip.note(touched::of(out).filter(|_| presses).map(&slip_of));
                }
            });
    }
}

/// Evaluates a point on a kind of master, under any law.
trait Touching<T>: Sync {
    fn touch<F: FrictionLaw>(
        &self,
        pressed: &Pressed,
        met: &Meeting,
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> Result<T, PointFault>;
}

impl Touching<GivenRigid> for Isometry3<f64> {
    fn touch<F: FrictionLaw>(
        &self,
        pressed: &Pressed,
        _met: &Meeting,
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> Result<GivenRigid, PointFault> {
        Ok(pressed.on_rigid(self, friction, history))
    }
}

impl Touching<GivenMoving> for MovingMaster<'_> {
    fn touch<F: FrictionLaw>(
        &self,
        pressed: &Pressed,
        met: &Meeting,
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> Result<GivenMoving, PointFault> {
        let foot = Hint {
            patch: facet(met).unwrap_or_default(),
            xi: met.xi,
        };
        pressed.on_body(self, foot, friction, history)
    }
}

impl Averaged {
    /// Bytes of heap that friction holds.
    pub fn rubs(&self) -> usize {
        self.rubbing.as_ref().map_or(0, |r| r.bytes())
    }

    /// Normal traction of a point.
    fn traction(&self, nodes: &SlaveNodes, i: usize, p: &SlavePoint) -> f64 {
        averaged::traction(nodes.terms(i, p).map(|(a, w)| (w, self.normals[a].n)))
    }

    /// Evaluates the points of a pair on a rigid master in this pose, once its nodes are known.
    pub(super) fn rub_rigid(
        &mut self,
        (model, pair, u): (&Model, &PairModel, &[f64]),
        pose: &Isometry3<f64>,
        (law, eps_t, slides): (LawNow, f64, Slides),
        histories: &[PointHistory],
        slips: &mut [Turning],
    ) {
        let Some(mut rubbing) = self.rubbing.take() else {
            return;
        };
        let batch = Batch {
            model,
            pair,
            u,
            own: self,
            eps_t,
            slides,
        };
        let found = (&mut rubbing.rigid[..], slips);
        with_law!(law, law => {
            batch.each(law, histories, found, *pose, |t: &GivenRigid| &t.touch.traction.slip);
        });
        self.rubbing = Some(rubbing);
    }

    /// Evaluates the points of a pair on faces of a body, once its nodes are known.
    ///
    /// # Errors
    /// That of the first point that has one.
    pub(super) fn rub_bodies(
        &mut self,
        (model, pair, u): (&Model, &PairModel, &[f64]),
        facets: &MovingMaster,
        (law, eps_t, slides): (LawNow, f64, Slides),
        histories: &[PointHistory],
        slips: &mut [Turning],
    ) -> Result<(), Fault> {
        let Some(mut rubbing) = self.rubbing.take() else {
            return Ok(());
        };
        let batch = Batch {
            model,
            pair,
            u,
            own: self,
            eps_t,
            slides,
        };
        let found = (&mut rubbing.moving[..], slips);
        with_law!(law, law => {
            batch.each(law, histories, found, *facets, |t: &GivenMoving| &t.touch.response.slip);
        });
        let fault =
            (rubbing.moving.iter().enumerate()).find_map(|(i, f)| Some((i, *f.as_ref().err()?)));
        self.rubbing = Some(rubbing);
        match fault {
            None => Ok(()),
            Some((i, fault)) => {
                let x = model.point_position(&pair.points[i], u);
                Err(Fault::contact(pair, i, &x, fault))
            }
        }
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Forces of the points with friction, and the part of the tangent under tractions of the nodes that stay.
    pub(super) fn rub_points<const TANGENT: bool>(
        &mut self,
        at: &At,
        own: &mut Averaged,
        nodes: &SlaveNodes,
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
        debug_assert_eq!(nodes.len(), own.normals.len());
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

    /// The points of a pair with averaged gaps and friction at the state evaluated last; nothing for others.
    pub fn rubbed_points(&self, index: usize) -> Option<RubbedPoints<'_, L>> {
        let own = self.averaged.get(index)?;
        Some(RubbedPoints {
            own,
            rubbing: own.rubbing.as_ref()?,
            pair: &self.model.pairs[index],
            law: L::of(self.penalties[index]),
        })
    }
}

/// What slave points with averaged gaps and friction did at a state.
pub struct RubbedPoints<'a, L> {
    own: &'a Averaged,
    rubbing: &'a Rubs,
    pair: &'a PairModel,
    law: L,
}

impl<L: PairLaw> RubbedPoints<'_, L> {
    /// A point that is pressed against a rigid master.
    pub fn rigid(&self, point: usize) -> Option<&GivenRigid> {
        let found = touched::of(self.rubbing.rigid.get(point)?)?;
        (found.touch.touch.n < 0.0).then_some(found)
    }

    /// A point that is pressed against faces of a body.
    pub fn moving(&self, point: usize) -> Option<&GivenMoving> {
        let found = touched::of(self.rubbing.moving.get(point)?)?;
        (found.touch.n < 0.0).then_some(found)
    }

    /// What the law would make of a point that is pressed no more: the tractions of its nodes, those of open ones continued above the
    /// surface, zero at least (force / length^2).
    pub fn beyond(&self, point: usize) -> f64 {
        let Some(nodes) = &self.pair.averaged else {
            return 0.0;
        };
        let at = |a: usize| (self.own.gaps[a].gap()).map_or(0.0, |gap| self.law.response(gap).n);
        let terms = nodes.terms(point, &self.pair.points[point]);
        averaged::traction(terms.map(|(a, w)| (w, at(a)))).max(0.0)
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
