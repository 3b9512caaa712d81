//! A sheet that meets itself.
use super::{knots, off, solve_sheet_file};
use crate::support::Outcome;
use serde_json::{Value, json};

/// Radius and thickness of a tube.
const R: f64 = 10.0;
const T: f64 = 0.5;

/// Half of a ring of width 1 about y, or its upper quarter: xi1 runs from the top down on the side of positive x.
fn ring(quarter: bool) -> Value {
    // The rational cubic of a half turn, and its first half by de Casteljau's rule.
    let half = [
        [0.0, R, 1.0],
        [2.0 * R / 3.0, R / 3.0, 1.0 / 3.0],
        [2.0 * R / 3.0, -R / 3.0, 1.0 / 3.0],
        [0.0, -R, 1.0],
    ];
    let mean = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|c| 0.5 * (a[c] + b[c]));
    let line = match quarter {
        false => half,
        true => {
            let one = [0, 1, 2].map(|k| mean(half[k], half[k + 1]));
            let two = [0, 1].map(|k| mean(one[k], one[k + 1]));
            [half[0], one[0], two[0], mean(two[0], two[1])]
        }
    };
    let points: Vec<[f64; 4]> = [0.0, 1.0]
        .into_iter()
        .flat_map(|y| line.map(|[x, z, w]| [x, w * y, z, w]))
        .collect();
    json!({"covact_geometry": 1, "unit": "mm", "resolution": null, "patches": [{
        "entity": 1, "degree": [3, 1], "knots": [knots(3), knots(1)], "points": points
    }]})
}

/// The tube between its planes of symmetry, pressed down at its top by `way` in the end.
fn pressed(quarter: bool, way: f64, penalty: f64) -> Outcome {
    let part = if quarter { 0.5 } else { 1.0 };
    let mut scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0}}},
        "bodies": {"tube": {
            "nurbs": {"file": "face.json", "thickness": T, "elements": [if quarter { 16 } else { 32 }, 1]},
            "material": "m"
        }},
        "contacts": {"walls": {
            "slave": "tube.bottom", "master": "tube.bottom", "penalty": {"value": penalty}
        }},
        "supports": {
            "top": {"on": "tube.edge.1", "symmetry": "x"},
            "sides": {"on": ["tube.edge.3", "tube.edge.4"], "displacement": {"y": 0}},
            "push": {"on": "tube.edge.1", "displacement": {
                "z": {"table": [[0, 0], [0.9, -19.3 * part], [1, -way * part]]}
            }}
        },
        "solution": {"step": {"initial": 0.05, "max": 0.05}, "newton": {"tolerance": 1e-9}},
        "output": {"every": 0}
    });
    if quarter {
        // The other half is the mirror image: a plane half-way, with twice the penalty as points sink in half as far.
        scene["surfaces"] = json!({"mirror": {"plane": {"normal": [0, 0, 1], "size": [60, 10]}}});
        scene["contacts"]["walls"]["master"] = json!("mirror");
        scene["contacts"]["walls"]["penalty"]["value"] = json!(2.0 * penalty);
        scene["supports"]["middle"] = json!({"on": "tube.edge.2", "symmetry": "z"});
    } else {
        scene["supports"]["bottom"] = json!({"on": "tube.edge.2", "symmetry": "x"});
        scene["supports"]["ground"] = json!({"on": "tube.edge.2", "displacement": {"z": 0}});
    }
    let outcome = solve_sheet_file(&ring(quarter), &scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    outcome
}

/// Half of a tube is pinched until its walls meet, half of the thickness inside of each: as its upper half meets a rigid plane in the
/// middle. Forces and moments of the walls balance, and nothing is in contact before.
#[test]
fn the_walls_of_a_tube_meet() {
    // Where walls are inclined, the gap along a normal differs from that along z by a part of the overlap: a small one.
    let (way, penalty) = (2.0 * R - T + 0.01, 400.0);
    let whole = pressed(false, way, penalty);
    let half = pressed(true, way, penalty);
    for (time, active) in (whole.column("time").iter()).zip(whole.column("points.active")) {
        // The walls meet where the way is 2 R - T, at time .995.
        assert_eq!(active > 0.0, *time > 0.99, "{time}: {active}");
    }
    let at = |outcome: &Outcome, name: &str| outcome.at(name, 1.0);
    let push = [&whole, &half].map(|o| at(o, "force.push.z"));
    let before = [&whole, &half].map(|o| o.at("force.push.z", 0.9));
    println!("{push:?}, before {before:?}");
    assert!(push[0] < 2.0 * before[0], "{push:?} {before:?}");
    assert!(off(before[0], before[1]) < 1e-5, "{before:?}");
    assert!(off(push[0], push[1]) < 1e-3, "{push:?}");
    for name in ["imbalance.force.walls", "imbalance.moment.walls"] {
        let left = at(&whole, name);
        println!("{name}: {left:e}");
        assert!(left < 1e-12 * push[0].abs(), "{name}: {left}");
    }
}
