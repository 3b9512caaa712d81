//! Patterns, scatter, products and constraints against dense matrices.
use covact::system::linear::{DirectSolver, LinearSolver, LuSolver, Method};
use covact::system::{
    ConstrainedScatter, ConstraintError, Dof, DofMap, DofMapBuilder, Link, Pattern, PatternError,
    SystemMatrix,
};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Repeatable numbers in [-0.5, 0.5).
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / 2f64.powi(53) - 0.5
    }
}

/// A random symmetric positive definite element matrix of `n` nodes, column-major.
fn element(n: usize, next: &mut impl FnMut() -> f64) -> Vec<f64> {
    let b = DMatrix::from_fn(3 * n, 3 * n, |_, _| next());
    (&b * b.transpose()).as_slice().to_vec()
}

/// A random element matrix of `n` nodes without any symmetry, column-major.
fn unsymmetric_element(n: usize, next: &mut impl FnMut() -> f64) -> Vec<f64> {
    (0..9 * n * n).map(|_| next()).collect()
}

fn add_dense(full: &mut DMatrix<f64>, nodes: &[u32], ke: &[f64]) {
    let size = 3 * nodes.len();
    let dof = |i: usize| 3 * nodes[i / 3] as usize + i % 3;
    for j in 0..size {
        for i in 0..size {
            full[(dof(i), dof(j))] += ke[j * size + i];
        }
    }
}

fn dense(matrix: &SystemMatrix) -> DMatrix<f64> {
    let n = matrix.pattern().dofs();
    DMatrix::from_fn(n, n, |i, j| matrix.get(i, j))
}

fn arc(nodes: usize, groups: &[&[u32]]) -> Arc<Pattern> {
    Arc::new(Pattern::new(nodes, groups.iter().copied()).unwrap())
}

const GROUPS: [&[u32]; 5] = [
    &[3, 0, 7, 2],
    &[7, 8, 1, 5, 6, 4, 0, 2],
    &[9, 3],
    &[4],
    // A degenerate element, which names node 5 twice.
    &[5, 9, 5],
];

/// Scatters an element into every group and compares entries and products with those of a dense matrix.
fn compare_with_dense(mut matrix: SystemMatrix, mut make: impl FnMut(usize) -> Vec<f64>) {
    let pattern = Arc::clone(matrix.pattern());
    let mut full = DMatrix::zeros(33, 33);
    for nodes in GROUPS {
        let ke = make(nodes.len());
        let mut map = vec![77];
        pattern.element_map(nodes, &mut map).unwrap();
        assert_eq!(map.len(), 1 + nodes.len() * (nodes.len() + 1) / 2);
        matrix.scatter(&map[1..], &ke);
        add_dense(&mut full, nodes, &ke);
    }
    assert!((dense(&matrix) - &full).amax() < 1e-14 * full.amax());
    let mut next = numbers(9);
    let x: Vec<f64> = (0..33).map(|_| next()).collect();
    let v = DVector::from_column_slice(&x);
    let mut y = vec![0.0; 33];
    let check = |y: &[f64], expected: DVector<f64>| {
        let y = DVector::from_column_slice(y);
        assert!(expected.amax() > 0.0);
        assert!((y - &expected).amax() < 1e-14 * expected.amax());
    };
    matrix.multiply(&x, &mut y);
    check(&y, &full * &v);
    matrix.abs_multiply(&x, &mut y);
    check(&y, full.abs() * v.abs());
    matrix.abs_row_sums(&mut y);
    check(&y, full.abs() * DVector::from_element(33, 1.0));
    matrix.diagonal(&mut y);
    check(&y, full.diagonal());
    assert_eq!(matrix.first_not_finite(), None);
    matrix.clear();
    assert_eq!(dense(&matrix).amax(), 0.0);
}

#[test]
fn scatter_and_products_as_dense() {
    let mut next = numbers(1);
    let matrix = SystemMatrix::new(arc(11, &GROUPS));
    assert!(matrix.is_symmetric() && matrix.transposed_values().is_none());
    compare_with_dense(matrix, |n| element(n, &mut next));
}

#[test]
fn unsymmetric_scatter_and_products_as_dense() {
    let mut next = numbers(7);
    let matrix = SystemMatrix::unsymmetric(arc(11, &GROUPS));
    assert!(!matrix.is_symmetric());
    assert_eq!(
        matrix.transposed_values().map(<[f64]>::len),
        Some(matrix.values().len())
    );
    compare_with_dense(matrix, |n| unsymmetric_element(n, &mut next));
}

/// A symmetric system comes out the same in both forms, to the last bit (but for a node that an element names twice,
/// whose sums have another order).
#[test]
fn symmetric_values_in_an_unsymmetric_matrix() {
    let pattern = arc(11, &GROUPS);
    let mut plain = SystemMatrix::new(Arc::clone(&pattern));
    let mut both = SystemMatrix::unsymmetric(Arc::clone(&pattern));
    let mut next = numbers(4);
    for nodes in &GROUPS[..4] {
        let mut ke = element(nodes.len(), &mut next);
        let size = 3 * nodes.len();
        for j in 0..size {
            for i in 0..j {
                ke[j * size + i] = ke[i * size + j];
            }
        }
        let mut map = Vec::new();
        pattern.element_map(nodes, &mut map).unwrap();
        plain.scatter(&map, &ke);
        both.scatter(&map, &ke);
    }
    assert!(plain.values() == both.values());
    let x: Vec<f64> = (0..33).map(|_| next()).collect();
    let (mut y, mut z) = (vec![0.0; 33], vec![0.0; 33]);
    plain.multiply(&x, &mut y);
    both.multiply(&x, &mut z);
    assert!(y == z && y.iter().any(|y| *y != 0.0));
}

#[test]
fn values_that_are_not_finite_are_found() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut matrix = SystemMatrix::unsymmetric(arc(11, &GROUPS));
        let at = 9 * matrix.pattern().block(9, 3).unwrap() as usize + 5;
        matrix.transposed_values_mut().unwrap()[at] = bad;
        assert_eq!(matrix.first_not_finite(), Some((9, 3)));
        matrix.clear();
        assert_eq!(matrix.first_not_finite(), None);
        matrix.values_mut()[at] = bad;
        assert_eq!(matrix.first_not_finite(), Some((9, 3)));
    }
}

#[test]
fn many_elements_on_any_number_of_threads() {
    let mut next = numbers(2);
    let nodes = 60u32;
    let elements: Vec<[u32; 4]> = (0..400)
        .map(|_| std::array::from_fn(|_| ((next() + 0.5) * f64::from(nodes)) as u32))
        .collect();
    let pattern = Arc::new(Pattern::new(nodes as usize, elements.iter().map(|e| &e[..])).unwrap());
    let (mut maps, mut kes) = (Vec::new(), Vec::new());
    let mut one_by_one = SystemMatrix::new(Arc::clone(&pattern));
    let mut unsymmetric = SystemMatrix::unsymmetric(Arc::clone(&pattern));
    for e in &elements {
        let at = maps.len();
        pattern.element_map(e, &mut maps).unwrap();
        let ke = unsymmetric_element(4, &mut next);
        one_by_one.scatter(&maps[at..], &ke);
        unsymmetric.scatter(&maps[at..], &ke);
        kes.extend(ke);
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(5)
        .build()
        .unwrap();
    for threads in [0, 1, 2, 3, 5] {
        let mut matrix = SystemMatrix::new(Arc::clone(&pattern));
        pool.install(|| matrix.scatter_many(4, &maps, &kes, threads));
        assert!(matrix.values() == one_by_one.values(), "{threads} threads");
        let mut matrix = SystemMatrix::unsymmetric(Arc::clone(&pattern));
        pool.install(|| matrix.scatter_many(4, &maps, &kes, threads));
        assert!(matrix.values() == unsymmetric.values());
        assert!(matrix.transposed_values() == unsymmetric.transposed_values());
    }
}

#[test]
fn pattern_holds_what_was_asked() {
    let pattern = arc(11, &GROUPS);
    for a in 0..11u32 {
        for b in 0..11u32 {
            let coupled = a == b || GROUPS.iter().any(|g| g.contains(&a) && g.contains(&b));
            assert_eq!(pattern.block(a, b).is_some(), coupled, "{a} {b}");
        }
        assert!(pattern.column(a as usize).is_sorted());
        assert_eq!(pattern.column(a as usize)[0], a);
    }
    assert_eq!(pattern.block(3, 11), None);
    assert_eq!(pattern.rows().len(), pattern.blocks());
    let error = Pattern::new(4, [&[0u32, 1][..], &[2, 4][..]].into_iter());
    assert_eq!(
        error,
        Err(PatternError::NodeOutOfRange {
            group: 1,
            node: 4,
            nodes: 4
        })
    );
    let mut map = vec![5];
    assert_eq!(
        pattern.element_map(&[0, 3, 10], &mut map),
        Err(PatternError::NotCoupled { row: 10, column: 0 })
    );
    assert_eq!(map, [5]);
    assert!(Pattern::new(usize::MAX, [].into_iter()).is_err());
    // The order of groups and of their nodes does not matter, what they couple does.
    let same = arc(
        11,
        &[&[5, 9], &[4, 6, 5, 1, 8, 7, 2, 0], &[2, 7, 3, 0], &[3, 9]],
    );
    assert_eq!((same.id(), &same), (pattern.id(), &pattern));
    assert_ne!(arc(11, &GROUPS[..4]).id(), pattern.id());
    assert_ne!(arc(12, &GROUPS).id(), pattern.id());
}

/// A coupling of z with z alone keeps all nine entries of its block.
#[test]
fn zeros_are_kept() {
    let pattern = arc(2, &[&[0, 1]]);
    let mut matrix = SystemMatrix::new(Arc::clone(&pattern));
    let mut ke = [0.0; 36];
    for (i, j, v) in [(2, 2, 3.0), (5, 5, 3.0), (2, 5, -1.0), (5, 2, -1.0)] {
        ke[6 * j + i] = v;
    }
    let mut map = Vec::new();
    pattern.element_map(&[1, 0], &mut map).unwrap();
    matrix.scatter(&map, &ke);
    assert_eq!(matrix.values().len(), 27);
    assert_eq!(matrix.get(5, 2), -1.0);
    for dof in [0, 1, 3, 4] {
        matrix.set_identity(dof, 1.0);
    }
    let mut solver = DirectSolver::default();
    solver.analyze(&pattern).unwrap();
    solver.factorize(&matrix).unwrap();
    let mut x = [1.0, 2.0, 2.0, 3.0, 4.0, 2.0];
    solver.solve_in_place(&mut x).unwrap();
    for (x, e) in x.iter().zip([1.0, 2.0, 1.0, 3.0, 4.0, 1.0]) {
        assert!((x - e).abs() < 1e-15);
    }
}

/// Three 4-node elements in a row, with all kinds of constraints; the condensed solution must be that of dense
/// elimination.
#[test]
fn constraints_as_dense_elimination() {
    let mut next = numbers(5);
    let matrix = SystemMatrix::new;
    constrained(
        |n| element(n, &mut next),
        matrix,
        &mut DirectSolver::default(),
    );
}

#[test]
fn unsymmetric_constraints_as_dense_elimination() {
    let mut next = numbers(6);
    let matrix = SystemMatrix::unsymmetric;
    constrained(
        |n| unsymmetric_element(n, &mut next),
        matrix,
        &mut LuSolver::default(),
    );
}

fn constrained(
    mut make: impl FnMut(usize) -> Vec<f64>,
    zero: impl Fn(Arc<Pattern>) -> SystemMatrix,
    solver: &mut dyn LinearSolver,
) {
    let elements: [[u32; 4]; 3] = [[0, 1, 2, 3], [2, 3, 4, 5], [4, 5, 6, 7]];
    let mut builder = DofMapBuilder::new(9);
    for dof in [0, 1, 2, 5, 25, 26] {
        builder.prescribe(dof).unwrap();
    }
    // Within a node; within an element; to a prescribed dof elsewhere; a chain 23 -> 20 -> 8, whose end is in another
    // element; a node that no element has.
    let ties = [
        (4, 3, -1.0),
        (10, 7, -1.0),
        (15, 0, 2.0),
        (20, 8, -3.0),
        (23, 20, 0.5),
        (24, 21, 1.5),
    ];
    for (dof, to, c) in ties.into_iter().rev() {
        builder.tie(dof, to, c).unwrap();
    }
    let dofs = builder.build().unwrap();
    assert_eq!(dofs.link(23), Link::To(8, -1.5));
    assert_eq!(dofs.link(15), Link::Removed);
    let coefficient = 2.0;
    assert_eq!(
        dofs.dof(15),
        Dof::Tied {
            dof: 0,
            coefficient
        }
    );

    // Dense: u = T q + g.
    let n = 27;
    let mut next = numbers(5);
    let mut given = vec![0.0; n];
    for dof in dofs.removed() {
        given[dof as usize] = next();
    }
    let free: Vec<usize> = (0..n).filter(|d| dofs.dof(*d) == Dof::Free).collect();
    assert_eq!(free.len(), n - 6 - ties.len());
    let mut t = DMatrix::zeros(n, free.len());
    let mut g = DVector::from_column_slice(&given);
    for (column, dof) in free.iter().enumerate() {
        t[(*dof, column)] = 1.0;
    }
    for (dof, to, c) in ties {
        let row = t.row(to as usize) * c;
        t.set_row(dof as usize, &row);
        g[dof as usize] += c * g[to as usize];
    }
    let mut full = DMatrix::zeros(n, n);
    let load = DVector::from_fn(n, |_, _| next());
    let kes: Vec<Vec<f64>> = elements.iter().map(|_| make(4)).collect();
    for (nodes, ke) in elements.iter().zip(&kes) {
        add_dense(&mut full, nodes, ke);
    }
    let reduced = t.transpose() * &full * &t;
    let right = t.transpose() * (&load - &full * &g);
    let q = reduced.clone().lu().solve(&right).unwrap();
    let expected = &t * q + &g;

    let mut groups: Vec<Vec<u32>> = Vec::new();
    for nodes in &elements {
        let mut group = Vec::new();
        dofs.extend_nodes(nodes, &mut group);
        groups.push(group);
    }
    assert_eq!(groups[0], [0, 1, 2, 3]);
    assert_eq!(groups[2], [4, 5, 6, 7, 2]);
    let pattern = Arc::new(Pattern::new(9, groups.iter().map(Vec::as_slice)).unwrap());
    let mut matrix = zero(Arc::clone(&pattern));
    let mut by_map = zero(Arc::clone(&pattern));
    let mut work = ConstrainedScatter::default();
    let mut rhs = load.as_slice().to_vec();
    let mut particular = given.clone();
    particular[free[0]] = 99.0; // must be ignored
    dofs.particular(&mut particular);
    assert!((DVector::from_column_slice(&particular) - &g).amax() < 1e-15);
    for ((nodes, group), ke) in elements.iter().zip(&groups).zip(&kes) {
        assert!(dofs.constrains(nodes));
        assert!(dofs.subtract_prescribed(nodes, ke, &particular, &mut rhs));
        matrix
            .scatter_constrained(nodes, ke, &dofs, &mut work)
            .unwrap();
        // The same with a map made beforehand.
        let size = 3 * group.len();
        let mut extended = vec![0.0; size * size];
        for j in 0..12 {
            extended[j * size..j * size + 12].copy_from_slice(&ke[12 * j..12 * j + 12]);
        }
        dofs.condense_matrix(group, &mut extended).unwrap();
        let mut map = Vec::new();
        pattern.element_map(group, &mut map).unwrap();
        by_map.scatter(&map, &extended);
    }
    assert!(matrix.values() == by_map.values());
    assert!(matrix.transposed_values() == by_map.transposed_values());
    dofs.fold(&mut rhs);
    let scale = matrix.set_identities(&dofs);
    assert!(scale > 0.0);
    for (a, i) in free.iter().enumerate() {
        assert!((rhs[*i] - right[a]).abs() < 1e-12);
        for (b, j) in free.iter().enumerate() {
            assert!((matrix.get(*i, *j) - reduced[(a, b)]).abs() < 1e-12);
        }
    }
    solver.analyze(&pattern).unwrap();
    let found = solver.factorize(&matrix).unwrap();
    assert!(found.method == Method::Lu || found.negative_pivots == 0);
    solver.solve_in_place(&mut rhs).unwrap();
    for dof in dofs.removed() {
        assert_eq!(rhs[dof as usize], 0.0);
    }
    dofs.expand(&mut rhs, Some(&particular));
    let u = DVector::from_column_slice(&rhs);
    // The random matrices have a condition of up to about 1e5.
    assert!((u - &expected).amax() < 1e-10 * expected.amax());

    // A pattern without the foreign target, and a list without it, are refused by name.
    let small = arc(9, &elements.each_ref().map(|e| &e[..]));
    let mut matrix = zero(small);
    assert_eq!(
        matrix.scatter_constrained(&elements[2], &kes[2], &dofs, &mut work),
        Err(PatternError::NotCoupled { row: 2, column: 6 })
    );
    assert_eq!(dense(&matrix).amax(), 0.0);
    assert_eq!(
        dofs.condense_matrix(&elements[2], &mut kes[2].clone()),
        Err(ConstraintError::TargetMissing { dof: 20 })
    );
}

#[test]
fn unconstrained_is_untouched() {
    let dofs = DofMap::free(4);
    let ke = element(4, &mut numbers(3));
    let mut same = ke.clone();
    dofs.condense_matrix(&[0, 1, 2, 3], &mut same).unwrap();
    assert_eq!(same, ke);
    assert!(!dofs.constrains(&[0, 1, 2, 3]));
    assert_eq!(dofs, DofMapBuilder::new(4).build().unwrap());
    let mut rhs = vec![1.0; 12];
    assert!(!dofs.subtract_prescribed(&[0, 1, 2, 3], &ke, &[0.0; 12], &mut rhs));
    dofs.fold(&mut rhs);
    dofs.expand(&mut rhs, None);
    assert_eq!(rhs, [1.0; 12]);
}

#[test]
fn contradictions_are_refused() {
    let mut b = DofMapBuilder::new(2);
    b.prescribe(1).unwrap();
    b.prescribe(1).unwrap();
    b.tie(2, 3, -1.0).unwrap();
    b.tie(2, 3, -1.0).unwrap();
    assert_eq!(b.get(1), Some(Dof::Prescribed));
    assert_eq!(b.get(6), None);
    assert_eq!(b.prescribe(2), Err(ConstraintError::Conflict { dof: 2 }));
    assert_eq!(b.tie(2, 3, 1.0), Err(ConstraintError::Conflict { dof: 2 }));
    assert_eq!(b.tie(1, 3, 1.0), Err(ConstraintError::Conflict { dof: 1 }));
    assert_eq!(b.tie(4, 4, 1.0), Err(ConstraintError::Cycle { dof: 4 }));
    let bad = ConstraintError::Coefficient { dof: 4 };
    assert_eq!(b.tie(4, 5, f64::NAN), Err(bad));
    let range = ConstraintError::OutOfRange { dof: 6, dofs: 6 };
    assert_eq!(b.tie(4, 6, 1.0), Err(range));
    assert_eq!(b.prescribe(6), Err(range));
    assert!(b.clone().build().is_ok());
    b.tie(3, 5, 1.0).unwrap();
    b.tie(5, 2, 1.0).unwrap();
    assert!(matches!(b.build(), Err(ConstraintError::Cycle { .. })));
    let message = ConstraintError::Conflict { dof: 7 }.to_string();
    assert_eq!(
        message,
        "component 1 of node 2 is constrained twice, in different ways"
    );
}
