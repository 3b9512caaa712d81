//! The rule by itself, for errors that are made up.
use super::*;
use crate::model::build::build;
use crate::scene;
use serde_json::json;

/// A block under two tools, both with automatic penalties.
fn model() -> Model {
    let tool = |z: f64| json!({ "plane": { "center": [0.5, 0.5, z], "size": [4, 4] }, "side": { "point": [0.5, 0.5, 0.5] } });
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1e4, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1] } }, "material": "m"
        } },
        "surfaces": { "above": tool(1.0), "below": tool(0.0) },
        "contacts": {
            "above": { "slave": "block.top", "master": "above" },
            "below": { "slave": "block.bottom", "master": "below", "accuracy": 1e-3 }
        },
        "supports": { "side": { "on": "block.x_min", "fixed": true } }
    });
    let loaded = scene::parse(&scene.to_string(), "scene.json").unwrap_or_else(|e| panic!("{e}"));
    build(&loaded).unwrap_or_else(|e| panic!("{e}"))
}

fn errors(forces: [f64; 2], sunk: [f64; 2]) -> Errors {
    Errors {
        forces: forces.to_vec(),
        sunk: sunk.to_vec(),
    }
}

#[test]
fn only_pairs_that_make_the_error_are_raised() {
    let (model, rule) = (model(), PenaltyRule::new(&model()));
    let raised = |forces, sunk| {
        let mut penalties = vec![1.0, 1.0];
        let any = rule.raise(&model, &errors(forces, sunk), false, &mut penalties);
        assert_eq!(any, penalties != [1.0, 1.0]);
        penalties
            .iter()
            .map(|p| (p * 1e6).round() / 1e6)
            .collect::<Vec<_>>()
    };
    // Within the band of both; above that of the more accurate one, which makes next to nothing of it, and all of it.
    assert_eq!(raised([1e-3, 1e-3], [0.0; 2]), [1.0, 1.0]);
    assert_eq!(raised([9e-3, 1e-4], [0.0; 2]), [1.0, 1.0]);
    assert_eq!(raised([0.0, 5e-3], [0.0; 2]), [1.0, 5.0]);
    // Towards the accuracy asked for; farther at once where contact gives way more than the block.
    assert_eq!(raised([0.04, 0.0], [0.0; 2]), [10.0, 1.0]);
    assert_eq!(raised([0.8, 0.0], [0.0; 2]), [100.0, 1.0]);
    assert_eq!(raised([8.0, 0.0], [0.0; 2]), [2000.0, 1.0]);
    // Too deep, however small the error.
    assert_eq!(raised([1e-6, 1e-6], [0.0, 2.0]), [1.0, 20.0]);
}

/// What the first penalty becomes for an error of its pair.
fn raised(rule: &PenaltyRule, model: &Model, again: bool, error: f64, from: f64) -> f64 {
    let mut penalties = vec![from; 2];
    let errors = errors([error, 0.0], [0.0; 2]);
    rule.raise(model, &errors, again, &mut penalties);
    (penalties[0] * 1e6).round() / 1e6
}

#[test]
fn a_penalty_that_did_not_serve_is_approached_by_halves_and_forgotten() {
    let (model, mut rule) = (model(), PenaltyRule::new(&model()));
    rule.reject(&[1.0, 1.0], &[100.0, 1.0], None);
    let of = |rule: &PenaltyRule, again, error| raised(rule, &model, again, error, 1.0);
    // Half as far, by the logarithm; not at once in a later step, unless the error is large.
    assert_eq!(of(&rule, true, 0.02), 5.0);
    assert_eq!(of(&rule, true, 0.2), 10.0);
    assert_eq!(of(&rule, false, 0.02), 1.0);
    assert_eq!(of(&rule, false, 0.2), 10.0);
    let mut penalties = vec![1.0, 1.0];
    let none = errors([0.0; 2], [0.0; 2]);
    for _ in 0..SOON {
        rule.lower(&model, &none, 0, &mut penalties);
    }
    // A large error is not borne for long, a small one is.
    assert_eq!(of(&rule, false, 0.2), 50.0);
    assert_eq!(of(&rule, true, 0.02), 5.0);
    for _ in SOON..FORGOTTEN {
        rule.lower(&model, &errors([0.0; 2], [0.0; 2]), 0, &mut penalties);
    }
    assert_eq!(of(&rule, false, 0.2), 50.0);
    assert_eq!(penalties, [1.0, 1.0]);
}

/// A penalty that did not lower a small error is tried again where the error has grown; one that could not be followed is not.
#[test]
fn a_penalty_that_did_not_help_is_tried_under_a_larger_error() {
    let (model, mut rule) = (model(), PenaltyRule::new(&model()));
    rule.reject(&[1.0, 1.0], &[100.0, 1.0], Some(0.08));
    assert_eq!(raised(&rule, &model, false, 0.1, 1.0), 10.0);
    assert!(raised(&rule, &model, false, 3.0, 1.0) > 100.0);
    rule.reject(&[1.0, 1.0], &[100.0, 1.0], None);
    assert_eq!(raised(&rule, &model, false, 3.0, 1.0), 10.0);
    // What was kept is kept by its own error.
    rule.reject(&[1.0, 1.0], &[100.0, 1.0], Some(0.08));
    rule.keep(&model, 0, 1.0, 5.0);
    assert_eq!(raised(&rule, &model, false, 3.0, 1.0), 1.0);
}

#[test]
fn a_penalty_that_is_kept_is_raised_no_more() {
    let (model, mut rule) = (model(), PenaltyRule::new(&model()));
    assert_eq!(raised(&rule, &model, false, 8.0, 3.0), 6000.0);
    rule.keep(&model, 0, 3.0, 5.0);
    let none = errors([0.0; 2], [0.0; 2]);
    for _ in 0..2 * FORGOTTEN {
        rule.lower(&model, &none, 0, &mut [3.0, 3.0]);
    }
    for error in [0.02, 0.8, 8.0] {
        for again in [false, true] {
            assert_eq!(raised(&rule, &model, again, error, 3.0), 3.0);
        }
    }
    // Where the error has grown that far, it is too soft after all; one that was left behind is kept no more.
    assert_eq!(raised(&rule, &model, false, 11.0, 3.0), 8400.0);
    let deep = errors([0.02, 0.0], [2.0, 0.0]);
    assert!(rule.raise(&model, &deep, false, &mut [3.0, 3.0]));
    assert!(rule.left_behind(&[3.0, 9.0]).next().is_none());
    assert!(rule.left_behind(&[8400.0, 9.0]).eq([0]));
    rule.remember(&none, &[3.0, 9.0], &[8400.0, 9.0]);
    assert_eq!(raised(&rule, &model, false, 8.0, 8400.0), 1.68e7);
}

/// A step that fails softens what is far stiffer than asked for, once, by what its error was at the last accepted step.
#[test]
fn a_failed_step_eases_what_is_too_stiff() {
    let (model, mut rule) = (model(), PenaltyRule::new(&model()));
    let mut penalties = vec![1e6, 1e6];
    assert!(!rule.ease(&model, &mut penalties));
    rule.remember(&errors([4e-6, 2e-3], [0.0; 2]), &[1e6, 1e6], &[1e6, 1e6]);
    assert!(rule.ease(&model, &mut penalties));
    assert_eq!(penalties, [1e3, 1e6]);
    // Its error is by first order what was asked for.
    assert!(!rule.ease(&model, &mut penalties));
    // The error that was measured before a penalty rose by ten.
    rule.remember(&errors([4e-4, 2e-3], [0.0; 2]), &[1e3, 1e6], &[1e4, 1e6]);
    penalties[0] = 1e4;
    assert!(rule.ease(&model, &mut penalties));
    assert_eq!(penalties, [100.0, 1e6]);
}

#[test]
fn what_costs_iterations_for_no_error_is_lowered() {
    let model = model();
    let lowered = |error: f64, iterations: u32| {
        let (mut rule, mut penalties) = (PenaltyRule::new(&model), vec![1.0, 1.0]);
        for step in 1..=IDLE {
            let any = rule.lower(
                &model,
                &errors([error, 0.0], [0.0; 2]),
                iterations,
                &mut penalties,
            );
            assert_eq!(any, step == IDLE && penalties[0] != 1.0);
        }
        (penalties[0] * 1e6).round() / 1e6
    };
    assert_eq!(lowered(4e-5, MANY + 1), 0.01);
    assert_eq!(lowered(2e-4, MANY + 1), 0.05);
    assert_eq!(lowered(4e-5, MANY), 1.0);
    assert_eq!(lowered(1e-3, MANY + 1), 1.0);
    assert_eq!(lowered(0.0, MANY + 1), 1.0);
}

#[test]
fn what_smaller_steps_do_not_help_is_accepted_at_last() {
    let model = model();
    let told = |error, cuts| untenable(&model, &errors([error, 0.0], [0.0; 2]), cuts);
    assert_eq!(told(7e-3, 0), None);
    assert_eq!(told(0.02, 0), Some(0.02));
    assert_eq!(told(0.02, 2), None);
    assert_eq!(told(0.5, 2), Some(0.5));
    assert_eq!(told(0.5, 2 * RELENTS + 1), None);
}
