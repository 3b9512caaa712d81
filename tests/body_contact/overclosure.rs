//! Bodies that overlap at the start: strained, taken as touching, shrunk in, refused; and bodies that part again.
use crate::blocks::{DELTA, done, exact, patch};
use crate::support::solve;
use covact::{model, scene};
use serde_json::{Value, json};

/// The blocks of the patch test, the upper one put `DELTA` into the lower one and held there: once the overlap is
/// resolved, the state is that of the upper block pressed by `DELTA`.
fn overlapping(choice: Value) -> Value {
    let mut scene = patch(2, 2, json!({ "gauss": 2 }));
    scene["bodies"]["upper"]["placement"] = json!({ "translation": [0, 0, -DELTA] });
    scene["supports"]["push"]["displacement"]["z"] = json!(0);
    scene["contacts"]["press"]["initial_overclosure"] = choice;
    scene["solution"]["step"] = json!({ "initial": 0.25, "max": 0.25 });
    scene["solution"]["newton"]["tolerance"] = json!(1e-11);
    scene
}

#[test]
fn an_overlap_of_bodies_is_strained_or_shrunk_in_or_counts_as_touching() {
    let p = exact();
    let strained = done(&overlapping(json!("strain")));
    let shrunk = done(&overlapping(json!({ "shrink": { "until": 0.5 } })));
    for (name, outcome) in [("strain", &strained), ("shrink", &shrunk)] {
        let force = outcome.at("force.ground.z", 1.0);
        assert!(
            (force - p).abs() < 1e-8 * p,
            "{name}: {force} instead of {p}"
        );
    }
    // Half the overlap at half the time: that of a press by half the displacement.
    let mut half = patch(2, 2, json!({ "gauss": 2 }));
    half["supports"]["push"]["displacement"]["z"] = json!(format!("-{}*t", 0.5 * DELTA));
    half["solution"]["newton"]["tolerance"] = json!(1e-11);
    let half = done(&half).at("force.ground.z", 1.0);
    let found = shrunk.at("force.ground.z", 0.25);
    assert!(
        half > 0.4 * p && (found - half).abs() < 1e-8 * half,
        "{found} instead of {half}"
    );
    // The overlap counts as no gap: nothing is pressed, until the upper block is moved.
    let mut free = overlapping(json!("stress_free"));
    let table = json!({ "table": [[0, 0], [0.5, 0], [1, -DELTA]] });
    free["supports"]["push"]["displacement"]["z"] = table;
    let free = done(&free);
    assert!(free.at("force.ground.z", 0.5).abs() < 1e-9 * p);
    let pressed = free.at("force.ground.z", 1.0);
    assert!((pressed - p).abs() < 1e-8 * p, "{pressed} instead of {p}");
}

#[test]
fn an_overlap_of_bodies_is_refused_by_name() {
    let text = overlapping(json!("refuse")).to_string();
    let loaded = scene::parse(&text, "scene.json").unwrap();
    let error = model::build::build(&loaded).unwrap_err();
    assert_eq!(error.pointer, "/contacts/press/initial_overclosure");
    let message = error.to_string();
    assert!(
        message.contains("`press`") && message.contains("0.01"),
        "{message}"
    );
}

/// Pressed together and drawn apart: the force goes back to nothing, no point stays in contact, and pressing again gives the
/// same force.
#[test]
fn bodies_part_and_meet_again() {
    let mut scene = patch(3, 2, json!({ "gauss": 3 }));
    let path = [
        [0.0, 0.0],
        [0.25, -DELTA],
        [0.5, DELTA],
        [0.75, DELTA],
        [1.0, -DELTA],
    ];
    scene["supports"]["push"]["displacement"]["z"] = json!({ "table": path });
    // Held by itself where nothing touches.
    scene["supports"]["ground"]["displacement"] = json!({ "z": 0 });
    scene["solution"]["step"] = json!({ "initial": 0.25, "max": 0.25 });
    scene["solution"]["newton"]["tolerance"] = json!(1e-11);
    let outcome = solve(&scene);
    assert_eq!(
        outcome.summary.status.name(),
        "done",
        "{:?}",
        outcome.summary
    );
    let force = |t: f64| outcome.at("force.ground.z", t);
    assert!(force(0.25) > 0.9 * exact());
    assert!(force(0.5).abs() < 1e-9 * force(0.25) && force(0.75).abs() < 1e-9 * force(0.25));
    assert_eq!(outcome.at("points.active", 0.5), 0.0);
    assert!((force(1.0) / force(0.25) - 1.0).abs() < 1e-9);
}
