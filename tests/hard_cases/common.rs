//! The scene that the tests change.
use crate::support::{Outcome, scene_json, solve};
use covact_geometry::NurbsPatch;
use serde_json::{Value, json};

/// A quarter of the clamped plate under a ball on `n` x `n` elements with slave points at Gauss points, pushed in by `depth`
/// in `steps` steps. The tolerance is below what is compared.
pub fn plate(n: u32, depth: f64, steps: u32) -> Value {
    let step = 1.0 / f64::from(steps);
    let mut scene = scene_json("ball_on_plate.json");
    scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = json!([n, n]);
    scene["surfaces"]["ball"]["motion"]["translation"] = json!([0, 0, format!("-{depth}*t")]);
    scene["contacts"]["press"] = json!({
        "slave": "plate.top", "master": "ball", "penalty": { "value": 60000 },
        "points": { "gauss": 2 }
    });
    scene["solution"] = json!({
        "step": { "initial": step, "max": step },
        "newton": { "tolerance": 1e-11 },
        "threads": 1
    });
    scene["output"] = json!({ "every": 0 });
    scene
}

/// Runs a scene to its end and into contact.
pub fn done(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    assert_eq!(
        outcome.summary.status.name(),
        "done",
        "{:?}",
        outcome.summary
    );
    outcome
}

/// Columns that say what happened, step numbers and the like left out.
pub const PHYSICAL: [&str; 10] = [
    "force.ball.x",
    "force.ball.y",
    "force.ball.z",
    "force.clamped_x.x",
    "force.clamped_x.z",
    "force.symmetry_y.y",
    "energy.internal",
    "energy.contact",
    "penetration.max",
    "pressure.max",
];

/// Largest difference of the physical columns at the steps both runs have, relative to each column's largest value;
/// at least the end and a positive force are compared. `factor` is what a column of the second run is multiplied by.
pub fn difference(a: &Outcome, b: &Outcome, factor: impl Fn(&str) -> f64) -> f64 {
    let (ta, tb) = (a.column("time"), b.column("time"));
    let rows: Vec<(usize, usize)> = (ta.iter().enumerate())
        .filter_map(|(i, t)| Some((i, tb.iter().position(|s| (s - t).abs() < 1e-9)?)))
        .collect();
    assert!(
        rows.contains(&(ta.len() - 1, tb.len() - 1)),
        "{ta:?} {tb:?}"
    );
    let mut largest = 0.0f64;
    for name in PHYSICAL {
        let (ca, cb) = (a.column(name), b.column(name));
        let scale = rows.iter().fold(0.0f64, |s, r| s.max(ca[r.0].abs()));
        assert!(scale > 0.0, "{name} is zero throughout");
        for &(i, j) in &rows {
            largest = largest.max((ca[i] - cb[j] * factor(name)).abs() / scale);
        }
    }
    largest
}

/// A patch as a face of a Kratos CAD file.
fn face(id: usize, patch: &NurbsPatch) -> Value {
    let points: Vec<Value> = (patch.points().iter().zip(patch.weights()).enumerate())
        .map(|(i, (p, w))| json!([i + 1, [p.x, p.y, p.z, w]]))
        .collect();
    json!({
        "brep_id": id,
        "swapped_surface_normal": false,
        "surface": {
            "is_trimmed": false,
            "is_rational": true,
            "degrees": patch.degree(),
            "knot_vectors": [patch.knots(0), patch.knots(1)],
            "control_points": points,
        },
        "boundary_loops": [],
    })
}

/// Writes patches as a Kratos CAD file.
pub fn cad_file(patches: &[NurbsPatch], path: &std::path::Path) {
    let faces: Vec<Value> = (patches.iter().enumerate().map(|(i, p)| face(i + 1, p))).collect();
    let cad = json!({
        "tolerances": { "model_tolerance": 1e-6 },
        "version_number": "1.0",
        "breps": [{ "brep_id": 100, "faces": faces, "edges": [], "vertices": [] }],
    });
    std::fs::write(path, cad.to_string()).expect("writable");
}
