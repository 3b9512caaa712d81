//! Facets: the faces of finite elements as surfaces.
//!
//! A [`Bilinear`] facet has four nodes, a [`Biquadratic`] one nine; both are [`Surface`](crate::Surface)s over `[-1, 1]^2`, the
//! parameters of the finite elements whose faces they are. Nodes are numbered with **xi1 fastest**, as control points and
//! as the faces of elements are: of four (-,-), (+,-), (-,+), (+,+); of nine node `i + 3 j` is at `(i - 1, j - 1)`.
//!
//! They deliver what they have: of a bilinear facet `rho_11 = rho_22 = 0`, so only its `h_12` differs from zero, and the
//! curvature of the surface that it stands for is in the angles between facets.
//!
//! A [`FacetMesh`] holds nodes that facets share. It comes from smooth surfaces ([`bilinear_facets`],
//! [`biquadratic_facets`]; [`smooth_patches`] lays one smooth surface over them), from STL files ([`Stl::facets`](crate::io::Stl::facets)) or from the faces of a finite-element mesh.

mod bilinear;
mod biquadratic;
mod counts;
mod deviation;
mod lines;
mod mesh;
mod refine;
mod smooth;

pub use bilinear::Bilinear;
pub use biquadratic::Biquadratic;
pub use mesh::FacetMesh;
pub use refine::{
    Crack, FacetOrigin, Faceted, Refinement, bilinear_facets, biquadratic_facets, facet_patch,
};
pub use smooth::{distance_from, smooth_patches};

/// Why facets could not be made. Numbers count from zero.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FacetError {
    /// A coordinate is infinite or not a number.
    #[error("node {0} is not finite")]
    Node(usize),
    /// A facet asks for a node that there is not.
    #[error("facet {facet} has node {node}, but there are {count} nodes")]
    NoNode {
        /// Number of the facet.
        facet: usize,
        /// The node that it asks for.
        node: u32,
        /// Nodes that there are.
        count: usize,
    },
    /// The chord tolerance or the size is not a positive finite number.
    #[error("the chord tolerance or size {0} is not a positive number")]
    Tolerance(f64),
    /// No facets per span are asked for.
    #[error("a span cannot be cut in no facets at all")]
    Count,
    /// The patches are farther apart at a joint than facets that share nodes there may be from them.
    #[error("joints are open by {gap:.3e}, more than half of the chord tolerance {tolerance:.3e}")]
    Gap {
        /// Largest gap of all joints.
        gap: f64,
        /// The chord tolerance.
        tolerance: f64,
    },
    /// A trimmed patch.
    #[error("trimmed patches cannot be faceted: patch {0} has a trim")]
    Trimmed(usize),
    /// More facets than allowed.
    #[error(
        "more than {limit} facets would be needed (the deviation is still {deviation:.3e} where {tolerance:.3e} is allowed)"
    )]
    TooMany {
        /// The largest number of facets.
        limit: usize,
        /// Largest deviation before the limit was met.
        deviation: f64,
        /// The tolerance asked for; zero where a number per span was.
        tolerance: f64,
    },
    /// No smooth surface can be laid over the facets.
    #[error(transparent)]
    Smooth(#[from] crate::moving::MovingError),
    /// A piece of the smooth surface that is no patch.
    #[error(transparent)]
    Patch(#[from] crate::patch::PatchError),
    /// A single patch that is no set.
    #[error(transparent)]
    Set(#[from] crate::project::PatchSetError),
}
