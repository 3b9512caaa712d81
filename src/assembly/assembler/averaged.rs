//! Contact with averaged gaps: the closest points of a pair are found in parallel, then everything is summed in order.
//!
//! A closed node couples all slave nodes of the faces around it with each other, and with all master nodes that the
//! points of these faces meet: the rank-one part of [`crate::contact::averaged`].
mod groups;
mod masters;
mod rank_one;
mod rubbing;
mod rubs;

use super::answer::PointAnswer;
use super::driven::DrivenBlock;
use super::per_pair::PerPair;
use super::rigid::rounding;
use super::{Assembler, Fault, SurfaceForce, Totals};
use crate::contact::averaged::{self, GapRow, NodalGap};
use crate::contact::carried::carried;
use crate::contact::fault::{Piece, PointFault};
use crate::contact::friction::history::PointHistory;
use crate::contact::kernel::{Normal, assemble_force};
use crate::contact::kind::{LawKind, TangentKind};
use crate::contact::law::{NoOffset, NormalLaw, PairLaw, PointLaw};
use crate::contact::meeting::Meeting;
use crate::contact::point::FaceTangent;
use crate::contact::points::SlavePoint;
use crate::contact::rigid::Exact;
use crate::contact::scatter::assemble_point;
use crate::model::averaged::{Share, SlaveNodes};
use crate::model::driven::press;
use crate::model::state::{PointState, State, heap};
use crate::model::{Model, PairModel};
use covact_geometry::{Hint, ShapeRows, Vec3};
pub(super) use groups::groups;
use nalgebra::Matrix3;
use rayon::prelude::*;
pub use rubs::RubbedPoints;
pub(super) use rubs::Rubs;

/// On an edge or a corner nearer than this part of an element the direction of the distance is not looked at.
const NEAR: f64 = 1e-6;

/// A pair with averaged gaps at the state evaluated last, and room for its matrices.
#[derive(Default)]
pub(super) struct Averaged {
    met: Vec<Result<Option<Meeting>, PointFault>>,
    shares: Vec<Share>,
    /// Per point: it has a gap and a closed node.
    carries: Vec<bool>,
    /// Per point that carries: the derivative of its gap.
    directions: Vec<Vec3>,
    /// Per point that carries: shape functions of the master; none where it is rigid.
    rows: Vec<ShapeRows>,
    gaps: Vec<NodalGap>,
    normals: Vec<Normal>,
    row: GapRow,
    keys: Vec<u32>,
    map: Vec<u32>,
    ke: Vec<f64>,
    /// With friction.
    rubbing: Option<Box<Rubs>>,
}

impl Averaged {
    /// Bytes of heap for each point of a pair, for each slave node, and for all of it at the start.
    pub fn sizes(pair: &PairModel) -> [usize; 3] {
        let met = size_of::<Result<Option<Meeting>, PointFault>>();
        let own = met + size_of::<Share>() + size_of::<bool>() + size_of::<Vec3>();
        let rows = match pair.body_master() {
            Some(_) => size_of::<ShapeRows>(),
            None => 0,
        };
        let node = size_of::<NodalGap>() + size_of::<Normal>();
        [own + rows, node, PerPair::<Averaged>::HEAD]
    }

    /// Bytes of heap that it holds, those of friction left out.
    pub fn bytes(&self) -> usize {
        let Averaged {
            met,
            shares,
            carries,
            directions,
            rows,
            gaps,
            normals,
            row,
            keys,
            map,
            ke,
            rubbing: _,
        } = self;
        let points = heap(met) + heap(shares) + heap(carries) + heap(directions) + heap(rows);
        let nodes = heap(gaps) + heap(normals);
        points + nodes + row.bytes() + heap(keys) + heap(map) + heap(ke)
    }

    /// Room for a pair; nothing where its gaps are those of the points.
    pub fn new(pair: &PairModel) -> Option<Self> {
        let nodes = pair.averaged.as_ref()?;
        let points = pair.points.len();
        let moving = if pair.body_master().is_some() {
            points
        } else {
            0
        };
        Some(Averaged {
            met: vec![Ok(None); points],
            shares: vec![Share::Nothing; points],
            carries: vec![false; points],
            directions: vec![Vec3::zeros(); points],
            rows: vec![ShapeRows::default(); moving],
            gaps: vec![NodalGap::default(); nodes.len()],
            normals: vec![Normal { n: 0.0, dn: 0.0 }; nodes.len()],
            row: GapRow::default(),
            keys: Vec::new(),
            map: Vec::new(),
            ke: Vec::new(),
            rubbing: Rubs::new(pair),
        })
    }

    /// Finds the closest point of every slave point, and from them the gaps and tractions of the nodes; `histories` have the
    /// multipliers of these, and are empty where they have none. `find` is given the hint of a point and, where points `keep` their
    /// facets, the penetration that its traction stands for.
    pub fn meet<L: PairLaw, F>(
        &mut self,
        model: &Model,
        pair: &PairModel,
        (law, histories): (&L, &[PointHistory]),
        (u, time, keep): (&[f64], f64, bool),
        states: &mut [PointState],
        find: F,
    ) -> Result<LawKind, Fault>
    where
        F: Fn(usize, &Vec3, (&mut Option<Hint>, f64)) -> Result<Option<Meeting>, PointFault> + Sync,
    {
        let Some(nodes) = &pair.averaged else {
            return Ok(LawKind::Penalty);
        };
        // Those of the linearisation before, asked for only where points keep their facets.
        let gaps = &self.gaps;
        let sunk = |i: usize, p: &SlavePoint| match keep {
            true => (nodes.terms(i, p).filter_map(|(at, _)| gaps[at].gap()))
                .fold(0.0, |most, gap| (-gap).max(most)),
            false => 0.0,
        };
        (pair.points.par_iter())
            .zip(states.par_iter_mut())
            .zip(self.met.par_iter_mut())
            .enumerate()
            .with_min_len(32)
            .for_each(|(i, ((p, s), out))| {
                *out = find(i, &model.point_position(p, u), (&mut s.hint, sunk(i, p)));
            });
        let fault = |point: usize, fault: PointFault| {
            Fault::contact(
                pair,
                point,
                &model.point_position(&pair.points[point], u),
                fault,
            )
        };
        let reaches = (pair.master.depth(model), pair.reach(model));
        let law_kind = match pair.offsets(time) {
            None => self.share(pair, nodes, reaches, &NoOffset),
            Some(offsets) => self.share(pair, nodes, reaches, &offsets),
        }
        .map_err(|(i, e)| fault(i, e))?;
        for (at, (normal, gap)) in self.normals.iter_mut().zip(&self.gaps).enumerate() {
            *normal = match histories.get(at) {
                Some(history) => gap.normal(&history.law(*law, 0.0)),
                None => gap.normal(law),
            };
        }
        for (i, p) in pair.points.iter().enumerate() {
            let closed = nodes.terms(i, p).any(|(at, _)| self.closed(at));
            self.carries[i] = closed && matches!(self.shares[i], Share::Gap(_));
            if let (true, Ok(Some(met))) = (self.carries[i], &self.met[i]) {
                met.check().map_err(|e| fault(i, e))?;
            }
        }
        Ok(match histories.is_empty() {
            true => law_kind,
            false => LawKind::Multipliers,
        })
    }

    /// What an augmentation makes of the nodes evaluated last.
    pub fn answer(&self, answers: &mut [Option<PointAnswer>]) {
        let nodes = self.normals.iter().zip(&self.gaps);
        for ((normal, gap), answer) in nodes.zip(answers) {
            let closed = gap.gap().filter(|_| normal.n < 0.0);
            *answer = closed.map(|g| PointAnswer::without_friction(normal.n, g));
        }
    }

    /// Shares the gaps of the points, measured from `offsets`, among the nodes; the fault of the first point that has one.
    fn share<O: PointLaw>(
        &mut self,
        pair: &PairModel,
        nodes: &SlaveNodes,
        (depth, reach): (f64, f64),
        offsets: &O,
    ) -> Result<LawKind, (usize, PointFault)> {
        self.gaps.fill(NodalGap::default());
        for (i, (p, met)) in pair.points.iter().zip(&self.met).enumerate() {
            let met = met.as_ref().map_err(|e| (i, *e))?;
            let share = Share::new(met.map(|m| (m.xi3, m.free)), offsets.z0(i), depth, reach);
            for (at, shape) in nodes.terms(i, p) {
                share.add_to(&mut self.gaps[at], shape, p.area);
            }
            self.shares[i] = share;
        }
        Ok(O::KIND)
    }

    fn closed(&self, node: usize) -> bool {
        self.normals[node].n < 0.0
    }

    /// Points that carry, with the facets they meet.
    pub fn touched(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        (self.met.iter().zip(&self.carries).enumerate()).filter_map(|(i, (met, carries))| match met
        {
            Ok(Some(met)) if *carries => facet(met).map(|f| (i, f)),
            _ => None,
        })
    }

    /// Tells the state what is closed, and the totals of the nodes.
    fn count<L: NormalLaw>(
        &self,
        law: &L,
        points: &mut [PointState],
        nodes: &mut [bool],
        totals: &mut Totals,
    ) {
        for (state, carries) in points.iter_mut().zip(&self.carries) {
            state.closed = *carries;
        }
        let mut deepest = 0.0f64;
        for (at, was) in nodes.iter_mut().enumerate() {
            let closed = self.closed(at);
            totals.changed += usize::from(closed != *was);
            *was = closed;
            let gap = &self.gaps[at];
            if let (true, Some(g)) = (closed, gap.gap()) {
                totals.active += 1;
                totals.contact_energy += law.energy(g) * gap.area;
                deepest = deepest.max(-g);
            }
        }
        totals.penetration.push(deepest);
        totals
            .touching
            .push((0..self.gaps.len()).any(|at| self.closed(at)));
    }
}

fn facet(met: &Meeting) -> Option<u32> {
    match met.piece {
        Piece::Facet(facet) => Some(facet),
        Piece::Patch(_) => None,
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Sums up pair `index`, whose points are found.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn average<const TANGENT: bool>(
        &mut self,
        index: usize,
        first: usize,
        state: &mut State,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) -> Result<(), Fault> {
        let pair = &self.model.pairs[index];
        let Some(nodes) = &pair.averaged else {
            return Ok(());
        };
        // Taken out, so that the rest of the assembler is free.
        let Some(own) = self.averaged.get_mut(index) else {
            return Ok(());
        };
        let mut own = std::mem::take(own);
        let points = &mut state.points[first..first + pair.points.len()];
        let law = L::of(self.penalties[index]);
        own.count(&law, points, &mut state.nodes[nodes.range()], totals);
        let u = &state.u;
        for (i, p) in pair.points.iter().enumerate() {
            if let (true, Share::Gap(gap)) = (own.carries[i], own.shares[i]) {
                let x = self.model.point_position(p, u);
                totals.contact_rounding += rounding(&law, gap, p, &x);
            }
        }
        let center = match pair.rigid_master() {
            Some(surface) => self.model.surfaces[surface].center(time, u)?,
            None => Vec3::zeros(),
        };
        let at = At {
            index,
            u,
            increments,
            center,
        };
        match self.model.kernel(index).tangent {
            _ if own.rubbing.is_some() => {
                self.rub_points::<TANGENT>(&at, &mut own, residual, rhs, totals);
            }
            TangentKind::Exact => {
                self.points::<TANGENT, _>(&at, &mut own, nodes, &Exact, residual, rhs, totals)
            }
            TangentKind::Published(parts) => {
                self.points::<TANGENT, _>(&at, &mut own, nodes, &parts, residual, rhs, totals)
            }
        }
        if TANGENT {
            match own.rubbing.take() {
                None => self.rank_one(&at, &mut own, nodes, rhs),
                Some(mut rubbing) => {
                    self.rub_nodes(&at, (&mut own, &mut rubbing), nodes, rhs);
                    own.rubbing = Some(rubbing);
                }
            }
        }
        if let Some(kept) = self.averaged.get_mut(index) {
            *kept = own;
        }
        Ok(())
    }

    /// Forces of the points, and the geometric part of the tangent.
    #[allow(clippy::too_many_arguments)]
    fn points<const TANGENT: bool, T: FaceTangent>(
        &mut self,
        at: &At,
        own: &mut Averaged,
        nodes: &SlaveNodes,
        tangent: &T,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) {
        let (model, index, u) = (self.model, at.index, at.u);
        let pair = &model.pairs[index];
        let surface = pair.rigid_master();
        if let Some(ran) = &mut self.ran[index] {
            ran.tangent = tangent.kind();
        }
        let small = NEAR * pair.element_size;
        for (i, p) in pair.points.iter().enumerate() {
            let count = p.count as usize;
            let Ok(Some(met)) = &own.met[i] else { continue };
            if !own.carries[i] {
                continue;
            }
            let lambda = averaged::traction(nodes.terms(i, p).map(|(a, w)| (w, own.normals[a].n)));
            let geometry = met.steady(small);
            own.directions[i] = geometry.normal();
            let (r, k) = averaged::point(&geometry, lambda, tangent);
            let r = r * p.area;
            let mut add = |node: usize, f: &Vec3| {
                for c in 0..3 {
                    residual[3 * node + c] += f[c];
                    self.contact[3 * node + c] += f[c];
                }
            };
            let force: Vec3 = r.fixed_rows::<3>(0).into();
            for (node, w) in p.terms() {
                add(node, &(force * w));
            }
            let (slave, master) = match surface {
                Some(number) => (&mut totals.surfaces[number], None),
                None => {
                    let [slave, master] = totals.pairs[index].sides();
                    (slave, Some(master))
                }
            };
            let x = model.point_position(p, u);
            slave.force -= force;
            slave.moment -= x.cross(&force);
            if let (Some(side), Some(facet), Some(body)) =
                (master, facet(met), self.masters.surface(index))
            {
                let rows = &mut own.rows[i];
                body.facets.shape(facet, met.xi, rows);
                let masters = body.facets.nodes(facet);
                for (k, &node) in masters.iter().enumerate() {
                    let row = [-rows.n[k], rows.n_1[k], rows.n_2[k]];
                    let f = assemble_force(&r, &row);
                    add(node as usize, &f);
                    side.add(&model.position(node as usize, u), &f);
                }
                if TANGENT {
                    let n = count + masters.len();
                    own.ke.resize(9 * n * n, 0.0);
                    assemble_point(&k, &p.shape[..count], rows, p.area, &mut own.ke);
                    own.keys.clear();
                    own.keys.extend_from_slice(&p.nodes[..count]);
                    own.keys.extend_from_slice(masters);
                    self.put_averaged(own, at.increments, rhs);
                }
                continue;
            }
            let k: Matrix3<f64> = k.fixed_view::<3, 3>(0, 0) * p.area;
            let mut borders = self.borders.iter_mut();
            if let Some(border) = borders.find(|b| surface == Some(b.surface())) {
                border.carry::<TANGENT>(p, &force, &k, &(x - at.center));
            }
            if TANGENT {
                let (nodes, shape) = (&p.nodes[..count], &p.shape[..count]);
                self.put_point([index, i], nodes, shape, &k, at.increments, rhs);
            }
        }
    }
}

/// What is summed where.
struct At<'a> {
    /// Number of the pair.
    index: usize,
    u: &'a [f64],
    increments: Option<&'a [f64]>,
    /// Centre of a rigid master.
    center: Vec3,
}

impl SurfaceForce {
    /// Adds what the residual `f` of a node at `x` says.
    fn add(&mut self, x: &Vec3, f: &Vec3) {
        self.force -= f;
        self.moment -= x.cross(f);
    }
}

impl DrivenBlock {
    /// Adds a point with residual `r` and tangent `k`, at `arm` from the centre.
    fn carry<const TANGENT: bool>(
        &mut self,
        p: &crate::contact::points::SlavePoint,
        r: &Vec3,
        k: &Matrix3<f64>,
        arm: &Vec3,
    ) {
        self.active += 1;
        let c = carried(r, k, arm);
        press::add(&mut self.residual, &-r, &c.spin);
        if TANGENT {
            press::add_tangent(&mut self.tangent, k, &c);
            for (node, w) in p.terms() {
                let [translation, spin] = self.block(node);
                *translation -= k * w;
                *spin += c.point_spin * w;
            }
        }
    }
}
