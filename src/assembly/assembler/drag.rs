//! What viscous forces did in a step.
use super::Assembler;
use crate::contact::law::PairLaw;

/// What the stabilisation did in a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Drag {
    /// Energy that its forces took.
    pub work: f64,
    /// Its forces (sum of the magnitudes at nodes) relative to those of loads, supports or contacts, whichever are largest.
    pub share: f64,
    /// The same without those of supports, as long as others act: a bending moment is held by pairs of forces that are large beside
    /// what bends.
    pub beside_loads: f64,
}

impl<L: PairLaw> Assembler<'_, L> {
    /// What the stabilisation did in the step whose last evaluation was at `u`; `residual` is that of all degrees of freedom.
    pub fn drag(&self, u: &[f64], residual: &[f64]) -> Drag {
        let passing = &self.effects.passing;
        let of_scene = self
            .effects
            .viscous
            .as_ref()
            .zip(self.model.stabilization.as_ref());
        if of_scene.is_none() && !passing.acts() {
            return Drag::default();
        }
        // Force of a degree of freedom, and its way.
        let of = |dof: usize| {
            let [force, _] = passing.force(dof, u[dof]);
            let [drag, way] = of_scene.map_or([0.0, 0.0], |(viscous, model)| {
                viscous.force(dof, model.weights[dof], u[dof])
            });
            let way = match passing.acts() {
                true => passing.way(dof, u[dof]),
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
        if own > 0.0 {
            let [loads, contacts, supports] = forces;
            let beside = |most: f64| own / most.max(f64::MIN_POSITIVE);
            let acting = loads.max(contacts);
            out.share = beside(acting.max(supports));
            out.beside_loads = match acting > 0.0 {
                true => beside(acting),
                false => out.share,
            };
        }
        out
    }
}
