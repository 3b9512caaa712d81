//! Self contact: a tube is pinched until its walls meet.
use crate::support::solve;
use covact::solve::event::Event;
use serde_json::{Value, json};

/// Radius and thickness of the tube.
pub const R: f64 = 10.0;
pub const T: f64 = 0.5;

/// Half of a ring of one element's width whose top is pushed down by `way`; the inner faces are slave and master.
pub fn pinched(way: f64, points: Value) -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0}}},
        "bodies": {"tube": {"mesh": {"cylinder_panel": {
            "radius": R, "thickness": T, "angles": [0, 180], "y": [0, 1], "elements": [32, 1]
        }}, "material": "m"}},
        "contacts": {"walls": {"slave": "tube.inner", "master": "tube.inner", "points": points}},
        "supports": {
            "top": {"on": "tube.phi_min", "symmetry": "x"},
            "bottom": {"on": "tube.phi_max", "symmetry": "x"},
            "front": {"on": "tube.y_min", "symmetry": "y"},
            "back": {"on": "tube.y_max", "symmetry": "y"},
            "push": {"on": "tube.phi_min", "mid_surface": true, "displacement": {
                "z": {"table": [[0, 0], [0.9, -19.3], [1, -way]]}
            }},
            "ground": {"on": "tube.phi_max", "mid_surface": true, "displacement": {"z": 0}}
        },
        "solution": {
            "step": {"initial": 0.05, "max": 0.05}, "newton": {"tolerance": 1e-9}, "threads": 1
        },
        "output": {"every": 0}
    })
}

#[test]
fn the_walls_of_a_pinched_tube_touch_and_nothing_else_does() {
    // The walls meet at 2 R - T; beyond that they are pressed.
    let outcome = solve(&pinched(2.0 * R - T + 0.05, json!("nodes")));
    let (time, active) = (outcome.column("time"), outcome.column("points.active"));
    let gap = outcome.column("gap.min");
    println!("{:?}", outcome.summary);
    for ((t, active), gap) in time.iter().zip(&active).zip(&gap) {
        println!("{t:.3}: {active} active, gap {gap:.4}");
        if *t < 0.91 {
            assert!(*active == 0.0, "contact at {t}, before the walls meet");
        }
    }
    assert_eq!(outcome.summary.status.name(), "done");
    assert!(*active.last().expect("steps") > 0.0);
    let on = |name: &str| outcome.at(&format!("{name}.z"), 1.0);
    // Both faces are slaves: what they feel as slaves and as masters sums up to nothing.
    let imbalance = outcome.at("imbalance.force.walls", 1.0);
    let push = on("force.push");
    println!(
        "push {push}, ground {}, imbalance {imbalance:e}",
        on("force.ground")
    );
    assert!(push < -0.01 && (push + on("force.ground")).abs() < 1e-6 * push.abs());
    assert!(imbalance < 1e-12);
}

/// The walls of a tube that is pressed by half its height do not meet: a contact of a body with itself guards against what need not
/// happen, and the run has reached its end.
#[test]
fn walls_that_do_not_meet_end_no_run() {
    let mut scene = pinched(R, json!("nodes"));
    scene["supports"]["push"]["displacement"]["z"] = json!("-10*t");
    scene["solution"]["step"] = json!({"initial": 0.2, "max": 0.2});
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "done");
    assert!(outcome.column("points.active").iter().all(|n| *n == 0.0));
    assert!(outcome.at("force.push.z", 1.0) < -0.01);
    let told = |e: &Event| matches!(e, Event::Note { text } if text.contains("contact `walls` never touched"));
    assert!(outcome.events.iter().any(told));
}
