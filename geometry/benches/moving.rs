//! Facets that move: time per facet of an update, and points per second of the closest point, cold and warm (from the foot
//! before the last motion), near the facets and far; for every degree, on one thread.

#[path = "../tests/moving/common.rs"]
mod moving_common;

use std::hint::black_box;
use std::time::{Duration, Instant};

use covact_geometry::{Hint, MovingFacets, Vec3};
use moving_common::*;

/// Items of a batch, which takes well below a millisecond: the best of its passes is hardly ever interrupted.
const BATCH: usize = 100;

/// Seconds for all batches, of each the best pass of those that fit into its time, at least five.
fn time(batches: usize, mut pass: impl FnMut(usize)) -> f64 {
    let one = |batch: usize| {
        let start = Instant::now();
        let mut best = f64::INFINITY;
        let mut passes = 0;
        while passes < 5 || start.elapsed() < Duration::from_millis(500) / batches as u32 {
            let start = Instant::now();
            pass(batch);
            best = best.min(start.elapsed().as_secs_f64());
            passes += 1;
        }
        best
    };
    (0..batches).map(one).sum()
}

fn main() {
    const POINTS: usize = 5_000;
    println!(
        "{:<12} {:>7} {:>10} {:>10} {:>12} {:>12} {:>12} {:>12}",
        "facets",
        "count",
        "build ms",
        "update ns",
        "cold near/s",
        "warm near/s",
        "cold far/s",
        "warm far/s"
    );
    let one = torus([160, 64], 1);
    let two = torus([80, 32], 2);
    type Make = fn(&Mesh) -> MovingFacets;
    let sets: [(&str, &Mesh, Make); 3] = [
        ("bilinear", &one, Mesh::faceted),
        ("biquadratic", &two, Mesh::faceted),
        ("smooth", &one, Mesh::smooth),
    ];
    for (name, mesh, make) in sets {
        let start = Instant::now();
        let mut set = make(mesh);
        let before = mesh.deformed(0.1, 0.0, 1);
        set.update(|k| before[k as usize]);
        let build = start.elapsed().as_secs_f64();
        // A small step on from there.
        let moved: Vec<Vec3> = (before.iter())
            .map(|x| x + Vec3::new(0.004 * x.y, -0.003 * x.z, 0.003))
            .collect();
        let update = time(1, |_| set.update(|k| moved[k as usize]));
        let mut line = format!(
            "{name:<12} {:>7} {:>10.1} {:>10.1}",
            set.len(),
            1e3 * build,
            1e9 * update / set.len() as f64
        );
        for far in [0.01, 0.3] {
            let mut random = Random(5);
            set.update(|k| before[k as usize]);
            let queries: Vec<Vec3> = (0..POINTS)
                .map(|_| {
                    let facet = (random.next() * set.len() as f64) as u32;
                    let xi = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
                    set.jet(facet, xi).rho + random.vector(far)
                })
                .collect();
            let hints: Vec<Option<Hint>> = (queries.iter())
                .map(|q| Some(set.project(q, None, f64::INFINITY, |_| true)?.hint()))
                .collect();
            set.update(|k| moved[k as usize]);
            for warm in [false, true] {
                let seconds = time(POINTS / BATCH, |batch| {
                    let range = batch * BATCH..(batch + 1) * BATCH;
                    for (q, hint) in queries[range.clone()].iter().zip(&hints[range]) {
                        let hint = hint.filter(|_| warm);
                        black_box(set.project(q, hint, f64::INFINITY, |_| true));
                    }
                });
                line += &format!(" {:>12.0}", POINTS as f64 / seconds);
            }
        }
        println!("{line}");
    }
}
