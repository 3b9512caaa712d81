//! Viscous forces that take bodies past a state from which no equilibrium goes on. They are brought in where a step fails, and
//! nothing of them is there before.
use super::{Contribution, Tangent};
use crate::model::Model;
use crate::model::stabilization::local_stiffness;
use crate::model::state::heap;

/// A force on every unknown of a body along its way since the start of the step.
#[derive(Debug, Default)]
pub struct Passing {
    /// What an element around a node resists with (force / length), zero where nothing is unknown; empty as long as nothing was
    /// passed.
    weights: Vec<f64>,
    /// Displacements at the start of the step.
    base: Vec<f64>,
    /// Part of the weights that resists; zero where nothing is to be passed.
    rate: f64,
}

impl Passing {
    /// From here on every unknown is held to the displacements `u` with this part of what an element around it resists with;
    /// with none, nothing is.
    pub fn hold(&mut self, model: &Model, u: &[f64], rate: f64) {
        self.rate = rate;
        if rate > 0.0 {
            if self.weights.is_empty() {
                self.weights = local_stiffness(model);
            }
            self.base.resize(self.weights.len(), 0.0);
            let own = self.base.len();
            self.base.copy_from_slice(&u[..own]);
        }
    }

    /// Force on a degree of freedom that is displaced by `u`, and its stiffness.
    #[inline]
    pub fn force(&self, dof: usize, u: f64) -> [f64; 2] {
        match self.rate > 0.0 {
            true => {
                let stiffness = self.rate * self.weights[dof];
                [stiffness * (u - self.base[dof]), stiffness]
            }
            false => [0.0, 0.0],
        }
    }

    /// Way of a degree of freedom since the start of the step.
    #[inline]
    pub fn way(&self, dof: usize, u: f64) -> f64 {
        u - self.base[dof]
    }

    /// Whether the present step is held.
    pub fn acts(&self) -> bool {
        self.rate > 0.0
    }
}

impl Contribution for Passing {
    fn begin(&mut self, _: &Model, _: &[f64], _: [f64; 2]) {}

    fn add(&mut self, _: &Model, u: &[f64], residual: &mut [f64], mut to: Option<&mut Tangent>) {
        if !self.acts() {
            return;
        }
        for dof in 0..self.weights.len() {
            let [force, stiffness] = self.force(dof, u[dof]);
            residual[dof] += force;
            if let Some(to) = to.as_mut().filter(|_| stiffness > 0.0) {
                to.matrix.add_diagonal(dof, stiffness);
            }
        }
    }

    fn bytes(&self) -> usize {
        heap(&self.weights) + heap(&self.base)
    }
}
