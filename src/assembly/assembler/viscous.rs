//! Viscous stabilisation: a force on every unknown of a body along its way since the start of the step, but for the rigid
//! motion that supports prescribe, and a diagonal of the tangent. Linear, so exact. Nothing is allocated where the scene does
//! not ask for it.
use super::Assembler;
use crate::contact::law::PairLaw;
use crate::effects::Contribution;
use crate::model::Model;
use crate::model::state::heap;
use covact_geometry::Vec3;

/// The step that is being stabilised.
pub(super) struct Viscous {
    /// Displacements at its start.
    base: Vec<f64>,
    /// The same, moved with what supports do to bodies that they hold in part: the medium goes along. Empty where there are none.
    medium: Vec<f64>,
    /// One over its length, times what the coefficient is reduced by; zero where nothing is stabilised.
    rate: f64,
}

/// What the stabilisation did in a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Drag {
    /// Energy that its forces took.
    pub work: f64,
    /// Its forces (sum of the magnitudes at nodes) relative to those of loads, supports or contacts, whichever are largest.
    pub share: f64,
}

impl Viscous {
    /// What the forces are measured from.
    fn medium(&self) -> &[f64] {
        match self.medium.is_empty() {
            true => &self.base,
            false => &self.medium,
        }
    }

    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        heap(&self.base) + heap(&self.medium)
    }

    pub fn new(model: &Model) -> Option<Viscous> {
        let dofs = 3 * model.nodes.len();
        model.stabilization.as_ref().map(|own| Viscous {
            base: vec![0.0; dofs],
            medium: vec![0.0; if own.free.is_empty() { 0 } else { dofs }],
            rate: 0.0,
        })
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Tells that a step from `start` to `end` begins at the displacements `u`.
    pub fn begin_step(&mut self, u: &[f64], start: f64, end: f64) {
        if let Some(inertia) = &mut self.inertia {
            inertia.begin(self.model, u, [start, end]);
        }
        if let (Some(viscous), Some(model)) = (&mut self.viscous, &self.model.stabilization) {
            viscous.base.copy_from_slice(u);
            if !viscous.medium.is_empty() {
                viscous.medium.copy_from_slice(u);
            }
            for piece in &model.free {
                let medium = &mut viscous.medium;
                let go = |n: u32, way: Vec3| {
                    (0..3).for_each(|c| medium[3 * n as usize + c] += way[c]);
                };
                // A value that cannot be evaluated is told where the step prescribes it.
                let _ = piece.motion.carried(self.model, u, end, go);
            }
            viscous.rate = match model.acts(start) {
                true => 1.0 / (end - start),
                false => 0.0,
            };
        }
    }

    /// Changes the coefficient in the present step by a factor.
    pub fn scale_drag(&mut self, factor: f64) {
        if let Some(viscous) = &mut self.viscous {
            viscous.rate *= factor;
        }
    }

    /// Whether the present step is stabilised.
    pub fn stabilizes(&self) -> bool {
        self.viscous.as_ref().is_some_and(|v| v.rate > 0.0)
    }

    pub(super) fn stabilize<const TANGENT: bool>(&mut self, u: &[f64], residual: &mut [f64]) {
        let (Some(viscous), Some(model)) = (&self.viscous, &self.model.stabilization) else {
            return;
        };
        if viscous.rate == 0.0 {
            return;
        }
        let medium = viscous.medium();
        for (dof, weight) in model.weights.iter().enumerate() {
            let stiffness = weight * viscous.rate;
            residual[dof] += stiffness * (u[dof] - medium[dof]);
            if TANGENT && stiffness > 0.0 {
                self.matrix.add_diagonal(dof, stiffness);
            }
        }
    }

    /// Mean velocity of some nodes in the present step, which ends at `u`.
    pub fn velocity(&self, u: &[f64], nodes: &[u32]) -> Vec3 {
        let Some(viscous) = &self.viscous else {
            return Vec3::zeros();
        };
        let sum = nodes.iter().fold(Vec3::zeros(), |s, &n| {
            let way = |c: usize| u[3 * n as usize + c] - viscous.base[3 * n as usize + c];
            s + Vec3::new(way(0), way(1), way(2))
        });
        sum * (viscous.rate / nodes.len() as f64)
    }

    /// What the stabilisation did in the step whose last evaluation was at `u`; `residual` is that of all degrees of freedom.
    pub fn drag(&self, u: &[f64], residual: &[f64]) -> Drag {
        let of_scene = self.viscous.as_ref().zip(self.model.stabilization.as_ref());
        if of_scene.is_none() && !self.passing.acts() {
            return Drag::default();
        }
        // Force of a degree of freedom, and its way.
        let of = |dof: usize| {
            let [force, _] = self.passing.force(dof, u[dof]);
            let [drag, way] = of_scene.map_or([0.0, 0.0], |(viscous, model)| {
                let drag = model.weights[dof] * viscous.rate * (u[dof] - viscous.medium()[dof]);
                [drag, u[dof] - viscous.base[dof]]
            });
            let way = match self.passing.acts() {
                true => self.passing.way(dof, u[dof]),
                false => way,
            };
            (force + drag, way)
        };
        let mut out = Drag::default();
        let (mut own, mut forces, mut held) = (0.0, [0.0f64; 3], 0);
        let removed: Vec<u32> = self.dofs.removed().collect();
        let bodies = 3 * self.model.body_nodes();
        for first in (0..u.len()).step_by(3) {
            let (mut drag, mut node) = (0.0, [0.0f64; 3]);
            for (dof, reaction) in residual.iter().enumerate().skip(first).take(3) {
                let (force, way) = match dof < bodies {
                    true => of(dof),
                    false => (0.0, 0.0),
                };
                out.work += force * way;
                drag += force * force;
                let squared = |of: &[f64]| of.get(dof).map_or(0.0, |f| f.powi(2));
                node[0] += squared(&self.external);
                node[1] += squared(&self.contact);
                if removed.get(held) == Some(&(dof as u32)) {
                    held += 1;
                    node[2] += reaction.powi(2);
                }
            }
            own += drag.sqrt();
            (0..3).for_each(|i| forces[i] += node[i].sqrt());
        }
        let largest = forces.iter().fold(0.0f64, |a, f| a.max(*f));
        out.share = match own > 0.0 {
            true => own / largest.max(f64::MIN_POSITIVE),
            false => 0.0,
        };
        out
    }
}
