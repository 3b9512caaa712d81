//! Solutions, counts and refusals beside those of this program's own solvers.
use super::library::Api;
use super::*;
use crate::system::linear::{DirectSolver, LinearSolver, LuSolver};
use std::sync::Arc;

/// Whether the library is there; says so where it is not.
fn present() -> bool {
    let found = Api::get();
    if let Err(fault) = &found {
        println!("skipped: {fault}");
        assert!(matches!(fault, MumpsFault::NoLibrary { .. }), "{fault}");
    }
    found.is_ok()
}

/// Numbers between -1 and 1 that look random.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}

/// What a matrix is like.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Like {
    Definite,
    /// Some diagonals are lowered by so much.
    Indefinite(f64),
    Unsymmetric,
    /// One unknown has no stiffness but what couples it with others.
    Singular,
    UnsymmetricSingular,
}

/// A matrix of bricks between the nodes of a grid, each a random one of the kind.
fn matrix(n: [u32; 3], like: Like, seed: u64) -> SystemMatrix {
    let node = |i: u32, j: u32, k: u32| (k * n[1] + j) * n[0] + i;
    let mut groups = Vec::new();
    for k in 0..n[2] - 1 {
        for j in 0..n[1] - 1 {
            for i in 0..n[0] - 1 {
                let corner = |c: u32| node(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
                groups.push([0, 1, 2, 3, 4, 5, 6, 7].map(corner));
            }
        }
    }
    let nodes = n.iter().product::<u32>() as usize;
    let pattern = Pattern::new(nodes, groups.iter().map(|g| &g[..])).expect("small");
    let pattern = Arc::new(pattern);
    let unsymmetric = matches!(like, Like::Unsymmetric | Like::UnsymmetricSingular);
    let mut matrix = match unsymmetric {
        true => SystemMatrix::unsymmetric(pattern.clone()),
        false => SystemMatrix::new(pattern.clone()),
    };
    let mut numbers = Numbers(seed);
    let mut map = Vec::new();
    let singular = matches!(like, Like::Singular | Like::UnsymmetricSingular);
    for group in &groups {
        map.clear();
        let factor = numbers.vector(24 * 24);
        let mut ke = vec![0.0; 24 * 24];
        for a in 0..24 {
            for b in 0..24 {
                // Singular: differences within a direction only, so that a rigid translation meets no force.
                ke[a + 24 * b] = match singular {
                    true if a % 3 == b % 3 => f64::from(u8::from(a == b)) * 8.0 - 1.0,
                    true => 0.0,
                    false => (0..24)
                        .map(|k| factor[a + 24 * k] * factor[b + 24 * k])
                        .sum(),
                };
                if like == Like::Unsymmetric && a < b {
                    ke[a + 24 * b] += 0.5 * factor[a + 24 * b];
                }
                if like == Like::UnsymmetricSingular && a < 12 && a % 3 == b % 3 {
                    ke[a + 24 * b] *= 3.0;
                }
            }
        }
        pattern.element_map(group, &mut map).expect("coupled");
        matrix.scatter(&map, &ke);
    }
    if let Like::Indefinite(by) = like {
        for dof in (0..pattern.dofs()).step_by(7) {
            matrix.add_diagonal(dof, -by);
        }
    }
    matrix
}

fn own(symmetric: bool) -> Box<dyn LinearSolver> {
    let options = SolverOptions::default();
    match symmetric {
        true => Box::new(DirectSolver::new(options)),
        false => Box::new(LuSolver::new(options)),
    }
}

fn mumps(symmetric: bool, options: MumpsOptions) -> ForeignSolver {
    ForeignSolver::mumps(symmetric, SolverOptions::default(), options)
}

/// Largest difference in parts of the largest entry of `b`.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0f64, |m, b| m.max(b.abs()));
    assert!(size > 0.0 && a.len() == b.len());
    a.iter()
        .zip(b)
        .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()))
        / size
}

/// The solution of a refined one of our own: two solvers agree as far as the condition lets them.
fn reference(matrix: &SystemMatrix, rhs: &[f64]) -> (Vec<f64>, Factorization) {
    let mut solver = own(matrix.is_symmetric());
    solver.analyze(matrix.pattern()).expect("analysed");
    let found = solver.factorize(matrix).expect("regular");
    let n = rhs.len();
    let (mut x, mut r, mut c) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    (solver.solve_refined(matrix, rhs, &mut x, &mut r, &mut c)).expect("solved");
    (x, found)
}

/// Definite, indefinite and unsymmetric matrices on one pattern after the other: solutions to 1e-12, the same numbers of negative
/// pivots, and the same sign of the determinant.
#[test]
fn solutions_and_counts_are_our_own() {
    if !present() {
        return;
    }
    let (mut negative, mut determinants) = (0, [0; 2]);
    for symmetric in [true, false] {
        let mut solver = mumps(symmetric, MumpsOptions::default());
        for (round, n) in [[2, 2, 2], [7, 5, 2], [12, 9, 3]].into_iter().enumerate() {
            let likes: &[Like] = match symmetric {
                true => &[
                    Like::Definite,
                    Like::Indefinite(30.0),
                    Like::Indefinite(90.0),
                    Like::Definite,
                ],
                false => &[Like::Unsymmetric; 4],
            };
            for (seed, &like) in likes.iter().enumerate() {
                let matrix = matrix(n, like, 5 + seed as u64);
                if seed == 0 {
                    let analysis = solver.analyze(matrix.pattern()).expect("analysed");
                    assert!(analysis.flops > 0.0 && analysis.fill > 0 && analysis.memory_bytes > 0);
                }
                // The pattern is that of the first, under another name.
                let mut on_first = match symmetric {
                    true => SystemMatrix::new(solver_pattern(&solver)),
                    false => SystemMatrix::unsymmetric(solver_pattern(&solver)),
                };
                on_first.values_mut().copy_from_slice(matrix.values());
                if let (Some(to), Some(from)) =
                    (on_first.transposed_values_mut(), matrix.transposed_values())
                {
                    to.copy_from_slice(from);
                }
                let rhs = Numbers(99).vector(matrix.pattern().dofs());
                let (expected, counts) = reference(&matrix, &rhs);
                let found = solver.factorize(&on_first).expect("regular");
                assert_eq!(
                    found.negative_pivots, counts.negative_pivots,
                    "{like:?} {n:?}"
                );
                assert_eq!(found.perturbed_pivots, counts.perturbed_pivots);
                let method = match (like, seed) {
                    (Like::Unsymmetric, _) => Method::Lu,
                    // Once one was indefinite, they are all factorized as such.
                    (Like::Definite, 0) if round == 0 => Method::Llt,
                    _ => Method::Ldlt,
                };
                assert_eq!(found.method, method, "{like:?} {n:?} {seed}");
                match symmetric {
                    true => negative += found.negative_pivots,
                    false => determinants[found.negative_pivots] += 1,
                }
                let mut x = rhs.clone();
                solver.solve_with(&on_first, &mut x).expect("solved");
                let error = difference(&x, &expected);
                assert!(error < 1e-12, "{like:?} {n:?}: {error:e}");
            }
        }
        assert_eq!(solver.take_handover(), None);
    }
    assert!(
        negative > 50 && determinants.iter().all(|n| *n > 1),
        "{negative} {determinants:?}"
    );
}

fn solver_pattern(solver: &ForeignSolver) -> Arc<Pattern> {
    solver.pattern().expect("analysed").clone()
}

/// A matrix of which nothing holds a translation is refused, with an unknown of the node that is eliminated last; with a spring it has a
/// solution.
#[test]
fn singular_matrices_are_refused() {
    if !present() {
        return;
    }
    for like in [Like::Singular, Like::UnsymmetricSingular] {
        let mut matrix = matrix([5, 4, 3], like, 1);
        let mut solver = mumps(matrix.is_symmetric(), MumpsOptions::default());
        solver.analyze(matrix.pattern()).expect("analysed");
        // Two directions are held.
        matrix.add_diagonal(0, 1.0);
        matrix.add_diagonal(2, 1.0);
        let refused = solver.factorize(&matrix);
        let Err(LinearError::TinyPivot { dof, ratio }) = refused else {
            panic!("{like:?}: {refused:?}");
        };
        assert!(dof.component == 1 && ratio < 1e-13, "{dof} {ratio:e}");
        let mut host = own(matrix.is_symmetric());
        host.analyze(matrix.pattern()).expect("analysed");
        let refused = host.factorize(&matrix);
        assert!(
            matches!(refused, Err(LinearError::TinyPivot { dof, .. } | LinearError::ZeroPivot { dof } | LinearError::NonPositivePivot { dof }) if dof.component == 1),
            "{refused:?}"
        );
        let rhs = Numbers(3).vector(matrix.pattern().dofs());
        let early = solver.solve_with(&matrix, &mut rhs.clone());
        assert_eq!(early, Err(LinearError::NotFactorized));
        matrix.add_diagonal(1, 1.0);
        let (expected, _) = reference(&matrix, &rhs);
        let mut x = rhs;
        solver.factorize(&matrix).expect("held");
        solver.solve_with(&matrix, &mut x).expect("solved");
        assert!(difference(&x, &expected) < 1e-12);
        assert_eq!(solver.take_handover(), None);
    }
}

/// Factors on the disk and every ordering that the library has: the same solutions. The folder is empty afterwards.
#[test]
fn settings_change_no_solution() {
    if !present() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let files = || std::fs::read_dir(folder.path()).expect("there").count();
    let out_of_core = Some(folder.path().to_owned());
    let mut settings: Vec<MumpsOptions> = [
        MumpsOrdering::Auto,
        MumpsOrdering::Metis,
        MumpsOrdering::Amd,
        MumpsOrdering::Scotch,
        MumpsOrdering::Pord,
        MumpsOrdering::Amf,
        MumpsOrdering::Qamd,
    ]
    .map(|ordering| MumpsOptions {
        ordering,
        ..MumpsOptions::default()
    })
    .to_vec();
    settings.push(MumpsOptions {
        out_of_core,
        ..MumpsOptions::default()
    });
    for like in [Like::Definite, Like::Indefinite(40.0), Like::Unsymmetric] {
        let matrix = matrix([14, 12, 3], like, 8);
        let rhs = Numbers(4).vector(matrix.pattern().dofs());
        let (expected, counts) = reference(&matrix, &rhs);
        for options in &settings {
            let mut solver = mumps(matrix.is_symmetric(), options.clone());
            match solver.analyze(matrix.pattern()) {
                Err(LinearError::Mumps(MumpsFault::NoOrdering { asked })) => {
                    assert!(matches!(asked, "scotch" | "pord"), "{asked}");
                    println!("skipped: no {asked}");
                    continue;
                }
                analyzed => drop(analyzed.expect("analysed")),
            }
            for _ in 0..2 {
                let found = solver.factorize(&matrix).expect("regular");
                assert_eq!(found.negative_pivots, counts.negative_pivots, "{options:?}");
                assert_eq!(files(), usize::from(options.out_of_core.is_some()));
                let mut x = rhs.clone();
                solver.solve_with(&matrix, &mut x).expect("solved");
                let error = difference(&x, &expected);
                assert!(error < 1e-12, "{like:?} {options:?}: {error:e}");
            }
            assert_eq!(solver.take_handover(), None);
            drop(solver);
            assert_eq!(files(), 0, "{options:?}");
        }
    }
}

/// A folder that is not there, and one whose name is too long, are refused before anything is factorized.
#[test]
fn folders_that_cannot_be_used() {
    if !present() {
        return;
    }
    let matrix = matrix([2, 2, 2], Like::Definite, 1);
    let analyzed = |folder: &std::path::Path| {
        let options = MumpsOptions {
            out_of_core: Some(folder.to_owned()),
            ..MumpsOptions::default()
        };
        mumps(true, options).analyze(matrix.pattern()).map(drop)
    };
    let folder = tempfile::tempdir().expect("a folder");
    let missing = analyzed(&folder.path().join("missing"));
    let kind = std::io::ErrorKind::NotFound;
    assert_eq!(missing, Err(MumpsFault::Folder { kind }.into()));
    let mut long = folder.path().to_owned();
    (0..10).for_each(|_| long.push("a".repeat(120)));
    std::fs::create_dir_all(&long).expect("made");
    let refused = analyzed(&long);
    assert!(
        matches!(
            refused,
            Err(LinearError::Mumps(MumpsFault::LongFolder { .. }))
        ),
        "{refused:?}"
    );
    assert_eq!(std::fs::read_dir(&long).expect("there").count(), 0);
}
