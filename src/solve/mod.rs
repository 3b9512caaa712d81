//! Newton's method with incremental loading on a sparse direct solver.
pub(crate) mod convergence;
mod cycle;
pub mod event;
pub(crate) mod failure;
pub mod newton;
pub(crate) mod place;
pub(crate) mod stepping;
pub(crate) mod unstable;
