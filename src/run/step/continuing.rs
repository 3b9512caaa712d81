//! Starts that go on with the path so far.
use super::Attempts;
use crate::model::state::State;

impl Attempts<'_, '_> {
    /// Continues the path into `trial`: by the last step, or by the motion of bodies with inertia. Whether there is a path.
    pub(super) fn continues(
        &self,
        before: Option<&(State, f64)>,
        dt: f64,
        trial: &mut State,
    ) -> bool {
        let inertia = self.assembler.effects.inertia.as_ref();
        match (before, inertia) {
            (None, None) => return false,
            (None, Some(_)) => trial.copy_from(self.committed),
            (Some((state, size)), _) => {
                (self.committed).extrapolate(self.model, state, dt / size, trial);
            }
        }
        if let Some(inertia) = inertia {
            inertia.predict(&mut trial.u);
        }
        true
    }
}
