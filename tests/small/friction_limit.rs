//! As displacements become small, large displacements with friction come to the same.
use crate::support::{Outcome, solve};
use crate::{displacements, large, off, scene};
use serde_json::{Value, json};

const STEPS: u32 = 6;

/// A block pressed on another one and drawn along it, or along a plane that turns a little; meshes do not match, and contact
/// begins in front of the master. All displacements have the factor `scale`.
fn drawn(on_body: bool, offset: f64, scale: f64) -> Value {
    let (low, deep, way) = (offset, 0.02 * scale, 0.03 * scale);
    let press = json!({"table": [[0, 0], [0.5, -deep], [1, -deep]]});
    let draw = json!({"table": [[0, 0], [0.5, 0], [1, way]]});
    let mut parts = json!({
        "bodies": {"upper": {
            "mesh": {"block": {"min": [0.3, 0.2, low], "max": [2.5, 1.7, low + 1.0], "elements": [5, 4, 2]}},
            "material": "m", "element": "h8_displacement"
        }},
        "contacts": {"c": {
            "slave": "upper.bottom", "master": "tool", "points": {"gauss": 2}, "offset": offset,
            "friction": {"coulomb": {"mu": 0.3}}, "penalty": {"value": 600}, "tangential_penalty": {"value": 400}
        }},
        "supports": {"hold": {"on": "upper.top", "displacement": {"x": draw, "y": format!("{}*t", 0.2 * way), "z": press}}}
    });
    if on_body {
        parts["bodies"]["lower"] = json!({
            "mesh": {"block": {"min": [0, 0, -1], "max": [3, 2, 0], "elements": [4, 3, 2]}},
            "material": "m", "element": "h8_displacement"
        });
        parts["contacts"]["c"]["master"] = json!("lower.top");
        parts["supports"]["ground"] = json!({"on": "lower.bottom", "fixed": true});
    } else {
        parts["surfaces"] = json!({"tool": {
            "plane": {"center": [1.4, 1, 0], "size": [20, 20]}, "depth": 1,
            "motion": {"rotation": {
                "center": [1.4, 1, 0], "axis": [1, 2, 3], "angle": {"table": [[0, 0], [0.5, 0], [1, 0.2 * scale]]}
            }}
        }});
    }
    scene(0.3, parts, STEPS)
}

/// Forces on both sides, energies and counts after the last step.
fn told(o: &Outcome, on_body: bool) -> (Vec<f64>, Vec<[f64; 2]>) {
    let side = |quantity: &str| match on_body {
        true => format!("slave.{quantity}.c"),
        false => format!("{quantity}.tool"),
    };
    let force = |q: &str| ["x", "y", "z"].map(|axis| o.at(&format!("{}.{axis}", side(q)), 1.0));
    let counts = o
        .column("points.stick")
        .into_iter()
        .zip(o.column("points.slip"));
    (
        force("force").to_vec(),
        counts.map(|(a, b)| [a, b]).collect(),
    )
}

#[test]
fn friction_is_the_limit_of_the_large_one() {
    for (on_body, offset) in [(true, 0.0), (true, 0.2), (false, 0.0), (false, 0.2)] {
        let mut last: Option<[f64; 3]> = None;
        for scale in [0.1, 0.05, 0.025] {
            let small = drawn(on_body, offset, scale);
            let mut other = large(&small);
            other["solution"]["newton"] = json!({"tolerance": 1e-12});
            let [a, b] = [solve(&small), solve(&other)];
            let ((forces, counts), (other, others)) = (told(&a, on_body), told(&b, on_body));
            println!("{counts:?}");
            // A point that is about to slide may do so a little earlier, but at the least displacements.
            let moved = counts.iter().zip(&others).map(|(a, b)| (a[0] - b[0]).abs());
            let moved = moved.fold(0.0, f64::max);
            assert!(moved <= if scale < 0.03 { 0.0 } else { 1.0 }, "{others:?}");
            let both = |i: usize| counts[STEPS as usize - 1][i] + counts[3][i];
            assert!(both(0) > 0.0 && both(1) > 0.0, "{counts:?}");
            let energy =
                |o: &Outcome| [o.at("energy.dissipated", 1.0), o.at("energy.friction", 1.0)];
            let differences = [
                off(&forces, &other, 1.0),
                off(&energy(&a), &energy(&b), 1.0),
                off(
                    &displacements(&a, "upper"),
                    &displacements(&b, "upper"),
                    1.0,
                ),
            ];
            println!("on body {on_body}, {offset}, {scale}: {differences:?}");
            for (k, now) in differences.iter().enumerate() {
                assert!(*now < 0.5 * scale, "{k}: {now}");
                if let Some(last) = &last {
                    let order = (last[k] / now).log2();
                    assert!((order - 1.0).abs() < 0.2, "{k}: order {order}");
                }
            }
            last = Some(differences);
            if on_body {
                let left = |q: &str| a.at(&format!("imbalance.{q}.c"), 1.0);
                let size = a.at("slave.force.c.z", 1.0).abs();
                assert!(left("force") < 1e-12 * size && left("moment") < 1e-12 * size);
            }
        }
    }
}
