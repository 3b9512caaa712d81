//! First touches under the penalty that a run starts with, against the same under a stiffer one.
use crate::support::solve;
use covact::output::RunStatus;
use serde_json::json;

/// A strip blown over a roller by a follower pressure: at the first touch what little contact stores shows in no energy beside what
/// bends, and the penalty that it starts with lets it carry a third of its force. The same contact under a hundred times the
/// penalty that suits carries 13.17.
#[test]
fn a_small_force_beside_much_bending_is_not_lost() {
    let scene = |penalty: Option<f64>| {
        let mut scene = json!({
            "covact": 1,
            "materials": { "steel": { "st_venant_kirchhoff": { "E": 210000, "nu": 0.3 } } },
            "bodies": { "strip": {
                "mesh": { "plate": { "size": [80, 10], "thickness": 0.4, "elements": [25, 1], "origin": [0, 0, 0.2] } },
                "material": "steel"
            } },
            "surfaces": { "roller": { "cylinder": { "radius": 30, "length": 30, "center": [0, 5, -30] } } },
            "contacts": { "c": { "slave": "strip.bottom", "master": "roller" } },
            "supports": {
                "end": { "on": "strip.x_min", "fixed": true },
                "sides": { "on": ["strip.y_min", "strip.y_max"], "symmetry": "y" }
            },
            "loads": { "p": { "on": "strip.top", "pressure": "0.015*t", "follower": true } },
            "solution": { "step": { "initial": 0.3333333333333333 } },
            "output": { "every": 0 }
        });
        if let Some(penalty) = penalty {
            scene["contacts"]["c"]["penalty"] = json!({ "value": penalty });
        }
        scene
    };
    let [own, stiff] = [None, Some(1e5)].map(|penalty| {
        let run = solve(&scene(penalty));
        let s = &run.summary;
        assert_eq!(s.status, RunStatus::Done, "{:?}", s.reason);
        run.at("force.roller.z", 1.0)
    });
    println!("{own} of {stiff}");
    assert!((stiff / 13.17 - 1.0).abs() < 1e-3, "{stiff}");
    assert!((own / stiff - 1.0).abs() < 0.03, "{own} of {stiff}");
}
