//! A block that slides far over another: the facets that it touches change, and the system's structure with them.
use crate::blocks::done;
use serde_json::{Value, json};

/// A block of side 1 pressed into a long one and drawn along it by `way`.
pub fn slide(way: f64, steps: u32) -> Value {
    let step = 0.5 / f64::from(steps);
    json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
        "bodies": {
            "bed": {"mesh": {"block": {
                "min": [0, 0, -1], "max": [8, 1, 0], "elements": [24, 2, 2]
            }}, "material": "m"},
            "sledge": {"mesh": {"block": {
                "min": [1, 0, 0.01], "max": [2, 1, 0.6], "elements": [4, 3, 2]
            }}, "material": "m"}
        },
        "contacts": {"press": {
            "slave": "sledge.bottom", "master": "bed.top", "points": {"gauss": 2}
        }},
        "supports": {
            "ground": {"on": "bed.bottom", "fixed": true},
            "bed_y": {"on": "bed.y_min", "symmetry": "y"},
            "sledge_y": {"on": "sledge.y_min", "symmetry": "y"},
            "push": {"on": "sledge.top", "displacement": {
                "x": {"table": [[0, 0], [0.5, 0], [1, way]]}, "y": 0,
                "z": {"table": [[0, 0], [0.5, -0.05], [1, -0.05]]}
            }}
        },
        "solution": {
            "step": {"initial": step, "max": step},
            "newton": {"tolerance": 1e-9}, "threads": 1
        },
        "output": {"every": 0}
    })
}

#[test]
fn the_structure_follows_a_sliding_block() {
    let outcome = done(&slide(4.0, 16));
    let rebuilds = outcome.summary.pattern_rebuilds;
    let iterations = outcome.summary.newton_iterations;
    println!(
        "{rebuilds} rebuilds, {iterations} iterations, {} steps",
        outcome.summary.steps
    );
    assert!(rebuilds >= 3, "{rebuilds}");
    assert!(u64::from(rebuilds) * 4 < iterations, "{rebuilds}");
    // Without friction nothing but the bed's edges and facets holds the block back.
    let down = outcome.at("slave.force.press.z", 1.0);
    let along = outcome.at("slave.force.press.x", 1.0);
    println!("{down} {along}");
    assert!(down > 1.0 && along.abs() < 0.05 * down, "{down} {along}");
}
