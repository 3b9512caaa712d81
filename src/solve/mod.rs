//! Newton's method with incremental loading on a sparse direct solver.
pub mod convergence;
mod cycle;
pub mod event;
pub mod failure;
pub mod newton;
pub mod place;
pub mod stepping;
pub mod unstable;
