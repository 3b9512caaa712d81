//! Direct solution by a library that is not part of the program: what such solvers have in common.
//!
//! The foreign solver analyses, factorizes and solves; this one checks what goes in and comes out, improves solutions, and has a
//! solver of its own, the host's, beside it. Without the library or what it runs on the first analysis fails. What fails later is
//! given up: the host solves from there on, and [`LinearSolver::take_handover`] says why.
mod csr;

pub(super) use csr::Csr;

use super::{
    Analysis, DirectSolver, Factorization, LinearError, LinearSolver, LuSolver, SolverOptions,
    first_not_finite, reserved, same_pattern,
};
use crate::system::{Pattern, SystemMatrix};
use std::fmt;
use std::sync::Arc;

/// Largest backward error of a solution that is accepted.
const ACCEPTED: f64 = 1e-8;
/// A backward error that a refinement would hardly better.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// A solver of another library.
pub(super) trait Backend: Send {
    /// Prepares for matrices on a pattern; what was prepared before is dropped.
    fn analyze(&mut self, pattern: &Pattern) -> Result<Analysis, LinearError>;

    /// Factorizes a matrix on the analysed pattern, whose values are finite. None where the host does it better.
    fn factorize(&mut self, matrix: &SystemMatrix) -> Result<Option<Factorization>, LinearError>;

    /// Overwrites a right-hand side of the right length with the solution.
    fn solve(&mut self, x: &mut [f64]) -> Result<(), LinearError>;

    /// Frees everything.
    fn clear(&mut self);

    /// Whether the host takes over where a solution stays inaccurate.
    fn leaves_hard_cases(&self) -> bool {
        false
    }

    /// As [`LinearSolver::expects_indefinite`].
    fn expects_indefinite(&self) -> bool {
        false
    }

    /// As [`LinearSolver::expect_indefinite`].
    fn expect_indefinite(&mut self, _expected: bool) {}
}

/// A direct solver that leaves the work to a library which is looked for when the first pattern is analysed.
pub struct ForeignSolver {
    backend: Box<dyn Backend>,
    symmetric: bool,
    prepared: Option<Prepared>,
    /// The solver beside it, and the pattern that it has analysed.
    host: Box<dyn LinearSolver + Send>,
    host_pattern: Option<u64>,
    /// What made an end of the library's part, and whether it has been told.
    fault: Option<LinearError>,
    told: bool,
}

/// Where the factors are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum At {
    Nowhere,
    Backend,
    Host,
}

/// What belongs to one pattern.
struct Prepared {
    pattern: Arc<Pattern>,
    analysis: Analysis,
    rhs: Vec<f64>,
    residual: Vec<f64>,
    sizes: Vec<f64>,
    at: At,
}

impl ForeignSolver {
    /// A solver that has analysed nothing yet.
    pub(super) fn new(backend: Box<dyn Backend>, symmetric: bool, options: SolverOptions) -> Self {
        let host: Box<dyn LinearSolver + Send> = match symmetric {
            true => Box::new(DirectSolver::new(options)),
            false => Box::new(LuSolver::new(options)),
        };
        ForeignSolver {
            backend,
            symmetric,
            prepared: None,
            host,
            host_pattern: None,
            fault: None,
            told: false,
        }
    }

    /// The pattern that was analysed.
    pub fn pattern(&self) -> Option<&Arc<Pattern>> {
        self.prepared.as_ref().map(|p| &p.pattern)
    }

    /// Leaves everything from here on to the host.
    fn give_up(&mut self, fault: LinearError) {
        self.fault = self.fault.or(Some(fault));
        self.backend.clear();
        if let Some(prepared) = &mut self.prepared {
            prepared.at = At::Nowhere;
        }
    }

    /// Factorizes on the host.
    fn on_host(&mut self, matrix: &SystemMatrix) -> Result<Factorization, LinearError> {
        let pattern = matrix.pattern();
        if self.host_pattern != Some(pattern.id()) {
            self.host_pattern = None;
            self.host.analyze(pattern)?;
            self.host_pattern = Some(pattern.id());
        }
        let found = self.host.factorize(matrix)?;
        if let Some(prepared) = &mut self.prepared {
            prepared.at = At::Host;
        }
        Ok(found)
    }

    /// What is prepared, if it is for this pattern.
    fn prepared(&mut self, matrix: &SystemMatrix) -> Result<&mut Prepared, LinearError> {
        let prepared = self.prepared.as_mut().ok_or(LinearError::NotAnalyzed)?;
        match same_pattern(&prepared.pattern, matrix.pattern()) {
            true => Ok(prepared),
            false => Err(LinearError::PatternMismatch),
        }
    }

    /// The solution and its backward error; `rhs` of what is prepared keeps the right-hand side.
    fn solve_refined(&mut self, matrix: &SystemMatrix, x: &mut [f64]) -> Result<f64, LinearError> {
        let prepared = self.prepared.as_mut().ok_or(LinearError::NotAnalyzed)?;
        prepared.rhs.copy_from_slice(x);
        self.backend.solve(x)?;
        let mut error = prepared.backward_error(matrix, x);
        if error > ROUND_OFF && error.is_finite() {
            self.backend.solve(&mut prepared.residual)?;
            for (x, c) in x.iter_mut().zip(&prepared.residual) {
                *x += c;
            }
            error = prepared.backward_error(matrix, x);
        }
        Ok(error)
    }
}

impl fmt::Debug for ForeignSolver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ForeignSolver")
            .field("symmetric", &self.symmetric)
            .field("fault", &self.fault)
            .finish_non_exhaustive()
    }
}

impl LinearSolver for ForeignSolver {
    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<&Analysis, LinearError> {
        let first = self.prepared.is_none();
        (self.prepared, self.host_pattern) = (None, None);
        let mut analysis = None;
        if self.fault.is_none() {
            match self.backend.analyze(pattern) {
                Ok(found) => analysis = Some(found),
                Err(error) if first || !error.is_fault() => return Err(error),
                Err(error) => self.give_up(error),
            }
        }
        let analysis = match analysis {
            Some(analysis) => analysis,
            None => {
                let analysis = *self.host.analyze(pattern)?;
                self.host_pattern = Some(pattern.id());
                analysis
            }
        };
        let n = pattern.dofs();
        let prepared = Prepared {
            pattern: pattern.clone(),
            analysis,
            rhs: reserved(n)?,
            residual: reserved(n)?,
            sizes: reserved(n)?,
            at: At::Nowhere,
        };
        Ok(&self.prepared.insert(prepared).analysis)
    }

    fn factorize(&mut self, matrix: &SystemMatrix) -> Result<Factorization, LinearError> {
        let symmetric = self.symmetric;
        let prepared = self.prepared(matrix)?;
        prepared.at = At::Nowhere;
        if symmetric && !matrix.is_symmetric() {
            return Err(LinearError::Unsymmetric);
        }
        if let Some((row, column)) = matrix.first_not_finite() {
            return Err(LinearError::NonFiniteMatrix { row, column });
        }
        if self.fault.is_none() {
            match self.backend.factorize(matrix) {
                Ok(Some(found)) => {
                    self.prepared(matrix)?.at = At::Backend;
                    return Ok(found);
                }
                Ok(None) => {}
                Err(error) if error.is_fault() => self.give_up(error),
                Err(error) => return Err(error),
            }
        }
        self.on_host(matrix)
    }

    fn solve_in_place(&mut self, rhs: &mut [f64]) -> Result<(), LinearError> {
        let prepared = self.prepared.as_mut().ok_or(LinearError::NotAnalyzed)?;
        match prepared.at {
            At::Nowhere => Err(LinearError::NotFactorized),
            At::Host => self.host.solve_in_place(rhs),
            At::Backend => {
                prepared.check(rhs)?;
                // Without the matrix the host cannot take over.
                self.backend.solve(rhs)?;
                match first_not_finite(rhs) {
                    Some(dof) => Err(LinearError::NonFiniteSolution { dof }),
                    None => Ok(()),
                }
            }
        }
    }

    /// Solves, and improves the solution once unless its backward error is that of round-off already.
    fn solve_with(&mut self, matrix: &SystemMatrix, rhs: &mut [f64]) -> Result<(), LinearError> {
        let prepared = self.prepared(matrix)?;
        match prepared.at {
            At::Nowhere => return Err(LinearError::NotFactorized),
            At::Host => return self.host.solve_with(matrix, rhs),
            At::Backend => prepared.check(rhs)?,
        }
        match self.solve_refined(matrix, rhs) {
            Ok(error) if error <= ACCEPTED => return Ok(()),
            Ok(error) if !self.backend.leaves_hard_cases() => {
                return Err(match first_not_finite(rhs) {
                    Some(dof) => LinearError::NonFiniteSolution { dof },
                    None => LinearError::Inaccurate { error },
                });
            }
            Ok(_) => {}
            Err(error) if error.is_fault() => self.give_up(error),
            Err(error) => return Err(error),
        }
        rhs.copy_from_slice(&self.prepared(matrix)?.rhs);
        self.on_host(matrix)?;
        self.host.solve_with(matrix, rhs)
    }

    fn expects_indefinite(&self) -> bool {
        match self.fault {
            None => self.backend.expects_indefinite(),
            Some(_) => self.host.expects_indefinite(),
        }
    }

    fn expect_indefinite(&mut self, expected: bool) {
        self.backend.expect_indefinite(expected);
        self.host.expect_indefinite(expected);
    }

    fn take_handover(&mut self) -> Option<LinearError> {
        let fault = self.fault.filter(|_| !self.told)?;
        self.told = true;
        Some(fault)
    }
}

impl Prepared {
    fn check(&self, rhs: &[f64]) -> Result<(), LinearError> {
        let (given, expected) = (rhs.len(), self.rhs.len());
        if given != expected {
            return Err(LinearError::Length { given, expected });
        }
        match first_not_finite(rhs) {
            Some(dof) => Err(LinearError::NonFiniteRightHandSide { dof }),
            None => Ok(()),
        }
    }

    /// Largest residual of a row by the sizes of the terms that make it up; `residual` keeps the residual.
    fn backward_error(&mut self, matrix: &SystemMatrix, x: &[f64]) -> f64 {
        matrix.multiply(x, &mut self.residual);
        matrix.abs_multiply(x, &mut self.sizes);
        let mut largest = 0.0;
        for ((r, b), size) in self.residual.iter_mut().zip(&self.rhs).zip(&self.sizes) {
            *r = b - *r;
            let size = size + b.abs();
            let error = if size > 0.0 { r.abs() / size } else { r.abs() };
            if error > largest || error.is_nan() {
                largest = error;
            }
        }
        largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::linear::{DeviceFault, Method};

    /// Works as long as it has calls left.
    struct Failing {
        calls: u32,
        order: u32,
    }

    impl Failing {
        fn call(&mut self) -> Result<(), LinearError> {
            match self.calls.checked_sub(1) {
                Some(left) => self.calls = left,
                None => return Err(DeviceFault::NoMemory { bytes: 8 }.into()),
            }
            Ok(())
        }
    }

    /// Takes the matrix for the unit matrix.
    impl Backend for Failing {
        fn analyze(&mut self, pattern: &Pattern) -> Result<Analysis, LinearError> {
            self.call()?;
            self.order = pattern.dofs() as u32;
            DirectSolver::plan(pattern, &SolverOptions::default())
        }
        fn factorize(&mut self, _: &SystemMatrix) -> Result<Option<Factorization>, LinearError> {
            self.call()?;
            Ok(Some(Factorization {
                method: Method::Ldlt,
                negative_pivots: 0,
                perturbed_pivots: 0,
                smallest_pivot_ratio: 1.0,
                smallest_pivot: None,
            }))
        }
        fn solve(&mut self, x: &mut [f64]) -> Result<(), LinearError> {
            assert_eq!(x.len() as u32, self.order);
            self.call()
        }
        fn clear(&mut self) {
            self.order = 0;
        }
    }

    fn unit() -> SystemMatrix {
        let pattern = Pattern::new(2, [&[0u32, 1][..]].into_iter()).expect("small");
        let mut matrix = SystemMatrix::new(Arc::new(pattern));
        (0..6).for_each(|dof| matrix.add_diagonal(dof, 1.0));
        matrix
    }

    /// Wherever the library fails after the first analysis, the host takes over, and why is told once.
    #[test]
    fn the_host_takes_over() {
        let b = [1.0, -2.0, 3.0, -4.0, 5.0, -6.0];
        for calls in 0..7 {
            let backend = Box::new(Failing { calls, order: 0 });
            let mut solver = ForeignSolver::new(backend, true, SolverOptions::default());
            let mut matrix = unit();
            let analyzed = solver.analyze(matrix.pattern()).map(drop);
            if calls == 0 {
                assert!(matches!(analyzed, Err(LinearError::Device(_))));
                assert_eq!(solver.factorize(&matrix), Err(LinearError::NotAnalyzed));
                continue;
            }
            analyzed.expect("one call");
            assert_eq!(
                solver.solve_in_place(&mut b.clone()),
                Err(LinearError::NotFactorized)
            );
            for _ in 0..3 {
                let mut x = b;
                solver.factorize(&matrix).expect("regular");
                solver.solve_with(&matrix, &mut x).expect("solved");
                assert_eq!(x, b);
                matrix = unit();
                solver.analyze(matrix.pattern()).expect("by either");
            }
            let told = solver.take_handover();
            assert_eq!(told, Some(DeviceFault::NoMemory { bytes: 8 }.into()));
            assert_eq!(solver.take_handover(), None);
        }
    }

    /// What is not a solution is refused.
    #[test]
    fn an_inaccurate_solution() {
        let backend = Box::new(Failing { calls: 9, order: 0 });
        let mut solver = ForeignSolver::new(backend, true, SolverOptions::default());
        let mut matrix = unit();
        matrix.add_diagonal(2, 0.5);
        solver.analyze(matrix.pattern()).expect("small");
        solver.factorize(&matrix).expect("not looked at");
        let solved = solver.solve_with(&matrix, &mut [1.0; 6]);
        assert!(
            matches!(solved, Err(LinearError::Inaccurate { .. })),
            "{solved:?}"
        );
    }
}
