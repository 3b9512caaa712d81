//! Supports through scenes: mid-surface supports, prescribed displacements, symmetry, contradictions, reactions.
use crate::support::{Outcome, solve};
use covact::{model, scene};
use serde_json::{Value, json};

/// Scene of one body `b`.
fn scene_of(mesh: Value, material: Value, supports: Value, loads: Value) -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": material}},
        "bodies": {"b": {"mesh": mesh, "material": "m"}},
        "supports": supports,
        "loads": loads,
        "solution": {"step": {"initial": 1, "max": 1}, "newton": {"tolerance": 1e-13}},
        "output": {"every": 1}
    })
}

/// Undeformed position and displacement of every node at a step.
fn nodes(outcome: &Outcome, step: u32) -> Vec<([f64; 3], [f64; 3])> {
    let body = outcome.body("b", step);
    let u = body.field("displacement");
    (body.points.iter().enumerate())
        .map(|(n, x)| (*x, [u[3 * n], u[3 * n + 1], u[3 * n + 2]]))
        .collect()
}

/// Side length, thickness, Young's modulus and pressure of the plates; the deflection is a thousandth of the thickness.
const SIDE: f64 = 10.0;
const THICK: f64 = 0.1;
const E: f64 = 1e6;
const NU: f64 = 0.3;
const Q: f64 = 2e-4;

/// Quarter of a square plate on hinges: `z` on the middle of the edges, and the displacement along an edge on both
/// faces (the "hard" support of Navier's solution, whose edges do not twist).
fn plate(n: u32) -> Value {
    scene_of(
        json!({"plate": {"size": [0.5 * SIDE, 0.5 * SIDE], "thickness": THICK, "elements": [n, n]}}),
        json!({"E": E, "nu": NU}),
        json!({
            "hinge_x": {"on": "b.x_max", "mid_surface": true, "displacement": {"z": 0}},
            "hinge_y": {"on": "b.y_max", "mid_surface": true, "displacement": {"z": 0}},
            "straight_x": {"on": "b.x_max", "displacement": {"y": 0}},
            "straight_y": {"on": "b.y_max", "displacement": {"x": 0}},
            "symmetry_x": {"on": "b.x_min", "symmetry": "x"},
            "symmetry_y": {"on": "b.y_min", "symmetry": "y"}
        }),
        json!({"q": {"on": "b.top", "pressure": format!("{Q}*t")}}),
    )
}

/// Deflection of the middle.
fn middle(outcome: &Outcome) -> f64 {
    let found: Vec<f64> = (nodes(outcome, 1).iter())
        .filter(|(x, _)| x[0].abs() < 1e-9 && x[1].abs() < 1e-9)
        .map(|(_, u)| -u[2])
        .collect();
    assert_eq!(found.len(), 2);
    0.5 * (found[0] + found[1])
}

/// S. P. Timoshenko and S. Woinowsky-Krieger, "Theory of Plates and Shells", 2nd ed. 1959, article 30, table 8:
/// w = .00406 q a^4 / D; .00406235 with more terms of the series. The shear deformation adds, on hard hinges, the
/// moment sum over the shear stiffness, .0736713 q a^2 / (G h) (the element's shear strain is constant through the
/// thickness: no correction factor): 0.04 % here.
#[test]
fn hinged_square_plate_converges_to_navier() {
    let d = E * THICK.powi(3) / (12.0 * (1.0 - NU * NU));
    let shear = E / (2.0 * (1.0 + NU)) * THICK;
    let exact = 0.00406235 * Q * SIDE.powi(4) / d + 0.0736713 * Q * SIDE.powi(2) / shear;
    let mut errors = Vec::new();
    for n in [4, 8, 16] {
        let outcome = solve(&plate(n));
        let w = middle(&outcome);
        println!("{n}: w {w:.8e}, exact {exact:.8e}, {:.3e}", w / exact - 1.0);
        errors.push((w / exact - 1.0).abs());
        // What the load puts in comes out at the hinges.
        let up: f64 = (["hinge_x", "hinge_y"].iter())
            .map(|s| outcome.at(&format!("force.{s}.z"), 1.0))
            .sum();
        let load = Q * SIDE * SIDE / 4.0;
        assert!((up / load - 1.0).abs() < 1e-10, "{up} instead of {load}");
    }
    let rates = [0, 1].map(|i| (errors[i] / errors[i + 1]).log2());
    println!("{errors:?}: rates {rates:?}");
    assert!(errors[2] < 2e-3);
    assert!(rates.iter().all(|r| (1.7..2.4).contains(r)));
}

/// A quarter with symmetry planes is the same as the whole.
#[test]
fn symmetry_replaces_the_other_half() {
    let quarter = plate(4);
    let mut whole = quarter.clone();
    whole["bodies"]["b"]["mesh"]["plate"] = json!({
        "size": [SIDE, SIDE], "thickness": THICK, "elements": [8, 8], "origin": [-0.5 * SIDE, -0.5 * SIDE, 0]});
    let all = whole["supports"].as_object_mut().expect("supports");
    for (axis, along) in [("x", "y"), ("y", "x")] {
        all.remove(&format!("symmetry_{axis}"));
        let on = format!("b.{axis}_min");
        all.insert(
            format!("hinge_{axis}_min"),
            json!({"on": on, "mid_surface": true, "displacement": {"z": 0}}),
        );
        all.insert(
            format!("straight_{axis}_min"),
            json!({"on": on, "displacement": {along: 0}}),
        );
    }
    let (quarter, whole) = (solve(&quarter), solve(&whole));
    let (q, w) = (middle(&quarter), middle(&whole));
    println!("{q} {w}");
    assert!(w > 0.0 && (q / w - 1.0).abs() < 1e-8);
    let up = whole.at("force.hinge_x.z", 1.0) + whole.at("force.hinge_x_min.z", 1.0);
    assert!((up / (4.0 * quarter.at("force.hinge_x.z", 1.0)) - 1.0).abs() < 1e-6);
}

/// On a hinge the middle stays, the faces turn about it, and the plate may become thinner.
#[test]
fn a_hinge_leaves_rotation_and_thickness_free() {
    // Squeezed between two pressures: strain -p / E through the thickness, also on the hinge.
    let p = 1000.0;
    let mut scene = plate(3);
    scene["loads"] = json!({
        "above": {"on": "b.top", "pressure": format!("{p}*t")},
        "below": {"on": "b.bottom", "pressure": format!("{p}*t")}
    });
    // Free to spread in its plane.
    let all = scene["supports"].as_object_mut().expect("supports");
    all.remove("straight_x");
    all.remove("straight_y");
    let outcome = solve(&scene);
    // St. Venant-Kirchhoff under a dead pressure: S lambda = -p with S = E (lambda^2 - 1) / 2.
    let thinning = (0..20).fold(1.0f64, |l, _| {
        l - (0.5 * E * l * (l * l - 1.0) + p) / (0.5 * E * (3.0 * l * l - 1.0))
    }) - 1.0;
    let mut seen = 0;
    for (x, u) in nodes(&outcome, 1) {
        if x[0] > 0.5 * SIDE - 1e-9 {
            let expected = thinning * x[2];
            assert!((u[2] / expected - 1.0).abs() < 1e-7, "{} {expected}", u[2]);
            seen += 1;
        }
    }
    assert_eq!(seen, 8);

    // Bent: faces move in opposite directions, the middle stays where it is.
    let outcome = solve(&plate(8));
    let edge: Vec<_> = (nodes(&outcome, 1).into_iter())
        .filter(|(x, _)| x[0] > 0.5 * SIDE - 1e-9 && x[1].abs() < 1e-9)
        .collect();
    let [(low, a), (_, b)] = [edge[0], edge[1]];
    assert_eq!(edge.len(), 2);
    assert!(low[2] < 0.0);
    let turn = (b[0] - a[0]) / THICK;
    // Slope in the middle of an edge by the first term of Navier's series, 4 q a^3 / (pi^5 D); the others add 3 %.
    let d = E * THICK.powi(3) / (12.0 * (1.0 - NU * NU));
    let first_term = 4.0 / std::f64::consts::PI.powi(5) * Q * SIDE.powi(3) / d;
    println!("edge turns by {turn:.4e}, first term {first_term:.4e}");
    assert!((turn / first_term).abs() > 0.9 && (turn / first_term).abs() < 1.1);
    assert!((a[2] + b[2]).abs() < 1e-15 && (a[0] + b[0]).abs() < 0.05 * (a[0] - b[0]).abs());
}

/// Bar of nu = 0 pulled by a prescribed displacement.
fn pulled(x: Value, step: f64) -> Outcome {
    let mut scene = scene_of(
        json!({"plate": {"size": [2, 1], "thickness": 0.5, "elements": [2, 1]}}),
        json!({"E": 100, "nu": 0}),
        json!({
            "wall": {"on": "b.x_min", "fixed": true},
            "end": {"on": "b.x_max", "displacement": {"x": x}}
        }),
        json!({}),
    );
    scene["solution"]["step"] = json!({"initial": step, "max": step});
    solve(&scene)
}

/// Force of the bar at a displacement: St. Venant-Kirchhoff in uniaxial strain, area 0.5.
fn pull_force(u: f64) -> f64 {
    let stretch = 1.0 + u / 2.0;
    0.5 * 100.0 * stretch * (stretch * stretch - 1.0) / 2.0
}

#[test]
fn displacements_by_number_table_and_expression() {
    // A number holds from the first step on.
    let outcome = pulled(json!(0.1), 0.25);
    let force = outcome.column("force.end.x");
    println!("{force:?}");
    assert_eq!(force.len(), 4);
    for f in force {
        assert!((f / pull_force(0.1) - 1.0).abs() < 1e-10);
    }

    // A table is linear between its rows, and steps end on them.
    let outcome = pulled(
        json!({"table": [[0, 0], [0.13, 0.2], [0.6, -0.1], [2, 0.7]]}),
        0.25,
    );
    let times = outcome.column("time");
    println!("{times:?}");
    for row in [0.13, 0.6, 1.0] {
        assert!(times.iter().any(|t| (t - row).abs() < 1e-12), "{times:?}");
    }
    let mut seen = 0;
    for (t, f) in times.iter().zip(outcome.column("force.end.x")) {
        let u = if *t <= 0.13 {
            0.2 * t / 0.13
        } else if *t <= 0.6 {
            0.2 - 0.3 * (t - 0.13) / 0.47
        } else {
            -0.1 + 0.8 * (t - 0.6) / 1.4
        };
        assert!(
            (f - pull_force(u)).abs() < 1e-10 * pull_force(0.2),
            "t {t}: {f}"
        );
        seen += 1;
    }
    assert!(seen >= 5);

    // An expression of place and time, at every node.
    let outcome = pulled(json!("0.1*t^2*(1+y)*(1+z)"), 0.5);
    let last = nodes(&outcome, outcome.summary.steps);
    let mut seen = 0;
    for (x, u) in last.iter().filter(|(x, _)| x[0] > 2.0 - 1e-9) {
        let expected = 0.1 * (1.0 + x[1]) * (1.0 + x[2]);
        assert!((u[0] - expected).abs() < 1e-14, "{x:?} {u:?}");
        seen += 1;
    }
    assert_eq!(seen, 4);
    for (x, u) in last.iter().filter(|(x, _)| x[0] < 1e-9) {
        assert_eq!(*u, [0.0; 3], "{x:?}");
    }
    // The wall holds what the end pulls.
    let balance = outcome.at("force.wall.x", 1.0) + outcome.at("force.end.x", 1.0);
    assert!(balance.abs() < 1e-10 * outcome.at("force.end.x", 1.0).abs());
}

/// The message with which a scene is refused.
fn refusal(scene: &Value) -> String {
    let text = scene.to_string();
    let loaded = match scene::parse(&text, "scene.json") {
        Ok(loaded) => loaded,
        Err(e) => return e.to_string(),
    };
    match model::build::build(&loaded) {
        Ok(_) => panic!("the scene should have been refused"),
        Err(e) => e.to_string(),
    }
}

#[test]
fn contradictions_are_refused_by_both_names() {
    let conflict = |one: Value, other: Value| {
        let mut scene = plate(2);
        scene["supports"] = json!({
            "all": {"on": "b.y_min", "fixed": true}, "one": one, "other": other});
        refusal(&scene)
    };
    let on = "b.x_max";
    let cases = [
        (
            json!({"on": on, "displacement": {"x": 0.1}}),
            json!({"on": on, "displacement": {"x": "0.1*t"}}),
        ),
        (
            json!({"on": on, "mid_surface": true, "displacement": {"x": 0.1}}),
            json!({"on": on, "mid_surface": true, "displacement": {"x": 0.2}}),
        ),
        (
            json!({"on": on, "mid_surface": true, "displacement": {"x": 0.1}}),
            json!({"on": on, "displacement": {"x": 0.2}}),
        ),
    ];
    for (one, other) in cases {
        // The fixed edge shares two nodes with the others, which must not be what is complained about.
        let far = |mut s: Value| {
            s["on"] = json!("b.x_max");
            s
        };
        let message = conflict(far(one), far(other));
        println!("{message}");
        assert!(
            message.contains("different displacements along x"),
            "{message}"
        );
        let named = ["`all`", "`one`", "`other`"].map(|n| message.contains(n));
        assert_eq!(named.iter().filter(|n| **n).count(), 2, "{message}");
    }
    // The same displacement twice is no contradiction, also as the mean of both faces.
    let mut scene = plate(2);
    let all = scene["supports"].as_object_mut().expect("supports");
    all.insert(
        "again".into(),
        json!({"on": "b.x_max", "displacement": {"z": "0*t"}}),
    );
    let loaded = scene::parse(&scene.to_string(), "scene.json").expect("valid");
    assert!(model::build::build(&loaded).is_ok());
}

/// One face held and the middle moved: the other face moves twice as far. Each support is charged with its own part of
/// the reaction, so that the sum is that of the load.
#[test]
fn a_mean_beside_a_held_face() {
    for face in ["b.low", "b.high"] {
        let mut scene = scene_of(
            json!({"plate": {"size": [2, 1], "thickness": 0.5, "elements": [2, 1], "origin": [0, 0, 0.25]}}),
            json!({"E": 1000, "nu": 0.3}),
            json!({
                "wall": {"on": "b.x_min", "fixed": true},
                "face": {"on": face, "displacement": {"z": 0.01}},
                "middle": {"on": "b.x_max", "mid_surface": true, "displacement": {"z": "0.02*t+0*y"}}
            }),
            json!({"q": {"on": "b.top", "traction": [0.2, 0.1, -0.7]}}),
        );
        scene["bodies"]["b"]["sets"] = json!({
            "low": {"nodes_in_box": {"min": [2, 0, 0], "max": [2, 1, 0]}},
            "high": {"nodes_in_box": {"min": [2, 0, 0.5], "max": [2, 1, 0.5]}}
        });
        let outcome = solve(&scene);
        for (x, u) in nodes(&outcome, 1).iter().filter(|(x, _)| x[0] > 2.0 - 1e-9) {
            let held = (x[2] > 0.25) == (face == "b.high");
            let expected = if held { 0.01 } else { 0.03 };
            assert!((u[2] - expected).abs() < 1e-14, "{x:?} {u:?}");
        }
        for (axis, load) in [("x", 0.4), ("y", 0.2), ("z", -1.4)] {
            let sum: f64 = (["wall", "face", "middle"].iter())
                .map(|s| outcome.at(&format!("force.{s}.{axis}"), 1.0))
                .sum();
            assert!((sum + load).abs() < 1e-10, "{axis}: {sum} against {load}");
        }
        // The face alone feels the squeeze between the two: it is not nothing.
        assert!(outcome.at("force.face.z", 1.0).abs() > 1.0);
    }
}
