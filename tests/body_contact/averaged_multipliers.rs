//! Multipliers of slave nodes whose gaps are averaged.
use crate::blocks::{DELTA, E, done, patch, pressures};
use crate::friction::last;
use serde_json::{Value, json};

fn averaged(scene: &mut Value, contact: &str, augmentation: Value) {
    let contact = &mut scene["contacts"][contact];
    contact["gap"] = json!("averaged");
    contact["augmentation"] = augmentation;
}

/// Both layers of the patch test as one, `E (e + 3/2 e^2 + 1/2 e^3)` with `e = -DELTA` (St. Venant-Kirchhoff, nu = 0): meshes that
/// match press each other by it at every node, with nothing left of the gap.
#[test]
fn two_layers_become_one() {
    let mut scene = patch(3, 3, json!({"gauss": 3}));
    averaged(&mut scene, "press", json!({"gap": 1e-10, "max": 60}));
    let outcome = done(&scene);
    let e = -DELTA;
    let p = -E * (e + 1.5 * e * e + 0.5 * e * e * e);
    let [low, high] = pressures(&outcome, "upper");
    let left = last(&outcome, "penetration.max");
    let often = last(&outcome, "augmentations");
    println!("{p} {low} {high}, {left:e} left after {often}");
    assert!(often >= 2.0 && left.abs() < 1e-10);
    assert!((low / p - 1.0).abs() < 1e-7 && (high / p - 1.0).abs() < 1e-7);
}

/// Blocks with meshes that do not match, the upper one smaller than the lower one, pressed into each other.
fn blocks(points: Value) -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
        "bodies": {
            "lower": {"mesh": {"block": {
                "min": [-0.7, -0.7, -0.5], "max": [0.7, 0.7, 0], "elements": [3, 3, 2]
            }}, "material": "m"},
            "upper": {"mesh": {"block": {
                "min": [-0.5, -0.5, 0], "max": [0.5, 0.5, 0.5], "elements": [4, 2, 2]
            }}, "material": "m"}
        },
        "contacts": {"press": {
            "slave": "upper.bottom", "master": "lower.top", "points": points, "gap": "averaged"
        }},
        "supports": {
            "ground": {"on": "lower.bottom", "fixed": true},
            "push": {"on": "upper.top", "displacement": {
                "x": 0, "y": 0, "z": "-0.04*t"
            }}
        },
        "solution": {
            "step": {"initial": 0.125, "max": 0.125}, "newton": {"tolerance": 1e-11}, "threads": 1
        },
        "output": {"every": 0}
    })
}

/// What penalties leave falls with their reciprocal, and what is left in the limit is the answer with multipliers.
#[test]
fn penalties_lead_to_what_multipliers_say() {
    for points in [json!({"gauss": 3}), json!({"lobatto": 4})] {
        let run = |key: &str, value: Value| {
            let mut scene = blocks(points.clone());
            scene["contacts"]["press"][key] = value;
            let outcome = done(&scene);
            (
                last(&outcome, "slave.force.press.z"),
                outcome.summary.newton_iterations,
            )
        };
        let (limit, iterations) = run("augmentation", json!({"gap": 1e-9, "max": 60}));
        let off = [2e4, 2e5, 2e6].map(|eps| limit - run("penalty", json!({"value": eps})).0);
        println!("{points}: {limit} in {iterations} iterations, penalties off by {off:?}");
        assert!(limit > 5.0 && off[0] > 0.003 * limit);
        for pair in off.windows(2) {
            assert!((pair[0] / pair[1] - 10.0).abs() < 0.7, "{off:?}");
        }
        // Averaged gaps ask no more of the faces than their nodes can give, so that multipliers settle at once.
        assert!(iterations < 120, "{iterations}");
    }
}

/// A ball on a plate: the same on a rigid surface, whose force is prescribed, so that its way is what penalties change.
#[test]
fn a_ball_that_a_force_presses_lies_where_stiff_penalties_let_it() {
    let run = |key: &str, value: Value| {
        let mut scene = json!({
            "covact": 1,
            "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
            "bodies": {"plate": {"mesh": {"plate": {
                "size": [4, 4], "thickness": 0.2, "elements": [8, 8], "origin": [-2, -2, 0.1]
            }}, "material": "m"}},
            "surfaces": {"ball": {
                "sphere": {"radius": 2, "center": [0.1, 0.05, 2.25]},
                "motion": {"free": {"force": {"z": "-0.2*t"}}}
            }},
            "contacts": {"press": {
                "slave": "plate.top", "master": "ball", "points": {"gauss": 3}, "gap": "averaged"
            }},
            "supports": {"edges": {"on": ["plate.x_min", "plate.x_max"], "fixed": true}},
            "solution": {
                "step": {"initial": 0.25, "max": 0.25}, "newton": {"tolerance": 1e-11}, "threads": 1
            },
            "output": {"every": 0}
        });
        scene["contacts"]["press"][key] = value;
        let outcome = done(&scene);
        assert!((last(&outcome, "force.ball.z").abs() - 0.2).abs() < 1e-9);
        last(&outcome, "way.ball.z")
    };
    let limit = run("augmentation", json!({"gap": 1e-9, "max": 60}));
    let off = [1e2, 1e3, 1e4].map(|eps| limit - run("penalty", json!({"value": eps})));
    println!("{limit}, penalties off by {off:?}");
    assert!(limit < -0.1 && off[0].abs() > 1e-4 * limit.abs());
    for pair in off.windows(2) {
        assert!((pair[0] / pair[1] - 10.0).abs() < 1.0, "{off:?}");
    }
}
