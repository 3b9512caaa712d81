//! When Newton's method may stop.
//!
//! A thin shell under a stiff penalty cannot reach a small residual relative to its load: rounding of the
//! displacements alone leaves about `eps |K| |u|`, which grows with (length / thickness)^3 and with the penalty. The
//! test therefore compares the residual with the larger of a tolerance on the forces and a small multiple of that
//! floor, and never stops while points still change their status, but where next to no force is left for
//! them to change, iteration after iteration.

/// Norms of one linearisation, all over the free degrees of freedom.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Norms {
    /// Residual.
    pub residual: f64,
    /// Largest of: external forces with reactions, contact forces.
    pub force: f64,
    /// Round-off floor `eps | |K| |u| |`.
    pub floor: f64,
}

/// Verdict on an iterate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    Converged,
    Continue,
    Diverged,
}

/// Part of the largest forces of a run below which those of a state are nothing beside them, and the part of them that they are then
/// measured by.
const NOTHING: f64 = 1e-4;
const REMEMBERED: f64 = 0.1;
/// Multiple of the round-off floor that counts as zero.
pub const FLOOR_FACTOR: f64 = 8.0;

impl Norms {
    /// The residual below which nothing is left to solve.
    pub fn target(&self, tolerance: f64) -> f64 {
        (tolerance * self.force).max(FLOOR_FACTOR * self.floor)
    }

    /// The same beside the largest forces that there have been, where next to nothing is left of them, and whether that is so:
    /// what was pressed and is let go to exactly where it began has no forces of its own to be measured by, and its points open
    /// and close by what rounding leaves.
    pub fn beside(self, largest: f64) -> (Self, bool) {
        let vanished = Norms::vanish(self.force, largest);
        let force = match vanished {
            true => REMEMBERED * largest,
            false => self.force,
        };
        (Norms { force, ..self }, vanished)
    }

    /// Whether forces are nothing beside the largest that there have been.
    pub fn vanish(force: f64, largest: f64) -> bool {
        force < NOTHING * largest
    }

    /// Residual relative to the forces (to the floor where there are none).
    pub fn relative(&self) -> f64 {
        let scale = self.force.max(self.floor);
        if scale > 0.0 {
            self.residual / scale
        } else {
            self.residual
        }
    }

    /// Judges an iterate; `settled` says that no contact point changed its status and no prescribed displacement is
    /// outstanding.
    pub fn judge(&self, tolerance: f64, settled: bool) -> Verdict {
        if !self.residual.is_finite() {
            return Verdict::Diverged;
        }
        if settled && self.residual <= self.target(tolerance) {
            return Verdict::Converged;
        }
        Verdict::Continue
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floor_counts_where_the_tolerance_cannot_be_met() {
        let norms = Norms {
            residual: 1e-7,
            force: 1.0,
            floor: 5e-8,
        };
        assert_eq!(norms.judge(1e-10, true), Verdict::Converged);
        assert_eq!(norms.judge(1e-10, false), Verdict::Continue);
        let high = Norms {
            residual: 1e-5,
            ..norms
        };
        assert_eq!(high.judge(1e-10, true), Verdict::Continue);
    }

    #[test]
    fn forces_that_have_vanished_are_measured_by_those_that_were() {
        let norms = Norms {
            residual: 1e-10,
            force: 1e-10,
            floor: 1e-16,
        };
        let (beside, vanished) = norms.beside(1.0);
        assert!(vanished);
        assert_eq!(norms.judge(1e-8, true), Verdict::Continue);
        assert_eq!(beside.judge(1e-8, true), Verdict::Converged);
        assert_eq!(beside.judge(1e-10, true), Verdict::Continue);
        // Forces that are small, and not nothing.
        assert_eq!(norms.beside(1e-7), (norms, false));
        assert_eq!(norms.beside(0.0), (norms, false));
    }

    #[test]
    fn nan_is_divergence_not_convergence() {
        let norms = Norms {
            residual: f64::NAN,
            force: 1.0,
            floor: 1.0,
        };
        assert_eq!(norms.judge(1e-8, true), Verdict::Diverged);
    }
}
