//! The LU of unsymmetric systems against dense solutions and faer's own sparse LU, and its errors.
use covact::assembly::{Pattern, SystemMatrix};
use covact::solve::linear::{
    DirectSolver, DofName, Factorization, LinearError, LinearSolver, LuSolver, Method,
    OrderingChoice, SolverOptions,
};
use faer::prelude::Solve;
use faer::sparse::{SparseColMat, Triplet};
use nalgebra::{DMatrix, DVector};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

/// Counts the allocations of each thread.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system allocator unchanged; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = ALLOCATIONS.try_with(|a| a.set(a.get() + 1));
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A small generator of repeatable numbers in [-0.5, 0.5) (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 2f64.powi(64) - 0.5
    }

    fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}

/// Elements of a brick of `n` nodes: eight corners of every cell.
fn cells(n: [u32; 3]) -> Vec<[u32; 8]> {
    let node = |i, j, k| i + n[0] * (j + n[1] * k);
    let mut out = Vec::new();
    for k in 1..n[2] {
        for j in 1..n[1] {
            for i in 1..n[0] {
                out.push(std::array::from_fn(|c| {
                    let c = c as u32;
                    node(i - 1 + (c & 1), j - 1 + (c >> 1 & 1), k - 1 + (c >> 2))
                }));
            }
        }
    }
    out
}

fn brick(n: [u32; 3]) -> (Arc<Pattern>, Vec<[u32; 8]>) {
    let elements = cells(n);
    let nodes = (n[0] * n[1] * n[2]) as usize;
    let pattern = Pattern::new(nodes, elements.iter().map(|e| &e[..])).unwrap();
    (Arc::new(pattern), elements)
}

/// Adds the 24 x 24 matrices that `make` writes (column-major) to an unsymmetric matrix.
fn assembled(
    pattern: &Arc<Pattern>,
    elements: &[[u32; 8]],
    mut make: impl FnMut(&mut [f64]),
) -> SystemMatrix {
    let mut matrix = SystemMatrix::unsymmetric(Arc::clone(pattern));
    let mut map = Vec::new();
    let mut ke = [0.0; 576];
    for element in elements {
        ke.fill(0.0);
        make(&mut ke);
        map.clear();
        pattern.element_map(element, &mut map).unwrap();
        matrix.scatter(&map, &ke);
    }
    matrix
}

/// Springs with random positive definite stiffness between all corners of a cell.
fn springs(ke: &mut [f64], random: &mut Random) {
    for p in 0..8 {
        for q in 0..p {
            let v = [random.next(), random.next(), random.next()];
            for a in 0..3 {
                for b in 0..3 {
                    let w = v[a] * v[b] + if a == b { 0.2 } else { 0.0 };
                    ke[24 * (3 * p + a) + 3 * p + b] += w;
                    ke[24 * (3 * q + a) + 3 * q + b] += w;
                    ke[24 * (3 * p + a) + 3 * q + b] -= w;
                    ke[24 * (3 * q + a) + 3 * p + b] -= w;
                }
            }
        }
    }
}

fn ground(matrix: &mut SystemMatrix, dof: usize, value: f64) {
    let old = matrix.get(dof, dof);
    matrix.set_identity(dof, old + value);
}

/// Entries without any order, the diagonal no larger than the rest.
fn random_matrix(n: [u32; 3], seed: u64) -> SystemMatrix {
    let (pattern, elements) = brick(n);
    let mut random = Random(seed);
    assembled(&pattern, &elements, |ke| {
        ke.iter_mut().for_each(|k| *k = random.next());
    })
}

/// Diffusion with a convection that outweighs it: an antisymmetric part of `peclet` times the symmetric one.
fn convection(n: [u32; 3], peclet: f64, seed: u64) -> SystemMatrix {
    let (pattern, elements) = brick(n);
    let mut random = Random(seed);
    let mut matrix = assembled(&pattern, &elements, |ke| {
        springs(ke, &mut random);
        for i in 0..24 {
            for j in 0..i {
                let w = peclet * 0.2 * random.next();
                ke[24 * j + i] += w;
                ke[24 * i + j] -= w;
            }
        }
    });
    (0..3).for_each(|d| ground(&mut matrix, d, 1.0));
    matrix
}

/// A lattice whose bottom nodes slide on a plane under Coulomb friction: a normal penalty, and tangential forces of
/// `mu` times the normal force, which depend on the normal displacement alone.
fn friction(n: [u32; 3], mu: f64, penalty: f64, seed: u64) -> SystemMatrix {
    let (pattern, elements) = brick(n);
    let mut random = Random(seed);
    let mut matrix = assembled(&pattern, &elements, |ke| springs(ke, &mut random));
    for node in 0..(n[0] * n[1]) as usize {
        ground(&mut matrix, 3 * node + 2, penalty);
        let first = 9 * matrix.pattern().column_starts()[node] as usize;
        let direction = [random.next(), random.next()];
        for (c, d) in direction.iter().enumerate() {
            matrix.values_mut()[first + 6 + c] += mu * penalty * d;
        }
    }
    (0..3).for_each(|d| ground(&mut matrix, 3 * 7 + d, 1.0));
    matrix
}

/// Rows and columns multiplied by factors over `decades` powers of ten.
fn ill_scaled(matrix: &mut SystemMatrix, decades: f64, same: bool, seed: u64) {
    let pattern = Arc::clone(matrix.pattern());
    let n = pattern.dofs();
    let mut random = Random(seed);
    let rows: Vec<f64> = (0..n)
        .map(|_| 10f64.powf(decades * random.next()))
        .collect();
    let columns: Vec<f64> = (0..n)
        .map(|d| {
            if same {
                rows[d]
            } else {
                10f64.powf(decades * random.next())
            }
        })
        .collect();
    let mut at = 0;
    for column in 0..pattern.nodes() {
        for &row in pattern.column(column) {
            for b in 0..3 {
                for a in 0..3 {
                    let (i, j) = (3 * row as usize + a, 3 * column + b);
                    matrix.values_mut()[at + 3 * b + a] *= rows[i] * columns[j];
                    let upper = matrix.transposed_values_mut().unwrap();
                    upper[at + 3 * b + a] *= rows[j] * columns[i];
                }
            }
            at += 9;
        }
    }
}

fn dense(matrix: &SystemMatrix) -> DMatrix<f64> {
    let n = matrix.pattern().dofs();
    DMatrix::from_fn(n, n, |i, j| matrix.get(i, j))
}

/// The solution of faer's sparse LU with full pivoting of rows, refined.
fn oracle(matrix: &SystemMatrix, rhs: &[f64]) -> Vec<f64> {
    let n = matrix.pattern().dofs();
    let mut triplets = Vec::new();
    for column in 0..matrix.pattern().nodes() as u32 {
        for &row in matrix.pattern().column(column as usize) {
            for i in 0..9 {
                let (r, c) = (3 * row + i % 3, 3 * column + i / 3);
                let entry = |r: u32, c: u32| Triplet::new(r, c, matrix.get(r as usize, c as usize));
                triplets.push(entry(r, c));
                if row != column {
                    triplets.push(entry(c, r));
                }
            }
        }
    }
    let sparse = SparseColMat::<u32, f64>::try_new_from_triplets(n, n, &triplets).unwrap();
    let lu = sparse.sp_lu().unwrap();
    let solve = |b: &[f64]| -> Vec<f64> {
        let x = lu.solve(faer::Col::from_fn(n, |i| b[i]));
        (0..n).map(|i| x[i]).collect()
    };
    let mut x = solve(rhs);
    // Its pivots are not scaled.
    for _ in 0..5 {
        let mut r = vec![0.0; n];
        matrix.multiply(&x, &mut r);
        r.iter_mut().zip(rhs).for_each(|(r, b)| *r = b - *r);
        for (x, c) in x.iter_mut().zip(solve(&r)) {
            *x += c;
        }
    }
    x
}

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

/// Twelve hubs that are all coupled and a leaf at each of them whose own block is zero: leaves are eliminated first, and
/// no exchange within a leaf's block helps, although the matrix is regular.
fn needs_other_supernode() -> SystemMatrix {
    let mut groups: Vec<Vec<u32>> = (0..12).map(|hub| vec![hub, 12 + hub]).collect();
    groups.push((0..12).collect());
    let pattern = Arc::new(Pattern::new(24, groups.iter().map(Vec::as_slice)).unwrap());
    let mut matrix = SystemMatrix::unsymmetric(Arc::clone(&pattern));
    let mut random = Random(12);
    let mut map = Vec::new();
    for group in &groups {
        let size = 3 * group.len();
        let mut ke = random.vector(size * size);
        for i in 0..size {
            // The coupling of a leaf with its hub is far from singular.
            ke[size * i + (i + size / 2) % size] += 2.0;
        }
        map.clear();
        pattern.element_map(group, &mut map).unwrap();
        matrix.scatter(&map, &ke);
    }
    for leaf in 12..24 {
        let block = 9 * pattern.block(leaf, leaf).unwrap() as usize;
        matrix.values_mut()[block..block + 9].fill(0.0);
    }
    matrix
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
