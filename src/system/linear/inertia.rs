//! The inertia of an unsymmetric system whose values are symmetric all the same.
use super::{DirectSolver, LinearSolver, Mode, SolverOptions};
use crate::system::SystemMatrix;

/// Part of the largest value by which values on both sides of the diagonal may differ.
const ALIKE: f64 = 1e-10;

/// Number of negative pivots of a matrix that is held as an unsymmetric one, which a factorization by LU does not tell: of its LDL^T
/// factorization, made for this alone. Nothing where its values are not symmetric, or do not let themselves be factorized so.
pub fn negative_pivots(matrix: &SystemMatrix) -> Option<usize> {
    let lower = symmetric(matrix)?;
    let mut solver = DirectSolver::new(SolverOptions {
        mode: Mode::Ldlt,
        ..SolverOptions::default()
    });
    solver.analyze(matrix.pattern()).ok()?;
    Some(solver.factorize(&lower).ok()?.negative_pivots)
}

/// The matrix without the half that says nothing new.
fn symmetric(matrix: &SystemMatrix) -> Option<SystemMatrix> {
    let (below, above) = (matrix.values(), matrix.transposed_values()?);
    let largest = below.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    let alike = |a: f64, b: f64| (a - b).abs() <= ALIKE * largest;
    let diagonal = |block: &[f64]| {
        let pairs = [(1, 3), (2, 6), (5, 7)];
        pairs.iter().all(|(i, j)| alike(block[*i], block[*j]))
    };
    for column in matrix.pattern().column_starts().windows(2) {
        let (first, last) = (9 * column[0] as usize, 9 * column[1] as usize);
        let beside = below[first + 9..last].iter().zip(&above[first + 9..last]);
        if !diagonal(&below[first..first + 9]) || !beside.into_iter().all(|(b, a)| alike(*b, *a)) {
            return None;
        }
    }
    let mut lower = SystemMatrix::new(matrix.pattern().clone());
    lower.values_mut().copy_from_slice(below);
    Some(lower)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::Pattern;
    use std::sync::Arc;

    /// Two nodes, held by springs of which two pull; the same with an entry on one side alone.
    #[test]
    fn negative_pivots_are_counted_where_values_are_symmetric() {
        let group: &[u32] = &[0, 1];
        let pattern = Pattern::new(2, [group].into_iter()).expect("a pattern");
        let mut matrix = SystemMatrix::unsymmetric(Arc::new(pattern));
        let mut map = Vec::new();
        matrix
            .pattern()
            .element_map(&[0, 1], &mut map)
            .expect("a map");
        let mut ke = [0.0; 36];
        for (dof, spring) in [3.0, -2.0, 4.0, 5.0, 6.0, -7.0].into_iter().enumerate() {
            ke[7 * dof] = spring;
        }
        (ke[5], ke[30]) = (0.5, 0.5);
        matrix.scatter(&map, &ke);
        assert_eq!(negative_pivots(&matrix), Some(2));
        for entry in [4, 1] {
            let mut other = matrix.clone();
            let mut aside = [0.0; 36];
            aside[entry] = 0.1;
            other.scatter(&map, &aside);
            assert_eq!(negative_pivots(&other), None);
        }
    }
}
