//! Closest points against truck 0.5 and monstertruck on the same queries in the same run: the share of wrong answers
//! (farther away than known by more than 1e-9 of the size, or none), then microseconds per query on one thread, the
//! best of several passes.
//!
//! `COVACT_BENCH_RIVALS=0` leaves the others out; an argument keeps the sets whose name contains it.

#[path = "../tests/projection/common/mod.rs"]
mod projection_common;

use std::hint::black_box;
use std::time::{Duration, Instant};

use covact_geometry::{Hint, NurbsPatch, PatchSet, Vec3};
use projection_common::sets::{self, QuerySet};

/// Queries of a set, and those of them that the slower codes get.
const COUNT: usize = 2000;
const FEW: usize = 60;

/// Microseconds per query: the best pass of those that fit into half a second, at least three.
fn time(count: usize, mut pass: impl FnMut()) -> f64 {
    let start = Instant::now();
    let mut best = f64::INFINITY;
    let mut passes = 0;
    while passes < 3 || start.elapsed() < Duration::from_millis(500) {
        let start = Instant::now();
        pass();
        best = best.min(start.elapsed().as_secs_f64());
        passes += 1;
    }
    1e6 * best / count as f64
}

/// Per cent of answers that are too far, infinite ones among them.
fn wrong(set: &PatchSet, truths: &[(Vec3, f64)], answer: impl Fn(&Vec3) -> f64) -> f64 {
    let limit = 1e-9 * set.size();
    let bad = |&&(q, truth): &&(Vec3, f64)| {
        let distance = answer(&q);
        distance > truth + limit || distance.is_nan()
    };
    100.0 * truths.iter().filter(bad).count() as f64 / truths.len() as f64
}

/// Distance that another code's parameters give on one of the patches, the nearest of all patches; infinite where it has none.
fn nearest(patches: &[NurbsPatch], q: &Vec3, find: impl Fn(usize) -> Option<(f64, f64)>) -> f64 {
    let one = |k: usize| {
        let (u, v) = find(k)?;
        let [[a, b], [c, d]] = patches[k].domain();
        let inside = u >= a && u <= b && v >= c && v <= d;
        inside.then(|| (patches[k].point([u, v]) - q).norm())
    };
    (0..patches.len())
        .filter_map(one)
        .fold(f64::INFINITY, f64::min)
}

fn line(name: &str, code: &str, wrong: f64, micros: f64) {
    println!("{name:<22} {code:<14} {wrong:>8.2} {micros:>12.3}");
}

/// Whether a set is asked for.
fn wanted(name: &str) -> bool {
    std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .all(|a| name.contains(&a))
}

fn ours(name: &str, set: &PatchSet, truths: &[(Vec3, f64)], hints: Option<&[Hint]>, reach: f64) {
    if !wanted(name) {
        return;
    }
    let hint = |k: usize| hints.map(|h| h[k]);
    let mut k = 0;
    let share = {
        let next = std::cell::Cell::new(0);
        wrong(set, truths, |q| {
            let k = next.replace(next.get() + 1);
            set.project(q, hint(k), f64::INFINITY)
                .map_or(f64::INFINITY, |f| f.distance)
        })
    };
    let micros = time(truths.len(), || {
        for (q, _) in truths {
            black_box(set.project(q, hint(k % truths.len()), reach));
            k += 1;
        }
    });
    line(name, "covact", share, micros);
}

fn rivals(name: &str, set: &PatchSet, truths: &[(Vec3, f64)]) {
    use monstertruck_geometry::prelude as monster;
    use truck_geometry::prelude as truck;
    if !wanted(name)
        || std::env::var("COVACT_BENCH_RIVALS").is_ok_and(|v| v == "0")
        || set.patches().len() > 10
    {
        return;
    }
    let few = &truths[..FEW.min(truths.len())];
    let theirs: Vec<_> = set.patches().iter().map(NurbsPatch::to_truck).collect();
    let by_truck = |q: &Vec3| {
        use truck::SearchNearestParameter;
        nearest(set.patches(), q, |k| {
            theirs[k].search_nearest_parameter(truck::Point3::new(q.x, q.y, q.z), None, 100)
        })
    };
    let share = wrong(set, few, by_truck);
    line(name, "truck", share, time_all(few, by_truck));
    let theirs: Vec<_> = set.patches().iter().map(to_monster).collect();
    let by_monster = |q: &Vec3| {
        use monster::SearchNearestParameter;
        nearest(set.patches(), q, |k| {
            theirs[k].search_nearest_parameter(monster::Point3::new(q.x, q.y, q.z), None, 100)
        })
    };
    let share = wrong(set, few, by_monster);
    line(name, "monstertruck", share, time_all(few, by_monster));
}

fn time_all(few: &[(Vec3, f64)], answer: impl Fn(&Vec3) -> f64) -> f64 {
    time(few.len(), || {
        for (q, _) in few {
            black_box(answer(q));
        }
    })
}

fn to_monster(
    patch: &NurbsPatch,
) -> monstertruck_geometry::prelude::NurbsSurface<monstertruck_geometry::prelude::Vector4> {
    use monstertruck_geometry::prelude::{BsplineSurface, KnotVector, NurbsSurface, Vector4};
    let [columns, rows] = patch.counts();
    let points = patch.homogeneous();
    let net = (0..columns)
        .map(|i| {
            (0..rows)
                .map(|j| Vector4::from(points[i + columns * j]))
                .collect()
        })
        .collect();
    let knots = |dir: usize| KnotVector::from(patch.knots(dir).to_vec());
    NurbsSurface::new(BsplineSurface::new((knots(0), knots(1)), net))
}

fn both(queries: &QuerySet) {
    ours(
        queries.name,
        &queries.set,
        &queries.truths,
        None,
        f64::INFINITY,
    );
    rivals(queries.name, &queries.set, &queries.truths);
}

/// Feet of the queries moved by a hundredth of a span: where the query was one step ago.
fn hints(set: &PatchSet, truths: &[(Vec3, f64)]) -> Vec<Hint> {
    truths
        .iter()
        .filter_map(|(q, _)| set.project(q, None, f64::INFINITY))
        .map(|foot| {
            let patch = &set.patches()[foot.patch as usize];
            let mut hint = foot.hint();
            for k in 0..2 {
                let spans = patch.spans(k);
                let [first, last] = patch.domain()[k];
                let step = 0.01 * (last - first) / spans.len() as f64;
                hint.xi[k] = (hint.xi[k] + step).min(last);
            }
            hint
        })
        .collect()
}

fn main() {
    println!(
        "{:<22} {:<14} {:>8} {:>12}",
        "set", "code", "wrong %", "us/query"
    );
    let all = f64::INFINITY;
    if wanted("near") || wanted("near, warm") || wanted("contact, warm") || wanted("contact, open")
    {
        let near = sets::near(COUNT, 3, 20, false);
        both(&near);
        let hint = hints(&near.set, &near.truths);
        ours("near, warm", &near.set, &near.truths, Some(&hint), all);
        let close = sets::above(&near.set, COUNT, 0.01, 3);
        let hint = hints(&near.set, &close);
        ours("contact, warm", &near.set, &close, Some(&hint), all);
        let open: Vec<(Vec3, f64)> = close
            .iter()
            .map(|(q, _)| (q + Vec3::z() * 0.7, f64::INFINITY))
            .collect();
        ours("contact, open", &near.set, &open, None, 0.05);
    }
    type Made = (&'static str, fn() -> QuerySet);
    let made: [Made; 9] = [
        ("edge and corner", || sets::edge_and_corner(COUNT)),
        ("far", || sets::far(COUNT)),
        ("focal", || sets::focal(COUNT, false)),
        ("sphere, near", || sets::sphere_near(COUNT, false)),
        ("sphere, pole", || sets::sphere_pole(COUNT, false)),
        ("sphere, centre", || sets::sphere_centre(200, false)),
        ("C0 crease", || sets::crease(COUNT)),
        ("six patches", || sets::sphere_near(COUNT, true)),
        ("six patches, centre", || sets::sphere_centre(200, true)),
    ];
    for (name, make) in made {
        if wanted(name) {
            both(&make());
        }
    }
    if wanted("six patches, warm") {
        let six = sets::sphere_near(COUNT, true);
        let hint = hints(&six.set, &six.truths);
        ours("six patches, warm", &six.set, &six.truths, Some(&hint), all);
    }
    if wanted("1024 patches") || wanted("1024 patches, warm") {
        let many = sets::patchwork(COUNT, 32);
        ours("1024 patches", &many.set, &many.truths, None, all);
        let hint = hints(&many.set, &many.truths);
        ours(
            "1024 patches, warm",
            &many.set,
            &many.truths,
            Some(&hint),
            all,
        );
    }
}
