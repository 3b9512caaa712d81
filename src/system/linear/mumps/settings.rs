//! What a user may ask of MUMPS.
use std::path::PathBuf;

/// Settings of [`ForeignSolver::mumps`](crate::system::linear::ForeignSolver::mumps).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MumpsOptions {
    pub ordering: MumpsOrdering,
    /// The folder in which the factors are kept instead of in memory.
    pub out_of_core: Option<PathBuf>,
}

/// Order of elimination.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MumpsOrdering {
    /// The order that this program's own factorizations take: of minimum degree and nested dissection the one with fewer operations.
    #[default]
    Auto,
    /// Nested dissection, by the METIS in this program.
    Metis,
    /// Approximate minimum degree, of this program.
    Amd,
    /// Nested dissection by SCOTCH, if the library has it.
    Scotch,
    /// PORD, if the library has it.
    Pord,
    /// Approximate minimum fill, of MUMPS.
    Amf,
    /// Approximate minimum degree that sees rows which are nearly full, of MUMPS.
    Qamd,
}

impl MumpsOrdering {
    /// The name in scenes.
    pub const fn name(self) -> &'static str {
        match self {
            MumpsOrdering::Auto => "auto",
            MumpsOrdering::Metis => "metis",
            MumpsOrdering::Amd => "amd",
            MumpsOrdering::Scotch => "scotch",
            MumpsOrdering::Pord => "pord",
            MumpsOrdering::Amf => "amf",
            MumpsOrdering::Qamd => "qamd",
        }
    }
}
