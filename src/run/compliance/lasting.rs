//! The error to rigid contact that lasts from step to step.
use super::HELPED;
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};

/// What steps in a row showed. A single one may be that of a point just about to slide.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lasting {
    /// The error at the last step that was measured, and at that one and the one before alike.
    before: f64,
    pub now: f64,
    /// The error when it last raised a penalty, while it is too large; else infinite.
    raised: f64,
}

impl Lasting {
    pub const NONE: Lasting = Lasting {
        before: 0.0,
        now: 0.0,
        raised: f64::INFINITY,
    };

    /// Takes the error of a step; whether the penalty is to be raised for what lasts, above `bound`.
    pub fn step(&mut self, error: f64, bound: f64) -> bool {
        self.now = error.min(std::mem::replace(&mut self.before, error));
        if self.now <= bound {
            self.raised = f64::INFINITY;
            return false;
        }
        // What a stiffer penalty did not lower, another will not.
        if error > HELPED * self.raised {
            return false;
        }
        self.raised = error;
        true
    }

    pub fn put(&self, out: &mut Writer) {
        let Lasting {
            before,
            now,
            raised,
        } = self;
        out.f64s(&[*before, *now, *raised]);
    }

    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        let mut numbers = [0.0; 3];
        from.f64s(&mut numbers)?;
        let [before, now, raised] = numbers;
        Ok(Lasting {
            before,
            now,
            raised,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_raise_does_not_lower_is_left_alone() {
        let mut own = Lasting::NONE;
        assert!(!own.step(0.1, 0.01), "a single step");
        assert!(own.step(0.1, 0.01));
        assert!(!own.step(0.1, 0.01), "it did not help");
        assert!(own.step(0.07, 0.01), "it did");
        // Until the error has been small.
        assert!(!own.step(0.005, 0.01));
        assert!(!own.step(0.1, 0.01));
        assert!(own.step(0.1, 0.01));
    }
}
