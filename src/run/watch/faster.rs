//! Steps that were solved from a softened penalty only and moved much faster than the ones before.
use super::{Span, Watch, Work};
use crate::model::Model;
use crate::model::error::number;
use crate::solve::failure::StepFailure;

/// Multiple of the speed of the last step above which such a step is cut, and told where it is taken all the same.
const FASTER: f64 = 10.0;

/// How much faster a step moved than the one before.
pub(super) struct Faster {
    times: f64,
    /// The same of what is prescribed, where that is faster itself.
    pace: f64,
}

/// Largest displacement of one of the first `n` unknowns by the time it took.
pub(super) fn speed(span: &Span, n: usize) -> f64 {
    let (was, now) = (&span.from.0.u[..n], &span.to.0.u[..n]);
    let moved = was.iter().zip(now).map(|(a, b)| (b - a).abs());
    moved.fold(0.0, f64::max) / (span.to.1 - span.from.1)
}

impl Faster {
    /// Of a step and the one before, by their speeds, the later one first, and their spans, the earlier one first.
    pub(super) fn of(
        model: &Model,
        [speed, last]: [f64; 2],
        [before, now]: [[f64; 2]; 2],
    ) -> Option<Faster> {
        if last <= 0.0 || speed <= FASTER * last {
            return None;
        }
        let pace = model.quickened(before, now).max(1.0);
        let times = speed / last;
        (times > FASTER * pace).then_some(Faster { times, pace })
    }

    /// What the user is told of it.
    pub(super) fn told(&self, (step, time): (u32, f64)) -> String {
        let prescribed = match self.pace > 1.0 {
            true => format!(", and what is prescribed {:.1} times as fast", self.pace),
            false => String::new(),
        };
        format!(
            "step {step} (time {}) was solved from a softened penalty only, and moved {:.0} times as fast as the step before\
             {prescribed}: it may have come to another equilibrium. Take smaller steps",
            number(time),
            self.times
        )
    }
}

impl Watch {
    /// Why a step without inertia is not to be taken, which was `softened` or slid over edges that are slaves, where its size does not
    /// explain where it went: its energies are out of balance, or it moved much faster than the one before. `energy` as for
    /// [`Self::close`].
    pub fn leapt(
        &self,
        model: &Model,
        step: u32,
        (work, energy): (&Work, f64),
        (span, softened): (&Span, bool),
    ) -> Option<StepFailure> {
        if model.dynamics.is_some() || !(softened || model.has_rims()) {
            return None;
        }
        if let Some(part) = self.jumped(model, step, work, energy) {
            return Some(StepFailure::Jumped { part });
        }
        if !softened {
            return None;
        }
        let speeds = [speed(span, self.reactions.len()), self.speed[0]];
        let faster = Faster::of(model, speeds, [self.span, [span.from.1, span.to.1]])?;
        Some(StepFailure::Faster {
            times: faster.times,
        })
    }
}
