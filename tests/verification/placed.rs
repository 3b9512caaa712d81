//! A mesh put elsewhere: the same problem turned and moved has the same answer.
use crate::support::{scene_json, set, solve};
use serde_json::json;

/// The plate under a ball at half its size, turned by 90 degrees about x and moved, and the ball with it: with half
/// of all lengths the forces are a quarter.
#[test]
fn turned_moved_and_scaled_scene_gives_the_same_forces() {
    let mut scene = scene_json("ball_on_plate.json");
    set(&mut scene, "/bodies/plate/mesh/plate/elements", vec![8, 8]);
    scene["output"] = json!({ "every": 0 });
    scene["solution"]["newton"] = json!({ "tolerance": 1e-11 });
    scene["solution"]["end_time"] = json!(0.5);
    scene["solution"]["stops"] = json!([0.25]);
    let reference = solve(&scene);
    // (x, y, z) -> (x, -z, y) / 2 + (1, -7, 20)
    let at = json!({ "scale": 0.5, "axis": [1, 0, 0], "angle": 90, "translation": [1, -7, 20] });
    scene["bodies"]["plate"]["placement"] = at.clone();
    scene["surfaces"]["ball"]["placement"] = at;
    scene["surfaces"]["ball"]["motion"] = json!({ "translation": [0, "5*t", 0] });
    scene["contacts"]["press"]["penalty"] = json!({ "value": 120000 });
    scene["supports"]["symmetry_y"]["symmetry"] = json!("z");
    let turned = solve(&scene);
    for t in [0.25, 0.5] {
        let expected = -reference.at("force.ball.z", t);
        let found = 4.0 * turned.at("force.ball.y", t);
        assert!(expected > 100.0);
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{found} instead of {expected} at {t}"
        );
    }
}
