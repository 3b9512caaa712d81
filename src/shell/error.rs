//! What can be wrong with elements: their input, and their state.
use thiserror::Error;

/// Why a block of elements could not be set up.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ShellError {
    /// The mesh holds another kind of element.
    #[error("the mesh holds {found} elements, not {wanted}")]
    Kind { wanted: &'static str, found: String },
    /// An element names a node that the mesh does not have.
    #[error("element {element} refers to node {node}, but the mesh has {nodes} nodes")]
    Node {
        element: u32,
        node: u32,
        nodes: usize,
    },
    /// The connectivity is not a whole number of elements.
    #[error("{entries} node numbers are not a whole number of {nodes}-node elements")]
    Connectivity { entries: usize, nodes: usize },
    /// Elements whose Jacobian is not positive at a Gauss point.
    #[error(
        "element {element} is inverted or flat: Jacobian determinant {jacobian:e} ({count} such element(s) in all)"
    )]
    Inverted {
        /// The first of them.
        element: u32,
        /// Smallest Jacobian determinant of that element.
        jacobian: f64,
        /// How many elements are inverted.
        count: usize,
    },
    /// A material constant is out of range.
    #[error("material: {name} = {value} must be {range}")]
    Material {
        name: &'static str,
        value: f64,
        range: &'static str,
    },
    /// Three enhanced strains lock when the material is nearly incompressible.
    #[error("three enhanced strains lock at nu = {nu} (limit 0.45); use seven")]
    TooFewEnhanced { nu: f64 },
}

/// An element that cannot be evaluated at the given displacements.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("element {element}: {cause}")]
pub struct ElementFault {
    /// Element number within its block.
    pub element: u32,
    pub cause: FaultCause,
}

/// What happened inside the element.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum FaultCause {
    /// The right Cauchy-Green tensor of the modified strain is not positive definite, so no deformation has it.
    #[error("det C / det G = {ratio:e} at Gauss point {point}: the material is turned inside out")]
    Collapsed {
        /// Gauss point `i + 2 j + 4 k`.
        point: u8,
        /// det C over det G, the square of the volume ratio (positive where two stretches are negative).
        ratio: f64,
    },
    /// The stiffness of the enhanced strains has a pivot that is zero or not a number.
    #[error("pivot {pivot:e} of enhanced strain {mode}")]
    Pivot { mode: u8, pivot: f64 },
}
