//! Bounded work: how many evaluations of the surface a query takes, counted rather than timed.

mod projection_common;

use std::cell::Cell;

use covact_geometry::{BezierPiece, Jet, NurbsPatch, PatchSet, Surface};
use projection_common::queries;
use projection_common::sets::{self, QuerySet};

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
