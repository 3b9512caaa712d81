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

    /// Whether a structure would buckle from an equilibrium that it has come to.
    pub fn buckles(&mut self, end: f64, trial: &mut State) -> bool {
        let committed = &self.committed.u;
        let (mut newton, _) = self.method(Patience::Short, First::default());
        newton.falling(trial, committed, end).is_some()
    }

    /// Solves a step whose equilibrium, `trial`, is unstable again, from where the energy is lower.
    pub fn departed(
        &mut self,
        step: u32,
        end: f64,
        trial: &mut State,
    ) -> Result<Converged, StepFailure> {
        self.departs = true;
        self.first = Some(First {
            search: true,
            ..First::default()
        });
        self.converge(step, end, trial, Patience::Short)
    }
}
