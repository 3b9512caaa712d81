//! Friction up to a largest traction: a flat block under a dead pressure, drawn over a floor. Once all of it slides, the force
//! along the floor is `min(mu p, limit)` times the area, whatever lies below (E. Orowan, Proceedings of the Institution of
//! Mechanical Engineers 150 (1943)).
use crate::support::solve;
use serde_json::{Value, json};

const MU: f64 = 0.3;
const LIMIT: f64 = 2.0;

/// A block of area 4 x 2 and height .2 under the pressure `p`; the floor moves below it.
fn drawn(p: f64, rigid: bool) -> Value {
    let mut scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 2000, "nu": 0}}},
        "bodies": {
            "block": {"mesh": {"block": {"min": [0, 0, 0], "max": [4, 2, 0.2], "elements": [6, 3, 1]}}, "material": "m"}
        },
        "contacts": {"c": {
            "slave": "block.bottom", "master": "floor",
            "friction": {"shear_limited": {"mu": MU, "limit": LIMIT}}
        }},
        "supports": {"held": {"on": "block.top", "displacement": {"x": 0, "y": 0}}},
        "loads": {"weight": {"on": "block.top", "pressure": {"table": [[0, 0], [0.5, p], [1, p]]}}},
        "output": {"every": 0}
    });
    let way = json!({"table": [[0, 0], [0.5, 0], [1, 0.1]]});
    if rigid {
        scene["surfaces"] = json!({"floor": {
            "plane": {"center": [2, 1, 0], "size": [20, 20]}, "motion": {"translation": [way, 0, 0]}
        }});
    } else {
        scene["bodies"]["floor"] = json!({
            "mesh": {"block": {"min": [-1, -1, -1], "max": [5, 3, 0], "elements": [8, 5, 1]}}, "material": "m"
        });
        scene["contacts"]["c"]["master"] = json!("floor.top");
        scene["supports"]["ground"] =
            json!({"on": "floor.bottom", "displacement": {"x": way, "y": 0, "z": 0}});
    }
    scene
}

#[test]
fn a_block_slides_at_the_smaller_of_both_limits() {
    const AREA: f64 = 8.0;
    for rigid in [true, false] {
        for p in [4.0, 40.0] {
            let outcome = solve(&drawn(p, rigid));
            assert_eq!(
                outcome.summary.status.name(),
                "done",
                "{:?}",
                outcome.summary.reason
            );
            let last = |name: &str| *outcome.column(name).last().expect("steps");
            let force = last("force.held.x").abs();
            let exact = f64::min(MU * p, LIMIT) * AREA;
            println!("rigid {rigid}, pressure {p}: {force} of {exact}");
            assert_eq!(last("points.stick"), 0.0);
            // At the borders of the block the faces of a body turn by about `p / E`, and the forces on them.
            let tolerance = if rigid { 1e-6 } else { p / 2000.0 };
            assert!((force / exact - 1.0).abs() < tolerance, "{force} {exact}");
        }
    }
}
