//! Fields of bodies with inertia.
use crate::assembly::Assembler;
use crate::model::Model;
use crate::output::{Field, Place};
use std::ops::Range;

/// How bodies with inertia move, 3 numbers per node of the model.
pub struct MotionFields {
    velocity: Vec<f64>,
    /// Forces of inertia and damping.
    pub forces: Vec<f64>,
}

impl MotionFields {
    /// At the displacements `u`, at the end of the step that is solved or of the last one that was accepted; nothing without
    /// inertia.
    pub fn new(model: &Model, assembler: &Assembler, u: &[f64]) -> Option<Self> {
        let inertia = assembler.effects.inertia.as_ref()?;
        Some(MotionFields {
            velocity: inertia.velocities(u),
            forces: inertia.forces(model, u),
        })
    }

    /// Of these nodes.
    pub fn field(&self, nodes: &Range<usize>) -> Field<'_> {
        Field {
            name: "velocity",
            components: 3,
            component_names: &[],
            data: &self.velocity[3 * nodes.start..3 * nodes.end],
            place: Place::Point,
        }
    }
}
