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
/// Part of the error, or of the deepest penetration, that a raise may leave at most. Under a penalty that is far too soft the
/// energy of contact grows with it at first; a penetration that is prescribed does not change at all.
const HELPS: f64 = 0.9;
const HELPS_DEPTH: f64 = 0.98;
/// Steps after which a penalty that did not serve is forgotten, and those after which one is where the error is untenable: what a
/// first touch cannot follow, the steps after it may.
const FORGOTTEN: u32 = 20;
const SOON: u32 = 3;
/// Steps until another raise is tried after one that did not serve, twice as many after the next one.
const WAIT: u32 = 2;

/// What is remembered of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PairRule {
    /// Penalty that did not serve (force / length^3); infinite where none is known.
    bad: f64,
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
            remembered,
            wait,
            failed,
            low,
            last,
        } in &self.pairs
        {
            out.f64(*bad);
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
            let bad = if known { rule.bad } else { f64::INFINITY };
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

    /// The penalties that a raise led to did not serve.
    pub fn reject(&mut self, before: &[f64], tried: &[f64]) {
        for ((rule, before), tried) in self.pairs.iter_mut().zip(before).zip(tried) {
            if tried > before {
                rule.bad = *tried;
                rule.remembered = FORGOTTEN;
                rule.wait = WAIT << rule.failed.min(8);
                rule.failed += 1;
            }
        }
    }

    /// Raises the penalty of a pair no more: a stiffer one is worse for a reason that stays. Two half passes have one penalty.
    pub fn keep(&mut self, model: &Model, index: usize, penalty: f64) {
        let other = model.pairs[index].half.map_or(index, |half| half.other);
        for pair in [index, other] {
            let rule = &mut self.pairs[pair];
            (rule.bad, rule.remembered) = (penalty, FOR_GOOD);
        }
    }

    /// Whether a raise lowered the errors by enough to be kept.
    pub fn helped(before: &Errors, after: &Errors) -> bool {
        after.sum() < HELPS * before.sum() || after.deepest() < HELPS_DEPTH * before.deepest()
    }

    /// Takes down the errors of an accepted step, of which the penalties were those `before` and are those of `now`.
    pub fn remember(&mut self, errors: &Errors, before: &[f64], now: &[f64]) {
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
                (rule.bad, rule.failed) = (f64::INFINITY, 0);
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
mod tests {
    use super::*;
    use crate::model::build::build;
    use crate::scene;
    use serde_json::json;

    /// A block under two tools, both with automatic penalties.
    fn model() -> Model {
        let tool = |z: f64| json!({ "plane": { "center": [0.5, 0.5, z], "size": [4, 4] }, "side": { "point": [0.5, 0.5, 0.5] } });
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 1e4, "nu": 0.3 } } },
            "bodies": { "block": {
                "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1] } }, "material": "m"
            } },
            "surfaces": { "above": tool(1.0), "below": tool(0.0) },
            "contacts": {
                "above": { "slave": "block.top", "master": "above" },
                "below": { "slave": "block.bottom", "master": "below", "accuracy": 1e-3 }
            },
            "supports": { "side": { "on": "block.x_min", "fixed": true } }
        });
        let loaded =
            scene::parse(&scene.to_string(), "scene.json").unwrap_or_else(|e| panic!("{e}"));
        build(&loaded).unwrap_or_else(|e| panic!("{e}"))
    }

    fn errors(forces: [f64; 2], sunk: [f64; 2]) -> Errors {
        Errors {
            forces: forces.to_vec(),
            sunk: sunk.to_vec(),
        }
    }

    #[test]
    fn only_pairs_that_make_the_error_are_raised() {
        let (model, rule) = (model(), PenaltyRule::new(&model()));
        let raised = |forces, sunk| {
            let mut penalties = vec![1.0, 1.0];
            let any = rule.raise(&model, &errors(forces, sunk), false, &mut penalties);
            assert_eq!(any, penalties != [1.0, 1.0]);
            penalties
                .iter()
                .map(|p| (p * 1e6).round() / 1e6)
                .collect::<Vec<_>>()
        };
        // Within the band of both; above that of the more accurate one, which makes next to nothing of it, and all of it.
        assert_eq!(raised([1e-3, 1e-3], [0.0; 2]), [1.0, 1.0]);
        assert_eq!(raised([9e-3, 1e-4], [0.0; 2]), [1.0, 1.0]);
        assert_eq!(raised([0.0, 5e-3], [0.0; 2]), [1.0, 5.0]);
        // Towards the accuracy asked for; farther at once where contact gives way more than the block.
        assert_eq!(raised([0.04, 0.0], [0.0; 2]), [10.0, 1.0]);
        assert_eq!(raised([0.8, 0.0], [0.0; 2]), [100.0, 1.0]);
        assert_eq!(raised([8.0, 0.0], [0.0; 2]), [2000.0, 1.0]);
        // Too deep, however small the error.
        assert_eq!(raised([1e-6, 1e-6], [0.0, 2.0]), [1.0, 20.0]);
    }

    /// What the first penalty becomes for an error of its pair.
    fn raised(rule: &PenaltyRule, model: &Model, again: bool, error: f64, from: f64) -> f64 {
        let mut penalties = vec![from; 2];
        let errors = errors([error, 0.0], [0.0; 2]);
        rule.raise(model, &errors, again, &mut penalties);
        (penalties[0] * 1e6).round() / 1e6
    }

    #[test]
    fn a_penalty_that_did_not_serve_is_approached_by_halves_and_forgotten() {
        let (model, mut rule) = (model(), PenaltyRule::new(&model()));
        rule.reject(&[1.0, 1.0], &[100.0, 1.0]);
        let of = |rule: &PenaltyRule, again, error| raised(rule, &model, again, error, 1.0);
        // Half as far, by the logarithm; not at once in a later step, unless the error is large.
        assert_eq!(of(&rule, true, 0.02), 5.0);
        assert_eq!(of(&rule, true, 0.2), 10.0);
        assert_eq!(of(&rule, false, 0.02), 1.0);
        assert_eq!(of(&rule, false, 0.2), 10.0);
        let mut penalties = vec![1.0, 1.0];
        let none = errors([0.0; 2], [0.0; 2]);
        for _ in 0..SOON {
            rule.lower(&model, &none, 0, &mut penalties);
        }
        // A large error is not borne for long, a small one is.
        assert_eq!(of(&rule, false, 0.2), 50.0);
        assert_eq!(of(&rule, true, 0.02), 5.0);
        for _ in SOON..FORGOTTEN {
            rule.lower(&model, &errors([0.0; 2], [0.0; 2]), 0, &mut penalties);
        }
        assert_eq!(of(&rule, false, 0.2), 50.0);
        assert_eq!(penalties, [1.0, 1.0]);
    }

    #[test]
    fn a_penalty_that_is_kept_is_raised_no_more() {
        let (model, mut rule) = (model(), PenaltyRule::new(&model()));
        assert_eq!(raised(&rule, &model, false, 8.0, 3.0), 6000.0);
        rule.keep(&model, 0, 3.0);
        let none = errors([0.0; 2], [0.0; 2]);
        for _ in 0..2 * FORGOTTEN {
            rule.lower(&model, &none, 0, &mut [3.0, 3.0]);
        }
        for error in [0.02, 0.8, 8.0] {
            for again in [false, true] {
                assert_eq!(raised(&rule, &model, again, error, 3.0), 3.0);
            }
        }
    }

    /// A step that fails softens what is far stiffer than asked for, once, by what its error was at the last accepted step.
    #[test]
    fn a_failed_step_eases_what_is_too_stiff() {
        let (model, mut rule) = (model(), PenaltyRule::new(&model()));
        let mut penalties = vec![1e6, 1e6];
        assert!(!rule.ease(&model, &mut penalties));
        rule.remember(&errors([4e-6, 2e-3], [0.0; 2]), &[1e6, 1e6], &[1e6, 1e6]);
        assert!(rule.ease(&model, &mut penalties));
        assert_eq!(penalties, [1e3, 1e6]);
        // Its error is by first order what was asked for.
        assert!(!rule.ease(&model, &mut penalties));
        // The error that was measured before a penalty rose by ten.
        rule.remember(&errors([4e-4, 2e-3], [0.0; 2]), &[1e3, 1e6], &[1e4, 1e6]);
        penalties[0] = 1e4;
        assert!(rule.ease(&model, &mut penalties));
        assert_eq!(penalties, [100.0, 1e6]);
    }

    #[test]
    fn what_costs_iterations_for_no_error_is_lowered() {
        let model = model();
        let lowered = |error: f64, iterations: u32| {
            let (mut rule, mut penalties) = (PenaltyRule::new(&model), vec![1.0, 1.0]);
            for step in 1..=IDLE {
                let any = rule.lower(
                    &model,
                    &errors([error, 0.0], [0.0; 2]),
                    iterations,
                    &mut penalties,
                );
                assert_eq!(any, step == IDLE && penalties[0] != 1.0);
            }
            (penalties[0] * 1e6).round() / 1e6
        };
        assert_eq!(lowered(4e-5, MANY + 1), 0.01);
        assert_eq!(lowered(2e-4, MANY + 1), 0.05);
        assert_eq!(lowered(4e-5, MANY), 1.0);
        assert_eq!(lowered(1e-3, MANY + 1), 1.0);
        assert_eq!(lowered(0.0, MANY + 1), 1.0);
    }

    #[test]
    fn what_smaller_steps_do_not_help_is_accepted_at_last() {
        let model = model();
        let told = |error, cuts| untenable(&model, &errors([error, 0.0], [0.0; 2]), cuts);
        assert_eq!(told(7e-3, 0), None);
        assert_eq!(told(0.02, 0), Some(0.02));
        assert_eq!(told(0.02, 2), None);
        assert_eq!(told(0.5, 2), Some(0.5));
        assert_eq!(told(0.5, 2 * RELENTS + 1), None);
    }
}
