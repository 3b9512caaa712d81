//! The direct solver for unsymmetric systems on a symmetric pattern: a supernodal LU on the structure of a Cholesky
//! factor.
mod dense;
mod factor;
mod scaling;
mod structure;
mod substitute;

use super::ordering;
use super::permuted::PermutedBlocks;
use super::symbolic;
use super::{
    Analysis, Factorization, LinearError, LinearSolver, Method, SolverOptions, first_not_finite,
    reserved, same_pattern,
};
use crate::machine::memory;
use crate::system::{Pattern, SystemMatrix};
use dense::Pivots;
use factor::{Factor, Source, Work};
use faer::Par;
use scaling::Scaling;
use std::fmt;
use std::sync::Arc;
use structure::Structure;

/// A backward error that is as good as round-off: no refinement can better it much.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;
/// Largest backward error of a solution that is accepted.
const ACCEPTED: f64 = 1e-8;
/// Part of what the largest unknown would make of a row below which that row is at rest, for each unknown of the system: round-off
/// of all of them is no more.
const AT_REST: f64 = 1000.0 * f64::EPSILON;
/// Refinements at most where pivots were replaced; one elsewhere.
const REFINEMENTS: u32 = 10;
/// A matrix with replaced pivots is singular if refinement does not bring the residual below this share of the
/// right-hand side: of a vector of random signs nearly everything lies outside the range of a singular matrix.
const SOLVABLE: f64 = 1e-3;

/// A sparse direct solver for matrices with a symmetric structure, unsymmetric ones above all.
///
/// Rows and columns are scaled; rows are exchanged within the diagonal block of a supernode only. A pivot below
/// [`SolverOptions::pivot_tolerance`] of its row is replaced by 1.5e-8 of it and counted
/// ([`Factorization::perturbed_pivots`]). The matrix is then tested: if refined solutions do not exist, it is singular
/// and the pivot is named.
#[derive(Default)]
pub struct LuSolver {
    options: SolverOptions,
    prepared: Option<Prepared>,
}

impl LuSolver {
    /// A solver that has analysed nothing yet.
    pub fn new(options: SolverOptions) -> Self {
        Self {
            options,
            prepared: None,
        }
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
}

impl fmt::Debug for LuSolver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LuSolver")
            .field("options", &self.options)
            .field("analysis", &self.analysis())
            .finish_non_exhaustive()
    }
}

impl LinearSolver for LuSolver {
    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<&Analysis, LinearError> {
        self.prepared = None;
        let prepared = Prepared::new(pattern, &self.options)?;
        Ok(&self.prepared.insert(prepared).analysis)
    }

    fn factorize(&mut self, matrix: &SystemMatrix) -> Result<Factorization, LinearError> {
        let prepared = self.prepared.as_mut().ok_or(LinearError::NotAnalyzed)?;
        prepared.factorized = None;
        if !same_pattern(&prepared.pattern, matrix.pattern()) {
            return Err(LinearError::PatternMismatch);
        }
        if let Some((row, column)) = matrix.first_not_finite() {
            return Err(LinearError::NonFiniteMatrix { row, column });
        }
        prepared.factorize(matrix, self.options.pivot_tolerance)
    }

    fn solve_in_place(&mut self, rhs: &mut [f64]) -> Result<(), LinearError> {
        let prepared = self.prepared.as_mut().ok_or(LinearError::NotAnalyzed)?;
        prepared.check(rhs)?;
        prepared.substitute(rhs);
        match first_not_finite(rhs) {
            Some(dof) => Err(LinearError::NonFiniteSolution { dof }),
            None => Ok(()),
        }
    }

    /// Solves, improves the solution once (more often where pivots were replaced) unless its backward error is that of
    /// round-off already, and refuses it if the error stays large.
    fn solve_with(&mut self, matrix: &SystemMatrix, rhs: &mut [f64]) -> Result<(), LinearError> {
        let prepared = self.prepared.as_mut().ok_or(LinearError::NotAnalyzed)?;
        if !same_pattern(&prepared.pattern, matrix.pattern()) {
            return Err(LinearError::PatternMismatch);
        }
        prepared.check(rhs)?;
        prepared.solve_refined(matrix, rhs)
    }
}

/// Everything that belongs to one pattern.
struct Prepared {
    pattern: Arc<Pattern>,
    analysis: Analysis,
    blocks: PermutedBlocks,
    structure: Structure,
    factor: Factor,
    scaling: Scaling,
    work: Work,
    /// The last factorization.
    factorized: Option<Factorization>,
    /// Permuted right-hand side.
    vector: Vec<f64>,
    below: Vec<f64>,
    rhs: Vec<f64>,
    residual: Vec<f64>,
    sizes: Vec<f64>,
    par: Par,
}

/// What the symbolic analysis decides, before anything of the factors' size is allocated.
struct Plan {
    analysis: Analysis,
    blocks: PermutedBlocks,
    structure: Structure,
    par: Par,
}

impl Plan {
    fn new(pattern: &Pattern, options: &SolverOptions) -> Result<Self, LinearError> {
        let order = ordering::order(pattern, options.ordering)?;
        let n = pattern.dofs();
        let (mut analysis, par) = Analysis::of(&order, options);
        // Of the counts c of a Cholesky factor's columns, the sums of c and of c (c + 3) / 2 are known; L and U take
        // c (c - 1) operations for each.
        analysis.flops = 2.0 * order.flops - 4.0 * order.fill as f64;
        analysis.fill = 2 * order.fill - n as u64;
        let symbolic = symbolic::of_nodes(pattern, &order)?;
        let blocks = PermutedBlocks::new(pattern, order);
        let structure = Structure::new(&symbolic, &blocks);
        drop(symbolic);
        analysis.stored = structure.values();
        let index = 4 * (blocks.rows.len() + blocks.sources.len() + blocks.starts.len() + 4 * n);
        let vectors = 8 * (8 * n + structure.below);
        analysis.memory_bytes =
            8 * (analysis.stored + structure.product) + structure.bytes() + index + vectors;
        Ok(Plan {
            analysis,
            blocks,
            structure,
            par,
        })
    }
}

impl Prepared {
    fn new(pattern: &Arc<Pattern>, options: &SolverOptions) -> Result<Self, LinearError> {
        let Plan {
            analysis,
            blocks,
            structure,
            par,
        } = Plan::new(pattern, options)?;
        memory::ask(analysis.memory_bytes as u64).map_err(LinearError::Memory)?;
        let n = pattern.dofs();
        let factor = Factor {
            values: reserved(analysis.stored)?,
            swaps: vec![0; n],
        };
        let work = Work::new(&structure, reserved(structure.product)?);
        Ok(Self {
            pattern: Arc::clone(pattern),
            analysis,
            blocks,
            factor,
            scaling: Scaling::new(n),
            work,
            factorized: None,
            vector: vec![0.0; n],
            below: vec![0.0; structure.below],
            rhs: vec![0.0; n],
            residual: vec![0.0; n],
            sizes: vec![0.0; n],
            structure,
            par,
        })
    }

    fn factorize(
        &mut self,
        matrix: &SystemMatrix,
        threshold: f64,
    ) -> Result<Factorization, LinearError> {
        self.scaling.compute(matrix)?;
        let source = Source {
            matrix,
            scaling: &self.scaling,
            blocks: &self.blocks,
        };
        let (structure, work) = (&self.structure, &mut self.work);
        let pivots = (self.factor).compute(structure, &source, work, threshold, self.par);
        let found = self.found(&pivots);
        if pivots.replaced > 0
            && let Some(dof) = found.smallest_pivot
            && !self.solvable(matrix)
        {
            let ratio = pivots.smallest;
            return Err(LinearError::TinyPivot { dof, ratio });
        }
        self.factorized = Some(found);
        Ok(found)
    }

    fn found(&self, pivots: &Pivots) -> Factorization {
        let any = pivots.smallest.is_finite();
        let dof = || self.blocks.dof_name(pivots.smallest_at);
        Factorization {
            method: Method::Lu,
            negative_pivots: usize::from(pivots.negative),
            perturbed_pivots: pivots.replaced,
            smallest_pivot_ratio: if any { pivots.smallest } else { 1.0 },
            smallest_pivot: any.then(dof),
        }
    }

    /// Whether the matrix has a solution for a right-hand side of which nearly everything is random.
    fn solvable(&mut self, matrix: &SystemMatrix) -> bool {
        let n = self.rhs.len();
        let mut rhs = std::mem::take(&mut self.rhs);
        let mut x = std::mem::take(&mut self.sizes);
        // Signs that follow the bits of the golden ratio's multiples, scaled as the rows are.
        for (i, (b, scale)) in rhs.iter_mut().zip(&self.scaling.rows).enumerate() {
            let bit = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40 & 1;
            *b = if bit == 0 { 1.0 } else { -1.0 } / scale;
        }
        x[..n].copy_from_slice(&rhs);
        self.substitute(&mut x);
        let mut best = f64::INFINITY;
        for _ in 0..REFINEMENTS {
            self.residual(matrix, &rhs, &x);
            let scaled = (self.residual.iter().zip(&self.scaling.rows)).map(|(r, s)| (r * s).abs());
            let largest = scaled.fold(0.0, |m, r| if r > m || r.is_nan() { r } else { m });
            if !largest.is_finite() || largest > 0.5 * best {
                break;
            }
            best = largest;
            if best < SOLVABLE {
                break;
            }
            self.improve(&mut x);
        }
        (self.rhs, self.sizes) = (rhs, x);
        best < SOLVABLE
    }

    fn check(&self, rhs: &[f64]) -> Result<(), LinearError> {
        if self.factorized.is_none() {
            return Err(LinearError::NotFactorized);
        }
        let (given, expected) = (rhs.len(), self.vector.len());
        if given != expected {
            return Err(LinearError::Length { given, expected });
        }
        match first_not_finite(rhs) {
            Some(dof) => Err(LinearError::NonFiniteRightHandSide { dof }),
            None => Ok(()),
        }
    }

    /// `x = A^-1 x` with the factors at hand.
    fn substitute(&mut self, x: &mut [f64]) {
        for (x, scale) in x.iter_mut().zip(&self.scaling.rows) {
            *x *= scale;
        }
        self.blocks.permute(x, &mut self.vector);
        (self.factor).solve(&self.structure, &mut self.vector, &mut self.below);
        self.blocks.restore(&self.vector, x);
        for (x, scale) in x.iter_mut().zip(&self.scaling.columns) {
            *x *= scale;
        }
    }

    /// `residual = b - A x`
    fn residual(&mut self, matrix: &SystemMatrix, rhs: &[f64], x: &[f64]) {
        matrix.multiply(x, &mut self.residual);
        for (r, b) in self.residual.iter_mut().zip(rhs) {
            *r = b - *r;
        }
    }

    /// `x += A^-1 residual`
    fn improve(&mut self, x: &mut [f64]) {
        let mut correction = std::mem::take(&mut self.residual);
        self.substitute(&mut correction);
        for (x, c) in x.iter_mut().zip(&correction) {
            *x += c;
        }
        self.residual = correction;
    }

    fn solve_refined(&mut self, matrix: &SystemMatrix, x: &mut [f64]) -> Result<(), LinearError> {
        let mut rhs = std::mem::take(&mut self.rhs);
        rhs.copy_from_slice(x);
        self.substitute(x);
        let perturbed = self.factorized.is_some_and(|f| f.perturbed_pivots > 0);
        let most = if perturbed { REFINEMENTS } else { 1 };
        let mut error = self.backward_error(matrix, &rhs, x);
        for _ in 0..most {
            if error <= ROUND_OFF || !error.is_finite() {
                break;
            }
            let before = error;
            self.improve(x);
            error = self.backward_error(matrix, &rhs, x);
            if error > 0.5 * before {
                break;
            }
        }
        self.rhs = rhs;
        if let Some(dof) = first_not_finite(x) {
            return Err(LinearError::NonFiniteSolution { dof });
        }
        if error > ACCEPTED {
            return Err(LinearError::Inaccurate { error });
        }
        Ok(())
    }

    /// `max |b - A x| / (|A| |x| + |b|)` by rows (W. Oettli and W. Prager, "Compatibility of approximate solution of
    /// linear equations with given error bounds for coefficients and right-hand sides", Numer. Math. 6 (1964)); leaves
    /// the residual.
    ///
    /// Where a part has come to rest while others move, both terms below the line go down with every iteration until their last
    /// digits underflow. Such rows are measured against what the largest unknown would make of them (M. Arioli, J. W. Demmel and
    /// I. S. Duff, "Solving sparse linear systems with sparse backward error", SIAM J. Matrix Anal. Appl. 10 (1989)), which is their
    /// largest entry times it: one, as rows and columns are scaled.
    fn backward_error(&mut self, matrix: &SystemMatrix, rhs: &[f64], x: &[f64]) -> f64 {
        self.residual(matrix, rhs, x);
        matrix.abs_multiply(x, &mut self.sizes);
        let scaled = x.iter().zip(&self.scaling.columns);
        let largest = scaled.map(|(x, c)| (x / c).abs()).fold(0.0, f64::max);
        let at_rest = AT_REST * x.len() as f64;
        let mut worst = 0.0f64;
        let rows = self.residual.iter().zip(&self.sizes).zip(rhs);
        for (((r, size), b), scale) in rows.zip(&self.scaling.rows) {
            if *r != 0.0 {
                let (own, elsewhere) = (size + b.abs(), largest / scale);
                let rests = own <= at_rest * (elsewhere + b.abs());
                let ratio = r.abs() / if rests { size + elsewhere } else { own };
                worst = if ratio.is_nan() {
                    f64::INFINITY
                } else {
                    worst.max(ratio)
                };
            }
        }
        worst
    }
}
