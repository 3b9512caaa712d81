//! Contact that is lost is told, by pair and step, and never passes for an equilibrium.
use crate::common::{done, plate};
use crate::support::solve;
use covact::solve::event::Event;
use serde_json::json;

fn warnings(outcome: &crate::support::Outcome, words: &str) -> Vec<String> {
    let all = outcome.summary.warnings.iter();
    all.filter(|w| w.contains(words)).cloned().collect()
}

fn notes(outcome: &crate::support::Outcome, words: &str) -> Vec<String> {
    let of = |e: &Event| match e {
        Event::Note { text } if text.contains(words) => Some(text.clone()),
        _ => None,
    };
    outcome.events.iter().filter_map(of).collect()
}

#[test]
fn points_that_sink_deeper_than_the_depth_fail_the_step() {
    // A penalty a thousandth of what the plate asks for lets the ball sink in by its whole way.
    for gap in ["pointwise", "averaged"] {
        let mut scene = plate(6, 3.0, 4);
        scene["contacts"]["press"]["gap"] = json!(gap);
        scene["contacts"]["press"]["penalty"] = json!({ "value": 1 });
        scene["surfaces"]["ball"]["depth"] = json!(1.2);
        scene["solution"]["step"] = json!({ "initial": 0.25, "max": 0.25, "min": 0.02 });
        let outcome = solve(&scene);
        assert_eq!(outcome.summary.status.name(), "not_converged");
        let reason = outcome.summary.reason.clone().unwrap_or_default();
        assert!(
            reason.contains("contact `press`: ")
                && reason.contains("sank deeper than the `depth` 1.2")
                && reason.contains("surface `ball`"),
            "{reason}"
        );
        // What was accepted is in contact.
        assert!(outcome.column("points.active").last() > Some(&0.0));
    }
}

#[test]
fn a_tool_that_jumps_through_the_sheet_in_the_smallest_step_fails() {
    // The first step ends with the middle of the plate deeper in the ball than its depth; it never touched. Half of the step
    // is not allowed.
    for gap in ["pointwise", "averaged"] {
        let mut scene = plate(6, 3.0, 1);
        scene["contacts"]["press"]["gap"] = json!(gap);
        scene["surfaces"]["ball"]["depth"] = json!(0.001);
        scene["solution"]["step"]["min"] = json!(0.6);
        let outcome = solve(&scene);
        assert_eq!(outcome.summary.status.name(), "not_converged");
        let reason = outcome.summary.reason.clone().unwrap_or_default();
        assert!(
            reason.contains("contact `press`: ")
                && reason.contains("passed through surface `ball`"),
            "{reason}"
        );
    }
}

/// A tool that is drawn back leaves what it pressed: that is noted.
#[test]
fn a_contact_that_opens_is_told_with_its_step() {
    for gap in ["pointwise", "averaged"] {
        let mut scene = plate(6, 1.0, 2);
        scene["contacts"]["press"]["gap"] = json!(gap);
        scene["surfaces"]["ball"]["motion"]["translation"] =
            json!([0, 0, { "table": [[0, 0], [0.5, -1], [1, 1]] }]);
        let outcome = done(&scene);
        assert!(warnings(&outcome, "opened at step").is_empty());
        let told = notes(&outcome, "opened at step");
        assert_eq!(told.len(), 1, "{told:?}");
        let active = outcome.column("points.active");
        let first = active.iter().position(|a| *a > 0.0).expect("contact");
        let step = first
            + active[first..]
                .iter()
                .position(|a| *a == 0.0)
                .expect("opens")
            + 1;
        let expected = format!("contact `press` opened at step {step} (");
        assert!(told[0].starts_with(&expected), "{} {expected}", told[0]);
    }
}

/// A plate that a load lifts off the ball while it still presses has lost its contact by what is done on it: that is warned of.
#[test]
fn a_contact_that_a_load_opens_is_warned_of() {
    let mut scene = plate(6, 1.0, 2);
    scene["surfaces"]["ball"]["motion"]["translation"] =
        json!([0, 0, { "table": [[0, 0], [0.5, -0.5], [1, -0.5]] }]);
    scene["loads"] = json!({ "away": {
        "on": "plate.bottom", "pressure": { "table": [[0, 0], [0.5, 0], [1, -40]] }
    } });
    let outcome = done(&scene);
    let told = warnings(&outcome, "opened at step");
    println!("{:?}", outcome.summary.warnings);
    assert_eq!(told.len(), 1, "{:?}", outcome.summary.warnings);
    assert!(notes(&outcome, "opened at step").is_empty());
}

/// The plate and the ball travel far together while the ball presses, so that the last digit of a position grows.
#[test]
fn a_balance_that_only_rounding_accepts_is_told() {
    let moved = |way: f64| -> serde_json::Value {
        let mut scene = plate(6, 1.0, 2);
        let up = json!({ "table": [[0, 0], [1, way]] });
        for (name, set) in [("clamped_x", "plate.x_max"), ("clamped_y", "plate.y_max")] {
            scene["supports"][name] =
                json!({ "on": set, "displacement": { "x": 0, "y": 0, "z": up } });
        }
        scene["surfaces"]["ball"]["motion"]["translation"] =
            json!([0, 0, { "table": [[0, 0], [1, way - 2.0]] }]);
        scene
    };
    // Over ten lengths nothing is to be told; at 1e10 the positions of points that press have five digits behind the
    // point, and the forces one or two in all.
    let near = done(&moved(10.0));
    assert!(warnings(&near, "balanced to").is_empty());
    assert!(near.column("residual").iter().all(|r| *r < 1e-10));
    let far = done(&moved(1e10));
    assert_eq!(warnings(&far, "balanced to").len(), 1);
    assert!(far.column("residual").iter().all(|r| *r > 1e-4));
}

/// A plate that a punch presses towards a floor. Where the floor stands still and is not reached it may be a stop, and where it
/// moves with the punch a part of it, which is told; where it moves in another way it was to be touched.
#[test]
fn a_stop_that_is_not_reached_is_told() {
    let scene = |floor: serde_json::Value| {
        json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
            "bodies": { "plate": {
                "mesh": { "plate": { "size": [10, 4], "thickness": 1, "elements": [5, 2] } }, "material": "m"
            } },
            "surfaces": {
                "punch": {
                    "sphere": { "radius": 3, "center": [10, 2, 3.6] }, "motion": { "translation": [0, 0, "-0.5*t"] }
                },
                "floor": floor
            },
            "contacts": {
                "press": { "slave": "plate.top", "master": "punch" },
                "stop": { "slave": "plate.bottom", "master": "floor" }
            },
            "supports": { "clamp": { "on": "plate.x_min", "fixed": true } },
            "output": { "every": 0 }
        })
    };
    let plane = |motion: serde_json::Value| {
        json!({
            "plane": { "center": [5, 2, -2], "size": [30, 30] }, "motion": { "translation": motion }
        })
    };
    let stop = solve(&scene(plane(json!([0, 0, 0]))));
    assert_eq!(stop.summary.status.name(), "done");
    let told = warnings(&stop, "contact `stop` never touched");
    assert!(
        told.len() == 1 && told[0].contains("may be a stop"),
        "{told:?}"
    );
    assert!(warnings(&stop, "press").is_empty());
    // What goes the punch's way may be a part of it.
    let part = solve(&scene(plane(json!([0, 0, "-0.5*t"]))));
    assert_eq!(part.summary.status.name(), "done");
    let told = warnings(&part, "contact `stop` never touched");
    assert!(
        told.len() == 1 && told[0].contains("a part of a tool"),
        "{told:?}"
    );
    let missed = solve(&scene(plane(json!([0, 0, "0.2*t"]))));
    assert_eq!(missed.summary.status.name(), "no_contact");
    let reason = missed.summary.reason.as_deref().unwrap_or_default();
    assert!(reason.contains("contact `stop` never touched"), "{reason}");
}

/// A straight column between two walls, shortened at once to far beyond its critical load.
fn straight_column(elements: u32) -> serde_json::Value {
    let wall = |z: f64, normal: f64| json!({ "plane": { "size": [240, 20], "center": [50, 0, z], "normal": [0, 0, normal] } });
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 210000, "nu": 0.3 } } },
        "bodies": { "column": {
            "mesh": { "plate": { "size": [100, 5], "thickness": 1, "elements": [elements, 1] } }, "material": "m"
        } },
        "surfaces": { "upper": wall(2.5, -1.0), "lower": wall(-2.5, 1.0) },
        "contacts": {
            "u": { "slave": "column.top", "master": "upper" },
            "l": { "slave": "column.bottom", "master": "lower" }
        },
        "supports": {
            "foot": { "on": "column.x_min", "fixed": true },
            "head": { "on": "column.x_max", "displacement": { "x": "-1.5*t", "z": 0 } },
            "y": { "on": "column", "plane_strain": "y" }
        },
        "output": { "every": 0 }
    })
}

/// Three elements have no smooth shape to buckle in: the column stays straight, and the walls are not to blame.
#[test]
fn a_column_that_stays_straight_is_told_to_be_unstable() {
    let outcome = solve(&straight_column(3));
    assert_eq!(outcome.summary.status.name(), "no_contact");
    let reason = outcome.summary.reason.clone().unwrap_or_default();
    assert!(
        reason.contains("never touched") && reason.contains("would have buckled"),
        "{reason}"
    );
}

/// Of fifty elements it buckles to one side, which nothing but rounding decides: under Euler's load of clamped ends in plane strain,
/// 379.6, until it touches a wall.
#[test]
fn a_straight_column_buckles_to_one_side() {
    let outcome = solve(&straight_column(50));
    assert_eq!(
        outcome.summary.status.name(),
        "done",
        "{:?}",
        outcome.summary
    );
    let euler = 4.0 * std::f64::consts::PI.powi(2) * 210e3 / 0.91 * 5.0 / 12.0 / 100f64.powi(2);
    let column = |name: &str| outcome.column(name);
    let walls = [column("force.upper.z"), column("force.lower.z")];
    let free = (0..walls[0].len()).take_while(|i| walls.iter().all(|w| w[*i] == 0.0));
    let forces: Vec<f64> = free.map(|i| -column("force.head.x")[i] / euler).collect();
    assert!(!forces.is_empty(), "{walls:?}");
    assert!(forces.iter().all(|f| (f - 1.0).abs() < 0.04), "{forces:?}");
}

/// A mat that falls on a rod thinner than the depth up to which contact is looked for has its ends far below it in the first step, and
/// would have fallen through: no point of it lies deep below the surface at any time.
#[test]
fn a_mat_that_falls_on_a_rod_hangs_over_it() {
    let scene = json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 3e7, "nu": 0.45, "density": 1200 } } },
        "bodies": { "mat": {
            "mesh": { "plate": { "size": [0.02, 0.2], "thickness": 0.002, "elements": [2, 26], "origin": [0, 0.05, 0.1315] } },
            "material": "rubber"
        } },
        "surfaces": { "rod": {
            "cylinder": { "radius": 0.01, "length": 0.3, "center": [0, 0.15, 0.12], "axis": [1, 0, 0] }
        } },
        "contacts": { "c": { "slave": "mat.bottom", "master": "rod", "friction": 0.5 } },
        "supports": { "w": { "on": "mat.x_min", "symmetry": "x" } },
        "loads": { "g": { "on": "mat", "gravity": [0, 0, "-9.81*t"] } },
        "output": { "every": 0 }
    });
    let outcome = done(&scene);
    let weight = 0.02 * 0.2 * 0.002 * 1200.0 * 9.81;
    let carried = outcome.at("force.rod.z", 1.0);
    assert!(
        (carried / weight - 1.0).abs() < 1e-3,
        "{carried} of {weight}"
    );
}
