//! Why a CAD surface cannot be a shell.
use covact_geometry::patch::PatchError;

/// Why a patch cannot be made a sheet.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NurbsError {
    /// A trim leaves nothing of the patch.
    #[error("the trim of the face leaves nothing of it")]
    Empty,
    /// The elements are cubic, and a degree cannot be lowered without another shape.
    #[error("the face has degree {degree} along xi{}, above {}", direction + 1, super::DEGREE)]
    Degree {
        /// Direction of the patch, 0 or 1.
        direction: usize,
        /// The degree of the patch along it.
        degree: usize,
    },
    /// The tangents may jump inside the patch.
    #[error("the face has a crease inside: at xi{} = {value} its knots allow the tangents to jump", direction + 1)]
    Crease {
        /// Direction of the patch, 0 or 1.
        direction: usize,
        /// The knot.
        value: f64,
    },
    /// An edge is one point in space, where there is no normal.
    #[error("edge {} of the face is one point (a pole), where the surface has no normal", edge + 1)]
    Pole {
        /// Number of the edge, 0 to 3.
        edge: usize,
    },
    /// Two edges are the same curve.
    #[error("edges {} and {} of the face are the same curve: a closed surface has to be cut in two", edges[0] + 1, edges[1] + 1)]
    Closed {
        /// Numbers of both edges, 0 to 3.
        edges: [usize; 2],
    },
    /// No tangent plane somewhere inside.
    #[error("the face has no normal at ({}, {}, {})", at[0], at[1], at[2])]
    NoNormal {
        /// Position of such a point.
        at: [f64; 3],
    },
    /// The surface moved under refinement.
    #[error("refinement moved the surface by {moved:e} of its size (limit {limit:e})")]
    Moved {
        /// Largest distance over the size of the patch.
        moved: f64,
        /// The largest that is accepted.
        limit: f64,
    },
    /// No side is the top throughout.
    #[error("faces {} and {} are parts of a surface with one side only (as a Moebius strip), which has no top", faces[0], faces[1])]
    OneSided {
        /// Numbers of both faces.
        faces: [u32; 2],
    },
    /// Two patches lie on each other.
    #[error("faces {} and {} are the same: their edges coincide all round", faces[0], faces[1])]
    Twice {
        /// Numbers of both faces.
        faces: [u32; 2],
    },
    /// More elements than make sense.
    #[error("{elements} knot spans are more than the limit of {limit}")]
    TooMany {
        /// Knot spans that were asked for.
        elements: u64,
        /// The most that are accepted.
        limit: u64,
    },
    /// An operation on knots or degree failed.
    #[error(transparent)]
    Patch(#[from] PatchError),
}
