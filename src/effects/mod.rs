//! What acts on nodes beside elements, loads and contact: each effect is a file or folder behind one trait, and the assembler
//! goes through those that a model has.
pub mod inertia;

use crate::model::Model;
use crate::system::{ConstrainedScatter, DofMap, SystemMatrix};

/// An effect that adds to the balance of forces.
pub trait Contribution: Send {
    /// A step from time `start` to `end` begins at the displacements `u`.
    fn begin(&mut self, model: &Model, u: &[f64], span: [f64; 2]);

    /// Adds its forces at the displacements `u` to a residual that holds all that acted before it, and what they change by to
    /// the tangent where there is one.
    fn add(&mut self, model: &Model, u: &[f64], residual: &mut [f64], to: Option<Tangent<'_>>);

    /// Bytes of heap that it holds.
    fn bytes(&self) -> usize;
}

/// The tangent of an evaluation.
pub struct Tangent<'a> {
    pub matrix: &'a mut SystemMatrix,
    pub dofs: &'a DofMap,
    pub work: &'a mut ConstrainedScatter,
    /// Where the blocks of the elements go, element after element ([`crate::system::Pattern::element_map`]).
    pub maps: &'a [u32],
    /// Prescribed increments that are still to come.
    pub increments: Option<&'a [f64]>,
    /// What these make of the right-hand side.
    pub rhs: &'a mut [f64],
}
