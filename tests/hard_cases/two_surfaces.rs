//! Two surfaces on the same face, and the balance of all that is told of forces and moments.
use crate::common::{PHYSICAL, difference, done, plate};
use serde_json::json;

#[test]
fn two_equal_balls_of_half_the_penalty_are_one() {
    let mut one = plate(6, 2.0, 2);
    one["output"] = json!({ "every": 1 });
    let mut two = one.clone();
    two["contacts"]["press"]["penalty"] = json!({ "value": 30000 });
    two["surfaces"]["other"] = two["surfaces"]["ball"].clone();
    two["contacts"]["also"] = two["contacts"]["press"].clone();
    two["contacts"]["also"]["master"] = json!("other");
    let (one, two) = (done(&one), done(&two));
    assert_eq!(PHYSICAL[0], "force.ball.x");
    let halves = |name: &str| match name {
        "force.ball.x" | "force.ball.y" | "force.ball.z" | "pressure.max" => 2.0,
        _ => 1.0,
    };
    let worst = difference(&one, &two, halves);
    assert!(worst < 1e-9, "{worst:e}");
    // On the nodes the pressures of both add up.
    let step = one.summary.steps;
    let (a, b) = (one.body("plate", step), two.body("plate", step));
    for name in ["contact_pressure", "contact_gap"] {
        let (a, b) = (a.field(name), b.field(name));
        let largest = (a.iter().filter(|x| x.is_finite())).fold(0.0f64, |s, x| s.max(x.abs()));
        assert!(largest > 0.0, "{name}");
        for (x, y) in a.iter().zip(b).filter(|(x, _)| x.is_finite()) {
            assert!((x - y).abs() < 1e-6 * largest, "{name}: {x} and {y}");
        }
    }
}

#[test]
fn forces_and_moments_are_in_balance_on_the_deformed_body() {
    // The clamped border is lifted by four thicknesses, so that lever arms change.
    let mut scene = plate(6, 2.0, 2);
    for (name, set) in [("clamped_x", "plate.x_max"), ("clamped_y", "plate.y_max")] {
        scene["supports"][name] = json!({
            "on": set, "displacement": { "x": 0, "y": 0, "z": { "table": [[0, 0], [1, 8]] } }
        });
    }
    let outcome = done(&scene);
    let acting = ["ball", "clamped_x", "clamped_y", "symmetry_x", "symmetry_y"];
    for quantity in ["force", "moment"] {
        for axis in ["x", "y", "z"] {
            let parts = acting.map(|on| outcome.at(&format!("{quantity}.{on}.{axis}"), 1.0));
            let scale = parts.iter().fold(0.0f64, |s, p| s.max(p.abs()));
            let sum: f64 = parts.iter().sum();
            assert!(scale > 1.0, "{quantity} {axis}: {parts:?}");
            assert!(
                sum.abs() < 1e-8 * scale,
                "{quantity} {axis}: {sum} of {parts:?}"
            );
        }
    }
}
