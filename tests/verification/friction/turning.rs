//! Friction against a floor that moves in a circle acts along the floor's velocity, whatever the steps.
//!
//! ```text
//!            ____________   held
//!           |    pad     |  pressed by .08 by the floor, which comes up
//!           |____________|
//!     -------------------------   floor: then a circle of radius 3; at its end it moves along y
//! ```
//!
//! The pad's shear and the elastic slip are short beside the radius, so that all points slide, and friction has the size `mu N` and the
//! direction of the floor's velocity at every time: Coulomb's law. Along the chord of a step it would lag by half of what the path
//! turns in it: 25 degrees under the steps that such a scene starts with.
use crate::support::{Outcome, solve};
use covact::output::RunStatus;
use serde_json::{Value, json};

const MU: f64 = 0.35;

fn scene(step: Value) -> Value {
    json!({
        "covact": 1,
        "materials": { "hard": { "neo_hooke": { "E": 600, "nu": 0.3 } } },
        "bodies": { "pad": {
            "mesh": { "block": { "min": [-12, -9, 0], "max": [12, 9, 10], "elements": [4, 3, 2] } },
            "material": "hard"
        } },
        "surfaces": { "floor": {
            "plane": { "size": [100, 100], "center": [0, 0, 0], "normal": [0, 0, 1] },
            "motion": { "translation": [
                "3*(cos(2*pi*max(0,t-.3)/.7)-1)", "3*sin(2*pi*max(0,t-.3)/.7)",
                { "table": [[0, 0], [0.3, 0.08], [1, 0.08]] }
            ] }
        } },
        "contacts": { "c": { "slave": "pad.bottom", "master": "floor", "friction": MU } },
        "supports": { "top": { "on": "pad.top", "fixed": true } },
        "solution": { "step": step },
        "output": { "every": 0 }
    })
}

/// Size over `mu N`, and by how much the direction is off the floor's velocity (degrees), of the friction at the end.
fn friction(outcome: &Outcome) -> [f64; 2] {
    let [x, y, z] = ["x", "y", "z"].map(|c| outcome.at(&format!("force.floor.{c}"), 1.0));
    [x.hypot(y) / (MU * z), x.atan2(y).to_degrees()]
}

fn told(outcome: &Outcome) -> bool {
    let warnings = &outcome.summary.warnings;
    warnings
        .iter()
        .any(|w| w.contains("direction of sliding turns"))
}

#[test]
fn friction_follows_a_floor_that_moves_in_a_circle() {
    let outcome = solve(&scene(json!({})));
    assert_eq!(outcome.summary.status, RunStatus::Done);
    let [size, off] = friction(&outcome);
    println!("{size} mu N, {off} degrees off");
    assert!((size - 1.0).abs() < 1e-3, "{size}");
    // Half of what the path turns in a step, and the elastic slip over the radius.
    assert!(off > 0.0 && off < 6.0, "{off}");
}

/// Steps that a scene fixes are taken, and what they leave aside is told.
#[test]
fn friction_that_lags_under_given_steps_is_told() {
    let fixed = |size: f64| json!({ "initial": size, "max": size, "adaptive": false });
    let [coarse, fine] = [0.1, 0.005].map(|size| solve(&scene(fixed(size))));
    let [[_, lags], [_, follows]] = [&coarse, &fine].map(friction);
    println!("{lags} and {follows} degrees off");
    // A step is a seventh of the circle, and half of that the lag.
    assert!((lags - 180.0 / 7.0).abs() < 3.0, "{lags}");
    assert!(told(&coarse));
    assert!(follows < 4.0 && !told(&fine), "{follows}");
}
