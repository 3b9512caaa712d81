//! The direct solver against dense solutions, and its errors.
use covact::system::linear::{
    DirectSolver, DofName, LinearError, LinearSolver, Method, Mode, Ordering, OrderingChoice,
    SolverOptions,
};
use covact::system::{Pattern, SystemMatrix};
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

/// A small generator of repeatable numbers in [0, 1) (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 2f64.powi(64)
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

fn pattern(nodes: usize, elements: &[[u32; 8]]) -> Arc<Pattern> {
    Arc::new(Pattern::new(nodes, elements.iter().map(|e| &e[..])).unwrap())
}

/// Springs with random symmetric positive definite 3 x 3 stiffness between all corners of each cell: positive
/// semi-definite, with the three translations of each connected part as its null space.
fn lattice(pattern: &Arc<Pattern>, elements: &[[u32; 8]], random: &mut Random) -> SystemMatrix {
    let mut matrix = SystemMatrix::new(Arc::clone(pattern));
    let mut map = Vec::new();
    let mut ke = [0.0; 576];
    for element in elements {
        ke.fill(0.0);
        for p in 0..8 {
            for q in 0..p {
                let v: [f64; 3] = std::array::from_fn(|_| random.next() - 0.5);
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
        map.clear();
        pattern.element_map(element, &mut map).unwrap();
        matrix.scatter(&map, &ke);
    }
    matrix
}

fn add_diagonal(matrix: &mut SystemMatrix, dof: usize, value: f64) {
    let old = matrix.get(dof, dof);
    matrix.set_identity(dof, old + value);
}

fn dense(matrix: &SystemMatrix) -> DMatrix<f64> {
    let n = matrix.pattern().dofs();
    DMatrix::from_fn(n, n, |i, j| matrix.get(i, j))
}

fn options(mode: Mode, ordering: OrderingChoice) -> SolverOptions {
    SolverOptions {
        mode,
        ordering,
        ..Default::default()
    }
}

fn vector(n: usize, random: &mut Random) -> Vec<f64> {
    (0..n).map(|_| random.next() - 0.5).collect()
}

/// Largest difference relative to the largest entry of `b`.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = b.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    assert!(size > 0.0);
    let diff = a
        .iter()
        .zip(b)
        .fold(0.0f64, |m, (x, y)| m.max((x - y).abs()));
    diff / size
}

/// A brick with one node on springs of stiffness one, so that it is positive definite.
fn grounded(n: [u32; 3], seed: u64) -> SystemMatrix {
    let elements = cells(n);
    let nodes = (n[0] * n[1] * n[2]) as usize;
    let mut matrix = lattice(&pattern(nodes, &elements), &elements, &mut Random(seed));
    for dof in 0..3 {
        add_diagonal(&mut matrix, dof, 1.0);
    }
    matrix
}

#[test]
fn positive_definite_as_dense() {
    for (seed, n) in [
        (1, [2, 2, 2]),
        (2, [5, 4, 2]),
        (3, [9, 3, 2]),
        (4, [4, 4, 4]),
    ] {
        let matrix = grounded(n, seed);
        let rhs = vector(matrix.pattern().dofs(), &mut Random(seed + 9));
        let expected = dense(&matrix)
            .cholesky()
            .unwrap()
            .solve(&DVector::from_column_slice(&rhs));
        for mode in [Mode::Llt, Mode::Ldlt, Mode::Auto] {
            for ordering in [OrderingChoice::Amd, OrderingChoice::Metis] {
                let mut solver = DirectSolver::new(options(mode, ordering));
                solver.analyze(matrix.pattern()).unwrap();
                let found = solver.factorize(&matrix).unwrap();
                assert_eq!(found.negative_pivots, 0);
                assert_eq!(found.method == Method::Ldlt, mode == Mode::Ldlt);
                let mut x = rhs.clone();
                solver.solve_in_place(&mut x).unwrap();
                // Condition about 1e3: twelve digits and a margin.
                assert!(difference(&x, expected.as_slice()) < 1e-11);
            }
        }
    }
}

/// A shifted lattice has as many negative pivots as eigenvalues below the shift (Sylvester's law of inertia).
#[test]
fn indefinite_with_inertia() {
    for shift in [1.0, 2.0, 3.0] {
        let mut matrix = grounded([5, 4, 2], 5);
        let n = matrix.pattern().dofs();
        for dof in 0..n {
            add_diagonal(&mut matrix, dof, -shift);
        }
        let full = dense(&matrix);
        let negative = full
            .clone()
            .symmetric_eigenvalues()
            .iter()
            .filter(|e| **e < 0.0)
            .count();
        assert!(negative > 3 && negative < n - 3, "{negative} of {n}");
        let rhs = vector(n, &mut Random(8));
        let expected = full.lu().solve(&DVector::from_column_slice(&rhs)).unwrap();
        let mut solver = DirectSolver::new(options(Mode::Auto, OrderingChoice::Best));
        solver.analyze(matrix.pattern()).unwrap();
        let found = solver.factorize(&matrix).unwrap();
        assert_eq!(
            (found.method, found.negative_pivots),
            (Method::Ldlt, negative)
        );
        let (mut x, mut r, mut c) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        solver
            .solve_refined(&matrix, &rhs, &mut x, &mut r, &mut c)
            .unwrap();
        assert!(difference(&x, expected.as_slice()) < 1e-10);
        // Refinement leaves a residual of round-off size, |A| |x| times a few eps.
        matrix.multiply(&x, &mut r);
        matrix.abs_multiply(&x, &mut c);
        for ((r, b), c) in r.iter().zip(&rhs).zip(&c) {
            assert!((r - b).abs() < 8.0 * f64::EPSILON * (c + b.abs()));
        }

        let mut strict = DirectSolver::new(options(Mode::Llt, OrderingChoice::Best));
        strict.analyze(matrix.pattern()).unwrap();
        let error = strict.factorize(&matrix).unwrap_err();
        assert!(matches!(error, LinearError::NonPositivePivot { .. }));
        assert_eq!(
            strict.solve_in_place(&mut x),
            Err(LinearError::NotFactorized)
        );
    }
}

#[test]
fn auto_returns_to_llt() {
    let stable = grounded([3, 3, 3], 6);
    let mut unstable = stable.clone();
    add_diagonal(&mut unstable, 40, -50.0);
    let mut solver = DirectSolver::default();
    solver.analyze(stable.pattern()).unwrap();
    let modes: Vec<_> = [&stable, &unstable, &unstable, &stable, &stable]
        .into_iter()
        .map(|m| {
            let f = solver.factorize(m).unwrap();
            (f.method, f.negative_pivots)
        })
        .collect();
    use Method::{Ldlt, Llt};
    assert_eq!(modes, [(Llt, 0), (Ldlt, 1), (Ldlt, 1), (Ldlt, 0), (Llt, 0)]);
}

/// Sets the row and the column of a dof to zero.
fn loosen(matrix: &mut SystemMatrix, dof: u32) {
    let pattern = Arc::clone(matrix.pattern());
    let (starts, rows) = (pattern.column_starts(), pattern.rows());
    for column in 0..pattern.nodes() as u32 {
        for b in starts[column as usize]..starts[column as usize + 1] {
            for i in 0..9u32 {
                let row = 3 * rows[b as usize] + i % 3;
                if row == dof || 3 * column + i / 3 == dof {
                    matrix.values_mut()[(9 * b + i) as usize] = 0.0;
                }
            }
        }
    }
}

/// A direction without stiffness is named, wherever the ordering puts it.
#[test]
fn singular_names_the_dof() {
    for node in [0u32, 17, 42, 63] {
        for component in 0..3u8 {
            let dof = DofName { node, component };
            let mut matrix = grounded([4, 4, 4], 7);
            loosen(&mut matrix, dof.dof() as u32);
            for (mode, expected) in [
                (Mode::Llt, LinearError::NonPositivePivot { dof }),
                (Mode::Ldlt, LinearError::ZeroPivot { dof }),
                (Mode::Auto, LinearError::ZeroPivot { dof }),
            ] {
                for ordering in [OrderingChoice::Amd, OrderingChoice::Metis] {
                    let mut solver = DirectSolver::new(options(mode, ordering));
                    solver.analyze(matrix.pattern()).unwrap();
                    assert_eq!(solver.factorize(&matrix), Err(expected), "{mode:?}");
                }
            }
        }
    }
}

/// A body that floats: its last pivots are round-off, of either sign.
#[test]
fn floating_body_is_refused() {
    let elements = cells([4, 4, 4]);
    for seed in 0..20 {
        let matrix = lattice(&pattern(64, &elements), &elements, &mut Random(seed));
        for mode in [Mode::Llt, Mode::Ldlt, Mode::Auto] {
            let mut solver = DirectSolver::new(options(mode, OrderingChoice::Amd));
            solver.analyze(matrix.pattern()).unwrap();
            let dof = match solver.factorize(&matrix).unwrap_err() {
                LinearError::TinyPivot { dof, .. }
                | LinearError::NonPositivePivot { dof }
                | LinearError::ZeroPivot { dof } => dof,
                other => panic!("{other}"),
            };
            // Only the node that is eliminated last can be left without support.
            assert_eq!(Some(&dof.node), solver.node_order().unwrap().last());
        }
    }
}

/// Two nodes on a spring, one of them on a weak ground: the second pivot is that ground, up to round-off of the spring.
#[test]
fn nearly_singular_is_measured() {
    let pattern = Arc::new(Pattern::new(2, [&[0u32, 1][..]].into_iter()).unwrap());
    for (ground, accepted) in [(1e-6, true), (1e-12, true), (3e-15, false), (1e-18, false)] {
        let mut matrix = SystemMatrix::new(Arc::clone(&pattern));
        for c in 0..3 {
            matrix.set_identity(c, 1.0);
            matrix.set_identity(3 + c, 1.0 + ground);
            matrix.values_mut()[9 + 4 * c] = -1.0;
        }
        for mode in [Mode::Llt, Mode::Ldlt] {
            let mut solver = DirectSolver::new(options(mode, OrderingChoice::Best));
            solver.analyze(&pattern).unwrap();
            match solver.factorize(&matrix) {
                Ok(f) => {
                    assert!(accepted);
                    assert!((f.smallest_pivot_ratio / ground - 1.0).abs() < 1e-3);
                }
                Err(LinearError::TinyPivot { ratio, .. }) => assert!(!accepted && ratio < 1e-14),
                Err(LinearError::ZeroPivot { .. } | LinearError::NonPositivePivot { .. }) => {
                    assert!(ground < 1e-16);
                }
                Err(other) => panic!("{other}"),
            }
        }
    }
}

#[test]
fn orderings_are_permutations_and_agree() {
    let matrix = grounded([11, 11, 11], 11);
    let n = matrix.pattern().dofs();
    let rhs = vector(n, &mut Random(1));
    let mut solutions = Vec::new();
    let mut flops = Vec::new();
    for ordering in [
        OrderingChoice::Amd,
        OrderingChoice::Metis,
        OrderingChoice::Best,
    ] {
        let mut solver = DirectSolver::new(options(Mode::Auto, ordering));
        let analysis = *solver.analyze(matrix.pattern()).unwrap();
        let mut order = solver.node_order().unwrap().to_vec();
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(i, o)| i == *o as usize));
        assert!(analysis.stored as u64 >= analysis.fill && analysis.metis_failed.is_none());
        flops.push(analysis.flops);
        if ordering == OrderingChoice::Best {
            assert_eq!(analysis.flops_amd, Some(flops[0]));
            assert_eq!(analysis.flops_metis, Some(flops[1]));
            assert_eq!(analysis.flops, flops[0].min(flops[1]));
            let metis = analysis.ordering == Ordering::Metis;
            assert_eq!(metis, flops[1] < flops[0]);
        }
        solver.factorize(&matrix).unwrap();
        let mut x = rhs.clone();
        solver.solve_in_place(&mut x).unwrap();
        solutions.push(x);
    }
    assert!(flops[0] != flops[1]);
    assert!(difference(&solutions[0], &solutions[1]) < 1e-11);
    // A second analysis finds the same order: the random numbers of METIS are seeded.
    let mut again = DirectSolver::new(options(Mode::Auto, OrderingChoice::Metis));
    let flops_again = again.analyze(matrix.pattern()).unwrap().flops;
    assert_eq!(flops_again.to_bits(), flops[1].to_bits());
}

/// All nodes coupled: the counts of a dense factorization.
#[test]
fn counts_of_a_full_matrix() {
    let nodes: Vec<u32> = (0..7).collect();
    let pattern = Arc::new(Pattern::new(7, [&nodes[..]].into_iter()).unwrap());
    let mut solver = DirectSolver::default();
    let analysis = solver.analyze(&pattern).unwrap();
    assert_eq!(analysis.fill, 21 * 22 / 2);
    let flops: usize = (1..=21).map(|r| r + r * (r + 1) / 2).sum();
    assert_eq!(analysis.flops, flops as f64);
}

#[test]
fn refactorization_allocates_nothing() {
    let mut stable = grounded([6, 6, 6], 3);
    let mut unstable = stable.clone();
    add_diagonal(&mut unstable, 100, -80.0);
    let n = stable.pattern().dofs();
    let (mut x, mut r, mut c) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let rhs = vector(n, &mut Random(2));
    let mut solver = DirectSolver::default();
    let before = ALLOCATIONS.get();
    solver.analyze(stable.pattern()).unwrap();
    assert!(ALLOCATIONS.get() > before, "the counter does not count");
    for round in 0..4 {
        let before = ALLOCATIONS.get();
        for matrix in [&stable, &unstable] {
            solver.factorize(matrix).unwrap();
            solver
                .solve_refined(matrix, &rhs, &mut x, &mut r, &mut c)
                .unwrap();
            matrix.abs_row_sums(&mut c);
        }
        // The first round also sets up what the dense kernels keep for the process: packing buffer, CPU features.
        if round > 0 {
            assert_eq!(ALLOCATIONS.get() - before, 0, "round {round}");
        }
        add_diagonal(&mut stable, 7, 0.5);
    }
}

#[test]
fn misuse_is_an_error() {
    let matrix = grounded([3, 3, 2], 1);
    let mut solver = DirectSolver::default();
    let mut x = vec![1.0; 54];
    assert_eq!(solver.factorize(&matrix), Err(LinearError::NotAnalyzed));
    assert_eq!(solver.solve_in_place(&mut x), Err(LinearError::NotAnalyzed));
    solver.analyze(matrix.pattern()).unwrap();
    assert_eq!(
        solver.solve_in_place(&mut x),
        Err(LinearError::NotFactorized)
    );
    // The same number of blocks, another structure.
    let lists: [&[u32]; 2] = [&[0, 1], &[2, 3]];
    let other: [&[u32]; 2] = [&[0, 2], &[1, 3]];
    let a = Arc::new(Pattern::new(4, lists.into_iter()).unwrap());
    let b = Arc::new(Pattern::new(4, other.into_iter()).unwrap());
    assert_eq!(a.blocks(), b.blocks());
    solver.analyze(&a).unwrap();
    assert_eq!(
        solver.factorize(&SystemMatrix::new(b)),
        Err(LinearError::PatternMismatch)
    );
    // An equal pattern that was built again is the same.
    let again = Arc::new(Pattern::new(4, lists.into_iter()).unwrap());
    assert!(solver.is_analyzed_for(&again));
    let mut identity = SystemMatrix::new(again);
    (0..12).for_each(|d| identity.set_identity(d, 2.0));
    solver.factorize(&identity).unwrap();
    assert_eq!(
        solver.solve_in_place(&mut x[..11]),
        Err(LinearError::Length {
            given: 11,
            expected: 12
        })
    );
    x[5] = f64::NAN;
    let dof = DofName {
        node: 1,
        component: 2,
    };
    assert_eq!(
        solver.solve_in_place(&mut x[..12]),
        Err(LinearError::NonFiniteRightHandSide { dof })
    );
    x[5] = 1.0;
    identity.set_identity(5, 1e-12);
    solver.factorize(&identity).unwrap();
    x[5] = 1e300;
    assert!(matches!(
        solver.solve_in_place(&mut x[..12]),
        Err(LinearError::NonFiniteSolution { .. })
    ));
    for bad in [f64::NAN, f64::INFINITY] {
        let mut broken = identity.clone();
        let block = broken.pattern().block(3, 2).unwrap();
        broken.values_mut()[9 * block as usize + 4] = bad;
        assert_eq!(
            solver.factorize(&broken),
            Err(LinearError::NonFiniteMatrix { row: 3, column: 2 })
        );
        assert_eq!(
            solver.solve_in_place(&mut x[..12]),
            Err(LinearError::NotFactorized)
        );
    }
}

#[test]
fn extreme_graphs() {
    let pair: [&[u32]; 2] = [&[4, 7], &[1, 9]];
    let none: [&[u32]; 0] = [];
    let patterns = [
        Pattern::new(0, none.into_iter()),
        Pattern::new(1, none.into_iter()),
        Pattern::new(5, none.into_iter()),
        Pattern::new(12, pair.into_iter()),
    ];
    for pattern in patterns {
        let pattern = Arc::new(pattern.unwrap());
        for ordering in [
            OrderingChoice::Amd,
            OrderingChoice::Metis,
            OrderingChoice::Best,
        ] {
            let mut matrix = SystemMatrix::new(Arc::clone(&pattern));
            let n = pattern.dofs();
            (0..n).for_each(|d| matrix.set_identity(d, 2.0 + d as f64));
            if let Some(block) = pattern.block(4, 7) {
                matrix.values_mut()[9 * block as usize + 5] = 1.5;
            }
            let mut solver = DirectSolver::new(options(Mode::Auto, ordering));
            solver.analyze(&pattern).unwrap();
            solver.factorize(&matrix).unwrap();
            let expected: Vec<f64> = (0..n).map(|d| 1.0 + d as f64).collect();
            let mut x = vec![0.0; n];
            matrix.multiply(&expected, &mut x);
            solver.solve_in_place(&mut x).unwrap();
            for (x, e) in x.iter().zip(&expected) {
                assert!((x - e).abs() < 1e-13 * e.abs());
            }
        }
    }
}

/// The dense kernels split their work by parts of the result, so that a second thread changes no sum.
#[test]
fn threads_change_nothing() {
    let matrix = grounded([12, 12, 12], 4);
    let rhs = vector(matrix.pattern().dofs(), &mut Random(3));
    let mut solutions = Vec::new();
    for threads in [1, 2, 2, 4] {
        let mut solver = DirectSolver::new(SolverOptions {
            threads,
            parallel_min_flops: 0.0,
            ..Default::default()
        });
        let analysis = solver.analyze(matrix.pattern()).unwrap();
        assert_eq!(analysis.threads, threads);
        solver.factorize(&matrix).unwrap();
        let mut x = rhs.clone();
        solver.solve_in_place(&mut x).unwrap();
        solutions.push(x);
    }
    for other in &solutions[1..] {
        assert!(solutions[0] == *other);
    }
}
