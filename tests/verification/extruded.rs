//! Bodies from surface meshes: the extruded plate bends as the generated one, and the shipped hat profile is in balance.
use crate::support::{scene_json, solve, solve_in};
use serde_json::{Value, json};
use std::fmt::Write;

/// A clamped strip pressed at its free end, with this mesh.
fn strip(mesh: Value) -> Value {
    json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 210000, "nu": 0.3 } } },
        "bodies": { "strip": { "mesh": mesh, "material": "steel" } },
        "supports": { "clamp": { "on": "strip.x_min", "fixed": true } },
        "loads": {
            "bend": { "on": "strip.x_max", "force": [0, 0, 20] },
            "press": { "on": "strip.top", "pressure": 0.01 }
        },
        "solution": { "step": { "initial": 0.5 } },
        "output": { "every": 0 }
    })
}

/// The extruded mesh of a plate gives the generated plate's displacements.
#[test]
fn an_extruded_plate_bends_as_the_generated_one() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut text = "*NODE\n".to_string();
    for j in 0..=3 {
        for i in 0..=8 {
            let (x, y) = (40.0 * f64::from(i) / 8.0, 10.0 * f64::from(j) / 3.0);
            writeln!(text, "{}, {x}, {y}, 2", 1 + i + 9 * j).expect("text");
        }
    }
    text += "*ELEMENT, TYPE=S4R\n";
    for j in 0..3 {
        for i in 0..8 {
            let a = 1 + i + 9 * j;
            writeln!(
                text,
                "{}, {a}, {}, {}, {}",
                1 + i + 8 * j,
                a + 1,
                a + 10,
                a + 9
            )
            .expect("text");
        }
    }
    std::fs::write(folder.path().join("strip.inp"), text).expect("written");
    let plate = json!({
        "plate": { "size": [40, 10], "thickness": 0.8, "elements": [8, 3], "layers": 2, "origin": [0, 0, 2] }
    });
    let file = json!({ "file": { "path": "strip.inp", "thickness": 0.8, "layers": 2 } });
    let ends = [plate, file].map(|mesh| {
        let outcome = solve_in(&strip(mesh), folder.path());
        assert_eq!(outcome.summary.status.name(), "done");
        let energy = outcome.at("energy.internal", 1.0);
        let reaction = outcome.at("force.clamp.z", 1.0);
        (energy, reaction)
    });
    println!("{ends:?}");
    assert!(ends[0].0 > 1.0);
    for (a, b) in [(ends[0].0, ends[1].0), (ends[0].1, ends[1].1)] {
        assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    }
}

/// The ball's force passes through the profile into the table, and sliding dissipates energy.
#[test]
fn the_hat_profile_carries_the_ball_to_the_table() {
    let outcome = solve(&scene_json("hat_pressed.json"));
    assert_eq!(outcome.summary.status.name(), "done");
    let (ball, table) = (
        outcome.at("force.ball.z", 1.0),
        outcome.at("force.table.z", 1.0),
    );
    println!(
        "{ball} {table}, {} iterations",
        outcome.summary.newton_iterations
    );
    assert!(ball < -10.0, "{ball}");
    // It begins to press at once: the crown's top is its outer side.
    assert!(outcome.at("force.ball.z", 0.1) < 0.0);
    assert!((ball + table).abs() < 1e-4 * table, "{ball} {table}");
    assert!(outcome.at("energy.dissipated", 1.0) > 0.0);
}
