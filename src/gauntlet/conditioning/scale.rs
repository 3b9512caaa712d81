//! One scene in other units and at other places.
use super::super::scenes::solution;
use super::super::{CaseError, Outcome, Trial};
use serde_json::{Value, json};

/// A ball pressed into a plate of edge `size` clamped at two sides, `away` plate lengths from the origin along each axis;
/// all over `end` units of time.
fn ball_on_plate(size: f64, modulus: f64, away: f64, end: f64) -> Value {
    let (l, far) = (size, away * size);
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": modulus, "nu": 0.3 } } },
        "bodies": { "plate": {
            "mesh": { "plate": {
                "size": [l, l], "thickness": 0.1 * l, "elements": [6, 6],
                "origin": [far - 0.5 * l, far - 0.5 * l, far - 0.05 * l]
            } },
            "material": "m"
        } },
        "surfaces": { "tool": {
            "sphere": { "radius": 0.5 * l, "center": [far, far, far + 0.5 * l] },
            "motion": { "translation": [0, 0, format!("-{:e}*t", 0.15 * l / end)] }
        } },
        "contacts": { "press": { "slave": "plate.top", "master": "tool", "points": { "gauss": 2 } } },
        "supports": {
            "left": { "on": "plate.x_min", "fixed": true },
            "right": { "on": "plate.x_max", "fixed": true }
        },
        "solution": solution(4),
        "output": { "every": 0 }
    });
    scene["solution"]["end_time"] = end.into();
    scene["solution"]["step"] =
        json!({ "initial": end / 4.0, "max": end / 4.0, "min": 1e-3 * end });
    scene
}

fn with_friction(mut scene: Value) -> Value {
    scene["contacts"]["press"]["friction"] = json!({ "coulomb": { "mu": 0.3 } });
    scene
}

/// Largest relative difference of forces, energies, pressure and penetration at the end.
fn difference(a: &Outcome, b: &Outcome, length: f64, modulus: f64) -> Result<f64, CaseError> {
    let (force, energy) = (modulus * length * length, modulus * length.powi(3));
    let mut worst = 0.0f64;
    for (name, unit) in [
        ("force.tool.z", force),
        ("force.left.x", force),
        ("energy.internal", energy),
        ("pressure.max", modulus),
        ("penetration.max", length),
    ] {
        worst = worst.max((b.last(name)? / unit / a.last(name)? - 1.0).abs());
    }
    Ok(worst)
}

pub fn scale(trial: &mut Trial) -> Result<(), CaseError> {
    let one = trial.done(&with_friction(ball_on_plate(1.0, 1.0, 0.0, 1.0)))?;
    trial.holds(
        "contact and slip",
        one.last("force.tool.z")? < -1e-3 && one.last("energy.dissipated")? > 0.0,
    );
    for (length, modulus) in [
        (1e-9, 1.0),
        (1e-9, 1e18),
        (1e-3, 1e6),
        (1e3, 1.0),
        (1e6, 1e-18),
    ] {
        let other = trial.done(&with_friction(ball_on_plate(length, modulus, 0.0, 1.0)))?;
        let d = difference(&one, &other, length, modulus)?;
        trial.within(format!("size {length:e}, modulus {modulus:e}"), d, 1e-8);
        trial.holds(
            "the same iterations",
            one.column("iterations")? == other.column("iterations")?,
        );
    }
    trial.iterations(200);
    Ok(())
}

pub fn far(trial: &mut Trial) -> Result<(), CaseError> {
    let near = trial.done(&ball_on_plate(1.0, 1.0, 0.0, 1.0))?;
    let far = trial.done(&ball_on_plate(1.0, 1.0, 1e4, 1.0))?;
    trial.holds("contact", near.last("force.tool.z")? < -1e-3);
    for name in ["force.tool.z", "energy.internal"] {
        trial.equal(name, far.last(name)?, near.last(name)?, 1e-6);
    }
    // A position is rounded to 2e-12 there, penetrations are 1e-4: pressures keep eight digits.
    trial.equal(
        "pressure",
        far.last("pressure.max")?,
        near.last("pressure.max")?,
        1e-6,
    );
    trial.iterations(70);
    Ok(())
}

pub fn time_unit(trial: &mut Trial) -> Result<(), CaseError> {
    let one = trial.done(&with_friction(ball_on_plate(1.0, 1.0, 0.0, 1.0)))?;
    trial.holds("contact", one.last("force.tool.z")? < -1e-3);
    for end in [1e-9, 1e9] {
        let other = trial.done(&with_friction(ball_on_plate(1.0, 1.0, 0.0, end)))?;
        trial.within(
            format!("end at {end:e}"),
            difference(&one, &other, 1.0, 1.0)?,
            1e-10,
        );
        trial.holds(
            "the same iterations",
            one.column("iterations")? == other.column("iterations")?,
        );
    }
    trial.iterations(110);
    Ok(())
}
