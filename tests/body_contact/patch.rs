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
    // Measured; the blocks are 3 x 3 on 2 x 2 elements, of which no edges coincide but the outer ones.
    for (error, stated) in errors.iter().zip([2.24e-2, 1.10e-2, 4.93e-3, 7.6e-4]) {
        assert!(
            *error < 1.02 * stated && *error > 0.5 * stated,
            "{errors:?}"
        );
    }
    assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
}

/// Linear on quadratic elements and the other way round, faces on faces: the shape functions of neither side have a kink
/// inside a face of the other, so the pressure is uniform.
#[test]
fn linear_and_quadratic_elements_pass_the_patch_test() {
    let p = exact();
    for [upper, lower] in [["h8", "q18"], ["q18", "h8"], ["q18", "q18"]] {
        // A linear slave's nodes meet corners of quadratic faces only, which bear no uniform pressure.
        let points = [json!({"gauss": 3}), json!("nodes")];
        for points in &points[..if upper == "h8" { 1 } else { 2 }] {
            let mut scene = patch(2, 2, points.clone());
            scene["bodies"]["upper"]["element"] = json!(upper);
            scene["bodies"]["lower"]["element"] = json!(lower);
            scene["solution"]["newton"]["tolerance"] = json!(1e-11);
            let outcome = done(&scene);
            let force = outcome.column("force.ground.z")[0];
            let p_max = outcome.column("pressure.max")[0];
            println!("{upper} on {lower}, {points}: {force} {p_max} {p}");
            assert!(
                (force - p).abs() < 1e-9 * p,
                "{upper} on {lower}, {points}: {force}"
            );
            assert!(
                (p_max - p).abs() < 1e-9 * p,
                "{upper} on {lower}, {points}: {p_max}"
            );
        }
    }
}
