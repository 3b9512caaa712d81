//! The model at small displacements: `K u + sum eps_n A g n = f` with one stiffness for the whole run. The elements are
//! evaluated once, undeformed, where the tangent of the large-rotation element is the stiffness of the linear one.
mod friction;
mod line;
mod matrix;

use super::elements::{Quadratic, Systems, quadratic, undeformed};
use super::{Assembler, Fault, Kind, PairForce, PatternError, SurfaceForce, Totals};
use crate::contact::law::{NormalLaw, PairLaw, Penalty};
use crate::model::Model;
use crate::model::kernel::{GapKind, Kernel};
use crate::model::loads::follower_force;
use crate::model::motion::SmallMotion;
use crate::model::small::SmallModel;
use crate::model::state::{PointState, State, heap};
use crate::scene::ValueError;
use crate::system::{DofMap, Pattern, SystemMatrix};
use covact_geometry::Vec3;
pub(super) use friction::Rubbing;
pub use line::Line;
use std::sync::Arc;

/// Part of the largest displacement so far, or of the gap at the start, by which a gap has to pass zero for its point to
/// change its status: less is rounding. The present displacements would not do: unloaded, they are rounding themselves.
const ROUNDING: f64 = 1e-12;

/// What is assembled once, and what was factorized last.
pub(super) struct Linear {
    /// Of all elements, without constraints: its product with displacements are forces and reactions.
    stiffness: SystemMatrix,
    /// Values of the system without contact, those of its transposed blocks behind them where it is unsymmetric.
    base: Vec<f64>,
    /// Gap per slave point at the last evaluation; NaN where there is no foot.
    gaps: Vec<f64>,
    /// Per point with history, what friction does there at the last evaluation; empty without friction.
    rubbing: Vec<Rubbing>,
    /// What was factorized last.
    factored: Option<Factored>,
    /// It is at hand, not only told by the run that is continued.
    at_hand: bool,
    /// `K du`.
    forces: Vec<f64>,
    /// Largest `n . (u_s - u_m)` at the last evaluation.
    largest: f64,
    /// Largest displacement at the last evaluation.
    way: f64,
    /// Largest displacement of all equilibria so far: what is left of it at rest is rounding.
    farthest: f64,
    /// The elements have been evaluated.
    ready: bool,
    /// Friction has the limits of the last linearisation, whatever its pressures are.
    searches: bool,
}

/// What a system at small displacements depends on.
#[derive(Debug, Clone, PartialEq)]
pub struct Factored {
    /// Points in contact.
    pub closed: Vec<bool>,
    /// Penalty per pair.
    pub penalties: Vec<f64>,
}

/// What a set of points in contact asks of the solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needed {
    /// The factorization at hand is that of the set.
    Nothing,
    /// It was made before the run was continued, and is made again.
    Again,
    /// A set of its own.
    Factorization,
}

impl Linear {
    /// Stiffness of a model on its pattern; nothing where displacements are large.
    pub fn new(
        model: &Model,
        dofs: &DofMap,
        pattern: &Arc<Pattern>,
    ) -> Result<Option<Box<Linear>>, PatternError> {
        if model.small.is_none() {
            return Ok(None);
        }
        let mut nodes: Vec<u32> = Vec::new();
        let mut starts = vec![0];
        for body in &model.bodies {
            for e in 0..body.block.elements() {
                nodes.extend(body.element_nodes(e));
                starts.push(nodes.len());
            }
        }
        let groups = starts.windows(2).map(|w| &nodes[w[0]..w[1]]);
        let own = Arc::new(Pattern::new(model.nodes.len(), groups)?);
        own.fits(true)?;
        Ok(Some(Box::new(Linear {
            stiffness: SystemMatrix::new(own),
            base: vec![0.0; 9 * pattern.blocks() * if model.symmetric { 1 } else { 2 }],
            gaps: vec![f64::NAN; model.contact_points()],
            rubbing: friction::rubbing(model),
            factored: None,
            at_hand: false,
            forces: vec![0.0; dofs.dofs()],
            largest: 0.0,
            way: 0.0,
            farthest: 0.0,
            ready: false,
            searches: false,
        })))
    }

    /// Bytes of heap that it holds, itself included.
    pub fn bytes(&self) -> usize {
        let Linear {
            stiffness,
            base,
            gaps,
            rubbing,
            factored,
            at_hand: _,
            forces,
            largest: _,
            way: _,
            farthest: _,
            ready: _,
            searches: _,
        } = self;
        let own = stiffness.bytes()[0] + stiffness.pattern().bytes() + heap(base);
        let known = (factored.as_ref()).map_or(0, |f| heap(&f.closed) + heap(&f.penalties));
        size_of::<Linear>() + own + heap(gaps) + heap(rubbing) + heap(forces) + known
    }

    /// What was factorized last.
    pub fn factored(&self) -> Option<&Factored> {
        self.factored.as_ref()
    }

    /// Largest displacement of all equilibria so far (length).
    pub fn farthest(&self) -> f64 {
        self.farthest
    }

    /// Takes over what the run that is continued had factorized, and how far it had gone.
    pub fn restore(&mut self, factored: Option<Factored>, farthest: f64) {
        self.factored = factored;
        self.farthest = farthest;
        self.at_hand = false;
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// The small displacements of the model.
    fn linear(&mut self) -> Option<(&mut Linear, &SmallModel)> {
        let model = self.model;
        self.linear.as_deref_mut().zip(model.small.as_ref())
    }

    /// Evaluates the elements, once.
    fn stiffen(&mut self) -> Result<(), Fault> {
        let Some(linear) = self.linear.as_deref_mut() else {
            return Ok(());
        };
        let mut systems = Systems::new(self.model);
        self.matrix.clear();
        let known = (&self.kinds[..], &self.element_maps[..]);
        undeformed(self.model, self.dofs, &mut self.matrix, &mut systems, known)?;
        let (base, transposed) = linear.base.split_at_mut(self.matrix.values().len());
        base.copy_from_slice(self.matrix.values());
        if let Some(values) = self.matrix.transposed_values() {
            transposed.copy_from_slice(values);
        }
        let (mut maps, mut count) = (Vec::new(), 0);
        for body in &self.model.bodies {
            for e in 0..body.block.elements() {
                let nodes: Vec<u32> = body.element_nodes(e).collect();
                linear.stiffness.pattern().element_map(&nodes, &mut maps)?;
                count += 1;
            }
        }
        linear.stiffness.clear();
        let kinds = vec![Kind::Free; count];
        undeformed(
            self.model,
            self.dofs,
            &mut linear.stiffness,
            &mut systems,
            (&kinds, &maps),
        )?;
        linear.ready = true;
        Ok(())
    }

    /// Residual `K u + f_contact - f_ext` at all degrees of freedom (reactions included) with the points in contact that
    /// `state` says are, whatever their gaps. For models with small displacements; nothing for others.
    ///
    /// # Errors
    /// A motion or a load without a value at `time`; an element without stiffness.
    pub fn small_residual(
        &mut self,
        state: &State,
        time: f64,
        residual: &mut [f64],
    ) -> Result<Totals, Fault> {
        if self.linear.as_ref().is_some_and(|l| !l.ready) {
            self.stiffen()?;
        }
        let mut totals = Totals::default();
        if let Some((linear, _)) = self.linear() {
            linear.stiffness.multiply(&state.u, residual);
            totals.internal_energy = 0.5 * dot(residual, &state.u);
        }
        self.small_contact(state, time, residual, &mut totals)?;
        self.dead(time)?;
        for (r, f) in residual.iter_mut().zip(&self.external) {
            *r -= f;
        }
        Ok(totals)
    }

    /// All loads as dead ones.
    fn dead(&mut self, time: f64) -> Result<(), ValueError> {
        let (mut x, mut f) = ([Vec3::zeros(); 9], [0.0; 27]);
        self.external.fill(0.0);
        for (_, load) in &self.model.dead_loads {
            load.add(time, &mut self.external)?;
        }
        for (_, load) in &self.model.follower_loads {
            let p = load.value.eval(time)?;
            for face in &load.faces {
                let nodes = face.nodes();
                for (x, &n) in x.iter_mut().zip(nodes) {
                    *x = self.model.nodes[n as usize];
                }
                follower_force(&x, face.count, p, &mut f);
                for (k, &n) in nodes.iter().enumerate() {
                    (0..3).for_each(|c| self.external[3 * n as usize + c] += f[3 * k + c]);
                }
            }
        }
        Ok(())
    }

    /// Adds the forces of the points that are in contact, and their totals.
    pub(super) fn small_contact(
        &mut self,
        state: &State,
        time: f64,
        residual: &mut [f64],
        totals: &mut Totals,
    ) -> Result<(), Fault> {
        totals.surfaces = vec![SurfaceForce::default(); self.model.surfaces.len()];
        totals.pairs = vec![PairForce::default(); self.model.pairs.len()];
        self.contact.fill(0.0);
        let model = self.model;
        if let Some((linear, small)) = self.linear() {
            linear.evaluate(model, small, &state.u, time)?;
        }
        self.rub(state, time)?;
        let (Some(linear), Some(small)) = (self.linear.as_deref_mut(), &model.small) else {
            return Ok(());
        };
        let (mut first, mut rounding) = (0, 0.0);
        for (index, (pair, own)) in model.pairs.iter().zip(&small.pairs).enumerate() {
            let range = first..first + pair.points.len();
            first = range.end;
            let eps = self.penalties[index];
            let law = Penalty { eps_n: eps };
            let rubbing = friction::of_pair(&linear.rubbing, model, state, index);
            let before = totals.active;
            let (mut deepest, mut force) = (0.0f64, PairForce::default());
            for (i, (p, state)) in pair
                .points
                .iter()
                .zip(&state.points[range.clone()])
                .enumerate()
            {
                let rubs = rubbing.and_then(|rubbing| rubbing[i].of());
                let drag = rubs.map(|rubs| rubs.t * p.area);
                let (true, Some(at)) = (state.closed || drag.is_some(), &own.points[i]) else {
                    continue;
                };
                let mut f = Vec3::zeros();
                if state.closed {
                    let gap = linear.gaps[range.start + i];
                    totals.active += 1;
                    deepest = deepest.max(-gap);
                    totals.contact_energy += law.energy(gap) * p.area;
                    let last = eps * p.area * f64::EPSILON * (at.gap.abs() + linear.largest);
                    rounding += last.powi(2);
                    f = at.normal * (law.response(gap).n * p.area);
                }
                if let Some(drag) = &drag {
                    f += drag;
                }
                let contact = &mut self.contact;
                let mut add = |node: usize, f: Vec3, side: &mut SurfaceForce| {
                    side.force -= f;
                    side.moment -= model.nodes[node].cross(&f);
                    for c in 0..3 {
                        residual[3 * node + c] += f[c];
                        contact[3 * node + c] += f[c];
                    }
                };
                for (node, w) in p.terms() {
                    add(node, f * w, &mut force.slave);
                }
                for &(node, w) in own.master(i) {
                    add(node as usize, f * -w, &mut force.master);
                }
                if let Some(drag) = &drag {
                    for (&(node, _), arm) in own.master(i).iter().zip(own.arms(i)) {
                        let f = at.normal * arm.dot(drag);
                        add(node as usize, f, &mut force.master);
                    }
                }
            }
            match pair.rigid_master() {
                Some(surface) => {
                    totals.surfaces[surface].force += force.slave.force;
                    totals.surfaces[surface].moment += force.slave.moment;
                }
                None => totals.pairs[index] = force,
            }
            totals.penetration.push(deepest);
            totals.touching.push(totals.active > before);
            self.ran[index] = Some(Kernel {
                gap: GapKind::Linearised,
                ..model.kernel(index)
            });
        }
        totals.contact_rounding = f64::sqrt(rounding);
        totals.contact_norm = dot(&self.contact, &self.contact).sqrt();
        Ok(())
    }

    /// Evaluates the gaps of all slave points.
    ///
    /// # Errors
    /// A motion without a value at `time`.
    pub fn small_gaps(&mut self, u: &[f64], time: f64) -> Result<(), ValueError> {
        let model = self.model;
        match self.linear() {
            Some((linear, small)) => linear.evaluate(model, small, u, time),
            None => Ok(()),
        }
    }

    /// Opens and closes points by the gaps of the last evaluation; returns how many changed.
    pub fn small_switch(&self, points: &mut [PointState]) -> usize {
        let (Some(linear), Some(small)) = (&self.linear, &self.model.small) else {
            return 0;
        };
        let at = small.pairs.iter().flat_map(|p| &p.points);
        let way = linear.way.max(linear.farthest);
        let mut changed = 0;
        for ((point, at), &gap) in points.iter_mut().zip(at).zip(&linear.gaps) {
            let Some(at) = at else { continue };
            let least = ROUNDING * (at.gap.abs() + way);
            let closed = if point.closed {
                gap <= least
            } else {
                gap < -least
            };
            changed += usize::from(closed != point.closed);
            point.closed = closed;
        }
        changed
    }

    /// What it takes to solve with this set of points in contact.
    pub fn small_needs(&self, points: &[PointState]) -> Needed {
        let Some((linear, last)) = (self.linear.as_ref()).and_then(|l| Some((l, l.factored()?)))
        else {
            return Needed::Factorization;
        };
        let same = last.penalties == self.penalties
            && (last.closed.iter().zip(points)).all(|(was, now)| *was == now.closed);
        match (same, linear.at_hand) {
            (true, true) => Needed::Nothing,
            (true, false) => Needed::Again,
            (false, _) => Needed::Factorization,
        }
    }

    /// Tells that the system with this set has been factorized.
    pub fn small_factored(&mut self, points: &[PointState]) {
        let penalties = self.penalties.clone();
        if let Some((linear, _)) = self.linear() {
            linear.factored = Some(Factored {
                closed: points.iter().map(|p| p.closed).collect(),
                penalties,
            });
            linear.at_hand = true;
        }
    }

    /// Begins a solution that uses no factors of another one: a run that is continued has none.
    pub fn small_begin(&mut self) {
        self.begin_solution();
        if let Some(linear) = self.linear.as_deref_mut() {
            linear.at_hand = false;
        }
    }

    /// Tells that the last evaluation was of an equilibrium.
    pub fn small_settled(&mut self) {
        if let Some(linear) = self.linear.as_deref_mut() {
            linear.farthest = linear.farthest.max(linear.way);
        }
    }

    /// What the large-rotation elements add at displacements `u`.
    ///
    /// # Errors
    /// Strains that are impossible.
    pub fn small_quadratic(&self, u: &[f64]) -> Result<Quadratic, Fault> {
        quadratic(self.model, u)
    }

    /// The energy along `du` from where the last evaluation was, `residual` being that of its own points in contact
    /// (all those below their masters).
    pub fn small_line(&mut self, du: &[f64], residual: &[f64]) -> Line {
        let (model, penalties) = (self.model, &self.penalties);
        let (Some(linear), Some(small)) = (self.linear.as_deref_mut(), &model.small) else {
            return Line::default();
        };
        linear.stiffness.multiply(du, &mut linear.forces);
        let mut line = Line {
            slope: dot(residual, du),
            curvature: dot(&linear.forces, du),
            points: Vec::new(),
        };
        let mut first = 0;
        for ((pair, own), eps) in model.pairs.iter().zip(&small.pairs).zip(penalties) {
            let still = pair.rigid_master().map(|_| SmallMotion::default());
            for (i, (p, at)) in pair.points.iter().zip(&own.points).enumerate() {
                let Some(at) = at else { continue };
                let gap = linear.gaps[first + i];
                let rate = own.approach(i, at, p, still.as_ref(), du);
                if rate == 0.0 && gap >= 0.0 {
                    continue;
                }
                let weight = eps * p.area;
                line.slope -= weight * gap.min(0.0) * rate;
                line.points.push([weight, gap, rate]);
            }
            first += pair.points.len();
        }
        line
    }
}

impl Linear {
    /// Gaps of all slave points.
    fn evaluate(
        &mut self,
        model: &Model,
        small: &SmallModel,
        u: &[f64],
        time: f64,
    ) -> Result<(), ValueError> {
        let (mut first, mut largest) = (0, 0.0f64);
        let mut farthest = u.iter().fold(0.0f64, |a, u| a.max(u.abs()));
        for (pair, own) in model.pairs.iter().zip(&small.pairs) {
            let motion = model.small_motion(pair, time)?;
            let offsets = pair.offsets(time);
            let gaps = &mut self.gaps[first..first + pair.points.len()];
            first += gaps.len();
            for (i, gap) in gaps.iter_mut().enumerate() {
                let Some(at) = &own.points[i] else { continue };
                let (length, way) = own.way(i, at, &pair.points[i], motion.as_ref(), u);
                largest = largest.max(way.abs());
                farthest = farthest.max(length);
                *gap = at.gap - offsets.map_or(0.0, |o| o.at(i)) + way;
            }
        }
        (self.largest, self.way) = (largest, farthest);
        Ok(())
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
