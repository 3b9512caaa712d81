//! Bodies whose elements give way where they are squeezed, and which other elements may replace.
use super::{Ending, March};
use crate::model::error::number;
use crate::model::state::State;
use crate::output::RunStatus;
use crate::run::hold;
use crate::solve::newton::Converged;
use crate::system::linear::Method;
use covact_geometry::Vec3;

impl March<'_, '_> {
    /// Looks into squeezed elements after a step whose tangent has negative pivots. Where other elements may replace them the run
    /// ends, else the body is told. The sign of a determinant, which is all that is known of an unsymmetric tangent, says too
    /// little: friction may turn it. A step whose energies tell of a jump is looked into whatever its tangent.
    pub(super) fn lost_hold(
        &mut self,
        committed: &State,
        converged: &Converged,
        jumped: bool,
    ) -> Option<Ending> {
        let last = converged.factorization?;
        let unstable = last.method != Method::Lu && last.negative_pivots > 0;
        if !unstable && !jumped {
            return None;
        }
        let lost = hold::lost(self.model, committed);
        let (body, at) = *lost.first()?;
        let name = &self.model.bodies[body].name;
        let text = format!(
            "body `{name}`: elements with enhanced strains near ({}, {}, {}) lose their hold where they are squeezed",
            number(at.x),
            number(at.y),
            number(at.z)
        );
        let squeezed = self.may_be_replaced(&lost);
        if !squeezed.is_empty() {
            return Some(Ending {
                status: RunStatus::NotConverged,
                reason: Some(text),
                squeezed,
            });
        }
        // Once for a body, wherever its elements do so later.
        let head = format!("body `{name}`: elements with enhanced strains near");
        if !self.progress.warnings.iter().any(|w| w.starts_with(&head)) {
            self.warn(format!("{text}, from time {} on: what the body answers may be far off; `h8_displacement` holds", number(self.progress.time)));
        }
        None
    }

    /// Those of the bodies that other elements may replace.
    pub(super) fn may_be_replaced(&self, lost: &[(usize, Vec3)]) -> Vec<usize> {
        let may = |body: &usize| self.replaceable.contains(&self.model.bodies[*body].name);
        lost.iter().map(|(body, _)| *body).filter(may).collect()
    }
}
