//! The published tangent leads to the same solution as the exact one; what it leaves out costs iterations.
use crate::common::{difference, done, plate};
use serde_json::{Value, json};

#[test]
fn every_tangent_leads_to_the_same_solution() {
    let run = |tangent: Value| {
        let mut scene = plate(10, 8.0, 8);
        scene["contacts"]["press"]["tangent"] = tangent;
        // A soft penalty, so that the penetration, which the published form takes for zero, is visible.
        scene["contacts"]["press"]["penalty"] = json!({ "value": 600 });
        scene["solution"]["newton"]["max_iterations"] = json!(60);
        done(&scene)
    };
    let published = |rotational: bool, curvature: bool| {
        run(json!({ "published": { "rotational": rotational, "curvature": curvature } }))
    };
    let exact = run(json!("exact"));
    let whole = published(true, true);
    let not_rotational = published(false, true);
    let main_alone = published(false, false);
    let count = [&exact, &whole, &not_rotational, &main_alone].map(|o| o.summary.newton_iterations);
    println!("iterations: exact, published, without rotational, main alone: {count:?}");
    for (name, other) in [("published", &whole), ("main alone", &main_alone)] {
        let d = difference(&exact, other, |_| 1.0);
        println!("{name}: {d:.1e}");
        assert!(d < 1e-8, "{name}: {d}");
    }
    // A rigid master has no rotational part: not a bit changes.
    assert_eq!(whole.history.rows, not_rotational.history.rows);
    assert!(count[1] >= count[0], "{count:?}");
    assert!(count[3] > count[1], "{count:?}");
}

/// Augmentation lets the gap vanish, on which the published form is the exact one, while tractions stay: without the
/// curvature part Newton's method loses its second order there.
#[test]
fn every_tangent_leads_to_the_same_augmented_solution() {
    let run = |tangent: Value| {
        let mut scene = plate(10, 8.0, 8);
        let press = &mut scene["contacts"]["press"];
        press["tangent"] = tangent;
        press["penalty"] = json!({ "value": 6000 });
        press["augmentation"] = json!({ "gap": 1e-5 });
        scene["solution"]["newton"]["max_iterations"] = json!(60);
        done(&scene)
    };
    let exact = run(json!("exact"));
    let whole = run(json!({ "published": {} }));
    let main_alone = run(json!({ "published": { "rotational": false, "curvature": false } }));
    let count = [&exact, &whole, &main_alone].map(|o| o.summary.newton_iterations);
    println!("iterations: exact, published, main alone: {count:?}");
    assert!(exact.at("penetration.max", 1.0) > 0.0);
    for (name, other) in [("published", &whole), ("main alone", &main_alone)] {
        let d = difference(&exact, other, |_| 1.0);
        println!("{name}: {d:.1e}");
        // Every augmentation starts from an equilibrium at 1e-8.
        assert!(d < 1e-6, "{name}: {d}");
    }
    assert!(count[1] <= count[0] + count[0] / 10, "{count:?}");
    assert!(count[2] > count[1], "{count:?}");
}
