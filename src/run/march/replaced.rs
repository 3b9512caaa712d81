//! Bodies whose elements give way where they are squeezed, and which other elements may replace.
use super::{Ending, March};
use crate::model::error::number;
use crate::model::state::State;
use crate::output::RunStatus;
use crate::run::hold;
use crate::solve::newton::Converged;
use covact_geometry::Vec3;

impl March<'_, '_> {
    /// Looks into squeezed elements after a step whose tangent has negative pivots (a negative determinant, where that is all that
    /// is known), or whose energies tell of a jump: at its end, and where it jumped also at its start, since what gave way may
    /// stand at rest behind the jump. Where other elements may replace them the run ends, else the body is told.
    pub(super) fn lost_hold(
        &mut self,
        committed: &State,
        before: Option<&State>,
        converged: &Converged,
        jumped: bool,
    ) -> Option<Ending> {
        let unstable = converged.factorization?.negative_pivots > 0;
        if !unstable && !jumped {
            return None;
        }
        let mut lost = hold::lost(self.model, committed);
        if lost.is_empty() && jumped {
            lost = before.map_or(Vec::new(), |state| hold::lost(self.model, state));
        }
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
                on_rims: false,
            });
        }
        // Once for a body, wherever its elements do so later.
        let head = format!("body `{name}`: elements with enhanced strains near");
        if !self.progress.warnings.iter().any(|w| w.starts_with(&head)) {
            self.warn(format!("{text}, from time {} on: what the body answers may be far off; `h8_mean_dilatation` holds", number(self.progress.time)));
        }
        None
    }

    /// Those of the bodies that other elements may replace.
    pub(super) fn may_be_replaced(&self, lost: &[(usize, Vec3)]) -> Vec<usize> {
        let may = |body: &usize| self.replaceable.contains(&self.model.bodies[*body].name);
        lost.iter().map(|(body, _)| *body).filter(may).collect()
    }
}
