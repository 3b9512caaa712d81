//! Augmentation of a step in equilibrium (Uzawa's method): tractions become multipliers, so that the penalties have to carry
//! the rest only, and gaps and elastic slip shrink.
//!
//! For a mode of compliance `C` (gap per pressure) an augmentation leaves the part `1 / (1 + eps C)` of a gap: a soft penalty
//! converges slowly. The parts that successive augmentations leave tell `eps C` of the slowest mode, and where it is too
//! little the penalty is raised to what would leave a tenth, never beyond what double precision carries
//! ([`AugmentationModel::stiffest`]). Raising is preferred to extrapolating the multipliers: it stays right where points open
//! and close.
//!
//! [`AugmentationModel::stiffest`]: crate::model::augmentation::AugmentationModel::stiffest
use crate::assembly::PointAnswer;
use crate::model::state::State;
use crate::model::{Model, PairModel};
use crate::solve::newton::StepFailure;
use std::ops::Range;

/// Part of a gap that an augmentation may leave before the penalty is raised.
const SLOW: f64 = 0.25;
/// Part of a gap that it should leave then.
const WANTED: f64 = 0.1;
/// Largest factor of a raise: the gaps of the first augmentations are those of softer modes.
const FACTOR: f64 = 10.0;

/// How far a pair in equilibrium is from its tolerances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Left {
    pub pair: usize,
    /// Largest gap of a point in contact (length).
    pub gap: f64,
    /// Largest elastic slip of a point that sticks (length).
    pub slip: f64,
    /// The larger of both relative to their tolerances.
    pub relative: f64,
}

impl Left {
    /// What the answers of the points leave, for every pair with augmentation.
    pub fn all(model: &Model, state: &State, answers: &[Option<PointAnswer>], out: &mut Vec<Left>) {
        out.clear();
        for (pair, p) in model.pairs.iter().enumerate() {
            let (Some(allowed), Some(range)) = (&p.augmentation, state.history(model, pair)) else {
                continue;
            };
            let (mut gap, mut slip) = (0.0f64, 0.0f64);
            for answer in answers[range].iter().flatten() {
                gap = gap.max(answer.gap.abs());
                if !answer.slides {
                    slip = slip.max(answer.elastic);
                }
            }
            out.push(Left {
                pair,
                gap,
                slip,
                relative: (gap / allowed.gap).max(slip / allowed.slip),
            });
        }
    }

    /// The failure of a step that has been augmented as often as it may.
    pub fn failure(&self, model: &Model, augmentations: u32) -> StepFailure {
        let pair = &model.pairs[self.pair];
        let (mut what, mut left, mut allowed) = ("a gap", self.gap, 0.0);
        if let Some(a) = &pair.augmentation {
            allowed = a.gap;
            if self.slip / a.slip > self.gap / a.gap {
                (what, left, allowed) = ("an elastic slip", self.slip, a.slip);
            }
        }
        StepFailure::NotAugmented {
            pair: pair.name.clone(),
            augmentations,
            what,
            left,
            allowed,
        }
    }
}

/// The penalty that leaves less, where an augmentation under `eps` has left the part `left` of the gaps; nothing where it is
/// not to be raised.
pub(super) fn stiffer(pair: &PairModel, eps: f64, left: f64) -> Option<f64> {
    let stiffest = pair.augmentation?.stiffest;
    if left <= SLOW || eps >= stiffest {
        return None;
    }
    let factor = (1.0 / WANTED - 1.0) * left / (1.0 - left).max(f64::MIN_POSITIVE);
    Some((eps * factor.clamp(1.0, FACTOR)).min(stiffest))
}

/// Makes multipliers of the tractions of a state in equilibrium. An open point has no pressure; its tangential traction stays
/// what it was tied by, for the case that it closes again.
pub(super) fn take(model: &Model, answers: &[Option<PointAnswer>], state: &mut State) {
    for range in augmented(model, state) {
        let histories = state.histories[range.clone()].iter_mut();
        for (history, answer) in histories.zip(&answers[range]) {
            match answer {
                Some(answer) => {
                    history.lambda_n = answer.n;
                    history.lambda = answer.t;
                }
                None => history.lambda_n = 0.0,
            }
        }
    }
}

/// Forgets the normal multipliers: a start that is to come in softly does without them.
pub(super) fn forget(model: &Model, state: &mut State) {
    for range in augmented(model, state) {
        (state.histories[range].iter_mut()).for_each(|history| history.lambda_n = 0.0);
    }
}

/// Where the histories of the pairs with augmentation are.
fn augmented(model: &Model, state: &State) -> Vec<Range<usize>> {
    let pairs = model.pairs.iter().enumerate();
    let augmented = pairs.filter(|(_, p)| p.augmentation.is_some());
    augmented
        .filter_map(|(index, _)| state.history(model, index))
        .collect()
}
