//! LU of unsymmetric systems against faer's Cholesky on the same pattern, in one run: seconds of the numeric
//! factorization (of the processor, where the system tells, so that neighbours on the machine count little), their ratio
//! and the memory of both.
//!
//! `cargo bench --bench lu -- [--write FOLDER] [SIZE ...]`: the matrices of plates (nodes along an edge, two through the
//! thickness) with 8-node cells and of bricks (`brick:NODES`). With `--write` the unsymmetric matrices are also left in
//! FOLDER as three files of little-endian numbers for other solvers: row starts and columns (i32), values (f64).
use covact::machine::memory::peak_memory_mb;
use covact::system::linear::{
    Analysis, DirectSolver, LinearSolver, LuSolver, Mode, OrderingChoice, SolverOptions,
};
use covact::system::{Pattern, SystemMatrix};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Seconds of the processor that this thread has had; elapsed seconds where the system does not tell.
fn seconds(since: Instant) -> f64 {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let spent = stat.split_whitespace().next().and_then(|n| n.parse().ok());
    spent.map_or_else(|| since.elapsed().as_secs_f64(), |ns: f64| 1e-9 * ns)
}

/// Random springs between all nodes of each cell, and an antisymmetric part of a third of their size.
fn matrices(n: [u32; 3]) -> [SystemMatrix; 2] {
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
    let mut symmetric = SystemMatrix::new(Arc::clone(&pattern));
    let mut unsymmetric = SystemMatrix::unsymmetric(Arc::clone(&pattern));
    let mut state = 1u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / 2f64.powi(53) - 0.5
    };
    let mut map = Vec::new();
    let mut ke = [0.0; 576];
    for element in &elements {
        ke.fill(0.0);
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
        map.clear();
        pattern.element_map(element, &mut map).unwrap();
        symmetric.scatter(&map, &ke);
        for i in 0..24 {
            for j in 0..i {
                let w = 0.1 * next();
                ke[24 * j + i] += w;
                ke[24 * i + j] -= w;
            }
        }
        unsymmetric.scatter(&map, &ke);
    }
    for matrix in [&mut symmetric, &mut unsymmetric] {
        for dof in 0..3 {
            let old = matrix.get(dof, dof);
            matrix.set_identity(dof, old + 1.0);
        }
    }
    [symmetric, unsymmetric]
}

fn options(ordering: OrderingChoice) -> SolverOptions {
    SolverOptions {
        mode: Mode::Llt,
        ordering,
        ..Default::default()
    }
}

/// Shortest factorization and solution (means of enough to outlast the clock's ticks), and the backward error of a
/// solution.
struct Timing {
    factorize: f64,
    solve: f64,
    analysis: Analysis,
    residual: f64,
}

fn time(solver: &mut dyn LinearSolver, matrix: &SystemMatrix, rounds: usize) -> Timing {
    let analysis = *solver.analyze(matrix.pattern()).unwrap();
    let n = matrix.pattern().dofs();
    let start = Instant::now();
    let (mut factorize, mut solve) = (f64::INFINITY, f64::INFINITY);
    let (mut x, mut y, mut size) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let repeats = (400_000 / n).max(1);
    for _ in 0..rounds {
        let from = seconds(start);
        for _ in 0..repeats {
            solver.factorize(matrix).unwrap();
        }
        factorize = factorize.min((seconds(start) - from) / repeats as f64);
        let from = seconds(start);
        for _ in 0..repeats {
            x.fill(1.0);
            solver.solve_in_place(&mut x).unwrap();
        }
        solve = solve.min((seconds(start) - from) / repeats as f64);
    }
    matrix.multiply(&x, &mut y);
    matrix.abs_multiply(&x, &mut size);
    let rows = y.iter().zip(&size);
    let residual = rows.fold(0.0f64, |m, (y, s)| m.max((y - 1.0).abs() / (s + 1.0)));
    Timing {
        factorize,
        solve,
        analysis,
        residual,
    }
}

fn write(matrix: &SystemMatrix, folder: &Path, name: &str) {
    let pattern = matrix.pattern();
    let nodes = pattern.nodes();
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); nodes];
    for column in 0..nodes {
        for &row in pattern.column(column) {
            neighbours[row as usize].push(column as u32);
            if row as usize != column {
                neighbours[column].push(row);
            }
        }
    }
    let (mut starts, mut columns, mut values) = (vec![0i32], Vec::new(), Vec::new());
    for (node, own) in neighbours.iter_mut().enumerate() {
        own.sort_unstable();
        for a in 0..3 {
            for &other in own.iter() {
                for b in 0..3 {
                    let column = 3 * other as usize + b;
                    columns.push(column as i32);
                    values.push(matrix.get(3 * node + a, column));
                }
            }
            starts.push(columns.len() as i32);
        }
    }
    let bytes = |v: &[i32]| v.iter().flat_map(|i| i.to_le_bytes()).collect::<Vec<u8>>();
    let put = |part: &str, data: Vec<u8>| {
        std::fs::write(folder.join(format!("{name}.{part}")), data).expect("a folder to write to");
    };
    put("starts", bytes(&starts));
    put("columns", bytes(&columns));
    put(
        "values",
        values.iter().flat_map(|v: &f64| v.to_le_bytes()).collect(),
    );
}

fn main() {
    let mut folder = None;
    let mut sizes = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--write" => folder = arguments.next(),
            // Of `cargo bench` and of test runners.
            option if option.starts_with("--") => {}
            size => sizes.push(size.to_owned()),
        }
    }
    if sizes.is_empty() {
        sizes = ["41", "91", "183", "brick:20"].map(str::to_owned).into();
    }
    for size in sizes {
        let (name, n) = match size.strip_prefix("brick:") {
            Some(n) => ("brick", n.parse().map(|n| [n, n, n])),
            None => ("plate", size.parse().map(|n| [n, n, 2])),
        };
        let Ok(n) = n else {
            eprintln!("{size} is no number of nodes");
            continue;
        };
        let [symmetric, unsymmetric] = matrices(n);
        let dofs = symmetric.pattern().dofs();
        let name = format!("{name}_{dofs}");
        if let Some(folder) = &folder {
            write(&unsymmetric, Path::new(folder), &name);
        }
        let rounds = 5;
        for ordering in [OrderingChoice::Amd, OrderingChoice::Metis] {
            // LU first, so that the peak of the process is not that of Cholesky.
            let lu = time(&mut LuSolver::new(options(ordering)), &unsymmetric, rounds);
            let peak = peak_memory_mb().unwrap_or(f64::NAN);
            let llt = time(
                &mut DirectSolver::new(options(ordering)),
                &symmetric,
                rounds,
            );
            println!(
                "{name} {ordering:?}: LU {:.4} s, LLT {:.4} s, ratio {:.2} (flops {:.2}); solve {:.4} s, {:.4} s; \
                 backward error {:.1e}, {:.1e}; memory {:.0} MB, {:.0} MB (process at LU {peak:.0} MB); {:.2} and {:.2} \
                 Gflop/s",
                lu.factorize,
                llt.factorize,
                lu.factorize / llt.factorize,
                lu.analysis.flops / llt.analysis.flops,
                lu.solve,
                llt.solve,
                lu.residual,
                llt.residual,
                lu.analysis.memory_bytes as f64 / 1e6,
                llt.analysis.memory_bytes as f64 / 1e6,
                2e-9 * lu.analysis.flops / lu.factorize,
                2e-9 * llt.analysis.flops / llt.factorize,
            );
        }
    }
}
