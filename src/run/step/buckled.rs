//! Newton's method from equilibria that are unstable.
use super::Attempts;
use crate::model::state::State;
use crate::solve::event::Observer;
use crate::solve::newton::{Converged, First, Newton, Patience, StepFailure};
use crate::system::linear::LinearSolver;

impl<'a, 'm> Attempts<'a, 'm> {
    /// Newton's method with what this has, and to whom it tells.
    pub(super) fn method(
        &mut self,
        patience: Patience,
        first: First,
    ) -> (
        Newton<'_, 'm, dyn LinearSolver + 'a>,
        &mut (dyn Observer + Send),
    ) {
        let newton = Newton {
            model: self.model,
            assembler: self.assembler,
            solver: self.solver,
            workspace: self.workspace,
            settings: self.settings,
            patience,
            first,
            mixed: self.mixed && self.settings.mixed,
            mixed_iterations: 0,
            opened: false,
            ping_pongs: 0,
            phases: self.phases,
            interrupt: self.interrupt,
            iterations: 0,
        };
        (newton, self.observer)
    }

    /// Looks for a direction in which a structure would buckle from an equilibrium that it has come to: by how much of their distance
    /// it moves neighbouring nodes against each other.
    pub fn buckles(&mut self, end: f64, trial: &mut State) -> Option<f64> {
        let committed = &self.committed.u;
        let (mut newton, _) = self.method(Patience::Short, First::default());
        newton.falling(trial, committed, end)
    }

    /// Solves a step whose equilibrium, `trial`, is unstable again, from where the energy is lower along the direction that
    /// [`Self::buckles`] has just found.
    pub fn departed(
        &mut self,
        step: u32,
        end: f64,
        trial: &mut State,
        stretch: f64,
    ) -> Result<Converged, StepFailure> {
        self.departs = Some(stretch);
        self.first = Some(First {
            search: true,
            ..First::default()
        });
        self.converge(step, end, trial, Patience::Short)
    }
}
