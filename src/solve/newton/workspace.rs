//! Room for Newton's method, and what a run knows of its factorizations.
use super::Unstable;
use crate::model::Model;
use crate::model::state::{State, heap};
use crate::system::linear::Method;
use std::collections::BTreeMap;

/// Work space of Newton's method: allocated once for a run.
pub struct Workspace {
    pub(super) residual: Vec<f64>,
    pub(super) rhs: Vec<f64>,
    pub(super) increments: Vec<f64>,
    pub(super) du: Vec<f64>,
    pub(super) scratch: Vec<f64>,
    pub(super) absolute: Vec<f64>,
    pub(super) base: State,
    /// The solver has the factors of an iterate of the last solution.
    pub(super) factored: bool,
    /// By how much of their distance the first increment of the last solution moved neighbouring nodes against each other, at most.
    pub bend: f64,
    /// Largest norm of the forces of an accepted step, where nothing has inertia.
    pub largest_force: f64,
    /// The last tangent with negative pivots, since this was last reset.
    pub unstable: Option<Unstable>,
    /// Factorizations made so far, of failed attempts too.
    pub factorizations: BTreeMap<Method, u64>,
}

impl Workspace {
    /// Room for the solutions of a model.
    pub fn new(model: &Model) -> Self {
        let n = 3 * model.nodes.len();
        Workspace {
            residual: vec![0.0; n],
            rhs: vec![0.0; n],
            increments: vec![0.0; n],
            du: vec![0.0; n],
            scratch: vec![0.0; n],
            absolute: vec![0.0; n],
            base: State::new(model),
            factored: false,
            bend: 0.0,
            largest_force: 0.0,
            unstable: None,
            factorizations: BTreeMap::new(),
        }
    }

    /// Bytes of heap that it holds, by part: vectors, and those of its state.
    pub fn parts(&self) -> Vec<(&'static str, usize)> {
        let Workspace {
            residual,
            rhs,
            increments,
            du,
            scratch,
            absolute,
            base,
            factored: _,
            bend: _,
            largest_force: _,
            unstable: _,
            // A few counts.
            factorizations: _,
        } = self;
        let vectors = [residual, rhs, increments, du, scratch, absolute].map(heap);
        let mut parts = vec![("vectors", vectors.iter().sum())];
        parts.extend(base.parts());
        parts
    }

    /// What outlives an accepted step: the factorizations made, and the largest force. All else is written by every step before it is read.
    pub fn kept(&self) -> (&BTreeMap<Method, u64>, f64) {
        let Workspace {
            residual: _,
            rhs: _,
            increments: _,
            du: _,
            scratch: _,
            absolute: _,
            base: _,
            factored: _,
            bend: _,
            largest_force,
            unstable: _,
            factorizations,
        } = self;
        (factorizations, *largest_force)
    }

    /// [`Self::residual`], to write to.
    pub fn residual_mut(&mut self) -> &mut [f64] {
        &mut self.residual
    }

    /// Residual at all degrees of freedom of the last evaluation: reactions at the constrained ones.
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }
}
