//! Newton's method with incremental loading on a sparse direct solver.
pub mod event;
pub mod linear;
