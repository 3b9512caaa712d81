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
use crate::assembly::{Assembler, Fault, Totals};
use crate::contact::friction::history::PointHistory;
use crate::model::state::State;
use crate::model::{Model, PairModel};
use crate::system::linear::{LinearError, LinearSolver};

/// Part of the change at which it is measured: points that the whole of it would open or close, or let slide, should not do so.
const PART: f64 = 1.0 / 64.0;

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

/// Part of the sizes of all nodal forces below which a resultant says nothing: forces balance.
const BALANCED: f64 = 0.05;

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
    /// linear solver cannot. What the last evaluation left in the assembler is then that of contact at `state`.
    ///
    /// # Errors
    /// A point that cannot be evaluated beside the state.
    pub fn rigid_limit<S: LinearSolver + ?Sized>(
        &mut self,
        model: &Model,
        assembler: &mut Assembler,
        solver: &mut S,
        (state, histories): (&State, &[PointHistory]),
        time: f64,
    ) -> Result<Option<RigidLimit>, Fault> {
        if model.small.is_some() || assembler.has_new_pattern() {
            return Ok(None);
        }
        // All of these are written by a step before it reads them.
        let Workspace {
            rhs: was,
            du,
            scratch: now,
            absolute: added,
            base,
            factored,
            ..
        } = self;
        base.copy_from(state);
        base.histories.copy_from_slice(histories);
        stiffened(assembler, 1.0 + PART, |a| a.contact(base, time, added))?;
        assembler.contact(base, time, was)?;
        for (f, w) in added.iter_mut().zip(&*was) {
            *f = (*f - w) / PART;
        }
        if !*factored {
            if solver.factorize(assembler.matrix()).is_err() {
                return Ok(None);
            }
            *factored = true;
        }
        let right = |du: &mut [f64]| {
            for (d, f) in du.iter_mut().zip(&*added) {
                *d = -f;
            }
            model.dofs.fold(du);
        };
        right(du);
        match solver.solve_with(assembler.matrix(), du) {
            Ok(()) => {}
            // The factors are those of the iterate before, and an estimate needs few digits.
            Err(LinearError::Inaccurate { .. }) => {
                right(du);
                if solver.solve_in_place(du).is_err() {
                    return Ok(None);
                }
            }
            Err(_) => return Ok(None),
        }
        model.dofs.expand(du, None);
        let mut probe = Probe {
            model,
            base,
            at: &state.u,
            du,
            forces: [was, added, now],
        };
        let mut limit = probe.measure(assembler, time)?;
        if model.pairs.iter().any(|p| p.friction.is_some()) {
            let normal = without_friction(assembler, |a| probe.measure(a, time))?;
            if normal.change() < limit.change() {
                limit = normal;
            }
        }
        let bodies = 3 * model.body_nodes();
        let largest = |u: &[f64]| u[..bodies].iter().fold(0.0f64, |m, x| m.max(x.abs()));
        limit.moved = [largest(du), largest(&state.u)];
        base.u.copy_from_slice(&state.u);
        base.points.clone_from(&state.points);
        base.nodes.copy_from_slice(&state.nodes);
        assembler.contact(base, time, now)?;
        let finite = |v: &[f64]| v.iter().all(|x| x.is_finite());
        let known = limit.forces.iter().all(|f| finite(f)) && finite(&limit.gross);
        Ok(Some(limit).filter(|l| known && finite(&l.moved)))
    }
}

/// What a measurement of forces works on.
struct Probe<'a> {
    model: &'a Model,
    base: &'a mut State,
    /// Displacements of the step, and their change to rigid contact.
    at: &'a [f64],
    du: &'a [f64],
    /// Room for nodal forces.
    forces: [&'a mut Vec<f64>; 3],
}

impl Probe<'_> {
    /// The change of forces: those added, and what the change of the displacements makes of those of the step.
    fn measure(&mut self, assembler: &mut Assembler, time: f64) -> Result<RigidLimit, Fault> {
        let [was, added, now] = &mut self.forces;
        let base = &mut *self.base;
        base.u.copy_from_slice(self.at);
        let stiffer = stiffened(assembler, 1.0 + PART, |a| a.contact(base, time, added))?;
        let totals = assembler.contact(base, time, was)?;
        for (u, d) in base.u.iter_mut().zip(self.du) {
            *u += PART * d;
        }
        let moved = assembler.contact(base, time, now)?;
        let mut gross = [0.0; 2];
        let nodes = was.as_chunks::<3>().0.iter().zip(now.as_chunks::<3>().0);
        for ((w, n), a) in nodes.zip(added.as_chunks::<3>().0) {
            let size = w.iter().map(|w| w * w).sum::<f64>().sqrt();
            if size > 0.0 {
                let along: f64 = (0..3).map(|c| (n[c] + a[c] - 2.0 * w[c]) * w[c]).sum();
                gross[0] += along / (PART * size);
                gross[1] += size;
            }
        }
        gross[0] = gross[0].abs();
        let forces = (self.model.pairs.iter().enumerate())
            .map(|(index, pair)| {
                let [w, s, m] = [&totals, &stiffer, &moved].map(|t| force(pair, index, t));
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
fn stiffened<T>(
    assembler: &mut Assembler,
    factor: f64,
    evaluate: impl FnOnce(&mut Assembler) -> T,
) -> T {
    let penalties = assembler.penalties.clone();
    assembler.penalties.iter_mut().for_each(|e| *e *= factor);
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
fn force(pair: &PairModel, index: usize, totals: &Totals) -> covact_geometry::Vec3 {
    match pair.rigid_master() {
        Some(surface) => totals.surfaces[surface].force,
        None => totals.pairs[index].slave.force,
    }
}
