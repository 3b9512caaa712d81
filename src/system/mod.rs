//! One sparse system, symmetric or with a symmetric structure, and its direct solvers.
//!
//! - [`DofMap`]: prescribed and tied degrees of freedom, and how they are condensed;
//! - [`Pattern`]: which nodes are coupled, as 3 x 3 blocks of the lower triangle;
//! - [`SystemMatrix`]: the values on a pattern, with scatter and products;
//! - [`linear`]: ordering, factorization and substitution.
//!
//! Every node has three degrees of freedom: number `3 * node + component`. All of them stay in the system, so that
//! the blocks are complete; a dof that a constraint removes gets a row and column of zeros and a diagonal
//! ([`SystemMatrix::set_identity`]).
mod constraints;
pub mod linear;
mod matrix;
mod pattern;
mod scalars;

pub use constraints::{ConstraintError, Dof, DofMap, DofMapBuilder, Link};
pub use matrix::{ConstrainedScatter, SystemMatrix};
pub use pattern::{Pattern, PatternError};
