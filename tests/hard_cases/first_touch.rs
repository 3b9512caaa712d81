//! First touches under the penalty that a run starts with, against the same under a stiffer one; and touches that end.
use crate::support::solve;
use covact::output::RunStatus;
use serde_json::{Value, json};

/// A strip blown over a roller by a follower pressure that goes on as given, until `end`.
fn strip(pressure: &Value, end: f64, step: &Value, penalty: Option<f64>) -> Value {
    let mut scene = json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 210000, "nu": 0.3 } } },
        "bodies": { "strip": {
            "mesh": { "plate": { "size": [80, 10], "thickness": 0.4, "elements": [25, 1], "origin": [0, 0, 0.2] } },
            "material": "steel"
        } },
        "surfaces": { "roller": { "cylinder": { "radius": 30, "length": 30, "center": [0, 5, -30] } } },
        "contacts": { "c": { "slave": "strip.bottom", "master": "roller" } },
        "supports": {
            "end": { "on": "strip.x_min", "fixed": true },
            "sides": { "on": ["strip.y_min", "strip.y_max"], "symmetry": "y" }
        },
        "loads": { "p": { "on": "strip.top", "pressure": pressure, "follower": true } },
        "solution": { "end_time": end, "step": step },
        "output": { "every": 0 }
    });
    if let Some(penalty) = penalty {
        scene["contacts"]["c"]["penalty"] = json!({ "value": penalty });
    }
    scene
}

/// The force of the roller at a time, of a run that ends.
fn force(scene: &Value, time: f64) -> f64 {
    let run = solve(scene);
    let s = &run.summary;
    assert_eq!(s.status, RunStatus::Done, "{:?}", s.reason);
    run.at("force.roller.z", time)
}

/// At the first touch what little contact stores shows in no energy beside what bends, and the penalty that it starts with lets it
/// carry a third of its force. The same contact under a hundred times the penalty that suits carries 13.17.
#[test]
fn a_small_force_beside_much_bending_is_not_lost() {
    // Not the last step, which is ruled by more.
    let step = json!({ "initial": 0.1, "max": 0.1 });
    let [own, stiff] =
        [None, Some(1e5)].map(|penalty| force(&strip(&json!("0.05*t"), 0.4, &step, penalty), 0.3));
    println!("{own} of {stiff}");
    assert!((stiff / 13.17 - 1.0).abs() < 1e-3, "{stiff}");
    assert!((own / stiff - 1.0).abs() < 0.05, "{own} of {stiff}");
}

/// The largest force stands at the step before the pressure turns: there is no next one that a penalty ruled after it could serve, as
/// there is none after the last. Under the penalty that it starts with it was 8.07 of 9.40.
#[test]
fn the_peak_before_a_turn_is_ruled_like_the_end() {
    let turning = json!({ "table": [[0, 0], [1, 0.016], [2, 0]] });
    let step = json!({ "initial": 0.5 });
    let [own, stiff] =
        [None, Some(1e5)].map(|penalty| force(&strip(&turning, 2.0, &step, penalty), 1.0));
    println!("{own} of {stiff}");
    assert!((stiff / 9.40 - 1.0).abs() < 1e-3, "{stiff}");
    assert!((own / stiff - 1.0).abs() < 0.01, "{own} of {stiff}");
}

/// A sheet of one Q18 layer squeezed between two plates and let go to exactly where it began: in the end no force is left to measure a
/// residual by, and points open and close by what rounding leaves. Forces that have vanished are measured by those that were.
#[test]
fn what_is_let_go_to_where_it_began_ends() {
    let plate = |z: f64, normal: f64, way: f64| {
        json!({
            "plane": { "center": [0, 0, z], "normal": [0, 0, normal], "size": [400, 400] },
            "motion": { "translation": [0, 0, { "table": [[0, 0], [1, way], [2, 0]] }] }
        })
    };
    let scene = json!({
        "covact": 1,
        "materials": { "aluminium": { "st_venant_kirchhoff": { "E": 70000, "nu": 0.33 } } },
        "bodies": { "sheet": {
            "mesh": { "plate": { "size": [100, 100], "thickness": 0.2, "elements": [3, 3], "origin": [0, 0, 0.1] } },
            "material": "aluminium", "element": "q18"
        } },
        "surfaces": { "lower": plate(0.0, 1.0, 0.0), "upper": plate(0.2, -1.0, -0.01) },
        "contacts": {
            "l": { "slave": "sheet.bottom", "master": "lower", "friction": 0.3 },
            "u": { "slave": "sheet.top", "master": "upper", "friction": 0.3 }
        },
        "supports": {
            "x": { "on": "sheet.x_min", "symmetry": "x" },
            "y": { "on": "sheet.y_min", "symmetry": "y" }
        },
        "solution": { "end_time": 2 },
        "output": { "every": 0 }
    });
    let run = solve(&scene);
    let s = &run.summary;
    println!("{} iterations in {} steps", s.newton_iterations, s.steps);
    assert_eq!(s.status, RunStatus::Done, "{:?}", s.reason);
    let [squeezed, free] = [1.0, 2.0].map(|t| -run.at("force.upper.z", t));
    println!("{squeezed}, then {free}");
    // Between uniaxial stress and uniaxial strain of 5 %: friction holds the faces.
    assert!(squeezed > 3.3e7 && squeezed < 5.3e7, "{squeezed}");
    assert!(free.abs() < 1e-4 * squeezed, "{free}");
    // Regression: 294 before they were.
    assert!(s.newton_iterations < 200, "{}", s.newton_iterations);
}
