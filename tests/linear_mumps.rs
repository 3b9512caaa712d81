//! Shipped scenes whose systems MUMPS solves: the histories are those of our own factorizations. Where there is no MUMPS, the tests
//! say that they were skipped.
#![cfg(feature = "mumps")]
use covact::output::Table;
use covact::run::{Options, RunError, Simulation};
use covact::scene;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The run of a shipped scene with this solver, on one thread; none where MUMPS is not there.
fn run(name: &str, solver: Value) -> Option<(Table, BTreeMap<String, u64>)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenes");
    let text = std::fs::read_to_string(format!("{folder}/{name}.json")).expect("a shipped scene");
    let mut scene: Value = serde_json::from_str(&text).expect("JSON");
    scene["solution"]["linear_solver"] = solver;
    scene["solution"]["threads"] = json!(1);
    scene["output"]["every"] = json!(0);
    let mut loaded = scene::parse(&scene.to_string(), name).expect("a scene");
    loaded.dir = folder.into();
    let mut simulation = match Simulation::new(loaded, Options::default()) {
        Err(RunError::Scene {
            message, pointer, ..
        }) if pointer == "/solution/linear_solver" => {
            assert!(
                message.starts_with("MUMPS: `libdmumps_seq.so` was not found"),
                "{message}"
            );
            println!("skipped: {message}");
            return None;
        }
        simulation => simulation.expect("a model"),
    };
    while simulation.step().expect("an equilibrium").is_some() {}
    let summary = simulation.summary();
    assert!(
        !summary.warnings.iter().any(|w| w.contains("MUMPS")),
        "{:?}",
        summary.warnings
    );
    Some((simulation.history().clone(), summary.factorizations))
}

/// The same steps and iterations, and all results of a kind within 1e-8 of the largest of them.
fn same(name: &str, a: &Table, b: &Table) {
    assert_eq!(a.columns, b.columns);
    assert_eq!(a.rows.len(), b.rows.len(), "{name}: steps");
    assert!(a.rows.len() > 4, "{name}");
    // Balances of forces are forces.
    let kind = |column: &str| {
        column
            .split(['.', '_'])
            .next()
            .unwrap_or_default()
            .to_owned()
    };
    let mut largest: BTreeMap<String, f64> = BTreeMap::new();
    for (i, column) in b.columns.iter().enumerate() {
        let size = largest.entry(kind(column)).or_default();
        *size = b.rows.iter().fold(*size, |m, row| m.max(row[i].abs()));
    }
    assert!(largest["force"] > 0.0 && largest["step"] > 4.0);
    for (i, column) in a.columns.iter().enumerate() {
        // What is left of a residual is round-off.
        if column == "residual" {
            continue;
        }
        for (x, y) in a.rows.iter().zip(&b.rows) {
            let allowed = 1e-8 * largest[&kind(column)];
            assert!(
                (x[i] - y[i]).abs() <= allowed,
                "{name}, {column}: {} {}",
                x[i],
                y[i]
            );
        }
    }
}

fn as_our_own(name: &str, method: &str, solver: Value) {
    let Some((history, counts)) = run(name, solver) else {
        return;
    };
    assert!(
        counts.get(method).is_some_and(|n| *n > 4),
        "{name}: {counts:?}"
    );
    let (own, own_counts) = run(name, json!("auto")).expect("no library is asked for");
    assert!(
        own_counts.get(method).is_some_and(|n| *n > 0),
        "{name}: {own_counts:?}"
    );
    same(name, &history, &own);
}

/// Stable equilibria, definite matrices at the end of each step.
#[test]
fn a_plate_under_a_ball() {
    as_our_own("ball_on_plate", "ldlt", json!("mumps"));
}

#[test]
fn a_plate_under_a_ball_with_factors_on_the_disk() {
    let settings = json!({ "mumps": { "out_of_core": true, "ordering": "amf" } });
    as_our_own("ball_on_plate", "ldlt", settings);
}

/// Indefinite matrices in a fifth of the iterations.
#[test]
fn a_strip_over_a_cylinder() {
    as_our_own("strip_over_cylinder", "ldlt", json!("mumps"));
}

/// Friction: unsymmetric matrices.
#[test]
fn a_block_that_is_ironed() {
    as_our_own("ironing", "lu", json!("mumps"));
}

/// A surface driven by force is a node of the system.
#[test]
fn a_ball_by_its_weight() {
    as_our_own("ball_by_weight", "ldlt", json!("mumps"));
}
