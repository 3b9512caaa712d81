//! Trimmed faces as masters: there is no contact where a trim leaves nothing.
use super::trims::{four_faces, square};
use super::{off, solve_sheet_file};
use serde_json::{Value, json};

/// A block pressed on a plate with a hole that is held throughout, half over the hole: the trimmed face and four faces without a trim
/// press the same points with the same forces, less than without a hole, with friction from then on.
#[test]
fn a_block_on_a_plate_with_a_hole() {
    let run = |file: Value, master: &str| -> Vec<f64> {
        let scene = json!({
            "covact": 1,
            "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
            "bodies": {
                "plate": {"nurbs": {"file": "face.json", "thickness": 0.2, "elements": [5, 5]}, "material": "m"},
                "block": {
                    "mesh": {"block": {"min": [0.13, -0.4, 0.11], "max": [1.63, 0.5, 0.9], "elements": [9, 6, 2]}},
                    "material": "m"
                }
            },
            "supports": {
                "held": {"on": "plate", "fixed": true},
                "grip": {"on": "block.top", "displacement": {"x": "0.02*max(t - 1, 0)", "y": 0, "z": "-0.05*min(t, 1)"}}
            },
            "contacts": {"c": {
                "slave": "block.bottom", "master": master, "friction": {"coulomb": {"mu": 0.2}}, "points": {"gauss": 3}
            }},
            "solution": {
                "end_time": 2, "step": {"initial": 0.25, "max": 0.25}, "newton": {"tolerance": 1e-10}
            },
            "output": {"every": 0}
        });
        let outcome = solve_sheet_file(&file, &scene);
        assert_eq!(
            outcome.summary.status.name(),
            "done",
            "{:?}",
            outcome.summary.reason
        );
        let mut all = vec![outcome.at("force.grip.z", 1.0)];
        all.extend(["x", "z"].map(|c| outcome.at(&format!("force.grip.{c}"), 2.0)));
        all
    };
    let trimmed = run(square(1.0), "plate.top");
    // Their normals point down.
    let faces = run(four_faces(1.0), "plate.bottom");
    let whole = run(square(1e-3), "plate.top");
    println!("{trimmed:?} {faces:?} {whole:?}");
    assert!(trimmed[0].abs() < 0.8 * whole[0].abs());
    for (a, b) in trimmed.iter().zip(faces) {
        assert!(b.abs() > 0.01 && off(*a, b) < 1e-6, "{a} {b}");
    }
}
