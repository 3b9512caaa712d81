//! Viscous stabilisation: a force on every unknown of a body along its way since the start of the step, but for the rigid
//! motion that supports prescribe, and a diagonal of the tangent. Linear, so exact. Nothing is allocated where the scene does
//! not ask for it.
use super::{Contribution, Tangent};
use crate::model::Model;
use crate::model::state::heap;
use covact_geometry::Vec3;

/// The step that is being stabilised.
#[derive(Debug)]
pub struct Viscous {
    /// Displacements at its start.
    base: Vec<f64>,
    /// The same, moved with what supports do to bodies that they hold in part: the medium goes along. Empty where there are none.
    medium: Vec<f64>,
    /// One over its length, times what the coefficient is reduced by; zero where nothing is stabilised.
    rate: f64,
}

impl Viscous {
    /// Where the model has a stabilisation.
    pub fn new(model: &Model) -> Option<Viscous> {
        let dofs = 3 * model.nodes.len();
        model.stabilization.as_ref().map(|own| Viscous {
            base: vec![0.0; dofs],
            medium: vec![0.0; if own.free.is_empty() { 0 } else { dofs }],
            rate: 0.0,
        })
    }

    /// What the forces are measured from.
    fn medium(&self) -> &[f64] {
        match self.medium.is_empty() {
            true => &self.base,
            false => &self.medium,
        }
    }

    /// Changes the coefficient in the present step by a factor.
    pub fn scale(&mut self, factor: f64) {
        self.rate *= factor;
    }

    /// Whether the present step is stabilised.
    pub fn acts(&self) -> bool {
        self.rate > 0.0
    }

    /// Force on a degree of freedom of this weight that is displaced by `u`, and its way since the start of the step.
    pub fn force(&self, dof: usize, weight: f64, u: f64) -> [f64; 2] {
        let drag = weight * self.rate * (u - self.medium()[dof]);
        [drag, u - self.base[dof]]
    }

    /// Mean velocity of some nodes in the present step, which ends at `u`.
    pub fn velocity(&self, u: &[f64], nodes: &[u32]) -> Vec3 {
        let sum = nodes.iter().fold(Vec3::zeros(), |s, &n| {
            let way = |c: usize| u[3 * n as usize + c] - self.base[3 * n as usize + c];
            s + Vec3::new(way(0), way(1), way(2))
        });
        sum * (self.rate / nodes.len() as f64)
    }
}

impl Contribution for Viscous {
    fn begin(&mut self, model: &Model, u: &[f64], [start, end]: [f64; 2]) {
        let Some(own) = &model.stabilization else {
            return;
        };
        self.base.copy_from_slice(u);
        if !self.medium.is_empty() {
            self.medium.copy_from_slice(u);
        }
        for piece in &own.free {
            let medium = &mut self.medium;
            let go = |n: u32, way: Vec3| {
                (0..3).for_each(|c| medium[3 * n as usize + c] += way[c]);
            };
            // A value that cannot be evaluated is told where the step prescribes it.
            let _ = piece.motion.carried(model, u, end, go);
        }
        self.rate = match own.acts(start) {
            true => 1.0 / (end - start),
            false => 0.0,
        };
    }

    fn add(&mut self, model: &Model, u: &[f64], residual: &mut [f64], to: Option<&mut Tangent>) {
        let Some(own) = model.stabilization.as_ref().filter(|_| self.rate != 0.0) else {
            return;
        };
        let medium = self.medium();
        for (dof, weight) in own.weights.iter().enumerate() {
            residual[dof] += weight * self.rate * (u[dof] - medium[dof]);
        }
        let Some(to) = to else { return };
        for (dof, weight) in own.weights.iter().enumerate() {
            let stiffness = weight * self.rate;
            if stiffness > 0.0 {
                to.matrix.add_diagonal(dof, stiffness);
            }
        }
    }

    fn bytes(&self) -> usize {
        heap(&self.base) + heap(&self.medium)
    }
}
