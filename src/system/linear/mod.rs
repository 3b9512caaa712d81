//! Direct solution of the system of a Newton iteration: [`DirectSolver`] where it is symmetric, [`LuSolver`] where only
//! its structure is; either by another library with `ForeignSolver` (features `cudss` and `mumps`).
//!
//! The symbolic work (ordering, structure of the factor, memory) is done once for a pattern, the numeric factorization
//! as often as the values change, without allocating.
mod cholesky;
#[cfg(feature = "cudss")]
mod cudss;
mod device;
#[cfg(any(feature = "cudss", feature = "mumps"))]
mod foreign;
mod inertia;
mod lu;
mod metis;
#[cfg(feature = "mumps")]
mod mumps;
mod mumps_fault;
mod ordering;
mod permuted;
mod symbolic;

pub use cholesky::DirectSolver;
pub use device::DeviceFault;
#[cfg(any(feature = "cudss", feature = "mumps"))]
pub use foreign::ForeignSolver;
pub use inertia::negative_pivots;
pub use lu::LuSolver;
#[cfg(feature = "mumps")]
pub use mumps::MumpsOptions;
pub use mumps_fault::MumpsFault;

use crate::machine::memory::Shortage;
use crate::system::{Pattern, SystemMatrix};
use faer::Par;
use ordering::NodeOrder;
use std::fmt;
use std::sync::Arc;

/// A solver of `A x = b` in three steps.
pub trait LinearSolver {
    /// Prepares for matrices on `pattern`; what was prepared and factorized before is dropped.
    ///
    /// # Errors
    /// [`LinearError::TooLarge`], [`LinearError::Memory`], [`LinearError::OutOfMemory`], [`LinearError::Metis`].
    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<&Analysis, LinearError>;

    /// Factorizes a matrix on the analysed pattern.
    ///
    /// # Errors
    /// [`LinearError::NotAnalyzed`], [`LinearError::PatternMismatch`], [`LinearError::Unsymmetric`] where the solver is
    /// for symmetric matrices, [`LinearError::NonFiniteMatrix`] and the errors of a matrix that has no (accurate)
    /// factorization; there is no factorization to solve with after any of them.
    fn factorize(&mut self, matrix: &SystemMatrix) -> Result<Factorization, LinearError>;

    /// Overwrites the right-hand side with the solution.
    ///
    /// # Errors
    /// [`LinearError::NotFactorized`], [`LinearError::Length`], [`LinearError::NonFiniteRightHandSide`],
    /// [`LinearError::NonFiniteSolution`].
    fn solve_in_place(&mut self, rhs: &mut [f64]) -> Result<(), LinearError>;

    /// Overwrites the right-hand side with the solution, with what the solver needs of the factorized `matrix` to make
    /// it as accurate as a Newton iteration wants it: nothing by default.
    ///
    /// # Errors
    /// As [`solve_in_place`](Self::solve_in_place), and [`LinearError::Inaccurate`].
    fn solve_with(&mut self, matrix: &SystemMatrix, rhs: &mut [f64]) -> Result<(), LinearError> {
        let _ = matrix;
        self.solve_in_place(rhs)
    }

    /// What is remembered of the matrices factorized so far, beside the analysis of their pattern: that an indefinite one
    /// is to be expected. A run that is continued gives it to [`expect_indefinite`](Self::expect_indefinite).
    fn expects_indefinite(&self) -> bool {
        false
    }

    /// Sets [`expects_indefinite`](Self::expects_indefinite), after the pattern was analysed.
    fn expect_indefinite(&mut self, _expected: bool) {}

    /// Why another solver than the one that was asked for has taken over since this was last called: what was asked for has
    /// failed on the way.
    fn take_handover(&mut self) -> Option<LinearError> {
        None
    }

    /// Solves and improves the solution once with the residual in working precision: `x = A^-1 b` and then
    /// `x += A^-1 (b - A x)`. It makes the backward error small where pivoting was poor (indefinite matrices); it does
    /// not lower the floor that `|A| |x|` sets. `residual` holds `b - A x` of the first solution, before it was
    /// improved, on return.
    ///
    /// # Errors
    /// As [`solve_in_place`](Self::solve_in_place), and [`LinearError::PatternMismatch`].
    fn solve_refined(
        &mut self,
        matrix: &SystemMatrix,
        rhs: &[f64],
        x: &mut [f64],
        residual: &mut [f64],
        correction: &mut [f64],
    ) -> Result<(), LinearError> {
        let expected = matrix.pattern().dofs();
        for given in [rhs.len(), x.len(), residual.len(), correction.len()] {
            if given != expected {
                return Err(LinearError::Length { given, expected });
            }
        }
        x.copy_from_slice(rhs);
        self.solve_in_place(x)?;
        matrix.multiply(x, residual);
        for (r, b) in residual.iter_mut().zip(rhs) {
            *r = b - *r;
        }
        correction.copy_from_slice(residual);
        self.solve_in_place(correction)?;
        for (x, c) in x.iter_mut().zip(correction) {
            *x += *c;
        }
        Ok(())
    }
}

/// Which factorization of a symmetric matrix to make.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// `L L^t`: an indefinite matrix is an error.
    Llt,
    /// `L D L^t` without pivoting: indefinite matrices, too; negative pivots are counted.
    Ldlt,
    /// `L L^t`, and `L D L^t` when that finds the matrix indefinite. It stays with `L D L^t` until a matrix is positive
    /// definite again.
    #[default]
    Auto,
}

/// A factorization that was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Method {
    /// `L L^t`
    Llt,
    /// `L D L^t`
    Ldlt,
    /// `L U` with exchanges of rows within the diagonal blocks.
    Lu,
}

impl Method {
    /// The name in scenes and results: `llt`, `ldlt`, `lu`.
    pub const fn name(self) -> &'static str {
        match self {
            Method::Llt => "llt",
            Method::Ldlt => "ldlt",
            Method::Lu => "lu",
        }
    }
}

/// Which orders of the nodes to try.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OrderingChoice {
    /// Approximate minimum degree alone.
    Amd,
    /// Nested dissection alone.
    Metis,
    /// Both, and the one with fewer operations is kept; minimum degree alone for small graphs, where the second
    /// ordering costs more than it can save.
    #[default]
    Best,
}

/// Settings of a [`DirectSolver`] or an [`LuSolver`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverOptions {
    /// For symmetric matrices; [`LuSolver`] knows one factorization only.
    pub mode: Mode,
    /// Which orders of the nodes to try.
    pub ordering: OrderingChoice,
    /// Threads of the dense kernels at most; 1 is serial (and does not allocate). More are used only where they help
    /// ([`Analysis::threads`]).
    pub threads: usize,
    /// Operations of a factorization below which one thread is used all the same.
    pub parallel_min_flops: f64,
    /// A pivot smaller than this times the sum of the magnitudes that it is the rest of is refused: fewer than about
    /// two digits of the solution would be right at 1e-14. Zero accepts everything but an exact zero. [`LuSolver`]
    /// replaces a smaller pivot instead and tests whether the matrix is singular.
    pub pivot_tolerance: f64,
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self {
            mode: Mode::Auto,
            ordering: OrderingChoice::Best,
            threads: 1,
            parallel_min_flops: 5e8,
            pivot_tolerance: 1e-14,
        }
    }
}

/// How the nodes were ordered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ordering {
    /// Approximate minimum degree.
    Amd,
    /// Nested dissection by METIS.
    Metis,
    /// One of another library.
    Other,
}

/// What the symbolic analysis found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Analysis {
    /// The order that is used.
    pub ordering: Ordering,
    /// Operations (multiply and subtract count as one, plus divisions) of a factorization in that order.
    pub flops: f64,
    /// Operations with minimum degree, if it was tried.
    pub flops_amd: Option<f64>,
    /// Operations with nested dissection, if it was tried.
    pub flops_metis: Option<f64>,
    /// Nonzeros of the factor's lower triangle, of both triangles for [`LuSolver`].
    pub fill: u64,
    /// Values stored for the factor, with the zeros that wide supernodes bring.
    pub stored: usize,
    /// Bytes held for the factor, the permuted matrix, the index structure and the workspace.
    pub memory_bytes: usize,
    /// Threads that factorizations use.
    pub threads: usize,
    /// Code of METIS if it failed and minimum degree was used instead.
    pub metis_failed: Option<i32>,
}

impl Analysis {
    /// What the order alone tells, and the threads it is worth.
    fn of(order: &NodeOrder, options: &SolverOptions) -> (Self, Par) {
        let threads = if options.threads > 1 && order.flops >= options.parallel_min_flops {
            options.threads
        } else {
            1
        };
        let analysis = Analysis {
            ordering: order.ordering,
            flops: order.flops,
            flops_amd: order.flops_amd,
            flops_metis: order.flops_metis,
            fill: order.fill,
            stored: 0,
            memory_bytes: 0,
            threads,
            metis_failed: order.metis_failed,
        };
        let par = if threads > 1 {
            Par::rayon(threads)
        } else {
            Par::Seq
        };
        (analysis, par)
    }
}

/// What a numeric factorization found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factorization {
    /// The factorization that succeeded.
    pub method: Method,
    /// Number of negative pivots, which is the number of negative eigenvalues (Sylvester's law of inertia); zero for a
    /// stable equilibrium. [`Method::Lu`] has no inertia: one where the determinant is negative (an odd number of
    /// negative real eigenvalues), else zero.
    pub negative_pivots: usize,
    /// Pivots that were too small and were replaced ([`Method::Lu`] only); the refinement of the solution makes up for
    /// them.
    pub perturbed_pivots: usize,
    /// Smallest ratio of a pivot to the magnitudes that it is the rest of ([`Method::Lu`]: to the largest entry of its
    /// row): 1e-16 over it estimates the relative error of the solution, and its reciprocal bounds the condition of
    /// the (diagonally scaled) matrix from below.
    pub smallest_pivot_ratio: f64,
    /// Where that ratio is; `None` for a system without dofs.
    pub smallest_pivot: Option<DofName>,
}

impl Factorization {
    /// What is known of a matrix that is not positive definite.
    pub fn indefinite(&self) -> String {
        match self.method {
            Method::Lu => "the determinant of the tangent is negative".to_owned(),
            _ => format!("the tangent has {} negative pivot(s)", self.negative_pivots),
        }
    }
}

/// A degree of freedom in the numbering of the system.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct DofName {
    /// Number of the node.
    pub node: u32,
    /// 0, 1, 2 for x, y, z.
    pub component: u8,
}

impl DofName {
    /// Number of the dof, `3 * node + component`.
    pub fn dof(self) -> usize {
        3 * self.node as usize + usize::from(self.component)
    }

    fn new(dof: usize) -> Self {
        Self {
            node: (dof / 3) as u32,
            component: (dof % 3) as u8,
        }
    }
}

impl fmt::Display for DofName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = ["x", "y", "z"][usize::from(self.component.min(2))];
        write!(f, "direction {axis} of node {}", self.node)
    }
}

/// Why a system could not be solved.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LinearError {
    /// A factorization was asked for before any pattern was analysed.
    #[error("no pattern has been analysed")]
    NotAnalyzed,
    /// A solution was asked for before any factorization.
    #[error("no matrix has been factorized")]
    NotFactorized,
    /// The matrix has another pattern than the analysed one.
    #[error("the matrix has another pattern than the one that was analysed")]
    PatternMismatch,
    /// The solver takes symmetric matrices only.
    #[error("the matrix is unsymmetric, and the factorization is for symmetric ones")]
    Unsymmetric,
    /// A vector does not fit the system.
    #[error("a vector has {given} entries, the system has {expected}")]
    Length {
        /// Its number of entries.
        given: usize,
        /// Unknowns of the system.
        expected: usize,
    },
    /// The factor is too large for 32-bit indices.
    #[error("the factor has more entries than 32-bit indices can count")]
    TooLarge,
    /// The factor could not be allocated.
    #[error("not enough memory for {bytes} bytes of the factorization")]
    OutOfMemory {
        /// Bytes that were asked for.
        bytes: usize,
    },
    /// A graphics processor was asked for.
    #[error("cuDSS: {0}")]
    Device(#[from] DeviceFault),
    /// MUMPS was asked for.
    #[error("MUMPS: {0}")]
    Mumps(#[from] MumpsFault),
    /// Found out before the factorization took anything.
    #[error("the factorization of the system: {0}")]
    Memory(Shortage),
    /// METIS failed.
    #[error("METIS found no ordering (code {code})")]
    Metis {
        /// Its error code.
        code: i32,
    },
    /// The matrix has an entry that is infinite or not a number.
    #[error("the matrix has a value that is not finite in the block of nodes {row} and {column}")]
    NonFiniteMatrix {
        /// Node of its row.
        row: u32,
        /// Node of its column.
        column: u32,
    },
    /// `L L^t` met a pivot that is zero or negative.
    #[error("the matrix is not positive definite: {dof}")]
    NonPositivePivot {
        /// The degree of freedom of the pivot or entry.
        dof: DofName,
    },
    /// `L D L^t` met a pivot that is exactly zero, or that overflowed.
    #[error("the matrix is singular, or cannot be factorized without pivoting: {dof}")]
    ZeroPivot {
        /// The degree of freedom of the pivot or entry.
        dof: DofName,
    },
    /// Nothing but round-off is left of a pivot.
    #[error("the matrix is singular to working precision: {dof} (pivot ratio {ratio:.1e})")]
    TinyPivot {
        /// The degree of freedom of the pivot or entry.
        dof: DofName,
        /// The pivot over the magnitudes that it is the rest of.
        ratio: f64,
    },
    /// A row or a column of zeros.
    #[error("the matrix is singular, its row or column is zero: {dof}")]
    ZeroRow {
        /// The degree of freedom of the pivot or entry.
        dof: DofName,
    },
    /// The solution does not satisfy the equations, although it was refined.
    #[error(
        "the solution is inaccurate (backward error {error:.1e}): the matrix is too near to a singular one"
    )]
    Inaccurate {
        /// Backward error of the solution.
        error: f64,
    },
    /// The right-hand side has an entry that is infinite or not a number.
    #[error("the right-hand side is not finite: {dof}")]
    NonFiniteRightHandSide {
        /// The degree of freedom of the pivot or entry.
        dof: DofName,
    },
    /// The solution overflowed; the dof is the first that is affected, not always the one where it began.
    #[error("the solution is not finite: {dof}")]
    NonFiniteSolution {
        /// The degree of freedom of the pivot or entry.
        dof: DofName,
    },
}

impl LinearError {
    /// Whether it is of a library that was asked for, not of the matrix.
    #[cfg(any(feature = "cudss", feature = "mumps"))]
    fn is_fault(&self) -> bool {
        matches!(self, LinearError::Device(_) | LinearError::Mumps(_))
    }
}

fn same_pattern(a: &Arc<Pattern>, b: &Arc<Pattern>) -> bool {
    Arc::ptr_eq(a, b) || (a.id() == b.id() && a.nodes() == b.nodes() && a.blocks() == b.blocks())
}

fn first_not_finite(x: &[f64]) -> Option<DofName> {
    x.iter().position(|x| !x.is_finite()).map(DofName::new)
}

/// A vector of zeros, or a typed error where the allocator would abort.
fn reserved(len: usize) -> Result<Vec<f64>, LinearError> {
    let mut values = Vec::new();
    (values.try_reserve_exact(len)).map_err(|_| LinearError::OutOfMemory { bytes: 8 * len })?;
    values.resize(len, 0.0);
    Ok(values)
}
