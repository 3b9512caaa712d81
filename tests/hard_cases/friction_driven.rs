//! Surfaces driven by force that friction holds, turns and carries.
use crate::friction::done;
use crate::support::solve;
use serde_json::{Value, json};

const RADIUS: f64 = 2.0;

/// A long cylinder on a strip whose nodes all move by `x`, a foundation of springs of modulus 1e4.
///
/// ```text
///       ( cylinder )   F down, M about y or free to turn
///   ====================   strip, every node moved by x(t)
/// ```
fn roller(x: Value, force: Value, moment: Value, mu: f64, steps: u32) -> Value {
    let step = 1.0 / f64::from(steps);
    json!({
        "covact": 1,
        "materials": { "stone": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.2 } } },
        "bodies": { "strip": {
            "mesh": { "block": { "min": [-1.2, -0.1, -0.1], "max": [0.2, 0.1, 0], "elements": [70, 1, 1] } },
            "material": "stone",
            "element": "h8_displacement",
            "sets": { "all": { "nodes_in_box": { "min": [-9, -9, -9], "max": [9, 9, 9] } } }
        } },
        "surfaces": { "roller": {
            "cylinder": { "radius": RADIUS, "length": 1, "center": [0, 0, RADIUS], "axis": [0, 1, 0] },
            "motion": { "free": {
                "center": [0, 0, RADIUS], "force": { "z": force }, "moment": { "y": moment }
            } }
        } },
        "contacts": { "roll": {
            "slave": "strip.top", "master": "roller", "points": { "gauss": 2 },
            "penalty": { "value": 1e4 }, "friction": { "coulomb": { "mu": mu } }
        } },
        "supports": { "moved": { "on": "strip.all", "displacement": { "x": x, "y": 0, "z": 0 } } },
        "solution": {
            "step": { "initial": step, "max": step, "min": 0.02, "adaptive": false },
            "newton": { "tolerance": 1e-11 }, "threads": 1
        },
        "output": { "every": 0 }
    })
}

/// Moved from t = 0.2 on.
fn way(far: f64) -> Value {
    json!({ "table": [[0, 0], [0.2, 0], [1, far]] })
}

/// The cylinder under gaps of points, or averaged ones.
fn rolls(gap: &str) {
    // Sunk by s, half a chord c: F = 2/3 eps (2 c) s width for the parabola of depth, c^2 = 2 R s.
    let force = 0.5;
    let mut scene = roller(way(1.0), json!(-force), json!(0), 0.5, 40);
    scene["contacts"]["roll"]["gap"] = json!(gap);
    let outcome = done(&scene);
    println!("{:?}", outcome.summary);
    let depth = outcome.at("penetration.max", 1.0);
    assert!(depth > 1e-4 && depth < 3e-3, "{depth}");
    for (t, x) in [(0.4, 0.25), (0.6, 0.5), (1.0, 1.0)] {
        // Backwards about y: the strip takes its lowest line along x.
        let turned = -outcome.at("rotation.roller.y", t).to_radians() * RADIUS;
        println!(
            "{t}: {turned} of {x}, force {:e}",
            outcome.at("force.roller.x", t)
        );
        // The points stick at their own depth below the circle.
        assert!(
            (turned / x - 1.0).abs() < 2.0 * depth / RADIUS,
            "{t}: {turned} {x}"
        );
        let left = outcome.at("moment_balance.roller.y", t);
        assert!(left.abs() < 1e-9 * force * RADIUS, "{t}: {left:e}");
        assert!((outcome.at("force.roller.z", t) / -force - 1.0).abs() < 1e-9);
        // No moment, no friction in sum: what there is has the arm R at every point but for the depth.
        assert!(outcome.at("force.roller.x", t).abs() < 0.5 * force * depth / RADIUS);
    }
}

#[test]
fn a_cylinder_rolls_on_a_moving_sheet_without_slip() {
    rolls("pointwise");
}

#[test]
fn a_cylinder_rolls_without_slip_where_gaps_are_averaged() {
    rolls("averaged");
}

#[test]
fn the_moment_of_friction_is_the_moment_applied() {
    let (force, moment) = (0.5, 0.2);
    let outcome = done(&roller(
        json!(0),
        json!(-force),
        json!(format!("{moment}*t")),
        0.5,
        10,
    ));
    let depth = outcome.at("penetration.max", 1.0);
    for t in [0.5, 1.0] {
        assert!(outcome.at("moment_balance.roller.y", t).abs() < 1e-9 * moment);
        // A turn about y by the given moment: the lowest line would go along -x, and pushes the strip there.
        let f = outcome.at("force.roller.x", t);
        println!("{t}: {f} {}", outcome.at("rotation.roller.y", t));
        assert!(
            (-f * RADIUS / (moment * t) - 1.0).abs() < 2.0 * depth / RADIUS,
            "{f}"
        );
        assert!(outcome.at("rotation.roller.y", t) > 0.0);
    }
    assert!(outcome.at("points.stick", 1.0) > 0.0);
}

#[test]
fn a_moment_that_friction_cannot_hold_is_named() {
    let outcome = solve(&roller(json!(0), json!(-0.5), json!("0.8*t"), 0.5, 10));
    let (summary, reason) = (&outcome.summary, outcome.summary.reason.clone());
    println!("{summary:?}");
    assert_eq!(summary.status.name(), "not_converged");
    // mu F R = 0.5.
    assert!(
        summary.time > 0.55 && summary.time < 0.64,
        "{}",
        summary.time
    );
    let reason = reason.expect("a reason");
    assert!(
        reason.contains("surface `roller`") && reason.contains("about y"),
        "{reason}"
    );
}

#[test]
fn a_braked_roller_rolls_as_long_as_friction_holds_the_brake() {
    // A moment against the rolling, below mu F R = 0.5: friction carries it, and the roller lags by elastic creep only.
    for moment in [0.3, 0.45] {
        let outcome = done(&roller(way(0.6), json!(-0.5), json!(moment), 0.5, 40));
        let depth = outcome.at("penetration.max", 1.0);
        let f = outcome.at("force.roller.x", 1.0);
        let turned = -outcome.at("rotation.roller.y", 1.0).to_radians() * RADIUS;
        println!("{moment}: {f} {turned}");
        assert!(
            (-f * RADIUS / moment - 1.0).abs() < 2.0 * depth / RADIUS,
            "{f}"
        );
        assert!(turned < 0.6 && turned > 0.97 * 0.6, "{turned}");
    }
}

/// A lid that a moment turns onto a rubber buffer, with friction: nothing but the buffer resists it, so that it is turned until it
/// touches, touching at the start or not. Its moment is the force on the buffer times the distance from the hinge, 35 to 45.
#[test]
fn a_moment_closes_a_lid_with_friction() {
    for gap in [0.0, 0.5] {
        let outcome = solve(&json!({
            "covact": 1,
            "materials": { "rubber": { "neo_hooke": { "E": 5, "nu": 0.45 } } },
            "bodies": { "buffer": {
                "mesh": { "block": { "min": [35, -5, -10], "max": [45, 5, 0], "elements": [4, 4, 4] } },
                "material": "rubber"
            } },
            "surfaces": { "lid": {
                "plane": { "size": [60, 40], "center": [30, 0, gap], "normal": [0, 0, -1] },
                "motion": { "free": { "moment": { "y": "500*t" }, "center": [0, 0, gap] } }
            } },
            "contacts": { "c": { "slave": "buffer.top", "master": "lid", "friction": 0.5 } },
            "supports": { "base": { "on": "buffer.bottom", "fixed": true } },
            "output": { "every": 0 }
        }));
        assert_eq!(outcome.summary.status.name(), "done");
        let force = outcome.at("force.base.z", 1.0);
        let arm = 500.0 / force;
        println!(
            "gap {gap}: {force}, {} iterations",
            outcome.summary.newton_iterations
        );
        assert!((38.0..42.0).contains(&arm), "{force} {arm}");
    }
}
