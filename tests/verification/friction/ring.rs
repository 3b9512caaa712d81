//! A ring that is squeezed between two plates with friction widens along its axis where it is bent, which friction resists along the
//! lines where it lies on the plates: a force that a normal penalty which serves the ring says nothing of. The reference is the same
//! ring with a tangential penalty that is given, ten and a hundred times as stiff as what is needed.
use crate::support::{Outcome, solve};
use covact::output::RunStatus;
use serde_json::{Value, json};

fn ring(tangential: Option<f64>) -> Outcome {
    let mut contact = json!({ "slave": "ring.outer", "friction": 0.2 });
    if let Some(value) = tangential {
        contact["tangential_penalty"] = json!({ "value": value });
    }
    let on = |plate: &str| -> Value {
        let mut contact = contact.clone();
        contact["master"] = json!(plate);
        contact
    };
    let outcome = solve(&json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 205000, "nu": 0.3 } } },
        "bodies": { "ring": {
            "mesh": { "cylinder_panel": {
                "radius": 45, "thickness": 1.2, "angles": [0, 360], "y": [0, 12], "elements": [64, 2], "center": [0, 0, 0]
            } },
            "material": "steel"
        } },
        "surfaces": {
            "lower": { "plane": { "size": [300, 100], "center": [0, 6, -45.6], "normal": [0, 0, 1] } },
            "upper": {
                "plane": { "size": [300, 100], "center": [0, 6, 45.6], "normal": [0, 0, -1] },
                "motion": { "translation": [0, 0, "-20*t"] }
            }
        },
        "contacts": { "below": on("lower"), "above": on("upper") },
        "supports": { "y": { "on": "ring.y_min", "symmetry": "y" } },
        "output": { "every": 0 }
    }));
    assert_eq!(outcome.summary.status, RunStatus::Done);
    outcome
}

#[test]
fn friction_along_a_squeezed_ring_does_not_give_way() {
    let [own, stiff, stiffer] = [None, Some(2e4), Some(2e5)].map(ring);
    let force = |outcome: &Outcome, time: f64| outcome.at("force.lower.y", time);
    for time in [0.5, 1.0] {
        let [own, stiff, stiffer] = [&own, &stiff, &stiffer].map(|o| force(o, time));
        println!("{own}, {stiff}, {stiffer} at {time}");
        assert!(
            stiff < -20.0 && (stiff / stiffer - 1.0).abs() < 1e-6,
            "{stiff}, {stiffer}"
        );
        assert!((own / stiff - 1.0).abs() < 0.01, "{own} of {stiff}");
    }
    let warnings = &own.summary.warnings;
    assert!(
        !warnings.iter().any(|w| w.contains("tangential")),
        "{warnings:?}"
    );
}
