//! Newton's method converges quadratically once the contact points are settled, in every step.
use crate::common::{done, plate};
use crate::support::Outcome;
use covact::solve::event::Event;
use serde_json::{Value, json};

/// The last three residuals of each accepted step whose last two iterations changed no point.
fn endings(outcome: &Outcome) -> Vec<[f64; 3]> {
    let mut out = Vec::new();
    let mut solve: Vec<(f64, usize)> = Vec::new();
    for event in &outcome.events {
        match event {
            Event::Iteration {
                iteration,
                residual,
                changed,
                ..
            } => {
                if *iteration == 0 {
                    solve.clear();
                }
                solve.push((*residual, *changed));
            }
            Event::StepAccepted { .. } => {
                if let [.., (a, _), (b, 0), (c, 0)] = solve[..] {
                    out.push([a, b, c]);
                }
            }
            _ => {}
        }
    }
    out
}

/// Where the iteration stops: nothing is known below.
const TOLERANCE: f64 = 1e-11;
/// With residuals relative to the forces, `r_(k+1) / r_k^2` tends to half the relative change of the tangent along the
/// displacement that the whole force would cause: the deflection in thicknesses, 8 / 2 here, not a large number.
/// Measured are values up to 1. A tangent with an error converges linearly, and its ratio grows without bound.
const C: f64 = 10.0;

/// How many pairs of residuals satisfy and violate quadratic convergence; pairs of which nothing can be said, the bound
/// lying below the tolerance or above a tenth of the residual, are left out.
fn judge(endings: &[[f64; 3]]) -> [usize; 2] {
    let mut count = [0, 0];
    for pair in endings.iter().flat_map(|e| e.windows(2)) {
        let bound = C * pair[0] * pair[0];
        if bound > TOLERANCE && bound < 0.1 * pair[0] {
            count[usize::from(pair[1] > bound)] += 1;
        }
    }
    count
}

fn run(points: Value, tangent: Value, penalty: f64) -> [usize; 2] {
    let mut scene = plate(10, 8.0, 8);
    scene["contacts"]["press"]["points"] = points;
    scene["contacts"]["press"]["tangent"] = tangent;
    scene["contacts"]["press"]["penalty"] = json!({ "value": penalty });
    scene["solution"]["newton"]["tolerance"] = json!(TOLERANCE);
    let endings = endings(&done(&scene));
    for e in &endings {
        println!(
            "{:.1e} -> {:.1e} -> {:.1e}: {:.1e}",
            e[0],
            e[1],
            e[2],
            e[1] / (e[0] * e[0])
        );
    }
    judge(&endings)
}

#[test]
fn last_residuals_fall_quadratically() {
    for points in [
        json!("nodes"),
        json!({ "gauss": 2 }),
        json!({ "lobatto": 3 }),
    ] {
        let [good, bad] = run(points.clone(), json!("exact"), 6e4);
        println!("{points}: {good} of {}", good + bad);
        assert!(good >= 5 && bad == 0, "{points}: {good} good, {bad} bad");
    }
}

#[test]
fn an_incomplete_tangent_is_found_out() {
    let main = json!({ "published": { "rotational": false, "curvature": false } });
    // The softer the penalty, the deeper the points, the more the curvature part weighs.
    let [good, bad] = run(json!("nodes"), main, 6e2);
    assert!(bad >= 3, "{good} good, {bad} bad");
}
