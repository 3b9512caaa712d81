//! The shipped press: two pads of an assembly in a STEP file, each a placed copy of one part, pressed into a rubber sheet. The
//! same pads as IGES faces and as JSON, whose placements are written out, press alike; and the sheet carries what they press.
use crate::support::{scene_json, set, solve, solve_in};
use covact_geometry::io::{read_path, write_iges, write_json};
use serde_json::{Value, json};
use std::path::Path;

/// The shipped scene on a coarse mesh, pressed by a millimetre.
fn coarse() -> Value {
    let mut scene = scene_json("press_pads.json");
    set(&mut scene, "/bodies/sheet/mesh/plate/elements", vec![20, 8]);
    scene["surfaces"]["pads"]["motion"]["translation"] = json!([0, 0, "-t"]);
    scene["solution"] =
        json!({ "newton": { "tolerance": 1e-11 }, "step": { "initial": 0.25, "max": 0.25 } });
    scene
}

#[test]
fn pads_of_an_assembly_press_as_their_copies_in_other_formats() {
    let step = solve(&coarse());
    assert_eq!(
        step.summary.status.name(),
        "done",
        "{:?}",
        step.summary.reason
    );
    let last = |name: &str| {
        let column = step.column(name);
        column[column.len() - 1]
    };
    let force = last("force.pads.z");
    // Pressed down, carried by the frame, and the second pad is the first one's mirror image.
    assert!(force < -1.0, "{force}");
    assert!((last("force.frame.z") + force).abs() < 1e-6 * force.abs());
    assert!(last("force.pads.x").abs() < 1e-6 * force.abs());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/cad/press.step");
    let mut file = read_path(&path).unwrap();
    assert_eq!(file.skipped, []);
    let names: Vec<Option<String>> = file.bodies.iter().map(|b| b.name.clone()).collect();
    assert_eq!(names.len(), 5, "{names:?}");
    let pad = |body: Option<usize>| body.is_some_and(|b| names[b].as_deref() == Some("pad"));
    file.patches.retain(|p| pad(p.tags.body));
    assert_eq!(
        file.patches.iter().filter(|p| p.instance != 0).count(),
        file.patches.len()
    );
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("pads.igs"), write_iges(&file).unwrap()).unwrap();
    std::fs::write(folder.path().join("pads.json"), write_json(&file).unwrap()).unwrap();
    for cad in [
        json!({ "file": "pads.igs" }),
        json!({ "file": "pads.json", "bodies": ["pad"] }),
    ] {
        let mut scene = coarse();
        scene["surfaces"]["pads"]["cad"] = cad.clone();
        let other = solve_in(&scene, folder.path());
        assert_eq!(
            other.summary.status.name(),
            "done",
            "{cad}: {:?}",
            other.summary.reason
        );
        for name in ["force.pads.z", "energy.internal", "energy.friction"] {
            let column = other.column(name);
            let (a, b) = (last(name), column[column.len() - 1]);
            assert!(
                a.abs() > 1e-6 && (a / b - 1.0).abs() < 1e-7,
                "{cad} {name}: {a} {b}"
            );
        }
    }
}
