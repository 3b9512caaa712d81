//! From element matrices to one sparse system, symmetric or with a symmetric structure.
//!
//! - [`Pattern`]: which nodes are coupled, as 3 x 3 blocks of the lower triangle;
//! - [`SystemMatrix`]: the values on a pattern, with scatter and products;
//! - [`Assembler`]: residual and tangent of a model;
//! - [`DofMap`]: prescribed and tied degrees of freedom, and how they are condensed.
//!
//! Every node has three degrees of freedom: number `3 * node + component`. All of them stay in the system, so that
//! the blocks are complete; a dof that a constraint removes gets a row and column of zeros and a diagonal
//! ([`SystemMatrix::set_identity`]).
mod assembler;
mod constraints;
mod matrix;
mod pattern;

pub(crate) use assembler::sizes;
pub use assembler::{
    Assembler, AssemblerMemory, CouplingMemory, Drag, Factored, Fault, Line, Manner, MemoryError,
    Needed, PairForce, PointAnswer, Quadratic, SurfaceForce, Totals,
};
pub use constraints::{ConstraintError, Dof, DofMap, DofMapBuilder, Link};
pub use matrix::{ConstrainedScatter, SystemMatrix};
pub use pattern::{Pattern, PatternError};
