//! Von Mises' truss: two bars on hinges, of which one is half of it.
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use serde_json::{Value, json};

/// Span and height of a bar, its thickness, and its modulus; its width is 1.
const SPAN: f64 = 10.0;
const HEIGHT: f64 = 2.0;
const THICKNESS: f64 = 0.6;
const E: f64 = 1000.0;

/// Force on the crown at this height above the hinge (St. Venant and Kirchhoff's bar).
fn force(height: f64) -> f64 {
    let before = SPAN.hypot(HEIGHT);
    let strain = 0.5 * ((SPAN * SPAN + height * height) / (before * before) - 1.0);
    E * THICKNESS * strain * height / before
}

fn bar(crown: Value) -> Value {
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": 0 } } },
        "bodies": { "bar": {
            "mesh": { "plate": { "size": [SPAN.hypot(HEIGHT), 1], "thickness": THICKNESS, "elements": [4, 1] } },
            "material": "m",
            "placement": { "axis": [0, 1, 0], "angle": -HEIGHT.atan2(SPAN).to_degrees() }
        } },
        "supports": {
            "foot": { "on": "bar.x_min", "mid_surface": true, "displacement": { "x": 0, "y": 0, "z": 0 } },
            "crown": { "on": "bar.x_max", "mid_surface": true, "displacement": crown },
            "faces": { "on": ["bar.y_min", "bar.y_max"], "symmetry": "y" }
        },
        "probes": { "crown": { "on": "bar.x_max" } },
        "solution": solution(24),
        "output": { "every": 0 }
    })
}

pub fn pushed(trial: &mut Trial) -> Result<(), CaseError> {
    let way = 2.4 * HEIGHT;
    let out = trial.done(&bar(json!({ "x": 0, "z": format!("-{way}*t") })))?;
    let [time, found] = [out.column("time")?, out.column("force.crown.z")?];
    let right: Vec<f64> = time.iter().map(|t| force(HEIGHT - way * t)).collect();
    let largest = right.iter().copied().fold(0.0, f64::max);
    let smallest = right.iter().copied().fold(0.0, f64::min);
    trial.holds(
        "up, down and up again",
        largest > 0.5 && smallest < -0.5 && right.len() >= 24,
    );
    let off = found.iter().zip(&right).map(|(a, b)| (a - b).abs());
    let worst = off.fold(0.0, f64::max);
    trial.within("force in every step by the largest", worst / largest, 1e-8);
    trial.iterations(110);
    Ok(())
}

pub fn snaps(trial: &mut Trial) -> Result<(), CaseError> {
    let load = -1.2;
    let mut scene = bar(json!({ "x": 0 }));
    scene["loads"]["push"] =
        json!({ "on": "bar.x_max", "force": [0, 0, { "table": [[0, 0], [1, load]] }] });
    scene["solution"]["stabilization"] = json!({ "viscous": {} });
    let out = trial.done(&scene)?;
    // The limit force is the smallest on the way down.
    let limit = (1..2000).map(|i| force(HEIGHT * f64::from(i) / 2000.0));
    let limit = limit.fold(0.0, f64::min);
    let [time, crown] = [out.column("time")?, out.column("probe.crown.z")?];
    let jump = crown.iter().position(|z| *z < -HEIGHT);
    let i = jump.ok_or_else(|| CaseError::new("it does not snap"))?;
    let steps = (load * time[i] - limit) / (load / 24.0);
    trial.holds("not before its limit force", steps >= 0.0);
    trial.within("jump after its limit force, in steps", steps, 1.0);
    let (mut low, mut high) = (-2.0 * HEIGHT, -HEIGHT);
    for _ in 0..200 {
        let z = 0.5 * (low + high);
        match force(z) < load {
            true => low = z,
            false => high = z,
        }
    }
    trial.equal(
        "place after the jump",
        HEIGHT + out.last("probe.crown.z")?,
        low,
        1e-5,
    );
    trial.iterations(255);
    Ok(())
}
