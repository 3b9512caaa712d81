//! Facets: a jet beside that of a NURBS patch of the same degree; building a set of 2500, 10,000 (and with
//! `FACETS=100000` in the environment that many) facets with the memory per facet; closest points beside the same surface
//! as one NURBS patch.

use std::alloc::{GlobalAlloc, Layout, System};
use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use covact_geometry::facet::{Refinement, bilinear_facets, biquadratic_facets, facet_patch};
use covact_geometry::{BezierPiece, NurbsPatch, PatchSet, Surface, Vec3};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

/// The system's allocator, counting bytes that are held.
struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        HELD.fetch_add(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller keeps the conditions of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller keeps the conditions of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Bicubic graph over a square of side 10 with 10 x 10 spans.
fn sheet() -> NurbsPatch {
    let n = 13u32;
    let mut knots = vec![0.0; 3];
    knots.extend((0..=10).map(f64::from));
    knots.extend([10.0; 3]);
    let points: Vec<Vec3> = (0..n * n)
        .map(|k| {
            let (x, y) = (
                f64::from(k % n) * 10.0 / 12.0,
                f64::from(k / n) * 10.0 / 12.0,
            );
            Vec3::new(x, y, (0.9 * x).sin() * (0.7 * y).cos())
        })
        .collect();
    NurbsPatch::new(
        [3; 2],
        [knots.clone(), knots],
        [n as usize; 2],
        &points,
        None,
    )
    .expect("a valid patch")
}

fn spread(k: u32) -> [f64; 3] {
    [0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_901]
        .map(|a: f64| (0.5 + a * f64::from(k)).fract())
}

/// A facet as a NURBS patch.
fn as_nurbs<S: Surface>(facet: &S) -> NurbsPatch {
    let BezierPiece { degree, points, .. } = &facet.bezier_pieces()[0];
    let knots = degree.map(|p| [vec![-1.0; p + 1], vec![1.0; p + 1]].concat());
    let points: Vec<Vec3> = points.iter().map(|p| Vec3::new(p[0], p[1], p[2])).collect();
    NurbsPatch::new(*degree, knots, degree.map(|p| p + 1), &points, None).expect("a valid patch")
}

fn jets<S: Surface>(c: &mut Criterion, name: &str, facet: &S) {
    let xi: Vec<[f64; 2]> = (0..1024)
        .map(spread)
        .map(|[a, b, _]| [2.0 * a - 1.0, 2.0 * b - 1.0])
        .collect();
    let patch = as_nurbs(facet);
    let mut group = c.benchmark_group(name);
    group.throughput(Throughput::Elements(1024));
    group.bench_function("jet", |b| {
        b.iter(|| {
            for &xi in &xi {
                black_box(facet.jet(black_box(xi)));
            }
        });
    });
    group.bench_function("jet of the same NURBS patch", |b| {
        b.iter(|| {
            for &xi in &xi {
                black_box(patch.jet(black_box(xi)));
            }
        });
    });
    group.finish();
}

fn queries<S: Surface>(c: &mut Criterion, name: &str, set: &PatchSet<S>, warm: bool) {
    let points: Vec<Vec3> = (0..1000)
        .map(spread)
        .map(|[a, b, z]| Vec3::new(10.0 * a, 10.0 * b, 3.0 * z - 1.5))
        .collect();
    let hints: Vec<_> = points
        .iter()
        .map(|q| set.project(&(q + Vec3::x() * 0.005), None, f64::INFINITY))
        .map(|foot| foot.filter(|_| warm).map(|foot| foot.hint()))
        .collect();
    let mut group = c.benchmark_group("project");
    group.throughput(Throughput::Elements(1000));
    group.sample_size(10);
    group.bench_function(
        format!("{name}, {}", if warm { "warm" } else { "cold" }),
        |b| {
            b.iter(|| {
                (points.iter().zip(&hints))
                    .filter_map(|(q, hint)| set.project(q, *hint, f64::INFINITY))
                    .count()
            });
        },
    );
    group.finish();
}

/// Builds a set, says how long it took and what it holds.
fn built<S: Surface>(name: &str, facets: Vec<S>) -> PatchSet<S> {
    let (count, before, start) = (facets.len(), HELD.load(Ordering::Relaxed), Instant::now());
    let set = PatchSet::new(facets, None).expect("a valid set");
    let held = HELD.load(Ordering::Relaxed) - before;
    println!(
        "{name}: {count} facets in {:.3} s, {} bytes per facet beside the {} of itself; {} joints",
        start.elapsed().as_secs_f64(),
        held / count,
        size_of::<S>(),
        set.edges().joints.len(),
    );
    set
}

fn facets(c: &mut Criterion) {
    let exact = facet_patch(sheet()).expect("a valid set");
    let one = bilinear_facets(&exact, Refinement::PerSpan(1)).expect("facets");
    jets(c, "bilinear", &one.mesh.surfaces().expect("facets")[0]);
    let one = biquadratic_facets(&exact, Refinement::PerSpan(1)).expect("facets");
    jets(c, "biquadratic", &one.mesh.surfaces().expect("facets")[0]);
    queries(c, "NURBS", &exact, false);
    queries(c, "NURBS", &exact, true);
    let mut sizes = vec![5, 10];
    if std::env::var("FACETS").is_ok_and(|n| n == "100000") {
        sizes.push(32);
    }
    for n in sizes {
        let start = Instant::now();
        let four = bilinear_facets(&exact, Refinement::PerSpan(n)).expect("facets");
        let nine = biquadratic_facets(&exact, Refinement::PerSpan(n)).expect("facets");
        println!(
            "made in {:.3} s: deviations {:.1e} and {:.1e}",
            start.elapsed().as_secs_f64(),
            four.deviation,
            nine.deviation
        );
        let count = four.mesh.facets.len();
        let set = built("bilinear", four.mesh.surfaces().expect("facets"));
        queries(c, &format!("{count} bilinear"), &set, false);
        queries(c, &format!("{count} bilinear"), &set, true);
        let set = built("biquadratic", nine.mesh.surfaces().expect("facets"));
        queries(c, &format!("{count} biquadratic"), &set, false);
        queries(c, &format!("{count} biquadratic"), &set, true);
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(700));
    targets = facets
}
criterion_main!(benches);
