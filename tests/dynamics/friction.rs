//! Friction and inertia.
use crate::support::{column, run};
use serde_json::json;

/// Closed form: a block that slides on a plane at first with `v` comes to rest after the time `v / (mu g)` and the way
/// `v^2 / (2 mu g)`; friction takes all of its energy.
#[test]
fn a_sliding_block_comes_to_rest() {
    let (mu, g, v) = (0.3, 10.0, 2.0);
    let (time, way) = (v / (mu * g), v * v / (2.0 * mu * g));
    let (density, height) = (1.0, 0.5);
    // Pressed in by what carries its weight from the start.
    let penalty = 2e4;
    let sunk = density * g * height / penalty;
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1e5, "nu": 0.3, "density": density } } },
        "bodies": { "b": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [2, 1, height], "elements": [4, 2, 1] } },
            "material": "m", "velocity": [v, 0, 0], "placement": { "translation": [0, 0, -sunk] }
        } },
        "surfaces": { "floor": { "plane": { "center": [1, 0.5, 0], "size": [20, 20] }, "side": { "point": [1, 0.5, 1] } } },
        "contacts": { "c": {
            "slave": "b.bottom", "master": "floor", "penalty": { "value": penalty }, "friction": mu
        } },
        "loads": { "weight": { "on": "b", "gravity": [0, 0, -g] } },
        "solution": { "dynamics": {}, "end_time": 1.3 * time, "step": { "max": time / 200.0, "initial": time / 200.0 } },
        "output": { "every": 0 }
    });
    let mut stopped = f64::INFINITY;
    let mut last = f64::NEG_INFINITY;
    let simulation = run(&scene, |s| {
        let u = s.displacements("b").expect("the body");
        let x = u.iter().map(|u| u.x).sum::<f64>() / u.len() as f64;
        if x < last && stopped.is_infinite() {
            stopped = s.time();
        }
        last = last.max(x);
    });
    let u = simulation.displacements("b").expect("the body");
    let x = u.iter().map(|u| u.x).sum::<f64>() / u.len() as f64;
    let energy = 0.5 * density * 2.0 * height * v * v;
    let taken = column(&simulation, "energy.dissipated");
    let taken = taken[taken.len() - 1] / energy;
    println!(
        "{} steps; way {:.5} of {way:.5}, stopped at {stopped:.4} of {time:.4}, friction took {taken:.4}",
        simulation.steps(),
        x
    );
    assert!((x / way - 1.0).abs() < 0.01, "{x} {way}");
    assert!((stopped / time - 1.0).abs() < 0.03, "{stopped} {time}");
    assert!((taken - 1.0).abs() < 0.01, "{taken}");
    // That it starts pressed in, and nothing else.
    let told = simulation.warnings();
    assert!(
        told.len() == 1 && told[0].contains("overclosure"),
        "{told:?}"
    );
}
