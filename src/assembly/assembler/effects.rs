//! Loads, contact and effects, in the order in which they are summed.
use super::{Assembler, Fault, Totals};
use crate::contact::law::PairLaw;
use crate::effects::inertia::Motion;
use crate::effects::{Tangent, Turn, Viscous};
use crate::model::state::State;
use crate::system::linear::{LinearError, LinearSolver};

impl<L: PairLaw> Assembler<'_, L> {
    /// What acts beside elements, in the order of [`Turn`].
    pub(super) fn acting<const TANGENT: bool>(
        &mut self,
        state: &mut State,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) -> Result<(), Fault> {
        // Sums keep the order that they have without effects.
        let last = self.effects.all().any(|e| e.turn() == Turn::BeforeContact);
        if !last {
            self.contacts::<TANGENT>(state, time, increments, residual, rhs, totals)?;
        }
        self.loads::<TANGENT>(state, time, increments, residual, rhs)?;
        if last {
            let u = &state.u;
            self.add_effects::<TANGENT>(Turn::BeforeContact, u, increments, residual, rhs, totals);
            self.contacts::<TANGENT>(state, time, increments, residual, rhs, totals)?;
        }
        for turn in [Turn::AfterContact, Turn::Last] {
            self.add_effects::<TANGENT>(turn, &state.u, increments, residual, rhs, totals);
        }
        Ok(())
    }

    fn add_effects<const TANGENT: bool>(
        &mut self,
        turn: Turn,
        u: &[f64],
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) {
        let mut tangent = Tangent {
            matrix: &mut self.matrix,
            dofs: self.dofs,
            work: &mut self.work,
            maps: &self.element_maps,
            increments,
            rhs,
        };
        for effect in self.effects.all().filter(|e| e.turn() == turn) {
            let to = TANGENT.then_some(&mut tangent);
            effect.add(self.model, u, residual, to);
            totals.effects_norm = totals.effects_norm.max(effect.norm());
        }
    }

    /// Tells that a step from `start` to `end` begins at the displacements `u`.
    pub fn begin_step(&mut self, u: &[f64], start: f64, end: f64) {
        for effect in self.effects.all() {
            effect.begin(self.model, u, [start, end]);
        }
    }

    /// From here on every unknown is held to the displacements `u` with this part of what an element around it resists with;
    /// with none, nothing is.
    pub fn pass(&mut self, u: &[f64], rate: f64) {
        self.effects.passing.hold(self.model, u, rate);
    }

    /// Whether the present step is stabilised.
    pub fn stabilizes(&self) -> bool {
        self.effects.viscous.as_ref().is_some_and(Viscous::acts)
    }

    /// Sets bodies in motion at time 0, from the state there: velocities as the scene has them, and the accelerations that the
    /// forces there cause. Nothing is done without inertia.
    ///
    /// # Errors
    /// What cannot be evaluated, or a mass matrix that cannot be factorized.
    pub fn set_in_motion<S: LinearSolver + ?Sized>(
        &mut self,
        solver: &mut S,
        state: &State,
    ) -> Result<(), StartError> {
        let (Some(inertia), Some(own)) = (&mut self.effects.inertia, &self.model.dynamics) else {
            return Ok(());
        };
        inertia
            .set_velocities(self.model, own)
            .map_err(Fault::from)?;
        let n = state.u.len();
        let (mut residual, mut rhs) = (vec![0.0; n], vec![0.0; n]);
        self.linearize(&mut state.clone(), 0.0, None, &mut residual, &mut rhs)?;
        let Some(inertia) = &mut self.effects.inertia else {
            return Ok(());
        };
        self.matrix.clear();
        for (b, r) in rhs.iter_mut().zip(&residual) {
            *b = -r;
        }
        let mut to = Tangent {
            matrix: &mut self.matrix,
            dofs: self.dofs,
            work: &mut self.work,
            maps: &self.element_maps,
            increments: None,
            rhs: &mut rhs,
        };
        inertia.start_system(self.model, &state.u, &mut to);
        self.dofs.fold(&mut rhs);
        if rhs.iter().any(|b| *b != 0.0) {
            self.matrix.set_identities(self.dofs);
            if let Some(pattern) = self.new_pattern.take() {
                solver.analyze(&pattern)?;
            }
            solver.factorize(&self.matrix)?;
            solver.solve_with(&self.matrix, &mut rhs)?;
            self.dofs.expand(&mut rhs, None);
        }
        inertia.set_start(&rhs);
        Ok(())
    }

    /// Goes on from where the motion was when a checkpoint was written, at the displacements `u`.
    pub fn go_on(&mut self, motion: Option<Motion>, u: &[f64]) {
        if let (Some(inertia), Some(motion)) = (&mut self.effects.inertia, motion) {
            inertia.go_on(motion, u);
        }
    }

    /// Makes of the residual of the step that is solved the balance of forces at its end, in dynamics: reactions where supports
    /// are, and nothing where all is free.
    pub fn balance(&self, u: &[f64], residual: &mut [f64]) {
        let Some(inertia) = &self.effects.inertia else {
            return;
        };
        inertia.balance(self.model, u, &self.contact, residual);
        let mut held = vec![false; residual.len()];
        for support in self.model.supports() {
            support.dofs.iter().for_each(|d| held[*d as usize] = true);
        }
        for (r, held) in residual.iter_mut().zip(held) {
            if !held {
                *r = 0.0;
            }
        }
    }
}

/// Why bodies could not be set in motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StartError {
    /// The forces at the start could not be evaluated.
    #[error(transparent)]
    Fault(#[from] Fault),
    /// The mass matrix could not be factorized or solved with.
    #[error("the mass matrix: {0}")]
    Solve(#[from] LinearError),
}
