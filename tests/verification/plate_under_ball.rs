//! Plate under a ball: clamped plate 100 x 100 x 2, E = 12000, nu = .3, St. Venant-Kirchhoff, rigid frictionless ball of
//! radius 25 pushed in by 10. Forces of the whole plate at 2.5, 5, 7.5 and 10.
//!
//! ```text
//!            ( ball )
//!   |-----------v-----------|     quarter model, symmetry at x = 0 and y = 0
//! ```
//!
//! Two references. An independent solid-shell program (numpy, one layer of H8 with the same element recipe) gave
//! 629 / 2571 / 7275 / 16638 on 25 x 25 elements, 623 / 2553 / 7255 / 16590 on 50 x 50 and 622 / 2550 / 7248 / 16577 on
//! 80 x 80; its quadratic element on 20 x 20 gave 621 / 2549 / 7247 / 16578. CalculiX 2.20 (C3D20R, two layers by their
//! nodes) gave 623 / 2572 / 7292 / 16671.
use crate::support::{Outcome, scene_json, set, solve};

const CONVERGED: [f64; 4] = [622.0, 2550.0, 7248.0, 16580.0];

fn run(n: u32) -> Outcome {
    let mut scene = scene_json("ball_on_plate.json");
    set(&mut scene, "/bodies/plate/mesh/plate/elements", vec![n, n]);
    scene["output"] = serde_json::json!({ "every": 0 });
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "done");
    outcome
}

fn forces(outcome: &Outcome) -> [f64; 4] {
    [0.25, 0.5, 0.75, 1.0].map(|t| -4.0 * outcome.at("force.ball.z", t))
}

/// Mean relative difference over the four forces.
fn difference(f: &[f64; 4], reference: &[f64; 4]) -> f64 {
    let sum: f64 = f
        .iter()
        .zip(reference)
        .map(|(f, r)| (f / r - 1.0).abs())
        .sum();
    sum / 4.0
}

#[test]
fn same_forces_as_an_independent_program_on_the_same_mesh() {
    let outcome = run(25);
    let f = forces(&outcome);
    // The printed digits of the reference, and different slave points' round-off: .1 %.
    for (f, reference) in f.iter().zip([629.0, 2571.0, 7275.0, 16638.0]) {
        assert!(
            (f / reference - 1.0).abs() < 1e-3,
            "{f} instead of {reference}"
        );
    }
    let iterations = outcome.summary.newton_iterations;
    assert!(iterations <= 150, "{iterations} iterations");
}

#[test]
fn converges_at_second_order_to_the_reference() {
    let fine: serde_json::Value =
        serde_json::from_str(include_str!("reference/ball_on_plate.json")).unwrap();
    let finest: [f64; 4] = std::array::from_fn(|i| fine["force"][i].as_f64().unwrap());
    // The finest own run agrees with the independent one within the width the latter states, .2 %.
    assert!(difference(&finest, &CONVERGED) < 2e-3);
    let [coarse, middle, dense] = [12, 25, 50].map(|n| forces(&run(n)));
    for (f, reference) in dense.iter().zip(CONVERGED) {
        assert!(
            (f / reference - 1.0).abs() < 3e-3,
            "{f} instead of {reference}"
        );
    }
    let errors = [coarse, middle, dense].map(|f| difference(&f, &finest));
    let rates = [
        (errors[0] / errors[1]).ln() / (25.0f64 / 12.0).ln(),
        (errors[1] / errors[2]).ln() / 2.0f64.ln(),
    ];
    println!("errors {errors:?}, rates {rates:?}");
    // Bilinear elements: 2. The edge of the contact zone cuts through elements, which scatters the rate, and the
    // reference is itself 80 x 80, which raises the last one.
    assert!(rates[0] > 1.6 && rates[0] < 2.6, "{rates:?}");
    assert!(rates[1] > 1.6 && rates[1] < 3.0, "{rates:?}");
}
