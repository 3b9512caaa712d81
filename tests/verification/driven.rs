//! Rigid surfaces driven by force.
//!
//! Constructions with a known answer: the same equilibrium reached by force and by displacement, balances of force and
//! moment, a rigid plane on an elastic foundation.
use crate::support::{Outcome, scene_json, set, solve};
use covact::solve::event::Event;
use serde_json::{Value, json};

/// A quarter of the clamped plate under a ball, on `n` x `n` elements.
fn plate(n: u32) -> Value {
    let mut scene = scene_json("ball_on_plate.json");
    set(&mut scene, "/bodies/plate/mesh/plate/elements", vec![n, n]);
    scene["output"] = json!({ "every": 0 });
    scene["solution"] = json!({
        "step": { "initial": 0.25, "max": 0.25 },
        "newton": { "tolerance": 1e-11 },
        "threads": 1
    });
    scene
}

fn done(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    outcome
}

#[test]
fn a_ball_pressed_by_its_weight_stands_where_the_same_force_is_met_by_displacement() {
    let mut by_force = plate(10);
    by_force["surfaces"]["ball"]["sphere"]["center"] = json!([0, 0, 29]);
    by_force["surfaces"]["ball"]["motion"] = json!({ "free": { "force": { "z": "-600*t" } } });
    let forced = done(&by_force);
    println!("{:?}", forced.summary);
    let depth = forced.at("displacement.ball.z", 1.0);
    let mut by_displacement = plate(10);
    by_displacement["surfaces"]["ball"]["sphere"]["center"] = json!([0, 0, 29]);
    by_displacement["surfaces"]["ball"]["motion"] =
        json!({ "translation": [0, 0, { "table": [[0, -3], [1, depth]] }] });
    let moved = done(&by_displacement);
    println!("{:?}", moved.summary);
    assert!((forced.at("force.ball.z", 1.0) / -600.0 - 1.0).abs() < 1e-9);
    for name in [
        "force.ball.x",
        "force.ball.z",
        "energy.internal",
        "energy.contact",
        "penetration.max",
    ] {
        let (a, b) = (forced.at(name, 1.0), moved.at(name, 1.0));
        assert!(
            a.abs() > 0.0 && (a / b - 1.0).abs() < 1e-8,
            "{name}: {a} {b}"
        );
    }
    assert!(forced.at("force_balance.ball.z", 1.0).abs() < 1e-7);
}

/// A rigid plane above a block that cannot move, pressed by the penalty alone: a Winkler foundation of modulus `eps`.
///
/// ```text
///      F  |   M about y
///   ______v___________     plane
///   ==================     block, all nodes held; eps per area
/// ```
fn foundation(free: Value) -> Value {
    json!({
        "covact": 1,
        "materials": { "stone": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.2 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [-3, -2, -1], "max": [3, 2, 0], "elements": [6, 4, 1] } },
            "material": "stone",
            "sets": { "all": { "nodes_in_box": { "min": [-9, -9, -9], "max": [9, 9, 9] } } }
        } },
        "surfaces": { "plane": {
            "plane": { "center": [0, 0, 0.25], "size": [12, 12] },
            "side": { "point": [0, 0, -5] },
            "motion": { "free": free }
        } },
        "contacts": { "press": {
            "slave": "block.top", "master": "plane", "points": { "gauss": 2 }, "penalty": { "value": 50 }
        } },
        "supports": { "held": { "on": "block.all", "fixed": true } },
        "solution": { "step": { "initial": 1, "max": 1 }, "newton": { "tolerance": 1e-12 }, "threads": 1 },
        "output": { "every": 0 }
    })
}

#[test]
fn a_plane_on_a_winkler_foundation_sinks_and_tilts_as_the_closed_form_says() {
    // Area 24, second moments 6 * 4^3 / 12 = 32 about x and 4 * 6^3 / 12 = 72 about y; two Gauss points a side
    // integrate them exactly. Small angles: the closed form is right to their square. The centre lies in the plane: a
    // tilted force with an arm across it would have a moment of its own.
    let (f, m_x, m_y) = (-6.0, 0.3, 0.5);
    let outcome = done(&foundation(json!({
        "center": [0, 0, 0.25],
        "force": { "z": f }, "moment": { "x": m_x, "y": m_y }
    })));
    let sunk = f / (50.0 * 24.0) - 0.25;
    let angle = |m: f64, i: f64| (m / (50.0 * i)).to_degrees();
    for (name, exact) in [
        ("displacement.plane.z", sunk),
        ("rotation.plane.x", angle(m_x, 32.0)),
        ("rotation.plane.y", angle(m_y, 72.0)),
        ("force.plane.z", f),
    ] {
        let value = outcome.at(name, 1.0);
        assert!(
            (value / exact - 1.0).abs() < 1e-4,
            "{name}: {value}, not {exact}"
        );
    }
    for axis in ["x", "y"] {
        let left = outcome.at(&format!("moment_balance.plane.{axis}"), 1.0);
        // What holds the rotation vector's z at zero takes part in second order of the angles: 2e-4 by 5e-5 here.
        assert!(left.abs() < 1e-8, "moment about {axis}: {left:e}");
    }
    // The same load as one force beside the middle: the moments are those of its arm.
    let beside = done(&foundation(json!({
        "center": [-m_y / f, m_x / f, 0.25],
        "force": { "z": f }, "moment": { "x": 0, "y": 0 }
    })));
    for (name, tolerance) in [
        ("rotation.plane.x", 1e-4),
        ("rotation.plane.y", 1e-4),
        ("force.plane.z", 1e-9),
    ] {
        let (a, b) = (beside.at(name, 1.0), outcome.at(name, 1.0));
        assert!((a / b - 1.0).abs() < tolerance, "{name}: {a} {b}");
    }
}

#[test]
fn a_plane_waits_for_its_force_and_rests_when_it_ends() {
    // As a holder that comes first and a punch after it: no force until t = .3, its peak at .6, none from .8 on.
    let f = -6.0;
    let force = json!({ "table": [[0, 0], [0.3, 0], [0.6, f], [0.8, 0], [1, 0]] });
    let mut scene = foundation(json!({ "center": [0, 0, 0.25], "force": { "z": force } }));
    scene["solution"]["step"] = json!({ "initial": 0.1, "max": 0.1 });
    let loaded = covact::scene::parse(&scene.to_string(), "scene.json").unwrap();
    let notes = covact::model::build::build(&loaded)
        .unwrap()
        .notes
        .join(" ");
    let outcome = done(&scene);
    assert!(
        notes.contains(
            "surface `plane`: no force acts on it before t = 0.3: it waits where it is placed"
        ),
        "{notes}"
    );
    for (t, sunk, pressed) in [
        (0.3, 0.0, 0.0),
        (0.6, f / (50.0 * 24.0) - 0.25, f),
        (0.8, -0.25, 0.0),
        (1.0, -0.25, 0.0),
    ] {
        let (z, force) = (
            outcome.at("displacement.plane.z", t),
            outcome.at("force.plane.z", t),
        );
        assert!((z - sunk).abs() < 1e-9, "at {t}: {z}, not {sunk}");
        assert!(
            (force - pressed).abs() < 1e-9,
            "at {t}: {force}, not {pressed}"
        );
    }
}

/// A block on its foot under a plane that is loaded off its centre.
fn tilting(motion: Value) -> Value {
    let mut scene = foundation(json!({}));
    scene["bodies"]["block"]["mesh"]["block"]["min"] = json!([-3, -2, -4]);
    scene["bodies"]["block"]["mesh"]["block"]["elements"] = json!([5, 4, 4]);
    scene["supports"]["held"]["on"] = json!("block.bottom");
    scene["surfaces"]["plane"]["motion"] = motion;
    scene["contacts"]["press"]["penalty"] = json!({ "scaled": 1 });
    scene["solution"]["step"] = json!({ "initial": 0.25, "max": 0.25 });
    scene
}

#[test]
fn a_block_loaded_off_its_centre_tilts_its_plane_in_balance() {
    let (e_x, e_y) = (0.6, -0.3);
    let outcome = done(&tilting(json!({ "free": {
        "center": [e_x, e_y, 0.25],
        "force": { "z": "-1200*t" }, "moment": { "x": 0, "y": 0 }
    } })));
    println!("{:?}", outcome.summary);
    for t in [0.25, 0.5, 1.0] {
        let f = 1200.0 * t;
        assert!((outcome.at("force.plane.z", t) / -f - 1.0).abs() < 1e-9);
        for axis in ["x", "y"] {
            let left = outcome.at(&format!("moment_balance.plane.{axis}"), t);
            assert!(
                left.abs() < 1e-8 * f,
                "moment about {axis} at {t}: {left:e}"
            );
        }
    }
    // It leans to where it is pushed: down at positive x, by the right-hand rule about y; down at negative y about x.
    let (x, y) = (
        outcome.at("rotation.plane.x", 1.0),
        outcome.at("rotation.plane.y", 1.0),
    );
    assert!(y > 0.5 && x > 0.5, "{x} {y}");
    // Newton's method is quadratic once the same points stay in contact.
    let last = residuals(&outcome, outcome.summary.steps);
    println!("{last:?}");
    assert!(quadratic(&last), "{last:?}");
}

/// Relative residuals of the last attempt at a step.
fn residuals(outcome: &Outcome, step: u32) -> Vec<f64> {
    use covact::solve::event::Event;
    let mut out = Vec::new();
    for event in &outcome.events {
        match event {
            Event::Iteration {
                step: s,
                iteration,
                residual,
                ..
            } if *s == step => {
                if *iteration == 0 {
                    out.clear();
                }
                out.push(*residual);
            }
            _ => {}
        }
    }
    out
}

/// Whether an iteration doubles the number of right digits, within a factor of 30, from where round-off does not do the
/// same.
fn quadratic(r: &[f64]) -> bool {
    (r.windows(2)).any(|w| (1e-6..1e-2).contains(&w[0]) && w[1] < 30.0 * w[0] * w[0])
}

#[test]
fn a_tilted_plane_by_force_is_the_same_plane_turned_by_as_much() {
    let forced = done(&tilting(json!({ "free": {
        "center": [0.6, 0, 0.25],
        "force": { "z": "-1200*t" }, "moment": { "y": 0 }
    } })));
    let (z, y) = (
        forced.at("displacement.plane.z", 1.0),
        forced.at("rotation.plane.y", 1.0),
    );
    let moved = done(&tilting(json!({
        "translation": [0, 0, { "table": [[0, -0.25], [1, z]] }],
        "rotation": { "center": [0.6, 0, 0.25], "axis": [0, 1, 0], "angle": format!("{y}*t") }
    })));
    for name in [
        "force.plane.x",
        "force.plane.z",
        "moment.plane.y",
        "energy.internal",
        "penetration.max",
    ] {
        let (a, b) = (forced.at(name, 1.0), moved.at(name, 1.0));
        assert!(
            a.abs() > 0.0 && (a / b - 1.0).abs() < 1e-8,
            "{name}: {a} {b}"
        );
    }
}

#[test]
fn a_ball_drawn_over_a_plate_under_its_weight() {
    // x prescribed, z free; the state does not remember how it was reached, so that the same ball moved by what was
    // found meets the same forces.
    let scene = |motion: Value| {
        let mut scene = plate(8);
        scene["bodies"]["plate"]["mesh"]["plate"]["origin"] = json!([-25, 0, 0]);
        scene["supports"]["symmetry_x"] = json!({ "on": "plate.x_min", "fixed": true });
        scene["surfaces"]["ball"]["motion"] = motion;
        scene
    };
    let drawn = done(&scene(json!({
        "translation": ["6*t", 0, 0],
        "free": { "force": { "z": -500 } }
    })));
    let z = drawn.at("displacement.ball.z", 1.0);
    for t in drawn.column("time") {
        assert!(
            (drawn.at("force.ball.z", t) / -500.0 - 1.0).abs() < 1e-9,
            "at {t}"
        );
    }
    let table = json!({ "table": [[0, -1], [1, z]] });
    let moved = done(&scene(json!({ "translation": ["6*t", 0, table] })));
    for name in ["force.ball.x", "force.ball.z", "energy.internal"] {
        let (a, b) = (drawn.at(name, 1.0), moved.at(name, 1.0));
        assert!(
            a.abs() > 1.0 && (a / b - 1.0).abs() < 1e-7,
            "{name}: {a} {b}"
        );
    }
    // The guide takes what pushes the ball back to the middle.
    let guide = drawn.at("force_balance.ball.x", 1.0);
    assert!((guide + drawn.at("force.ball.x", 1.0)).abs() < 1e-9 * guide.abs() && guide != 0.0);
}

#[test]
fn a_ball_that_may_spin_is_held_and_named() {
    let mut scene = plate(8);
    scene["surfaces"]["ball"]["motion"] = json!({ "free": {
        "center": [0, 0, 26], "force": { "z": "-400*t" }, "moment": { "z": 0 }
    } });
    let outcome = done(&scene);
    let warning = outcome
        .summary
        .warnings
        .iter()
        .find(|w| w.contains("about z"));
    let warning = warning.expect("a warning that names the motion");
    assert!(
        warning.contains("surface `ball`") && warning.contains("held"),
        "{warning}"
    );
    assert!(outcome.at("rotation.ball.z", 1.0).abs() < 1e-9);
}

#[test]
fn forces_that_nothing_resists_are_named() {
    let mut scene = plate(8);
    scene["surfaces"]["ball"]["motion"] = json!({ "free": {
        "center": [0, 0, 26], "force": { "z": "-400*t" }, "moment": { "z": 5 }
    } });
    let spun = solve(&scene);
    let reason = spun.summary.reason.expect("a reason");
    assert_eq!(spun.summary.status.name(), "not_converged");
    assert!(
        reason.contains("nothing resists the motion of surface `ball` about z"),
        "{reason}"
    );
    // Pulled off again in the second half.
    let mut scene = plate(8);
    scene["surfaces"]["ball"]["motion"] = json!({ "free": {
        "force": { "z": { "table": [[0, 0], [0.5, -400], [1, 400]] } }
    } });
    let lifted = solve(&scene);
    let reason = lifted.summary.reason.expect("a reason");
    assert!(
        reason.contains("surface `ball`, which forces drive along z, has lost all contact"),
        "{reason}"
    );
    assert!(lifted.summary.time > 0.7, "{}", lifted.summary.time);
}

/// Problems of a scene before anything is read, then the error of its model: pointer and message.
/// A cam, a cylinder that turns about an axis 5 beside its own under a moment, below a leaf spring that it does not touch yet. Turned by
/// about `asin(gap / 5)` it does; from there on the moment of what it lifts is the one that drives it. Friction takes part, but what lies
/// off the line to the axis is resisted by more than that.
#[test]
fn a_cam_is_turned_by_its_moment_until_it_touches() {
    let gap = 0.06;
    let outcome = done(&json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 206000, "nu": 0.3 } } },
        "bodies": { "leaf": {
            "mesh": { "plate": {
                "size": [60, 10], "thickness": 1, "elements": [40, 2], "origin": [-60, 0, 12.5 + gap]
            } },
            "material": "steel"
        } },
        "surfaces": { "cam": {
            "cylinder": { "radius": 12, "length": 40, "center": [-4, 5, 0], "axis": [0, 1, 0] },
            "motion": { "free": { "moment": { "y": "-60*t" }, "center": [-9, 5, 0] } }
        } },
        "contacts": { "lift": { "slave": "leaf.bottom", "master": "cam", "friction": 0.1 } },
        "supports": {
            "clamp": { "on": "leaf.x_min", "fixed": true },
            "side": { "on": "leaf.y_min", "symmetry": "y" }
        },
        "output": { "every": 0 }
    }));
    let told = outcome.events.iter().find_map(|event| match event {
        Event::Model { notes, .. } => notes.iter().find(|n| n.contains("until it touches")),
        _ => None,
    });
    let start = told.expect("a note on where it starts");
    // The first node that it meets lies at x = -4.5; where its axis is by then follows from the angle.
    let mut angle = 0.0f64;
    for _ in 0..50 {
        let aside: f64 = 4.5 - 5.0 * angle.cos();
        angle = ((12.0 + gap - (144.0 - aside * aside).sqrt()) / 5.0).asin();
    }
    let angle = -angle.to_degrees();
    let told = start
        .split(['(', ',', ')'])
        .nth(2)
        .and_then(|n| n.trim().parse::<f64>().ok());
    assert!(
        told.is_some_and(|a| (a / angle - 1.0).abs() < 1e-5),
        "{start}, {angle}"
    );
    let at = |column: &str| outcome.at(column, 1.0);
    let about = at("moment.cam.y") - 9.0 * at("force.cam.z");
    assert!((about + 60.0).abs() < 1e-6, "{about}");
    assert!(at("rotation.cam.y") < -30.0);
}

fn refused(scene: &Value) -> (String, String) {
    let loaded = covact::scene::parse(&scene.to_string(), "scene.json").unwrap();
    if let Some(problem) = covact::scene::check(&loaded).into_iter().next() {
        return (problem.pointer, problem.message);
    }
    let error = covact::model::build::build(&loaded).expect_err("refused");
    assert!(error.help.is_some(), "{error}");
    (error.pointer.clone(), error.to_string())
}

#[test]
fn what_cannot_be_driven_is_refused_by_name() {
    let ball = |motion: Value| {
        let mut scene = plate(4);
        scene["surfaces"]["ball"]["sphere"]["center"] = json!([0, 0, 30]);
        scene["surfaces"]["ball"]["motion"] = motion;
        scene
    };
    let at = |field: &str| format!("/surfaces/ball/motion/free{field}");
    for (motion, pointer, part) in [
        (
            json!({ "free": {} }),
            at(""),
            "no component of the motion is free",
        ),
        (
            json!({ "translation": [0, 0, "-t"], "free": { "force": { "z": -5 } } }),
            at("/force/z"),
            "the translation along z is both prescribed over time and free",
        ),
        (
            json!({
                "rotation": { "axis": [0, 1, 1], "angle": "5*t" },
                "free": { "force": { "z": -5 }, "moment": { "y": 0 } }
            }),
            at("/moment/y"),
            "the rotation about y is both prescribed over time and free",
        ),
        (
            json!({ "free": { "force": { "z": 5 } } }),
            at(""),
            "no slave point lies in its way along z",
        ),
        (
            json!({ "free": { "force": { "z": { "table": [[0, 0], [1, 0]] } } } }),
            at(""),
            "the force is zero at all times",
        ),
    ] {
        let (found, message) = refused(&ball(motion));
        assert!(
            found == pointer && message.contains(part),
            "{found}: {message}"
        );
    }
    let mut alone = ball(json!({ "free": { "force": { "z": -5 } } }));
    alone["contacts"] = json!({});
    let (found, message) = refused(&alone);
    assert!(
        found == at("") && message.contains("takes part in no contact"),
        "{message}"
    );
    // A constant translation only says where the surface starts, and the way to the first touch is told.
    let placed = ball(json!({ "translation": [0, 0, 1], "free": { "force": { "z": -5 } } }));
    let loaded = covact::scene::parse(&placed.to_string(), "scene.json").unwrap();
    let model = covact::model::build::build(&loaded).unwrap();
    let (_, _, driven) = model.driven().next().unwrap();
    // Gauss points of the first element lie beside the apex: 25 - sqrt(25^2 - r^2) above it, r = 12.5 (1 - 1/sqrt 3) / 2 * sqrt 2.
    let r = 12.5 * (1.0 - 1.0 / 3f64.sqrt()) / 2.0 * 2f64.sqrt();
    let way = 30.0 + 1.0 - 25.0 - 1.0 + 25.0 - (625.0 - r * r).sqrt();
    assert!(
        (driven.start[2] + way).abs() < 1e-9,
        "{} {way}",
        driven.start[2]
    );
    let note = model.notes.iter().find(|n| n.contains("until it touches"));
    assert!(
        note.is_some_and(|n| n.contains("surface `ball`: moved by (0, 0, -5.")),
        "{note:?}"
    );
}
