//! Multipliers beside the penalties: answers that do not depend on the penalty, and nothing left of gaps and elastic slip.
use crate::support::{Outcome, scene_json, set, solve};
use covact::solve::event::Event;
use serde_json::{Value, json};

fn run(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    assert!(outcome.summary.reason.is_none(), "{:?}", outcome.summary);
    outcome
}

/// A block, free sideways, under a rigid plane that is pressed down by `.2 t`. nu = 0, so that the state is one of uniform
/// strain; the penalty gives way by 4 % of the shortening.
fn pressed() -> Value {
    json!({
        "covact": 1,
        "materials": { "foam": { "st_venant_kirchhoff": { "E": 100, "nu": 0 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [2, 2, 4], "elements": [2, 2, 4] } },
            "material": "foam"
        } },
        "surfaces": { "plane": {
            "plane": { "center": [1, 1, 4], "size": [8, 8] },
            "side": { "point": [1, 1, 0] },
            "motion": { "translation": [0, 0, "-0.2*t"] }
        } },
        "contacts": { "press": {
            "slave": "block.top", "master": "plane", "penalty": { "value": 600 },
            "augmentation": { "gap": 1e-7 }
        } },
        "supports": {
            "floor": { "on": "block.bottom", "symmetry": "z" },
            "x": { "on": "block.x_min", "symmetry": "x" },
            "y": { "on": "block.y_min", "symmetry": "y" }
        },
        "solution": {
            "step": { "initial": 0.25, "max": 0.25 }, "newton": { "tolerance": 1e-11 }, "threads": 1
        },
        "output": { "every": 0 }
    })
}

/// Force on the plane when the block is shortened by `d`: stretch `l = 1 - d / 4`, second Piola-Kirchhoff stress
/// `E (l^2 - 1) / 2`, force `l S A`.
fn uniform(d: f64) -> f64 {
    let l = 1.0 - d / 4.0;
    4.0 * l * 100.0 * (1.0 - l * l) / 2.0
}

#[test]
fn no_gap_is_left_under_a_soft_penalty() {
    let outcome = run(&pressed());
    for t in [0.25, 0.5, 0.75, 1.0] {
        let (force, exact) = (outcome.at("force.plane.z", t), -uniform(0.2 * t));
        // A gap of 1e-7 is 5e-7 of the shortening.
        assert!((force / exact - 1.0).abs() < 2e-6, "{t}: {force} {exact}");
        assert!(outcome.at("penetration.max", t) < 1e-7);
        let pressure = outcome.at("pressure.max", t);
        assert!((pressure * 4.0 / -exact - 1.0).abs() < 2e-6, "{pressure}");
    }
    assert!(outcome.column("augmentations").iter().all(|n| *n >= 1.0));
    let plain = {
        let mut scene = pressed();
        scene["contacts"]["press"]["augmentation"] = Value::Null;
        run(&scene)
    };
    let off = plain.at("force.plane.z", 1.0) / -uniform(0.2) - 1.0;
    assert!(off.abs() > 2e-2, "{off}");
    let told = (outcome.events.iter()).filter(|e| matches!(e, Event::Augmented { .. }));
    let times: f64 = outcome.column("augmentations").iter().sum();
    // One for every equilibrium: that of the step, and one after every augmentation.
    assert_eq!(told.count(), 4 + times as usize);
}

#[test]
fn a_body_that_leaves_and_returns_starts_anew() {
    let mut scene = pressed();
    scene["surfaces"]["plane"]["motion"]["translation"][2] =
        json!({ "table": [[0, 0], [1, -0.2], [2, 0.3], [3, -0.2]] });
    scene["solution"]["end_time"] = json!(3);
    scene["solution"]["stops"] = json!([1, 2]);
    let outcome = run(&scene);
    let force = |t: f64| outcome.at("force.plane.z", t);
    assert!((force(1.0) / -uniform(0.2) - 1.0).abs() < 2e-6);
    assert_eq!(force(2.0), 0.0);
    assert!(outcome.at("energy.internal", 2.0) < 1e-20);
    assert!((force(3.0) / force(1.0) - 1.0).abs() < 2e-6);
    let opened = |e: &&Event| matches!(e, Event::Note { text } if text.contains("opened at step"));
    assert_eq!(outcome.events.iter().filter(opened).count(), 1);
}

#[test]
fn what_counts_as_touching_is_augmented_from_there_on() {
    let mut scene = pressed();
    scene["surfaces"]["plane"]["plane"]["center"][2] = json!(3.8);
    scene["contacts"]["press"]["initial_overclosure"] = json!("stress_free");
    let outcome = run(&scene);
    let force = outcome.at("force.plane.z", 1.0);
    assert!((force / -uniform(0.2) - 1.0).abs() < 2e-6, "{force}");
}

#[test]
fn bodies_as_masters_are_augmented_too() {
    // Two blocks of the same stiffness, the upper one pushed down: each is shortened by half.
    let mut scene = pressed();
    scene["bodies"]["upper"] = json!({
        "mesh": { "block": { "min": [-0.5, -0.5, 4], "max": [2.5, 2.5, 8], "elements": [2, 2, 4] } },
        "material": "foam"
    });
    scene["bodies"]["block"]["mesh"]["block"]["elements"] = json!([3, 3, 4]);
    scene["surfaces"] = json!({});
    scene["contacts"]["press"]["master"] = json!("upper.bottom");
    scene["supports"]["tool"] =
        json!({ "on": "upper.top", "displacement": { "x": 0, "y": 0, "z": "-0.2*t" } });
    scene["contacts"]["press"]["points"] = json!({ "gauss": 2 });
    let mut forces = Vec::new();
    for penalty in [300.0, 3000.0, 30_000.0] {
        set(&mut scene, "/contacts/press/penalty/value", penalty);
        let outcome = run(&scene);
        assert!(outcome.at("penetration.max", 1.0) < 1e-7);
        assert!(outcome.at("imbalance.force.press", 1.0) < 1e-9);
        assert!(outcome.at("imbalance.moment.press", 1.0) < 1e-9);
        forces.push(outcome.at("force.tool.z", 1.0));
    }
    println!("{forces:?}");
    for force in &forces {
        assert!(
            (force / forces[2] - 1.0).abs() < 1e-5 && *force < -1.0,
            "{forces:?}"
        );
    }
}

#[test]
fn what_is_not_reached_is_told_and_cuts_the_step() {
    let mut scene = pressed();
    scene["contacts"]["press"]["augmentation"] = json!({ "gap": 1e-9, "max": 1 });
    scene["solution"]["step"]["min"] = json!(0.1);
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "not_converged");
    let reason = outcome.summary.reason.clone().unwrap_or_default();
    assert!(
        reason.contains("contact `press`: after 1 augmentation(s) a gap of")
            && reason.contains("more than 1.000e-9"),
        "{reason}"
    );
}

#[test]
fn a_step_taken_back_takes_its_multipliers_and_penalties_back() {
    // An augmentation leaves some 1/28 of a gap (1 / (1 + eps C), C = 4 / 100 for small strains), so that two of them are too
    // few for the whole way at once: .2 / 28^3 is more than 6.5e-6, half of it is not.
    let steps = |size: f64| {
        let mut scene = pressed();
        scene["contacts"]["press"]["augmentation"] = json!({ "gap": 6.5e-6, "max": 2 });
        scene["solution"]["step"] = json!({ "initial": size, "max": size });
        run(&scene)
    };
    let (whole, halves) = (steps(1.0), steps(0.5));
    assert_eq!((whole.summary.cuts, halves.summary.cuts), (1, 0));
    let cut = (whole.events.iter())
        .position(|e| matches!(e, Event::StepCut { .. }))
        .unwrap();
    let taken = |e: &&Event| {
        matches!(
            e,
            Event::Augmented {
                augmentation: 2,
                ..
            }
        )
    };
    assert_eq!(whole.events[..cut].iter().filter(taken).count(), 1);
    // Nothing is left of what was tried: the run is the one that took the half from the start.
    assert_eq!(whole.column("time"), [0.5, 1.0]);
    for name in [
        "force.plane.z",
        "energy.internal",
        "pressure.max",
        "augmentations",
        "iterations",
    ] {
        assert_eq!(whole.column(name), halves.column(name), "{name}");
        assert!(whole.at(name, 1.0) != 0.0, "{name}");
    }
}

#[test]
fn hertz_is_flat_in_the_penalty() {
    let mut scene = scene_json("hertz_block.json");
    set(
        &mut scene,
        "/bodies/block/mesh/block/elements",
        vec![14, 14, 12],
    );
    for axis in 0..3 {
        let fine = format!("/bodies/block/mesh/block/spacing/{axis}/fine/fine");
        set(&mut scene, &fine, 6);
    }
    scene["contacts"]["press"]["augmentation"] = json!({});
    scene["output"] = json!({ "every": 0 });
    let mut values = Vec::new();
    // The automatic penalty is 20 times the stiffness of an element: from a tenth to the hundredfold of that.
    for scaled in [0.005, 0.05, 0.5, 5.0] {
        scene["contacts"]["press"]["penalty"] = json!({ "scaled": scaled });
        let outcome = run(&scene);
        let force = -4.0 * outcome.at("force.sphere.z", 1.0) / 2.93040 - 1.0;
        let peak = outcome.at("pressure.max", 1.0) / 1.39916 - 1.0;
        println!(
            "{scaled}: F {:.3} %, p0 {:.3} %, augmentations {}, iterations {}",
            100.0 * force,
            100.0 * peak,
            outcome.at("augmentations", 1.0),
            outcome.summary.newton_iterations
        );
        // Points at the border of contact do not chatter.
        assert_eq!(outcome.summary.cuts, 0);
        assert!(outcome.summary.newton_iterations <= 25);
        values.push((force, peak));
    }
    for (force, peak) in &values {
        assert!((force - values[2].0).abs() < 5e-3, "{values:?}");
        assert!((peak - values[2].1).abs() < 5e-3, "{values:?}");
        // Six cells under the contact radius instead of the twelve of the shipped scene.
        assert!(force.abs() < 3e-2 && peak.abs() < 5e-2, "{values:?}");
    }
}

/// NAFEMS CGS-4, as in the friction tests: a block whose top is pushed up an incline of 1 to 10.
fn wedge(mu: f64, augmentation: Value) -> Value {
    let angle = 0.1f64.atan();
    json!({
        "covact": 1,
        "materials": { "elastic": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [-1, 0, 0], "max": [1, 1, 1], "elements": [4, 2, 2] } },
            "element": "h8_displacement",
            "material": "elastic",
            "placement": { "axis": [0, 1, 0], "angle": -angle.to_degrees() }
        } },
        "surfaces": { "incline": {
            "plane": { "center": [0, 0.5, 0], "normal": [-angle.sin(), 0, angle.cos()], "size": [10, 4] }
        } },
        "contacts": { "slide": {
            "slave": "block.bottom", "master": "incline", "friction": { "coulomb": { "mu": mu } },
            "augmentation": augmentation
        } },
        "supports": { "push": { "on": "block.top", "displacement": {
            "x": { "table": [[0, 0], [1, 0], [2, 0.2]] }, "y": 0,
            "z": { "table": [[0, 0], [1, -0.001], [2, 0.019]] }
        } } },
        "solution": {
            "end_time": 2, "step": { "initial": 0.5, "max": 0.5 }, "newton": { "tolerance": 1e-10 }
        },
        "output": { "every": 0 }
    })
}

#[test]
fn nafems_wedge_augmented() {
    for mu in [0.1, 0.2, 0.3] {
        let outcome = run(&wedge(mu, json!({ "gap": 1e-7, "slip": 1e-7 })));
        let ratio = outcome.at("force.push.x", 2.0) / outcome.at("force.incline.z", 2.0);
        let exact = (0.1 + mu) / (1.0 - 0.1 * mu);
        println!(
            "{mu}: {ratio} {exact}, augmentations {:?}",
            outcome.column("augmentations")
        );
        assert_eq!(outcome.at("points.stick", 2.0), 0.0);
        assert!(outcome.column("augmentations").iter().sum::<f64>() > 0.0);
        assert!((ratio / exact - 1.0).abs() < 1e-6, "{mu}: {ratio} {exact}");
    }
}

#[test]
fn points_that_stick_do_not_slip_elastically() {
    // Pressed down and sheared with a coefficient that holds everything: the force is that of a tangential penalty so stiff
    // that nothing gives way, and a soft one is far from it.
    let sheared = |ratio: f64, augmentation: Value| {
        let mut scene = wedge(5.0, augmentation);
        // One that the run chooses would follow what a soft tangential one takes away.
        scene["contacts"]["slide"]["penalty"] = json!({ "scaled": 1 });
        scene["contacts"]["slide"]["tangential_penalty"] = json!({ "scaled": ratio });
        scene["supports"]["push"]["displacement"]["x"] =
            json!({ "table": [[0, 0], [1, 0], [2, 0.0002]] });
        scene["supports"]["push"]["displacement"]["z"] =
            json!({ "table": [[0, 0], [1, -0.01], [2, -0.01]] });
        run(&scene)
    };
    let force = |o: &Outcome| o.at("force.push.x", 2.0) - o.at("force.push.x", 1.0);
    let fine = json!({ "gap": 1e-7, "slip": 1e-7 });
    let soft = sheared(0.01, Value::Null);
    let (held, stiff) = (sheared(0.01, fine.clone()), sheared(1.0, fine));
    println!("{} {} {}", force(&soft), force(&held), force(&stiff));
    assert!(held.at("points.slip", 2.0) == 0.0 && held.at("points.stick", 2.0) > 10.0);
    assert!((force(&held) / force(&stiff) - 1.0).abs() < 2e-3);
    assert!((force(&soft) / force(&stiff) - 1.0).abs() > 5e-2);
    // What the tangential penalties still carry is nothing beside what the soft ones store.
    assert!(held.at("energy.friction", 2.0) < 1e-4 * soft.at("energy.friction", 2.0));
}

#[test]
fn bodies_that_stick_do_not_slip_elastically() {
    // One block pressed on another and sheared along it, with a coefficient that holds everything.
    let sheared = |ratio: f64, augmentation: Value| {
        let mut scene = pressed();
        scene["bodies"]["upper"] = json!({
            "mesh": { "block": { "min": [-0.5, -0.5, 4], "max": [2.5, 2.5, 6], "elements": [3, 3, 2] } },
            "material": "foam"
        });
        scene["bodies"]["block"]["mesh"]["block"]["elements"] = json!([2, 2, 3]);
        scene["surfaces"] = json!({});
        let contact = &mut scene["contacts"]["press"];
        contact["master"] = json!("upper.bottom");
        contact["points"] = json!({ "gauss": 2 });
        contact["penalty"] = json!("auto");
        contact["friction"] = json!({ "coulomb": { "mu": 5 } });
        contact["tangential_penalty"] = json!({ "scaled": ratio });
        contact["augmentation"] = augmentation;
        scene["supports"] = json!({
            "floor": { "on": "block.bottom", "fixed": true },
            "tool": { "on": "upper.top", "displacement": {
                "x": { "table": [[0, 0], [1, 0], [2, 0.02]] }, "y": 0,
                "z": { "table": [[0, 0], [1, -0.2], [2, -0.2]] }
            } }
        });
        scene["solution"]["end_time"] = json!(2);
        scene["solution"]["step"] = json!({ "initial": 0.5, "max": 0.5 });
        scene["solution"]["newton"]["tolerance"] = json!(1e-9);
        run(&scene)
    };
    let force = |o: &Outcome| o.at("force.tool.x", 2.0) - o.at("force.tool.x", 1.0);
    let fine = json!({ "gap": 1e-5, "slip": 1e-5 });
    let soft = sheared(0.05, Value::Null);
    let (held, stiff) = (sheared(0.05, fine.clone()), sheared(1.0, fine));
    println!("{} {} {}", force(&soft), force(&held), force(&stiff));
    println!("{:?}", held.column("augmentations"));
    assert!(held.at("penetration.max", 2.0) <= 1e-5);
    assert!((force(&held) / force(&stiff) - 1.0).abs() < 5e-3);
    assert!((force(&soft) / force(&stiff) - 1.0).abs() > 2e-2);
    for name in ["imbalance.force.press", "imbalance.moment.press"] {
        assert!(held.at(name, 2.0) < 1e-9 * held.at("force.tool.z", 2.0).abs());
    }
}
