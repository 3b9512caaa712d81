//! Facets against the exact surface: a cylinder of radius 10 pressed into an elastic block in plane strain (half of it),
//! the same slave mesh for all.
//!
//! ```text
//!        ( cylinder )        facets of length s in place of the circle
//!   |--------v--------|      contact zone a few facets wide, 4 and more slave points a facet
//!   |      block      |      held below, symmetric at x = 0
//! ```
//!
//! A chord of length s of a circle of radius R is s^2 / (8 R) off its arc in the middle and two thirds of that in the
//! mean, so the faceted cylinder stands back by `s^2 / (12 R)` and lacks the force `dF/d(depth) s^2 / (12 R)`: second
//! order. A parabola through the ends and the middle of an arc, and the cubic with the slopes of the mean of both
//! neighbouring chords, are off by the fourth power.
use crate::support::{Outcome, solve};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

const R: f64 = 10.0;
const DEPTH: f64 = 0.6;

/// `facets` per quarter of the circle.
fn press(facets: Value) -> Outcome {
    let mut scene = json!({
        "covact": 1,
        "materials": { "soft": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": {
                "min": [0, 0, -4], "max": [6, 0.5, 0], "elements": [48, 1, 8],
                "spacing": ["uniform", "uniform", { "geometric": { "ratio": 0.25 } }]
            } },
            "material": "soft", "element": "h8_displacement"
        } },
        "surfaces": { "tool": {
            "cylinder": { "radius": R, "length": 3, "center": [0, 0.25, R], "axis": [0, 1, 0] },
            "motion": { "translation": [0, 0, format!("-{DEPTH}*t")] }
        } },
        "contacts": { "press": {
            "slave": "block.top", "master": "tool",
            "points": { "gauss": 3 }, "penalty": { "value": 4000 }
        } },
        "supports": {
            "below": { "on": "block.bottom", "fixed": true },
            "symmetry": { "on": "block.x_min", "symmetry": "x" },
            "front": { "on": "block.y_min", "symmetry": "y" },
            "back": { "on": "block.y_max", "symmetry": "y" }
        },
        "solution": { "step": { "initial": 0.25, "max": 0.25 }, "stops": [0.9] },
        "output": { "every": 0 }
    });
    if !facets.is_null() {
        scene["surfaces"]["tool"]["facets"] = facets;
    }
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "done");
    outcome
}

fn force(outcome: &Outcome) -> f64 {
    -outcome.at("force.tool.z", 1.0)
}

fn errors(kind: &str, per_quarter: &[u32], exact: f64) -> Vec<f64> {
    (per_quarter.iter())
        .map(|n| {
            let outcome = press(json!({ "kind": kind, "count": [4 * n, 1] }));
            println!("{:?}", outcome.summary.effects);
            let error = (exact - force(&outcome)) / exact;
            println!("{kind}, {n} facets a quarter: {error:.3e}");
            error
        })
        .collect()
}

#[test]
fn the_force_error_falls_with_the_square_of_the_facets_and_is_their_sagitta() {
    let exact = press(Value::Null);
    let f = force(&exact);
    let stiffness = (f + exact.at("force.tool.z", 0.9)) / (0.1 * DEPTH);
    println!("{f} {stiffness}");
    let counts = [8, 16, 32];
    let e = errors("bilinear", &counts, f);
    for (e, n) in e.iter().zip(counts) {
        let s = R * FRAC_PI_2 / f64::from(n);
        let sagitta = s * s / (8.0 * R) * stiffness / f;
        println!("error {e:.3e}, sagitta {sagitta:.3e}: {:.3}", e / sagitta);
    }
    println!(
        "{:?}",
        e.windows(2)
            .map(|e| (e[0] / e[1]).log2())
            .collect::<Vec<_>>()
    );
    for kind in ["biquadratic", "smooth"] {
        let e = errors(kind, &[4, 8, 16], f);
        println!(
            "{:?}",
            e.windows(2)
                .map(|e| (e[0] / e[1]).abs().log2())
                .collect::<Vec<_>>()
        );
    }
}
