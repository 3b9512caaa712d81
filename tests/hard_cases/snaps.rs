//! Snap-fits at default steps: a large step must not jump to a state beside the path.
use crate::common::done;
use serde_json::json;

/// A hook is drawn over a round bump and falls behind it. From a softened penalty its second step finds a state in which the hook is
/// jammed, 33 times as fast as the first one and at 53 times the force of its path. Reference: the same scene in steps of 0.0125 and
/// 0.025, whose forces at the end are 0.996 and 0.976 along z.
#[test]
fn a_hook_is_not_jammed_by_a_large_step() {
    let scene = json!({
        "covact": 1,
        "materials": { "polymer": { "neo_hooke": { "E": 2000, "nu": 0.35 } } },
        "bodies": {
            "hook": {
                "mesh": { "plate": { "size": [40, 4], "thickness": 2, "elements": [60, 2], "origin": [0, 0, 1] } },
                "material": "polymer",
                "sets": { "tip": { "faces_in_box": { "min": [30, -1, -0.01], "max": [40.1, 5, 1.9] } } }
            }
        },
        "surfaces": {
            "bump": {
                "cylinder": { "radius": 3, "length": 20, "center": [44, 2, -1] },
                "motion": { "translation": ["-12*t", 0, 0] }
            }
        },
        "contacts": { "over": { "slave": "hook.tip", "master": "bump", "friction": 0.2 } },
        "supports": { "root": { "on": "hook.x_min", "fixed": true } }
    });
    let outcome = done(&scene);
    let forces = |axis: &str| outcome.column(&format!("force.bump.{axis}"));
    let largest = forces("x")
        .iter()
        .fold(0.0, |most: f64, f| most.max(f.abs()));
    let end = *forces("z").last().unwrap();
    assert!(largest < 1.5, "{largest}");
    assert!((end - 0.985).abs() < 0.03, "{end}");
}
