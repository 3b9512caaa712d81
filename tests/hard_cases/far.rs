//! CAD coordinates may lie far from the origin.
use crate::common::{done, plate};
use crate::support::Outcome;
use serde_json::json;

/// A plate under a ball, both moved `far` along x and y.
fn moved(far: f64) -> Outcome {
    let mut scene = plate(6, 2.0, 2);
    scene["bodies"]["plate"]["mesh"]["plate"]["origin"] = json!([far, far, 0]);
    scene["surfaces"]["ball"]["sphere"]["center"] = json!([far, far, 26]);
    scene["solution"]["newton"]["tolerance"] = json!(1e-8);
    done(&scene)
}

#[test]
fn far_from_the_origin_nothing_but_the_last_digits_changes() {
    // 1e4 from the origin a position has 12 digits behind the point, and points sink in by some 1e-3.
    let (near, far) = (moved(0.0), moved(1e4));
    assert_eq!(
        near.summary.newton_iterations,
        far.summary.newton_iterations
    );
    for name in ["force.ball.z", "energy.internal", "penetration.max"] {
        let (a, b) = (near.at(name, 1.0), far.at(name, 1.0));
        assert!(a != 0.0, "{name}");
        assert!((b / a - 1.0).abs() < 1e-8, "{name}: {a} and {b}");
    }
}
