//! Shipped scenes of NURBS shells that slide, at coarser meshes.
use super::off;
use crate::support::{Outcome, scene_json, set, solve};
use covact::solve::event::Event;
use serde_json::json;

/// A scene that must end at the defaults with no more than 12 iterations a step on average, failed ones included, and without
/// warnings.
fn run_to_end(scene: &serde_json::Value) -> Outcome {
    let outcome = run_with_peaks(scene);
    let warnings = &outcome.summary.warnings;
    assert!(warnings.is_empty(), "{warnings:?}");
    outcome
}

/// The same where a force may have had its peak between two steps, which is a warning.
fn run_with_peaks(scene: &serde_json::Value) -> Outcome {
    let outcome = solve(scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    let sum = |name: &str| outcome.column(name).iter().sum::<f64>();
    let steps = outcome.column("time").len() as f64;
    let mean = (sum("iterations") + sum("iterations.failed")) / steps;
    println!("{steps} steps, {mean:.1} iterations a step");
    assert!(mean <= 12.0, "{mean} iterations a step");
    outcome
}

/// `tubes_crossed_nurbs`: forces and moments of both tubes balance, through pressing and drawing; the tubes stick, then the upper one
/// slides.
#[test]
fn crossed_tubes_balance() {
    let mut scene = scene_json("tubes_crossed_nurbs.json");
    for body in ["lower", "upper"] {
        set(&mut scene, &format!("/bodies/{body}/nurbs/size"), 10);
    }
    scene["solution"]["end_time"] = json!(1.3);
    scene["output"] = json!({"every": 0});
    let outcome = run_to_end(&scene);
    let last = |name: &str| *outcome.column(name).last().expect("steps");
    let [x, y, z] = ["x", "y", "z"].map(|c| last(&format!("slave.force.tubes.{c}")));
    let force = (x * x + y * y + z * z).sqrt();
    let worst = |name: &str| outcome.column(name).into_iter().fold(0.0, f64::max);
    // The tubes are 60 long.
    let left = [
        worst("imbalance.force.tubes") / force,
        worst("imbalance.moment.tubes") / (60.0 * force),
    ];
    println!("force {force}, left {left:?}");
    assert!(force > 1.0 && left.iter().all(|l| *l < 1e-12), "{left:?}");
    // Coulomb's law on a tube that bends in where it is pressed.
    let ratio = (y / z).abs();
    assert!(last("points.slip") > 0.0 && ratio > 0.2, "{ratio}");
}

/// `tubes_crossed_nurbs` with tighter tolerances: once no point switches any more, each residual is about the square of the one before,
/// with both tubes bending and friction between them.
#[test]
fn crossed_tubes_converge_quadratically() {
    let mut scene = scene_json("tubes_crossed_nurbs.json");
    for body in ["lower", "upper"] {
        set(&mut scene, &format!("/bodies/{body}/nurbs/size"), 10);
    }
    scene["solution"]["end_time"] = json!(1.3);
    scene["solution"]["newton"] = json!({"tolerance": 1e-11});
    scene["output"] = json!({"every": 0});
    let outcome = run_to_end(&scene);
    // Pairs of residuals without a change in between, from where Newton's method is near its end to where rounding is left, which is
    // 1e-11 of the forces.
    let mut pairs = Vec::new();
    let mut last = None;
    for event in &outcome.events {
        let Event::Iteration {
            iteration,
            residual,
            changed,
            line_search,
            ..
        } = event
        else {
            continue;
        };
        let follows = *iteration > 1 && *changed == 0 && *line_search == 1.0;
        if let Some(before) = last.filter(|before| follows && *before < 1e-2 && *before > 1e-5) {
            pairs.push([before, *residual]);
        }
        last = (*changed == 0).then_some(*residual);
    }
    let factors: Vec<f64> = pairs
        .iter()
        .map(|[a, b]| (b - 3e-11).max(0.0) / (a * a))
        .collect();
    println!("{factors:.1?}");
    assert!(pairs.len() > 20, "{pairs:?}");
    // The same factor from 4e-3 to 1e-6: of a rate that is linear, by a tenth, it would grow to 1e5.
    assert!(factors.iter().all(|f| *f < 200.0), "{pairs:?}");
}

/// `sheet_over_hills`: the same hills as one patch take the same forces while the sheet is drawn over the borders of the eight.
#[test]
fn a_sheet_over_hills_does_not_feel_borders() {
    let run = |file: &str| {
        let mut scene = scene_json("sheet_over_hills.json");
        set(&mut scene, "/bodies/sheet/nurbs/size", 4);
        let path = format!("../../assets/cad/{file}");
        set(&mut scene, "/surfaces/hills/cad/file", path);
        scene["solution"]["end_time"] = json!(3.5);
        scene["solution"]["newton"] = json!({"tolerance": 1e-10});
        scene["output"] = json!({"every": 0});
        run_to_end(&scene)
    };
    let [eight, one] = ["hills.igs", "hills_one.json"].map(run);
    for name in [
        "force.hills.x",
        "force.hills.z",
        "energy.dissipated",
        "energy.internal",
    ] {
        let [a, b] = [&eight, &one].map(|o| o.at(name, 3.5));
        println!("{name}: {a} {b}");
        assert!(a.abs() > 0.1 && off(a, b) < 1e-6, "{name}: {a} {b}");
    }
}

/// `snap_clip_nurbs`: both strips are unstressed before and after, so that friction takes all the work of pushing; the wall
/// bears what the push exerts.
#[test]
fn a_clip_snaps() {
    let mut scene = scene_json("snap_clip_nurbs.json");
    for body in ["hook", "catch"] {
        set(&mut scene, &format!("/bodies/{body}/nurbs/size"), 3);
    }
    scene["output"] = json!({"every": 0});
    // The line of contact goes from point to point, which changes the force by some percent.
    let outcome = run_with_peaks(&scene);
    let peak = |w: &String| w.contains("to see its peak");
    assert!(outcome.summary.warnings.iter().all(peak));
    let [work, friction, stored] = ["energy.external", "energy.dissipated", "energy.internal"]
        .map(|name| outcome.at(name, 1.0));
    println!("work {work}, friction {friction}, stored {stored}");
    assert!(
        friction > 0.1 && off(work, friction) < 1e-2,
        "{work} {friction}"
    );
    assert!(stored < 1e-10 * work);
    let all = ["force.push.x", "force.wall.x"].map(|name| outcome.column(name));
    let largest = all[0].iter().fold(0.0, |m: f64, f| m.max(f.abs()));
    // Held back at first, drawn in behind the bumps.
    assert!(
        all[0].iter().any(|f| *f > 0.1 * largest) && largest > 0.03,
        "{largest}"
    );
    for (push, wall) in all[0].iter().zip(&all[1]) {
        assert!((push + wall).abs() < 1e-6 * largest, "{push} {wall}");
    }
}
