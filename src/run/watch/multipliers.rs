//! What multipliers do: the work of tractions that no penalty stores.
use super::Watch;
use crate::assembly::{Assembler, PointAnswer};
use crate::contact::law::PairLaw;
use crate::model::Model;
use crate::model::state::State;

/// Normal tractions and gaps of points that nothing presses yet; none where no pair has multipliers.
pub(super) fn tractions(model: &Model) -> Vec<[f64; 2]> {
    match model.pairs.iter().any(|p| p.augmentation.is_some()) {
        true => vec![[0.0; 2]; model.histories()],
        false => Vec::new(),
    }
}

impl Watch {
    /// Normal tractions and gaps of the points `range` with multipliers; nothing where the model has none.
    pub(in crate::run) fn tractions(&self, range: std::ops::Range<usize>) -> &[[f64; 2]] {
        self.tractions.get(range).unwrap_or_default()
    }

    /// Whether the tractions are those of as many points with history as a state has.
    pub(in crate::run) fn fits(&self, state: &State) -> bool {
        self.tractions.is_empty() || self.tractions.len() == state.histories.len()
    }

    /// Takes over points with history that were cut anew: each stands for the one of this number before.
    pub(in crate::run) fn recut(&mut self, sources: &[usize]) {
        if !self.tractions.is_empty() {
            self.tractions = sources.iter().map(|&i| self.tractions[i]).collect();
        }
    }

    /// Work of the normal tractions of points with multipliers that their penalties do not store.
    pub(super) fn multipliers<L: PairLaw>(
        &self,
        model: &Model,
        assembler: &Assembler<L>,
        state: &State,
    ) -> f64 {
        let answers = assembler.answers();
        let mut adjusted = 0.0;
        for (index, pair) in model.pairs.iter().enumerate() {
            let (Some(_), Some(range)) = (&pair.augmentation, state.history(model, index)) else {
                continue;
            };
            let laws = [self.penalties[index], assembler.penalties[index]].map(L::of);
            let mut sum = 0.0;
            let areas = match &pair.averaged {
                Some(nodes) => nodes.areas(&pair.points),
                None => (state.slaves(model, index).iter().map(|p| p.area)).collect(),
            };
            for ((area, was), now) in (areas.iter())
                .zip(&self.tractions[range.clone()])
                .zip(&answers[range])
            {
                let [n, g] = traction(now);
                let stored = laws[1].energy(g) - laws[0].energy(was[1]);
                sum += (stored - 0.5 * (n + was[0]) * (g - was[1])) * area;
            }
            adjusted += pair.share() * sum;
        }
        adjusted
    }

    pub(in crate::run) fn keep_tractions(&mut self, answers: &[Option<PointAnswer>]) {
        for (kept, answer) in self.tractions.iter_mut().zip(answers) {
            *kept = traction(answer);
        }
    }
}

/// Normal traction and gap of a point with multipliers; nothing where it is open.
fn traction(answer: &Option<PointAnswer>) -> [f64; 2] {
    answer.as_ref().map_or([0.0; 2], |a| [a.n, a.gap])
}
