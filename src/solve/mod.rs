//! Newton's method with incremental loading on a sparse direct solver.
pub mod convergence;
pub mod event;
pub mod linear;
pub mod newton;
pub mod stepping;
pub mod unstable;
