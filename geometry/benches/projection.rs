//! Time of closest point queries: near (cold and warm), far away, centre of a sphere.

use covact_geometry::primitives::sphere;
use covact_geometry::{Hint, NurbsPatch, PatchSet, Vec3};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn bumpy() -> NurbsPatch {
    let n = 20;
    let mut knots = vec![0.0; 3];
    knots.extend((0..=17).map(|k| f64::from(k) / 17.0));
    knots.extend([1.0; 3]);
    let points: Vec<Vec3> = (0..n * n)
        .map(|k| {
            let (x, y) = (
                f64::from(k % n) * 10.0 / 19.0,
                f64::from(k / n) * 10.0 / 19.0,
            );
            Vec3::new(x, y, (0.9 * x).sin() * (0.7 * y).cos())
        })
        .collect();
    NurbsPatch::new([3; 2], [knots.clone(), knots], [20; 2], &points, None)
        .expect("a valid bicubic patch")
}

/// Points in [0, 1)^3 that fill it evenly (additive recurrence).
fn spread(k: u32) -> Vec3 {
    let one = |a: f64| (0.5 + a * f64::from(k)).fract();
    Vec3::new(
        one(0.819_172_513_396),
        one(0.671_043_606_704),
        one(0.549_700_477_901),
    )
}

fn queries(c: &mut Criterion) {
    const COUNT: u32 = 1000;
    let sheet = PatchSet::new(vec![bumpy()], None).expect("a valid set");
    let ball = sphere(1.0, Vec3::zeros(), Vec3::z()).expect("a valid sphere");
    let ball = PatchSet::new(vec![ball], None).expect("a valid set");
    let patch = &sheet.patches()[0];
    let near: Vec<(Vec3, [f64; 2])> = (0..COUNT)
        .map(|k| {
            let u = spread(k);
            let jet = patch.jet([u.x, u.y]);
            let n = jet.rho_i[0].cross(&jet.rho_i[1]).normalize();
            (jet.rho + n * (0.8 * (u.z - 0.5)), [u.x, u.y])
        })
        .collect();
    let far: Vec<Vec3> = (0..COUNT)
        .map(|k| (spread(k) - Vec3::from_element(0.5)).normalize() * (1000.0 * sheet.size()))
        .collect();
    let mut group = c.benchmark_group("project");
    group.throughput(Throughput::Elements(u64::from(COUNT)));
    group.bench_function("near, cold", |b| {
        b.iter(|| {
            near.iter()
                .filter_map(|(q, _)| sheet.project(q, None, f64::INFINITY))
                .count()
        });
    });
    group.bench_function("near, warm", |b| {
        b.iter(|| {
            let warm = |(q, xi): &(Vec3, [f64; 2])| {
                let xi = xi.map(|x| (x + 0.01 / 17.0).min(1.0));
                sheet.project(q, Some(Hint { patch: 0, xi }), f64::INFINITY)
            };
            near.iter().filter_map(warm).count()
        });
    });
    group.bench_function("far", |b| {
        b.iter(|| {
            far.iter()
                .filter_map(|q| sheet.project(q, None, f64::INFINITY))
                .count()
        });
    });
    group.bench_function("sphere, near", |b| {
        let near = |k| (spread(k) - Vec3::from_element(0.5)).normalize() * 1.2;
        b.iter(|| {
            (0..COUNT)
                .filter_map(|k| ball.project(&near(k), None, f64::INFINITY))
                .count()
        });
    });
    group.bench_function("sphere, centre", |b| {
        let near = |k| (spread(k) - Vec3::from_element(0.5)) * 1e-6;
        b.iter(|| {
            (0..COUNT)
                .filter_map(|k| ball.project(&near(k), None, f64::INFINITY))
                .count()
        });
    });
    group.finish();
}

criterion_group!(benches, queries);
criterion_main!(benches);
