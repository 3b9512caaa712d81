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

/// Bodies whose elements gave way in a step, and what is told of the first of them.
pub(super) struct GaveWay {
    lost: Vec<(usize, Vec3)>,
    body: usize,
    text: String,
    /// What they do, a part of the text.
    what: &'static str,
    /// What ends it.
    helps: &'static str,
}

impl March<'_, '_> {
    /// Looks into elements at the end of a step that is not accepted yet: whether their material feels what they lose of their volume,
    /// and into squeezed ones where its tangent has negative pivots (a negative determinant, where that is all that is known).
    pub(super) fn lost_hold(&self, state: &State, converged: &Converged) -> Vec<GaveWay> {
        let unstable = converged
            .factorization
            .is_some_and(|f| f.negative_pivots > 0);
        let squeezed = unstable.then(|| self.squeezed(hold::lost(self.model, state)));
        let unfelt = self.unfelt(state).into_iter();
        unfelt.chain(squeezed.flatten()).collect()
    }

    /// Looks into squeezed elements after a step whose energies tell of a jump, at its end and at its start, since what gave way may
    /// stand at rest behind the jump.
    pub(super) fn lost_in_jump(
        &self,
        committed: &State,
        before: Option<&State>,
    ) -> Option<GaveWay> {
        let at_start = || self.squeezed(hold::lost(self.model, before?));
        (self.squeezed(hold::lost(self.model, committed))).or_else(at_start)
    }

    fn squeezed(&self, lost: Vec<(usize, Vec3)>) -> Option<GaveWay> {
        let (body, at) = *lost.first()?;
        let name = &self.model.bodies[body].name;
        let text = format!(
            "body `{name}`: elements with enhanced strains near ({}, {}, {}) lose their hold where they are squeezed",
            number(at.x),
            number(at.y),
            number(at.z)
        );
        Some(GaveWay {
            lost,
            body,
            text,
            what: "lose their hold",
            helps: HOLDS,
        })
    }

    /// Looks for blocks whose elements have lost more volume than their material feels: what they answer is too soft, and nothing
    /// else tells of it.
    fn unfelt(&self, state: &State) -> Option<GaveWay> {
        let unfelt = hold::unfelt(self.model, state);
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
        Some(GaveWay {
            lost: blocks.map(|h| (h.body, h.at)).collect(),
            body: worst.body,
            text,
            what: "lose more of their volume",
            helps: match worst.layered {
                true => HOLDS,
                false => "a finer mesh follows farther",
            },
        })
    }

    /// An ending, where other elements may replace those of some bodies.
    pub(super) fn without(&self, gave_way: &[GaveWay]) -> Option<Ending> {
        gave_way.iter().find_map(|gave_way| {
            let squeezed = self.may_be_replaced(&gave_way.lost);
            (!squeezed.is_empty()).then(|| Ending {
                squeezed,
                ..Ending::new(RunStatus::NotConverged, Some(gave_way.text.clone()))
            })
        })
    }

    /// Tells of elements that gave way in the accepted step once for what they do, wherever they do so later.
    pub(super) fn tell_lost(&mut self, gave_way: GaveWay) {
        let GaveWay {
            lost: _,
            body,
            text,
            what,
            helps,
        } = gave_way;
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
    }

    /// Those of the bodies that other elements may replace.
    pub(super) fn may_be_replaced(&self, lost: &[(usize, Vec3)]) -> Vec<usize> {
        let may = |body: &usize| self.replaceable.contains(&self.model.bodies[*body].name);
        lost.iter().map(|(body, _)| *body).filter(may).collect()
    }
}
