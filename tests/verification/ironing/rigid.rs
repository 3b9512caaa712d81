//! The shipped scene `ironing`, and the same slab of quadratic elements.
use super::Slide;
use crate::support::{Outcome, scene_json, set, solve};
use serde_json::{Value, json};

/// Length of an element of the shipped slab; the die slides one in a unit of time, after `PRESSED`.
const ELEMENT: f64 = 0.375;
const PRESSED: f64 = 0.4;

/// The shipped scene over `elements` of its eight, around the same middle, with the steps given (in time).
fn scene(elements: f64, step: f64) -> Value {
    let mut scene = scene_json("ironing.json");
    let end = PRESSED + elements;
    let way = elements * ELEMENT;
    set(
        &mut scene,
        "/surfaces/die/cylinder/center/0",
        6.0 - 0.5 * way,
    );
    let motion = &mut scene["surfaces"]["die"]["motion"]["translation"];
    motion[0] = json!({ "table": [[0, 0], [PRESSED, 0], [end, way]] });
    motion[2] = json!({ "table": [[0, 0], [PRESSED, -0.4], [end, -0.4]] });
    set(&mut scene, "/solution/end_time", end);
    scene["solution"]["step"] = json!({ "initial": step, "max": step, "adaptive": false });
    scene["solution"]["threads"] = json!(1);
    scene["output"] = json!({ "every": 0 });
    scene
}

/// Quadratic elements, each as long as two linear ones, in a slab cut shorter for speed.
fn quadratic(mut scene: Value) -> Value {
    scene["bodies"]["slab"]["element"] = json!("q18");
    let block = &mut scene["bodies"]["slab"]["mesh"]["block"];
    *block = json!({ "min": [2.25, 0, -3], "max": [9.75, ELEMENT, 0], "elements": [10, 1, 2] });
    set(&mut scene, "/contacts/iron/points/gauss", 3);
    scene
}

fn frictionless(mut scene: Value) -> Value {
    let iron = scene["contacts"]["iron"]
        .as_object_mut()
        .expect("a contact");
    iron.remove("friction").expect("friction");
    scene
}

/// Runs it, at the shipped step with at most eight iterations a step on average.
fn slide(scene: &Value) -> (Outcome, Slide) {
    let outcome = solve(scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    let mean = summary.newton_iterations as f64 / f64::from(summary.steps);
    println!(
        "{} steps, {mean:.2} iterations a step, {:.2} s",
        summary.steps, summary.wall_s
    );
    // At the shipped step; longer ones are there for the rate.
    let shipped = scene["solution"]["step"]["max"] == json!(0.05);
    assert!(!shipped || mean < 8.0);
    let slide = Slide::new(&outcome, "die", PRESSED, ELEMENT);
    (outcome, slide)
}

#[test]
fn without_friction_nothing_resists_the_die() {
    for (name, scene) in [
        ("h8", frictionless(scene(4.0, 0.05))),
        ("q18", quadratic(frictionless(scene(4.0, 0.1)))),
    ] {
        let (_, slide) = slide(&scene);
        let (h, v) = slide.mean();
        println!(
            "{name}: mean H {:.1e}, mean |H| {:.2e}, swing {:.2e} of V",
            h / v,
            slide.mean_abs_h(),
            slide.swing() / v
        );
        assert!(v > 0.0 && slide.mean_abs_h() > 0.0);
        assert!(slide.mean_abs_h() < 0.01);
        assert!((h / v).abs() < 1e-4);
    }
}

#[test]
fn the_work_of_the_slide_is_dissipated_or_stored() {
    let residuals = [0.2, 0.1, 0.05].map(|step| {
        let (_, slide) = slide(&scene(4.0, step));
        let (sum, absolute) = slide.energy_residual();
        println!("h8, step {step}: {sum:.2e}, absolute {absolute:.2e}");
        (sum.abs(), absolute)
    });
    // The shipped step.
    assert!(residuals[2].0 < 1e-3);
    // Over both halvings: in a single one nodes that happen to come or go near the end of a step count for more.
    let rate = (residuals[0].1 / residuals[2].1).log2() / 2.0;
    assert!(rate > 1.7, "rate {rate}");
}

#[test]
fn facets_make_noise_and_the_exact_die_none() {
    let exact = scene(4.0, 0.05);
    let mut faceted = exact.clone();
    faceted["surfaces"]["die"]["facets"] = json!({ "kind": "bilinear", "count": [48, 1] });
    let [exact, faceted] = [exact, faceted].map(|scene| {
        let (_, slide) = slide(&scene);
        let (h, v) = slide.mean();
        println!(
            "V {v:.4}, H/V {:.4}, swing {:.2e} of H",
            h / v,
            slide.swing() / h
        );
        slide.swing() / h
    });
    assert!(exact < 0.03);
    assert!(faceted > 0.1 && faceted > 5.0 * exact);
}

#[test]
fn quadratic_elements_keep_both_too() {
    let (_, slide) = slide(&quadratic(scene(4.0, 0.05)));
    let (h, v) = slide.mean();
    println!(
        "q18: V {v:.4}, H/V {:.4}, swing {:.2e} of H, energy {:.2e}",
        h / v,
        slide.swing() / h,
        slide.energy_residual().0
    );
    assert!(slide.swing() / h < 0.03);
    assert!(slide.energy_residual().0.abs() < 1e-3);
}
