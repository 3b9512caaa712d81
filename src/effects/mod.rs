//! What acts on nodes beside elements, loads and contact: each effect is a file or folder behind one trait, and the assembler
//! goes through those that a model has.
pub mod inertia;
mod passing;
mod viscous;

pub use passing::Passing;
pub use viscous::Viscous;

use crate::model::Model;
use crate::system::{ConstrainedScatter, DofMap, SystemMatrix};
use inertia::Inertia;

/// An effect that adds to the balance of forces.
pub trait Contribution: Send {
    /// A step over the times `span` begins at the displacements `u`.
    fn begin(&mut self, model: &Model, u: &[f64], span: [f64; 2]);

    /// Adds its forces at the displacements `u` to a residual that holds all that acted before it, and what they change by to
    /// the tangent where there is one.
    fn add(&mut self, model: &Model, u: &[f64], residual: &mut [f64], to: Option<&mut Tangent>);

    /// When it is added.
    fn turn(&self) -> Turn {
        Turn::Last
    }

    /// Norm of its forces in the last evaluation, where the residual has to be small beside them.
    fn norm(&self) -> f64 {
        0.0
    }

    /// Bytes of heap that it holds.
    fn bytes(&self) -> usize;
}

/// The order in which effects are added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn {
    /// Before contact: it weights all that acts before it.
    BeforeContact,
    /// After contact, which it weights too.
    AfterContact,
    /// When all else is summed.
    Last,
}

/// The tangent of an evaluation.
pub struct Tangent<'a> {
    /// The matrix that blocks are added to.
    pub matrix: &'a mut SystemMatrix,
    /// Which degrees of freedom are unknown.
    pub dofs: &'a DofMap,
    /// Work space for adding blocks of constrained degrees of freedom.
    pub work: &'a mut ConstrainedScatter,
    /// Where the blocks of the elements go, element after element ([`crate::system::Pattern::element_map`]).
    pub maps: &'a [u32],
    /// Prescribed increments that are still to come.
    pub increments: Option<&'a [f64]>,
    /// What these make of the right-hand side.
    pub rhs: &'a mut [f64],
}

/// The effects of a model.
#[derive(Debug)]
pub struct Effects {
    /// In dynamics.
    pub inertia: Option<Box<Inertia>>,
    /// Where the scene asks for stabilisation.
    pub viscous: Option<Viscous>,
    /// What takes a run past a jump.
    pub passing: Passing,
}

impl Effects {
    /// Those that the model asks for.
    pub fn new(model: &Model) -> Effects {
        Effects {
            inertia: Inertia::new(model).map(Box::new),
            viscous: Viscous::new(model),
            passing: Passing::default(),
        }
    }

    /// All that there are.
    pub fn all(&mut self) -> impl Iterator<Item = &mut dyn Contribution> {
        let Effects {
            inertia,
            viscous,
            passing,
        } = self;
        let inertia = inertia.as_deref_mut().map(|e| e as &mut dyn Contribution);
        let viscous = viscous.as_mut().map(|e| e as &mut dyn Contribution);
        (inertia.into_iter())
            .chain(viscous)
            .chain([passing as &mut dyn Contribution])
    }

    /// Bytes of heap by part, also of those that there are not.
    pub fn parts(&self) -> [(&'static str, usize); 4] {
        let Effects {
            inertia,
            viscous,
            passing,
        } = self;
        [
            ("inertia", inertia.as_ref().map_or(0, |e| e.bytes())),
            ("dashpots", inertia.as_ref().map_or(0, |e| e.dashpots())),
            ("stabilization", viscous.as_ref().map_or(0, |e| e.bytes())),
            ("jumps", passing.bytes()),
        ]
    }
}
