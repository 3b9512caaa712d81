//! Time of a second-order jet beside truck-geometry, on 20 x 20 control points with random parameters: one number is the
//! time of all parameters, so the time per jet is that divided by `COUNT`.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

use covact_geometry::{Frame, Jet, NurbsPatch, PatchShape, Vec3};
use truck_geometry::prelude::{NurbsSurface, Vector4};

const COUNT: usize = 1024;

fn random(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

fn discard<T>(x: T) {
    black_box(x);
}

fn patch(degree: usize, rational: bool) -> NurbsPatch {
    let count = 20;
    let mut state = 42;
    let inner = count - degree;
    let mut knots = vec![0.0; degree];
    knots.extend((0..=inner).map(|k| k as f64 / inner as f64));
    knots.extend(vec![1.0; degree]);
    let points: Vec<Vec3> = (0..count * count)
        .map(|k| Vec3::new((k % count) as f64, (k / count) as f64, random(&mut state)))
        .collect();
    let weights: Vec<f64> = points.iter().map(|_| 0.5 + random(&mut state)).collect();
    let weights = rational.then_some(weights.as_slice());
    NurbsPatch::new(
        [degree; 2],
        [knots.clone(), knots],
        [count; 2],
        &points,
        weights,
    )
    .expect("the patch is sound")
}

fn parameters(state: &mut u64) -> Vec<[f64; 2]> {
    (0..COUNT).map(|_| [random(state), random(state)]).collect()
}

fn truck_jet(surface: &NurbsSurface<Vector4>, [u, v]: [f64; 2]) -> Jet {
    let x = surface.subs(u, v);
    let vector = |v: truck_geometry::prelude::Vector3| Vec3::new(v.x, v.y, v.z);
    Jet {
        rho: Vec3::new(x.x, x.y, x.z),
        rho_i: [vector(surface.uder(u, v)), vector(surface.vder(u, v))],
        rho_ij: [
            vector(surface.uuder(u, v)),
            vector(surface.uvder(u, v)),
            vector(surface.vvder(u, v)),
        ],
    }
}

fn evaluation(c: &mut Criterion) {
    let mut state = 7;
    let xi = parameters(&mut state);
    for (degree, rational) in [(2, true), (3, false), (3, true), (5, true), (9, true)] {
        let patch = patch(degree, rational);
        let kind = if rational { "rational" } else { "plain" };
        let mut group = c.benchmark_group(format!("degree {degree} {kind}"));
        group.throughput(Throughput::Elements(COUNT as u64));
        group.sample_size(20);
        group.bench_function("jet", |b| {
            b.iter(|| xi.iter().for_each(|&xi| discard(patch.jet(black_box(xi)))));
        });
        let one_span: Vec<[f64; 2]> = {
            let [a, b] = patch.spans(0)[5];
            xi.iter().map(|x| x.map(|s| a + (b - a) * s)).collect()
        };
        group.bench_function("jet, span known", |b| {
            b.iter(|| {
                for &xi in &one_span {
                    black_box(patch.jet_in_span(black_box([5, 5]), black_box(xi)));
                }
            });
        });
        group.bench_function("jet3", |b| {
            b.iter(|| xi.iter().for_each(|&xi| discard(patch.jet3(black_box(xi)))));
        });
        group.bench_function("jet and frame", |b| {
            b.iter(|| {
                for &xi in &xi {
                    black_box(Frame::new(&patch.jet(black_box(xi)), 1.0));
                }
            });
        });
        let mut shape = PatchShape::default();
        group.bench_function("shape", |b| {
            b.iter(|| {
                for &xi in &xi {
                    patch.shape(black_box(xi), &mut shape);
                    black_box(&shape);
                }
            });
        });
        if degree == 3 {
            let surface = patch.to_truck();
            group.throughput(Throughput::Elements(64));
            group.bench_function("truck jet", |b| {
                b.iter(|| {
                    for &xi in &xi[..64] {
                        black_box(truck_jet(&surface, black_box(xi)));
                    }
                });
            });
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_millis(1000));
    targets = evaluation
}
criterion_main!(benches);
