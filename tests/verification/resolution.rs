//! Where the geometry of tool and mesh decides about a force, it is told with numbers: sharp edges between slave points,
//! facets beside an interference fit, few points under a force, the side that a tube is shrunk onto.
use crate::support::{Outcome, scene_json, solve, stl_box};
use covact::model::{Model, build::build};
use covact::solve::event::Event;
use serde_json::{Value, json};

fn run(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    assert!(outcome.summary.reason.is_none(), "{:?}", outcome.summary);
    outcome
}

fn model(scene: &Value) -> Model {
    let loaded = covact::scene::parse(&scene.to_string(), "scene.json").expect("a scene");
    build(&loaded).expect("a model")
}

fn told<'a>(all: &'a [String], words: &str) -> Vec<&'a String> {
    all.iter().filter(|w| w.contains(words)).collect()
}

/// A strip that is bent down over the edge x = 0 of a box, with `n` elements along it.
fn over_an_edge(n: u32, down: f64) -> Value {
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
        "bodies": { "strip": {
            "mesh": { "plate": {
                "size": [20, 1], "thickness": 0.5, "elements": [n, 1], "origin": [-10, 0, 0.26]
            } },
            "material": "m"
        } },
        "surfaces": { "box": { "cad": { "file": "box.stl" } } },
        "contacts": { "c": { "slave": "strip.bottom", "master": "box" } },
        "supports": {
            "clamp": { "on": "strip.x_min", "fixed": true },
            "width": { "on": "strip.y_min", "symmetry": "y" },
            "width2": { "on": "strip.y_max", "symmetry": "y" },
            "end": { "on": "strip.x_max", "mid_surface": true, "displacement": { "z": format!("-{down}*t") } }
        },
        "solution": { "step": { "initial": 0.1, "max": 0.1 } },
        "output": { "every": 0 }
    })
}

fn run_beside_box(scene: &Value) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let text = stl_box([-12.0, -2.0, -10.0], [0.3, 3.0, 0.0]);
    std::fs::write(folder.path().join("box.stl"), text).unwrap();
    let outcome = crate::support::solve_in(scene, folder.path());
    assert!(outcome.summary.reason.is_none(), "{:?}", outcome.summary);
    outcome
}

#[test]
fn a_sharp_edge_between_slave_points_is_warned_of() {
    let alone = |n| {
        let mut scene = over_an_edge(n, 4.0);
        scene["contacts"]["c"]["passes"] = json!("one");
        run_beside_box(&scene)
    };
    let outcomes = [21, 42].map(alone);
    let [coarse, fine] = outcomes.each_ref().map(|o| o.at("force.box.z", 1.0));
    // What the warning says: the force is that of the mesh.
    assert!((coarse / fine - 1.0).abs() > 0.01, "{coarse} {fine}");
    for outcome in &outcomes {
        let told = told(
            &outcome.summary.warnings,
            "sharp convex edges or tips of surface `box`",
        );
        assert_eq!(told.len(), 1, "{:?}", outcome.summary.warnings);
        let share = outcome.summary.accuracy.contacts[0].edge_share;
        assert!(share > 0.5, "{share}");
        assert!(told[0].contains(&format!("{:.0} % of its force", 100.0 * share)));
    }
}

/// With the edges as slaves, which they become by themselves, the force is hardly that of the mesh.
#[test]
fn a_sharp_edge_between_slave_points_becomes_a_slave() {
    let outcomes = [21, 42].map(|n| run_beside_box(&over_an_edge(n, 4.0)));
    let [coarse, fine] = outcomes.each_ref().map(|o| o.at("force.box.z", 1.0));
    assert!(
        fine > 0.1 && (coarse / fine - 1.0).abs() < 2e-3,
        "{coarse} {fine}"
    );
    for outcome in &outcomes {
        let noted = outcome.events.iter().any(|e| match e {
            Event::Model { notes, .. } => notes
                .iter()
                .any(|n| n.contains("with such edges as slaves")),
            _ => false,
        });
        assert!(noted);
    }
}

/// A block that lies on the middle of the same box, off its edges.
#[test]
fn edges_away_from_the_contact_are_noted_and_not_warned_of() {
    let mut scene = over_an_edge(20, 0.0);
    scene["bodies"]["strip"]["mesh"] = json!({ "block": {
        "min": [-8, 0, 0], "max": [-6, 1, 1], "elements": [4, 2, 2]
    } });
    scene["supports"] = json!({
        "down": { "on": "strip.top", "displacement": { "x": 0, "y": 0, "z": "-0.01*t" } }
    });
    let outcome = run_beside_box(&scene);
    assert!(told(&outcome.summary.warnings, "sharp").is_empty());
    assert_eq!(outcome.summary.accuracy.contacts[0].edge_share, 0.0);
    let noted = outcome.events.iter().any(|e| match e {
        Event::Model { notes, .. } => {
            told(notes, "sharp convex edge(s), of up to 90 degrees").len() == 1
        }
        _ => false,
    });
    assert!(noted);
}

/// A tube of outer radius 10.01 in one of inner radius 10, both a wall of 1 thick, held to plane strain; `n` and `m` elements
/// over a quarter.
fn fit([n, m]: [u32; 2], points: Value) -> Value {
    let tube = |radius: f64, elements: u32| {
        json!({
            "mesh": { "cylinder_panel": {
                "radius": radius, "thickness": 1, "angles": [0, 90], "y": [0, 1], "elements": [elements, 1]
            } },
            "material": "m"
        })
    };
    let mut supports = serde_json::Map::new();
    for body in ["inner", "outer"] {
        for (set, axis) in [
            ("phi_min", "x"),
            ("phi_max", "z"),
            ("y_min", "y"),
            ("y_max", "y"),
        ] {
            let support = json!({ "on": format!("{body}.{set}"), "symmetry": axis });
            supports.insert(format!("{body}_{set}"), support);
        }
    }
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
        "bodies": { "inner": tube(9.51, n), "outer": tube(10.5, m) },
        "contacts": { "fit": {
            "slave": "inner.outer", "master": "outer.inner", "points": points,
            "initial_overclosure": { "shrink": { "until": 1 } }
        } },
        "supports": supports,
        "solution": { "step": { "initial": 1, "max": 1 } },
        "output": { "every": 0 }
    })
}

/// Mean pressure of the fit: the force of a quarter on the plane x = 0 by its area.
fn pressure(outcome: &Outcome) -> f64 {
    outcome.at("slave.force.fit.x", 1.0).abs() / 10.0
}

#[test]
fn facets_that_change_an_interference_are_told_by_how_much() {
    // Faces that match node by node are exact but for the elements.
    let matching = run(&fit([24, 24], json!("nodes")));
    assert!(told(&matching.summary.warnings, "flat facets").is_empty());
    let right = pressure(&matching);
    for (elements, points) in [
        ([12, 8], json!("nodes")),
        ([24, 16], json!("nodes")),
        ([48, 32], json!("nodes")),
        ([12, 12], json!({ "gauss": 2 })),
    ] {
        let outcome = run(&fit(elements, points));
        let off = pressure(&outcome) / right - 1.0;
        let told = told(&outcome.summary.warnings, "flat facets");
        let expected = off.abs() > 0.01;
        assert_eq!(
            told.len(),
            usize::from(expected),
            "{elements:?} {off}: {told:?}"
        );
        if !expected {
            continue;
        }
        let text = told[0].split("wrong by about ").nth(1);
        match text {
            None => assert!(off > 0.3, "{off}: {}", told[0]),
            Some(text) => {
                let number = text.split(' ').next().and_then(|n| n.parse::<f64>().ok());
                let found = number.expect("a number") / 100.0;
                assert!(
                    found / off > 1.0 / 3.0 && found / off < 3.0,
                    "{found} {off}: {}",
                    told[0]
                );
            }
        }
    }
}

/// A tube shrunk onto a rigid pin that is thicker than its bore: with the side left to the program it lies outside of the pin.
#[test]
fn a_tube_shrinks_onto_a_pin_and_check_says_how_it_was_taken() {
    let mut scene = fit([24, 24], json!("nodes"));
    let bodies = scene["bodies"].as_object_mut().unwrap();
    bodies.remove("inner");
    let supports = scene["supports"].as_object_mut().unwrap();
    supports.retain(|name, _| name.starts_with("outer"));
    scene["surfaces"] = json!({ "pin": { "cylinder": { "radius": 10.01, "length": 4 } } });
    scene["contacts"]["fit"]["slave"] = json!("outer.inner");
    scene["contacts"]["fit"]["master"] = json!("pin");
    // Points this near say nothing, and the elements behind them decide; those of a thicker pin contradict them.
    let words = "surface `pin`: the slave points start on one side";
    assert!(told(&model(&scene).notes, words).is_empty());
    let mut thicker = scene.clone();
    thicker["surfaces"]["pin"]["cylinder"]["radius"] = json!(10.1);
    assert_eq!(told(&model(&thicker).notes, words).len(), 1);
    let auto = run(&scene);
    // Lame, plane strain, inner displacement .01 at a = 10, b = 11: p = u E / ((1 + nu) a (1 - 2 nu + (b/a)^2) / ((b/a)^2 - 1)).
    let ratio = 1.21;
    let exact = 0.01 * 1000.0 / (1.3 * 10.0 * (0.4 + ratio) / (ratio - 1.0));
    let found = auto.at("force.pin.x", 1.0).abs() / 10.0;
    assert!((found / exact - 1.0).abs() < 0.02, "{found} {exact}");
    // Said in words it is the same.
    scene["surfaces"]["pin"]["side"] = json!({ "point": [20, 0, 20] });
    let given = run(&scene);
    assert_eq!(given.at("force.pin.x", 1.0), auto.at("force.pin.x", 1.0));
    assert!(told(&self::model(&scene).notes, "start on one side").is_empty());
}

/// A thick hub on a shaft that is .02 too large, twice as much as the facets of its bore lie off the shaft: what is left of the overclosure
/// while it shrinks is not sinking in between nodes, and the nodes bear Lame's pressure.
#[test]
fn an_overclosure_that_shrinks_is_no_sinking_in() {
    let mut scene = fit([16, 16], json!("nodes"));
    scene["bodies"].as_object_mut().unwrap().remove("inner");
    let supports = scene["supports"].as_object_mut().unwrap();
    supports.retain(|name, _| name.starts_with("outer"));
    let mesh = &mut scene["bodies"]["outer"]["mesh"]["cylinder_panel"];
    (mesh["radius"], mesh["thickness"], mesh["layers"]) = (json!(15), json!(10), json!(5));
    scene["surfaces"] =
        json!({ "shaft": { "cylinder": { "radius": 10.02, "length": 4 }, "side": "outward" } });
    let fit = scene["contacts"]["fit"].as_object_mut().unwrap();
    fit.insert("slave".to_owned(), json!("outer.inner"));
    fit.insert("master".to_owned(), json!("shaft"));
    // Left to the default, they could be repeated with others.
    fit.remove("points");
    scene["solution"] = json!({ "step": { "initial": 0.1, "max": 0.1 } });
    let outcome = run(&scene);
    assert!(
        told(&outcome.summary.warnings, "sinks").is_empty(),
        "{:?}",
        outcome.summary.warnings
    );
    assert_eq!(outcome.summary.given_up.runs, 0);
    // Plane strain, inner displacement .02 at a = 10, b = 20.
    let exact = 0.02 * 1000.0 / (1.3 * 10.0 * (0.4 + 4.0) / 3.0);
    let found = outcome.at("force.shaft.x", 1.0).abs() / 10.0;
    println!("{found} of {exact}");
    assert!((found / exact - 1.0).abs() < 0.02, "{found} {exact}");
}

#[test]
fn few_points_under_a_force_are_told() {
    // The plate under a ball: one node touches on a coarse mesh, many Gauss points on a finer one.
    let mut scene = scene_json("ball_on_plate.json");
    scene["output"] = json!({ "every": 0 });
    scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = json!([6, 6]);
    scene["contacts"]["press"]["points"] = json!("nodes");
    let coarse = run(&scene);
    let noted = |outcome: &Outcome| {
        let of = |e: &Event| matches!(e, Event::Note { text } if text.contains("carry 90 % of its force"));
        outcome.events.iter().filter(|e| of(e)).count()
    };
    assert_eq!(noted(&coarse), 1);
    let few = coarse.summary.accuracy.contacts[0].few;
    assert!(few.is_some_and(|few| few < 5), "{few:?}");
    scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = json!([16, 16]);
    scene["contacts"]["press"]["points"] = json!({ "gauss": 4 });
    let fine = run(&scene);
    assert_eq!(noted(&fine), 0);
    assert_eq!(fine.summary.accuracy.contacts[0].few, None);
}

/// A tube whose end is held by its rim: a diaphragm across the axis lets fibres turn (the pinched cylinder comes out the same
/// with `mid_surface`), while what holds both faces along the axis clamps them. What holds all components is meant: it is noted
/// what it is.
#[test]
fn what_a_support_means_for_a_border_is_told() {
    let said = |support: Value| {
        let mut scene = fit([8, 8], json!("nodes"));
        for body in ["inner", "outer"] {
            scene["bodies"][body]["mesh"]["cylinder_panel"]["y"] = json!([0, 40]);
        }
        scene["supports"]["outer_y_max"] = support;
        let model = model(&scene);
        let count = |texts: &[String], text: &str| told(texts, text).len();
        let border = "support `outer_y_max`: along the border of body `outer`";
        let notes: Vec<String> = told(&model.notes, border).into_iter().cloned().collect();
        [
            count(
                &model.warnings,
                "support `outer_y_max`: it holds both faces",
            ),
            notes
                .iter()
                .filter(|n| n.contains("clamped (hinged with"))
                .count(),
            notes.iter().filter(|n| n.ends_with("hinged")).count(),
        ]
    };
    let held = |displacement: Value, mid_surface: bool| {
        said(
            json!({ "on": "outer.y_max", "displacement": displacement, "mid_surface": mid_surface }),
        )
    };
    assert_eq!(held(json!({ "x": 0, "z": 0 }), false), [0, 0, 0]);
    assert_eq!(held(json!({ "y": 0, "z": 0 }), false), [1, 0, 0]);
    assert_eq!(held(json!({ "y": 0, "z": 0 }), true), [0, 0, 0]);
    assert_eq!(held(json!({ "x": 0, "y": 0, "z": 0 }), false), [0, 1, 0]);
    assert_eq!(held(json!({ "x": 0, "y": 0, "z": 0 }), true), [0, 0, 1]);
    assert_eq!(held(json!({ "y": 0 }), false), [0, 0, 0]);
    let fixed = said(json!({ "on": "outer.y_max", "fixed": true }));
    assert_eq!(fixed, [0, 1, 0]);
}

/// A cantilever of steel, 40 x .8, on 20 elements or more, that a roller of radius 5 presses down by 6 at x = 30.2.
fn under_a_roller(elements: u32, points: &Value) -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}}},
        "bodies": {"strip": {"mesh": {"plate": {
            "size": [40, 4], "thickness": 0.8, "elements": [elements, 1], "origin": [0, 0, -0.4]
        }}, "material": "m"}},
        "surfaces": {"nose": {
            "cylinder": {"radius": 5, "length": 20, "center": [30.2, 2, 5.02], "axis": [0, 1, 0]},
            "motion": {"translation": [0, 0, "-6*t"]}
        }},
        "contacts": {"c": {"slave": "strip.top", "master": "nose", "points": points}},
        "supports": {
            "f": {"on": "strip.x_min", "fixed": true},
            "y": {"on": "strip", "plane_strain": "y"}
        },
        "output": {"every": 0}
    })
}

/// Without friction the roller is pushed along by what the strip slopes. A node that slides on it leans aside by up to half of an
/// element over the radius, .2 here, though the roller sinks in by less than a hundredth of what the strip is bent: the run is
/// repeated with 3 x 3 Gauss points, whose distance over the diameter bounds what is left. Nodes that are asked for are warned of.
#[test]
fn a_force_that_leans_aside_on_single_nodes_is_seen() {
    let force = |outcome: &Outcome| {
        ["x", "z"].map(|c| *(outcome.column(&format!("force.nose.{c}")).last()).expect("steps"))
    };
    let fine = force(&run(&under_a_roller(160, &json!({"gauss": 3}))));
    let nodes = run(&under_a_roller(20, &json!("nodes")));
    let default = run(&under_a_roller(20, &json!("auto")));
    let [off, left] = [&nodes, &default].map(|outcome| {
        let own = force(outcome);
        (own[0] - fine[0]).hypot(own[1] - fine[1]) / fine[0].hypot(fine[1])
    });
    let (warnings, notes) = (&nodes.summary.warnings, &default.summary.warnings);
    println!("{fine:?}, nodes off by {off}, by default {left}: {warnings:?} {notes:?}");
    assert!(fine[0] < -6.0 && off > 0.1);
    // Gauss points of faces of 2 are up to .775 apart.
    assert!(left < 0.775 / (2.0 * 5.0), "{left}");
    assert_eq!(
        told(warnings, "of its force act aside").len(),
        1,
        "{warnings:?}"
    );
    assert!(told(notes, "act aside").is_empty(), "{notes:?}");
}

/// A strip bent over a roller by its ends, which go down by 8.
fn ends_down(mid_surface: bool) -> Value {
    json!({
        "covact": 1,
        "materials": {"s": {"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}}},
        "bodies": {"b": {
            "mesh": {"plate": {"size": [50, 10], "thickness": 1, "elements": [25, 1], "origin": [0, 0, 0.5]}}, "material": "s"
        }},
        "surfaces": {"r": {"cylinder": {"radius": 10, "length": 30, "center": [0, 5, -10], "axis": [0, 1, 0]}}},
        "contacts": {"c": {"slave": "b.bottom", "master": "r"}},
        "supports": {
            "e": {"on": "b.x_max", "mid_surface": mid_surface, "displacement": {"z": "-8*t"}},
            "y": {"on": "b.y_min", "symmetry": "y"},
            "m": {"on": "b.x_min", "symmetry": "x"}
        },
        "output": {"every": 0}
    })
}

/// Both faces moved alike through the thickness leave the fibres there no other way than to become longer where they tilt: a strip that
/// should be hinged bears more than twice. It is told; with `mid_surface` the force is that of a beam, `3 E I w / L^3` on each side with
/// what lies on the roller left out, and nothing is said.
#[test]
fn fibres_that_a_support_stretches_are_told() {
    let head = "support `e`: it moves both faces of body `b` alike through the thickness";
    let [held, free] = [false, true].map(|mid| run(&ends_down(mid)));
    let warned = |outcome: &Outcome| told(&outcome.summary.warnings, head).len();
    assert_eq!([warned(&held), warned(&free)], [1, 0]);
    let [held, free] = [held, free].map(|outcome| -outcome.at("force.e.z", 1.0));
    // Half of the strip; it lies on the roller up to where that slopes as a clamp's end would.
    let beam = 3.0 * 210000.0 * (10.0 / 12.0) * 8.0 / 50f64.powi(3);
    println!("{held} {free} {beam}");
    assert!(free / beam > 0.98 && free / beam < 1.1, "{free} {beam}");
    assert!(held > 2.0 * free, "{held} {free}");
}

/// A round surface that is turned about the origin because its centre was not said.
#[test]
fn a_roller_that_goes_round_the_origin_is_noted() {
    let noted = |center: Value| {
        let mut scene = ends_down(true);
        scene["surfaces"]["r"]["motion"] =
            json!({"rotation": {"axis": [0, 1, 0], "angle": "10*t", "center": center}});
        let model = model(&scene);
        let found = told(
            &model.notes,
            "surface `r`: its axis of rotation passes through the origin, 10 away",
        );
        found.len()
    };
    assert_eq!([noted(json!([0, 0, 0])), noted(json!([0, 0, -10]))], [1, 0]);
}
