//! Shipped scenes of contact between bodies, at coarser meshes: what both sides feel, and symmetries that hold exactly.
use crate::support::{Outcome, scene_json, set, solve};
use serde_json::{Value, json};

/// A shipped scene, changed at JSON pointers, solved tightly.
fn coarse(name: &str, changes: &[(&str, Value)]) -> Value {
    let mut scene = scene_json(name);
    for (pointer, value) in changes {
        set(&mut scene, pointer, value.clone());
    }
    scene["solution"]["newton"] = json!({"tolerance": 1e-10});
    scene["solution"]["threads"] = json!(1);
    scene
}

/// Solves a scene that must end with at most this mean of Newton iterations a step and without warnings.
fn run_to_end(scene: &Value, most: f64) -> Outcome {
    let outcome = solve(scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    // What the penalty takes from forces is measured and told where it is 1 % or more.
    let told =
        |w: &&String| w.starts_with("contact gives way") && summary.accuracy.force_error >= 0.01;
    let others: Vec<&String> = summary.warnings.iter().filter(|w| !told(w)).collect();
    assert!(others.is_empty(), "{others:?}");
    let iterations = outcome.column("iterations");
    let mean = iterations.iter().sum::<f64>() / iterations.len() as f64;
    let cuts: f64 = outcome.column("cuts").iter().sum();
    println!(
        "{} steps, {mean:.1} iterations a step, {cuts} cuts",
        iterations.len()
    );
    assert!(mean <= most, "{mean} Newton iterations a step");
    outcome
}

/// Both sides of the pair feel opposite forces and moments, in every step.
fn assert_balance(outcome: &Outcome, pair: &str, length: f64) {
    let column = |name: &str| outcome.column(&format!("{name}.{pair}"));
    let force: Vec<f64> = (outcome.column(&format!("slave.force.{pair}.x")).iter())
        .zip(outcome.column(&format!("slave.force.{pair}.y")))
        .zip(outcome.column(&format!("slave.force.{pair}.z")))
        .map(|((x, y), z)| (x * x + y * y + z * z).sqrt())
        .collect();
    let last = *force.last().expect("steps");
    let worst = |values: Vec<f64>| values.into_iter().fold(0.0, f64::max);
    let (f, m) = (
        worst(column("imbalance.force")) / last,
        worst(column("imbalance.moment")) / (last * length),
    );
    println!("{pair}: force {last}, imbalance of forces {f:e}, of moments {m:e}");
    assert!(last > 0.0 && f < 1e-12 && m < 1e-12);
}

fn assert_close(what: &str, a: f64, b: f64, tolerance: f64) {
    println!("{what}: {a} and {b}, {:e} apart", (a - b).abs() / b.abs());
    assert!(
        b != 0.0 && (a - b).abs() < tolerance * b.abs(),
        "{what}: {a} and {b}"
    );
}

/// `crossed_tubes`: equal tubes, so the scene with roles exchanged is its mirror image.
#[test]
fn crossed_tubes_feel_the_same_with_roles_exchanged() {
    let mut scene = coarse(
        "crossed_tubes.json",
        &[
            (
                "/bodies/lower/mesh/cylinder_panel/elements",
                json!([16, 10]),
            ),
            (
                "/bodies/upper/mesh/cylinder_panel/elements",
                json!([16, 10]),
            ),
            ("/supports/upper_end/displacement/z", json!("-10*t")),
        ],
    );
    let one = run_to_end(&scene, 12.0);
    assert_balance(&one, "tubes", 40.0);
    let tubes = scene["contacts"]["tubes"].as_object_mut().expect("a pair");
    let slave = tubes.insert("slave".into(), json!("upper.outer"));
    tubes.insert("master".into(), slave.expect("its slave"));
    let other = run_to_end(&scene, 12.0);
    assert_balance(&other, "tubes", 40.0);
    let end = |run: &Outcome, name: &str| run.at(&format!("force.{name}"), 1.0);
    // The ends carry everything along z.
    for run in [&one, &other] {
        let push = end(run, "upper_end.z");
        assert!(push < -1.0);
        assert_close("lower end", end(run, "lower_end.z"), -push, 1e-8);
        assert_close(
            "slave",
            run.at("area.contact", 1.0),
            one.at("area.contact", 1.0),
            1e-6,
        );
    }
    // Mirror images of each other: what one tube does in one run, the other does in the other.
    for (a, b) in [
        ("upper_end.z", "upper_end.z"),
        ("upper_end.y", "lower_end.x"),
        ("lower_end.x", "upper_end.y"),
        ("upper_cut_below.y", "lower_cut_above.x"),
        ("upper_middle.x", "lower_middle.y"),
    ] {
        assert_close(a, end(&one, a), end(&other, b), 1e-6);
    }
    // In one run the tubes differ by what the contact points sample, of second order in the size of an element: a quarter of
    // the radius here, and the bending of the wall is resolved no better.
    let press = end(&one, "lower_end.z");
    for (a, b) in [
        ("upper_end.y", "lower_end.x"),
        ("upper_middle.x", "lower_middle.y"),
        ("upper_cut_below.y", "lower_cut_above.x"),
    ] {
        let apart = (end(&one, a) - end(&one, b)).abs() / press;
        println!("{a} and {b} are {apart:e} of the press apart");
        assert!(apart > 0.0 && apart < 0.02);
    }
}

/// Meshes of `sandwiched_shell` for tests.
fn sandwich() -> Value {
    coarse(
        "sandwiched_shell.json",
        &[
            ("/bodies/below/mesh/block/elements", json!([8, 8, 3])),
            ("/bodies/sheet/mesh/plate/elements", json!([10, 10])),
            ("/bodies/above/mesh/block/elements", json!([5, 5, 3])),
            // Elements of this size are softer, and so would be their contact.
            ("/contacts/upper_face/penalty", json!({"scaled": 6})),
            ("/contacts/lower_face/penalty", json!({"scaled": 6})),
        ],
    )
}

/// `sandwiched_shell`: what presses from above is carried by the floor and by the clamp.
#[test]
fn sandwiched_shell_carries_part_of_the_load_to_its_clamp() {
    let outcome = run_to_end(&sandwich(), 9.0);
    assert_balance(&outcome, "upper_face", 30.0);
    assert_balance(&outcome, "lower_face", 30.0);
    for t in outcome.column("time") {
        let f = |name: &str| outcome.at(&format!("{name}.z"), t);
        let (press, floor) = (f("force.press"), f("force.floor"));
        let clamp = f("force.clamp_x") + f("force.clamp_y");
        assert!((press + floor + clamp).abs() < 1e-8 * press.abs(), "at {t}");
        assert!((f("slave.force.upper_face") + press).abs() < 1e-8 * press.abs());
        assert!((f("slave.force.lower_face") + floor).abs() < 1e-8 * press.abs());
    }
    let f = |name: &str| outcome.at(name, 1.0);
    let share = (f("force.clamp_x.z") + f("force.clamp_y.z")) / -f("force.press.z");
    println!("share of the clamp: {share}");
    assert!(share > 0.1 && share < 0.4);
    // Mirror image over x = y; the meshes are too, the corner of the clamp belongs to both.
    assert_close("sides", f("force.below_x.x"), f("force.below_y.y"), 1e-8);
    assert_close("sheet", f("force.sheet_x.x"), f("force.sheet_y.y"), 1e-8);
}

/// The same with equal blocks pressed by equal ways: the sheet stays where it is, and each block feels a rigid plane but
/// for the thickness strain of half the sheet, p / E = about 4 / 2000 of .5, against 2.5 of 10 in the block: 4e-4.
#[test]
fn a_sheet_between_equal_blocks_is_a_rigid_plane() {
    let mut scene = sandwich();
    let above = scene["bodies"]["above"].clone();
    scene["bodies"]["below"] = above;
    set(
        &mut scene,
        "/bodies/below/mesh/block/min",
        json!([0, 0, -10.5]),
    );
    set(
        &mut scene,
        "/bodies/below/mesh/block/max",
        json!([12, 12, -0.5]),
    );
    set(
        &mut scene,
        "/supports/press/displacement/z",
        json!("-2.5*t"),
    );
    scene["supports"]["floor"] =
        json!({"on": "below.bottom", "displacement": {"x": 0, "y": 0, "z": "2.5*t"}});
    let outcome = run_to_end(&scene, 9.0);
    let f = |name: &str| outcome.at(name, 1.0);
    assert_close("blocks", f("force.floor.z"), -f("force.press.z"), 1e-8);
    let pressed = f("force.press.z");
    for clamp in ["clamp_x", "clamp_y"] {
        let z = f(&format!("force.{clamp}.z"));
        assert!(z.abs() < 1e-8 * pressed.abs(), "{clamp}: {z}");
    }
    let sheet = outcome.body("sheet", outcome.column("step").len() as u32);
    let u = sheet.field("displacement");
    for (n, p) in sheet.points.iter().enumerate() {
        let mirror = (sheet.points.iter())
            .position(|q| (q[0] - p[0]).hypot(q[1] - p[1]).hypot(q[2] + p[2]) < 1e-9)
            .expect("mirror image");
        assert!((u[3 * n + 2] + u[3 * mirror + 2]).abs() < 1e-8);
    }
    for body in ["below", "sheet"] {
        scene["bodies"]
            .as_object_mut()
            .expect("bodies")
            .remove(body);
        for kind in ["supports", "contacts"] {
            let items = scene[kind].as_object_mut().expect(kind);
            items.retain(|_, v| {
                let on = v["on"].as_str().or(v["slave"].as_str()).unwrap_or_default();
                !on.starts_with(body)
            });
        }
    }
    scene["surfaces"] =
        json!({"plane": {"plane": {"size": [60, 60]}, "placement": {"translation": [0, 0, 0.5]}}});
    let pair = scene["contacts"]["upper_face"]
        .as_object_mut()
        .expect("pair");
    pair.insert("master".into(), json!("plane"));
    pair.remove("master_surface");
    let rigid = run_to_end(&scene, 9.0);
    assert_close("on a plane", pressed, rigid.at("force.press.z", 1.0), 1e-3);
}

/// `pinched_tube`: the scene is its own mirror image over z = 0, and the walls touch there.
#[test]
fn walls_of_the_pinched_tube_touch_with_pressure() {
    let scene = coarse(
        "pinched_tube.json",
        &[("/bodies/tube/mesh/cylinder_panel/elements", json!([24, 14]))],
    );
    let outcome = run_to_end(&scene, 9.0);
    let (time, step) = (outcome.column("time"), outcome.column("step"));
    let f = |name: &str, t: f64| outcome.at(name, t);
    let peak = |name: &str| {
        outcome
            .column(name)
            .iter()
            .fold(0.0, |a: f64, b| a.max(b.abs()))
    };
    let force = peak("force.above.z");
    for &t in &time {
        let (above, below) = (f("force.above.z", t), f("force.below.z", t));
        assert!(
            (above + below).abs() < 1e-8 * force,
            "at {t}: {above}, {below}"
        );
        assert!(f("force.waist.z", t).abs() < 1e-8 * force, "at {t}");
    }
    println!("force of a ball {force}");
    let (imbalance, moment) = (
        peak("imbalance.force.walls"),
        peak("imbalance.moment.walls"),
    );
    println!("imbalance of the walls {imbalance:e}, {moment:e}");
    assert!(imbalance < 1e-12 * force && moment < 1e-12 * force * 60.0);
    // Pressure on the inner walls, near the middle of the tube only, and the walls are together there.
    let last = *step.last().expect("steps") as u32;
    let tube = outcome.body("tube", last);
    let (u, p) = (tube.field("displacement"), tube.field("contact_pressure"));
    let (mut pressed, mut middle) = (0, 0);
    for (n, x) in tube.points.iter().enumerate() {
        let mirror = (tube.points.iter())
            .position(|q| (q[0] - x[0]).hypot(q[1] - x[1]).hypot(q[2] + x[2]) < 1e-6)
            .expect("mirror image");
        for k in 0..3 {
            let sign = if k == 2 { -1.0 } else { 1.0 };
            let apart = u[3 * n + k] - sign * u[3 * mirror + k];
            assert!(apart.abs() < 1e-8, "node {n}: {apart:e}");
        }
        if x[0].hypot(x[2]) < 19.5 && p[n] > 0.0 {
            pressed += 1;
            // A node shows the pressure of the faces around it, so it may be an element away from those that touch.
            let z = (x[2] + u[3 * n + 2]).abs();
            assert!(x[1] < 15.0 && z < 1.5, "{x:?} at {z}");
            if x[0].abs() + x[1] < 1e-6 {
                println!("in the middle: pressure {}, {z} from z = 0", p[n]);
                // Held at Gauss points, faces that bulge towards each other sink in further at their corners.
                assert!(p[n] > 0.1 && z < 0.1);
                middle += 1;
            }
        }
    }
    println!("{pressed} nodes of the inner face are pressed");
    assert!(pressed >= 4 && middle == 2);
    // 1 % of the size of an element.
    // A tenth of the thickness of the tube, which is what walls may sink into each other under an automatic penalty.
    assert!(peak("penetration.max") < 0.2);
    // Until shortly before the balls are two walls apart nothing touches inside: the tube's outer faces alone are in contact.
    let way = |t: f64| 19.3 * t;
    let apart = (time.iter().zip(&step)).rfind(|(t, _)| way(**t) < 15.0);
    let tube = outcome.body("tube", *apart.expect("a step").1 as u32);
    let p = tube.field("contact_pressure");
    let inside = (tube.points.iter().zip(p)).filter(|(x, p)| x[0].hypot(x[2]) < 19.5 && **p > 0.0);
    assert_eq!(inside.count(), 0);
}

/// `q18_on_h8`: the quadratic shell is so close that its refinement hardly changes the force.
#[test]
fn a_quadratic_cap_on_linear_elements_is_refined() {
    let force = |cap: u32| {
        let scene = coarse(
            "q18_on_h8.json",
            &[
                ("/bodies/cap/mesh/sphere_panel/elements", json!([cap, cap])),
                ("/bodies/block/mesh/block/elements", json!([8, 8, 3])),
                ("/supports/edge_x/displacement/z", json!("-3*t")),
                ("/supports/edge_y/displacement/z", json!("-3*t")),
            ],
        );
        let outcome = run_to_end(&scene, 10.0);
        assert_balance(&outcome, "press", 25.0);
        let f = |name: &str| outcome.at(name, 1.0);
        let pushed = f("force.edge_x.z") + f("force.edge_y.z");
        assert_close("floor", f("force.floor.z"), -pushed, 1e-8);
        // Mirror image over x = y.
        (f("force.floor.z"), f("area.contact"))
    };
    let [coarse, middle, fine] = [2, 3, 5].map(force);
    println!("{coarse:?} {middle:?} {fine:?}");
    // Measured: 8.5 % and 1.0 % away from the finest, on the same coarse block.
    assert_close("refined twice", middle.0, fine.0, 0.015);
    assert!((middle.0 - fine.0).abs() < (coarse.0 - fine.0).abs());
}
