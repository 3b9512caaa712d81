//! Slave points that start below the master: strained, taken as touching, shrunk in, refused.
use crate::support::{Outcome, scene_json, solve};
use serde_json::{Value, json};

/// A block, free sideways, under a rigid plane that starts `depth` below its top. nu = 0, so that the pressed state is one
/// of uniform strain.
fn pressed(choice: Value, depth: f64) -> Value {
    json!({
        "covact": 1,
        "materials": { "foam": { "st_venant_kirchhoff": { "E": 100, "nu": 0 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [2, 2, 4], "elements": [2, 2, 4] } },
            "material": "foam"
        } },
        "surfaces": { "plane": {
            "plane": { "center": [1, 1, 4.0 - depth], "size": [8, 8] },
            "side": { "point": [1, 1, 0] }
        } },
        "contacts": { "press": {
            "slave": "block.top", "master": "plane", "penalty": { "value": 1e5 },
            "initial_overclosure": choice
        } },
        "supports": {
            "floor": { "on": "block.bottom", "symmetry": "z" },
            "x": { "on": "block.x_min", "symmetry": "x" },
            "y": { "on": "block.y_min", "symmetry": "y" }
        },
        "solution": {
            "step": { "initial": 0.25, "max": 0.25 }, "newton": { "tolerance": 1e-9 }, "threads": 1
        },
        "output": { "every": 0 }
    })
}

fn run(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    assert!(outcome.summary.reason.is_none(), "{:?}", outcome.summary);
    outcome
}

/// Force on the plane when the block is shortened by `d`: stretch l = 1 - d / 4 (the penetration, 1e-4 of `d`, taken off by
/// the caller's tolerance), second Piola-Kirchhoff stress E (l^2 - 1) / 2, force l S A.
fn uniform(d: f64) -> f64 {
    let l = 1.0 - d / 4.0;
    -4.0 * l * 100.0 * (l * l - 1.0) / 2.0
}

#[test]
fn an_interference_shrunk_in_ends_as_the_closed_form_and_as_the_same_fit_by_displacement() {
    let d = 0.2;
    let shrunk = run(&pressed(json!({ "shrink": { "until": 0.75 } }), d));
    let at_once = run(&pressed(json!("strain"), d));
    let mut moved = pressed(json!("strain"), 0.0);
    moved["surfaces"]["plane"]["motion"] = json!({ "translation": [0, 0, format!("-{d}*t")] });
    let moved = run(&moved);
    let force = |o: &Outcome, t: f64| o.at("force.plane.z", t);
    for (name, other) in [("displacement", &moved), ("strain", &at_once)] {
        for column in ["force.plane.z", "energy.internal", "penetration.max"] {
            let (a, b) = (shrunk.at(column, 1.0), other.at(column, 1.0));
            assert!(
                (a / b - 1.0).abs() < 1e-9 && a != 0.0,
                "{name}, {column}: {a} {b}"
            );
        }
    }
    // The penalty gives way by p / eps: 5.2e-5 of 0.2.
    let penetration = shrunk.at("penetration.max", 1.0);
    let exact = uniform(d - penetration);
    assert!(
        (force(&shrunk, 1.0) / -exact - 1.0).abs() < 1e-9,
        "{} {exact}",
        force(&shrunk, 1.0)
    );
    // On the way a part of the interference is resolved: a third at t = 1/4, all from t = 3/4 on.
    for (t, part) in [(0.25, 1.0 / 3.0), (0.5, 2.0 / 3.0), (0.75, 1.0)] {
        let resolved = d * part - shrunk.at("penetration.max", t);
        let exact = uniform(resolved);
        assert!((force(&shrunk, t) / -exact - 1.0).abs() < 1e-9, "at {t}");
    }
}

/// A fit that is asked for may be deeper than half of an element, which is 1 wide. What is not asked for is refused there: such a surface
/// stands where it does not belong.
#[test]
fn a_fit_may_be_deeper_than_half_an_element() {
    let d = 0.6;
    let shrunk = run(&pressed(json!({ "shrink": { "until": 0.75 } }), d));
    let force = shrunk.at("force.plane.z", 1.0);
    let exact = uniform(d - shrunk.at("penetration.max", 1.0));
    assert!(
        (force / -exact - 1.0).abs() < 1e-9,
        "{force} for {}",
        -exact
    );
    let text = pressed(json!("strain"), d).to_string();
    let loaded = covact::scene::parse(&text, "fit.json").expect("a scene");
    let refused = covact::model::build::build(&loaded).expect_err("deeper than half an element");
    assert!(
        refused
            .to_string()
            .contains("more than half an element, 0.5"),
        "{refused}"
    );
}

#[test]
fn what_counts_as_touching_is_not_stressed_and_presses_from_there_on() {
    let still = run(&pressed(json!("stress_free"), 0.2));
    assert_eq!(still.at("force.plane.z", 1.0), 0.0);
    assert_eq!(still.at("energy.internal", 1.0), 0.0);
    let mut pushed = pressed(json!("stress_free"), 0.2);
    pushed["surfaces"]["plane"]["motion"] = json!({ "translation": [0, 0, "-0.1*t"] });
    let pushed = run(&pushed);
    let mut flush = pressed(json!("strain"), 0.0);
    flush["surfaces"]["plane"]["motion"] = json!({ "translation": [0, 0, "-0.1*t"] });
    let flush = run(&flush);
    for column in [
        "force.plane.z",
        "energy.internal",
        "penetration.max",
        "pressure.max",
    ] {
        let (a, b) = (pushed.at(column, 1.0), flush.at(column, 1.0));
        assert!((a / b - 1.0).abs() < 1e-9 && a != 0.0, "{column}: {a} {b}");
    }
}

#[test]
fn an_overclosure_on_edges_and_curved_faces_is_stress_free_too() {
    // A ball that starts .05 deep in a plate.
    let mut scene = scene_json("ball_on_plate.json");
    scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = json!([12, 12]);
    scene["surfaces"]["ball"]["sphere"]["center"] = json!([0, 0, 25.95]);
    scene["surfaces"]["ball"]["motion"] = json!({});
    scene["contacts"]["press"]["initial_overclosure"] = json!("stress_free");
    scene["output"] = json!({ "every": 0 });
    let outcome = run(&scene);
    assert_eq!(outcome.at("energy.internal", 1.0), 0.0);
    assert_eq!(outcome.at("pressure.max", 1.0), 0.0);
}

#[test]
fn a_refused_overclosure_names_pair_amount_and_place() {
    use covact::model::build::build;
    let text = pressed(json!("refuse"), 0.2).to_string();
    let loaded = covact::scene::parse(&text, "scene.json").unwrap();
    let error = build(&loaded).expect_err("refused");
    assert_eq!(error.pointer, "/contacts/press/initial_overclosure");
    let message = error.to_string();
    for part in ["`press`", "overclosure of 0.2", "9 point(s)", "4)"] {
        assert!(message.contains(part), "{message}");
    }
    assert!(error.help.is_some());
}
