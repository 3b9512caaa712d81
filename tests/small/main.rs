//! Small displacements (`solution.kinematics: "small"`): the limit of the large ones, linear, factorized once for every change
//! of points in contact, and honest about what it neglects.
mod contact;
mod doubts;
mod elements;
mod friction;
mod friction_limit;
mod friction_tangent;
mod refused;
#[path = "../verification/support.rs"]
#[allow(dead_code)]
mod support;

use serde_json::{Value, json};
use support::Outcome;

/// A scene of material `m` (E = 100), with `solution.kinematics` small and the steps of a run in `steps`.
fn scene(nu: f64, parts: Value, steps: u32) -> Value {
    let size = 1.0 / f64::from(steps);
    let mut out = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 100, "nu": nu}}},
        "solution": {"kinematics": "small", "step": {"initial": size, "max": size, "adaptive": false}},
        "output": {"every": 1000}
    });
    for (key, value) in parts.as_object().expect("an object") {
        out[key] = value.clone();
    }
    out
}

/// The same scene with displacements of any size.
fn large(scene: &Value) -> Value {
    let mut out = scene.clone();
    out["solution"]["kinematics"] = json!("large");
    out
}

/// Factorizations of a run.
fn factorizations(outcome: &Outcome) -> u64 {
    outcome.summary.factorizations.values().sum()
}

/// Displacements of a body after the last step.
fn displacements(outcome: &Outcome, body: &str) -> Vec<f64> {
    let file = outcome.body(body, outcome.summary.steps);
    file.field("displacement").to_vec()
}

/// Largest difference of `a` and `factor` times `b`, relative to the largest of `a`, which is not zero.
fn off(a: &[f64], b: &[f64], factor: f64) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    assert!(size > 0.0 && size.is_finite());
    let off = a.iter().zip(b).map(|(a, b)| (a - factor * b).abs());
    off.fold(0.0, f64::max) / size
}
