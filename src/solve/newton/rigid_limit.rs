//! What forces would be if contact did not give way.
//!
//! The tractions `t` of a penalty are the less than those of rigid contact the more gap is left. Added to themselves as loads,
//! as an augmentation would, they change the displacements by `K du = -f(t)`, and the forces of contact by `f(t)` and by what
//! `du` makes of them: to first order in the compliance that is all that the penalty takes away. One solution with the
//! factors at hand and a few evaluations of contact tell it of every step by itself, whatever steps led there; a point that
//! slides takes friction of the added pressure with it. Where there is friction the smaller one counts of two changes, of all
//! forces and of the normal ones: slip that turns round says nothing of rigid contact. Of multipliers only what the penalty still
//! carries counts.
use super::Workspace;
use crate::assembly::{Assembler, Fault, SurfaceForce, Totals};
use crate::contact::friction::history::PointHistory;
use crate::model::state::State;
use crate::model::{Model, PairModel};
use crate::system::linear::{LinearError, LinearSolver};

/// Part of the change at which it is measured: points that the whole of it would open or close, or let slide, should not do so.
pub(super) const PART: f64 = 1.0 / 64.0;

/// Change of a step's forces and displacements from the penalty to rigid contact, to first order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigidLimit {
    /// Per pair: the size of the change of the force on its slave side, or of all that acts on its rigid master, and the size of
    /// the force itself (force).
    pub forces: Vec<[f64; 2]>,
    /// The same of the sum of the sizes of the forces at all nodes, which is not zero where forces balance (force).
    pub gross: [f64; 2],
    /// Largest change of a displacement of the bodies, and the largest displacement (length).
    pub moved: [f64; 2],
}

/// Times of what a raise leaves by first order that may be left.
const DOUBT: f64 = 3.0;

/// Part of the sizes of all nodal forces below which a resultant says nothing: forces balance.
const BALANCED: f64 = 0.05;

/// Part of a pair's force that rigid contact may change for that change to be known by first order.
const KNOWN: f64 = 0.5;
/// Times of it that are far more than it, at once and after a raise that went as far, and the part of the largest force below which no
/// change counts.
const FAR: [f64; 2] = [5.0, 2.0];
const COUNTS: f64 = 0.2;

impl RigidLimit {
    /// Whether the forces of every pair balance, as between tubes that shrink onto each other.
    fn balances(&self) -> bool {
        self.forces.iter().all(|f| f[1] < BALANCED * self.gross[1])
    }

    /// The force that its change is relative to: of the pair that carries most, or of all nodes where forces balance (force).
    pub fn force(&self) -> f64 {
        match self.balances() {
            true => self.gross[1],
            false => self.forces.iter().fold(0.0, |a, f| a.max(f[1])),
        }
    }

    /// Largest change of a force (force).
    pub fn change(&self) -> f64 {
        let gross = if self.balances() { self.gross[0] } else { 0.0 };
        self.forces.iter().fold(gross, |a, f| a.max(f[0]))
    }

    /// Takes what stiffer penalties have just shown for what the rest of the way to rigid contact may still change: where penalties rose
    /// by a factor f, an error that falls as `1 / f` has left the part `1 / (f - 1)` of the change. A slip that is about to turn, or a
    /// path about to, answers far more to the tractions of a step than to its penalty. `before` and `after` are the totals under
    /// both, `moved` the largest change of a displacement. Nothing is taken where forces balance, whose change is not known.
    pub fn bound(&mut self, model: &Model, [before, after]: [&Totals; 2], moved: f64, factor: f64) {
        if factor <= 1.0 || self.balances() {
            return;
        }
        let left = DOUBT / (factor - 1.0);
        for ((index, pair), own) in model.pairs.iter().enumerate().zip(&mut self.forces) {
            let [a, b] = [before, after].map(|t| force(pair, index, t).force);
            own[0] = own[0].min(left * (b - a).norm());
        }
        self.moved[0] = self.moved[0].min(left * moved);
    }

    /// The pair whose force stiffer penalties have changed by far more than was left to rigid contact; none where every force went
    /// about as far as two springs in series would. Once that is what a path does that is about to touch; where every raise does it,
    /// it is not the penalty's compliance that shows, but faces of both sides that do not fit each other: where they bend, corners
    /// of one press into the chords of the other, the harder the stiffer contact is.
    pub fn outrun(
        &self,
        model: &Model,
        [before, after]: [&Totals; 2],
        again: bool,
    ) -> Option<usize> {
        let reference = self.force();
        let all = model.pairs.iter().enumerate().zip(&self.forces);
        let off = all.filter_map(|((index, pair), [change, own])| {
            let [a, b] = [before, after].map(|t| force(pair, index, t).force);
            let changed = (b - a).norm();
            let part = change / own;
            let foretold = own * part / (1.0 - part);
            let far = part < KNOWN
                && changed > FAR[usize::from(again)] * foretold
                && changed > own.max(COUNTS * reference);
            far.then_some((index, changed))
        });
        let most = off.max_by(|a, b| a.1.total_cmp(&b.1));
        most.map(|(index, _)| index)
    }

    /// Size of the force of a pair (force).
    pub fn of_pair(model: &Model, index: usize, totals: &Totals) -> f64 {
        force(&model.pairs[index], index, totals).force.norm()
    }

    fn finite(&self) -> bool {
        let pairs = self.forces.iter().flatten();
        pairs
            .chain(&self.gross)
            .chain(&self.moved)
            .all(|x| x.is_finite())
    }

    /// Leaves out what acts at points whose penetration is prescribed, a part of the force of every pair: rigid contact could not
    /// be there.
    pub fn leave_out(&mut self, parts: impl Iterator<Item = f64>) {
        let mut all = [0.0; 2];
        for (f, part) in self.forces.iter_mut().zip(parts) {
            all = [all[0] + part * f[1], all[1] + f[1]];
            f[0] = (f[0] - part * f[1]).max(0.0);
        }
        if all[0] > 0.0 {
            self.gross[0] = (self.gross[0] - self.gross[1] * all[0] / all[1]).max(0.0);
        }
    }
}

impl Workspace {
    /// Measures the step that was just solved for, at `state` with the `histories` that it was solved with; nothing where the
    /// linear solver cannot, or contact has no value beside the state. What is then left in the assembler is contact at `state`. A
    /// relative change of forces below `little` is taken as it comes: the smaller one without friction is not looked for.
    ///
    /// # Errors
    /// A point that cannot be evaluated at the state itself.
    pub fn rigid_limit<S: LinearSolver + ?Sized>(
        &mut self,
        model: &Model,
        assembler: &mut Assembler,
        solver: &mut S,
        (state, histories): (&State, &[PointHistory]),
        (time, little): (f64, f64),
    ) -> Result<Option<RigidLimit>, Fault> {
        if model.small.is_some() || assembler.has_new_pattern() {
            return Ok(None);
        }
        self.beside(state, histories);
        let found = self.measure(model, assembler, solver, state, (time, little));
        place(&mut self.base, state);
        assembler.contact(&mut self.base, time, &mut self.scratch)?;
        Ok(found.ok().flatten().filter(RigidLimit::finite))
    }

    /// Makes the state with the histories that it was solved with one to evaluate contact beside. All of it is written by a step before
    /// it reads it, and contact reads nothing of elements.
    pub(super) fn beside(&mut self, state: &State, histories: &[PointHistory]) {
        let base = &mut self.base;
        base.cuts.clone_from(&state.cuts);
        base.histories.clear();
        base.histories.extend_from_slice(histories);
        place(base, state);
    }

    /// The measurement; leaves the assembler beside the state.
    fn measure<S: LinearSolver + ?Sized>(
        &mut self,
        model: &Model,
        assembler: &mut Assembler,
        solver: &mut S,
        state: &State,
        (time, little): (f64, f64),
    ) -> Result<Option<RigidLimit>, Fault> {
        let Workspace {
            rhs: was,
            du,
            scratch: now,
            absolute: stiffer,
            base,
            factored,
            ..
        } = self;
        let mut probe = Probe {
            model,
            base,
            time,
            forces: [was, stiffer, now],
        };
        let before = probe.before(assembler)?;
        if !*factored {
            if solver.factorize(assembler.matrix()).is_err() {
                return Ok(None);
            }
            *factored = true;
        }
        probe.added(du);
        match solver.solve_with(assembler.matrix(), du) {
            Ok(()) => {}
            // The factors are those of the iterate before, and an estimate needs few digits.
            Err(LinearError::Inaccurate { .. }) => {
                probe.added(du);
                if solver.solve_in_place(du).is_err() {
                    return Ok(None);
                }
            }
            Err(_) => return Ok(None),
        }
        model.dofs.expand(du, None);
        let mut limit = probe.after(assembler, &before, du)?;
        let slides = model.pairs.iter().any(|p| p.friction.is_some());
        if slides && limit.change() >= little * limit.force() {
            place(probe.base, state);
            let normal = without_friction(assembler, |assembler| {
                let before = probe.before(assembler)?;
                probe.after(assembler, &before, du)
            })?;
            if normal.change() < limit.change() {
                limit = normal;
            }
        }
        let bodies = 3 * model.body_nodes();
        let largest = |u: &[f64]| u[..bodies].iter().fold(0.0f64, |m, x| m.max(x.abs()));
        limit.moved = [largest(du), largest(&state.u)];
        Ok(Some(limit))
    }
}

/// Puts the points of a state where those of another one are.
pub(super) fn place(base: &mut State, state: &State) {
    base.u.copy_from_slice(&state.u);
    base.points.clone_from(&state.points);
    base.nodes.copy_from_slice(&state.nodes);
}

/// What a measurement of forces works on.
struct Probe<'a> {
    model: &'a Model,
    base: &'a mut State,
    time: f64,
    /// Forces at nodes: at the state, under stiffer penalties, and beside the state.
    forces: [&'a mut Vec<f64>; 3],
}

impl Probe<'_> {
    /// Evaluates contact at the state, under stiffer penalties first; the totals of both in the order of the forces.
    fn before(&mut self, assembler: &mut Assembler) -> Result<[Totals; 2], Fault> {
        let ([was, stiffer, _], time) = (&mut self.forces, self.time);
        let more = stiffened(assembler, |a| a.contact(self.base, time, stiffer))?;
        Ok([assembler.contact(self.base, time, was)?, more])
    }

    /// The right-hand side of the tractions as loads.
    fn added(&self, du: &mut [f64]) {
        let [was, stiffer, _] = &self.forces;
        for ((d, s), w) in du.iter_mut().zip(&**stiffer).zip(&**was) {
            *d = (w - s) / PART;
        }
        self.model.dofs.fold(du);
    }

    /// The change of forces: those added, and what the change `du` of the displacements makes of those of the step.
    fn after(
        &mut self,
        assembler: &mut Assembler,
        [totals, more]: &[Totals; 2],
        du: &[f64],
    ) -> Result<RigidLimit, Fault> {
        for (u, d) in self.base.u.iter_mut().zip(du) {
            *u += PART * d;
        }
        let [was, stiffer, now] = &mut self.forces;
        let moved = assembler.contact(self.base, self.time, now)?;
        let mut gross = [0.0; 2];
        let nodes = was.as_chunks::<3>().0.iter().zip(now.as_chunks::<3>().0);
        for ((w, n), s) in nodes.zip(stiffer.as_chunks::<3>().0) {
            let size = w.iter().map(|w| w * w).sum::<f64>().sqrt();
            if size > 0.0 {
                let along: f64 = (0..3).map(|c| (n[c] + s[c] - 2.0 * w[c]) * w[c]).sum();
                gross[0] += along / (PART * size);
                gross[1] += size;
            }
        }
        gross[0] = gross[0].abs();
        let forces = (self.model.pairs.iter().enumerate())
            .map(|(index, pair)| {
                let [w, s, m] = [totals, more, &moved].map(|t| force(pair, index, t).force);
                [(s + m - 2.0 * w).norm() / PART, w.norm()]
            })
            .collect();
        Ok(RigidLimit {
            forces,
            gross,
            moved: [0.0; 2],
        })
    }
}

/// Part of the tangential penalties under which friction is nothing.
const NO_FRICTION: f64 = 1e-12;

/// Evaluates under stiffer penalties, normal and tangential ones.
fn stiffened<T>(assembler: &mut Assembler, evaluate: impl FnOnce(&mut Assembler) -> T) -> T {
    let penalties = assembler.penalties.clone();
    assembler
        .penalties
        .iter_mut()
        .for_each(|e| *e *= 1.0 + PART);
    let result = evaluate(assembler);
    assembler.penalties = penalties;
    result
}

/// Evaluates without friction: with it, a point that slides sticks where the change of its displacement turns its slip round, and
/// tells of its tangential penalty.
fn without_friction<T>(assembler: &mut Assembler, evaluate: impl FnOnce(&mut Assembler) -> T) -> T {
    let ratios = assembler.ratios.clone();
    assembler.ratios.iter_mut().for_each(|r| *r *= NO_FRICTION);
    let result = evaluate(assembler);
    assembler.ratios = ratios;
    result
}

/// What acts on the slave side of a pair, or on the bodies from its rigid master.
pub(super) fn force<'t>(pair: &PairModel, index: usize, totals: &'t Totals) -> &'t SurfaceForce {
    match pair.rigid_master() {
        Some(surface) => &totals.surfaces[surface],
        None => &totals.pairs[index].slave,
    }
}
