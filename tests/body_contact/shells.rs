//! A shell pressed on a shell: an arch comes down on a clamped plate, both of them thin.
use crate::blocks::done;
use crate::support::Outcome;
use serde_json::{Value, json};

/// A quarter of the plate (10 long, 4 wide) and of the arch of radius 20 above it (3.7 wide, lest its edge slide off), whose ends move down by `depth` in
/// `steps` steps. The arch is the slave.
pub fn arch_on_plate(depth: f64, steps: u32, points: Value) -> Value {
    let step = 1.0 / f64::from(steps);
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0.3}}},
        "bodies": {
            "plate": {"mesh": {"plate": {
                "size": [10, 4], "thickness": 0.3, "elements": [10, 3]
            }}, "material": "m"},
            "arch": {"mesh": {"cylinder_panel": {
                "radius": 20, "thickness": 0.3, "angles": [160, 180], "y": [0, 3.7],
                "elements": [8, 2], "origin": [0, 0, 20.31]
            }}, "material": "m"}
        },
        "contacts": {"press": {
            "slave": "arch.outer", "master": "plate.top", "points": points,
            "penalty": {"value": 300}
        }},
        "supports": {
            "clamped": {"on": "plate.x_max", "fixed": true},
            "plate_x": {"on": "plate.x_min", "symmetry": "x"},
            "plate_y": {"on": "plate.y_min", "symmetry": "y"},
            "arch_x": {"on": "arch.phi_max", "symmetry": "x"},
            "arch_y": {"on": "arch.y_min", "symmetry": "y"},
            "push": {"on": "arch.phi_min", "displacement": {"z": format!("-{depth}*t")}}
        },
        "solution": {
            "step": {"initial": step, "max": step},
            "newton": {"tolerance": 1e-11}, "threads": 1
        },
        "output": {"every": 0}
    })
}

/// Largest force between the sides of a pair, and the largest imbalances of force and moment.
pub fn balance(outcome: &Outcome, pair: &str) -> [f64; 3] {
    let largest = |name: String| {
        let column = outcome.column(&name);
        column.iter().fold(0.0f64, |a, x| a.max(x.abs()))
    };
    [
        largest(format!("slave.force.{pair}.z")),
        largest(format!("imbalance.force.{pair}")),
        largest(format!("imbalance.moment.{pair}")),
    ]
}

/// What one side feels the other feels: the sums over the nodes of both bodies, for every kind of slave points and both
/// surfaces, under a large deflection.
#[test]
fn both_sides_feel_the_same() {
    for points in [json!("nodes"), json!({"gauss": 3}), json!({"lobatto": 2})] {
        for surface in ["faces", "smooth"] {
            let mut scene = arch_on_plate(2.0, 4, points.clone());
            scene["contacts"]["press"]["master_surface"] = json!(surface);
            let outcome = done(&scene);
            let [force, sum, moment] = balance(&outcome, "press");
            println!("{points} {surface}: force {force:.4}, off by {sum:.1e}, {moment:.1e}");
            assert!(force > 1.0);
            // Moments are taken about the origin, ten lengths away.
            assert!(sum < 1e-12 * force, "{points} {surface}");
            assert!(moment < 1e-11 * force, "{points} {surface}");
            let reaction = outcome.column("force.clamped.z");
            let on_plate = outcome.column("master.force.press.z");
            for (r, f) in reaction.iter().zip(&on_plate) {
                assert!((r + f).abs() < 1e-8 * force, "{r} {f}");
            }
        }
    }
}
