//! The shipped scene `panel_pressed`.
use crate::support::{Outcome, scene_json, set, solve};
use serde_json::json;

fn press(size: f64) -> Outcome {
    let mut scene = scene_json("panel_pressed.json");
    set(&mut scene, "/bodies/panel/nurbs/size", size);
    // The punch sits on its rim all around by then.
    scene["solution"]["end_time"] = json!(0.7);
    scene["output"] = json!({"every": 1000});
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "done");
    let warnings = &outcome.summary.warnings;
    assert!(warnings.is_empty(), "{warnings:?}");
    outcome
}

/// Clamps bear what the punch exerts; elements of two thirds of the size change the force by less than one per cent; the sheet stays
/// out of the punch but for what the penalty allows, and its fields are those of a sheet: thickness 1, pressure below the punch.
#[test]
fn a_panel_pressed_by_a_punch() {
    let [coarse, fine] = [6.0, 4.0].map(press);
    let force = |o: &Outcome, of: &str, c: &str| o.at(&format!("force.{of}.{c}"), 0.7);
    for outcome in [&coarse, &fine] {
        let size = force(outcome, "punch", "z").abs();
        for c in ["x", "y", "z"] {
            let left = force(outcome, "punch", c) + force(outcome, "clamped", c);
            assert!(left.abs() < 1e-6 * size, "{c}: {left} of {size}");
        }
    }
    let [a, b] = [&coarse, &fine].map(|o| -force(o, "punch", "z"));
    println!("{a} {b}, {} iterations", coarse.summary.newton_iterations);
    assert!(a > 100.0 && (a / b - 1.0).abs() < 1e-2, "{a} {b}");
    assert!(coarse.summary.newton_iterations <= 80);

    let body = coarse.body("panel", coarse.summary.steps);
    let (thickness, pressure) = (body.field("thickness"), body.field("contact_pressure"));
    assert!(thickness.iter().all(|t| (t - 1.0).abs() < 1e-6));
    let highest = pressure.iter().copied().fold(0.0, f64::max);
    assert!(highest > 1.0);
    // The middle goes down, the border stays.
    let u = body.field("displacement");
    let lowest = u.chunks_exact(3).map(|u| u[2]).fold(0.0, f64::min);
    assert!((-2.8..-1.4).contains(&lowest), "{lowest}");
    // The exact mid-surface is there, too.
    let file = format!("panel_mid_{:04}.vtu", coarse.summary.steps);
    assert!(coarse.folder.path().join(file).exists());
}

/// The dish of `flanged_panel` (assets/make_flanged.py) as one patch in place of two, and its flanges, as a file of geometry.
fn whole_dish() -> serde_json::Value {
    let bezier = |low: f64, high: f64| {
        let middle = 0.5 * (low + high);
        [[low, low * low], [middle, low * high], [high, high * high]]
    };
    let (x, y) = (bezier(-60.0, 60.0), bezier(-40.0, 40.0));
    let quadratic = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let dish: Vec<[f64; 4]> = (y.iter())
        .flat_map(|[y, yy]| x.map(|[x, xx]| [x, *y, 4.0 * xx / 3600.0 + 3.0 * yy / 1600.0, 1.0]))
        .collect();
    let (sin, cos) = 50f64.to_radians().sin_cos();
    let flange = |side: f64| -> Vec<[f64; 4]> {
        let of = |s: f64| {
            x.map(|[x, xx]| {
                let z = 4.0 * xx / 3600.0 + 3.0 - s * sin;
                [x, side * (40.0 + s * cos), z, 1.0]
            })
        };
        [0.0, 15.0].into_iter().flat_map(of).collect()
    };
    let patch = |entity: u32, degree: [u32; 2], knots: [&[f64]; 2], points: Vec<[f64; 4]>| json!({"entity": entity, "degree": degree, "knots": knots, "points": points});
    let linear = [0.0, 0.0, 1.0, 1.0];
    json!({"covact_geometry": 1, "unit": "mm", "resolution": null, "patches": [
        patch(1, [2, 2], [&quadratic, &quadratic], dish),
        patch(5, [2, 1], [&quadratic, &linear], flange(1.0)),
        patch(7, [2, 1], [&quadratic, &linear], flange(-1.0)),
    ]})
}

/// The shipped scene `flanged_panel`, of four faces one of which is turned over: its clamps bear what the punch exerts. The punch
/// touches with its corners at few points; under a ball, which many points resolve, the dish as one patch in place of two, whose
/// knots do not match, takes the same force.
#[test]
fn a_flanged_panel_of_four_faces() {
    let mut scene = scene_json("flanged_panel.json");
    set(&mut scene, "/bodies/panel/nurbs/size", 8);
    scene["output"] = json!({"every": 0});
    let force = |o: &Outcome, of: &str, c: &str| o.at(&format!("force.{of}.{c}"), 1.0);
    let balanced = |scene: &serde_json::Value| {
        let outcome = solve(scene);
        assert_eq!(outcome.summary.status.name(), "done");
        let size = force(&outcome, "punch", "z").abs();
        for c in ["x", "y", "z"] {
            let left = force(&outcome, "punch", c) + force(&outcome, "clamped", c);
            assert!(left.abs() < 1e-6 * size, "{c}: {left} of {size}");
        }
        size
    };
    let corners = balanced(&scene);
    assert!(corners > 1000.0, "{corners}");
    scene["surfaces"]["punch"] = json!({
        "sphere": {"radius": 120, "center": [0, 0, 120.7]}, "motion": {"translation": [0, 0, "-4*t"]}
    });
    let four = balanced(&scene);
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("whole.json");
    std::fs::write(&file, whole_dish().to_string()).expect("written");
    scene["bodies"]["panel"]["nurbs"]["file"] = json!(file);
    let three = balanced(&scene);
    println!("{four} {three}: {}", (four / three - 1.0).abs());
    assert!((four / three - 1.0).abs() < 1e-3, "{four} {three}");
}
