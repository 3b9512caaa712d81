//! Direct solution on a graphics processor, by NVIDIA's cuDSS.
//!
//! The matrix is analysed, factorized and solved on the device; the host keeps its structure by rows. Where cuDSS replaces a pivot, or a
//! solution leaves a residual, the matrix is one for which it matters how that is done: it is then factorized by the solver of the
//! host, which names the unknown that nothing holds. Hard cases so have the same answers with either.
mod library;

use super::foreign::{Backend, Csr, ForeignSolver};
use super::{
    Analysis, Factorization, LinearError, Method, OrderingChoice, SolverOptions, ordering, reserved,
};
use crate::system::{Pattern, SystemMatrix};
use library::Device;

/// `L D L^t` of symmetric matrices, `L U` of others.
struct Cudss {
    symmetric: bool,
    options: SolverOptions,
    prepared: Option<Prepared>,
}

/// Everything that belongs to one pattern.
struct Prepared {
    csr: Csr,
    device: Device,
    values: Vec<f64>,
}

impl ForeignSolver {
    /// A solver on a graphics processor, by NVIDIA's cuDSS: `L D L^t` of symmetric matrices, `L U` of others.
    pub fn cudss(symmetric: bool, options: SolverOptions) -> Self {
        let backend = Cudss {
            symmetric,
            options,
            prepared: None,
        };
        ForeignSolver::new(Box::new(backend), symmetric, options)
    }
}

impl Backend for Cudss {
    fn analyze(&mut self, pattern: &Pattern) -> Result<Analysis, LinearError> {
        self.prepared = None;
        // cuDSS has an order of its own; what this one says of the work is near enough.
        let order = ordering::order(pattern, OrderingChoice::Amd)?;
        let (mut analysis, _) = Analysis::of(&order, &self.options);
        analysis.threads = 1;
        let csr = Csr::new(pattern, self.symmetric)?;
        analysis.memory_bytes = csr.bytes() + 8 * (csr.entries() + 3 * pattern.dofs());
        let device = Device::new(&csr)?;
        let values = reserved(csr.entries())?;
        self.prepared = Some(Prepared {
            csr,
            device,
            values,
        });
        Ok(analysis)
    }

    /// None where pivots were replaced.
    fn factorize(&mut self, matrix: &SystemMatrix) -> Result<Option<Factorization>, LinearError> {
        let prepared = self.prepared.as_mut().ok_or(LinearError::NotAnalyzed)?;
        let Prepared {
            csr,
            device,
            values,
        } = prepared;
        csr.gather(matrix, values);
        let [negative_pivots, replaced] = device.factorize(values)?;
        if replaced > 0 {
            return Ok(None);
        }
        Ok(Some(Factorization {
            method: match self.symmetric {
                true => Method::Ldlt,
                false => Method::Lu,
            },
            negative_pivots,
            perturbed_pivots: 0,
            smallest_pivot_ratio: 1.0,
            smallest_pivot: None,
        }))
    }

    fn solve(&mut self, x: &mut [f64]) -> Result<(), LinearError> {
        let prepared = self.prepared.as_mut().ok_or(LinearError::NotFactorized)?;
        Ok(prepared.device.solve(x)?)
    }

    fn clear(&mut self) {
        self.prepared = None;
    }

    fn leaves_hard_cases(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::linear::{DeviceFault, DirectSolver, LinearSolver, LuSolver};
    use std::sync::Arc;

    /// A chain of springs between nodes, the first of which a spring of stiffness `ground` holds.
    fn chain(symmetric: bool, ground: f64) -> (Arc<Pattern>, SystemMatrix) {
        let n = 40;
        let groups: Vec<[u32; 2]> = (1..n).map(|i| [i - 1, i]).collect();
        let pattern = Pattern::new(n as usize, groups.iter().map(|g| &g[..])).expect("small");
        let pattern = Arc::new(pattern);
        let mut matrix = match symmetric {
            true => SystemMatrix::new(pattern.clone()),
            false => SystemMatrix::unsymmetric(pattern.clone()),
        };
        for group in &groups {
            let mut ke = [0.0; 36];
            for c in 0..3 {
                let k = 1.0 + c as f64;
                ke[7 * c] = k;
                ke[7 * (c + 3)] = k;
                let skew = if symmetric { 0.0 } else { 0.3 };
                ke[c + 6 * (c + 3)] = -k - skew;
                ke[c + 3 + 6 * c] = -k + skew;
            }
            let mut map = Vec::new();
            pattern.element_map(group, &mut map).expect("coupled");
            matrix.scatter(&map, &ke);
        }
        for dof in 0..3 {
            matrix.add_diagonal(dof, ground);
        }
        (pattern, matrix)
    }

    /// Where there is a device: solutions are those of the host, negative pivots are counted, and a matrix without a solution is named by
    /// the host. Where there is none: what is missing is said.
    #[test]
    fn answers_are_those_of_the_host() {
        for symmetric in [true, false] {
            let (pattern, matrix) = chain(symmetric, 1.0);
            let options = SolverOptions::default();
            let mut solver = ForeignSolver::cudss(symmetric, options);
            if let Err(error) = solver.analyze(&pattern) {
                println!("no device: {error}");
                let LinearError::Device(fault) = error else {
                    panic!("{error}");
                };
                assert!(
                    matches!(
                        fault,
                        DeviceFault::NoLibrary { .. } | DeviceFault::NoDevice { .. }
                    ),
                    "{error}"
                );
                assert!(matches!(
                    solver.factorize(&matrix),
                    Err(LinearError::NotAnalyzed)
                ));
                return;
            }
            let b: Vec<f64> = (0..pattern.dofs())
                .map(|i| 1.0 + (i as f64).sin())
                .collect();
            let mut host: Box<dyn LinearSolver> = match symmetric {
                true => Box::new(DirectSolver::new(options)),
                false => Box::new(LuSolver::new(options)),
            };
            host.analyze(&pattern).expect("analysed");
            for ground in [1.0, 2.0, -0.5] {
                let (_, mut other) = chain(symmetric, ground);
                let mut matrix = matrix.clone();
                matrix.values_mut().copy_from_slice(other.values());
                let found = solver.factorize(&matrix).expect("regular");
                let expected = host.factorize(&matrix).expect("regular");
                if symmetric {
                    assert_eq!(found.negative_pivots, expected.negative_pivots);
                    assert_eq!(found.negative_pivots, if ground < 0.0 { 3 } else { 0 });
                }
                let (mut x, mut y) = (b.clone(), b.clone());
                solver.solve_with(&matrix, &mut x).expect("solved");
                host.solve_with(&matrix, &mut y).expect("solved");
                let size = y.iter().fold(0.0f64, |m, y| m.max(y.abs()));
                for (x, y) in x.iter().zip(&y) {
                    assert!((x - y).abs() < 1e-12 * size && size > 1.0, "{x} {y}");
                }
                other.clear();
            }
            // Nothing holds it.
            let (_, free) = chain(symmetric, 0.0);
            let mut matrix = matrix.clone();
            matrix.values_mut().copy_from_slice(free.values());
            let solved = solver.factorize(&matrix).and_then(|_| {
                let mut x = b.clone();
                solver.solve_with(&matrix, &mut x)
            });
            println!("free: {solved:?}");
            if symmetric {
                assert!(solved.is_err());
            }
        }
    }
}
