//! Integration segments, cut anew before a step.
use super::{March, Outputs, StepControl};
use crate::model::recut::recut;
use crate::model::state::State;
use crate::run::RunError;

impl March<'_, '_> {
    /// Cuts the slave faces of all pairs with segments by their masters as they are now, and takes what is known of the
    /// points before to those that there are now.
    pub(super) fn recut(
        &mut self,
        committed: &mut State,
        walk: &mut StepControl,
        outputs: &mut Outputs,
    ) -> Result<(), RunError> {
        let (time, masters) = (self.progress.time, &mut self.assembler.masters);
        if let Some(sources) = recut(self.model, masters, committed, time)? {
            self.watch.recut(&sources);
            if let Some((before, _)) = &mut walk.before {
                before.recut(&sources);
            }
        }
        (outputs.fields).resample(self.model, masters, committed, time)
    }
}
