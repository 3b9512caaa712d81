//! Viscous stabilisation: its tangent, its scale, what it costs where it is off. What it does to bodies that only contact
//! holds and to structures that snap is in the group `instability` of the gauntlet.
use crate::support::solve;
use covact::assembly::Assembler;
use covact::model::Model;
use covact::model::build::build;
use covact::model::state::State;
use covact::output::RunStatus;
use covact::scene::parse;
use serde_json::{Value, json};

/// A block of `size` held by one face, E = 100, without contact.
fn block(size: [f64; 3], stabilization: Value) -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
        "bodies": {"block": {
            "mesh": {"block": {"min": [0, 0, 0], "max": size, "elements": [2, 3, 2]}}, "material": "m"
        }},
        "supports": {"held": {"on": "block.x_min", "fixed": true}},
        "loads": {"pull": {"on": "block.x_max", "force": ["3*t", "t", 0]}},
        "solution": {"end_time": 2, "step": {"initial": 0.5, "max": 0.5}, "stabilization": stabilization, "threads": 1},
        "output": {"every": 0}
    })
}

fn model(scene: &Value) -> Model {
    build(&parse(&scene.to_string(), "scene.json").expect("a scene")).expect("a model")
}

/// The residual gains `c m (u - base) / dt` and the tangent its derivative: to rounding, and nothing else changes.
#[test]
fn force_and_tangent_are_those_of_the_formula() {
    let size = [2.0, 1.0, 0.5];
    let (factor, end, dt) = (0.02, 2.0, 0.25);
    let plain = model(&block(size, json!("none")));
    assert!(plain.stabilization.is_none());
    let helped = model(&block(size, json!({"viscous": {"factor": factor}})));
    let own = helped.stabilization.as_ref().expect("stabilisation");
    // Second moments of the nodal volumes about the longest axis: 0, 1, 2 with 1/4, 1/2, 1/4.
    let length = (12.0f64 * 0.5).sqrt();
    let thickness = 2.0 * (2.0 * 1.0 * 0.5) / (2.0 * (2.0 * 1.0 + 1.0 * 0.5 + 2.0 * 0.5));
    let c = factor * end * 100.0 * (thickness / length).powi(2) / length.powi(2);
    assert!(
        (own.coefficient / c - 1.0).abs() < 1e-12,
        "{} {c}",
        own.coefficient
    );

    let linearize = |model: &Model, way: f64| {
        let mut assembler = Assembler::new(model, &model.dofs).expect("a pattern");
        let mut state = State::new(model);
        assembler.begin_step(&state.u, 0.5, 0.5 + dt);
        for (i, u) in state.u.iter_mut().enumerate() {
            *u = way * (1e-3 * i as f64).sin();
        }
        for dof in model.dofs.removed() {
            state.u[dof as usize] = 0.0;
        }
        let n = state.u.len();
        let (mut residual, mut rhs) = (vec![0.0; n], vec![0.0; n]);
        (assembler.linearize(&mut state, 0.75, None, &mut residual, &mut rhs))
            .expect("an evaluation");
        let drag = assembler.drag(&state.u, &residual);
        (state.u, residual, assembler.matrix().clone(), drag)
    };
    let (u, r0, k0, none) = linearize(&plain, 0.1);
    let (_, r1, k1, drag) = linearize(&helped, 0.1);
    assert_eq!(none, covact::assembly::Drag::default());
    let (mut volume, mut work) = (0.0, 0.0);
    for dof in 0..u.len() {
        let w = own.weights[dof];
        volume += w / c;
        work += w * u[dof] * u[dof] / dt;
        let free = !helped.dofs.removed().any(|d| d as usize == dof);
        assert_eq!(w > 0.0, free);
        let force = w * u[dof] / dt;
        assert!((r1[dof] - r0[dof] - force).abs() < 1e-12, "{dof}");
        if free {
            let gained = k1.get(dof, dof) - k0.get(dof, dof);
            assert!((gained - w / dt).abs() < 1e-12 * k0.get(dof, dof), "{dof}");
            for other in (0..dof).filter(|o| o / 3 == dof / 3) {
                assert_eq!(k1.get(dof, other), k0.get(dof, other));
            }
        }
    }
    // The nodes of the face that is held have a quarter of the volume.
    assert!((volume / (3.0 * 0.75) - 1.0).abs() < 1e-12, "{volume}");
    assert!(work > 0.0 && (drag.work / work - 1.0).abs() < 1e-12);
    assert!(drag.share > 0.0);
}

/// Lengths times 1000, modulus times 1e-3, the time of the run times 7: the same part of the forces.
#[test]
fn scales_with_the_units() {
    let run = |length: f64, modulus: f64, time: f64| {
        let scale = |x: f64| x * length;
        let mut scene = block([2.0, 1.0, 0.5].map(scale), json!({"viscous": {}}));
        scene["materials"]["m"]["neo_hooke"]["E"] = json!(100.0 * modulus);
        let force = modulus * length * length;
        scene["loads"]["pull"]["force"] = json!([
            format!("3*{force}*t/{time}"),
            format!("{force}*t/{time}"),
            0
        ]);
        scene["solution"]["end_time"] = json!(2.0 * time);
        scene["solution"]["step"] = json!({"initial": 0.5 * time, "max": 0.5 * time});
        scene["solution"]["newton"] = json!({"tolerance": 1e-11});
        solve(&scene)
    };
    let (a, b) = (run(1.0, 1.0, 1.0), run(1e3, 1e-3, 7.0));
    let energy = 1e-3 * 1e9;
    for (name, unit) in [
        ("energy.stabilization", energy),
        ("stabilization.share", 1.0),
        ("energy.internal", energy),
    ] {
        let (a, b) = (a.column(name), b.column(name));
        assert_eq!(a.len(), 4);
        for (a, b) in a.iter().zip(&b) {
            assert!(
                *a > 0.0 && (b / unit / a - 1.0).abs() < 1e-7,
                "{name}: {a} {b}"
            );
        }
    }
    // What it takes from a body that is only loaded is far below what is stored, and nothing is told.
    let part = a.column("energy.stabilization")[3] / a.column("energy.internal")[3];
    println!("dissipated: {part:.1e} of the strain energy");
    assert!(part < 0.01, "{part}");
    assert_eq!(a.summary.warnings, Vec::<String>::new());
    assert!(
        a.summary
            .effects
            .iter()
            .any(|e| e == "stabilization.viscous")
    );
}

/// After `until` the run is that without: the state forgets what held it.
#[test]
fn until_ends_it() {
    let limited = solve(&block(
        [2.0, 1.0, 0.5],
        json!({"viscous": {"factor": 0.1, "until": 0.7}}),
    ));
    let plain = solve(&block([2.0, 1.0, 0.5], json!("none")));
    assert!(
        limited
            .column("time")
            .iter()
            .any(|t| (t - 0.7).abs() < 1e-12)
    );
    let share = limited.column("stabilization.share");
    for (t, s) in limited.column("time").iter().zip(&share) {
        assert_eq!(*s > 0.0, *t < 0.7 + 1e-9, "{t} {s}");
    }
    let (a, b) = (
        limited.at("energy.internal", 2.0),
        plain.at("energy.internal", 2.0),
    );
    assert!((a / b - 1.0).abs() < 1e-7, "{a} {b}");
    assert!(plain.history.column("energy.stabilization").is_none());
}

/// A block pressed on a floor and pushed along slides under mu N to within a thousandth, whether a support or a wall pushes it:
/// what holds it from drifting off takes nothing away from the force that is asked for.
#[test]
fn a_block_that_is_pushed_feels_its_friction_only() {
    let (mu, pressure) = (0.1, 2.0);
    let push = json!({"table": [[0, 0], [1, 0], [2, 0.5]]});
    let mut scene = json!({
        "covact": 1,
        "materials": {"alu": {"st_venant_kirchhoff": {"E": 70000, "nu": 0.33}}},
        "bodies": {"block": {
            "mesh": {"block": {"min": [0, 0, 0], "max": [8, 6, 5], "elements": [3, 2, 2]}}, "material": "alu"
        }},
        "surfaces": {"floor": {"plane": {"center": [4, 3, 0], "size": [40, 40]}}},
        "contacts": {"rests": {"slave": "block.bottom", "master": "floor", "friction": mu}},
        "loads": {"press": {"on": "block.top", "pressure": {"table": [[0, 0], [1, pressure]]}}},
        "solution": {"end_time": 2},
        "output": {"every": 0}
    });
    let friction = mu * pressure * 48.0;
    let mut held = scene.clone();
    held["supports"] = json!({"push": {"on": "block.x_min", "displacement": {"x": push}}});
    scene["surfaces"]["wall"] = json!({
        "plane": {"center": [0, 3, 2.5], "size": [4, 3], "normal": [1, 0, 0]},
        "motion": {"translation": [push, 0, 0]}
    });
    scene["contacts"]["push"] = json!({"slave": "block.x_min", "master": "wall"});
    for (scene, pushes) in [(held, "force.push.x"), (scene, "force.wall.x")] {
        let outcome = solve(&scene);
        assert_eq!(outcome.summary.status, RunStatus::Done);
        let told = &outcome.summary.warnings;
        assert!(!told.iter().any(|w| w.contains("rests on")), "{told:?}");
        for time in [1.5, 2.0] {
            let [pushes, floor] =
                [pushes, "force.floor.x"].map(|name| outcome.at(name, time).abs());
            println!("{pushes} {floor} {friction}");
            assert!((floor / friction - 1.0).abs() < 1e-4);
            assert!((pushes / friction - 1.0).abs() < 1e-3);
        }
    }
}

/// A plate that only two planes hold is pressed by one of them and let go again. In the end nothing is stored, by which what was dissipated
/// while it began could be measured, and hardly a force is left that could rest on anything.
#[test]
fn what_is_let_go_again_does_not_rest_on_it() {
    let plane = |z: f64, normal: f64, way: f64, end: f64| {
        json!({
            "plane": { "center": [0, 0, z], "normal": [0, 0, normal], "size": [60, 60] },
            "motion": { "translation": [0, 0, { "table": [[0, 0], [1, way], [2, end]] }] }
        })
    };
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
        "bodies": { "plate": {
            "mesh": { "plate": { "size": [10, 10], "thickness": 1, "elements": [4, 4], "origin": [0, 0, 0.5] } },
            "material": "m"
        } },
        "surfaces": { "lower": plane(0.0, 1.0, 0.0, 0.0), "upper": plane(1.0, -1.0, -0.02, 0.1) },
        "contacts": {
            "below": { "slave": "plate.bottom", "master": "lower" },
            "above": { "slave": "plate.top", "master": "upper" }
        },
        "supports": {
            "x": { "on": "plate.x_min", "symmetry": "x" },
            "y": { "on": "plate.y_min", "symmetry": "y" }
        },
        "solution": { "end_time": 2 },
        "output": { "every": 0 }
    });
    let outcome = solve(&scene);
    let s = &outcome.summary;
    assert_eq!(s.status, RunStatus::Done, "{:?}", s.reason);
    // It was at work.
    let dissipated = outcome.at("energy.stabilization", 2.0);
    assert!(dissipated > 0.0, "{dissipated}");
    assert!(outcome.at("energy.internal", 2.0) < 0.1 * dissipated);
    assert!(s.warnings.is_empty(), "{:?}", s.warnings);
}

/// A strip on a roller bent by a force as it yields: what the nose presses with arrives at the roller. The symmetry plane carries
/// the bending moment by forces to and fro that are far larger, beside which the stabilisation once looked like nothing while it took
/// 2 % of the force, and so 9 % of the deflection.
#[test]
fn a_strip_that_is_bent_by_a_force_passes_on_all_of_it() {
    let scene = json!({
        "covact": 1,
        "units": { "length": "mm", "force": "N" },
        "materials": { "steel": { "j2": {
            "E": 206e3, "nu": 0.3, "hardening": { "swift": { "strength": 565, "offset": 0.0071, "exponent": 0.26 } }
        } } },
        "bodies": { "strip": {
            "mesh": { "plate": { "size": [60, 10], "thickness": 2, "elements": [24, 1] } }, "material": "steel"
        } },
        "surfaces": {
            "nose": {
                "cylinder": { "radius": 8, "length": 40, "center": [0, 5, 9.01], "axis": [0, 1, 0] }, "side": "outward",
                "motion": { "free": { "force": { "z": "-42*t" } } }
            },
            "roller": {
                "cylinder": { "radius": 8, "length": 40, "center": [50, 5, -9.01], "axis": [0, 1, 0] }, "side": "outward"
            }
        },
        "contacts": {
            "a": { "slave": "strip.top", "master": "nose" },
            "b": { "slave": "strip.bottom", "master": "roller" }
        },
        "supports": {
            "x": { "on": "strip.x_min", "symmetry": "x" },
            "y": { "on": "strip.y_min", "symmetry": "y" }
        },
        "output": { "every": 0 }
    });
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status, RunStatus::Done);
    let [nose, roller] = ["force.nose.z", "force.roller.z"].map(|name| outcome.at(name, 1.0).abs());
    println!("{nose} {roller}");
    assert!((nose / 42.0 - 1.0).abs() < 1e-6);
    assert!((roller / 42.0 - 1.0).abs() < 1e-3);
}
