//! Fields of friction: what the files say is what was solved.
use crate::friction::{block, done, plane};
use serde_json::json;

#[test]
fn fields_of_friction_add_up_to_the_forces() {
    let top = json!({
        "x": { "table": [[0, 0], [0.5, 0], [1, 0.008]] }, "y": 0,
        "z": { "table": [[0, 0], [0.5, -0.02], [1, -0.02]] }
    });
    let mut scene = block(plane(), top, json!(0.3), 8);
    scene["output"] = json!({ "every": 1, "contact_points": true });
    let outcome = done(&scene);
    let points = outcome.body("slide_points", 8);
    let area = points.field("area");
    let sum = |values: &[f64]| -> f64 { values.iter().zip(area).map(|(v, a)| v * a).sum() };
    let component = |field: &[f64], c: usize| -> Vec<f64> {
        field.iter().skip(c).step_by(3).copied().collect()
    };
    let traction = points.field("friction_traction");
    for (values, column) in [
        (component(traction, 0), "force.tool.x"),
        (component(traction, 1), "force.tool.y"),
        (points.field("contact_pressure").to_vec(), "force.tool.z"),
        (points.field("dissipated").to_vec(), "energy.dissipated"),
    ] {
        let (a, b) = (sum(&values), outcome.at(column, 1.0));
        assert!(
            (a - b).abs() < 1e-9 * outcome.at("force.tool.z", 1.0),
            "{column}: {a} {b}"
        );
    }
    let status = points.field("contact_status");
    let count = |s: f64| status.iter().filter(|v| **v == s).count() as f64;
    assert_eq!(status.len(), 40);
    assert!(count(2.0) > 0.0 && count(3.0) > 0.0);
    assert_eq!(count(2.0), outcome.at("points.stick", 1.0));
    assert_eq!(count(3.0), outcome.at("points.slip", 1.0));
    let below = points.field("contact_gap").iter().all(|g| *g < 0.0);
    assert!(below && points.points.iter().all(|x| x[2] < 0.0));
    // The slip of a point that slides is what its path shows.
    for (s, slip) in status.iter().zip(points.field("slip")) {
        assert!(*s != 3.0 || *slip > 0.0);
    }
    // At the nodes, by the integrals of their shape functions: the sums are the same.
    let body = outcome.body("block", 8);
    let bottom: Vec<usize> = (0..body.points.len())
        .filter(|n| body.points[*n][2] == 0.0)
        .collect();
    let weight = |n: usize| {
        let side = |x: f64, half: f64| if x.abs() > half - 1e-9 { 0.5 } else { 1.0 };
        let p = body.points[n];
        0.2 * 0.25 * side(p[0], 0.5) * side(p[1], 0.25)
    };
    let nodal = |values: &[f64]| -> f64 { bottom.iter().map(|&n| weight(n) * values[n]).sum() };
    for (values, column) in [
        (
            component(body.field("friction_traction"), 0),
            "force.tool.x",
        ),
        (body.field("contact_pressure").to_vec(), "force.tool.z"),
        (body.field("dissipated").to_vec(), "energy.dissipated"),
    ] {
        let (a, b) = (nodal(&values), outcome.at(column, 1.0));
        assert!((a / b - 1.0).abs() < 1e-9, "{column}: {a} {b}");
    }
    let status = body.field("contact_status");
    let others = (0..status.len()).filter(|n| !bottom.contains(n));
    assert!(others.clone().count() > 0 && others.into_iter().all(|n| status[n] == 0.0));
    assert!(bottom.iter().all(|&n| status[n] == 2.0 || status[n] == 3.0));
    let listed = std::fs::read_to_string(outcome.folder.path().join("results.pvd")).unwrap();
    for step in 0..=8 {
        assert!(listed.contains(&format!("file=\"slide_points_{step:04}.vtu\"")));
    }
}

#[test]
fn other_files_stay_as_they_are() {
    let top = json!({ "x": 0, "y": 0, "z": "-0.02*t" });
    let mut scene = block(plane(), top, json!(0.0), 2);
    scene["output"] = json!({ "every": 2 });
    let without = done(&scene);
    scene["contacts"]["slide"]["friction"]["coulomb"]["mu"] = json!(0.3);
    let with = done(&scene);
    let names = |outcome: &crate::support::Outcome| {
        let text = std::fs::read(outcome.folder.path().join("block_0002.vtu")).unwrap();
        let text = String::from_utf8_lossy(&text);
        ["friction_traction", "slip", "dissipated"].map(|n| text.contains(&format!("Name=\"{n}\"")))
    };
    assert_eq!(names(&without), [false; 3]);
    assert_eq!(names(&with), [true; 3]);
    assert!(!with.folder.path().join("slide_points_0002.vtu").exists());
}
