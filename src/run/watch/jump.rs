//! What is told of a step whose energies do not balance.
use crate::model::Model;
use crate::model::error::number;
use crate::run::remedy::smoother;

/// A step whose energies do not balance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Energy that the step lost, negative where it gained some.
    pub lost: f64,
    /// The same as a part of the work turned over so far.
    pub part: f64,
}

impl Jump {
    /// What the user is told; `softened` says that the step was solved from a softened penalty only.
    pub(super) fn told(
        &self,
        model: &Model,
        (step, [from, to]): (u32, [f64; 2]),
        softened: bool,
    ) -> String {
        self.words((step, to), softened, &smoother(model, from))
    }

    /// The same with the remedy in words.
    pub(in crate::run) fn words(
        &self,
        (step, time): (u32, f64),
        softened: bool,
        remedy: &str,
    ) -> String {
        let (did, what) = match self.lost > 0.0 {
            true => ("lost", "went"),
            false => ("gained", "came"),
        };
        let why = match softened {
            true => {
                "it was solved from a softened penalty only, and may have come to another equilibrium"
            }
            false => "the path jumped (snap-through, or contact lost)",
        };
        format!(
            "step {step} (time {}) {did} an energy of {:.3e} that {what} nowhere, {:.1} % of the work so far and more than the \
             size of the step explains: {why}. {remedy}; otherwise what follows is one of several states that are possible after the \
             jump",
            number(time),
            self.lost.abs(),
            100.0 * self.part
        )
    }

    /// The same of a step with friction that was solved from a softened penalty and lost some, and whose size may explain it.
    pub(super) fn rubbed(&self, model: &Model, (step, [from, to]): (u32, [f64; 2])) -> String {
        format!(
            "step {step} (time {}) lost an energy of {:.3e} that went nowhere, {:.1} % of the work so far, and was solved from a \
             softened penalty only: with friction points may have come to rest at other places on that way, and keep what they have \
             there. {}, and compare",
            number(to),
            self.lost,
            100.0 * self.part,
            smoother(model, from)
        )
    }
}
