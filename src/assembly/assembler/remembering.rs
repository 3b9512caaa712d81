//! What an assembler keeps of every point with history: its answer to an augmentation, and how its traction turned.
use super::Assembler;
use super::answer::PointAnswer;
use crate::contact::friction::turning::Turning;
use crate::contact::law::PairLaw;
use crate::model::Model;
use crate::model::state::State;

/// Answers of all points with history, where any pair has augmentation.
pub(super) fn answers(model: &Model) -> Vec<Option<PointAnswer>> {
    match model.pairs.iter().any(|p| p.augmentation.is_some()) {
        true => vec![None; model.histories()],
        false => Vec::new(),
    }
}

/// Tractions of all points with history, where any pair has friction.
pub(super) fn slips(model: &Model) -> Vec<Turning> {
    match model.pairs.iter().any(|p| p.friction.is_some()) {
        true => vec![Turning::default(); model.histories()],
        false => Vec::new(),
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Takes over the number of points with history of a state whose segments were cut anew. Answers are written by every
    /// evaluation before they are read, and no traction has turned where a step begins.
    pub(super) fn follow_cuts(&mut self, state: &State) {
        let n = state.histories.len();
        if !self.answers.is_empty() {
            self.answers.resize(n, None);
        }
        if !self.slips.is_empty() && self.slips.len() != n {
            self.slips.clear();
            self.slips.resize(n, Turning::default());
        }
    }
}
