//! A flat belt on two pulleys, one turned, the other driven back by a moment and pulled off by a force: the creep of belts
//! (O. Reynolds, "On the efficiency of belts or straps as communicators of work", The Engineer 38, 1874).
//!
//! ```text
//!         ,-----.  <---------- tight, T1 ----------- ,-----.
//!       /         \                                /         \      2 T = force that pulls the pulleys apart,
//!      |  turned   |                              |   moment  | -->  (T1 - T2) R = moment.
//!       \         /                                \         /
//!         `-----'  ----------- slack, T2 ----------> `-----'
//! ```
//!
//! Where the belt comes on a pulley it sticks, so that the rim goes as fast as it does: that of the turned pulley as fast as the
//! tight part, that of the other as fast as the slack one. As much of the belt leaves a pulley as comes on it, so the speeds are as
//! the stretches, and the driven pulley falls behind by `1 - (1 + T2 / EA) / (1 + T1 / EA)`. What sticks and what slides changes
//! with every element that comes on or leaves, on both pulleys, and friction is all that holds the driven one.
use crate::support::solve_in;
use serde_json::json;
use std::f64::consts::PI;
use std::fmt::Write;

const R: f64 = 10.0;
const H: f64 = 0.5;
const WIDTH: f64 = 4.0;
const APART: f64 = 50.0;
const E: f64 = 500.0;
/// Force that pulls the pulleys apart, and moment on the driven one.
const FORCE: f64 = 40.0;
const MOMENT: f64 = 30.0;
/// What comes on a pulley and leaves it does so by whole elements: on 100 to 140 of them the creep is 1 to 6 % too small.
const ELEMENTS: usize = 140;

/// The belt, as an Abaqus file of one row of bricks: straight above from the first pulley to the second one, round it, and back.
fn belt() -> String {
    let (half, length) = (PI * R, 2.0 * (APART + PI * R));
    let at = |i: usize, r: f64| {
        let s = length * i as f64 / ELEMENTS as f64;
        if s < APART {
            return [s, r];
        }
        if s < APART + half {
            let a = (s - APART) / R;
            return [APART + r * a.sin(), r * a.cos()];
        }
        if s < 2.0 * APART + half {
            return [2.0 * APART + half - s, -r];
        }
        let a = (s - 2.0 * APART - half) / R;
        [-r * a.sin(), -r * a.cos()]
    };
    let mut text = String::from("*NODE\n");
    for i in 0..ELEMENTS {
        for (k, (y, r)) in [(0.0, R), (0.0, R + H), (WIDTH, R), (WIDTH, R + H)]
            .into_iter()
            .enumerate()
        {
            let ([x, z], n) = (at(i, r), 4 * i + k + 1);
            let _ = writeln!(text, "{n}, {x}, {}, {z}", y - 0.5 * WIDTH);
        }
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=all\n";
    for i in 0..ELEMENTS {
        let (a, b) = (4 * i + 1, 4 * ((i + 1) % ELEMENTS) + 1);
        let _ = writeln!(
            text,
            "{}, {a}, {b}, {}, {}, {}, {}, {}, {}",
            i + 1,
            b + 2,
            a + 2,
            a + 1,
            b + 1,
            b + 3,
            a + 3
        );
    }
    text += "*SURFACE, NAME=inner, TYPE=ELEMENT\nall, S1\n*NSET, NSET=side\n";
    for i in 0..ELEMENTS {
        let _ = writeln!(text, "{}, {}", 4 * i + 1, 4 * i + 2);
    }
    text
}

#[test]
fn the_driven_pulley_creeps() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("belt.inp"), belt()).expect("written");
    let contact = |pulley: &str| json!({"slave": "belt.inner", "master": pulley, "friction": {"coulomb": {"mu": 0.3}}});
    let scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": E, "nu": 0}}},
        "bodies": {"belt": {"mesh": {"file": {"path": "belt.inp"}}, "material": "m", "element": "h8"}},
        "surfaces": {
            "turned": {
                "cylinder": {"radius": R, "length": 20},
                "motion": {"rotation": {"axis": [0, 1, 0], "angle": {"table": [[0, 0], [2, 0], [14, 1080]]}}}
            },
            "driven": {
                "cylinder": {"radius": R, "length": 20, "center": [APART, 0, 0]},
                "motion": {"free": {
                    "force": {"x": {"table": [[0, 0], [1, FORCE]]}},
                    "moment": {"y": {"table": [[0, 0], [1, 0], [2, -MOMENT]]}}
                }}
            }
        },
        "contacts": {"a": contact("turned"), "b": contact("driven")},
        "supports": {"side": {"on": "belt.side", "symmetry": "y"}},
        // The belt goes round once from the stop to the end.
        "solution": {"end_time": 14, "stops": [3.6]},
        "output": {"every": 0}
    });
    let outcome = solve_in(&scene, folder.path());
    let rotation = |time: f64| outcome.at("rotation.driven.y", time);
    let turned = 90.0 * (14.0 - 3.6);
    let creep = 1.0 - (rotation(14.0) - rotation(3.6)) / turned;
    let tension = |sign: f64| 0.5 * (FORCE + sign * MOMENT / R) / (E * H * WIDTH);
    let expected = 1.0 - (1.0 + tension(-1.0)) / (1.0 + tension(1.0));
    println!("creep {creep:.3e}, expected {expected:.3e}");
    assert!((creep / expected - 1.0).abs() < 0.05);
    let force = outcome.at("force.turned.x", 14.0);
    assert!((force / FORCE + 1.0).abs() < 1e-6, "{force}");
    // A regression: some six iterations a step, in steps of more than an element.
    let iterations = outcome.summary.newton_iterations;
    println!("{} steps, {iterations} iterations", outcome.summary.steps);
    assert!(iterations < 2500, "{iterations}");
}
