//! What a run watches: penalties, numbers that are none, points that switch round and round, points that pass through.
use crate::common::{done, plate};
use crate::support::{Outcome, solve};
use covact::solve::event::Event;
use serde_json::{Value, json};

fn warned(outcome: &Outcome, words: &str) -> usize {
    let all = outcome.summary.warnings.iter();
    all.filter(|w| w.contains(words)).count()
}

/// The penalty of a plate under a ball as a multiple of the elements' stiffness; 20 times that is the automatic one.
fn with_penalty(field: &str, multiple: f64) -> Value {
    let mut scene = plate(4, 0.5, 1);
    scene["contacts"]["press"] = json!({
        "slave": "plate.top", "master": "ball", "points": { "gauss": 2 },
        "friction": { "coulomb": { "mu": 0.1 } }
    });
    scene["contacts"]["press"][field] = json!({ "scaled": multiple / 20.0 });
    scene
}

#[test]
fn stiff_penalties_are_warned_of_and_stiffer_ones_refused() {
    for (field, words) in [
        ("penalty", "the penalty"),
        ("tangential_penalty", "the tangential penalty"),
    ] {
        let [below, above] = [0.99e4, 1.01e4].map(|m| check(&with_penalty(field, m)).unwrap());
        assert!(
            !below
                .iter()
                .any(|w| w.contains("times the stiffness of the elements"))
        );
        let told: Vec<_> = above
            .iter()
            .filter(|w| w.contains("1.0e4 times the stiffness of the elements"))
            .collect();
        assert_eq!(told.len(), 1, "{above:?}");
        assert!(
            told[0].contains("contact `press`") && told[0].contains(words),
            "{}",
            told[0]
        );
        assert!(check(&with_penalty(field, 0.99e7)).is_ok());
        let (pointer, message, help) = check(&with_penalty(field, 1.01e7)).unwrap_err();
        assert_eq!(pointer, format!("/contacts/press/{field}"));
        assert!(
            message.contains(words) && message.contains("1.0e7 times the stiffness"),
            "{message}"
        );
        assert!(help.contains("augmentation"), "{help}");
    }
}

/// The warnings of a model, or pointer, message and help of its error.
fn check(scene: &Value) -> Result<Vec<String>, (String, String, String)> {
    let mut loaded = covact::scene::parse(&scene.to_string(), "scene.json").expect("a scene");
    loaded.dir = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes");
    match covact::model::build::build(&loaded) {
        Ok(model) => Ok(model.warnings),
        Err(e) => Err((e.pointer.clone(), e.to_string(), e.help.unwrap_or_default())),
    }
}

/// A run that stops where an expression has no value names the field, and keeps what was before.
#[test]
fn expressions_without_a_value_are_named() {
    // At the end of the first step; the times that are tried before a run do not meet it.
    let cases: [(&str, Value, &str); 4] = [
        (
            "/surfaces/ball/motion/translation",
            json!([0, 0, "-t*sqrt(abs(t-1/3)-.001)"]),
            "/surfaces/ball/motion",
        ),
        (
            "/supports/clamped_x",
            json!({ "on": "plate.x_max", "displacement": { "z": "1e-9*ln(abs(t-1/3)-.001)" } }),
            "/supports/clamped_x",
        ),
        (
            "/loads",
            json!({ "push": { "on": "plate.top", "pressure": "ln(abs(t-1/3)-.001)" } }),
            "/loads/push",
        ),
        (
            "/loads",
            json!({ "push": { "on": "plate.top", "pressure": "sqrt(abs(t-1/3)-.001)", "follower": true } }),
            "/loads/push/pressure",
        ),
    ];
    for (at, value, pointer) in cases {
        let mut scene = plate(4, 0.5, 4);
        let (parent, key) = at.rsplit_once('/').unwrap();
        match scene.pointer_mut(parent) {
            Some(parent) => parent[key] = value,
            None => panic!("{parent}"),
        }
        // Its edge is that of `clamped_x` too.
        scene["supports"]
            .as_object_mut()
            .expect("supports")
            .remove("clamped_y");
        scene["solution"]["step"] = json!({ "initial": 0.34, "max": 0.34, "min": 0.3 });
        let outcome = solve(&scene);
        assert_eq!(outcome.summary.status.name(), "not_converged", "{at}");
        let reason = outcome.summary.reason.clone().unwrap_or_default();
        assert!(reason.contains(&format!("`{pointer}`")), "{reason}");
        assert_eq!(outcome.summary.time, 0.0);
    }
}

/// A support that tears the plate away by more than a double holds: the element is named.
#[test]
fn forces_that_are_not_finite_are_placed() {
    let mut scene = plate(4, 0.5, 1);
    scene["supports"]["clamped_x"] =
        json!({ "on": "plate.x_max", "displacement": { "x": "1e200*t", "y": 0, "z": 0 } });
    scene["supports"]
        .as_object_mut()
        .expect("supports")
        .remove("clamped_y");
    scene["solution"]["step"]["min"] = json!(0.5);
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "not_converged");
    let reason = outcome.summary.reason.clone().unwrap_or_default();
    assert!(reason.contains("body `plate`"), "{reason}");
}

/// The ball passes the plate within the first step as far as its ends are looked at; smaller steps catch it.
#[test]
fn a_tool_that_would_pass_through_is_caught_by_smaller_steps() {
    let mut scene = plate(4, 0.5, 1);
    scene["surfaces"]["ball"]["motion"]["translation"] =
        json!([0, 0, { "table": [[0, 0], [1, -2.5]] }]);
    scene["surfaces"]["ball"]["depth"] = json!(1.0);
    let outcome = done(&scene);
    assert_eq!(warned(&outcome, "passed through"), 0);
    assert!(outcome.summary.cuts > 0);
    let cut = outcome.events.iter().find_map(|e| match e {
        Event::StepCut { reason, .. } => Some(reason.clone()),
        _ => None,
    });
    let reason = cut.unwrap_or_default();
    assert!(
        reason.contains("contact `press`") && reason.contains("passed through surface `ball`"),
        "{reason}"
    );
    let mut small = scene.clone();
    small["solution"]["step"] = json!({ "initial": 0.25, "max": 0.25 });
    let small = done(&small);
    let [a, b] = [&outcome, &small].map(|o| o.at("force.ball.z", 1.0));
    assert!(a < -100.0 && (a - b).abs() < 1e-7 * a.abs(), "{a} {b}");
}

/// A thin sheet that a ball presses on a block: a step that has no equilibrium with all of what presses on the sheet's elements in their
/// thickness strain is taken with less, and told.
#[test]
fn strains_that_do_not_take_what_presses_are_told() {
    let scene = json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 105, "nu": 0.3 } } },
        "bodies": {
            "base": {
                "element": "h8_displacement", "material": "rubber",
                "mesh": { "block": { "min": [-4.6, -5.7, -3.34], "max": [4.6, 5.7, -0.34], "elements": [5, 5, 2] } }
            },
            "sheet": {
                "material": "rubber",
                "mesh": { "plate": {
                    "size": [8.32, 10.44], "thickness": 0.248, "elements": [6, 8], "origin": [-4.16, -5.22, -0.124]
                } }
            }
        },
        "surfaces": { "tool": {
            "sphere": { "radius": 3.972, "center": [0.5, -0.52, 4.129] },
            "motion": { "translation": [0, 0, "-0.591*t"] }
        } },
        "contacts": {
            "lie": { "slave": "sheet.bottom", "master": "base.top", "friction": 0.089 },
            "press": { "slave": "sheet.top", "master": "tool", "points": { "gauss": 2 } }
        },
        "supports": {
            "floor": { "on": "base.bottom", "fixed": true },
            "ends": { "on": ["sheet.x_min", "sheet.x_max"], "fixed": true }
        },
        "loads": { "push": { "on": "sheet.bottom", "pressure": { "table": [[0, 0], [0.3, 0.00097]] } } },
        "output": { "every": 0 }
    });
    let words = "elements that are pressed on both faces could not take all";
    assert_eq!(warned(&done(&scene), words), 1);
}
