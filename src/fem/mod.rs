//! What finite elements share: quadrature rules and the maps of their faces.
//!
//! - [`quadrature`]: Gauss and Lobatto rules.
//! - [`face`]: the faces that loads and contact integrate over, given by their nodes.
pub mod face;
pub mod quadrature;

pub use face::{FaceNodes, Quad, shape, shape_derivatives};
pub use quadrature::{Rule, gauss, lobatto};
