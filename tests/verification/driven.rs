//! Rigid surfaces driven by force.
//!
//! Constructions with a known answer: the same equilibrium reached by force and by displacement, balances of force and
//! moment, a rigid plane on an elastic foundation.
use crate::support::{Outcome, scene_json, set, solve};
use serde_json::{Value, json};

/// A quarter of the clamped plate under a ball, on `n` x `n` elements.
fn plate(n: u32) -> Value {
    let mut scene = scene_json("ball_on_plate.json");
    set(&mut scene, "/bodies/plate/mesh/plate/elements", vec![n, n]);
    scene["output"] = json!({ "every": 0 });
    scene["solution"] = json!({
        "step": { "initial": 0.25, "max": 0.25 },
        "newton": { "tolerance": 1e-11 },
        "threads": 1
    });
    scene
}

fn done(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    outcome
}

#[test]
fn a_ball_pressed_by_its_weight_stands_where_the_same_force_is_met_by_displacement() {
    let mut by_force = plate(10);
    by_force["surfaces"]["ball"]["sphere"]["center"] = json!([0, 0, 29]);
    by_force["surfaces"]["ball"]["motion"] = json!({ "free": { "force": { "z": "-600*t" } } });
    let forced = done(&by_force);
    println!("{:?}", forced.summary);
    let depth = forced.at("displacement.ball.z", 1.0);
    let mut by_displacement = plate(10);
    by_displacement["surfaces"]["ball"]["sphere"]["center"] = json!([0, 0, 29]);
    by_displacement["surfaces"]["ball"]["motion"] =
        json!({ "translation": [0, 0, { "table": [[0, -3], [1, depth]] }] });
    let moved = done(&by_displacement);
    println!("{:?}", moved.summary);
    assert!((forced.at("force.ball.z", 1.0) / -600.0 - 1.0).abs() < 1e-9);
    for name in [
        "force.ball.x",
        "force.ball.z",
        "energy.internal",
        "energy.contact",
        "penetration.max",
    ] {
        let (a, b) = (forced.at(name, 1.0), moved.at(name, 1.0));
        assert!(
            a.abs() > 0.0 && (a / b - 1.0).abs() < 1e-8,
            "{name}: {a} {b}"
        );
    }
    assert!(forced.at("force_balance.ball.z", 1.0).abs() < 1e-7);
}
