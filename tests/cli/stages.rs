//! Stages of a scene that are refused, and what is told of those that run.
use crate::support::*;
use serde_json::json;

#[test]
fn stages_that_do_not_fit_are_refused() {
    let bend = json!({ "name": "bend", "until": 0.5 });
    let cases = [
        (
            json!([bend, { "name": "bend", "release": "forces" }]),
            "/stages/1/name",
            "two stages have the name `bend`",
        ),
        (
            json!([bend, { "name": "out", "release": "forces", "until": 0.8 }]),
            "/stages/1/until",
            "the last stage ends at 0.8, and the run at 1",
        ),
        (
            json!([bend, { "name": "hold", "until": 0.5 }, { "name": "out", "release": "forces" }]),
            "/stages/1/until",
            "the stage ends at 0.5, and begins at 0.5",
        ),
        (
            json!([{ "name": "bend", "until": 0.5, "release": "forces" }, { "name": "out" }]),
            "/stages/0/release",
            "the first stage has nothing to release",
        ),
        (
            json!([bend, { "name": "out", "release": "forces", "contacts": ["press"] }]),
            "/stages/1/release",
            "nothing is released",
        ),
        (
            json!([bend, { "name": "out", "contacts": "prss" }]),
            "/stages/1/contacts",
            "did you mean `press`?",
        ),
        (
            json!([bend, { "name": "out", "release": "forces", "supports": "clamp" }]),
            "/stages/1/supports",
            "there is no support `clamp`",
        ),
        (
            json!([{ "name": "bend", "until": 0.5, "tools": { "ball": [0, 0, -2] } }, { "name": "out", "release": "forces" }]),
            "/stages/0/tools",
            "`ball`",
        ),
    ];
    for (stages, pointer, message) in cases {
        let text = plate_with(&[("/stages", stages)]);
        let folder = tempfile::tempdir().unwrap();
        let text = serde_json::to_string_pretty(&text).unwrap();
        let told = unfolded(&refused_in(folder.path(), text.as_bytes()));
        assert!(
            told.contains(message),
            "{pointer}: no `{message}` in\n{told}"
        );
        // The place is a line within the stages.
        let first = text[..text.find("\"stages\"").unwrap()]
            .matches('\n')
            .count()
            + 1;
        let line: usize = told
            .split("scene.json:")
            .nth(1)
            .and_then(|rest| rest.split(':').next()?.parse().ok())
            .expect("a line");
        assert!(line > first, "{pointer}: {told}");
    }
}

/// An elastic plate goes back to where it was, whichever way it is released; the stages are in the summary.
#[test]
fn an_elastic_plate_goes_back() {
    for release in ["forces", "tools"] {
        let folder = tempfile::tempdir().unwrap();
        let stages = json!([{ "name": "press", "until": 0.5, "tools": { "ball": [0, 0, -2] } }, { "name": "back", "release": release }]);
        let mut scene = plate_with(&[
            ("/stages", stages),
            ("/solution/step", json!({ "initial": 0.1 })),
        ]);
        scene["surfaces"]["ball"]
            .as_object_mut()
            .unwrap()
            .remove("motion");
        scene["probes"] = json!({ "middle": { "near": [0, 0, 0], "quantity": "displacement" } });
        let text = serde_json::to_string_pretty(&scene).unwrap();
        std::fs::write(folder.path().join("scene.json"), text).unwrap();
        let output = covact(folder.path(), &["run", "scene.json", "-o", "out"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let told = unfolded(&(stdout(&output) + &stderr(&output)));
        assert!(told.contains("stage `back` begins"), "{told}");
        // A tool that is taken back is meant to leave.
        assert!(!told.contains("opened at step"), "{told}");
        let history = covact::output::read_csv(&folder.path().join("out/history.csv")).unwrap();
        let z = history.column("probe.middle.z").unwrap();
        let deepest = z.iter().fold(0.0f64, |a, z| a.min(*z));
        let last = z[z.len() - 1];
        assert!(deepest < -1.0 && last.abs() < 1e-8, "{deepest}, {last}");
        let text = std::fs::read_to_string(folder.path().join("out/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        let names: Vec<_> = (summary["stages"].as_array().unwrap().iter())
            .map(|s| s["name"].as_str().unwrap())
            .collect();
        assert_eq!(names, ["press", "back"]);
        assert!(summary["stages"][1]["force"].as_f64().unwrap() > 1.0);
    }
}

/// `check` says from when on a contact acts that a later stage brings, and nothing of points that it has not got yet.
#[test]
fn a_contact_of_a_later_stage_is_told_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let stages = json!([{ "name": "rest", "until": 0.5, "contacts": [] }, { "name": "push", "contacts": ["press"] }]);
    write_plate(folder.path(), &[("/stages", stages)]);
    let output = covact(folder.path(), &["check", "scene.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let told = unfolded(&stdout(&output));
    assert!(told.contains("acts from stage `push` on"), "{told}");
    assert!(!told.contains(" 0 points"), "{told}");
}

/// A plate that a pressure lifts against the ball is not free when the ball is back.
#[test]
fn a_contact_that_still_bears_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let stages = json!([{ "name": "press", "until": 0.5, "tools": { "ball": [0, 0, -2] } }, { "name": "back", "release": "tools" }]);
    let mut scene = plate_with(&[("/stages", stages)]);
    scene["surfaces"]["ball"]
        .as_object_mut()
        .unwrap()
        .remove("motion");
    scene["loads"] = json!({ "lift": { "on": "plate.bottom", "pressure": 0.5 } });
    let text = serde_json::to_string_pretty(&scene).unwrap();
    std::fs::write(folder.path().join("scene.json"), text).unwrap();
    let output = covact(folder.path(), &["run", "scene.json", "-o", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let told = unfolded(&(stdout(&output) + &stderr(&output)));
    assert!(
        told.contains("stage `back`: contact `press` still bears at its end, with its tool back where it started"),
        "{told}"
    );
}
