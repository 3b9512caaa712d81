//! Shells of several faces, and of trimmed ones.
use super::{body, face};
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Outcome, Trial};
use covact_geometry::trim::{TrimCurve, TrimLoop};
use covact_geometry::{NurbsCurve, NurbsPatch, Vec3};
use nalgebra::Vector2;
use serde_json::{Value, json};

/// A plate of about 8 x 8 under a ball.
fn plate(
    trial: &mut Trial,
    name: &str,
    patches: Vec<NurbsPatch>,
    mut keys: Value,
    rim: Value,
) -> Result<Outcome, CaseError> {
    keys["thickness"] = json!(0.5);
    let mut solution = solution(3);
    solution["newton"]["tolerance"] = json!(1e-9);
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
        "bodies": { "sheet": body(trial, name, patches, keys)? },
        "surfaces": { "ball": {
            "sphere": { "radius": 4, "center": [3.6, 4.1, 4.25] },
            "side": "outward",
            "motion": { "translation": [0, 0, "-0.8*t"] }
        } },
        "contacts": { "press": {
            "slave": "sheet.top", "master": "ball", "penalty": { "value": 2e3 }, "points": { "gauss": 4 }
        } },
        "supports": { "rim": { "on": rim, "clamped": true } },
        "solution": solution,
        "output": { "every": 0 }
    });
    trial.done(&scene)
}

fn agree(trial: &mut Trial, name: &str, one: &Outcome, other: &Outcome) -> Result<(), CaseError> {
    trial.holds("contact", one.last("force.ball.z")? < -1.0);
    for column in ["force.ball.z", "energy.internal"] {
        let what = format!("{column}, {name}");
        trial.equal(what, other.last(column)?, one.last(column)?, 1e-3);
    }
    Ok(())
}

pub fn joined(trial: &mut Trial) -> Result<(), CaseError> {
    let (x, y) = (Vec3::x(), Vec3::y());
    let edges = json!([
        "sheet.edge.1",
        "sheet.edge.2",
        "sheet.edge.3",
        "sheet.edge.4"
    ]);
    let whole = vec![face(Vec3::zeros(), x * 8.0, y * 8.0)?];
    let whole = plate(
        trial,
        "whole",
        whole,
        json!({ "elements": [12, 12] }),
        edges,
    )?;
    let left = face(Vec3::zeros(), x * 3.0, y * 8.0)?;
    let two = vec![left.clone(), face(x * 3.0, x * 5.0, y * 8.0)?];
    let three = vec![
        left,
        face(x * 3.0, x * 5.0, y * 3.3)?,
        face(x * 3.0 + y * 3.3, x * 5.0, y * 4.7)?,
    ];
    for (name, patches) in [("two", two), ("three", three)] {
        let keys = json!({ "size": 8.0 / 12.0 });
        let other = plate(trial, name, patches, keys, json!("sheet.rim"))?;
        agree(trial, name, &whole, &other)?;
    }
    trial.iterations(110);
    Ok(())
}

pub fn trimmed(trial: &mut Trial) -> Result<(), CaseError> {
    let clamped = json!(["sheet.edge.3", "sheet.edge.4"]);
    // The face ends askew, from (7.6, 0) to (8.4, 8).
    let whole = face(Vec3::zeros(), Vec3::x() * 9.13, Vec3::y() * 8.0)?;
    let corners = [[0.0, 0.0], [7.6 / 9.13, 0.0], [8.4 / 9.13, 1.0], [0.0, 1.0]].map(Vector2::from);
    let line = |k: usize| -> Result<TrimCurve, CaseError> {
        let parameter = NurbsCurve::line(corners[k], corners[(k + 1) % 4]);
        Ok(TrimCurve {
            parameter: parameter.map_err(|e| CaseError::new(e.to_string()))?,
            space: None,
            entity: 0,
        })
    };
    let curves = (0..4).map(line).collect::<Result<_, _>>()?;
    let trimmed = whole
        .trimmed_by(vec![TrimLoop { curves }], true, 1e-9)?
        .patch;
    trial.holds("trimmed", trimmed.trim().is_some());
    let points = [
        Vec3::zeros(),
        Vec3::new(7.6, 0.0, 0.0),
        Vec3::new(0.0, 8.0, 0.0),
        Vec3::new(8.4, 8.0, 0.0),
    ];
    let knots = || vec![0.0, 0.0, 1.0, 1.0];
    let ends = NurbsPatch::new([1, 1], [knots(), knots()], [2, 2], &points, None)?;
    let ends = plate(
        trial,
        "ends",
        vec![ends],
        json!({ "elements": [12, 12] }),
        clamped.clone(),
    )?;
    let trimmed = plate(
        trial,
        "trimmed",
        vec![trimmed],
        json!({ "elements": [13, 12] }),
        clamped,
    )?;
    agree(trial, "trimmed", &ends, &trimmed)?;
    trial.iterations(55);
    Ok(())
}
