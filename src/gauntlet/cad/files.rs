//! One tool in several formats and units.
use super::{STATE, block, write};
use crate::gauntlet::drawn::difference;
use crate::gauntlet::scenes::alone;
use crate::gauntlet::{CaseError, Trial};
use covact_geometry::Vec3;
use covact_geometry::io::{CadFile, LengthUnit, write_iges};
use covact_geometry::primitives::sphere_without_poles;
use serde_json::json;

/// A cylinder of radius 20 that ends in a half sphere about (0, 0, 20), in millimetres (Open CASCADE 8.0).
const PUNCH: &str = include_str!("round_punch.step");

pub fn step(trial: &mut Trial) -> Result<(), CaseError> {
    write(trial, "punch.step", PUNCH.as_bytes())?;
    let exact = json!({ "sphere": { "radius": 20, "center": [0, 0, 20] }, "side": "outward" });
    let exact = trial.done(&block(exact, 1.0))?;
    let punch = trial.done(&block(json!({ "cad": "punch.step" }), 1.0))?;
    trial.holds("something slides", exact.last("points.slip")? > 0.0);
    trial.within("difference", difference(&exact, &punch, &STATE)?, 1e-9);
    trial.iterations(45);
    Ok(())
}

pub fn inches(trial: &mut Trial) -> Result<(), CaseError> {
    write(trial, "punch.step", PUNCH.as_bytes())?;
    let here = trial.done(&block(json!({ "cad": "punch.step" }), 1.0))?;
    let inch = 1.0 / 25.4;
    let mut scene = block(json!({ "cad": "punch.step" }), inch);
    scene["units"] = json!({ "length": "in" });
    let there = trial.done(&scene)?;
    for name in STATE {
        let unit = match name {
            name if name.starts_with("force") => 1.0,
            "pressure.max" => 1.0 / (inch * inch),
            _ => inch,
        };
        trial.equal(name, there.last(name)? / unit, here.last(name)?, 1e-9);
    }
    trial.iterations(45);
    Ok(())
}

pub fn formats(trial: &mut Trial) -> Result<(), CaseError> {
    let patches = sphere_without_poles(20.0, Vec3::new(0.3, -0.2, 20.0), Vec3::new(0.2, 0.1, 1.0))?;
    let unit = LengthUnit {
        name: "mm".into(),
        to_metre: Some(1e-3),
    };
    let iges = write_iges(&CadFile::of(patches.to_vec(), unit));
    let iges = iges.map_err(|e| CaseError::new(e.to_string()))?;
    write(trial, "ball.igs", iges.as_bytes())?;
    let json = trial.cad("ball", patches.to_vec())?;
    let json = trial.done(&block(json!({ "cad": json }), 1.0))?;
    let iges = trial.done(&block(json!({ "cad": "ball.igs" }), 1.0))?;
    trial.holds("contact", json.last("force.tool.z")? < -1.0);
    trial.within("difference", difference(&json, &iges, &STATE)?, 1e-9);
    trial.iterations(40);
    Ok(())
}

pub fn pieces(trial: &mut Trial) -> Result<(), CaseError> {
    let ball =
        |radius: f64, x: f64| sphere_without_poles(radius, Vec3::new(x, 0.5, radius), Vec3::z());
    let (small, big) = (ball(6.0, -5.0)?.to_vec(), ball(9.0, 4.5)?.to_vec());
    let both = trial.cad("both", [small.clone(), big.clone()].concat())?;
    let mut one = block(json!({ "cad": both, "side": "outward" }), 1.0);
    alone(&mut one);
    let [small, big] = [trial.cad("small", small)?, trial.cad("big", big)?];
    let mut two = block(json!({ "cad": small, "side": "outward" }), 1.0);
    alone(&mut two);
    two["surfaces"]["other"] = two["surfaces"]["tool"].clone();
    two["surfaces"]["other"]["cad"] = big.into();
    two["contacts"]["other"] = two["contacts"]["press"].clone();
    two["contacts"]["other"]["master"] = "other".into();
    let [one, two] = [trial.done(&one)?, trial.done(&two)?];
    for axis in ["x", "y", "z"] {
        let parts = ["tool", "other"].map(|t| two.last(&format!("force.{t}.{axis}")));
        let [a, b] = parts;
        let (a, b) = (a?, b?);
        trial.holds(
            format!("both press along {axis}"),
            a.abs() > 1e-3 && b.abs() > 1e-3,
        );
        let whole = one.last(&format!("force.tool.{axis}"))?;
        trial.equal(format!("force along {axis}"), a + b, whole, 1e-9);
    }
    let off = difference(&one, &two, &STATE[2..])?;
    trial.within("energies and pressure", off, 1e-9);
    trial.iterations(36);
    Ok(())
}
