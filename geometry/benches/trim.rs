//! Trims: nanoseconds per point test against the number of curves, and microseconds per projection on a trimmed patch
//! beside the same patch without its trim.
//!
//! `cargo bench -p covact-geometry --bench trim`

#[path = "../tests/projection/common/mod.rs"]
mod projection_common;
#[path = "../tests/projection/curves.rs"]
mod trim_common;

use std::f64::consts::TAU;
use std::hint::black_box;

use covact_geometry::{PatchSet, Trim, Vec3};
use criterion::{Criterion, criterion_group, criterion_main};
use projection_common::{Random, bumpy};
use trim_common::{one_curve, polygon, star};

const POINTS: usize = 1024;

fn contains(c: &mut Criterion) {
    let mut group = c.benchmark_group("contains");
    let mut random = Random(1);
    let points: Vec<[f64; 2]> = (0..POINTS)
        .map(|_| [random.between(0.0, 1.0), random.between(0.0, 1.0)])
        .collect();
    for n in [4, 100, 10_000] {
        let corners: Vec<[f64; 2]> = (0..n)
            .map(|k| {
                let angle = TAU * k as f64 / n as f64;
                let r = if k % 2 == 0 { 0.4 } else { 0.35 };
                [0.5 + r * angle.cos(), 0.5 + r * angle.sin()]
            })
            .collect();
        let lines = Trim::new(vec![polygon(&corners)], [[0.0, 1.0]; 2], 0.0).unwrap();
        let mut random = trim_common::Random(2);
        let cubic = one_curve(star(&mut random, [0.5; 2], [0.35, 0.4], 3, n, false));
        let cubic = Trim::new(vec![cubic], [[0.0, 1.0]; 2], 1e-9).unwrap();
        for (name, trim) in [("lines", lines), ("cubic spans", cubic)] {
            let mut k = 0;
            group.bench_function(format!("{n} {name}"), |b| {
                b.iter(|| {
                    k = (k + 1) % POINTS;
                    black_box(trim.contains(black_box(points[k])))
                });
            });
        }
    }
    group.finish();
}

fn project(c: &mut Criterion) {
    let mut group = c.benchmark_group("project");
    let patch = bumpy(3, 23, false, 1);
    let mut random = trim_common::Random(3);
    let outer = one_curve(star(&mut random, [0.5; 2], [0.35, 0.48], 3, 14, false));
    let trim = Trim::new(vec![outer], patch.domain(), 1e-9).unwrap();
    let mut random = Random(4);
    let mut points = [Vec::new(), Vec::new()];
    while points.iter().any(|p| p.len() < POINTS) {
        let xi = random.xi(&patch);
        let jet = patch.jet(xi);
        let normal = jet.rho_i[0].cross(&jet.rho_i[1]).normalize();
        let q: Vec3 = jet.rho + normal * random.between(-0.1, 0.1);
        points[usize::from(!trim.contains(xi))].push(q);
    }
    let plain = PatchSet::new(vec![patch.clone()], None).unwrap();
    let trimmed = PatchSet::new(vec![patch.with_trim(Some(trim))], None).unwrap();
    for (place, points) in ["inside", "trimmed away"].iter().zip(&points) {
        for (name, set) in [("untrimmed", &plain), ("trimmed", &trimmed)] {
            let mut k = 0;
            group.bench_function(format!("{place}, {name}"), |b| {
                b.iter(|| {
                    k = (k + 1) % POINTS;
                    black_box(set.project(black_box(&points[k]), None, f64::INFINITY))
                });
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(1));
    targets = contains, project
}
criterion_main!(benches);
