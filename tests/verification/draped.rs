//! A heavy sheet laid on hills of eight CAD patches by its weight, held by one edge in the end.
use crate::support::{Outcome, scene_json, set, solve};
use serde_json::json;

/// Width, length, thickness (mm), density (t/mm^3) and gravity (mm/s^2).
const WEIGHT: f64 = 48.0 * 32.0 * 0.5 * 4e-9 * 9810.0;

/// The value of the last step.
fn last(outcome: &Outcome, name: &str) -> f64 {
    outcome.column(name).last().copied().expect("a step")
}

/// It ends as it is shipped, without a word of warning; hills and the edge that is kept carry the weight, forces along the hills are in
/// balance and within the limit of friction, and what the weight has done is stored or rubbed away.
#[test]
fn hills_and_the_kept_edge_carry_the_weight() {
    let mut scene = scene_json("gravity_drape.json");
    scene["output"] = json!({ "every": 0 });
    let outcome = solve(&scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    println!(
        "{} iterations in {} steps, {:.1} CPU s",
        summary.newton_iterations,
        summary.steps,
        summary.cpu_s.unwrap_or(f64::NAN)
    );
    assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
    assert!(summary.newton_iterations <= 250 && summary.accuracy.force_error < 0.01);
    let [hills, kept, hand] = ["hills", "kept", "hand"]
        .map(|name| ["x", "y", "z"].map(|c| last(&outcome, &format!("force.{name}.{c}"))));
    println!("hills {hills:?}, kept {kept:?}, weight {WEIGHT}");
    assert_eq!(hand, [0.0; 3]);
    for c in 0..3 {
        let wanted = if c == 2 { WEIGHT } else { 0.0 };
        let off = hills[c].abs() + kept[c].abs();
        assert!(off > 0.05 * WEIGHT, "{c}");
        // Forces on the sheet, or by it: of one sign.
        assert!(
            ((hills[c] + kept[c]).abs() - wanted).abs() < 1e-6 * WEIGHT,
            "{c}: {hills:?} {kept:?}"
        );
    }
    // Most of it rests on the hills, on many points.
    assert!(hills[2].abs() > 0.6 * WEIGHT && last(&outcome, "points.active") > 60.0);
    // Slopes of up to a third and friction of .4.
    assert!(hills[0].hypot(hills[1]) < 0.75 * hills[2].abs());
    let work = last(&outcome, "energy.external");
    let left = last(&outcome, "energy.imbalance") / work;
    assert!(work > 0.0 && left.abs() < 5e-3, "{left}");
}

/// The same hills as the one surface that they were cut from.
#[test]
fn borders_of_hills_are_not_felt() {
    let [many, one] = ["hills.igs", "hills_one.json"].map(|file| {
        let mut scene = scene_json("gravity_drape.json");
        set(
            &mut scene,
            "/bodies/sheet/mesh/plate/elements",
            json!([18, 12]),
        );
        set(
            &mut scene,
            "/surfaces/hills/cad/file",
            format!("../../assets/cad/{file}"),
        );
        scene["output"] = json!({ "every": 0 });
        let outcome = solve(&scene);
        assert_eq!(outcome.summary.status.name(), "done");
        outcome
    });
    for name in [
        "force.hills.x",
        "force.hills.y",
        "force.hills.z",
        "force.kept.z",
        "energy.dissipated",
    ] {
        let [a, b] = [last(&many, name), last(&one, name)];
        assert!(
            b.abs() > 1e-5 && (a / b - 1.0).abs() < 1e-8,
            "{name}: {a} {b}"
        );
    }
}
