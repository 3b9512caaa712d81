//! Bounded work: how many evaluations of the surface a query takes, counted rather than timed.

use std::cell::Cell;

use crate::common::sets::{self, QuerySet};
use crate::common::{queries, wild};
use covact_geometry::{BezierPiece, Jet, NurbsPatch, PatchSet, Status, Surface};
use rayon::prelude::*;

thread_local! {
    static JETS: Cell<usize> = const { Cell::new(0) };
}

/// A patch that counts how often it is evaluated on this thread.
#[derive(Debug, Clone)]
struct Counted(NurbsPatch);

impl Surface for Counted {
    fn domain(&self) -> [[f64; 2]; 2] {
        self.0.domain()
    }

    fn spans(&self, dir: usize) -> Vec<[f64; 2]> {
        self.0.spans(dir)
    }

    fn find_span(&self, xi: [f64; 2]) -> [usize; 2] {
        self.0.find_span(xi)
    }

    fn jet_in_span(&self, span: [usize; 2], xi: [f64; 2]) -> Jet {
        JETS.with(|n| n.set(n.get() + 1));
        self.0.jet_in_span(span, xi)
    }

    fn bezier_pieces(&self) -> Vec<BezierPiece> {
        Surface::bezier_pieces(&self.0)
    }

    fn crease_knots(&self, dir: usize) -> Vec<f64> {
        self.0.crease_knots(dir)
    }

    fn sharp_knots(&self, dir: usize, angle: f64) -> Vec<f64> {
        self.0.sharp_knots(dir, angle)
    }
}

/// Mean and most evaluations of a query, without hint and with the foot of the query as the hint.
fn counts(queries: &QuerySet) -> [(f64, usize); 2] {
    let patches = queries.set.patches().iter().cloned().map(Counted).collect();
    let set = PatchSet::new(patches, None).unwrap();
    let mut sums = [0; 2];
    let mut most = [0; 2];
    for (q, _) in &queries.truths {
        let mut hint = None;
        for k in 0..2 {
            let before = JETS.get();
            hint = set.project(q, hint, f64::INFINITY).map(|f| f.hint());
            let used = JETS.get() - before;
            sums[k] += used;
            most[k] = most[k].max(used);
        }
    }
    [0, 1].map(|k| (sums[k] as f64 / queries.truths.len() as f64, most[k]))
}

#[test]
fn evaluations_are_few_and_bounded() {
    // Limits on the mean and on every query, a few times what is counted: 5 near, 1.5 warm, 250 at a pole.
    let n = queries(300);
    for (queries, mean, most) in [
        (sets::near(n, 3, 20, false), 20.0, 500),
        (sets::edge_and_corner(n), 20.0, 500),
        (sets::far(n), 20.0, 500),
        (sets::focal(n, false), 200.0, 10000),
        (sets::sphere_near(n, false), 100.0, 2000),
        (sets::sphere_pole(n, false), 1000.0, 10000),
        (sets::sphere_centre(n, false), 1000.0, 10000),
        (sets::crease(n), 50.0, 1000),
        (sets::sphere_near(n, true), 200.0, 2000),
        (sets::sphere_centre(n, true), 1000.0, 10000),
        (sets::patchwork(n, 10), 200.0, 2000),
    ] {
        let [cold, warm] = counts(&queries);
        eprintln!(
            "{}: cold {:.2} (at most {}), from the foot {:.2} (at most {})",
            queries.name, cold.0, cold.1, warm.0, warm.1
        );
        assert!(cold.0 >= 1.0 && cold.0 <= mean && warm.0 <= mean);
        assert!(cold.1 <= most && warm.1 <= most);
    }
}

/// What the queries on random patches gave.
#[derive(Debug, Default, Clone, Copy)]
struct Outcome {
    /// Farther away than the reference by more than 1e-9 of the size, and said to be found.
    wrong: usize,
    not_converged: usize,
    non_unique: usize,
    /// Evaluations in all and of the worst query.
    sum: usize,
    most: usize,
}

impl Outcome {
    fn and(self, other: Outcome) -> Outcome {
        Outcome {
            wrong: self.wrong + other.wrong,
            not_converged: self.not_converged + other.not_converged,
            non_unique: self.non_unique + other.non_unique,
            sum: self.sum + other.sum,
            most: self.most.max(other.most),
        }
    }
}

/// Queries on random patches with weights over the given orders of magnitude, against dense sampling.
fn on_wild_patches(patches: u64, count: usize, orders: f64) -> Outcome {
    (0..patches)
        .into_par_iter()
        .map(|seed| {
            let patch = wild::patch(seed, orders);
            let samples = wild::Samples::new(&patch);
            let set = PatchSet::new(vec![Counted(patch.clone())], None).unwrap();
            let mut out = Outcome::default();
            for q in wild::points(&patch, count, seed) {
                let before = JETS.get();
                let foot = set.project(&q, None, f64::INFINITY).unwrap();
                let used = JETS.get() - before;
                out.sum += used;
                out.most = out.most.max(used);
                let reference = samples.distance(&patch, &q);
                let too_far = foot.distance - reference;
                match foot.status {
                    Status::NotConverged => out.not_converged += 1,
                    _ if too_far > 1e-9 * set.size() => {
                        let degree = patch.degree();
                        eprintln!("patch {seed} {degree:?} {q:?}: {too_far:e} {foot:?}");
                        out.wrong += 1;
                    }
                    Status::NonUnique => out.non_unique += 1,
                    Status::Unique => {}
                }
            }
            out
        })
        .reduce(Outcome::default, Outcome::and)
}

#[test]
fn feet_on_random_patches() {
    // Few of the patches by default; COVACT_QUERIES=1000 takes as many as the counts below were taken from.
    let patches = queries(50) as u64;
    for orders in [4.0, 0.0, 6.0] {
        let out = on_wild_patches(patches, 25, orders);
        eprintln!("weights over {orders} orders: {out:?}");
        assert_eq!(out.wrong, 0);
        // One in a thousand may be given up, and says so.
        assert!(out.not_converged as u64 <= 1 + patches * 25 / 1000);
    }
}
