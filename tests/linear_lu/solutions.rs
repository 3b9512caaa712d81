//! Solutions, counts and costs.
use crate::ALLOCATIONS;
use crate::matrices::*;
use covact::system::linear::{
    DirectSolver, Factorization, LinearError, LinearSolver, LuSolver, Method, OrderingChoice,
    SolverOptions,
};
use covact::system::{Pattern, SystemMatrix};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Largest difference relative to the largest entry of `b`.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = b.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    assert!(size > 0.0);
    let pairs = a.iter().zip(b);
    pairs.fold(0.0f64, |m, (x, y)| m.max((x - y).abs())) / size
}

/// Largest `|b - A x| / (|A| |x| + |b|)` of the rows.
fn backward_error(matrix: &SystemMatrix, x: &[f64], b: &[f64]) -> f64 {
    let (mut r, mut size) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    matrix.multiply(x, &mut r);
    matrix.abs_multiply(x, &mut size);
    let rows = r.iter().zip(&size).zip(b);
    rows.fold(0.0, |m, ((r, s), b)| m.max((r - b).abs() / (s + b.abs())))
}

fn factorized(matrix: &SystemMatrix, ordering: OrderingChoice) -> (LuSolver, Factorization) {
    let mut solver = LuSolver::new(SolverOptions {
        ordering,
        ..Default::default()
    });
    solver.analyze(matrix.pattern()).unwrap();
    let found = solver.factorize(matrix).unwrap();
    assert_eq!(found.method, Method::Lu);
    (solver, found)
}

fn solve(solver: &mut LuSolver, matrix: &SystemMatrix, rhs: &[f64]) -> Vec<f64> {
    let mut x = rhs.to_vec();
    solver.solve_with(matrix, &mut x).unwrap();
    x
}

/// Matrices of all kinds: backward error of a few round-offs after refinement, the determinant's sign of dense LU, and
/// faer's solution as far as the condition (known from the dense inverse) lets two solutions agree.
#[test]
fn as_dense_and_as_fully_pivoted() {
    let mut cases = Vec::new();
    for (seed, n) in [
        (1, [2, 2, 2]),
        (2, [5, 4, 2]),
        (3, [9, 3, 2]),
        (4, [4, 4, 4]),
    ] {
        cases.push((format!("random {n:?}"), random_matrix(n, seed)));
        cases.push((format!("convection {n:?}"), convection(n, 10.0, seed)));
        cases.push((format!("friction {n:?}"), friction(n, 0.3, 1e3, seed)));
        for same in [true, false] {
            let mut matrix = friction(n, 0.8, 10.0, seed);
            ill_scaled(&mut matrix, 16.0, same, seed);
            cases.push((format!("ill-scaled {n:?} {same}"), matrix));
        }
    }
    for (name, matrix) in cases {
        let n = matrix.pattern().dofs();
        let full = dense(&matrix);
        let rhs = Random(99).vector(n);
        let expected = oracle(&matrix, &rhs);
        assert!(backward_error(&matrix, &expected, &rhs) < 1e-14, "{name}");
        // Two solutions with backward errors w differ by at most w |A^-1| (|A| |x| + |b|) each (Oettli and Prager).
        let scale = DMatrix::from_diagonal(&full.diagonal().map(|d| 1.0 / d.abs().sqrt()));
        let scaled = &scale * &full * &scale;
        assert!((&scaled - scaled.transpose()).amax() > 1e-3, "{name}");
        let negative = scaled.determinant() < 0.0;
        let inverse = &scale * scaled.try_inverse().unwrap() * &scale;
        let size = full.abs() * DVector::from_column_slice(&expected).abs()
            + DVector::from_column_slice(&rhs).abs();
        let spread = inverse.abs() * size;
        for ordering in [OrderingChoice::Amd, OrderingChoice::Metis] {
            let (mut solver, found) = factorized(&matrix, ordering);
            assert_eq!(found.perturbed_pivots, 0, "{name}");
            assert_eq!(found.negative_pivots == 1, negative, "{name}");
            let x = solve(&mut solver, &matrix, &rhs);
            let error = backward_error(&matrix, &x, &rhs);
            assert!(error < 4.0 * f64::EPSILON, "{name}: {error:.1e}");
            for ((x, e), spread) in x.iter().zip(&expected).zip(spread.iter()) {
                assert!((x - e).abs() < 64.0 * f64::EPSILON * spread, "{name}");
            }
            // A plain solve is nearly as good, as pivots are exchanged within supernodes.
            let mut plain = rhs.clone();
            solver.solve_in_place(&mut plain).unwrap();
            let error = backward_error(&matrix, &plain, &rhs);
            assert!(error < 1e-9, "{name}: {error:.1e}");
        }
    }
}

/// Larger systems with wide supernodes, against a solution that is known.
#[test]
fn larger_systems() {
    for matrix in [
        convection([12, 11, 10], 3.0, 5),
        friction([40, 30, 2], 0.5, 1e4, 6),
    ] {
        let n = matrix.pattern().dofs();
        let expected = Random(3).vector(n);
        let mut rhs = vec![0.0; n];
        matrix.multiply(&expected, &mut rhs);
        let mut fills = Vec::new();
        for ordering in [OrderingChoice::Amd, OrderingChoice::Metis] {
            let (mut solver, found) = factorized(&matrix, ordering);
            assert_eq!(found.perturbed_pivots, 0);
            let analysis = solver.analysis().unwrap();
            assert!(analysis.stored as u64 >= analysis.fill && analysis.flops > 1e6);
            assert!(analysis.memory_bytes > 8 * analysis.stored);
            fills.push(analysis.fill);
            let x = solve(&mut solver, &matrix, &rhs);
            assert!(backward_error(&matrix, &x, &rhs) < 4.0 * f64::EPSILON);
            // Condition about 1e5, with the friction's penalty 1e4 about 1e9.
            assert!(difference(&x, &expected) < 1e-7);
        }
        assert_ne!(fills[0], fills[1]);
    }
}

/// A symmetric matrix, stored as one triangle or as two, has the solution of Cholesky.
#[test]
fn symmetric_matrices_too() {
    let (pattern, elements) = brick([6, 5, 4]);
    let mut random = Random(8);
    let mut both = assembled(&pattern, &elements, |ke| springs(ke, &mut random));
    (0..3).for_each(|d| ground(&mut both, d, 1.0));
    let mut one = SystemMatrix::new(Arc::clone(&pattern));
    one.values_mut().copy_from_slice(both.values());
    let rhs = random.vector(pattern.dofs());
    let mut cholesky = DirectSolver::default();
    cholesky.analyze(&pattern).unwrap();
    assert_eq!(cholesky.factorize(&both), Err(LinearError::Unsymmetric));
    cholesky.factorize(&one).unwrap();
    let mut expected = rhs.clone();
    cholesky.solve_in_place(&mut expected).unwrap();
    let mut solutions = Vec::new();
    for matrix in [&one, &both] {
        let (mut solver, found) = factorized(matrix, OrderingChoice::Best);
        assert_eq!(found.negative_pivots, 0);
        solutions.push(solve(&mut solver, matrix, &rhs));
        assert!(difference(&solutions[0], &expected) < 1e-11);
    }
    assert!(solutions[0] == solutions[1]);
}

/// All nodes coupled: the counts of a dense factorization.
#[test]
fn counts_of_a_full_matrix() {
    let nodes: Vec<u32> = (0..7).collect();
    let pattern = Arc::new(Pattern::new(7, [&nodes[..]].into_iter()).unwrap());
    let mut solver = LuSolver::default();
    let analysis = solver.analyze(&pattern).unwrap();
    assert_eq!((analysis.fill, analysis.stored), (21 * 21, 21 * 21));
    let flops: usize = (0..21).map(|r| r + r * r).sum();
    assert_eq!(analysis.flops, flops as f64);
}

#[test]
fn refactorization_allocates_nothing() {
    let matrix = friction([6, 6, 6], 0.5, 1e3, 3);
    // A pivot block that is singular alone, so that the solver has to replace a pivot and test the matrix.
    let perturbed = needs_other_supernode();
    let mut solvers = [LuSolver::default(), LuSolver::default()];
    let mut vectors = [&matrix, &perturbed].map(|m| Random(2).vector(m.pattern().dofs()));
    let before = ALLOCATIONS.get();
    solvers[0].analyze(matrix.pattern()).unwrap();
    solvers[1].analyze(perturbed.pattern()).unwrap();
    assert!(ALLOCATIONS.get() > before, "the counter does not count");
    for round in 0..4 {
        let before = ALLOCATIONS.get();
        for ((solver, matrix), x) in
            (solvers.iter_mut().zip([&matrix, &perturbed])).zip(&mut vectors)
        {
            solver.factorize(matrix).unwrap();
            solver.solve_with(matrix, x).unwrap();
            solver.solve_in_place(x).unwrap();
        }
        // The first round also sets up what the dense kernels keep for the process: packing buffer, CPU features.
        if round > 0 {
            assert_eq!(ALLOCATIONS.get() - before, 0, "round {round}");
        }
    }
}

#[test]
fn replaced_pivots_are_counted_and_refined_away() {
    let matrix = needs_other_supernode();
    let n = matrix.pattern().dofs();
    let expected = Random(1).vector(n);
    let mut rhs = vec![0.0; n];
    matrix.multiply(&expected, &mut rhs);
    let (mut solver, found) = factorized(&matrix, OrderingChoice::Amd);
    assert!(found.perturbed_pivots > 0 && found.perturbed_pivots < n);
    assert!(found.smallest_pivot_ratio < 1e-14 && found.smallest_pivot.is_some());
    let x = solve(&mut solver, &matrix, &rhs);
    assert!(backward_error(&matrix, &x, &rhs) < 1e-13);
    assert!(difference(&x, &expected) < 1e-9);
}

#[test]
fn extreme_graphs() {
    let pair: [&[u32]; 2] = [&[4, 7], &[1, 9]];
    let none: [&[u32]; 0] = [];
    for pattern in [
        Pattern::new(0, none.into_iter()),
        Pattern::new(1, none.into_iter()),
        Pattern::new(5, none.into_iter()),
        Pattern::new(12, pair.into_iter()),
    ] {
        let pattern = Arc::new(pattern.unwrap());
        let n = pattern.dofs();
        let mut matrix = SystemMatrix::unsymmetric(Arc::clone(&pattern));
        (0..n).for_each(|d| matrix.set_identity(d, 2.0 + d as f64));
        if let Some(block) = pattern.block(4, 7) {
            matrix.values_mut()[9 * block as usize + 5] = 1.5;
        }
        let (mut solver, found) = factorized(&matrix, OrderingChoice::Best);
        assert_eq!(found.smallest_pivot.is_none(), n == 0);
        let expected: Vec<f64> = (0..n).map(|d| 1.0 + d as f64).collect();
        let mut x = vec![0.0; n];
        matrix.multiply(&expected, &mut x);
        solver.solve_with(&matrix, &mut x).unwrap();
        for (x, e) in x.iter().zip(&expected) {
            assert!((x - e).abs() < 1e-13 * e.abs());
        }
    }
}

/// The dense kernels split their work by parts of the result, so that a second thread changes no sum.
#[test]
fn threads_change_nothing() {
    let matrix = convection([12, 12, 12], 2.0, 4);
    let rhs = Random(3).vector(matrix.pattern().dofs());
    let mut solutions = Vec::new();
    for threads in [1, 2, 2, 4] {
        let mut solver = LuSolver::new(SolverOptions {
            threads,
            parallel_min_flops: 0.0,
            ..Default::default()
        });
        assert_eq!(solver.analyze(matrix.pattern()).unwrap().threads, threads);
        solver.factorize(&matrix).unwrap();
        solutions.push(solve(&mut solver, &matrix, &rhs));
    }
    for other in &solutions[1..] {
        assert!(solutions[0] == *other);
    }
}

#[test]
fn right_hand_sides_one_after_the_other() {
    let matrix = random_matrix([4, 3, 3], 21);
    let (mut solver, _) = factorized(&matrix, OrderingChoice::Best);
    let lu = dense(&matrix).lu();
    for seed in 0..3 {
        let rhs = Random(seed).vector(108);
        let expected = lu.solve(&DVector::from_column_slice(&rhs)).unwrap();
        let x = solve(&mut solver, &matrix, &rhs);
        assert!(difference(&x, expected.as_slice()) < 1e-9);
    }
}

/// A part that has come to rest has residuals that are squared with every iteration, until they underflow: what is left of their
/// digits says nothing of the solution, in the other part nor in this one.
#[test]
fn a_part_at_rest_leaves_the_other_one_accurate() {
    let elements: [[u32; 8]; 2] =
        std::array::from_fn(|e| std::array::from_fn(|a| (8 * e + a) as u32));
    let pattern = Pattern::new(16, elements.iter().map(|e| &e[..])).unwrap();
    let mut random = Random(11);
    let matrix = assembled(&Arc::new(pattern), &elements, |ke| {
        for (i, k) in ke.iter_mut().enumerate() {
            *k = random.next() + if i % 25 == 0 { 12.0 } else { 0.0 };
        }
    });
    let (mut solver, _) = factorized(&matrix, OrderingChoice::Amd);
    for small in [1e-290, 1e-318, 1e-322] {
        let mut rhs = random.vector(48);
        rhs[24..].iter_mut().for_each(|b| *b *= small);
        let mut x = rhs.clone();
        solver.solve_with(&matrix, &mut x).unwrap();
        let error = backward_error(&matrix, &x, &rhs);
        assert!(x[..24].iter().any(|x| x.abs() > 1e-3) && x[24..].iter().all(|x| x.abs() < 1e-280));
        assert!(small > 1e-300 || error > 1e-8, "{small}: {error:e}");
        let mut residual = vec![0.0; 48];
        matrix.multiply(&x, &mut residual);
        let largest = (residual.iter().zip(&rhs)).fold(0.0f64, |m, (r, b)| m.max((r - b).abs()));
        assert!(largest < 1e-15, "{small}: {largest:e}");
    }
}
