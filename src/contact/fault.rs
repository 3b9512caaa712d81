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
    /// The search for the closest point did not converge.
    #[error("the closest point search did not converge ({piece}, xi = [{}, {}])", xi[0], xi[1])]
    ProjectionNotConverged {
        /// The patch, edge or vertex of the master that was reached.
        piece: Piece,
        /// Surface coordinates there.
        xi: [f64; 2],
    },
    /// The point is so deep or so far away that its closest point is not unique: `1 - xi3 kappa` is zero or negative.
    #[error(
        "the point lies at or beyond the focal surface of the master ({piece}, xi = [{}, {}], xi3 = {xi3:e})",
        xi[0], xi[1]
    )]
    BeyondFocalSurface {
        /// The patch, edge or vertex of the master that was reached.
        piece: Piece,
        /// Surface coordinates there.
        xi: [f64; 2],
        /// Normal coordinate of the point (length).
        xi3: f64,
    },
    /// The traction of a point on an edge or a corner acts along its distance from it.
    #[error(
        "the traction on an edge or a corner has no direction, because the point has come too near to it \
         ({piece}, xi = [{}, {}], xi3 = {xi3:e})",
        xi[0], xi[1]
    )]
    NoDirection {
        /// The patch, edge or vertex of the master that was reached.
        piece: Piece,
        /// Surface coordinates there.
        xi: [f64; 2],
        /// Normal coordinate of the point (length).
        xi3: f64,
    },
    /// The tangents of the master are parallel or zero.
    #[error("the master has no normal at {piece}, xi = [{}, {}]", xi[0], xi[1])]
    DegenerateFrame {
        /// The patch, edge or vertex of the master that was reached.
        piece: Piece,
        /// Surface coordinates there.
        xi: [f64; 2],
    },
    /// The position of the slave point is infinite or not a number.
    #[error("the point's position is not finite")]
    NotFinite,
}
