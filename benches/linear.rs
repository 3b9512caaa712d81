//! Assembly and direct solution of generated bricks and plates of 8-node cells.
//!
//! The stiffness is that of random springs between all nodes of each cell, which has the pattern of 8-node
//! hexahedra and is positive definite. Before the timed runs the analysis of each case is printed.
use covact::system::linear::{DirectSolver, LinearSolver, Mode, OrderingChoice, SolverOptions};
use covact::system::{Pattern, SystemMatrix};
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::sync::Arc;

struct Case {
    name: String,
    elements: Vec<[u32; 8]>,
    pattern: Arc<Pattern>,
    maps: Vec<u32>,
    kes: Vec<f64>,
    matrix: SystemMatrix,
}

fn case(kind: &str, n: [u32; 3]) -> Case {
    let node = |i, j, k| i + n[0] * (j + n[1] * k);
    let mut elements: Vec<[u32; 8]> = Vec::new();
    for k in 1..n[2] {
        for j in 1..n[1] {
            for i in 1..n[0] {
                elements.push(std::array::from_fn(|c| {
                    let c = c as u32;
                    node(i - 1 + (c & 1), j - 1 + (c >> 1 & 1), k - 1 + (c >> 2))
                }));
            }
        }
    }
    let nodes = (n[0] * n[1] * n[2]) as usize;
    let pattern = Arc::new(Pattern::new(nodes, elements.iter().map(|e| &e[..])).unwrap());
    let mut maps = Vec::new();
    let mut kes = vec![0.0; 576 * elements.len()];
    let mut state = 1u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / 2f64.powi(53) - 0.5
    };
    for (element, ke) in elements.iter().zip(kes.chunks_exact_mut(576)) {
        pattern.element_map(element, &mut maps).unwrap();
        for p in 0..8 {
            for q in 0..p {
                let v = [next(), next(), next()];
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
    let mut matrix = SystemMatrix::new(Arc::clone(&pattern));
    matrix.scatter_many(8, &maps, &kes, 1);
    for dof in 0..3 {
        let old = matrix.get(dof, dof);
        matrix.set_identity(dof, old + 1.0);
    }
    Case {
        name: format!("{kind} {} dofs", pattern.dofs()),
        elements,
        pattern,
        maps,
        kes,
        matrix,
    }
}

fn solver(mode: Mode, ordering: OrderingChoice, threads: usize) -> DirectSolver {
    DirectSolver::new(SolverOptions {
        mode,
        ordering,
        threads,
        ..Default::default()
    })
}

fn linear(c: &mut Criterion) {
    let cases = [
        case("plate", [26, 26, 2]),
        case("plate", [82, 82, 2]),
        case("brick", [16, 16, 16]),
        case("brick", [23, 23, 23]),
    ];
    for case in cases {
        let mut group = c.benchmark_group(&case.name);
        group.sample_size(10);
        group.bench_function("pattern", |b| {
            b.iter(|| Pattern::new(case.pattern.nodes(), case.elements.iter().map(|e| &e[..])));
        });
        let mut matrix = case.matrix.clone();
        for threads in [1, 2] {
            group.bench_function(format!("scatter, {threads} threads"), |b| {
                b.iter(|| {
                    matrix.clear();
                    matrix.scatter_many(8, &case.maps, &case.kes, threads);
                });
            });
        }
        for ordering in [
            OrderingChoice::Amd,
            OrderingChoice::Metis,
            OrderingChoice::Best,
        ] {
            let mut s = solver(Mode::Llt, ordering, 1);
            group.bench_function(format!("analyze, {ordering:?}"), |b| {
                b.iter(|| s.analyze(&case.pattern).unwrap().flops);
            });
            println!("{}: {:?}", case.name, s.analysis());
        }
        for (mode, threads) in [(Mode::Llt, 1), (Mode::Ldlt, 1), (Mode::Llt, 2)] {
            let mut s = solver(mode, OrderingChoice::Best, threads);
            s.analyze(&case.pattern).unwrap();
            group.bench_function(format!("factorize, {mode:?}, {threads} threads"), |b| {
                b.iter(|| s.factorize(&case.matrix).unwrap());
            });
            if threads == 1 {
                // The runs above may have been filtered out.
                s.factorize(&case.matrix).unwrap();
                let mut x = vec![1.0; case.pattern.dofs()];
                group.bench_function(format!("solve, {mode:?}"), |b| {
                    b.iter(|| {
                        x.fill(1.0);
                        s.solve_in_place(&mut x).unwrap();
                    });
                });
            }
        }
        let (x, mut y) = (
            vec![1.0; case.pattern.dofs()],
            vec![0.0; case.pattern.dofs()],
        );
        group.bench_function("multiply", |b| {
            b.iter(|| case.matrix.multiply(black_box(&x), &mut y));
        });
        group.finish();
    }
}

criterion_group!(benches, linear);
criterion_main!(benches);
