//! Solid-shell elements and their materials.
//!
//! Elements have displacement unknowns only, three per node, on the top and the bottom face of the shell, so that
//! contact sees a genuine surface. Everything is total Lagrange: Green-Lagrange strains `E_ij = (g_i.g_j - G_i.G_j)/2`
//! in the convected frame `G_i = X_,i`, `g_i = x_,i` of the natural coordinates (r, s, t), t being the thickness.
//! Strains, stresses and tangents keep their covariant and contravariant components throughout, and isotropic laws are
//! evaluated with the metric, so no rotation to Cartesian axes is paid for.
//!
//! - [`H8Block`], [`Q18Block`]: the elements of one body, evaluated one at a time ([`H8System`], [`Q18System`] receive
//!   forces and tangent); [`Block`] is either.
//! - [`material`]: laws, one file each.
//! - [`distortion`]: how far an element is from the shape it computes best in.

// Index loops show the sums the way they are written on paper, over several arrays at once.
#![allow(clippy::needless_range_loop)]

mod block;
mod brick;
pub mod distortion;
mod error;
mod h8;
mod history;
mod hold;
mod kinematics;
mod layered;
pub mod material;
mod mean_dilatation;
mod nurbs;
mod pressed;
mod q18;
mod reference;
mod stress;
mod sums;
mod tangent;
#[cfg(test)]
mod tests;

pub(crate) use block::with_block;
pub use block::{Block, ElementBlock, ElementSystem, STATES, bytes_per_element};
pub use error::{ElementFault, FaultCause, ShellError};
pub use h8::{Formulation, H8Block, H8System};
pub use history::{Flow, PlasticWork, Remembered};
pub use material::{Law, MaterialLaw, Memory, Metric, NeoHooke, Response, StVenantKirchhoff};
pub use nurbs::{
    AnchorSpring, HeldNormal, NurbsBlock, NurbsSystem, SEAM_DOFS, SEAM_NODES, SeamSpan,
    SheetResultants,
};
pub use q18::{Q18Block, Q18System};
pub use stress::{extrapolate, extrapolate_quadratic};

/// Voigt order of strains and stresses: 11, 22, 33, 12, 23, 13; strains with engineering shears `2 E_ij`.
pub const VOIGT: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
