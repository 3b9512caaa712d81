//! Automatic penalties, ruled by the error that they make.
//!
//! A contact's penalty starts soft. The error that every pair makes in the forces ([`super::compliance`]) is measured at the end
//! of every step, before the step is accepted, and kept in a band: above [`HIGH`] the step is solved again, from where it is,
//! under a stiffer penalty; below [`LOW`], where steps take many iterations, the next ones have a softer one. The work of
//! contact is what a penalty costs in accuracy, so the size of an element does not decide, nor a deep point, as long as the
//! layers of a stack stay apart ([`Ruled::deepest`](crate::model::penalty::Ruled::deepest)).
//!
//! A raise that Newton's method cannot follow is tried half as far, by its logarithm; one that does not lower the error is taken
//! back, and not tried again for a while. Where none serves and the error is large, the step is cut a few times; then it is
//! taken as it is. What error is left is told at the end of the run.
use crate::model::{Model, PairModel};
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use crate::run::compliance::Errors;

/// Bounds of the band, as multiples of the accuracy asked for: an error above the larger one raises a penalty, one below the
/// smaller one may lower it.
const HIGH: f64 = 2.5;
const LOW: f64 = 0.075;
/// The same, above which a penalty that was softened to get through a step is too soft to be accepted.
const UNTENABLE: f64 = 7.5;
/// Penetration, relative to what is too deep, above which no raise waits.
const SUNK: f64 = 3.0;
/// Cuts of a step after each of which twice as much is accepted; after twice as many all of it is.
const RELENTS: u32 = 2;
/// Steps in a row with so low an error, and their mean number of iterations, after which a penalty is lowered.
const IDLE: u32 = 3;
const MANY: u32 = 8;
/// Part of the largest error of a pair that another has to make to be raised with it.
const SHARE: f64 = 0.1;
/// Smallest and largest factor of a raise, and the largest where contact gives way more than the bodies do.
const RAISE: [f64; 3] = [2.0, 100.0, 1e4];
/// Smallest factor of a lowering, and where a step fails.
const LOWER: f64 = 0.01;
const EASE: f64 = 1e-4;
/// Factor of a raise by depth, times how much too deep points are.
const DEEPER: f64 = 10.0;
/// Part of the error, or of the deepest penetration, that a raise may leave at most; a penetration that is prescribed does not change
/// at all. Beyond the last error contact gives way more than the bodies do, and its energy grows with the penalty at first.
const HELPS: f64 = 0.9;
const HELPS_DEPTH: f64 = 0.98;
const FAR: f64 = 1.0;
/// Steps after which a penalty that did not serve is forgotten, and those after which one is where the error is untenable: what a
/// first touch cannot follow, the steps after it may.
const FORGOTTEN: u32 = 20;
const SOON: u32 = 3;
/// Times of the error under which a penalty is raised no more that it may grow to: beyond, that penalty is too soft after all.
const OUTGROWN: f64 = 2.0;
/// Steps until another raise is tried after one that did not serve, twice as many after the next one.
const WAIT: u32 = 2;

/// What is remembered of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PairRule {
    /// Penalty that did not serve (force / length^3); infinite where none is known.
    bad: f64,
    /// Error of all pairs at which no stiffer one is to be tried at all; infinite where that was not found.
    kept: f64,
    /// Error of all pairs that was not lowered by that penalty; infinite where that was not found.
    found: f64,
    /// Steps for which that is remembered, and those until another raise is tried.
    remembered: u32,
    wait: u32,
    /// Raises in a row that did not serve.
    failed: u32,
    /// Steps in a row in which the error was low, and their iterations.
    low: [u32; 2],
    /// Error and depth ([`Errors`]) at the last accepted step, by first order those under the penalty of now.
    last: [f64; 2],
}

impl PairRule {
    const NEW: PairRule = PairRule {
        bad: f64::INFINITY,
        kept: f64::INFINITY,
        found: f64::INFINITY,
        remembered: 0,
        wait: 0,
        failed: 0,
        low: [0; 2],
        last: [0.0; 2],
    };
}

/// Steps after which what did not serve is still remembered.
const FOR_GOOD: u32 = u32::MAX / 2;

/// The rule of all pairs.
#[derive(Debug, Clone, PartialEq)]
pub struct PenaltyRule {
    pairs: Vec<PairRule>,
}

impl PenaltyRule {
    /// Nothing is known yet.
    pub fn new(model: &Model) -> Self {
        PenaltyRule {
            pairs: vec![PairRule::NEW; model.pairs.len()],
        }
    }

    /// Into a checkpoint.
    pub(super) fn put(&self, out: &mut Writer) {
        for PairRule {
            bad,
            kept,
            found,
            remembered,
            wait,
            failed,
            low,
            last,
        } in &self.pairs
        {
            out.f64(*bad);
            out.f64(*kept);
            out.f64(*found);
            [remembered, wait, failed]
                .into_iter()
                .for_each(|n| out.u32(*n));
            low.iter().for_each(|n| out.u32(*n));
            out.f64s(last);
        }
    }

    /// [`Self::put`], read back for the same model.
    pub(super) fn take(model: &Model, from: &mut Reader) -> Result<Self, Malformed> {
        let mut rule = PenaltyRule::new(model);
        for pair in &mut rule.pairs {
            *pair = PairRule {
                bad: from.f64()?,
                kept: from.f64()?,
                found: from.f64()?,
                remembered: from.u32()?,
                wait: from.u32()?,
                failed: from.u32()?,
                low: [from.u32()?, from.u32()?],
                last: [from.f64()?, from.f64()?],
            };
        }
        Ok(rule)
    }

    /// Raises the penalties of pairs whose errors are too large, or whose points sink in too deep; whether there were any.
    /// `again` says that a raise of the same step did not serve: half as far, by its logarithm, is tried at once.
    pub fn raise(
        &self,
        model: &Model,
        errors: &Errors,
        again: bool,
        penalties: &mut [f64],
    ) -> bool {
        let total = errors.sum();
        let largest = errors.forces.iter().fold(0.0f64, |a, b| a.max(*b));
        let mut raised = false;
        let [least, many, most] = RAISE;
        let most = if total > 1.0 { most } else { many };
        for (index, pair) in model.pairs.iter().enumerate() {
            let Some(ruled) = pair.ruled else { continue };
            // The second of two half passes goes with the first.
            let other = pair.half.map_or(index, |half| half.other);
            if pair.half.is_some_and(|half| half.back) {
                continue;
            }
            let of = |values: &[f64]| values[index].max(values[other]);
            let (error, sunk) = (of(&errors.forces), of(&errors.sunk));
            let rule = &self.pairs[index];
            let accuracy = ruled.accuracy;
            let counts = total > HIGH * accuracy && error >= SHARE * largest;
            let waits = rule.wait > 0 && !again && total <= UNTENABLE * accuracy && sunk <= SUNK;
            if !counts && sunk <= 1.0 || waits {
                continue;
            }
            let by_error = match counts {
                true => two_digits(total / accuracy).clamp(least, most),
                false => 1.0,
            };
            // What is far too soft gives way by as much under a little more.
            let by_depth = match sunk > 1.0 {
                true => two_digits(DEEPER * sunk),
                false => 1.0,
            };
            // Between what serves and what does not.
            let untenable = total > UNTENABLE * accuracy;
            let known = again || !untenable || rule.remembered + SOON > FORGOTTEN;
            let before = rule.kept.min(rule.found);
            let outgrown =
                untenable && total > OUTGROWN * before || rule.kept.is_finite() && sunk > 1.0;
            let bad = match known && !outgrown {
                true => rule.bad,
                false => f64::INFINITY,
            };
            let between = (penalties[index] * bad).sqrt();
            let bound = ruled.stiffest.min(between);
            let eps = (penalties[index] * by_error.max(by_depth.min(most))).min(bound);
            // A little more would not be worth another solution.
            if eps >= 1.2 * penalties[index] {
                set(model, index, eps, penalties);
                raised = true;
            }
        }
        raised
    }

    /// The penalties that a raise led to did not serve: they did not lower this error, or could not be followed.
    pub fn reject(&mut self, before: &[f64], tried: &[f64], error: Option<f64>) {
        for ((rule, before), tried) in self.pairs.iter_mut().zip(before).zip(tried) {
            if tried > before {
                rule.bad = *tried;
                rule.found = error.unwrap_or(f64::INFINITY);
                rule.remembered = FORGOTTEN;
                rule.wait = WAIT << rule.failed.min(8);
                rule.failed += 1;
            }
        }
    }

    /// Raises the penalty of a pair no more, as long as the error of now does not grow and no point sinks in too deep: a stiffer one is
    /// worse for a reason that stays. Two half passes have one penalty.
    pub fn keep(&mut self, model: &Model, index: usize, penalty: f64, error: f64) {
        let other = model.pairs[index].half.map_or(index, |half| half.other);
        for pair in [index, other] {
            let rule = &mut self.pairs[pair];
            (rule.bad, rule.kept, rule.remembered) = (penalty, error, FOR_GOOD);
            rule.found = f64::INFINITY;
        }
    }

    /// The pairs whose penalties, now `penalties`, have been raised beyond one that was kept.
    pub fn left_behind(&self, penalties: &[f64]) -> impl Iterator<Item = usize> {
        let rules = self.pairs.iter().zip(penalties).enumerate();
        rules.filter_map(|(i, (rule, now))| (rule.kept.is_finite() && *now > rule.bad).then_some(i))
    }

    /// Whether nothing is known of a raise by the error that is left: where contact between bodies gives way more than these do, which hardly
    /// feel it, its energy grows with the penalty at first.
    pub fn unknown(model: &Model, before: &Errors) -> bool {
        before.sum() > FAR && between_bodies(model)
    }

    /// Whether a raise lowered the errors by enough to be kept.
    pub fn helped(before: &Errors, after: &Errors) -> bool {
        after.sum() < HELPS * before.sum() || after.deepest() < HELPS_DEPTH * before.deepest()
    }

    /// Takes down the errors of an accepted step, of which the penalties were those `before` and are those of `now`.
    pub fn remember(&mut self, errors: &Errors, before: &[f64], now: &[f64]) {
        for index in self.left_behind(now).collect::<Vec<_>>() {
            let rule = &mut self.pairs[index];
            (rule.bad, rule.kept) = (f64::INFINITY, f64::INFINITY);
            (rule.found, rule.remembered) = (f64::INFINITY, 0);
        }
        let all = errors.forces.iter().zip(&errors.sunk);
        for ((rule, errors), (before, now)) in
            (self.pairs.iter_mut().zip(all)).zip(before.iter().zip(now))
        {
            rule.last = [errors.0, errors.1].map(|e| e * before / now);
        }
    }

    /// Lowers the penalties of pairs that made next to no error at the last accepted step, because a step fails: a clamp that was
    /// pressed before anything was bent is far stiffer than what is bent now asks for.
    pub fn ease(&mut self, model: &Model, penalties: &mut [f64]) -> bool {
        let before = penalties.to_vec();
        for (index, pair) in model.pairs.iter().enumerate() {
            if let Some(factor) = softer(pair, index, |i| self.pairs[i].last) {
                set(model, index, before[index] * factor.max(EASE), penalties);
            }
        }
        let all = self.pairs.iter_mut().zip(before.iter().zip(&*penalties));
        all.for_each(|(rule, (before, now))| rule.last = rule.last.map(|e| e * before / now));
        before != penalties
    }

    /// Lowers the penalties of pairs that make next to no error and may be what the iterations of the last steps were for.
    pub fn lower(
        &mut self,
        model: &Model,
        errors: &Errors,
        iterations: u32,
        penalties: &mut [f64],
    ) -> bool {
        let mut lowered = false;
        for (index, pair) in model.pairs.iter().enumerate() {
            let rule = &mut self.pairs[index];
            rule.wait = rule.wait.saturating_sub(1);
            rule.remembered = rule.remembered.saturating_sub(1);
            if rule.remembered == 0 {
                (rule.bad, rule.kept) = (f64::INFINITY, f64::INFINITY);
                (rule.found, rule.failed) = (f64::INFINITY, 0);
            }
            let of = |i: usize| [errors.forces[i], errors.sunk[i]];
            let Some(factor) = softer(pair, index, of) else {
                rule.low = [0; 2];
                continue;
            };
            let [steps, sum] = &mut rule.low;
            *steps += 1;
            *sum = sum.saturating_add(iterations);
            if *steps >= IDLE && *sum > MANY * *steps {
                rule.low = [0; 2];
                let eps = penalties[index] * factor.max(LOWER);
                set(model, index, eps, penalties);
                lowered = true;
            } else if *steps >= IDLE {
                rule.low = [0; 2];
            }
        }
        lowered
    }
}

/// Factor, at most 1, to a penalty that makes the error asked for, where that of now makes next to none; none where it does, or
/// where nothing touches and nothing is known. Of two half passes, which have one penalty, the larger error counts, and the
/// second goes with the first. `of` are error and depth of a pair.
fn softer(pair: &PairModel, index: usize, of: impl Fn(usize) -> [f64; 2]) -> Option<f64> {
    let ruled = pair.ruled.filter(|_| pair.half.is_none_or(|h| !h.back))?;
    let ([a, b], [c, d]) = (of(index), of(pair.half.map_or(index, |half| half.other)));
    let (error, sunk) = (a.max(c), b.max(d));
    if error <= 0.0 || error >= LOW * ruled.accuracy {
        return None;
    }
    Some(two_digits((error / ruled.accuracy).max(sunk)).min(1.0))
}

/// Whether a penalty that was softened to get through a step is too soft to be accepted, and the error that it makes. Where
/// smaller steps have not helped, more is accepted: what is left is told at the end.
pub fn untenable(model: &Model, errors: &Errors, cuts: u32) -> Option<f64> {
    let total = errors.sum();
    let aims = (model.pairs.iter()).filter_map(|p| Some(p.ruled?.accuracy));
    if cuts > 2 * RELENTS {
        return None;
    }
    let bound = UNTENABLE * f64::from(1 << cuts.min(RELENTS));
    let allowed = aims.fold(f64::INFINITY, |a, aim| a.min(bound * aim));
    (total > allowed).then_some(total)
}

/// Whether bodies meet bodies, and no edges of rigid surfaces.
pub fn between_bodies(model: &Model) -> bool {
    !model.has_rims() && model.pairs.iter().any(|p| p.body_master().is_some())
}

/// A factor to two digits: what rounding makes of an error, in other units or far from the origin, is not to reach the forces.
fn two_digits(factor: f64) -> f64 {
    if !(factor > 0.0 && factor.is_finite()) {
        return factor;
    }
    let unit = 10f64.powi(factor.log10().floor() as i32 - 1);
    (factor / unit).round() * unit
}

/// The smallest error that raises a penalty; infinite where the run chooses none.
pub fn raises_from(model: &Model) -> f64 {
    let rules = model.pairs.iter().filter_map(|p| p.ruled);
    rules.fold(f64::INFINITY, |a, r| a.min(HIGH * r.accuracy))
}

/// Sets the penalty of a pair; two half passes have one.
fn set(model: &Model, index: usize, eps: f64, penalties: &mut [f64]) {
    let other = model.pairs[index].half.map_or(index, |half| half.other);
    penalties[index] = eps;
    penalties[other] = eps;
}

/// Whether the run may choose the penalty of every pair.
pub fn rules_all(model: &Model) -> bool {
    model.pairs.iter().all(|p: &PairModel| p.ruled.is_some())
}

#[cfg(test)]
mod tests;
