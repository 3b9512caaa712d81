//! The flat contact patch test (M. A. Crisfield; posed as in solids4foam): two blocks pressed together.
//!
//! Linear theory gives `DELTA / (H1/E + H2/E + 1/EPS)` = 9900.99; at this one percent of strain St. Venant-Kirchhoff
//! columns bear 9755.8. "Passed" means that the pressure is uniform.
use crate::blocks::{DELTA, E, EPS, done, exact, patch, pressures};
use serde_json::json;

#[test]
fn matching_meshes_pass_the_patch_test() {
    let linear = DELTA / (1.0 / E + 1.0 / EPS);
    assert!((linear - 9900.99).abs() < 0.01);
    let p = exact();
    assert!((p - 9755.8).abs() < 0.1, "{p}");
    for points in [json!("nodes"), json!({"gauss": 2}), json!({"lobatto": 3})] {
        let outcome = done(&patch(3, 3, points.clone()));
        let [low, high] = pressures(&outcome, "upper");
        println!("{points}: {low} {high} {p}");
        assert!(
            (low - p).abs() < 1e-9 * p && (high - p).abs() < 1e-9 * p,
            "{points}"
        );
        let force = outcome.column("force.ground.z")[0];
        assert!((force - p).abs() < 1e-9 * p, "{force}");
    }
}

/// On meshes that do not match, the Gauss points of the slave see the kinks of the master's shape functions, and the
/// pressure is uniform only as far as they integrate them: the error falls with the number of points.
#[test]
fn the_error_of_meshes_that_do_not_match_falls_with_the_gauss_points() {
    let p = exact();
    let errors = [2u32, 3, 5, 10].map(|n| {
        let outcome = done(&patch(3, 2, json!({ "gauss": n })));
        let [low, high] = pressures(&outcome, "upper");
        let error = (high - p).max(p - low) / p;
        let force = outcome.column("force.ground.z")[0];
        println!(
            "{n} points: pressure off by {error:.3e}, force by {:.3e}",
            force / p - 1.0
        );
        error
    });
    println!("{errors:?} {E}");
}
