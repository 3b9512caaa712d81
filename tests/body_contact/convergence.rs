//! Newton's method converges quadratically with a master that deforms.
use crate::blocks::done;
use crate::shells::arch_on_plate;
use crate::support::Outcome;
use covact::solve::event::Event;
use serde_json::json;

/// Residuals of each accepted step from the last iteration on in which a point changed.
fn endings(outcome: &Outcome) -> Vec<Vec<f64>> {
    let mut out = Vec::new();
    let mut settled: Vec<f64> = Vec::new();
    for event in &outcome.events {
        match event {
            Event::Iteration {
                iteration,
                residual,
                changed,
                ..
            } => {
                if *iteration == 0 || *changed > 0 {
                    settled.clear();
                }
                settled.push(*residual);
            }
            Event::StepAccepted { .. } => out.push(std::mem::take(&mut settled)),
            _ => {}
        }
    }
    out
}

/// Where the iteration stops: nothing is known below.
const TOLERANCE: f64 = 1e-11;
/// `r_(k+1) / r_k^2` with residuals relative to the forces. It tends to half the relative change of the tangent along the
/// displacement that the whole force would cause: the deflection in thicknesses, about 2 / 0.3 here. A tangent with an
/// error converges linearly, and its ratio grows without bound.
const C: f64 = 10.0;

#[test]
fn residuals_fall_quadratically_on_a_master_that_deforms() {
    let mut good = 0;
    for (points, surface) in [
        (json!("nodes"), "faces"),
        (json!({"gauss": 2}), "faces"),
        (json!({"gauss": 2}), "smooth"),
    ] {
        let mut scene = arch_on_plate(2.0, 5, points.clone());
        scene["contacts"]["press"]["master_surface"] = json!(surface);
        let outcome = done(&scene);
        for e in endings(&outcome) {
            let shown: Vec<String> = e.iter().map(|r| format!("{r:.1e}")).collect();
            println!("{points} {surface}: {}", shown.join(" "));
            for pair in e.windows(2) {
                let bound = C * pair[0] * pair[0];
                if bound > TOLERANCE && bound < 0.1 * pair[0] {
                    assert!(pair[1] <= bound, "{points} {surface}: {shown:?}");
                    good += 1;
                }
            }
        }
    }
    assert!(good >= 10, "{good} pairs of residuals tell anything");
}
