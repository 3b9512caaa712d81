//! Slave points whose normal tractions are those of nodes with averaged gaps, on a rigid master. What they did at the end of a step is
//! what was evaluated last, with its last bits.
use super::{Batch, Limited};
use crate::assembly::RubbedPoints;
use crate::contact::friction::history::PointHistory;
use crate::contact::kernel::Normal;
use crate::contact::law::{NormalLaw, PairLaw};
use crate::model::state::PointState;
use rayon::prelude::*;

/// The law of a point that is pressed no more: what the laws of its nodes would draw it by.
pub(super) struct Beyond(pub f64);

impl NormalLaw for Beyond {
    fn response(&self, _xi3: f64) -> Normal {
        Normal { n: self.0, dn: 0.0 }
    }

    fn energy(&self, _xi3: f64) -> f64 {
        0.0
    }
}

impl<L: PairLaw> Batch<'_, L> {
    /// Takes the end of a step into the histories. `limited` is the traction that the law allowed at its start, for a trial
    /// traction, a normal and a pressure.
    pub(super) fn rubbed(
        &self,
        points: &[PointState],
        histories: &mut [PointHistory],
        eps_t: f64,
        limited: &impl Limited,
        rubbed: &RubbedPoints<'_, L>,
    ) {
        (histories.par_iter_mut().zip(points).enumerate())
            .with_min_len(64)
            .for_each(|(i, (history, point))| match rubbed.rigid(i) {
                Some(found) => {
                    let touch = &found.touch;
                    let (traction, n) = (&touch.traction, touch.touch.n);
                    let first = limited(&traction.trial, &touch.normal, -history.n, None);
                    history.accept(&touch.local, traction, &first, n, eps_t, &self.turn);
                }
                None => {
                    let law = Beyond(rubbed.beyond(i));
                    self.leave(i, point.hint, &law, eps_t, history);
                }
            });
    }
}
