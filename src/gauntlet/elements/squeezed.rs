//! Large compression between plates.
use super::super::scenes::solution;
use super::super::{CaseError, Outcome, Trial};
use serde_json::{Value, json};

const E: f64 = 100.0;
const NU: f64 = 0.3;
const PENALTY: f64 = 1e5;

/// Force per undeformed area (tension positive) and lateral stretch of a neo-Hookean bar between planes that stand at
/// `height` of 1, the upper one behind a penalty; its sides are free, or held.
pub fn between_planes(height: f64, confined: bool, penalty: f64) -> (f64, f64) {
    let lambda = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU));
    let mu = 0.5 * E / (1.0 + NU);
    let bar = |l3: f64| {
        let mut l1 = 1.0f64;
        if !confined {
            for _ in 0..100 {
                let ln = (l1 * l1 * l3).ln();
                let lateral = mu * (l1 - 1.0 / l1) + lambda * ln / l1;
                let slope = mu * (1.0 + 1.0 / (l1 * l1)) + lambda * (2.0 - ln) / (l1 * l1);
                l1 -= lateral / slope;
            }
        }
        (mu * (l3 - 1.0 / l3) + lambda * (l1 * l1 * l3).ln() / l3, l1)
    };
    // The pressure acts on the undeformed area of the slave.
    let (mut low, mut high) = (height, 1.0);
    for _ in 0..200 {
        let l3 = 0.5 * (low + high);
        match penalty * (l3 - height) + bar(l3).0 > 0.0 {
            true => high = l3,
            false => low = l3,
        }
    }
    bar(low)
}

/// A block of 1 x 1 x `height` squeezed by the part `amount` in steps of 5 %.
fn block(element: &str, n: u32, layers: u32, size: [f64; 2], amount: f64, confined: bool) -> Value {
    let [width, height] = size;
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": E, "nu": NU } } },
        "bodies": { "block": {
            "mesh": { "plate": {
                "size": [width, width], "thickness": height, "elements": [n, n], "layers": layers,
                "origin": [0, 0, height / 2.0]
            } },
            "material": "m",
            "element": element
        } },
        "surfaces": { "tool": {
            "plane": { "center": [0, 0, height], "normal": [0, 0, -1], "size": [10.0 * width, 10.0 * width] },
            "motion": { "translation": [0, 0, format!("-{:?}*t", amount * height)] }
        } },
        "contacts": { "press": {
            "slave": "block.top", "master": "tool", "points": { "gauss": 2 }, "penalty": { "value": PENALTY / height }
        } },
        "supports": {
            "floor": { "on": "block.bottom", "symmetry": "z" },
            "left": { "on": "block.x_min", "symmetry": "x" },
            "front": { "on": "block.y_min", "symmetry": "y" }
        },
        "solution": solution((amount / 0.05).round() as u32),
        "output": { "every": 0 }
    });
    if confined {
        scene["supports"]["right"] = json!({ "on": "block.x_max", "symmetry": "x" });
        scene["supports"]["back"] = json!({ "on": "block.y_max", "symmetry": "y" });
    }
    scene
}

fn uniform(
    trial: &mut Trial,
    name: &str,
    out: &Outcome,
    area: f64,
    right: f64,
) -> Result<(), CaseError> {
    let force = out.last("force.tool.z")? / area;
    trial.equal(format!("pressure, {name}"), force, right, 1e-9);
    trial.equal(
        format!("largest pressure, {name}"),
        out.last("pressure.max")?,
        -right,
        1e-9,
    );
    // The assumed thickness strain of `h8` softens with the pressure on it: its tangent may have negative pivots here, which
    // is told.
    if !name.starts_with("h8 ") {
        let unstable = out.warnings("negative pivot").len() as f64;
        trial.within(format!("steps with negative pivots, {name}"), unstable, 0.0);
    }
    Ok(())
}

pub fn squeezed(trial: &mut Trial) -> Result<(), CaseError> {
    for (element, n, layers) in [
        ("h8", 3, 1),
        ("h8", 4, 2),
        ("h8", 3, 4),
        ("h8_displacement", 3, 2),
        ("q18", 2, 1),
    ] {
        for confined in [false, true] {
            let out = trial.done(&block(element, n, layers, [1.0, 1.0], 0.4, confined))?;
            let (right, _) = between_planes(0.6, confined, PENALTY);
            let sides = if confined { "confined" } else { "free" };
            uniform(
                trial,
                &format!("{element} in {layers} layer(s), {sides}"),
                &out,
                1.0,
                right,
            )?;
        }
    }
    trial.iterations(320);
    Ok(())
}

pub fn sheet(trial: &mut Trial) -> Result<(), CaseError> {
    for layers in [1, 2] {
        let out = trial.done(&block("h8", 4, layers, [16.0, 1.0], 0.3, false))?;
        let (right, _) = between_planes(0.7, false, PENALTY);
        uniform(
            trial,
            &format!("h8 in {layers} layer(s)"),
            &out,
            256.0,
            right,
        )?;
    }
    trial.iterations(60);
    Ok(())
}
