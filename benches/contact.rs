//! Time per slave point: the whole way from position to force and tangent, and the kernel alone; then a table of both
//! with ratios.
use covact::contact::friction::history::PointHistory;
use covact::contact::friction::law::Coulomb;
use covact::contact::friction::rigid::Friction;
use covact::contact::kernel::{Normal, normal_tangent, normal_tangent_rigid};
use covact::contact::law::{NormalLaw, Penalty};
use covact::contact::published::{self, Parts};
use covact::contact::rigid::{Exact, Overhang, RigidMaster, RigidTangent};
use covact_geometry::{Frame, Hint, PatchSet, Vec3, primitives};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Isometry3;
use std::hint::black_box;
use std::time::Instant;

const RADIUS: f64 = 25.0;
const COUNT: usize = 512;
const LAW: Penalty = Penalty { eps_n: 6e4 };

/// A slave point and where its last search ended, a hundredth of the radius away.
type Query = (Vec3, Option<Hint>);

/// A name and what is timed, for `COUNT` points.
type Workload<'a> = (&'static str, Box<dyn Fn() + 'a>);

/// The ball as one patch with poles and as six without.
fn balls() -> Option<[PatchSet; 2]> {
    let one = primitives::sphere(RADIUS, Vec3::zeros(), Vec3::y()).ok()?;
    let six = primitives::sphere_without_poles(RADIUS, Vec3::zeros(), Vec3::y()).ok()?;
    let mut one = PatchSet::new(vec![one], None).ok()?;
    let mut six = PatchSet::new(six.to_vec(), None).ok()?;
    one.set_side_as_given(false);
    six.set_side_as_given(false);
    Some([one, six])
}

/// Points at a height above the lower half of the ball, away from poles, evenly spread.
fn queries(set: &PatchSet, height: f64) -> Vec<Query> {
    let direction = |k: usize, shift: f64| {
        let (i, j) = ((k % 32) as f64 / 32.0, (k / 32) as f64 / 16.0);
        let (longitude, latitude) = (2.0 * i + 0.6 + shift, 1.6 * j - 0.8 + shift);
        let c = latitude.cos();
        Vec3::new(c * longitude.cos(), latitude.sin(), -c * longitude.sin())
    };
    (0..COUNT)
        .map(|k| {
            let before = direction(k, 0.01) * (RADIUS + height);
            let hint = set.project(&before, None, f64::INFINITY).map(|f| f.hint());
            (direction(k, 0.0) * (RADIUS + height), hint)
        })
        .collect()
}

fn touch_all<T: RigidTangent>(master: &RigidMaster, queries: &[Query], tangent: &T) -> usize {
    let touch = |(x, hint): &Query| {
        let mut hint = *hint;
        let touch = master.touch(
            black_box(x),
            (&mut hint, Overhang::default()),
            &LAW,
            tangent,
        );
        black_box(touch).is_ok_and(|t| t.is_some())
    };
    queries.iter().filter(|q| touch(q)).count()
}

/// Points with friction that have moved by `chord` since the base of their slip was set; how many slide.
fn slide_all(master: &RigidMaster, queries: &[Query], chord: f64) -> usize {
    let friction = Friction {
        law: Coulomb { mu: 0.3 },
        eps_t: LAW.eps_n,
    };
    let slides = |(x, hint): &Query| {
        let mut hint = *hint;
        let history = PointHistory {
            base: x + Vec3::new(0.0, chord, 0.0),
            ..PointHistory::default()
        };
        let law = history.law(LAW, 0.0);
        let touch = master.touch_with_friction(
            black_box(x),
            (&mut hint, Overhang::default()),
            &law,
            &friction,
            &history,
        );
        black_box(touch).is_ok_and(|t| t.is_some_and(|t| t.traction.slip.slides))
    };
    queries.iter().filter(|q| slides(q)).count()
}

/// Named workloads of `COUNT` points each.
fn workloads([set, six]: &[PatchSet; 2]) -> Vec<Workload<'_>> {
    let [master, six_master] = [set, six].map(|surface| RigidMaster {
        surface,
        pose: Isometry3::identity(),
        depth: 0.1 * RADIUS,
        keep: false,
    });
    let six_closed = queries(six, -0.01);
    let (closed, near, far) = (
        queries(set, -0.01),
        queries(set, 0.01 * RADIUS),
        queries(set, 4.0 * RADIUS),
    );
    let cold: Vec<Query> = closed.iter().map(|q| (q.0, None)).collect();
    let frames: Vec<(Frame, f64, Normal)> = (closed.iter())
        .filter_map(|(x, hint)| {
            let foot = set.project(x, *hint, f64::INFINITY)?;
            let frame = Frame::new(&foot.jet, foot.side)?;
            let xi3 = foot.signed_distance;
            Some((frame, xi3, LAW.response(xi3)))
        })
        .collect();
    assert_eq!(frames.len(), COUNT);
    assert_eq!(touch_all(&master, &closed, &Exact), COUNT);
    assert_eq!(touch_all(&master, &near, &Exact), 0);
    assert_eq!(touch_all(&master, &far, &Exact), 0);
    let jets: Vec<_> = (closed.iter())
        .filter_map(|(x, hint)| Some(set.project(x, *hint, f64::INFINITY)?.jet))
        .collect();
    // .01 deep: the limit is reached at a slip of .003.
    assert_eq!(slide_all(&master, &closed, 1e-4), 0);
    let slid = slide_all(&master, &closed, 0.1);
    assert!(slid > COUNT / 2, "{slid}");
    let (sixth, seventh) = (master.clone(), master.clone());
    let (sticking, sliding) = (closed.clone(), closed.clone());
    let kernels = [frames.clone(), frames.clone(), frames.clone(), frames];
    let [k1, k2, k3, k4] = kernels;
    let other = master.clone();
    let (third, fourth, fifth) = (master.clone(), master.clone(), master.clone());
    let again = closed.clone();
    vec![
        (
            "point/closed, exact",
            Box::new(move || _ = black_box(touch_all(&master, &closed, &Exact))),
        ),
        (
            "point/closed, published",
            Box::new(move || _ = black_box(touch_all(&other, &again, &Parts::ALL))),
        ),
        (
            "point/closed, no hint",
            Box::new(move || _ = black_box(touch_all(&third, &cold, &Exact))),
        ),
        (
            "point/closed, six biquartic",
            Box::new(move || _ = black_box(touch_all(&six_master, &six_closed, &Exact))),
        ),
        (
            "point/closed, stick",
            Box::new(move || _ = black_box(slide_all(&sixth, &sticking, 1e-4))),
        ),
        (
            "point/closed, slip",
            Box::new(move || _ = black_box(slide_all(&seventh, &sliding, 0.1))),
        ),
        (
            "point/open, near",
            Box::new(move || _ = black_box(touch_all(&fourth, &near, &Exact))),
        ),
        (
            "point/open, out of reach",
            Box::new(move || _ = black_box(touch_all(&fifth, &far, &Exact))),
        ),
        (
            "kernel/frame",
            Box::new(move || {
                jets.iter().for_each(|j| {
                    black_box(Frame::new(black_box(j), 1.0));
                })
            }),
        ),
        (
            "kernel/3x3 exact",
            Box::new(move || {
                k1.iter().for_each(|(f, xi3, n)| {
                    black_box(normal_tangent_rigid(black_box(f), *xi3, n));
                })
            }),
        ),
        (
            "kernel/3x3 published",
            Box::new(move || {
                k2.iter().for_each(|(f, _, n)| {
                    black_box(published::normal_tangent_rigid(black_box(f), n, Parts::ALL));
                })
            }),
        ),
        (
            "kernel/9x9 exact",
            Box::new(move || {
                k3.iter().for_each(|(f, xi3, n)| {
                    black_box(normal_tangent(black_box(f), *xi3, n));
                })
            }),
        ),
        (
            "kernel/9x9 published",
            Box::new(move || {
                k4.iter().for_each(|(f, _, n)| {
                    black_box(published::normal_tangent(black_box(f), n, Parts::ALL));
                })
            }),
        ),
    ]
}

fn contact(c: &mut Criterion) {
    let Some(sets) = balls() else { return };
    let workloads = workloads(&sets);
    let mut group = c.benchmark_group("contact");
    group.throughput(Throughput::Elements(COUNT as u64));
    for (name, work) in &workloads {
        group.bench_function(*name, |b| b.iter(work));
    }
    group.finish();
    table(&workloads);
}

/// Nanoseconds per point, and as multiples of the first of their kind. The workloads take turns and the fastest round
/// of each counts, so that other load on the machine falls on all alike.
fn table(workloads: &[Workload]) {
    let mut best = vec![f64::INFINITY; workloads.len()];
    for _ in 0..51 {
        for ((_, work), best) in workloads.iter().zip(&mut best) {
            let start = Instant::now();
            work();
            *best = best.min(start.elapsed().as_nanos() as f64 / COUNT as f64);
        }
    }
    println!("\n{:<28} {:>9} {:>9}", "", "ns/point", "ratio");
    let mut first = ("", 1.0);
    for ((name, _), time) in workloads.iter().zip(best) {
        let kind = name.split('/').next().unwrap_or_default();
        if first.0 != kind {
            first = (kind, time);
        }
        println!("{name:<28} {time:>9.1} {:>9.2}", time / first.1);
    }
}

criterion_group!(benches, contact);
criterion_main!(benches);
