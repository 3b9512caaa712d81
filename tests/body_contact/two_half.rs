//! Two half passes: each side is the slave once.
use crate::blocks::{done, exact, patch, pressures};
use crate::convergence::{C, FLOOR, endings};
use crate::shells::arch_on_plate;
use crate::support::solve;
use covact::solve::event::Event;
use serde_json::{Value, json};

/// Each side integrates its own shape functions, so that no kink lies within a face: few points suffice on meshes that do
/// not match (Sauer and De Lorenzis (2013)).
#[test]
fn two_half_passes_pass_the_patch_test() {
    let p = exact();
    for [upper, lower] in [["h8", "h8"], ["h8", "q18"], ["q18", "q18"]] {
        let mut scene = patch(3, 2, json!({"gauss": 3}));
        scene["contacts"]["press"]["passes"] = json!("two_half");
        scene["bodies"]["upper"]["element"] = json!(upper);
        scene["bodies"]["lower"]["element"] = json!(lower);
        scene["solution"]["newton"]["tolerance"] = json!(1e-12);
        let outcome = done(&scene);
        for body in ["upper", "lower"] {
            let [low, high] = pressures(&outcome, body);
            println!("{upper} on {lower}, {body}: {low} {high} {p}");
            assert!((high - p).max(p - low) < 1e-10 * p, "{low} {high} {p}");
        }
        assert!(outcome.column("imbalance.force.press")[0] < 1e-10 * p);
    }
}

/// The imbalance of two curved sides falls as they are refined.
#[test]
fn the_imbalance_falls_with_refinement() {
    let share = |factor: u32| {
        let mut scene = arch_on_plate(1.5, 3, json!({"gauss": 5}));
        scene["contacts"]["press"]["passes"] = json!("two_half");
        for (_, body) in scene["bodies"].as_object_mut().expect("bodies") {
            for (_, mesh) in body["mesh"].as_object_mut().expect("mesh") {
                for n in mesh["elements"].as_array_mut().expect("elements") {
                    *n = json!(n.as_u64().expect("number") * u64::from(factor));
                }
            }
        }
        let outcome = done(&scene);
        let last = |name: &str| *outcome.column(name).last().expect("steps");
        let force = last("slave.force.press.z").abs();
        let share = last("imbalance.force.press") / force;
        println!("{factor}: force {force:.6e}, imbalance {share:.3e}");
        assert!(force > 0.0);
        share
    };
    let shares = [1, 2].map(share);
    assert!(shares[0] > 1e-9, "{shares:?}");
    assert!(shares[1] < 0.6 * shares[0], "{shares:?}");
}

/// Slave and master exchanged are the same equations.
#[test]
fn exchanged_roles_give_the_same_result() {
    let values = |exchange: bool| {
        let mut scene = arch_on_plate(1.5, 3, json!({"gauss": 2}));
        let press = &mut scene["contacts"]["press"];
        press["passes"] = json!("two_half");
        if exchange {
            let (slave, master) = (press["slave"].take(), press["master"].take());
            press["slave"] = master;
            press["master"] = slave;
        }
        scene["solution"]["newton"]["tolerance"] = json!(1e-12);
        let outcome = done(&scene);
        let sides = if exchange {
            ["master", "slave"]
        } else {
            ["slave", "master"]
        };
        let mut names = sides.map(|s| format!("{s}.force.press.z")).to_vec();
        names.extend(["energy.internal", "energy.contact", "points.active"].map(String::from));
        names
            .iter()
            .map(|n| *outcome.column(n).last().expect("steps"))
            .collect::<Vec<f64>>()
    };
    let (a, b) = (values(false), values(true));
    println!("{a:?}\n{b:?}");
    for (a, b) in a.iter().zip(&b) {
        assert!(*a != 0.0 && (a - b).abs() < 1e-10 * a.abs(), "{a} {b}");
    }
}

/// A tangent that lacked something would converge linearly.
#[test]
fn residuals_fall_quadratically_in_two_half_passes() {
    let mut scene = arch_on_plate(1.5, 5, json!({"gauss": 2}));
    scene["contacts"]["press"]["passes"] = json!("two_half");
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "done");
    let mut good = 0u32;
    for e in endings(&outcome) {
        println!("{e:?}");
        // A foot that passes from facet to facet spoils one pair of residuals, and the next falls again as it should.
        let mut spoilt = false;
        for pair in e.windows(2) {
            let bound = (C * pair[0] * pair[0]).max(FLOOR);
            if bound < 0.1 * pair[0] {
                let falls = pair[1] <= bound;
                assert!(falls || !spoilt, "{e:?}");
                good += u32::from(falls);
                spoilt = !falls;
            }
        }
        assert!(!spoilt, "{e:?}");
    }
    assert!(good >= 2, "{good}");
}

/// A smooth surface is not the faces that it smooths, and each pass sees one side smooth: told before anything is solved.
#[test]
fn smooth_surfaces_in_two_half_passes_draw_a_warning() {
    let warnings = |surface: &str| {
        let mut scene = arch_on_plate(1.5, 5, json!({"gauss": 2}));
        scene["contacts"]["press"]["passes"] = json!("two_half");
        scene["contacts"]["press"]["master_surface"] = json!(surface);
        let loaded = covact::scene::parse(&scene.to_string(), "scene.json").expect("a scene");
        let model = covact::model::build::build(&loaded).expect("a model");
        (model.warnings.iter())
            .filter(|w| w.contains("`press`") && w.contains("sagitta"))
            .count()
    };
    assert_eq!([warnings("faces"), warnings("smooth")], [0, 1]);
}

/// An arch above a coarse plate, touched lightly: slave points of the arch are in contact along its lowest line, those of the
/// plate lie too far from it.
fn lightly_touched(push: Value) -> Value {
    let mut scene = arch_on_plate(0.02, 8, json!({"gauss": 2}));
    scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = json!([3, 2]);
    scene["contacts"]["press"]["passes"] = json!("two_half");
    scene["supports"]["push"]["displacement"]["z"] = push;
    scene
}

/// A contact of two passes touches where either of them does.
#[test]
fn one_pass_in_contact_is_contact() {
    let outcome = solve(&lightly_touched(json!("-0.02*t")));
    assert_eq!(outcome.summary.reason, None);
    assert_eq!(outcome.summary.status.name(), "done");
    let last = |name: &str| *outcome.column(name).last().expect("steps");
    // The pass of the plate has no point in contact: it does not push back.
    let (slave, master) = (last("slave.force.press.z"), last("master.force.press.z"));
    println!("{slave} {master}");
    assert!(slave > 0.0 && master == 0.0, "{slave} {master}");
    // Where neither touches, that is said once.
    let outcome = solve(&lightly_touched(json!("-0.001*t")));
    assert_eq!(outcome.summary.status.name(), "no_contact");
    let reason = outcome.summary.reason.expect("a reason");
    assert!(reason.contains("contact `press` never touched"), "{reason}");
}

/// Contact is lost where neither pass touches any more, and that is said once.
#[test]
fn contact_that_both_passes_have_lost_is_told_once() {
    let push = json!({"table": [[0, 0], [0.5, -0.02], [1, 0]]});
    let outcome = solve(&lightly_touched(push));
    assert_eq!(outcome.summary.status.name(), "done");
    let force = |t: f64| outcome.at("slave.force.press.z", t);
    assert!(force(0.5) > 0.0 && force(1.0) == 0.0);
    let words = "contact `press` opened at step";
    let told = |e: &&Event| matches!(e, Event::Note { text } if text.contains(words));
    assert_eq!(outcome.events.iter().filter(told).count(), 1);
}

/// Two coarse half tubes, crown to crown, meet at few points, and each pass finds another force: that is told, at the step
/// where it is most. One pass has the same force on both sides, and nothing to tell.
#[test]
fn passes_that_do_not_balance_are_told() {
    let pressed = |passes: &str| {
        let panel = |radius: f64, angles: [f64; 2], elements: u32, z: f64| {
            json!({
                "mesh": { "cylinder_panel": {
                    "radius": radius, "thickness": 1.5, "angles": angles, "y": [0, 1], "elements": [elements, 1],
                    "origin": [0, 0, z]
                } },
                "material": "rubber"
            })
        };
        let moved = |on: &str| json!({ "on": on, "displacement": { "x": 0, "y": 0, "z": "-3*t" } });
        let plane = |on: &str| json!({ "on": on, "symmetry": "y" });
        done(&json!({
            "covact": 1,
            "materials": { "rubber": { "neo_hooke": { "E": 5, "nu": 0.3 } } },
            "bodies": {
                "upper": panel(8.0, [90.0, 270.0], 10, 18.6), "lower": panel(9.0, [-90.0, 90.0], 9, 0.0)
            },
            "contacts": { "crowns": {
                "slave": "upper.outer", "master": "lower.outer", "passes": passes, "points": { "gauss": 2 }
            } },
            "supports": {
                "left": { "on": "lower.phi_min", "fixed": true }, "right": { "on": "lower.phi_max", "fixed": true },
                "down_left": moved("upper.phi_min"), "down_right": moved("upper.phi_max"),
                "a": plane("upper.y_min"), "b": plane("upper.y_max"), "c": plane("lower.y_min"), "d": plane("lower.y_max")
            },
            "output": { "every": 0 }
        }))
    };
    let told = |outcome: &crate::support::Outcome| -> Vec<String> {
        let all = outcome.summary.warnings.iter();
        all.filter(|w| w.contains("two half passes differ"))
            .cloned()
            .collect()
    };
    let halves = pressed("two_half");
    let imbalance = halves.column("imbalance.force.crowns");
    let worst = (0..imbalance.len())
        .max_by(|a, b| imbalance[*a].total_cmp(&imbalance[*b]))
        .expect("steps");
    println!("{imbalance:?}");
    let warnings = told(&halves);
    assert!(
        imbalance[worst] > 0.05 && warnings.len() == 1,
        "{warnings:?}"
    );
    let step = format!("at step {} ", halves.column("step")[worst]);
    assert!(warnings[0].contains(&step), "{step}: {warnings:?}");
    assert_eq!(told(&pressed("one")), Vec::<String>::new());
}
