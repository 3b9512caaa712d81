//! Contact that begins at a distance from the master: what the thickness would do that is not modelled.
use crate::support::{Outcome, scene_json, solve};
use serde_json::{Value, json};

fn run(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    assert!(outcome.summary.reason.is_none(), "{:?}", outcome.summary);
    outcome
}

fn same(a: &Outcome, b: &Outcome, columns: &[&str], tolerance: f64) {
    for name in columns {
        let (x, y) = (a.column(name), b.column(name));
        let last = *x.last().unwrap();
        assert!(last.abs() > 1e-12, "{name} is zero");
        for (x, y) in x.iter().zip(&y) {
            assert!((x - y).abs() <= tolerance * last.abs(), "{name}: {x} {y}");
        }
    }
}

/// The plate of the shipped scene under a ball of this radius, whose lowest point starts on the plate with the offset.
fn ball(radius: f64, offset: f64, friction: Value) -> Value {
    let mut scene = scene_json("ball_on_plate.json");
    scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = json!([8, 8]);
    scene["surfaces"]["ball"]["sphere"]["radius"] = json!(radius);
    scene["surfaces"]["ball"]["sphere"]["center"] = json!([0, 0, 1.0 + radius + offset]);
    scene["surfaces"]["ball"]["depth"] = json!(5);
    scene["contacts"]["press"]["offset"] = json!(offset);
    scene["contacts"]["press"]["friction"] = friction;
    scene["output"] = json!({ "every": 0 });
    scene
}

#[test]
fn a_ball_with_an_offset_is_a_larger_ball() {
    // The points at a distance h from a sphere of radius R are the sphere of radius R + h: nothing tells them apart, with or
    // without friction, at an offset far from small.
    for friction in [Value::Null, json!({ "coulomb": { "mu": 0.3 } })] {
        let slides = !friction.is_null();
        let thin = run(&ball(15.0, 10.0, friction.clone()));
        let thick = run(&ball(25.0, 0.0, friction));
        let columns = [
            "force.ball.z",
            "force.clamped_x.x",
            "energy.internal",
            "penetration.max",
        ];
        same(&thin, &thick, &columns, 1e-7);
        if slides {
            same(&thin, &thick, &["energy.dissipated", "force.ball.x"], 1e-6);
            assert!(thin.at("points.stick", 1.0) + thin.at("points.slip", 1.0) > 0.0);
        }
        let (a, b) = (
            thin.summary.newton_iterations,
            thick.summary.newton_iterations,
        );
        // The same tangent, and so the same path.
        assert!(a.abs_diff(b) <= 2, "{a} {b} iterations");
    }
}

#[test]
fn reactions_and_moments_balance_with_offset_and_friction() {
    let outcome = run(&ball(15.0, 10.0, json!({ "coulomb": { "mu": 0.3 } })));
    let supports = ["clamped_x", "clamped_y", "symmetry_x", "symmetry_y"];
    for t in [0.25, 0.5, 1.0] {
        for (kind, scale) in [("force", "force.ball.z"), ("moment", "moment.ball.x")] {
            let size = outcome.at(scale, t).abs();
            assert!(size > 1.0);
            for axis in ["x", "y", "z"] {
                let on = |name: &str| outcome.at(&format!("{kind}.{name}.{axis}"), t);
                let sum: f64 = supports.iter().map(|s| on(s)).sum::<f64>() + on("ball");
                // No external load: what the supports and the ball exert cancels.
                assert!(
                    sum.abs() < 1e-6 * size,
                    "{kind} {axis} at {t}: {sum} of {size}"
                );
            }
        }
    }
}

/// A block pressed by a plane or by another block that starts `apart` above it. nu = 0.
fn block(apart: f64, offset: f64, body: bool) -> Value {
    let mut scene = json!({
        "covact": 1,
        "materials": { "foam": { "st_venant_kirchhoff": { "E": 100, "nu": 0 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [2, 2, 4], "elements": [3, 3, 4] } },
            "material": "foam"
        } },
        "contacts": { "press": {
            "slave": "block.top", "master": "plane", "penalty": { "value": 1e4 }, "offset": offset
        } },
        "supports": {
            "floor": { "on": "block.bottom", "symmetry": "z" },
            "x": { "on": "block.x_min", "symmetry": "x" },
            "y": { "on": "block.y_min", "symmetry": "y" }
        },
        "solution": {
            "step": { "initial": 0.25, "max": 0.25 }, "newton": { "tolerance": 1e-10 }, "threads": 1
        },
        "output": { "every": 0 }
    });
    if body {
        scene["bodies"]["tool"] = json!({
            "mesh": { "block": {
                "min": [0, 0, 4.0 + apart], "max": [2, 2, 6.0 + apart], "elements": [3, 3, 2]
            } },
            "material": "foam"
        });
        scene["contacts"]["press"]["master"] = json!("tool.bottom");
        scene["contacts"]["press"]["points"] = json!({ "gauss": 2 });
        scene["supports"]["plane"] =
            json!({ "on": "tool.top", "displacement": { "x": 0, "y": 0, "z": "-0.2*t" } });
    } else {
        scene["surfaces"] = json!({ "plane": {
            "plane": { "center": [1, 1, 4.0 + apart], "size": [8, 8] },
            "side": { "point": [1, 1, 0] },
            "motion": { "translation": [0, 0, "-0.2*t"] }
        } });
    }
    scene
}

#[test]
fn sheets_of_half_the_thickness_are_the_real_ones() {
    for body in [false, true] {
        let (thin, thick) = (run(&block(0.5, 0.5, body)), run(&block(0.0, 0.0, body)));
        let columns = [
            "force.plane.z",
            "energy.internal",
            "penetration.max",
            "pressure.max",
        ];
        same(&thin, &thick, &columns, 1e-8);
        if body {
            let size = thin.at("force.plane.z", 1.0).abs();
            assert!(thin.at("imbalance.force.press", 1.0) < 1e-10 * size);
            assert!(thin.at("imbalance.moment.press", 1.0) < 1e-10 * size);
        }
    }
}

#[test]
fn an_overclosure_counts_from_the_offset() {
    // The plane starts .3 above the block, .2 within the offset: touching without stress, and pressed from there on.
    for augmentation in [Value::Null, json!({ "gap": 1e-7 })] {
        let mut scene = block(0.3, 0.5, false);
        scene["contacts"]["press"]["initial_overclosure"] = json!("stress_free");
        scene["contacts"]["press"]["augmentation"] = augmentation.clone();
        let mut plain = block(0.0, 0.0, false);
        plain["contacts"]["press"]["augmentation"] = augmentation;
        same(
            &run(&scene),
            &run(&plain),
            &["force.plane.z", "energy.internal"],
            1e-6,
        );
        scene["contacts"]["press"]["initial_overclosure"] = json!({ "shrink": { "until": 1 } });
        // What shrinks in on top: .2 more. Stretch l = 1 - d / 4, force proportional to l (1 - l^2); the penalty gives way by
        // a part of 6e-4.
        let uniform = |l: f64| l * (1.0 - l * l);
        let shrunk = run(&scene).at("force.plane.z", 1.0);
        let resting = run(&plain).at("force.plane.z", 1.0);
        let ratio = uniform(0.9) / uniform(0.95);
        assert!(
            (shrunk / resting / ratio - 1.0).abs() < 1e-3,
            "{shrunk} {resting}"
        );
    }
}

#[test]
fn offset_and_augmentation_go_together_with_friction() {
    let mut thin = ball(15.0, 10.0, json!({ "coulomb": { "mu": 0.3 } }));
    let mut thick = ball(25.0, 0.0, json!({ "coulomb": { "mu": 0.3 } }));
    for scene in [&mut thin, &mut thick] {
        scene["contacts"]["press"]["augmentation"] = json!({});
    }
    let (thin, thick) = (run(&thin), run(&thick));
    same(
        &thin,
        &thick,
        &["force.ball.z", "energy.internal", "energy.dissipated"],
        1e-6,
    );
    assert!(thin.column("augmentations").iter().sum::<f64>() > 0.0);
    assert!(thin.at("penetration.max", 1.0) < 1e-4 * 50.0 / 8.0);
}
