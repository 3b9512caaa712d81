//! Gaps averaged over the faces around slave nodes, in the assembled system and in runs.
use crate::blocks::{DELTA, E, done, patch, pressures};
use crate::convergence::judge_scene;
use crate::self_contact::{R, T, pinched};
use crate::shells::{arch_on_plate, balance};
use crate::support::{scene_json, set, solve};
use covact::assembly::{Assembler, Totals};
use covact::model::state::State;
use covact::model::{Model, build::build};
use covact::output::RunStatus;
use covact::scene;
use covact::system::DofMap;
use serde_json::{Value, json};

fn averaged(mut scene: Value) -> Value {
    for contact in scene["contacts"]
        .as_object_mut()
        .expect("contacts")
        .values_mut()
    {
        contact["gap"] = json!("averaged");
    }
    scene
}

fn model(scene: &Value) -> Model {
    let mut loaded = scene::parse(&scene.to_string(), "scene.json").expect("valid scene");
    loaded.dir = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenes").into();
    build(&loaded).unwrap_or_else(|e| panic!("{e} at {}", e.pointer))
}

/// A number in (-1, 1) that looks random.
fn noise(i: usize) -> f64 {
    let x = (i as f64 * 12.9898 + 4.1414).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

/// The contact of a scene alone, at given displacements: what the whole has more than the same bodies without contact.
struct ContactAlone<'m> {
    with: &'m Model,
    systems: [(&'m Model, Assembler<'m>); 2],
}

impl<'m> ContactAlone<'m> {
    fn new(with: &'m Model, without: &'m Model, free: &'m DofMap) -> Self {
        let system = |model| (model, Assembler::new(model, free).expect("a pattern"));
        ContactAlone {
            with,
            systems: [system(with), system(without)],
        }
    }

    /// Residual and totals.
    fn at(&mut self, u: &[f64]) -> (Vec<f64>, Totals) {
        let n = u.len();
        let [a, b] = self.systems.each_mut().map(|(model, assembler)| {
            let mut state = State::new(model);
            state.u.copy_from_slice(u);
            let (mut r, mut rhs) = (vec![0.0; n], vec![0.0; n]);
            let totals = assembler
                .linearize(&mut state, 0.0, None, &mut r, &mut rhs)
                .unwrap_or_else(|e| panic!("{e}"));
            (r, totals)
        });
        let r = (0..n).map(|i| a.0[i] - b.0[i]).collect();
        (r, a.1)
    }

    /// Entry of the tangent of the last evaluation.
    fn entry(&self, i: usize, j: usize) -> f64 {
        let [a, b] = [0, 1].map(|k| self.systems[k].1.matrix());
        let own = self.systems[1].1.matrix().pattern();
        let in_both = own.block((i / 3) as u32, (j / 3) as u32).is_some();
        a.get(i, j) - if in_both { b.get(i, j) } else { 0.0 }
    }

    /// Errors of the tangent, of the residual as derivative of the energy, of force and of moment balance.
    fn errors(&mut self, name: &str, u: &[f64]) -> [f64; 4] {
        let n = u.len();
        let (r0, totals) = self.at(u);
        let all: usize = (self.with.pairs.iter())
            .filter_map(|p| p.averaged.as_ref().map(|a| a.len()))
            .sum();
        assert!(
            0 < totals.active && totals.active < all,
            "{name}: {} of {all} nodes closed",
            totals.active
        );
        let k: Vec<Vec<f64>> = (0..n)
            .map(|i| (0..n).map(|j| self.entry(i, j)).collect())
            .collect();
        let largest = |x: &[f64]| x.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        let k_scale = k.iter().fold(0.0f64, |a, row| a.max(largest(row)));
        let r_scale = largest(&r0);
        assert!(k_scale > 1e-3 && r_scale > 1e-4, "{name}: nothing presses");
        let h = 1e-6;
        let (mut tangent, mut energy, mut columns) = (0.0f64, 0.0f64, 0);
        for j in 0..n {
            if k[j][j] == 0.0 {
                continue;
            }
            columns += 1;
            let mut side = |sign: f64| {
                let mut u = u.to_vec();
                u[j] += sign * h;
                self.at(&u)
            };
            let (plus, minus) = (side(1.0), side(-1.0));
            assert_eq!(plus.1.active, minus.1.active);
            for (i, row) in k.iter().enumerate() {
                let slope = (plus.0[i] - minus.0[i]) / (2.0 * h);
                tangent = tangent.max((slope - row[j]).abs() / k_scale);
            }
            let slope = (plus.1.contact_energy - minus.1.contact_energy) / (2.0 * h);
            energy = energy.max((slope - r0[j]).abs() / r_scale);
        }
        assert!(columns > 20, "{name}: {columns} columns");
        let [force, moment] = match self.with.pairs[0].body_master() {
            None => [0.0; 2],
            Some(_) => {
                let p = &totals.pairs[0];
                [
                    (p.slave.force + p.master.force).norm() / p.slave.force.norm(),
                    (p.slave.moment + p.master.moment).norm() / p.slave.moment.norm(),
                ]
            }
        };
        println!(
            "{name}: {} of {all} nodes closed, {columns} columns: tangent {tangent:.1e}, energy {energy:.1e}, balance \
             {force:.1e} {moment:.1e}",
            totals.active
        );
        [tangent, energy, force, moment]
    }
}

/// The assembled tangent against central differences of the residual, the residual against those of the energy, and the
/// balance of both sides, with some of the nodes open.
#[test]
fn assembled_tangents_are_derivatives_and_both_sides_balance() {
    let ball = |element: &str, n: u32| {
        let mut scene = scene_json("ball_on_plate.json");
        set(&mut scene, "/bodies/plate/mesh/plate/elements", vec![n, n]);
        scene["bodies"]["plate"]["element"] = json!(element);
        scene["contacts"]
            .as_object_mut()
            .unwrap()
            .values_mut()
            .for_each(|c| {
                c["points"] = json!({"gauss": 3});
                c["penalty"] = json!({"value": 500});
            });
        scene
    };
    let arch = |slave: &str, master: &str, surface: &str| {
        let mut scene = arch_on_plate(2.0, 4, json!({"gauss": 3}));
        scene["bodies"]["arch"]["element"] = json!(slave);
        scene["bodies"]["plate"]["element"] = json!(master);
        scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = json!([4, 2]);
        scene["bodies"]["arch"]["mesh"]["cylinder_panel"]["elements"] = json!([3, 1]);
        scene["contacts"]["press"]["master_surface"] = json!(surface);
        scene
    };
    for (name, scene, body, lift) in [
        ("ball on h8", ball("h8", 6), "plate", 3.0),
        ("ball on q18", ball("q18", 4), "plate", 3.0),
        ("h8 on h8", arch("h8", "h8", "faces"), "arch", -0.2),
        ("q18 on h8", arch("q18", "h8", "faces"), "arch", -0.2),
        ("h8 on q18", arch("h8", "q18", "faces"), "arch", -0.2),
        ("h8 on smooth h8", arch("h8", "h8", "smooth"), "arch", -0.2),
    ] {
        let with = model(&averaged(scene.clone()));
        let mut alone = scene;
        alone.as_object_mut().unwrap().remove("contacts");
        alone.as_object_mut().unwrap().remove("surfaces");
        let without = model(&alone);
        let free = DofMap::free(with.nodes.len());
        let mut u: Vec<f64> = (0..3 * with.nodes.len()).map(|i| 0.02 * noise(i)).collect();
        let moved = with.bodies.iter().find(|b| b.name == body).unwrap();
        let first = moved.first_node as usize;
        for node in first..first + moved.mesh.nodes.len() {
            u[3 * node + 2] += lift;
        }
        let [tangent, energy, force, moment] =
            ContactAlone::new(&with, &without, &free).errors(name, &u);
        assert!(tangent < 1e-7, "{name}: {tangent:e}");
        assert!(energy < 1e-7, "{name}: {energy:e}");
        assert!(
            force < 1e-12 && moment < 1e-12,
            "{name}: {force:e} {moment:e}"
        );
    }
}

/// Nominal pressure of the patch test at a penalty.
fn exact(eps: f64) -> f64 {
    let mut p = DELTA * 0.97 * E;
    for _ in 0..50 {
        let s = 1.0 - (DELTA - p / eps);
        let (f, df) = (
            p + 0.5 * E * s * (s * s - 1.0),
            1.0 + 0.5 * E * (3.0 * s * s - 1.0) / eps,
        );
        p -= f / df;
    }
    p
}

/// Two blocks whose meshes do not match, under ever stiffer penalties: how far the tractions are off. Those of points
/// oscillate the more the stiffer the penalty, up to 36 % with 2 x 2 points; those of averaged gaps, which are the nodes'
/// own, are off by what the points miss of the kinks in the master's shape functions, 6.7 % with 2 x 2 points and 0.33 %
/// with 10 x 10, whatever the penalty. (The nodal means of pointwise tractions hide the oscillation: they are off by less.)
#[test]
fn blocks_under_a_stiff_penalty() {
    let run = |points: u32, gap: &str, eps: f64| {
        let mut scene = patch(3, 2, json!({ "gauss": points }));
        scene["contacts"]["press"]["penalty"]["value"] = json!(eps);
        scene["contacts"]["press"]["gap"] = json!(gap);
        scene["solution"]["newton"]["tolerance"] = json!(1e-10);
        let outcome = done(&scene);
        let p = exact(eps);
        let [low, high] = pressures(&outcome, "upper");
        let nodes = (high - p).max(p - low) / p;
        let largest = outcome.column("pressure.max")[0] / p - 1.0;
        let force = outcome.column("force.ground.z")[0] / p - 1.0;
        println!(
            "{eps:.0e}, {points} points, {gap}: nodes {nodes:.2e}, largest {largest:.2e}, force {force:.2e}"
        );
        assert!(force.abs() < 3e-4);
        [nodes, largest]
    };
    let automatic = model(&patch(3, 2, json!("nodes"))).notes;
    println!("{automatic:?}");
    let points = [2, 3, 5, 10];
    let mut before: Option<[f64; 4]> = None;
    for (eps, stated) in [
        (1e8, [0.125, 0.0992, 0.0463, 0.0128]),
        (1e9, [0.299, 0.159, 0.0814, 0.0221]),
        (1e10, [0.363, 0.169, 0.0878, 0.0240]),
    ] {
        let pointwise = points.map(|n| run(n, "pointwise", eps));
        let averaged = points.map(|n| run(n, "averaged", eps));
        for i in 0..4 {
            let (at_points, at_nodes) = (pointwise[i][1], averaged[i][0]);
            assert!((at_points / stated[i] - 1.0).abs() < 0.02, "{at_points}");
            // What is left is the quadrature's, and no matter of the penalty.
            if let Some(before) = before {
                assert!((at_nodes / before[i] - 1.0).abs() < 0.08, "{at_nodes}");
            }
            assert!(at_nodes < [0.07, 0.062, 0.025, 0.0034][i], "{at_nodes}");
            assert!(at_nodes < 0.65 * at_points, "{at_nodes} {at_points}");
        }
        before = Some(averaged.map(|a| a[0]));
    }
}

/// Newton's method converges quadratically; elements are half open on the border of the contact zone, and both sides feel
/// the same.
#[test]
fn an_arch_comes_down_on_a_plate() {
    for (points, surface) in [
        (json!({"gauss": 3}), "faces"),
        (json!({"gauss": 3}), "smooth"),
    ] {
        let mut scene = averaged(arch_on_plate(2.0, 5, points.clone()));
        scene["contacts"]["press"]["master_surface"] = json!(surface);
        scene["output"] = json!({"every": 1});
        let [good, bad] = judge_scene(&scene);
        println!("{points} {surface}: {good} good, {bad} bad");
        let outcome = done(&scene);
        let [force, sum, moment] = balance(&outcome, "press");
        println!("force {force:.4}, off by {sum:.1e}, {moment:.1e}");
        let file = outcome.body("arch", outcome.summary.steps);
        let status = file.field("contact_status");
        let [open, closed] = [1.0, 2.0].map(|s| status.iter().filter(|x| **x == s).count());
        println!("{open} open, {closed} closed");
        let plain = {
            scene["contacts"]["press"]["gap"] = json!("pointwise");
            balance(&done(&scene), "press")[0]
        };
        println!("pointwise {plain:.4}");
        // The tractions of points that pass an edge between faces do not vanish; that is the one.
        let passed = usize::from(surface == "faces");
        assert!(
            good >= 5 && bad <= passed,
            "{points} {surface}: {good} good, {bad} bad"
        );
        assert!(force > 1.0 && sum < 1e-12 * force && moment < 1e-11 * force);
        assert!(open > 3 && closed > 3, "{open} open, {closed} closed");
        assert!((force / plain - 1.0).abs() < 0.02, "{force} {plain}");
    }
}

/// The clamped plate under a ball (see `plate_under_ball`) needs the same force as with gaps of the points, to half a
/// percent. Measured on 25 x 25 elements: 0.17 % at most; on 40 x 40 it is 621.8 / 2554.5 / 7256.3 / 16602, within 0.2 % of
/// the converged 622 / 2550 / 7248 / 16580.
#[test]
fn the_ball_on_a_plate_needs_the_same_force() {
    let run = |gap: &str| {
        let mut scene = scene_json("ball_on_plate.json");
        set(
            &mut scene,
            "/bodies/plate/mesh/plate/elements",
            vec![25, 25],
        );
        scene["contacts"]
            .as_object_mut()
            .unwrap()
            .values_mut()
            .for_each(|c| {
                c["points"] = json!({"gauss": 3});
                c["gap"] = json!(gap);
            });
        scene["output"] = json!({"every": 0});
        let outcome = done(&scene);
        let f = [0.25, 0.5, 0.75, 1.0].map(|t| -4.0 * outcome.at("force.ball.z", t));
        println!(
            "{gap}: {} iterations {f:.1?}",
            outcome.summary.newton_iterations
        );
        f
    };
    for (a, b) in run("averaged").iter().zip(run("pointwise")) {
        assert!(
            b > 500.0 && (a / b - 1.0).abs() < 5e-3,
            "{a} instead of {b}"
        );
    }
}

/// The walls of a pinched tube, slave and master at once: both sides feel the same.
#[test]
fn a_body_touches_itself() {
    let scene = pinched(2.0 * R - T + 0.6, json!({"gauss": 3}));
    let outcome = done(&averaged(scene));
    let [force, sum] = ["force.push.z", "imbalance.force.walls"].map(|c| outcome.at(c, 1.0));
    let active = *outcome.column("points.active").last().expect("steps");
    println!("force {force}, off by {sum:.1e}, {active} nodes closed");
    assert!(active > 0.0 && force < -0.01 && sum < 1e-12);
}

/// An overclosure that counts as touching presses nothing, and one that shrinks ends where strain ends.
#[test]
fn overclosures_are_averaged_too() {
    let run = |choice: Value, way: f64| {
        let mut scene = averaged(patch(3, 2, json!({"gauss": 3})));
        scene["bodies"]["upper"]["mesh"]["block"]["min"] = json!([0, 0, -0.004]);
        scene["contacts"]["press"]["initial_overclosure"] = choice;
        scene["supports"]["push"]["displacement"]["z"] = json!(format!("-{way}*t"));
        scene["solution"]["newton"]["tolerance"] = json!(1e-10);
        let outcome = done(&scene);
        *outcome.column("force.ground.z").last().unwrap()
    };
    let [held, strained, shrunk] = [
        run(json!("stress_free"), 0.0),
        run(json!("strain"), 0.0),
        run(json!({"shrink": {"until": 1}}), 0.0),
    ];
    println!("{held:e} {strained} {shrunk}");
    assert!(strained > 1000.0);
    assert!(held.abs() < 1e-9 * strained);
    assert!((shrunk / strained - 1.0).abs() < 1e-8);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let history = |threads: u32| {
        let mut scene = averaged(arch_on_plate(2.0, 3, json!({"gauss": 3})));
        scene["solution"]["threads"] = json!(threads);
        let outcome = done(&scene);
        std::fs::read(outcome.folder.path().join("history.csv")).expect("history")
    };
    assert!(history(1) == history(2));
}

/// Only points on the faces have a mean, and enough of them.
#[test]
fn points_that_give_no_mean_are_refused() {
    let at_nodes = averaged(patch(3, 2, json!("nodes")));
    let loaded = scene::parse(&at_nodes.to_string(), "scene.json").expect("well-formed");
    let problems = scene::check(&loaded);
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(
        format!("{:?}", problems[0]).contains("/contacts/press/gap"),
        "{problems:?}"
    );
    let mut one = averaged(patch(2, 2, json!({"gauss": 1})));
    one["bodies"]["upper"]["element"] = json!("q18");
    let loaded = scene::parse(&one.to_string(), "scene.json").expect("well-formed");
    let error = build(&loaded).expect_err("corners have no weight");
    assert_eq!(error.pointer, "/contacts/press/gap");
}

/// Pads that are pressed on each other by a force, with Gauss points below the borders between faces: a point there that hops from one
/// face to the next changes what it carries by more than Newton's method asks for. Points keep their faces, as those of single gaps
/// do: five iterations a step, where it took a thousand, and with friction came to no end.
#[test]
fn points_on_borders_between_faces_do_not_hop() {
    for friction in [None, Some(0.5)] {
        let mut scene = json!({
            "covact": 1,
            "materials": { "rubber": { "neo_hooke": { "E": 4, "nu": 0.45 } } },
            "bodies": {
                "upper": {
                    "mesh": { "block": { "min": [-8, -8, 0], "max": [8, 8, 6], "elements": [3, 3, 2] } },
                    "material": "rubber"
                },
                "lower": {
                    "mesh": { "block": { "min": [-12, -12, -8], "max": [12, 12, 0], "elements": [6, 6, 2] } },
                    "material": "rubber"
                }
            },
            "contacts": { "c": {
                "slave": "upper.bottom", "master": "lower.top", "points": { "gauss": 3 }, "gap": "averaged"
            } },
            "supports": {
                "base": { "on": "lower.bottom", "fixed": true },
                "guide": { "on": "upper.top", "displacement": { "x": 0, "y": 0 } }
            },
            "loads": { "press": { "on": "upper.top", "force": [0, 0, "-60*t"] } },
            "output": { "every": 0 }
        });
        if let Some(mu) = friction {
            scene["contacts"]["c"]["friction"] = json!(mu);
        }
        let outcome = solve(&scene);
        let summary = &outcome.summary;
        assert_eq!(summary.status, RunStatus::Done, "{:?}", summary.reason);
        println!("{friction:?}: {} iterations", summary.newton_iterations);
        assert!(
            summary.newton_iterations <= 80,
            "{}",
            summary.newton_iterations
        );
        let force = outcome.at("slave.force.c.z", 1.0).abs();
        // Viscous forces hold the upper pad along z beside contact.
        assert!((force - 60.0).abs() < 1e-4 * 60.0, "{force}");
    }
}
