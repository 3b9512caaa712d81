//! What keeps a contact point from being evaluated.
use std::fmt;

/// The piece of a master surface that a foot lies on, numbered from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Piece {
    /// A patch of a rigid surface.
    Patch(u32),
    /// A facet of a master that moves.
    Facet(u32),
}

impl fmt::Display for Piece {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Piece::Patch(k) => write!(f, "patch {k}"),
            Piece::Facet(k) => write!(f, "facet {k}"),
        }
    }
}

/// What keeps a point from being evaluated.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PointFault {
    #[error("the closest point search did not converge ({piece}, xi = [{}, {}])", xi[0], xi[1])]
    ProjectionNotConverged { piece: Piece, xi: [f64; 2] },
    #[error(
        "the point lies at or beyond the focal surface of the master ({piece}, xi = [{}, {}], xi3 = {xi3:e})",
        xi[0], xi[1]
    )]
    BeyondFocalSurface {
        piece: Piece,
        xi: [f64; 2],
        xi3: f64,
    },
    /// The traction of a point on an edge or a corner acts along its distance from it.
    #[error(
        "the traction on an edge or a corner has no direction, because the point has come too near to it \
         ({piece}, xi = [{}, {}], xi3 = {xi3:e})",
        xi[0], xi[1]
    )]
    NoDirection {
        piece: Piece,
        xi: [f64; 2],
        xi3: f64,
    },
    #[error("the master has no normal at {piece}, xi = [{}, {}]", xi[0], xi[1])]
    DegenerateFrame { piece: Piece, xi: [f64; 2] },
    #[error("the point's position is not finite")]
    NotFinite,
}
