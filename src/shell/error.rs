//! What can be wrong with elements: their input, and their state.
use thiserror::Error;

/// Why a block of elements could not be set up.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ShellError {
    /// The mesh holds another kind of element.
    #[error("the mesh holds {found} elements, not {wanted}")]
    Kind {
        /// The kind that the block takes.
        wanted: &'static str,
        /// The kind of the mesh.
        found: String,
    },
    /// An element names a node that the mesh does not have.
    #[error("element {element} refers to node {node}, but the mesh has {nodes} nodes")]
    Node {
        /// Number of the element, from 0.
        element: u32,
        /// The node that it names.
        node: u32,
        /// Number of nodes of the mesh.
        nodes: usize,
    },
    /// The connectivity is not a whole number of elements.
    #[error("{entries} node numbers are not a whole number of {nodes}-node elements")]
    Connectivity {
        /// Number of entries of the connectivity.
        entries: usize,
        /// Nodes of an element.
        nodes: usize,
    },
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
        /// Name of the constant.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be, in words.
        range: &'static str,
    },
    /// A rolled sheet whose rolling direction stands on it.
    #[error(
        "element {element}: the rolling direction of its material is nearly normal to the sheet there"
    )]
    Rolling {
        /// Number of the element, from 0.
        element: u32,
    },
    /// Three enhanced strains lock when the material is nearly incompressible.
    #[error("three enhanced strains lock at nu = {nu} (limit 0.45); use seven")]
    TooFewEnhanced {
        /// Poisson's ratio of the material.
        nu: f64,
    },
    /// Elements that put their tangent together from one half of it, with a law whose tangent is not symmetric.
    #[error(
        "the tangent of the material is not symmetric, which elements of this kind do not take"
    )]
    Unsymmetric,
    /// The law of a shell on a NURBS patch has to be elastic, with a form in plane stress.
    #[error(
        "a body of kind `nurbs` has the law `st_venant_kirchhoff` or `neo_hooke`: others have no form in plane stress here"
    )]
    PlaneStress,
    /// The tangents of a surface are parallel at a point of an element.
    #[error("element {element}: the surface has no normal there")]
    NoNormal {
        /// Number of the element, from 0.
        element: u32,
    },
    /// The elements of a sheet are set up from its patch, not from a mesh.
    #[error("elements of a NURBS patch are set up from its sheet")]
    Sheet,
}

/// An element that cannot be evaluated at the given displacements.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("element {element}: {cause}")]
pub struct ElementFault {
    /// Element number within its block.
    pub element: u32,
    /// What is wrong with it.
    pub cause: FaultCause,
}

/// What happened inside the element.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum FaultCause {
    /// The right Cauchy-Green tensor of the modified strain is not positive definite, so no deformation has it.
    #[error("{}", collapsed(*point, *ratio))]
    Collapsed {
        /// Gauss point `i + 2 j + 4 k`.
        point: u8,
        /// det C over det G, the square of the volume ratio (positive where the squares of two stretches are negative).
        ratio: f64,
    },
    /// The stiffness of the enhanced strains has a pivot that is zero or not a number.
    #[error("{}", pivot_words(*mode, *pivot))]
    Pivot {
        /// Number of the enhanced strain.
        mode: u8,
        /// The pivot.
        pivot: f64,
    },
}

/// What a strain means that no deformation has.
fn collapsed(point: u8, ratio: f64) -> String {
    if !ratio.is_finite() {
        return format!("the strain at Gauss point {point} is not a finite number ({ratio})");
    }
    let why = match ratio > 0.0 {
        true => "the squares of two stretches are negative, which no deformation has",
        false => "the material is turned inside out",
    };
    format!("det C / det G = {ratio:e} at Gauss point {point}: {why}")
}

fn pivot_words(mode: u8, pivot: f64) -> String {
    match pivot.is_finite() {
        true => format!("pivot {pivot:e} of enhanced strain {mode}"),
        false => {
            format!("the stiffness of enhanced strain {mode} is not a finite number ({pivot})")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each cause is told as what it is: inside out is what has a negative determinant, and nothing else.
    #[test]
    fn collapsed_strains_are_told_as_what_they_are() {
        let told = |ratio| FaultCause::Collapsed { point: 3, ratio }.to_string();
        assert!(told(-0.5).contains("inside out"), "{}", told(-0.5));
        assert!(told(0.0).contains("inside out"), "{}", told(0.0));
        for (ratio, words) in [
            (3.6, "the squares of two stretches are negative"),
            (f64::NAN, "not a finite number (NaN)"),
            (f64::INFINITY, "not a finite number (inf)"),
        ] {
            let text = told(ratio);
            assert!(
                text.contains(words) && !text.contains("inside out"),
                "{text}"
            );
        }
        let pivot = |pivot| FaultCause::Pivot { mode: 2, pivot }.to_string();
        assert_eq!(pivot(0.0), "pivot 0e0 of enhanced strain 2");
        assert!(pivot(f64::NAN).contains("is not a finite number (NaN)"));
    }
}
