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
