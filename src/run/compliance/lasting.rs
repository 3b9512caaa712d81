//! The error to rigid contact that lasts from step to step, and what raises of the penalty did about it.
use super::HELPED;
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};

/// Factor of a raise from which on it should have shown in the error.
const SHOWS: f64 = 2.0;

/// What steps in a row showed. A single one may be that of a point just about to slide.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lasting {
    /// The error at the last step that was measured, and at that one and the one before alike.
    before: f64,
    pub now: f64,
    /// The error when it last raised a penalty, while it is too large; else infinite.
    raised: f64,
    /// A raise did not help.
    vain: bool,
}

impl Lasting {
    pub const NONE: Lasting = Lasting {
        before: 0.0,
        now: 0.0,
        raised: f64::INFINITY,
        vain: false,
    };

    /// Takes the error of a step, before which penalties had been raised by the factor `stiffened`; whether the penalty is to be
    /// raised for what lasts, above `bound`.
    pub fn step(&mut self, error: f64, stiffened: f64, bound: f64) -> bool {
        self.now = error.min(std::mem::replace(&mut self.before, error));
        if self.now <= bound {
            (self.raised, self.vain) = (f64::INFINITY, false);
            return false;
        }
        // What a stiffer penalty did not lower, another will not; one that is hardly stiffer has not been tried.
        self.vain |= stiffened >= SHOWS && error > HELPED * self.raised;
        self.raised = error;
        !self.vain
    }

    pub fn put(&self, out: &mut Writer) {
        let Lasting {
            before,
            now,
            raised,
            vain,
        } = self;
        out.f64s(&[*before, *now, *raised]);
        out.bool(*vain);
    }

    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        let mut numbers = [0.0; 3];
        from.f64s(&mut numbers)?;
        let [before, now, raised] = numbers;
        Ok(Lasting {
            before,
            now,
            raised,
            vain: from.bool()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_raise_does_not_lower_is_left_alone() {
        let mut own = Lasting::NONE;
        assert!(!own.step(0.1, 1.0, 0.01), "a single step");
        assert!(own.step(0.1, 1.0, 0.01));
        // One by little has not been tried, nor one that was taken back.
        assert!(own.step(0.12, 1.3, 0.01));
        assert!(own.step(0.13, 1.0, 0.01));
        assert!(own.step(0.07, 10.0, 0.01), "it helped");
        assert!(!own.step(0.07, 10.0, 0.01), "it did not");
        assert!(!own.step(0.15, 1.0, 0.01));
        // Until the error has been small.
        assert!(!own.step(0.005, 10.0, 0.01));
        assert!(!own.step(0.1, 1.0, 0.01));
        assert!(own.step(0.1, 1.0, 0.01));
    }
}
