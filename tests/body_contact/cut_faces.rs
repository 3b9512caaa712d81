//! Sets of faces that a box selects take the faces in planes of symmetry along.
use crate::support::solve;
use covact::solve::event::Event;
use serde_json::{Value, json};

/// A slice of a block pressed into a slice of another one, both between planes of symmetry: the force, and what is told.
fn pressed(sets: Value, slave: &str, master: &str) -> (f64, Vec<String>) {
    let block = |min: [f64; 3], max: [f64; 3], elements: [u32; 3]| json!({ "min": min, "max": max, "elements": elements });
    let run = solve(&json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 10, "nu": 0.3}}},
        "bodies": {
            "upper": {
                "mesh": {"block": block([-2.0, 0.0, 0.02], [2.0, 0.5, 2.0], [7, 1, 3])}, "material": "m",
                "sets": {"skin": sets["upper"]}
            },
            "lower": {
                "mesh": {"block": block([-4.0, 0.0, -3.0], [4.0, 0.5, 0.0], [12, 1, 4])}, "material": "m",
                "sets": {"skin": sets["lower"]}
            }
        },
        "contacts": {"c": {"slave": slave, "master": master}},
        "supports": {
            "planes": {"on": ["upper.y_min", "upper.y_max", "lower.y_min", "lower.y_max"], "symmetry": "y"},
            "ground": {"on": "lower.z_min", "fixed": true},
            "press": {"on": "upper.z_max", "displacement": {"x": 0, "y": 0, "z": "-0.3*t"}}
        },
        "output": {"every": 0}
    }));
    assert_eq!(run.summary.status.name(), "done");
    let notes = run.events.iter().flat_map(|e| match e {
        Event::Model { notes, .. } => notes.clone(),
        _ => Vec::new(),
    });
    let notes = notes.filter(|n| n.contains("plane of symmetry")).collect();
    (run.at("force.ground.z", 1.0), notes)
}

/// All slave points lie in the planes of symmetry, where their distance from the master's faces in those planes is nothing: the bodies
/// went through each other without a force. Such faces are left out and told of; what is left is the force of the sides that
/// face each other, but for the areas of nodes at their borders.
#[test]
fn faces_in_planes_of_symmetry_take_no_part() {
    let sets = json!({
        "upper": {"faces_in_box": {"min": [-3, -1, -1], "max": [3, 1, 1.4]}},
        "lower": {"faces_in_box": {"min": [-5, -1, -2.3], "max": [5, 1, 1]}}
    });
    let (facing, none) = pressed(sets.clone(), "upper.z_min", "lower.z_max");
    let (skins, told) = pressed(sets, "upper.skin", "lower.skin");
    println!("{facing} {skins} {told:?}");
    assert!(none.is_empty(), "{none:?}");
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(
        told[0].contains("of the") && told[0].contains("`upper.skin`"),
        "{told:?}"
    );
    assert!(
        facing > 0.5 && (skins / facing - 1.0).abs() < 0.01,
        "{skins} {facing}"
    );
}
