//! Sheets of metal that nothing but tools hold, at default settings.
use crate::support::{Outcome, solve};
use covact::output::RunStatus;
use serde_json::json;

/// Half of a strip on a roller, bent by a second one over its middle until a hinge turns there, without hardening. Nothing but two points
/// at each roller holds it, and where it flows its stiffness changes by orders of magnitude from one iterate to the next: full
/// steps of Newton's method throw it off the rollers.
///
/// Closed form: a rigid strip with one hinge of the plastic moment of plane strain, `M = 2 / sqrt(3) sigma_y t^2 b / 4`. At the
/// way w of the middle the angle a of the strip keeps its mid-surface half a thickness off the roller of radius r at the
/// distance l, `l sin a - (w - r - t/2) cos a = r + t/2`, and the force along the normal is M over the way along the strip from hinge to
/// contact, `l cos a + (w - r - t/2) sin a`. Elastic bending turns the strip by .04 more, .2 % of the vertical force, and the points of
/// the element at the hinge lie off the middle, where the moment is .6 % smaller.
#[test]
fn a_strip_between_rollers_turns_about_a_plastic_hinge() {
    let (length, radius, thickness, width, stress) = (20.0, 3.0, 1.0, 0.5, 250.0);
    let off = radius + 0.5 * thickness;
    let roller = |x: f64, z: f64| {
        json!({
            "cylinder": { "center": [x, width / 2.0, z], "axis": [0, 1, 0], "radius": radius, "length": 2 },
            "side": "outward"
        })
    };
    let mut punch = roller(0.0, off);
    punch["motion"] = json!({ "translation": [0, 0, "-4*t"] });
    let outcome = solve(&json!({
        "covact": 1,
        "materials": { "steel": { "j2": {
            "E": 205000, "nu": 0.3, "hardening": { "linear": { "yield_stress": stress } }
        } } },
        "bodies": { "strip": {
            "mesh": { "plate": { "size": [24, width], "thickness": thickness, "elements": [48, 1] } },
            "material": "steel"
        } },
        "surfaces": { "support": roller(length, -off), "punch": punch },
        "contacts": {
            "below": { "slave": "strip.bottom", "master": "support" },
            "above": { "slave": "strip.top", "master": "punch" }
        },
        "supports": {
            "middle": { "on": "strip.x_min", "symmetry": "x" },
            "edges": { "on": ["strip.y_min", "strip.y_max"], "symmetry": "y" }
        },
        "output": { "every": 0 }
    }));
    let summary = &outcome.summary;
    assert_eq!(summary.status, RunStatus::Done, "{:?}", summary.reason);
    let moment = 2.0 / 3f64.sqrt() * stress * thickness * thickness * width / 4.0;
    let (time, force) = (outcome.column("time"), outcome.column("force.support.z"));
    let mut compared = 0;
    // Before, the strip is still elastic next to the hinge; later it meets the punch beside its middle.
    for (t, force) in time
        .iter()
        .zip(&force)
        .filter(|(t, _)| (0.5..0.7).contains(*t))
    {
        let rise = 4.0 * t - off;
        let mut angle = 0.0f64;
        for _ in 0..50 {
            angle = ((off + rise * angle.cos()) / length).asin();
        }
        let arm = length * angle.cos() + rise * angle.sin();
        let expected = moment / arm * angle.cos();
        println!("{t}: {force} {expected}");
        assert!((force / expected - 1.0).abs() < 0.01, "{force} {expected}");
        compared += 1;
    }
    assert!(compared > 1);
    // Regression: iterations were 112 and 39.
    assert!(summary.newton_iterations < 160 && summary.failed_iterations < 60);
    assert_eq!(summary.cuts, 0);
}

/// A sheet that lies on a plane while its punch is still on the way is in equilibrium: no iteration, and no word of what
/// rounding makes of nothing.
#[test]
fn a_sheet_that_lies_untouched_is_left_alone() {
    let outcome = solve(&json!({
        "covact": 1,
        "materials": { "steel": { "neo_hooke": { "E": 205000, "nu": 0.3 } } },
        "bodies": { "sheet": {
            "mesh": { "plate": { "size": [10, 4], "thickness": 1, "elements": [10, 4] } }, "material": "steel"
        } },
        "surfaces": {
            "floor": { "plane": { "center": [5, 2, -0.5], "size": [30, 30] } },
            "punch": {
                "sphere": { "radius": 3, "center": [0, 0, 4.5] }, "motion": { "translation": [0, 0, "-0.5*t"] }
            }
        },
        "contacts": {
            "below": { "slave": "sheet.bottom", "master": "floor" },
            "above": { "slave": "sheet.top", "master": "punch" }
        },
        "supports": {
            "side": { "on": "sheet.x_min", "symmetry": "x" },
            "back": { "on": "sheet.y_min", "symmetry": "y" }
        },
        "output": { "every": 0 }
    }));
    let summary = &outcome.summary;
    assert_eq!(summary.status, RunStatus::NoContact);
    assert_eq!(summary.newton_iterations, 0);
    assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
}

/// A flange wiped around the edge of a die, under a pad that a force presses; slave points as asked for, or by default.
fn wiped(points: &str) -> Outcome {
    let cylinder = |x: f64, z: f64, radius: f64| {
        json!({
            "cylinder": { "center": [x, 0.5, z], "axis": [0, 1, 0], "radius": radius, "length": 6 },
            "side": "outward"
        })
    };
    let contact = |side: &str, tool: &str| json!({ "slave": side, "master": tool, "points": points, "friction": 0.1 });
    solve(&json!({
        "covact": 1,
        "materials": { "steel": { "j2": {
            "E": 205000, "nu": 0.3, "hardening": { "linear": { "yield_stress": 250, "slope": 900 } }
        } } },
        "bodies": { "sheet": {
            "mesh": { "plate": {
                "size": [34, 1], "thickness": 1, "elements": [34, 1], "layers": 2, "origin": [-20, 0, 0]
            } },
            "material": "steel"
        } },
        "surfaces": {
            "die": { "plane": { "center": [-12, 0.5, -0.5], "size": [20, 6] } },
            "edge": cylinder(-2.0, -2.5, 2.0),
            "wiper": cylinder(5.0, 4.6, 4.0),
            "pad": {
                "plane": { "center": [-13, 0.5, 0.5], "size": [20, 6], "normal": [0, 0, -1] },
                "motion": { "free": { "force": { "z": { "table": [[0, 0], [0.1, -300], [2, -300]] } } } }
            }
        },
        "contacts": {
            "on_die": contact("sheet.bottom", "die"),
            "on_edge": contact("sheet.bottom", "edge"),
            "under_wiper": contact("sheet.top", "wiper"),
            "under_pad": contact("sheet.top", "pad")
        },
        "supports": {
            "end": { "on": "sheet.x_min", "symmetry": "x" },
            "sides": { "on": ["sheet.y_min", "sheet.y_max"], "symmetry": "y" }
        },
        "stages": [
            { "name": "clamp", "until": 0.1 },
            { "name": "wipe", "until": 1, "tools": { "wiper": [0, 0, -4] } }
        ],
        "solution": { "end_time": 1 },
        "output": { "every": 0 }
    }))
}

/// The pad's border lies at a row of nodes, which the strip's stretch moves past it by a thousandth of an element. If points were in
/// contact or not by the place of their foot alone, the row would leave the pad and come back without end: the run took 2,648
/// iterations.
#[test]
fn a_flange_is_wiped_under_a_pad_whose_border_lies_at_nodes() {
    let outcome = wiped("nodes");
    let summary = &outcome.summary;
    assert_eq!(summary.status, RunStatus::Done, "{:?}", summary.reason);
    // What is pressed down is borne by the die, and friction along x by the end.
    let at = |name: &str| outcome.at(&format!("force.{name}"), 1.0);
    let down: f64 = ["die.z", "edge.z", "wiper.z", "pad.z"].map(at).iter().sum();
    assert!(
        at("wiper.z") < -10.0 && down.abs() < 1e-4 * at("die.z"),
        "{down}"
    );
    assert!((at("pad.z") / -300.0 - 1.0).abs() < 1e-4, "{}", at("pad.z"));
    // What is over it is regression.
    assert!(
        summary.newton_iterations < 500,
        "{}",
        summary.newton_iterations
    );
}

/// Nodes that are as far apart as half of the die's radius lean aside on it, and then leave it with nothing on its edge. By default
/// this is seen, and the run is repeated with Gauss points for both round tools; with 5 x 5 of them on their faces, asked for, the
/// edge bears (57.3, 175.2).
#[test]
fn a_flange_that_is_wiped_lies_on_the_edge_of_its_die() {
    let found = wiped("auto");
    let [x, z] = ["x", "z"].map(|c| found.at(&format!("force.edge.{c}"), 1.0));
    println!("({x}, {z}){}", found.summary.in_vain());
    assert!((x / 57.3 - 1.0).abs() < 0.05 && (z / 175.2 - 1.0).abs() < 0.05);
    assert!(found.summary.given_up.runs > 0);
}

/// Two rubber fingers close on a block and lift it off a table, which comes to rest while the block is carried on: nothing but friction
/// holds the block then, and the residuals of the table go down with every iteration until they underflow.
///
/// Closed form: the supports of the fingers carry the weight of the block, 20^3 x 2e-9 x 9810.
#[test]
fn a_block_is_lifted_by_two_fingers_off_a_table_that_comes_to_rest() {
    let finger = |x: f64| {
        json!({
            "mesh": { "block": { "size": [6, 10, 20], "elements": [3, 3, 5], "origin": [x, -5, 5.6] } },
            "material": "rubber"
        })
    };
    let way = |x: f64| {
        let closing = json!({ "table": [[0, 0], [1, x]] });
        let lifting = json!({ "table": [[0, 0], [1, 0], [3, 24]] });
        json!([closing, 0, lifting])
    };
    let outcome = solve(&json!({
        "covact": 1,
        "materials": {
            "rubber": { "neo_hooke": { "E": 2, "nu": 0.45 } },
            "light": { "neo_hooke": { "E": 50, "nu": 0.35, "density": 2e-9 } },
            "hard": { "neo_hooke": { "E": 500, "nu": 0.3 } }
        },
        "bodies": {
            "left": finger(-16.3),
            "right": finger(10.3),
            "block": {
                "mesh": { "block": { "size": [20, 20, 20], "elements": [4, 4, 4], "origin": [-10, -10, 0] } },
                "material": "light"
            },
            "table": {
                "mesh": { "block": { "size": [40, 40, 5], "elements": [5, 5, 1], "origin": [-20, -20, -5] } },
                "material": "hard"
            }
        },
        "contacts": {
            "a": { "slave": "left.x_max", "master": "block.x_min", "friction": 0.6 },
            "c": { "slave": "right.x_min", "master": "block.x_max", "friction": 0.6 },
            "t": { "slave": "block.bottom", "master": "table.top", "friction": 0.3 }
        },
        "supports": {
            "floor": { "on": "table.bottom", "fixed": true },
            "left": { "on": "left.x_min", "displacement": way(1.0) },
            "right": { "on": "right.x_max", "displacement": way(-1.0) }
        },
        "loads": { "weight": { "on": "block", "gravity": [0, 0, { "table": [[0, 0], [1, -9810]] }] } },
        "solution": { "end_time": 3 },
        "output": { "every": 0 }
    }));
    let summary = &outcome.summary;
    assert_eq!(summary.status, RunStatus::Done);
    assert!(!format!("{:?}", summary.warnings).contains("rests on the stabilization"));
    let [left, right] = ["force.left.z", "force.right.z"].map(|name| outcome.column(name));
    let weight = 8000.0 * 2e-9 * 9810.0;
    let lifted = outcome
        .column("time")
        .into_iter()
        .zip(left.iter().zip(&right));
    for (time, (left, right)) in lifted.filter(|(time, _)| *time > 1.2) {
        let carried = left + right;
        assert!(
            (carried / weight - 1.0).abs() < 0.01,
            "{time}: {carried}, {weight}"
        );
    }
    let iterations = summary.newton_iterations;
    assert!(iterations < 600, "{iterations}");
}
