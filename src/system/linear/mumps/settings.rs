//! What a user may ask of MUMPS.
use crate::scene::MumpsOrdering;
use std::path::PathBuf;

/// Settings of [`ForeignSolver::mumps`](crate::system::linear::ForeignSolver::mumps).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MumpsOptions {
    /// How unknowns are ordered before the factorization.
    pub ordering: MumpsOrdering,
    /// The folder in which the factors are kept instead of in memory.
    pub out_of_core: Option<PathBuf>,
}
