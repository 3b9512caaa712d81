//! What slave points remember under friction: nothing is lost, doubled or invented on the way.
use crate::common::cad_file;
use crate::friction::{block, book, done, plane, table, work};
use crate::support::Outcome;
use covact::solve::event::Event;
use covact_geometry::primitives::{self, sphere, sphere_without_poles};
use covact_geometry::{NurbsPatch, Vec3};
use serde_json::{Value, json};

/// Pressed in until t = 0.25 while it is drawn along x, and back.
fn drawn() -> Value {
    json!({
        "x": { "table": [[0, 0], [0.75, 0.3], [1, 0.25]] }, "y": 0,
        "z": { "table": [[0, 0], [0.25, -0.05], [1, -0.05]] }
    })
}

/// Columns that friction shows in.
const COLUMNS: [&str; 7] = [
    "force.tool.x",
    "force.tool.z",
    "energy.internal",
    "energy.contact",
    "energy.friction",
    "energy.dissipated",
    "pressure.max",
];

/// Largest difference of the columns at equal steps, relative to the largest value of each.
fn difference(a: &Outcome, b: &Outcome) -> f64 {
    let mut largest = 0.0f64;
    for outcome in [a, b] {
        let cuts: Vec<&Event> = (outcome.events.iter())
            .filter(|e| matches!(e, Event::StepCut { .. }))
            .collect();
        assert!(cuts.is_empty(), "{cuts:?}");
    }
    for name in COLUMNS {
        let (a, b) = (a.column(name), b.column(name));
        assert_eq!(a.len(), b.len());
        let scale = a.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        assert!(scale > 0.0, "{name} is zero throughout");
        for (a, b) in a.iter().zip(&b) {
            largest = largest.max((a - b).abs() / scale);
        }
    }
    largest
}

/// Runs the drawn block on patches from a file.
fn on_patches(patches: &[NurbsPatch], changes: impl Fn(&mut Value)) -> Outcome {
    on_patches_with(patches, 0.3, changes)
}

fn on_patches_with(patches: &[NurbsPatch], mu: f64, changes: impl Fn(&mut Value)) -> Outcome {
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("tool.cad.json");
    cad_file(patches, &file);
    let mut tool = json!({ "cad": { "file": file }, "side": { "point": [0, 0, 5] }, "depth": 0.4 });
    changes(&mut tool);
    done(&block(tool, drawn(), json!(mu), 40))
}

#[test]
fn borders_knots_and_poles_of_a_sphere_do_not_exist_for_friction() {
    let center = Vec3::new(0.1, 0.05, -2.0);
    let at = |axis: Vec3| sphere(2.0, center, axis).unwrap();
    let reference = on_patches(&[at(Vec3::new(1.0, -2.0, 0.5))], |_| {});
    assert!(reference.at("points.slip", 0.75) > 10.0);
    let y = at(Vec3::y());
    // The pole under the middle of the block, a seam and knots along its way.
    let z = at(Vec3::z());
    for (name, patches) in [
        ("y", vec![y.clone()]),
        ("swapped", vec![y.swapped().unwrap()]),
        ("reversed", vec![y.reversed(0).unwrap()]),
        ("pole", vec![z.clone()]),
        ("pole, reversed", vec![z.reversed(1).unwrap()]),
        (
            "six",
            sphere_without_poles(2.0, center, Vec3::new(1.0, 0.2, 1.0))
                .unwrap()
                .to_vec(),
        ),
    ] {
        let d = difference(&reference, &on_patches(&patches, |_| {}));
        println!("{name}: {d:.1e}");
        assert!(d < 1e-8, "{name}: {d:e}");
    }
}

#[test]
fn borders_between_patches_and_facets_of_a_plane_do_not_exist_for_friction() {
    let reference = done(&block(plane(), drawn(), json!(0.3), 40));
    // Four rectangles that meet under the block, their parameters turned and reversed.
    let piece =
        |x: f64, y: f64| primitives::plane(Vec3::new(x, y, 0.0), Vec3::z(), [4.0, 4.0]).unwrap();
    let patches = [
        piece(-1.93, -1.98),
        piece(2.07, -1.98).swapped().unwrap(),
        piece(-1.93, 2.02).reversed(0).unwrap(),
        piece(2.07, 2.02).swapped().unwrap().reversed(1).unwrap(),
    ];
    let four = on_patches(&patches, |_| {});
    let d = difference(&reference, &four);
    println!("four patches: {d:.1e}");
    assert!(d < 1e-8, "{d:e}");
    for kind in ["bilinear", "biquadratic", "smooth"] {
        let mut tool = plane();
        tool["facets"] = json!({ "kind": kind, "count": [57, 43] });
        let facets = done(&block(tool, drawn(), json!(0.3), 40));
        let d = difference(&reference, &facets);
        println!("{kind}: {d:.1e}");
        assert!(d < 1e-8, "{kind}: {d:e}");
    }
}

/// Forces that lean over a convex edge turn at once as a point passes it; the block jumps, with friction or without, and what it
/// had stored for that is gone (the same for all steps: 1.5 % of the dissipation with 40 facets). Friction must lose no more.
#[test]
fn friction_loses_nothing_at_a_crease_and_at_facet_edges() {
    // A shallow roof: a ridge under the block, across its way; and a cylinder made of few flat facets.
    let slope = 0.1f64;
    let half = |sign: f64| {
        let n = Vec3::new(sign * slope, 0.0, 1.0).normalize();
        let along = Vec3::new(n.z, 0.0, -n.x);
        let middle = Vec3::new(0.11, 0.0, 0.0) + along * sign * 2.0;
        primitives::plane(middle, n, [4.0, 4.0]).unwrap()
    };
    let roof = |mu: f64| {
        on_patches_with(&[half(1.0), half(-1.0)], mu, |tool| {
            tool["placement"] = json!({ "translation": [0, 0, 0.02] });
        })
    };
    let facets = |mu: f64| {
        let tool = json!({
            "cylinder": { "radius": 2, "length": 4, "center": [0.03, 0, -2], "axis": [0, 1, 0] },
            "facets": { "kind": "bilinear", "count": [40, 3] },
            "side": { "point": [0, 0, 5] }
        });
        done(&block(tool, drawn(), json!(mu), 128))
    };
    let lost = |outcome: &Outcome| {
        let way = [[0.0, 0.0], [0.75, 0.3], [1.0, 0.25]];
        let down = [[0.0, 0.0], [0.25, -0.05], [1.0, -0.05]];
        let put_in = work(outcome, &outcome.column("force.top.x"), |t| table(&way, t))
            + work(outcome, &outcome.column("force.top.z"), |t| table(&down, t));
        put_in - book(outcome)
    };
    for (name, with, without) in [
        ("roof", roof(0.3), roof(0.0)),
        ("facets", facets(0.3), facets(0.0)),
    ] {
        let dissipated = with.at("energy.dissipated", 1.0);
        let [with, without] = [lost(&with), lost(&without)].map(|e| e / dissipated);
        println!("{name}: {with:.1e} of {dissipated:.3e}, {without:.1e} without friction");
        assert!(dissipated > 0.1);
        assert!((with - without).abs() < 5e-3, "{name}: {with} {without}");
    }
}

#[test]
fn a_point_that_comes_back_starts_without_traction_and_keeps_its_path() {
    // Pressed and drawn, lifted, moved on, put down again.
    let top = json!({
        "x": { "table": [[0, 0], [0.2, 0], [0.4, 0.1], [0.5, 0.1], [0.6, 0.2], [1, 0.2]] }, "y": 0,
        "z": { "table": [[0, 0], [0.2, -0.02], [0.4, -0.02], [0.5, 0.05], [0.6, 0.05], [0.8, -0.02], [1, -0.02]] }
    });
    let mut scene = block(plane(), top.clone(), json!(0.3), 20);
    scene["output"] = json!({ "every": 1 });
    let outcome = done(&scene);
    assert!(outcome.at("force.tool.x", 0.4).abs() > 0.1);
    for t in [0.5, 0.55, 0.6, 0.65] {
        assert_eq!(
            outcome.at("points.stick", t) + outcome.at("points.slip", t),
            0.0,
            "{t}"
        );
        assert_eq!(outcome.at("force.tool.x", t), 0.0);
        assert_eq!(outcome.at("energy.friction", t), 0.0);
        assert_eq!(
            outcome.at("energy.dissipated", t),
            outcome.at("energy.dissipated", 0.5)
        );
    }
    // Pressed alone, a block presses to all sides alike; what is left of the first time would show.
    let (x, z) = (
        outcome.at("force.tool.x", 1.0),
        outcome.at("force.tool.z", 1.0),
    );
    assert!(z > 0.1 && x.abs() < 1e-8 * z, "{x:e} {z}");
    let path = |outcome: &Outcome, step: u32| {
        let file = outcome.body("block", step);
        file.field("slip").iter().fold(0.0f64, |a, b| a.max(*b))
    };
    let mut fine = block(plane(), top, json!(0.3), 200);
    fine["output"] = json!({ "every": 40 });
    let fine = done(&fine);
    let [drawn, lifted, put_down] = [8, 12, 20].map(|step| path(&outcome, step));
    let [all_drawn, all_lifted, all_put_down] = [8, 12, 20].map(|step| path(&fine, 10 * step));
    println!("{drawn} {lifted} {put_down}, in fine steps {all_drawn} {all_lifted} {all_put_down}");
    assert!(drawn > 0.08 && drawn < 0.1 + 1e-9, "{drawn}");
    // Lifting lets the sides slide back and releases what was elastic, putting down adds a little sliding to the sides.
    for ([before, after], [from, to]) in [
        ([drawn, lifted], [all_drawn, all_lifted]),
        ([lifted, put_down], [all_lifted, all_put_down]),
    ] {
        assert!(after >= before && after - before < 1.2 * (to - from) + 1e-3);
    }
}

#[test]
fn a_step_that_is_cut_leaves_no_trace_in_the_last_bit() {
    let run = |steps: u32, iterations: u32| {
        let top = json!({ "x": "0.2*t", "y": 0, "z": "-0.15*t" });
        let mut scene = block(plane(), top, json!(0.3), steps);
        scene["solution"]["newton"] = json!({ "tolerance": 1e-5, "max_iterations": iterations });
        done(&scene)
    };
    // The whole way at once is too much for that many iterations; a part of it is not.
    let cut = run(1, 4);
    let first = cut.column("time")[0];
    let at_once = run((1.0 / first).round() as u32, 4);
    let cuts = cut
        .events
        .iter()
        .filter(|e| matches!(e, Event::StepCut { .. }))
        .count();
    println!(
        "{cuts} cuts; {:?} and {:?}",
        at_once.column("time"),
        cut.column("time")
    );
    assert!(cuts > 0 && at_once.at("cuts", first) == 0.0);
    assert_eq!(first, at_once.column("time")[0]);
    for name in &cut.history.columns {
        if name != "cuts" && name != "iterations.failed" {
            let (a, b) = (at_once.at(name, first), cut.at(name, first));
            assert!(a.to_bits() == b.to_bits(), "{name}: {a:e} {b:e}");
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let run = |threads: u32| {
        let mut scene = block(plane(), drawn(), json!(0.3), 8);
        scene["bodies"]["block"]["mesh"]["block"]["elements"] = json!([9, 5, 1]);
        scene["solution"]["threads"] = json!(threads);
        let outcome = done(&scene);
        assert!(outcome.at("points.slip", 0.75) > 0.0);
        std::fs::read(outcome.folder.path().join("history.csv")).expect("history")
    };
    let one = run(1);
    for threads in [2, 3] {
        assert!(one == run(threads), "{threads} threads differ");
    }
}

#[test]
fn a_surface_that_turns_carries_what_sticks_to_it() {
    // Pressed on until t = 0.2, then block and surface turn by 90 degrees and move on together.
    for (axis, name) in [
        ([0, 0, 1], "about the normal"),
        ([0, 1, 0], "with the normal"),
    ] {
        let angle = json!({ "table": [[0, 0], [0.2, 0], [1, 90]] });
        let mut tool = plane();
        let moved = json!({ "table": [[0, 0], [0.2, 0], [1, 0.7]] });
        tool["motion"] = json!({
            "rotation": { "axis": axis, "angle": angle },
            "translation": [moved, 0, 0]
        });
        // Radians of the turn, and how far the top was pressed and sheared before.
        let a = "(max(t-0.2,0)/0.8*pi/2)";
        let s = "(max(t-0.2,0)/0.8*0.7)";
        let (dx, dz) = ("(0.002*min(t/0.2,1))", "(-0.02*min(t/0.2,1))");
        let top = match name {
            "about the normal" => json!({
                "x": format!("cos({a})*(x+{dx}) - sin({a})*y - x + {s}"),
                "y": format!("sin({a})*(x+{dx}) + cos({a})*y - y"),
                "z": dz
            }),
            _ => json!({
                "x": format!("cos({a})*(x+{dx}) + sin({a})*(z+{dz}) - x + {s}"),
                "y": 0,
                "z": format!("-sin({a})*(x+{dx}) + cos({a})*(z+{dz}) - z")
            }),
        };
        let mut scene = block(tool, top, json!(0.8), 40);
        scene["solution"]["stops"] = json!([0.2]);
        let outcome = done(&scene);
        let slid = outcome.at("energy.dissipated", 0.2);
        for column in ["internal", "contact", "friction"] {
            let name = format!("energy.{column}");
            let (before, after) = (outcome.at(&name, 0.2), outcome.at(&name, 1.0));
            assert!(
                before > 0.0 && (after / before - 1.0).abs() < 1e-7,
                "{name}: {before} {after}"
            );
        }
        assert!(
            outcome.at("energy.dissipated", 1.0) - slid
                <= 1e-9 * outcome.at("energy.friction", 1.0)
        );
        let force = |t: f64| ["x", "y", "z"].map(|c| outcome.at(&format!("force.tool.{c}"), t));
        let (b, e) = (force(0.2), force(1.0));
        let turned = match name {
            "about the normal" => [-b[1], b[0], b[2]],
            _ => [b[2], b[1], -b[0]],
        };
        assert!(b[0].abs() > 1e-3 * b[2].abs(), "nothing is sheared");
        println!("{name}: {b:?} {e:?}");
        for c in 0..3 {
            assert!(
                (turned[c] - e[c]).abs() < 1e-7 * b[2].abs(),
                "{name}: {turned:?} {e:?}"
            );
        }
    }
}

#[test]
fn a_raised_penalty_leaves_the_friction_of_before() {
    // Pressed, sheared without sliding, then pressed on until the automatic penalty is raised.
    let top = json!({
        "x": { "table": [[0, 0], [0.2, 0], [0.4, 0.02], [1, 0.02]] }, "y": 0,
        "z": { "table": [[0, 0], [0.2, -0.04], [0.4, -0.04], [1, -0.2]] }
    });
    let mut scene = block(plane(), top, json!(5.0), 40);
    scene["contacts"]["slide"]["penalty"] = json!("auto");
    // Stiffens as it is pressed, so that the error passes the bound on the way.
    scene["materials"]["rubber"] = json!({ "neo_hooke": { "E": 100, "nu": 0.3 } });
    scene["bodies"]["block"]["mesh"]["block"]["elements"] = json!([5, 2, 4]);
    scene["contacts"]["slide"]["accuracy"] = json!(0.06);
    let outcome = done(&scene);
    let raised = (outcome.events.iter())
        .filter(|e| matches!(e, Event::PenaltyRuled { step, .. } if *step > 1))
        .count();
    let (times, force) = (outcome.column("time"), outcome.column("force.tool.x"));
    println!("{raised} raises, {:?}", outcome.summary.warnings);
    println!("{force:?}");
    assert!(raised > 0);
    let mut smooth = 0.0f64;
    for (t, f) in times.windows(3).zip(force.windows(3)) {
        if t[0] > 0.4 - 1e-9 {
            smooth = smooth.max((f[2] - 2.0 * f[1] + f[0]).abs() / f[1].abs());
        }
    }
    println!("largest kink {smooth:.1e}");
    // By the error of a tenth that the raise takes away, not by the factor of more than two that the penalty is raised by.
    assert!(smooth < 0.1, "{smooth}");
}

#[test]
fn a_coefficient_that_falls_to_zero_lets_everything_go() {
    let mu = json!({ "table": [[0, 0.3], [0.4, 0.3], [0.6, 0], [1, 0]] });
    let top = json!({
        "x": { "table": [[0, 0], [0.2, 0], [0.4, 0.05], [1, 0.05]] }, "y": 0,
        "z": { "table": [[0, 0], [0.2, -0.02], [1, -0.02]] }
    });
    let outcome = done(&block(plane(), top, mu, 40));
    assert!(outcome.at("force.tool.x", 0.4).abs() > 0.1);
    let released = outcome.at("energy.dissipated", 0.6);
    for t in [0.6, 0.7, 1.0] {
        let (x, z) = (outcome.at("force.tool.x", t), outcome.at("force.tool.z", t));
        assert!(x.abs() < 1e-8 * z, "{t}: {x:e}");
        assert_eq!(outcome.at("energy.friction", t), 0.0);
        assert!((outcome.at("energy.dissipated", t) - released).abs() < 1e-12 * released);
    }
    // What the block gives back from t = 0.4 on, where nothing moves it any more, is dissipated.
    let stored = |t: f64| {
        ["internal", "contact", "friction"]
            .iter()
            .map(|p| outcome.at(&format!("energy.{p}"), t))
            .sum::<f64>()
    };
    let (gave, took) = (
        stored(0.4) - stored(1.0),
        released - outcome.at("energy.dissipated", 0.4),
    );
    println!("{gave:.6e} {took:.6e}");
    assert!(
        gave > 0.0 && (took / gave - 1.0).abs() < 0.02,
        "{gave} {took}"
    );
}
