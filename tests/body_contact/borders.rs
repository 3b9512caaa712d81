//! Bodies whose borders lie flush: a squeezed body is pushed past the border of the other.
use crate::support::{Outcome, solve};
use serde_json::{Value, json};

/// A block of rubber 20 x 4 x 3, symmetric at x = 0 and y = 0, whose side y = 4 is flush with the border of what lies below.
fn rubber(below: &Value) -> Value {
    let mut scene = json!({
        "covact": 1,
        "materials": {
            "s": {"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}},
            "r": {"neo_hooke": {"E": 6, "nu": 0.47}}
        },
        "bodies": {"g": {
            "mesh": {"block": {"min": [0, 0, 0], "max": [20, 4, 3], "elements": [20, 2, 4]}},
            "material": "r"
        }},
        "contacts": {"a": {"slave": "g.bottom", "master": "plane"}},
        "supports": {
            "y": {"on": "g.y_min", "symmetry": "y"},
            "x": {"on": "g.x_min", "symmetry": "x"},
            "u": {"on": "g.top", "displacement": {"x": 0, "z": "-0.5*t"}}
        },
        "output": {"every": 0}
    });
    match below["plane"].is_object() {
        true => scene["surfaces"] = json!({ "plane": below }),
        false => {
            scene["bodies"]["lo"] = below.clone();
            scene["contacts"]["a"]["master"] = json!("lo.top");
            scene["supports"]["f"] = json!({"on": "lo.bottom", "fixed": true});
        }
    }
    scene
}

fn done(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    assert_eq!(outcome.summary.status.name(), "done");
    outcome
}

/// The rows of nodes at the side slide off the border as the rubber bulges. Over steel the force is that over a rigid plane whose
/// border lies at the same place, which has the same rounding; how many iterations it takes is a regression. Nodes that were lost one
/// after the other, and came back, left a fifth of the force after five thousand.
#[test]
fn rubber_that_is_flush_with_steel_bears_as_over_a_rigid_plane() {
    let plane = done(&rubber(
        &json!({"plane": {"size": [28, 8], "center": [10, 0, 0]}}),
    ));
    let expected = plane.at("force.u.z", 1.0);
    assert!(expected < -100.0, "{expected}");
    // Matching meshes, and others.
    for (n, min, max) in [(9, -4, 24), (20, 0, 20)] {
        let steel = done(&rubber(&json!({
            "mesh": {"block": {"min": [min, 0, -5], "max": [max, 4, 0], "elements": [n, 1, 2]}}, "material": "s"
        })));
        let force = steel.at("force.u.z", 1.0);
        println!(
            "{n}: {force} for {expected}, {} iterations",
            steel.summary.newton_iterations
        );
        assert!(
            (force / expected - 1.0).abs() < 5e-3,
            "{n}: {force} {expected}"
        );
        assert!(steel.summary.newton_iterations < 600);
    }
}

/// A rubber mount 40 x 40 x 15 between steel plates that are larger than it by `more` all around, pressed together by 6 %.
fn mount(more: f64) -> f64 {
    let plate = |bottom: f64| {
        let (low, high) = (-more, 40.0 + more);
        json!({
            "mesh": {"block": {"min": [low, low, bottom], "max": [high, high, bottom + 4.0], "elements": [6, 6, 1]}},
            "material": "s"
        })
    };
    let outcome = done(&json!({
        "covact": 1,
        "materials": {
            "s": {"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}},
            "r": {"neo_hooke": {"E": 3, "nu": 0.48}}
        },
        "bodies": {
            "lower": plate(-4.0),
            "upper": plate(15.0),
            "pad": {
                "mesh": {"block": {"min": [0, 0, 0], "max": [40, 40, 15], "elements": [8, 8, 4]}},
                "material": "r"
            }
        },
        "contacts": {
            "a": {"slave": "pad.bottom", "master": "lower.top", "friction": 0.4},
            "b": {"slave": "pad.top", "master": "upper.bottom", "friction": 0.4}
        },
        "supports": {
            "f": {"on": "lower.bottom", "fixed": true},
            "p": {"on": "upper.top", "displacement": [0, 0, "-0.9*t"]}
        },
        "output": {"every": 0}
    }));
    println!("{more}: {} iterations", outcome.summary.newton_iterations);
    outcome.at("force.p.z", 1.0)
}

/// The rubber creeps past the edges of plates of its own size by a tenth of an element: nearly all of its faces still lie on them, so
/// that the force is that between larger plates. Nodes at the border, which stand for a quarter of the faces, tilted over the edge with
/// all of that: 19 % of the force was missing, without a word.
#[test]
fn a_mount_bears_between_plates_of_its_own_size_as_between_larger_ones() {
    let [same, larger] = [0.0, 5.0].map(mount);
    println!("{same} {larger}");
    assert!(
        larger < -400.0 && (same / larger - 1.0).abs() < 0.01,
        "{same} {larger}"
    );
}

/// A steel cover on a gasket of its own size, pressed on a flange by two bolts: nothing but contact with friction holds either. Both
/// contacts carry what the bolts pull. How many iterations that takes is a regression: it was 2,720 where nodes hung over the border,
/// and the first steps were cut until so soft a penalty held the cover.
#[test]
fn a_gasket_under_bolts_carries_their_force() {
    let bolt = |low: f64| json!({"faces_in_box": {"min": [low - 0.1, 4.9, 5.9], "max": [low + 10.1, 15.1, 6.1]}});
    let force = || json!([0, 0, "-300*t"]);
    let plate = |thickness: f64, elements: [u32; 2], middle: f64| {
        json!({"plate": {
            "size": [60, 20], "thickness": thickness, "elements": elements, "origin": [0, 0, middle]
        }})
    };
    let outcome = done(&json!({
        "covact": 1,
        "materials": {
            "r": {"neo_hooke": {"E": 6, "nu": 0.48}},
            "s": {"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}}
        },
        "bodies": {
            "gasket": {"mesh": plate(2.0, [18, 6], 1.0), "material": "r"},
            "cover": {
                "mesh": plate(4.0, [12, 4], 4.0), "material": "s", "sets": {"left": bolt(5.0), "right": bolt(45.0)}
            }
        },
        "surfaces": {"flange": {"plane": {"size": [100, 50], "center": [30, 10, 0]}}},
        "contacts": {
            "below": {"slave": "gasket.bottom", "master": "flange", "friction": 0.3},
            "above": {"slave": "gasket.top", "master": "cover.bottom", "friction": 0.3}
        },
        "loads": {
            "left": {"on": "cover.left", "force": force()},
            "right": {"on": "cover.right", "force": force()}
        },
        "output": {"every": 0}
    }));
    for name in ["force.flange.z", "slave.force.above.z"] {
        let force = outcome.at(name, 1.0).abs();
        assert!((force / 600.0 - 1.0).abs() < 1e-4, "{name}: {force}");
    }
    let iterations = outcome.summary.newton_iterations;
    println!("{iterations} iterations");
    assert!(iterations < 250, "{iterations}");
}

/// A pin in its bore, of polygons with `n` and `m` sides: force along z on the pin that is moved by .02 more than the clearance.
fn pin(n: u32, m: u32) -> f64 {
    let ring = |radius: f64, thickness: f64, n: u32, layers: u32, material: &str| {
        json!({"mesh": {"cylinder_panel": {
            "radius": radius, "thickness": thickness, "angles": [0, 360], "y": [0, 2], "elements": [n, 1], "layers": layers
        }}, "material": material})
    };
    let outcome = done(&json!({
        "covact": 1,
        "materials": {
            "s": {"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}},
            "a": {"st_venant_kirchhoff": {"E": 70000, "nu": 0.33}}
        },
        "bodies": {"p": ring(7.475, 4.95, n, 2, "s"), "l": ring(17.5, 15.0, m, 6, "a")},
        "contacts": {"c": {"slave": "p.outer", "master": "l.inner"}},
        "supports": {
            "y": {"on": ["p.y_min", "p.y_max", "l.y_min", "l.y_max"], "symmetry": "y"},
            "f": {"on": "l.outer", "fixed": true},
            "h": {"on": "p.inner", "displacement": {"x": 0, "z": "0.07*t"}}
        },
        "output": {"every": 0}
    }));
    outcome.at("force.h.z", 1.0)
}

/// The sides of the pin's polygon lie up to .038 off its circle, with a clearance of .05: measured from them the pin is .02 away where it
/// should bear, and the force was half of that of a mesh four times as fine.
#[test]
fn a_pin_in_its_bore_bears_as_round_ones_do() {
    let [coarse, fine] = [pin(36, 72), pin(144, 144)];
    println!("{coarse} {fine}");
    assert!(
        fine > 1000.0 && (coarse / fine - 1.0).abs() < 0.1,
        "{coarse} {fine}"
    );
}
