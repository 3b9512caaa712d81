//! When a run is given up, since another one stands ready to take its place.
use super::{Ending, March};
use crate::model::edges;
use crate::model::error::number;
use crate::model::state::State;
use crate::output::RunStatus;
use crate::run::bearing::Bearing;
use crate::run::progress::Progress;
use crate::run::unseen::{hanging, slides};

/// Iterations of failed attempts from which on a run may work in vain: one that another may stand for, and one of which the other is
/// known to be worse.
const IN_VAIN: u64 = 100;
const WORSE_IN_VAIN: u64 = 500;
/// Times the iterations of a run without failed attempts that what is left may cost, at the pace so far.
const WORTH: f64 = 2.0;
/// Cuts of a run from which on it crawls, where there are more than one in so many steps.
const CRAWLS: u32 = 10;
const MANY_CUTS: u32 = 5;

/// How long a run is followed that goes on badly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::run) enum Patience {
    /// To its end: no other stands ready.
    Full,
    /// With elements that gave way, since others would bend otherwise.
    Long,
    /// Without the edges of rigid surfaces as slaves, or with fewer slave points, it may come to its end.
    Short,
}

impl March<'_, '_> {
    /// Whether a run that goes on badly is given up for one that stands ready, with the sides of contacts between bodies exchanged, too,
    /// or with the faces beside an edge that lies on the slave.
    pub(super) fn gives_up(&self, state: &State) -> bool {
        let vain = match self.patience {
            Patience::Full => false,
            Patience::Long => self.fails_often(WORSE_IN_VAIN),
            Patience::Short => self.cut_often() || self.fails_often(IN_VAIN),
        };
        let edged = || {
            let on_slave = |pair| edges::on_slave(self.model, pair, &state.u);
            self.sides_may && self.model.pairs.iter().any(on_slave)
        };
        vain || self.crawls() && (self.exchangeable || edged())
    }

    /// Ends a run in which an edge of a master has sunk into its slave and may be a slave in another one, or a surface between slave
    /// points that may be more in another one; of other edges the user is told. `by`: the deepest penetration and what the points of
    /// every pair carry, in the step from `from` to `to`.
    pub(super) fn sinks(
        &mut self,
        state: &State,
        span: [f64; 2],
        by: (&[f64], &[Bearing]),
    ) -> Option<Ending> {
        let time = self.progress.time;
        let sunk = (self.unseen.rims).sunk(self.model, &state.u, time, by);
        for sunk in sunk.iter().filter(|s| !s.may) {
            let head = sunk.head(self.model);
            if !self.progress.warnings.iter().any(|w| w.starts_with(&head)) {
                self.warn(sunk.told(self.model, time));
            }
        }
        let on_rims =
            sunk.iter().any(|s| s.may) || (self.unseen.edges).sunk(self.model, &state.u, by.0);
        let penalties = &self.assembler.penalties;
        let mut between = (self.unseen.between).look(self.model, state, span, (by, penalties));
        let masters = &mut self.assembler.masters;
        between.extend(hanging(
            self.model,
            masters,
            (state, time),
            &self.unseen.more,
        ));
        let text = match on_rims {
            true => "an edge of a master sinks in between slave points",
            false => "a surface sinks in between slave points, or these hang over its border",
        };
        (on_rims || !between.is_empty()).then(|| Ending {
            on_rims,
            between,
            ..Ending::new(RunStatus::NotConverged, Some(text.to_owned()))
        })
    }

    /// Ends a run in which slave points slide over flat faces of a curved master that may be smooth in another one; of others the
    /// user is told.
    pub(super) fn slides(&mut self, state: &State) -> Option<Ending> {
        let may = |(index, _): &(usize, f64)| self.unseen.smooth.contains(index);
        let found = slides(self.model, state);
        let (slid, told): (Vec<_>, Vec<_>) = found.into_iter().partition(may);
        for (index, part) in told {
            let name = &self.model.pairs[index].name;
            let head = format!(
                "contact `{name}`: its points slide over flat faces that stand for curved ones"
            );
            if !self.progress.warnings.iter().any(|w| w.starts_with(&head)) {
                self.warn(format!(
                    "{head}, by which gaps are {:.0} % of the overclosure or clearance at the start off, at time {}: take a smooth \
                     master (`\"master_surface\": \"smooth\"`), finer faces, or element `q18`",
                    100.0 * part,
                    number(self.progress.time)
                ));
            }
        }
        let text = "slave points slide over flat faces that stand for curved ones";
        (!slid.is_empty()).then(|| Ending {
            slid: slid.into_iter().map(|(index, _)| index).collect(),
            ..Ending::new(RunStatus::NotConverged, Some(text.to_owned()))
        })
    }

    fn fails_often(&self, from: u64) -> bool {
        let Progress {
            iterations,
            accepted,
            time,
            ..
        } = &*self.progress;
        let done = time / self.scene.solution.end_time;
        in_vain(from, *iterations, *accepted, done)
    }

    /// Whether steps are cut again and again.
    fn cut_often(&self) -> bool {
        let (cuts, steps) = (self.progress.cuts, self.progress.steps);
        cuts >= CRAWLS && MANY_CUTS * cuts > steps
    }

    /// Whether steps in contact with a body are cut again and again.
    fn crawls(&self) -> bool {
        let mut pairs = self.model.pairs.iter().zip(&*self.touching);
        self.cut_often()
            && pairs.any(|(pair, touching)| *touching && self.model.between_bodies(pair))
    }
}

/// Whether attempts that fail make what is left of a run, of which a part is done, cost more than twice another one that begins again and
/// has none: near its end a run is worth more of them.
fn in_vain(from: u64, iterations: u64, accepted: u64, done: f64) -> bool {
    // Both relative to the part that is done.
    let left = iterations as f64 * (1.0 - done);
    iterations.saturating_sub(accepted) > from && left > WORTH * accepted as f64
}

#[cfg(test)]
mod tests {
    use super::{IN_VAIN, WORSE_IN_VAIN};

    fn in_vain(iterations: u64, accepted: u64, done: f64) -> bool {
        super::in_vain(IN_VAIN, iterations, accepted, done)
    }

    #[test]
    fn a_run_near_its_end_is_worth_more_attempts() {
        // Few attempts say nothing.
        assert!(!in_vain(110, 10, 0.1));
        assert!(in_vain(111, 10, 0.1));
        // A tenth of the way for 200 iterations: 1,800 are left, and all of it without failed attempts would take 900.
        assert!(!in_vain(200, 90, 0.1));
        assert!(in_vain(201, 90, 0.1));
        assert!(!super::in_vain(WORSE_IN_VAIN, 590, 90, 0.1));
        assert!(super::in_vain(WORSE_IN_VAIN, 591, 90, 0.1));
        // As many failed attempts half way, and near the end.
        assert!(in_vain(361, 90, 0.5));
        assert!(!in_vain(359, 90, 0.5));
        assert!(!in_vain(900, 90, 0.8));
    }
}
