//! Two blocks, one on the other.
use crate::support::{Outcome, solve};
use covact::solve::event::Event;
use serde_json::{Value, json};

/// Young's modulus and penalty of the patch test.
pub const E: f64 = 1e6;
pub const EPS: f64 = 1e8;
/// Displacement of the top.
pub const DELTA: f64 = 0.01;

/// The patch test of Crisfield as solids4foam poses it, in space: blocks of 1 x 1 x 0.5, `nu = 0`, the upper one on
/// `upper` x `upper` elements pressed by `DELTA` onto the lower one on `lower` x `lower`. The upper one is the slave.
pub fn patch(upper: u32, lower: u32, points: Value) -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": E, "nu": 0}}},
        "bodies": {
            "lower": {"mesh": {"block": {
                "min": [0, 0, -0.5], "max": [1, 1, 0], "elements": [lower, lower, 1]
            }}, "material": "m"},
            "upper": {"mesh": {"block": {
                "min": [0, 0, 0], "max": [1, 1, 0.5], "elements": [upper, upper, 1]
            }}, "material": "m"}
        },
        "contacts": {"press": {
            "slave": "upper.bottom", "master": "lower.top", "points": points,
            "penalty": {"value": EPS}
        }},
        "supports": {
            "ground": {"on": "lower.bottom", "displacement": {"z": 0}},
            "lower_x": {"on": "lower.x_min", "symmetry": "x"},
            "lower_y": {"on": "lower.y_min", "symmetry": "y"},
            "upper_x": {"on": "upper.x_min", "symmetry": "x"},
            "upper_y": {"on": "upper.y_min", "symmetry": "y"},
            "push": {"on": "upper.top", "displacement": {"z": format!("-{DELTA}*t")}}
        },
        "solution": {
            "step": {"initial": 1, "max": 1}, "newton": {"tolerance": 1e-13}, "threads": 1
        },
        "output": {"every": 1}
    })
}

/// Runs a scene to its end.
pub fn done(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    let status = outcome.summary.status.name();
    assert_eq!(status, "done", "{:?}", outcome.summary);
    outcome
}

/// Smallest and largest pressure at the nodes of the slave faces at the last step.
pub fn pressures(outcome: &Outcome, body: &str) -> [f64; 2] {
    let file = outcome.body(body, outcome.summary.steps);
    let (p, status) = (file.field("contact_pressure"), file.field("contact_status"));
    let on = p
        .iter()
        .zip(status)
        .filter(|(_, s)| **s == 2.0)
        .map(|(p, _)| *p);
    on.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| {
        [a.min(p), b.max(p)]
    })
}

/// Nominal pressure of the patch test: St. Venant-Kirchhoff columns under a stretch `s` bear `E s (s^2 - 1) / 2`, and
/// the penetration is what they leave of the way.
pub fn exact() -> f64 {
    let mut p = 9900.0;
    for _ in 0..50 {
        let s = 1.0 - (DELTA - p / EPS);
        let (f, df) = (
            p + 0.5 * E * s * (s * s - 1.0),
            1.0 + 0.5 * E * (3.0 * s * s - 1.0) / EPS,
        );
        p -= f / df;
    }
    p
}

/// A rubber block of 6 x 6 faces on a stiff block of 2 x 2 that is eight times as wide, whose faces are the slaves: the rubber lies between
/// their points. Its force is that of the same scene with its sides exchanged; before these were exchanged by the run, less than a third
/// of it was left at the end of three repetitions.
#[test]
fn a_master_between_the_points_of_its_slave_becomes_the_slave() {
    let scene = |slave: &str, master: &str| {
        json!({
            "covact": 1,
            "materials": {"rubber": {"neo_hooke": {"E": 1, "nu": 0.3}}, "steel": {"neo_hooke": {"E": 1e6, "nu": 0.3}}},
            "bodies": {
                "small": {"mesh": {"block": {
                    "min": [0.13, 0.21, 0], "max": [1.13, 1.21, 0.5], "elements": [6, 6, 3]
                }}, "material": "rubber", "element": "h8_displacement"},
                "large": {"mesh": {"block": {
                    "min": [-4, -4, -10], "max": [4, 4, 0], "elements": [2, 2, 1]
                }}, "material": "steel", "element": "h8_displacement"}
            },
            "contacts": {"c": {"slave": slave, "master": master}},
            "supports": {
                "floor": {"on": "large.bottom", "fixed": true},
                "push": {"on": "small.top", "displacement": {"x": 0, "y": 0, "z": "-0.1*t"}}
            },
            "output": {"every": 0}
        })
    };
    let [given, exchanged] =
        [["large.top", "small.bottom"], ["small.bottom", "large.top"]].map(|[slave, master]| {
            let outcome = done(&scene(slave, master));
            let told = |e: &&Event| match e {
                Event::Model { notes, .. } => {
                    notes.iter().any(|n| n.contains("its sides are exchanged"))
                }
                _ => false,
            };
            (
                outcome.at("force.push.z", 1.0),
                outcome.events.iter().filter(told).count(),
            )
        });
    println!("{given:?} {exchanged:?}");
    assert_eq!((given.1, exchanged.1), (1, 0));
    // About E A w / h, and more since the top cannot spread.
    assert!((-0.35..-0.2).contains(&exchanged.0), "{exchanged:?}");
    assert!((given.0 / exchanged.0 - 1.0).abs() < 1e-12);
}
