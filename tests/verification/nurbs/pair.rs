//! Shells on NURBS patches in contact with each other, both with their thickness.
use super::seams::geometry;
use super::{arc, knots, off};
use crate::support::{Outcome, solve_in};
use covact::assembly::Assembler;
use covact::model::build::build;
use covact::model::state::State;
use covact::scene;
use covact_geometry::{NurbsPatch, Vec3};
use serde_json::{Value, json};

/// `z = z0 + a x^2 + b y^2` over the square [-20, 20]^2.
fn dish(z0: f64, a: f64, b: f64) -> NurbsPatch {
    let points: Vec<Vec3> = (0..9)
        .map(|k| {
            let (i, j) = (k % 3, k / 3);
            let bowl = |i: i32, a: f64| if i == 1 { -400.0 * a } else { 400.0 * a };
            let at = |i: i32| 20.0 * f64::from(i - 1);
            Vec3::new(at(i), at(j), z0 + bowl(i, a) + bowl(j, b))
        })
        .collect();
    NurbsPatch::new([2, 2], [knots(2), knots(2)], [3, 3], &points, None).expect("a patch")
}

/// A part of a torus with its apex at the origin, where the radii of curvature are 80 and 60; 40 wide along x and y, with weights that
/// differ in both directions.
fn vault() -> NurbsPatch {
    let (big, small) = (20.0, 60.0);
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for [c, s, w] in arc(-0.34, 0.34) {
        for [d, t, v] in arc(-0.26, 0.26) {
            let r = big + small * c;
            points.push(Vec3::new(r * t, small * s, r * d - big - small));
            weights.push(w * v);
        }
    }
    NurbsPatch::new(
        [2, 2],
        [knots(2), knots(2)],
        [3, 3],
        &points,
        Some(&weights),
    )
    .expect("a patch")
}

/// A flat sheet over a dome, half of both thicknesses and a gap of .05 apart, whose border goes down by `depth`.
fn scene(lower: Value, contact: Value, depth: f64) -> Value {
    let body = |file: &str, thickness: f64, n: u32| {
        json!({
            "nurbs": {"file": file, "thickness": thickness, "elements": [n, n]}, "material": "m"
        })
    };
    let edges = |of: &str| json!([1, 2, 3, 4].map(|k| format!("{of}.edge.{k}")));
    let mut out = json!({
        "covact": 1,
        "units": {"length": "mm"},
        "materials": {"m": {"st_venant_kirchhoff": {"E": 12000, "nu": 0.3}}},
        "bodies": {"upper": body("upper.json", 1.0, 10)},
        "contacts": {"press": {
            "slave": "upper.bottom", "master": "lower.top", "penalty": {"value": 3000}, "points": {"gauss": 4}
        }},
        "supports": {
            "border": {
                "on": edges("upper"), "displacement": {"x": "1*t", "y": 0, "z": format!("-{depth}*t")}
            }
        },
        "solution": {"step": {"initial": 0.1, "max": 0.1}},
        "output": {"every": 0}
    });
    for (key, value) in contact.as_object().expect("an object") {
        out["contacts"]["press"][key] = value.clone();
    }
    match lower {
        Value::Null => {
            out["surfaces"] = json!({"lower": {"cad": {"file": "lower.json"}}});
            out["contacts"]["press"]["master"] = json!("lower");
        }
        on => {
            out["bodies"]["lower"] = body("lower.json", 1.5, 9);
            out["supports"]["held"] = json!({"on": on, "fixed": true});
        }
    }
    out
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    let write = |name: &str, patch: NurbsPatch| {
        let text = geometry(&[patch]).to_string();
        std::fs::write(folder.path().join(name), text).expect("written");
    };
    write("lower.json", dish(0.0, -0.006, -0.004));
    write("upper.json", dish(1.3, 0.0, 0.0));
    write("vault.json", vault());
    write("bulge.json", dish(1.3, 0.004, 0.003));
    folder
}

fn solve(scene: &Value) -> Outcome {
    solve_in(scene, folder().path())
}

/// Where the lower sheet is held as a whole it is a rigid surface at half of its thickness: the same force as on that surface of the
/// CAD file with an offset, without and with friction.
#[test]
fn a_held_sheet_is_the_rigid_surface() {
    let two = json!({"orthotropic": {"mu": [0.1, 0.3], "direction": [1, 0.8, 0.1]}});
    for friction in [
        json!({}),
        json!({"friction": {"coulomb": {"mu": 0.2}}}),
        json!({"friction": two}),
    ] {
        let held = solve(&scene(json!("lower.top"), friction.clone(), 2.0));
        let mut contact = friction.clone();
        contact["offset"] = json!(0.75);
        let rigid = solve(&scene(Value::Null, contact, 2.0));
        for c in ["x", "y", "z"] {
            let [a, b] = [&held, &rigid].map(|o| o.at(&format!("force.border.{c}"), 1.0));
            println!("{friction} {c}: {a} {b}");
            if c == "z" {
                assert!(a.abs() > 50.0, "{a}");
            }
            let size = held.at("force.border.z", 1.0).abs();
            if c == "y" && friction["friction"]["orthotropic"].is_object() {
                assert!(a.abs() > 1e-2 * size, "{a}");
            }
            assert!((a - b).abs() < 1e-6 * size, "{friction} {c}: {a} {b}");
        }
    }
}

/// Both sheets bend: the forces on both balance, a flexible sheet below takes less force than a held one, and Newton's method takes
/// few iterations, as it does with exact tangents.
#[test]
fn two_sheets_bend() {
    let edges = json!([1, 2, 3, 4].map(|k| format!("lower.edge.{k}")));
    let rough = json!({"friction": {"coulomb": {"mu": 0.2}}});
    let held = solve(&scene(json!("lower.top"), rough.clone(), 2.0));
    let two = json!({"friction": {"orthotropic": {"mu": [0.1, 0.3], "direction": [1, 0.8, 0.1]}}});
    for contact in [json!({}), rough, two] {
        let both = solve(&scene(edges.clone(), contact, 2.0));
        let force = |c: &str, of: &str| both.at(&format!("force.{of}.{c}"), 1.0);
        let size = force("z", "border").abs();
        let stiff = held.at("force.border.z", 1.0).abs();
        println!(
            "{size} of {stiff}, {} steps, {} iterations",
            both.summary.steps, both.summary.newton_iterations
        );
        assert!(size > 20.0 && size < 0.95 * stiff, "{size} {stiff}");
        for c in ["x", "y", "z"] {
            let left = force(c, "border") + force(c, "held");
            assert!(left.abs() < 1e-6 * size, "{c}: {left}");
        }
        let s = &both.summary;
        assert!(
            s.newton_iterations <= 8 * u64::from(s.steps),
            "{}",
            s.newton_iterations
        );
    }
}

/// The same where the lower sheet is rational: a part of a torus held as a whole is that surface of the file, to the last digits.
#[test]
fn a_held_torus_is_the_rigid_surface() {
    let friction = json!({"friction": {"coulomb": {"mu": 0.2}}});
    let mut held = scene(json!("lower.top"), friction.clone(), 1.0);
    held["bodies"]["lower"]["nurbs"]["file"] = json!("vault.json");
    let mut contact = friction;
    contact["offset"] = json!(0.75);
    let mut rigid = scene(Value::Null, contact, 1.0);
    rigid["surfaces"]["lower"]["cad"]["file"] = json!("vault.json");
    let [held, rigid] = [held, rigid].map(|s| solve(&s));
    let size = held.at("force.border.z", 1.0).abs();
    assert!(size > 50.0, "{size}");
    for c in ["x", "y", "z"] {
        let [a, b] = [&held, &rigid].map(|o| o.at(&format!("force.border.{c}"), 1.0));
        println!("{c}: {a} {b}");
        assert!((a - b).abs() < 1e-10 * size, "{c}: {a} {b}");
    }
}

/// Values without a pattern between -1 and 1.
fn noise(k: usize) -> f64 {
    let x = (12.9898 * k as f64 + 4.1).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

/// The assembled contact of both sheets at displacements without a pattern: forces and moments of all control points cancel at
/// round-off, and the tangent is the derivative of the forces. The lower sheet is polynomial, then rational.
#[test]
fn balance_and_tangent_of_two_sheets() {
    for lower in ["lower.json", "vault.json"] {
        balance_and_tangent(lower);
    }
}

fn balance_and_tangent(lower: &str) {
    let folder = folder();
    let all = json!("lower.corner.1");
    let mut scene = scene(all, json!({}), 2.0);
    scene["bodies"]["lower"]["nurbs"]["file"] = json!(lower);
    let text = serde_json::to_string_pretty(&scene).expect("serialisable");
    let mut loaded = scene::parse(&text, "scene.json").expect("a scene");
    loaded.dir = folder.path().to_path_buf();
    loaded.scene.solution.stabilization = scene::Stabilization::Auto;
    let model = build(&loaded).unwrap_or_else(|e| panic!("{e} at {}", e.pointer));
    let mut state = State::new(&model);
    let lower = model
        .bodies
        .iter()
        .position(|b| b.name == "lower")
        .expect("a body");
    let first = model.bodies[lower].first_node as usize;
    let own = first..first + model.bodies[lower].mesh.nodes.len();
    for n in 0..model.nodes.len() {
        for c in 0..3 {
            state.u[3 * n + c] = 0.05 * noise(3 * n + c);
        }
        if !own.contains(&n) {
            state.u[3 * n + 2] -= 0.6;
        }
    }
    let mut assembler = Assembler::new(&model, &model.dofs).expect("a pattern");
    let n = state.u.len();
    let (mut r, mut rhs) = (vec![0.0; n], vec![0.0; n]);
    assembler.clear_matrix();
    let totals =
        (assembler.linearize_contact(&mut state, 1.0, None, &mut r, &mut rhs)).expect("evaluated");
    assert!(totals.active > 50, "{}", totals.active);
    let at = |i: usize| Vec3::from_column_slice(&r[3 * i..][..3]);
    let nodes = 0..model.nodes.len();
    let on_slave: Vec3 = nodes.clone().filter(|i| !own.contains(i)).map(at).sum();
    let total: Vec3 = nodes.clone().map(at).sum();
    let moment: Vec3 = nodes
        .map(|i| model.position(i, &state.u).cross(&at(i)))
        .sum();
    let size = on_slave.norm();
    println!("force {size}, left {} and {}", total.norm(), moment.norm());
    assert!(size > 1.0, "{size}");
    assert!(total.norm() < 1e-12 * size, "{total}");
    // Lengths are up to 28.
    assert!(moment.norm() < 1e-12 * 28.0 * size, "{moment}");
    let matrix = assembler.matrix().clone();
    let free = |d: usize| !model.dofs.removed().any(|r| r as usize == d);
    let h = 1e-6;
    let (mut worst, mut scale, mut compared) = (0.0f64, 0.0f64, 0);
    for c in (0..n).filter(|&c| free(c)).step_by(5) {
        let mut side = |sign: f64| {
            let mut moved = state.clone();
            moved.u[c] += sign * h;
            let mut r = vec![0.0; n];
            (assembler.contact(&mut moved, 1.0, &mut r)).expect("evaluated");
            r
        };
        let (plus, minus) = (side(1.0), side(-1.0));
        for r in (0..n).filter(|&d| free(d)) {
            let slope = (plus[r] - minus[r]) / (2.0 * h);
            if slope != 0.0 {
                worst = worst.max((slope - matrix.get(r, c)).abs());
                scale = scale.max(slope.abs());
                compared += 1;
            }
        }
    }
    println!("{} of {scale} in {compared} entries", worst / scale);
    assert!(scale > 1.0 && compared > 1000, "{scale} {compared}");
    // A point that crosses zero between both ends changes a slope by a small share of one point's.
    assert!(worst < 2e-6 * scale, "{}", worst / scale);
}

/// A bulged sheet and a block wider than what touches, each of them the slave once: the same force.
#[test]
fn a_sheet_on_a_block() {
    let forces = [true, false].map(|slave| {
        let mut scene = scene(json!("lower.bottom"), json!({}), 1.2);
        scene["bodies"]["upper"]["nurbs"]["file"] = json!("bulge.json");
        scene["bodies"]["lower"] = json!({
            "mesh": {"block": {"min": [-20, -20, -6], "max": [20, 20, 0.75], "elements": [24, 24, 2]}},
            "material": "soft"
        });
        scene["materials"]["soft"] = json!({"neo_hooke": {"E": 1200, "nu": 0.3}});
        scene["supports"]["border"]["displacement"]["x"] = json!(0);
        if !slave {
            scene["contacts"]["press"]["slave"] = json!("lower.top");
            scene["contacts"]["press"]["master"] = json!("upper.bottom");
            scene["contacts"]["press"]["points"] = json!({"gauss": 3});
        }
        let outcome = solve(&scene);
        let force = outcome.at("force.border.z", 1.0);
        let left = force + outcome.at("force.held.z", 1.0);
        assert!(left.abs() < 1e-6 * force.abs(), "{left}");
        force
    });
    println!("{forces:?}: {}", off(forces[1], forces[0]));
    assert!(forces[0].abs() > 20.0, "{forces:?}");
    assert!(off(forces[1], forces[0]) < 1e-2, "{forces:?}");
}
