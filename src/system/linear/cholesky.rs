//! The direct solver: faer's supernodal Cholesky factorizations on node blocks.
use super::ordering::{self, NodeOrder, buffer};
use super::permuted::{PermutedBlocks, expand};
use super::symbolic;
use super::{
    Analysis, Factorization, LinearError, LinearSolver, Method, Mode, SolverOptions,
    first_not_finite, reserved, same_pattern,
};
use crate::machine::memory;
use crate::system::{Pattern, SystemMatrix};
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::{ldlt::factor::LdltError, llt::factor::LltError};
use faer::sparse::linalg::cholesky::supernodal;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};
use std::fmt;
use std::sync::Arc;

/// A sparse direct solver for symmetric systems. See [`LinearSolver`] for how it is used; it can be analysed again
/// when the pattern changes.
#[derive(Default)]
pub struct DirectSolver {
    options: SolverOptions,
    prepared: Option<Prepared>,
}

impl DirectSolver {
    /// A solver that has analysed nothing yet.
    pub fn new(options: SolverOptions) -> Self {
        Self {
            options,
            prepared: None,
        }
    }

    /// The settings.
    pub fn options(&self) -> &SolverOptions {
        &self.options
    }

    /// What an analysis of a pattern finds, the memory above all; nothing is prepared or kept.
    ///
    /// # Errors
    /// [`LinearError::TooLarge`], [`LinearError::OutOfMemory`], [`LinearError::Metis`].
    pub fn plan(pattern: &Pattern, options: &SolverOptions) -> Result<Analysis, LinearError> {
        Plan::new(pattern, options).map(|plan| plan.analysis)
    }

    /// What the last analysis found.
    pub fn analysis(&self) -> Option<&Analysis> {
        self.prepared.as_ref().map(|p| &p.analysis)
    }

    /// The order of elimination, `order[new] = old node`.
    pub fn node_order(&self) -> Option<&[u32]> {
        self.prepared
            .as_ref()
            .map(|p| p.matrix.blocks.new_to_old.as_slice())
    }

    /// Whether the solver is prepared for matrices on `pattern`.
    pub fn is_analyzed_for(&self, pattern: &Arc<Pattern>) -> bool {
        self.prepared
            .as_ref()
            .is_some_and(|p| same_pattern(&p.pattern, pattern))
    }
}

impl fmt::Debug for DirectSolver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DirectSolver")
            .field("options", &self.options)
            .field("analysis", &self.analysis())
            .finish_non_exhaustive()
    }
}

impl LinearSolver for DirectSolver {
    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<&Analysis, LinearError> {
        self.prepared = None;
        let prepared = Prepared::new(pattern, &self.options)?;
        Ok(&self.prepared.insert(prepared).analysis)
    }

    fn factorize(&mut self, matrix: &SystemMatrix) -> Result<Factorization, LinearError> {
        let prepared = self.prepared.as_mut().ok_or(LinearError::NotAnalyzed)?;
        prepared.factor = None;
        if !same_pattern(&prepared.pattern, matrix.pattern()) {
            return Err(LinearError::PatternMismatch);
        }
        if !matrix.is_symmetric() {
            return Err(LinearError::Unsymmetric);
        }
        prepared.matrix.gather(matrix)?;
        let mode = self.options.mode;
        let llt = mode == Mode::Llt || (mode == Mode::Auto && !prepared.expect_indefinite);
        let found = if llt {
            match prepared.llt() {
                Err(LinearError::NonPositivePivot { .. }) if mode == Mode::Auto => {
                    prepared.ldlt()?
                }
                other => other?,
            }
        } else {
            prepared.ldlt()?
        };
        prepared.expect_indefinite = found.negative_pivots > 0;
        if let Some(dof) = found.smallest_pivot
            && found.smallest_pivot_ratio < self.options.pivot_tolerance
        {
            let ratio = found.smallest_pivot_ratio;
            return Err(LinearError::TinyPivot { dof, ratio });
        }
        prepared.factor = Some(found.method);
        Ok(found)
    }

    fn expects_indefinite(&self) -> bool {
        self.prepared.as_ref().is_some_and(|p| p.expect_indefinite)
    }

    fn expect_indefinite(&mut self, expected: bool) {
        if let Some(prepared) = &mut self.prepared {
            prepared.expect_indefinite = expected;
        }
    }

    fn solve_in_place(&mut self, rhs: &mut [f64]) -> Result<(), LinearError> {
        let prepared = self.prepared.as_mut().ok_or(LinearError::NotAnalyzed)?;
        prepared.solve(rhs)
    }
}

/// The lower triangle of the permuted matrix, by columns of dofs.
#[derive(Debug)]
struct PermutedMatrix {
    blocks: PermutedBlocks,
    dof_starts: Vec<u32>,
    dof_rows: Vec<u32>,
    values: Vec<f64>,
}

impl PermutedMatrix {
    fn new(pattern: &Pattern, order: NodeOrder) -> Self {
        let mut blocks = PermutedBlocks::new(pattern, order);
        let (dof_starts, dof_rows) = expand(&blocks.starts, &blocks.rows);
        // The dofs' rows say the same.
        blocks.rows = Vec::new();
        Self {
            blocks,
            values: vec![0.0; dof_rows.len()],
            dof_starts,
            dof_rows,
        }
    }

    /// Copies the values in the new order and checks that they are finite.
    fn gather(&mut self, matrix: &SystemMatrix) -> Result<(), LinearError> {
        let from = matrix.values();
        for column in self.blocks.starts.windows(2) {
            let sources = &self.blocks.sources[column[0] as usize..column[1] as usize];
            let height = 3 * sources.len();
            let to = &mut self.values[9 * column[0] as usize..][..3 * height];
            for (k, &source) in sources.iter().enumerate() {
                let first = 9 * (source >> 1) as usize;
                let block = &from[first..first + 9];
                // A product with zero is zero, and NaN if the value is infinite or NaN.
                if block.iter().map(|v| v * 0.0).sum::<f64>() != 0.0 {
                    return Err(not_finite(matrix.pattern(), source >> 1));
                }
                for b in 0..3 {
                    let target = &mut to[b * height + 3 * k..][..3];
                    for (a, t) in target.iter_mut().enumerate() {
                        *t = if source & 1 == 0 {
                            block[3 * b + a]
                        } else {
                            block[3 * a + b]
                        };
                    }
                }
            }
        }
        Ok(())
    }

    fn view(&self) -> SparseColMatRef<'_, u32, f64> {
        let n = self.dof_starts.len() - 1;
        // The check passes over all indices, which is little beside any factorization.
        let symbolic = SymbolicSparseColMatRef::new_unsorted_checked(
            n,
            n,
            &self.dof_starts,
            None,
            &self.dof_rows,
        );
        SparseColMatRef::new(symbolic, &self.values)
    }

    fn diagonal(&self, dof: usize) -> f64 {
        let (node, c) = (dof / 3, dof % 3);
        let starts = &self.blocks.starts;
        let first = starts[node] as usize;
        let height = 3 * (starts[node + 1] as usize - first);
        self.values[9 * first + c * height + c]
    }
}

fn not_finite(pattern: &Pattern, block: u32) -> LinearError {
    let column = pattern.column_starts().partition_point(|&s| s <= block) - 1;
    LinearError::NonFiniteMatrix {
        row: pattern.rows()[block as usize],
        column: column as u32,
    }
}

/// Everything that belongs to one pattern.
struct Prepared {
    pattern: Arc<Pattern>,
    analysis: Analysis,
    matrix: PermutedMatrix,
    symbolic: supernodal::SymbolicSupernodalCholesky<u32>,
    factor_values: Vec<f64>,
    /// Permuted right-hand side; sums of the pivot check.
    vector: Vec<f64>,
    memory: MemBuffer,
    par: Par,
    /// The last matrix had negative pivots.
    expect_indefinite: bool,
    factor: Option<Method>,
}

/// What the symbolic analysis decides, before anything of the factor's size is allocated.
struct Plan {
    analysis: Analysis,
    symbolic: supernodal::SymbolicSupernodalCholesky<u32>,
    order: NodeOrder,
    scratch: StackReq,
    par: Par,
}

impl Plan {
    fn new(pattern: &Pattern, options: &SolverOptions) -> Result<Self, LinearError> {
        let order = ordering::order(pattern, options.ordering)?;
        let n = pattern.dofs();
        let (mut analysis, par) = Analysis::of(&order, options);
        let symbolic = symbolic::of_dofs(pattern, &order)?;
        let scratch = supernodal::factorize_supernodal_numeric_llt_scratch::<u32, f64>(
            &symbolic,
            par,
            Default::default(),
        )
        .or(supernodal::factorize_supernodal_numeric_ldlt_scratch::<
            u32,
            f64,
        >(&symbolic, par, Default::default()))
        .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        analysis.stored = symbolic.len_val();
        let entries = 9 * pattern.blocks();
        analysis.memory_bytes = scratch.size_bytes()
            + 8 * (analysis.stored + entries + n)
            + 4 * (entries + n + 1 + pattern.blocks())
            + 4 * (symbolic.row_idx().len() + 4 * symbolic.n_supernodes());
        let plan = Plan {
            analysis,
            symbolic,
            order,
            scratch,
            par,
        };
        Ok(plan)
    }
}

impl Prepared {
    fn new(pattern: &Arc<Pattern>, options: &SolverOptions) -> Result<Self, LinearError> {
        let Plan {
            analysis,
            symbolic,
            order,
            scratch,
            par,
        } = Plan::new(pattern, options)?;
        memory::ask(analysis.memory_bytes as u64).map_err(LinearError::Memory)?;
        let n = pattern.dofs();
        let matrix = PermutedMatrix::new(pattern, order);
        let memory = buffer(scratch)?;
        let factor_values = reserved(analysis.stored)?;
        Ok(Self {
            pattern: Arc::clone(pattern),
            analysis,
            matrix,
            symbolic,
            factor_values,
            vector: vec![0.0; n],
            memory,
            par,
            expect_indefinite: false,
            factor: None,
        })
    }

    fn llt(&mut self) -> Result<Factorization, LinearError> {
        let result = supernodal::factorize_supernodal_numeric_llt(
            &mut self.factor_values,
            self.matrix.view(),
            Default::default(),
            &self.symbolic,
            self.par,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        if let Err(LltError::NonPositivePivot { index }) = result {
            let dof = self.matrix.blocks.dof_name(index);
            return Err(LinearError::NonPositivePivot { dof });
        }
        let mut found = Smallest::default();
        self.for_each_pivot(|dof, l| {
            found.see(dof, l * l, self.matrix.diagonal(dof).abs());
        });
        Ok(found.into_factorization(Method::Llt, &self.matrix))
    }

    fn ldlt(&mut self) -> Result<Factorization, LinearError> {
        let result = supernodal::factorize_supernodal_numeric_ldlt(
            &mut self.factor_values,
            self.matrix.view(),
            Default::default(),
            &self.symbolic,
            self.par,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        if let Err(LdltError::ZeroPivot { index }) = result {
            let dof = self.matrix.blocks.dof_name(index);
            return Err(LinearError::ZeroPivot { dof });
        }
        let mut indefinite = false;
        self.for_each_pivot(|_, d| indefinite |= d < 0.0);
        self.vector.fill(0.0);
        if indefinite {
            self.sum_updates();
        }
        let mut found = Smallest::default();
        self.for_each_pivot(|dof, d| {
            let terms = self.matrix.diagonal(dof).abs().max(self.vector[dof]);
            found.see(dof, d, terms);
        });
        Ok(found.into_factorization(Method::Ldlt, &self.matrix))
    }

    /// Calls `f` with every permuted dof and its entry on the factor's diagonal, in order.
    fn for_each_pivot(&self, mut f: impl FnMut(usize, f64)) {
        let factor = supernodal::SupernodalLltRef::new(&self.symbolic, &self.factor_values);
        for s in 0..self.symbolic.n_supernodes() {
            let node = factor.supernode(s);
            let (start, values) = (node.start(), node.val());
            for j in 0..values.ncols() {
                f(start + j, values[(j, j)]);
            }
        }
    }

    /// `vector[i] = sum_k l_ik^2 |d_k|`: the magnitudes that were subtracted on the way to pivot `i`. For a positive
    /// definite matrix they add up to less than the diagonal and this is not needed.
    fn sum_updates(&mut self) {
        let factor = supernodal::SupernodalLdltRef::new(&self.symbolic, &self.factor_values);
        for s in 0..self.symbolic.n_supernodes() {
            let node = factor.supernode(s);
            let (start, values) = (node.start(), node.val());
            let columns = values.ncols();
            for j in 0..columns {
                let d = values[(j, j)].abs();
                for i in j + 1..columns {
                    self.vector[start + i] += values[(i, j)] * values[(i, j)] * d;
                }
                for (i, &row) in node.pattern().iter().enumerate() {
                    let l = values[(columns + i, j)];
                    self.vector[row as usize] += l * l * d;
                }
            }
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) -> Result<(), LinearError> {
        let method = self.factor.ok_or(LinearError::NotFactorized)?;
        let n = self.vector.len();
        if rhs.len() != n {
            return Err(LinearError::Length {
                given: rhs.len(),
                expected: n,
            });
        }
        if let Some(dof) = first_not_finite(rhs) {
            return Err(LinearError::NonFiniteRightHandSide { dof });
        }
        self.matrix.blocks.permute(rhs, &mut self.vector);
        let x = MatMut::from_column_major_slice_mut(&mut self.vector, n, 1);
        let stack = MemStack::new(&mut self.memory);
        match method {
            Method::Llt => supernodal::SupernodalLltRef::new(&self.symbolic, &self.factor_values)
                .solve_in_place_with_conj(Conj::No, x, Par::Seq, stack),
            _ => supernodal::SupernodalLdltRef::new(&self.symbolic, &self.factor_values)
                .solve_in_place_with_conj(Conj::No, x, Par::Seq, stack),
        }
        self.matrix.blocks.restore(&self.vector, rhs);
        match first_not_finite(rhs) {
            Some(dof) => Err(LinearError::NonFiniteSolution { dof }),
            None => Ok(()),
        }
    }
}

/// Runs over the pivots and keeps the smallest ratio.
#[derive(Default)]
struct Smallest {
    negative: usize,
    at: Option<(usize, f64)>,
}

impl Smallest {
    fn see(&mut self, dof: usize, pivot: f64, terms: f64) {
        self.negative += usize::from(pivot < 0.0);
        // A pivot whose terms are all zero is itself zero, which has been refused.
        let ratio = pivot.abs() / terms;
        if self.at.is_none_or(|(_, r)| ratio < r) {
            self.at = Some((dof, ratio));
        }
    }

    fn into_factorization(self, method: Method, matrix: &PermutedMatrix) -> Factorization {
        Factorization {
            method,
            perturbed_pivots: 0,
            negative_pivots: self.negative,
            smallest_pivot_ratio: self.at.map_or(1.0, |(_, r)| r),
            smallest_pivot: self.at.map(|(dof, _)| matrix.blocks.dof_name(dof)),
        }
    }
}
