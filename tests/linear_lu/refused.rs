//! Matrices and calls that are errors.
use crate::matrices::*;
use covact::system::SystemMatrix;
use covact::system::linear::{DofName, LinearError, LinearSolver, LuSolver};
use std::sync::Arc;

/// Sets the row, the column or both of a dof to zero.
fn loosen(matrix: &mut SystemMatrix, dof: u32, row: bool, column: bool) {
    let pattern = Arc::clone(matrix.pattern());
    let mut at = 0;
    for c in 0..pattern.nodes() as u32 {
        for &r in pattern.column(c as usize) {
            for i in 0..9 {
                let (i, j) = (3 * r + i % 3, 3 * c + i / 3);
                if (row && i == dof) || (column && j == dof) {
                    matrix.values_mut()[at] = 0.0;
                }
                if (row && j == dof) || (column && i == dof) {
                    matrix.transposed_values_mut().unwrap()[at] = 0.0;
                }
                at += 1;
            }
        }
    }
}

/// A direction without stiffness is named, wherever the ordering puts it; one that depends on the others is at least
/// found.
#[test]
fn singular_matrices_are_refused() {
    for node in [0u32, 17, 42, 63] {
        for component in 0..3u8 {
            let dof = DofName { node, component };
            for (row, column) in [(true, true), (true, false), (false, true)] {
                let mut matrix = friction([4, 4, 4], 0.4, 100.0, 7);
                loosen(&mut matrix, dof.dof() as u32, row, column);
                let mut solver = LuSolver::default();
                solver.analyze(matrix.pattern()).unwrap();
                let found = solver.factorize(&matrix);
                assert_eq!(found, Err(LinearError::ZeroRow { dof }));
                let mut x = vec![1.0; 192];
                assert_eq!(
                    solver.solve_in_place(&mut x),
                    Err(LinearError::NotFactorized)
                );
            }
        }
    }
}

/// A body that floats: its last pivots are round-off. Its load has a solution only if it is in equilibrium.
#[test]
fn floating_bodies_are_refused() {
    let (pattern, elements) = brick([4, 4, 4]);
    for seed in 0..20 {
        let mut random = Random(seed);
        let matrix = assembled(&pattern, &elements, |ke| springs(ke, &mut random));
        let mut solver = LuSolver::default();
        solver.analyze(&pattern).unwrap();
        let error = solver.factorize(&matrix);
        assert!(
            matches!(error, Err(LinearError::TinyPivot { ratio, .. }) if ratio < 1e-13),
            "{seed}: {error:?}"
        );
    }
}

/// Two rows that are multiples of each other: no row and no column is zero.
#[test]
fn dependent_rows_are_refused() {
    let (pattern, elements) = brick([3, 3, 3]);
    let mut random = Random(4);
    let mut matrix = assembled(&pattern, &elements, |ke| {
        ke.iter_mut().for_each(|k| *k = random.next());
    });
    // The middle node couples with all; its second row becomes twice its first one.
    let node = 13u32;
    let mut at = 0;
    for c in 0..27u32 {
        for &r in pattern.column(c as usize) {
            for k in 0..3 {
                if r == node {
                    let v = matrix.values()[at + 3 * k];
                    matrix.values_mut()[at + 3 * k + 1] = 2.0 * v;
                } else if c == node {
                    let upper = matrix.transposed_values_mut().unwrap();
                    upper[at + 3 + k] = 2.0 * upper[at + k];
                }
            }
            at += 9;
        }
    }
    let full = dense(&matrix);
    assert!((full.row(40) - full.row(39) * 2.0).amax() == 0.0);
    let mut solver = LuSolver::default();
    solver.analyze(&pattern).unwrap();
    assert!(matches!(
        solver.factorize(&matrix),
        Err(LinearError::TinyPivot { .. })
    ));
}

#[test]
fn misuse_is_an_error() {
    let matrix = random_matrix([3, 3, 2], 1);
    let mut solver = LuSolver::default();
    let mut x = vec![1.0; 54];
    assert_eq!(solver.factorize(&matrix), Err(LinearError::NotAnalyzed));
    assert_eq!(
        solver.solve_with(&matrix, &mut x),
        Err(LinearError::NotAnalyzed)
    );
    solver.analyze(matrix.pattern()).unwrap();
    assert_eq!(
        solver.solve_with(&matrix, &mut x),
        Err(LinearError::NotFactorized)
    );
    let other = random_matrix([2, 2, 2], 1);
    assert_eq!(solver.factorize(&other), Err(LinearError::PatternMismatch));
    solver.factorize(&matrix).unwrap();
    assert_eq!(
        solver.solve_with(&other, &mut x),
        Err(LinearError::PatternMismatch)
    );
    let length = LinearError::Length {
        given: 53,
        expected: 54,
    };
    assert_eq!(solver.solve_in_place(&mut x[..53]), Err(length));
    x[5] = f64::NAN;
    let dof = DofName {
        node: 1,
        component: 2,
    };
    let error = LinearError::NonFiniteRightHandSide { dof };
    assert_eq!(solver.solve_with(&matrix, &mut x), Err(error));
    let mut broken = matrix.clone();
    let block = broken.pattern().block(4, 3).unwrap();
    broken.transposed_values_mut().unwrap()[9 * block as usize + 4] = f64::NAN;
    let error = LinearError::NonFiniteMatrix { row: 4, column: 3 };
    assert_eq!(solver.factorize(&broken), Err(error));
    assert_eq!(
        solver.solve_in_place(&mut x),
        Err(LinearError::NotFactorized)
    );
}
