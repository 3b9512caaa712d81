//! Elastic bars that hit each other along their axes: the wave equation with unilateral contact (B. de Saint-Venant, 1867).
//!
//! Modulus, density and cross-section are 1, and so is the speed of waves.
use super::steps;
use crate::gauntlet::{CaseError, Outcome, Trial};
use serde_json::{Value, json};

/// Speed over that of waves: strains are as large, and what is not linear in them is 1e-4 of what is.
const V: f64 = 1e-4;

/// A bar from `start` on along x.
fn bar(start: f64, length: f64, elements: u32, velocity: f64) -> Value {
    json!({
        "mesh": { "block": { "min": [start, 0, 0], "max": [start + length, 1, 1], "elements": [elements, 1, 1] } },
        "material": "m",
        "element": "h8_displacement",
        "velocity": [velocity, 0, 0]
    })
}

fn scene(bodies: Value, solution: Value) -> Value {
    let names: Vec<&String> = bodies
        .as_object()
        .into_iter()
        .flat_map(|b| b.keys())
        .collect();
    let sides = |axis: &str| -> Vec<String> {
        (names.iter())
            .flat_map(|n| [format!("{n}.{axis}_min"), format!("{n}.{axis}_max")])
            .collect()
    };
    let supports = json!({
        "y": { "on": sides("y"), "symmetry": "y" }, "z": { "on": sides("z"), "symmetry": "z" }
    });
    let probes: serde_json::Map<String, Value> = (names.iter())
        .map(|n| ((*n).clone(), json!({ "body": n })))
        .collect();
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1, "nu": 0, "density": 1 } } },
        "bodies": bodies,
        "supports": supports,
        "probes": probes,
        "solution": solution,
        "output": { "every": 0 }
    })
}

/// Mean velocity of a bar from `start` to the end of the run, over [`V`].
fn velocity(out: &Outcome, body: &str, start: f64) -> Result<f64, CaseError> {
    let column = format!("probe.{body}.x");
    let way = out.last(&column)? - out.at(&column, start)?;
    Ok(way / (out.last("time")? - start) / V)
}

pub fn wall(trial: &mut Trial) -> Result<(), CaseError> {
    let n = 40;
    let h = 1.0 / f64::from(n);
    let mut scene = scene(json!({ "bar": bar(0.0, 1.0, n, -V) }), steps(h, 2.5));
    scene["surfaces"]["wall"] = json!({
        "plane": { "center": [0, 0.5, 0.5], "normal": [1, 0, 0], "size": [3, 3] }, "side": { "point": [1, 0.5, 0.5] }
    });
    scene["contacts"]["hit"] =
        json!({ "slave": "bar.x_min", "master": "wall", "penalty": { "value": 100.0 / h } });
    let out = trial.done(&scene)?;
    let [time, force] = [out.column("time")?, out.column("force.wall.x")?];
    let middle: Vec<f64> = (time.iter().zip(&force))
        .filter(|(t, _)| (0.3..1.7).contains(*t))
        .map(|(_, f)| f / V)
        .collect();
    let mean = middle.iter().sum::<f64>() / middle.len() as f64;
    trial.equal("mean force", mean, 1.0, 3e-3);
    let touching = time.iter().zip(&force).filter(|(_, f)| **f > 1e-3 * V);
    let end = touching.map(|(t, _)| *t).fold(0.0, f64::max);
    trial.within("end of contact, off by steps", (end - 2.0) / h, 2.5);
    // The front of the wave is spread over elements: first order in their size.
    trial.equal(
        "velocity afterwards",
        velocity(&out, "bar", 2.25)?,
        1.0,
        3e-2,
    );
    let energy = ["kinetic", "internal", "contact"].map(|e| out.column(&format!("energy.{e}")));
    let [kinetic, internal, contact] = energy;
    let (kinetic, internal, contact) = (kinetic?, internal?, contact?);
    let highest = (0..kinetic.len())
        .map(|i| kinetic[i] + internal[i] + contact[i])
        .fold(0.0, f64::max);
    let gained = (highest / (0.5 * V * V) - 1.0).max(0.0);
    trial.within("energy gained", gained, 1e-4);
    trial.iterations(320);
    Ok(())
}

/// Bars in contact from x = 0 on of which the first moves.
fn row(trial: &mut Trial, lengths: &[f64], end: f64) -> Result<Outcome, CaseError> {
    let n = 20.0;
    let (mut bodies, mut start) = (json!({}), 0.0);
    for (i, length) in lengths.iter().enumerate() {
        let v = if i == 0 { V } else { 0.0 };
        let elements = (n * length).round() as u32;
        bodies[format!("bar{i}")] = bar(start, *length, elements, v);
        start += length;
    }
    let mut scene = scene(bodies, steps(1.0 / n, end));
    for i in 1..lengths.len() {
        scene["contacts"][format!("hit{i}")] = json!({
            "slave": format!("bar{}.x_max", i - 1), "master": format!("bar{i}.x_min"), "penalty": { "value": 100.0 * n }
        });
    }
    let out = trial.done(&scene)?;
    // Nothing acts from outside: the centre of mass moves on. Probes count every node alike, which vibrations tell from the mass.
    let mut momentum = 0.0;
    for (i, length) in lengths.iter().enumerate() {
        momentum += length * out.last(&format!("probe.bar{i}.x"))?;
    }
    trial.equal(
        "way of the centre of mass",
        momentum,
        lengths[0] * V * end,
        2e-2,
    );
    Ok(out)
}

pub fn cradle(trial: &mut Trial) -> Result<(), CaseError> {
    let out = row(trial, &[1.0, 1.0, 1.0], 5.0)?;
    trial.within("velocity of the first", velocity(&out, "bar0", 4.5)?, 0.04);
    trial.within("velocity of the second", velocity(&out, "bar1", 4.5)?, 0.04);
    trial.equal(
        "velocity of the last",
        velocity(&out, "bar2", 4.5)?,
        1.0,
        0.04,
    );
    trial.iterations(330);
    Ok(())
}

pub fn lengths(trial: &mut Trial) -> Result<(), CaseError> {
    let out = row(trial, &[0.5, 1.0], 4.0)?;
    trial.within(
        "velocity of the short one",
        velocity(&out, "bar0", 3.0)?,
        0.02,
    );
    trial.equal(
        "velocity of the long one",
        velocity(&out, "bar1", 3.0)?,
        0.5,
        0.02,
    );
    trial.iterations(260);
    Ok(())
}
