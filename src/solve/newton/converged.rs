//! What Newton's method took to an equilibrium.
use super::{LinearSolver, Newton, StepFailure};
use crate::assembly::Totals;
use crate::system::linear::Factorization;

/// Multiple of their distance that neighbouring nodes may be apart at an equilibrium. A control point of which a trim leaves next to
/// nothing may well be a thousand away.
const NOWHERE: f64 = 1e6;

/// What a converged step took.
#[derive(Debug, Clone, PartialEq)]
pub struct Converged {
    /// Iterations, those of augmentations included.
    pub iterations: u32,
    /// Augmentations, and those of the iterations that they took.
    pub augmentations: u32,
    /// Iterations that the augmentations took.
    pub augmenting: u32,
    /// Sums of forces and contact at the equilibrium.
    pub totals: Totals,
    /// Norm of the forces at the equilibrium.
    pub force: f64,
    /// Relative residual and points whose status changed, per linearisation.
    pub history: Vec<(f64, usize)>,
    /// Largest round-off floor met, relative to the forces.
    pub floor: f64,
    /// The last factorization; none if the start was in equilibrium already.
    pub factorization: Option<Factorization>,
    /// The step was solved from a softened penalty only.
    pub softened: bool,
    /// It was solved under penalties softer than those that it began with.
    pub eased: bool,
}

impl Converged {
    /// Goes on from the state that these are of to `next`, by an augmentation.
    pub fn augmented(&mut self, next: Converged) {
        self.iterations += next.iterations;
        self.augmenting += next.iterations;
        self.augmentations += 1;
        self.totals = next.totals;
        self.force = next.force;
        self.history.extend(next.history);
        self.floor = self.floor.max(next.floor);
        self.factorization = next.factorization.or(self.factorization.take());
    }

    /// Goes on to the same step under a stiffer penalty, whose iterations say nothing of how far a step may go.
    pub fn stiffened(&mut self, next: Converged) {
        self.augmented(next);
        self.augmentations -= 1;
    }
}

impl<S: LinearSolver + ?Sized> Newton<'_, '_, S> {
    /// Whether neighbouring nodes are where anything can be. Beside displacements without bounds rounding is as large as all forces:
    /// what holds a node by next to nothing lets it go anywhere, and nothing is left of the residual by that measure.
    ///
    /// # Errors
    /// Where they are not.
    pub(super) fn stays(&self, u: &[f64], iteration: u32) -> Result<(), StepFailure> {
        let stretch = self.model.largest_stretch(u);
        match stretch > NOWHERE && stretch.is_finite() {
            true => Err(StepFailure::Diverges { iteration, stretch }),
            false => Ok(()),
        }
    }
}
