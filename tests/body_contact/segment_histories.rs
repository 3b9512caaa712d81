//! Friction and multipliers on slave faces that are cut anew at every step.
use crate::blocks::{DELTA, E, EPS, done, patch, pressures};
use crate::friction::{last, layers, stick, turn};
use crate::support::Outcome;
use serde_json::{Value, json};

const MU: f64 = 0.3;

fn segments() -> Value {
    json!({"segments": 2})
}

/// The patch test of sticking ([`stick`]): no kink lies within a piece, so that uniform shear goes through meshes that do not
/// match, where the Gauss points of whole faces are off by percents. What is left is of second order in the shear, as with two
/// half passes.
#[test]
fn meshes_that_do_not_match_stick_in_uniform_shear() {
    let [cut, gauss] = [segments(), json!({"gauss": 3})].map(|points| stick(points, false));
    println!("segments off by {cut:e}, Gauss points by {gauss:e}");
    assert!(cut < 1e-5 && gauss > 1e-3, "{cut:e} {gauss:e}");
}

/// The cut of the first step is that of bodies which have not moved, the next one that of bodies pressed and sheared: forces
/// differ by what that changes, and by nothing from there on.
#[test]
fn turning_a_sticking_pair_changes_nothing_in_its_traction() {
    turn(segments(), 2, "pointwise");
}

/// `H = mu V` over edges of facets, and the work of the drag: what is dissipated is the work that is not stored.
#[test]
fn a_block_that_slides_is_held_back_by_mu_times_its_load() {
    let mut scene = layers([2, 2], [7, 3], "upper.bottom", 0.002, "1.3*max(0, t-0.25)");
    scene["contacts"]["rub"]["points"] = segments();
    let outcome = done(&scene);
    let slide = |side: &str, c: &str| outcome.column(&format!("{side}.force.rub.{c}"));
    let (h, v) = (slide("slave", "x"), slide("slave", "z"));
    let (hm, vm) = (slide("master", "x"), slide("master", "z"));
    let time = outcome.column("time");
    let mut sliding = 0;
    for i in 0..time.len() {
        assert!(v[i].abs() > 1.0);
        assert!((v[i] + vm[i]).abs() < 1e-12 * v[i].abs());
        if time[i] > 0.4 {
            println!("{} {} {}", time[i], h[i], v[i]);
            assert!((h[i].abs() - MU * v[i].abs()).abs() < 1e-9 * v[i].abs());
            assert!((h[i] + hm[i]).abs() < 1e-9 * v[i].abs());
            sliding += 1;
        }
    }
    assert!(sliding >= 4 && last(&outcome, "points.stick") == 0.0);
    // The balance of energies is that of work and friction, to the rule by which both are integrated over steps.
    let [external, imbalance] =
        ["external", "imbalance"].map(|e| last(&outcome, &format!("energy.{e}")));
    println!("work {external}, out of balance by {imbalance:e}");
    assert!(external > 50.0 && imbalance.abs() < 1e-3 * external);
    let mut gauss = scene;
    gauss["contacts"]["rub"]["points"] = json!({"gauss": 10});
    let gauss = last(&done(&gauss), "energy.dissipated");
    let dissipated = last(&outcome, "energy.dissipated");
    println!("dissipated {dissipated}, by 10 x 10 Gauss points {gauss}");
    assert!((dissipated / gauss - 1.0).abs() < 1e-4);
}

/// A block of 3 x 3 elements that is pressed on one of 2 x 2, whose nodes all go sideways, by `points` with multipliers: every
/// step has other pieces.
fn drawn(friction: bool) -> Outcome {
    let mut scene = patch(3, 2, segments());
    scene["bodies"]["lower"]["mesh"]["block"]["min"] = json!([-0.6, 0, -0.5]);
    scene["bodies"]["lower"]["mesh"]["block"]["max"] = json!([1.2, 1, 0]);
    let aside = json!({"x": "0.5*max(0, t-0.25)", "y": 0, "z": 0});
    scene["supports"]["lower_x"] = json!({"on": "lower.top", "displacement": aside.clone()});
    scene["supports"]["ground"] = json!({"on": "lower.bottom", "displacement": aside});
    scene["supports"]
        .as_object_mut()
        .expect("supports")
        .remove("lower_y");
    let down = format!("-{DELTA}*min(1, 4*t)");
    scene["supports"]["push"]["displacement"]["z"] = json!(down);
    let press = &mut scene["contacts"]["press"];
    press["augmentation"] = json!({"gap": 1e-10, "slip": 1e-10, "max": 60});
    if friction {
        press["friction"] = json!({"coulomb": {"mu": MU}});
        press["tangential_penalty"] = json!({"value": EPS});
    }
    scene["solution"]["step"] = json!({"initial": 0.125, "max": 0.125});
    done(&scene)
}

/// Without friction a block on a plane is pressed by `E (e + 3/2 e^2 + 1/2 e^3)`, `e = -DELTA / 0.5` (St. Venant-Kirchhoff, nu = 0),
/// at every point and as long as it is drawn: the multipliers of one cut go over to the next.
#[test]
fn multipliers_stay_with_a_block_that_is_drawn_away() {
    let outcome = drawn(false);
    let e = -DELTA / 0.5;
    let p = -E * (e + 1.5 * e * e + 0.5 * e * e * e);
    let (v, augmented) = (
        outcome.column("slave.force.press.z"),
        outcome.column("augmentations"),
    );
    let [low, high] = pressures(&outcome, "upper");
    println!("{p} {low} {high} {v:?} {augmented:?}");
    assert!((low / p - 1.0).abs() < 1e-7 && (high / p - 1.0).abs() < 1e-7);
    for v in &v[2..] {
        assert!((v / p - 1.0).abs() < 1e-7, "{v} {p}");
    }
    // What the last cut had needs nothing more than to be carried over.
    assert!(augmented[1] >= 1.0 && augmented[4..].iter().all(|n| *n <= 1.0));
}

/// And with friction it is held back by `mu V`, with nothing left of the gap.
#[test]
fn multipliers_with_friction_drag_by_mu_times_the_load() {
    let outcome = drawn(true);
    let slide = |c: &str| outcome.column(&format!("slave.force.press.{c}"));
    let (h, v, time) = (slide("x"), slide("z"), outcome.column("time"));
    let mut sliding = 0;
    for i in (0..time.len()).filter(|&i| time[i] > 0.4) {
        println!("{} {} {}", time[i], h[i], v[i]);
        assert!(v[i] > 1.0 && (h[i] / v[i] - MU).abs() < 1e-9);
        sliding += 1;
    }
    assert!(sliding >= 4);
    assert!(last(&outcome, "penetration.max").abs() < 1e-9);
}
