//! Bodies whose elements give way where they are squeezed, and which other elements may replace.
use super::{Ending, March};
use crate::model::error::number;
use crate::model::state::State;
use crate::output::RunStatus;
use crate::run::hold;
use crate::solve::newton::Converged;
use covact_geometry::Vec3;

/// What helps a block.
const HOLDS: &str = "`h8_mean_dilatation` holds";

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
        if let Some(ending) = self.unfelt(committed) {
            return Some(ending);
        }
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
        self.gave_way(&lost, (body, text, "lose their hold"), HOLDS)
    }

    /// Looks for blocks whose elements have lost more volume than their material feels: what they answer is too soft, and nothing
    /// else tells of it. As [`Self::lost_hold`] from there on.
    fn unfelt(&mut self, committed: &State) -> Option<Ending> {
        let unfelt = hold::unfelt(self.model, committed);
        let worst = unfelt.first()?;
        let text = format!(
            "body `{}`: elements with enhanced strains near ({}, {}, {}) lose more of their volume than their material feels, {:.1} % \
             and {:.1} %, where they are pressed",
            self.model.bodies[worst.body].name,
            number(worst.at.x),
            number(worst.at.y),
            number(worst.at.z),
            100.0 * worst.lost[0],
            100.0 * worst.lost[1],
        );
        let blocks = unfelt.iter().filter(|h| h.layered);
        let lost: Vec<_> = blocks.map(|h| (h.body, h.at)).collect();
        let helps = match worst.layered {
            true => HOLDS,
            false => "a finer mesh follows farther",
        };
        self.gave_way(
            &lost,
            (worst.body, text, "lose more of their volume"),
            helps,
        )
    }

    /// Ends the run where other elements may replace those of the bodies, else tells of the first of them once, wherever its elements
    /// do so later. `what` they do is a part of the text, and `helps` ends it.
    fn gave_way(
        &mut self,
        lost: &[(usize, Vec3)],
        (body, text, what): (usize, String, &str),
        helps: &str,
    ) -> Option<Ending> {
        let squeezed = self.may_be_replaced(lost);
        if !squeezed.is_empty() {
            return Some(Ending {
                squeezed,
                ..Ending::new(RunStatus::NotConverged, Some(text))
            });
        }
        let head = format!(
            "body `{}`: elements with enhanced strains near",
            self.model.bodies[body].name
        );
        let told = |w: &String| w.starts_with(&head) && w.contains(what);
        if !self.progress.warnings.iter().any(told) {
            self.warn(format!(
                "{text}, from time {} on: what the body answers may be far off; {helps}",
                number(self.progress.time)
            ));
        }
        None
    }

    /// Those of the bodies that other elements may replace.
    pub(super) fn may_be_replaced(&self, lost: &[(usize, Vec3)]) -> Vec<usize> {
        let may = |body: &usize| self.replaceable.contains(&self.model.bodies[*body].name);
        lost.iter().map(|(body, _)| *body).filter(may).collect()
    }
}
