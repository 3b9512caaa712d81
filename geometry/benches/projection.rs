//! Time of closest point queries on a bumpy sheet (whole and cut into 1024 patches), on spheres of one and of six
//! patches, and as contact asks them: points at a small depth with a hint, and open points with a short reach.

use covact_geometry::primitives::{sphere, sphere_without_poles};
use covact_geometry::{Hint, NurbsPatch, PatchSet, Vec3};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};

/// Bicubic graph over a square, `n` control points in each direction, the same bumps per control point.
fn bumpy(n: u32) -> NurbsPatch {
    let spans = n - 3;
    let mut knots = vec![0.0; 3];
    knots.extend((0..=spans).map(|k| f64::from(k) / f64::from(spans)));
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
    NurbsPatch::new(
        [3; 2],
        [knots.clone(), knots],
        [n as usize; 2],
        &points,
        None,
    )
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

const COUNT: u32 = 1000;

/// A query: point, hint, reach.
type Query = (Vec3, Option<Hint>, f64);

fn measure(group: &mut BenchmarkGroup<WallTime>, name: &str, set: &PatchSet, queries: &[Query]) {
    group.bench_function(name, |b| {
        b.iter(|| {
            queries
                .iter()
                .filter_map(|(q, hint, reach)| set.project(q, *hint, *reach))
                .count()
        });
    });
}

/// Points at most `most` off the surface, with parameters a little off their foot.
fn near(set: &PatchSet, most: f64, offset: f64) -> Vec<Query> {
    let patches = set.patches();
    (0..COUNT)
        .map(|k| {
            let u = spread(k);
            let number = (k as usize * 7919) % patches.len();
            let domain = patches[number].domain();
            let xi = [0, 1].map(|k| domain[k][0] + u[k] * (domain[k][1] - domain[k][0]));
            let jet = patches[number].jet(xi);
            let n = jet.rho_i[0].cross(&jet.rho_i[1]).normalize();
            let xi = [0, 1].map(|k| (xi[k] + offset).min(domain[k][1]));
            let patch = number as u32;
            (
                jet.rho + n * (2.0 * most * (u.z - 0.5)),
                Some(Hint { patch, xi }),
                f64::INFINITY,
            )
        })
        .collect()
}

fn cold(queries: Vec<Query>) -> Vec<Query> {
    queries
        .into_iter()
        .map(|(q, _, reach)| (q, None, reach))
        .collect()
}

fn around(centre: f64, radius: f64) -> Vec<Query> {
    (0..COUNT)
        .map(|k| {
            let d = spread(k) - Vec3::from_element(0.5);
            let q = if radius > 0.0 {
                d.normalize() * radius
            } else {
                d * centre
            };
            (q, None, f64::INFINITY)
        })
        .collect()
}

fn queries(c: &mut Criterion) {
    let sheet = PatchSet::new(vec![bumpy(20)], None).expect("a valid set");
    let one = vec![sphere(1.0, Vec3::zeros(), Vec3::z()).expect("a valid sphere")];
    let ball = PatchSet::new(one, None).expect("a valid set");
    let six = sphere_without_poles(1.0, Vec3::zeros(), Vec3::z()).expect("a valid sphere");
    let six = PatchSet::new(six.to_vec(), None).expect("a valid set");
    // 32 x 32 patches of 2 x 2 spans each.
    let whole = bumpy(67);
    let cut = |k: u32| f64::from(k) / 32.0;
    let many: Vec<NurbsPatch> = (0..32 * 32)
        .map(|k| {
            let (i, j) = (k % 32, k / 32);
            whole
                .with_domain([[cut(i), cut(i + 1)], [cut(j), cut(j + 1)]])
                .expect("a part of the domain")
        })
        .collect();
    let many = PatchSet::new(many, None).expect("a valid set");
    let mut group = c.benchmark_group("project");
    group.throughput(Throughput::Elements(u64::from(COUNT)));
    measure(
        &mut group,
        "near, cold",
        &sheet,
        &cold(near(&sheet, 0.4, 0.0)),
    );
    measure(
        &mut group,
        "near, warm",
        &sheet,
        &near(&sheet, 0.4, 0.01 / 17.0),
    );
    let close = near(&sheet, 0.01, 0.01 / 17.0);
    measure(&mut group, "contact, warm", &sheet, &close);
    let open: Vec<Query> = close
        .iter()
        .map(|(q, hint, _)| (q + Vec3::z() * 0.7, *hint, 0.05))
        .collect();
    measure(&mut group, "contact, open, cold", &sheet, &cold(open));
    measure(
        &mut group,
        "far",
        &sheet,
        &around(0.0, 1000.0 * sheet.size()),
    );
    let beyond: Vec<Query> = (0..COUNT)
        .map(|k| {
            let u = spread(k);
            let q = Vec3::new(
                if k % 2 == 0 { -0.5 * u.x } else { 10.0 * u.x },
                -0.5 * u.y,
                u.z - 0.5,
            );
            (q, None, f64::INFINITY)
        })
        .collect();
    measure(&mut group, "edge and corner", &sheet, &beyond);
    measure(&mut group, "sphere, near", &ball, &around(0.0, 1.2));
    measure(&mut group, "sphere, centre", &ball, &around(1e-6, 0.0));
    measure(&mut group, "six patches, near", &six, &around(0.0, 1.2));
    measure(&mut group, "six patches, inside", &six, &around(0.0, 0.7));
    let warm: Vec<Query> = around(0.0, 1.01)
        .into_iter()
        .filter_map(|(q, _, reach)| {
            let foot = six.project(&q, None, reach)?;
            Some((q * 1.001 + Vec3::x() * 0.001, Some(foot.hint()), reach))
        })
        .collect();
    measure(&mut group, "six patches, warm", &six, &warm);
    measure(&mut group, "six patches, centre", &six, &around(1e-6, 0.0));
    measure(
        &mut group,
        "1024 patches, cold",
        &many,
        &cold(near(&many, 0.4, 0.0)),
    );
    measure(
        &mut group,
        "1024 patches, warm",
        &many,
        &near(&many, 0.4, 0.01 / 64.0),
    );
    group.finish();
}

criterion_group!(benches, queries);
criterion_main!(benches);
