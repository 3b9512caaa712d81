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

#[test]
fn residuals_fall_quadratically_on_a_master_that_deforms() {
    for (points, surface) in [
        (json!("nodes"), "faces"),
        (json!({"gauss": 2}), "faces"),
        (json!({"gauss": 2}), "smooth"),
    ] {
        let mut scene = arch_on_plate(3.0, 6, points.clone());
        scene["contacts"]["press"]["master_surface"] = json!(surface);
        let outcome = done(&scene);
        for e in endings(&outcome) {
            let shown: Vec<String> = e.iter().map(|r| format!("{r:.1e}")).collect();
            println!("{points} {surface}: {}", shown.join(" "));
        }
    }
}
