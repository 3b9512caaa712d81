//! The ball dragged over hills and the sheet drawn through a bead, both with friction on rigid CAD surfaces.
use crate::support::{Outcome, scene_json, set, solve};
use serde_json::json;

/// Steps that failed, and Newton iterations a step.
pub fn effort(outcome: &Outcome) -> (f64, f64) {
    let (cuts, iterations) = (outcome.column("cuts"), outcome.column("iterations"));
    let mean = iterations.iter().sum::<f64>() / iterations.len() as f64;
    (cuts.iter().sum(), mean)
}

/// A coarse bowl instead of the ball, which starts beside the point where four patches meet, (4, 4), and is dragged over
/// their four borders; `file` are the hills.
fn over_the_corner(file: &str) -> Outcome {
    let mut scene = scene_json("ball_drag.json");
    set(
        &mut scene,
        "/surfaces/hills/cad/file",
        format!("../../assets/cad/{file}"),
    );
    let panel = json!({
        "radius": 12.5, "thickness": 5, "longitude": [110, 250], "latitude": [-60, 60], "elements": [16, 12]
    });
    scene["bodies"]["ball"]["mesh"] = json!({ "sphere_panel": panel });
    scene["bodies"]["ball"]["placement"] = json!({ "translation": [-1, 1, 14.6] });
    let motion = json!({
        "x": { "table": [[0, 0], [1, 0], [4, 7]] },
        "y": { "table": [[0, 0], [1, 0], [4, 5]] },
        "z": { "table": [[0, 0], [1, -0.8], [4, -0.6]] }
    });
    scene["supports"] = json!({
        "hand": { "on": "ball.inner", "displacement": motion }
    });
    scene["solution"] = json!({
        "end_time": 4, "newton": { "tolerance": 1e-11 },
        "step": { "initial": 0.25, "max": 0.25, "adaptive": false }
    });
    scene["output"] = json!({ "every": 0 });
    solve(&scene)
}

/// Eight patches of mixed orders, with exchanged, reversed and graded parameters, are the one bicubic they were cut from:
/// forces, slip and dissipation know nothing of the borders.
#[test]
fn borders_of_patches_are_not_felt() {
    let (many, one) = (
        over_the_corner("hills.igs"),
        over_the_corner("hills_one.json"),
    );
    for outcome in [&many, &one] {
        let summary = &outcome.summary;
        assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
        let (cuts, iterations) = effort(outcome);
        // A limit of what it costs: a step that turns with the motion takes most.
        assert!(cuts == 0.0 && iterations <= 8.5, "{cuts} {iterations}");
    }
    let slip = one.column("points.slip");
    let most = slip.iter().fold(0.0f64, |a, b| a.max(*b));
    assert!(most >= 10.0, "{slip:?}");
    for name in [
        "force.hills.x",
        "force.hills.y",
        "force.hills.z",
        "moment.hills.z",
        "energy.internal",
        "energy.friction",
        "energy.dissipated",
        "points.stick",
        "points.slip",
    ] {
        let (a, b) = (many.column(name), one.column(name));
        assert_eq!((a.len(), b.len()), (16, 16));
        let largest = b.iter().fold(0.0f64, |m, b| m.max(b.abs()));
        let off = a
            .iter()
            .zip(&b)
            .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        println!(
            "{name}: largest {largest:.6}, difference {:.1e} of it",
            off / largest
        );
        assert!(largest > 1e-3, "{name}: {b:?}");
        assert!(off <= 1e-8 * largest, "{name}: {a:?} {b:?}");
    }
}
