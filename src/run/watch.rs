//! What a run watches of its energies.
//!
//! The work done on the bodies since the start is summed over the accepted steps by the trapezoidal rule: reactions at
//! supports and loads on the displacements of the step, the force and the moment of every rigid surface on the motion of
//! the surface, and the pressure of contacts whose overclosure shrinks on what the offset shrinks by. Forces at the start of
//! a step are those in equilibrium there, so that what is suddenly there with a step counts as growing evenly over it, but for
//! friction: where points begin to slide, or turn round, their tractions are at their limit in most of the step.
//!
//! An overclosure at the start that the first step resolves counts as one that shrinks in it. Penalties put in energy of
//! their own where they change under points that are pressed, by any factor: what a step leaves out of balance over which they
//! change counts as that. A point with a multiplier does the work of its tractions; what of that the penalty does not hold counts, with its sign.
//!
//! What is then left of the balance is the error of the rule, of second order in the step, or a jump of the path.
mod eased;
mod faint;
mod faster;
mod heading;
mod jump;
mod lag;
mod multipliers;

#[cfg(test)]
mod tests;
mod twist;

use crate::assembly::{Assembler, Fault, SurfaceForce, Totals};
use crate::contact::law::PairLaw;
use crate::model::Model;
use crate::model::state::State;
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use crate::shell::Flow;
use faint::faint;
use faster::Faster;
use heading::Heading;
pub use jump::Jump;
use twist::Twist;

/// Share of the work turned over so far above which a step that no trapezoid explains is told.
const JUMP: f64 = 0.01;
/// The same of a step that was solved from a softened penalty only.
const OTHER: f64 = 1e-3;
/// Part of the work turned over so far that was there before a step, below which it is one of first touches, whose trapezoid is coarse.
const FIRST: f64 = 0.5;
/// Share of the work turned over above which the sum of all steps is told.
const DRIFT: f64 = 0.05;

/// Part of the work turned over so far, or of what is stored, that a step may not gain out of nothing: no path leads to such a
/// state. Where penalties change, which put in energy of their own, it is larger in small steps.
const GAINED: [f64; 2] = [0.5, 2.0];

/// Sums since the start, and what acts at the last accepted state: all that the watch needs to go on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Watch {
    /// Work of supports, loads, rigid surfaces and overclosures (energy).
    pub external: f64,
    /// Energy that penalties and multipliers put in by changing (energy).
    pub adjusted: f64,
    /// `external + adjusted - stored - dissipated` (energy).
    pub imbalance: f64,
    /// Sum of the sizes of all works, whatever their signs (energy).
    pub turnover: f64,
    /// How materials have flowed.
    flow: Flow,
    /// How the direction of friction turned.
    heading: Heading,
    /// The largest change of the imbalance in one step, and that step.
    pub worst: f64,
    pub worst_step: u32,
    /// The most that the energies have come from nowhere so far, and in which step (energy).
    pub gained: f64,
    pub gained_step: u32,
    /// Largest displacement of a node by the time it took, in the last step and in the one before.
    pub speed: [f64; 2],
    /// Start and end of the last step; both zero before the first.
    pub span: [f64; 2],
    /// A step from a softened penalty jumped in spite of its size: the path snaps, and others will.
    snaps: bool,
    /// The last accepted step ended with a tangent that had negative pivots.
    pub unstable: bool,
    /// Reactions and loads, 3 per node of the bodies (force); no loads where the scene has none.
    reactions: Vec<f64>,
    loads: Vec<f64>,
    /// What the rigid surfaces exert.
    surfaces: Vec<SurfaceForce>,
    /// Penalty per pair, and the tangential one over it.
    penalties: Vec<f64>,
    ratios: Vec<f64>,
    /// Per pair whose overclosure shrinks: sum of normal traction, overclosure at the start and area (energy).
    pressed: Vec<f64>,
    /// Normal traction and gap per point with multipliers.
    tractions: Vec<[f64; 2]>,
    /// What penalties stored at the end of the last accepted step (energy).
    stored: f64,
    /// Energy that rounding makes of displacements, and far less than any load (energy).
    faint: f64,
}

/// Work of one step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Work {
    pub external: f64,
    pub adjusted: f64,
    /// Largest error of the trapezoidal rule where every force changes in one direction over the step.
    pub coarse: f64,
    turnover: f64,
    /// Penalties changed in the step, or before it.
    pub changed: bool,
    /// The largest ratio of a penalty to what it was, or the other way round.
    eased: f64,
}

impl Work {
    /// Adds what changes from `a` to `b` at the ends of the step in a linear way.
    fn add(&mut self, a: f64, b: f64) {
        self.external += 0.5 * (a + b);
        self.turnover += 0.5 * (a + b).abs();
        self.coarse += 0.5 * (b - a).abs();
    }

    /// With what the rule leaves out of the work of friction ([`PointHistory::sudden`](crate::contact::friction::history::PointHistory)).
    pub(super) fn with_sudden(mut self, sudden: f64) -> Self {
        self.external += sudden;
        self.turnover += sudden.abs();
        self
    }
}

/// Ends of a step.
#[derive(Debug, Clone, Copy)]
pub struct Span<'a> {
    pub from: (&'a State, f64),
    pub to: (&'a State, f64),
}

impl Watch {
    /// Nothing has acted yet.
    pub fn new(model: &Model) -> Self {
        let n = 3 * model.body_nodes();
        Watch {
            reactions: vec![0.0; n],
            loads: vec![0.0; if model.loaded() { n } else { 0 }],
            surfaces: vec![SurfaceForce::default(); model.surfaces.len()],
            penalties: model.pairs.iter().map(|p| p.eps_n).collect(),
            ratios: (model.pairs.iter())
                .map(|p| p.friction.as_ref().map_or(0.0, |f| f.ratio))
                .collect(),
            pressed: vec![0.0; model.pairs.len()],
            faint: faint(model),
            tractions: multipliers::tractions(model),
            ..Watch::default()
        }
    }

    /// Takes what acts on bodies with inertia from the start on: `balance` as [`Assembler::balance`] has it.
    pub(super) fn start<L: PairLaw>(&mut self, assembler: &Assembler<L>, balance: &[f64]) {
        let n = self.reactions.len();
        self.reactions.copy_from_slice(&balance[..n]);
        let loads = self.loads.len();
        (self.loads).copy_from_slice(&assembler.external()[..loads]);
    }

    /// Goes on in the model of the next stage, whose forces at its start are these: `changed` is what contacts store more there
    /// than at the end of the stage before, which nobody put in, and `tractions` are those of the points with history.
    pub(super) fn enter<L: PairLaw>(
        self,
        model: &Model,
        assembler: &Assembler<L>,
        (residual, totals): (&[f64], &Totals),
        (changed, tractions): (f64, Vec<[f64; 2]>),
    ) -> Watch {
        let mut watch = Watch::new(model);
        let n = watch.reactions.len();
        watch.reactions.copy_from_slice(&residual[..n]);
        let loads = watch.loads.len();
        (watch.loads).copy_from_slice(&assembler.external()[..loads]);
        watch.surfaces.clone_from(&totals.surfaces);
        if watch.tractions.len() == tractions.len() {
            watch.tractions = tractions;
        }
        Watch {
            external: self.external,
            adjusted: self.adjusted + changed,
            imbalance: self.imbalance,
            turnover: self.turnover,
            stored: self.stored + changed,
            flow: self.flow,
            heading: self.heading.clone(),
            worst: self.worst,
            worst_step: self.worst_step,
            gained: self.gained,
            gained_step: self.gained_step,
            speed: self.speed,
            span: self.span,
            pressed: self.pressed,
            penalties: self.penalties,
            ratios: self.ratios,
            ..watch
        }
    }

    /// Into a checkpoint.
    pub(super) fn put(&self, out: &mut Writer) {
        let Watch {
            external,
            adjusted,
            imbalance,
            turnover,
            flow: Flow { most, work, lag },
            heading,
            worst,
            worst_step,
            gained,
            gained_step,
            speed,
            span,
            snaps,
            unstable,
            reactions,
            loads,
            surfaces,
            penalties,
            ratios,
            pressed,
            tractions,
            stored,
            faint: _,
        } = self;
        out.bool(*snaps);
        out.bool(*unstable);
        out.f64s(&[
            *external, *adjusted, *imbalance, *turnover, *worst, *stored, *gained,
        ]);
        out.f64s(&[*most, *work, *lag]);
        out.u32(*worst_step);
        out.u32(*gained_step);
        out.f64s(speed);
        out.f64s(span);
        for numbers in [reactions, loads, penalties, ratios, pressed] {
            out.count(numbers.len());
            out.f64s(numbers);
        }
        out.count(surfaces.len());
        for SurfaceForce { force, moment } in surfaces {
            out.f64s(force.as_slice());
            out.f64s(moment.as_slice());
        }
        out.count(tractions.len());
        out.f64s(tractions.as_flattened());
        heading.put(out);
    }

    /// [`Self::put`], read back for the same model.
    pub(super) fn take(model: &Model, from: &mut Reader) -> Result<Self, Malformed> {
        let mut watch = Watch::new(model);
        watch.snaps = from.bool()?;
        watch.unstable = from.bool()?;
        let mut sums = [0.0; 7];
        from.f64s(&mut sums)?;
        [
            watch.external,
            watch.adjusted,
            watch.imbalance,
            watch.turnover,
            watch.worst,
            watch.stored,
            watch.gained,
        ] = sums;
        let mut flow = [0.0; 3];
        from.f64s(&mut flow)?;
        let [most, work, lag] = flow;
        watch.flow = Flow { most, work, lag };
        watch.worst_step = from.u32()?;
        watch.gained_step = from.u32()?;
        from.f64s(&mut watch.speed)?;
        from.f64s(&mut watch.span)?;
        for numbers in [
            &mut watch.reactions,
            &mut watch.loads,
            &mut watch.penalties,
            &mut watch.ratios,
            &mut watch.pressed,
        ] {
            from.exactly(numbers.len(), "watched numbers")?;
            from.f64s(numbers)?;
        }
        from.exactly(watch.surfaces.len(), "surfaces")?;
        for SurfaceForce { force, moment } in &mut watch.surfaces {
            from.f64s(force.as_mut_slice())?;
            from.f64s(moment.as_mut_slice())?;
        }
        let count = match watch.tractions.is_empty() {
            true => from.exactly(0, "tractions").map(|()| 0)?,
            false => from.count(16)?,
        };
        watch.tractions.resize(count, [0.0; 2]);
        from.f64s(watch.tractions.as_flattened_mut())?;
        watch.heading = Heading::take(model, from)?;
        Ok(watch)
    }

    /// Gives an assembler the penalties of the last accepted step, under which its state is in equilibrium: those of the next one may
    /// have been chosen since, and forces under them would be others.
    pub fn in_equilibrium(&self, assembler: &mut Assembler) {
        assembler.penalties.copy_from_slice(&self.penalties);
        assembler.ratios.copy_from_slice(&self.ratios);
    }

    /// Work of a step that is solved. `residual` is that of all degrees of freedom; the assembler has evaluated the end of the
    /// step.
    ///
    /// # Errors
    /// A motion of a surface without a value at an end of the step, or a point that cannot be evaluated.
    pub fn work<L: PairLaw>(
        &self,
        model: &Model,
        assembler: &Assembler<L>,
        residual: &[f64],
        totals: &Totals,
        span: &Span,
    ) -> Result<Work, Fault> {
        let mut work = Work::beyond(self.faint);
        let (from, to) = (span.from.0, span.to.0);
        let n = self.reactions.len();
        let (was, now) = (&from.u[..n], &to.u[..n]);
        for (at, end) in [
            (&self.reactions, residual),
            (&self.loads, assembler.external()),
        ] {
            let [mut a, mut b] = [0.0; 2];
            for (i, (a_i, b_i)) in at.iter().zip(end).enumerate() {
                let du = now[i] - was[i];
                a += a_i * du;
                b += b_i * du;
            }
            work.add(a, b);
        }
        let twists = Twist::all(model, span)?;
        for ((twist, was), now) in twists.iter().zip(&self.surfaces).zip(&totals.surfaces) {
            if let Some(twist) = twist {
                work.add(twist.power(was), twist.power(now));
            }
        }
        work.adjusted += self.multipliers(model, assembler, span.to.0);
        work.changed = self.penalties != assembler.penalties || self.ratios != assembler.ratios;
        work.eased = self.eased([&assembler.penalties, &assembler.ratios]);
        Ok(work)
    }

    /// What acts at the end of an accepted step, whose work has been taken: [`Self::work`].
    pub fn accept<L: PairLaw>(
        &mut self,
        assembler: &Assembler<L>,
        residual: &[f64],
        totals: &Totals,
        span: &Span,
    ) {
        let n = self.reactions.len();
        self.reactions.copy_from_slice(&residual[..n]);
        let loads = self.loads.len();
        (self.loads).copy_from_slice(&assembler.external()[..loads]);
        self.surfaces.copy_from_slice(&totals.surfaces);
        self.speed = [faster::speed(span, n), self.speed[0]];
        self.penalties.copy_from_slice(&assembler.penalties);
        self.ratios.copy_from_slice(&assembler.ratios);
        self.keep_tractions(assembler.answers());
    }

    /// What a step gains out of nothing, as a part of the work turned over so far or of what was stored, where that is too much to be a path: `energy`
    /// as for [`Self::close`]. Not known of a first step and of overclosures.
    pub fn gained(
        &self,
        model: &Model,
        (step, large): (u32, bool),
        work: &Work,
        energy: f64,
    ) -> Option<f64> {
        let known = step > 1 && model.pairs.iter().all(|p| p.overclosure.is_none());
        let put_in = self.external + work.external + self.adjusted + work.adjusted;
        let gained = energy + self.imbalance - put_in;
        // What was stored already may have come in otherwise, with an overclosure that the first step resolved.
        let stored = self.external + self.adjusted - self.imbalance;
        let part = gained / (self.turnover + work.turnover).max(stored);
        let limit = GAINED[usize::from(work.changed && !large)];
        (known && gained > work.coarse && part > limit).then_some(part)
    }

    /// What a step loses or gains out of nothing, as a part of the work turned over so far, where its size does not explain it: `energy` as for [`Self::close`], which tells it once the step is accepted. Not known of a
    /// first step, of overclosures, and where penalties have changed; nothing once the path snaps however small steps are.
    pub fn jumped(&self, model: &Model, step: u32, work: &Work, energy: f64) -> Option<f64> {
        let known = step > 1
            && !self.snaps
            && !work.changed
            && model.pairs.iter().all(|p| p.overclosure.is_none());
        let lost = self.lost(work, energy).abs();
        let part = lost / (self.turnover + work.turnover).max(energy.abs());
        (known && lost > work.coarse && part > JUMP).then_some(part)
    }

    /// Energy that a step loses, negative where it gains some: `energy` as for [`Self::close`].
    pub fn lost(&self, work: &Work, energy: f64) -> f64 {
        let put_in = self.external + work.external + self.adjusted + work.adjusted;
        put_in - energy - self.imbalance
    }

    /// Closes the balance of a step. `pressed` are the sums of this name at its end, `energy` what is stored and what has been
    /// dissipated since the start, `stored` the part of it that penalties store; the step went from time `from` to `to`. What is told
    /// of a step that is out of balance, with whether elements that lost their hold may be why: not where penalties have changed.
    pub fn close(
        &mut self,
        model: &Model,
        (step, [from, to]): (u32, [f64; 2]),
        mut work: Work,
        pressed: &[f64],
        [energy, stored]: [f64; 2],
        softened: bool,
    ) -> Option<(String, bool)> {
        for ((pair, was), now) in model.pairs.iter().zip(&mut self.pressed).zip(pressed) {
            match &pair.overclosure {
                Some(over) => {
                    let shrunk = over.factor(from) - over.factor(to);
                    work.add(*was * shrunk, now * shrunk);
                    *was = *now;
                }
                // What the first step resolves has shrunk in it from all to nothing.
                None => work.add(0.0, *now),
            }
        }
        self.external += work.external;
        if work.changed {
            let put_in = self.external + self.adjusted + work.adjusted;
            work.adjusted +=
                self.put_in_by_penalties(step, &work, energy + self.imbalance - put_in);
        }
        self.stored = stored;
        self.adjusted += work.adjusted;
        let earlier = self.turnover;
        self.turnover += work.turnover;
        let before = self.imbalance;
        self.imbalance = self.external + self.adjusted - energy;
        let lost = self.imbalance - before;
        let last_span = std::mem::replace(&mut self.span, [from, to]);
        if lost.abs() > self.worst.abs() {
            (self.worst, self.worst_step) = (lost, step);
        }
        if -self.imbalance > self.gained {
            (self.gained, self.gained_step) = (-self.imbalance, step);
        }
        let part = lost.abs() / self.turnover.max(energy.abs());
        let limit = if softened { OTHER } else { JUMP };
        if lost.abs() > work.coarse && part > limit {
            self.snaps |= softened;
            let text = Jump { lost, part }.told(model, (step, [from, to]), softened);
            return Some((text, !work.changed));
        }
        // Where points with friction come to rest on the way there, the path decides about what they keep.
        let first = earlier < FIRST * self.turnover;
        if softened && !first && lost > 0.0 && part > JUMP && slides(model) {
            return Some((Jump { lost, part }.rubbed(model, (step, [from, to])), true));
        }
        let faster = Faster::of(model, self.speed, [last_span, [from, to]]);
        (faster.filter(|_| softened)).map(|faster| (faster.told((step, to)), true))
    }

    /// Sum of the sizes of all works so far, whatever their signs (energy).
    pub fn turned_over(&self) -> f64 {
        self.turnover
    }

    /// What is said of a run with friction whose energies are out of balance at its end. Without friction a state does not
    /// depend on the steps that led to it, only the sums of this watch do.
    pub fn drift(&self, model: &Model) -> Option<String> {
        let part = self.imbalance.abs() / self.turnover;
        (slides(model) && part > DRIFT).then(|| {
            format!(
                "the energies are out of balance by {:.3e} at the end, {:.1} % of the work, most of it in step {} ({:.3e}): the \
                 steps are too large for what happens in them, or the path jumped there. Take a smaller `solution.step.max`",
                self.imbalance,
                100.0 * part,
                self.worst_step,
                self.worst
            )
        })
    }
}

/// Whether any contact has friction.
fn slides(model: &Model) -> bool {
    model.pairs.iter().any(|p| p.friction.is_some())
}
