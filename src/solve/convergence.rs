//! When Newton's method may stop.
//!
//! A thin shell under a stiff penalty cannot reach a small residual relative to its load: rounding of the
//! displacements alone leaves about `eps |K| |u|`, which grows with (length / thickness)^3 and with the penalty. The
//! test therefore compares the residual with the larger of a tolerance on the forces and a small multiple of that
//! floor, and never stops while points still change their status.

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

/// Multiple of the round-off floor that counts as zero.
pub const FLOOR_FACTOR: f64 = 8.0;

impl Norms {
    /// The residual below which nothing is left to solve.
    pub fn target(&self, tolerance: f64) -> f64 {
        (tolerance * self.force).max(FLOOR_FACTOR * self.floor)
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
    fn nan_is_divergence_not_convergence() {
        let norms = Norms {
            residual: f64::NAN,
            force: 1.0,
            floor: 1.0,
        };
        assert_eq!(norms.judge(1e-8, true), Verdict::Diverged);
    }
}
