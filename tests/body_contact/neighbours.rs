//! Contacts of one slave with neighbouring faces of a body.
use crate::support::{Outcome, solve};
use covact::solve::event::Event;
use serde_json::{Value, json};

/// A steel strip, held at its left end, that a block presses down with its lower edge, at x = 0: to the left of the edge the strip
/// stands in front of the block's side, to the right below its bottom. `contacts` are those of the strip's top with the block.
fn strip(contacts: &Value) -> Value {
    json!({
        "covact": 1,
        "materials": {"s": {"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}}},
        "bodies": {
            "k": {
                "mesh": {"block": {"min": [0, 0, 0.05], "max": [6, 2, 5], "elements": [4, 1, 4]}}, "material": "s"
            },
            "h": {
                "mesh": {"plate": {"size": [20, 2], "thickness": 0.4, "elements": [23, 1], "origin": [-15, 0, -0.2]}},
                "material": "s"
            }
        },
        "contacts": contacts,
        "supports": {
            "y": {"on": ["k", "h"], "symmetry": "y"},
            "f": {"on": "h.x_min", "fixed": true},
            "u": {"on": "k.top", "displacement": {"x": "-0.8*t", "z": "-6*t"}}
        },
        "output": {"every": 0}
    })
}

fn solved(contacts: &Value) -> Outcome {
    let outcome = solve(&strip(contacts));
    assert_eq!(outcome.summary.status.name(), "done");
    outcome
}

/// The edge between both masters belongs to one contact, told under the name of the first: the same bits as where the scene says so,
/// with the sets in the same order. Each by itself the masters ended there, and the strip was held by both, which did not end.
#[test]
fn contacts_with_neighbouring_faces_are_one() {
    let contact = |master: Value| json!({"slave": "h.top", "master": master, "friction": 0.1});
    let one = solved(&json!({"c": contact(json!(["k.bottom", "k.x_min"]))}));
    let two = solved(&json!({"c": contact(json!("k.bottom")), "d": contact(json!("k.x_min"))}));
    let told = |outcome: &Outcome| {
        let notes = outcome.events.iter().filter_map(|e| match e {
            Event::Model { notes, .. } => Some(notes),
            _ => None,
        });
        (notes.flatten()).any(|n| n.contains("neighbouring faces"))
    };
    assert_eq!([told(&one), told(&two)], [false, true]);
    let force = one.at("slave.force.c.z", 1.0);
    assert!(force < -10.0, "{force}");
    assert_eq!(one.history.columns, two.history.columns);
    assert_eq!(one.history.rows, two.history.rows);
    // Other friction makes other contacts of them.
    let mut scene =
        strip(&json!({"c": contact(json!("k.bottom")), "d": contact(json!("k.x_min"))}));
    scene["contacts"]["d"]["friction"] = json!(0.2);
    scene["solution"] = json!({"end_time": 1e-3});
    let apart = solve(&scene);
    assert!(!told(&apart) && apart.history.column("slave.force.d.z").is_some());
}
