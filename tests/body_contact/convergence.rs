//! Newton's method converges quadratically with a master that deforms.
use crate::shells::arch_on_plate;
use crate::support::{Outcome, solve};
use covact::solve::event::Event;
use serde_json::{Value, json};

/// Residuals of each accepted step from the last iteration on in which a point changed.
pub fn endings(outcome: &Outcome) -> Vec<Vec<f64>> {
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

/// What rounding leaves: residuals fall to 1e-13.
pub const FLOOR: f64 = 1e-12;
/// `r_(k+1) / r_k^2` with residuals relative to the forces tends to a number of the order of the deflection in
/// thicknesses, 2 / 0.3 here, but is larger where points pass from facet to facet on the way: up to 97 is measured. A
/// tangent with an error converges linearly, and its ratio grows without bound.
pub const C: f64 = 200.0;

/// How many pairs of residuals satisfy and violate quadratic convergence; pairs of which nothing can be said are left
/// out.
fn judge(points: &Value, surface: &str, tangent: Value) -> [usize; 2] {
    let mut scene = arch_on_plate(2.0, 5, points.clone());
    scene["contacts"]["press"]["master_surface"] = json!(surface);
    scene["contacts"]["press"]["tangent"] = tangent;
    println!("{points} {surface}:");
    judge_scene(&scene)
}

/// [`judge`] for any scene.
pub fn judge_scene(scene: &Value) -> [usize; 2] {
    let mut count = [0, 0];
    for e in endings(&solve(scene)) {
        let shown: Vec<String> = e.iter().map(|r| format!("{r:.1e}")).collect();
        println!("{}", shown.join(" "));
        for pair in e.windows(2) {
            let bound = (C * pair[0] * pair[0]).max(FLOOR);
            if bound < 0.1 * pair[0] {
                count[usize::from(pair[1] > bound)] += 1;
            }
        }
    }
    count
}

#[test]
fn residuals_fall_quadratically_on_a_master_that_deforms() {
    let mut all = 0;
    for (points, surface) in [
        (json!("nodes"), "faces"),
        (json!({"gauss": 2}), "faces"),
        (json!({"gauss": 2}), "smooth"),
    ] {
        let [good, bad] = judge(&points, surface, json!("exact"));
        assert!(
            good >= 2 && bad == 0,
            "{points} {surface}: {good} good, {bad} bad"
        );
        all += good;
    }
    assert!(all >= 10, "{all} pairs of residuals tell anything");
}

#[test]
fn a_tangent_without_its_rotational_part_is_found_out() {
    let main = json!({ "published": { "rotational": false, "curvature": false } });
    let [good, bad] = judge(&json!({"gauss": 2}), "faces", main);
    assert!(bad >= 3, "{good} good, {bad} bad");
}
