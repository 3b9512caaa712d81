//! A block on rigid surfaces, its top moved.
use crate::gauntlet::drawn::{FRICTION, block, change, difference, flat, plane, steps};
use crate::gauntlet::{CaseError, Trial};
use covact_geometry::{NurbsPatch, Vec3, primitives};
use serde_json::{Value, json};

/// Largest part by which the push along x misses `mu` times the pressing force, at the steps from `start` on.
fn missed(
    outcome: &crate::gauntlet::Outcome,
    mu: impl Fn(f64) -> f64,
    start: f64,
) -> Result<f64, CaseError> {
    let (x, z) = (
        outcome.column("force.tool.x")?,
        outcome.column("force.tool.z")?,
    );
    let mut missed = 0.0f64;
    for (i, t) in outcome.column("time")?.into_iter().enumerate() {
        if t > start - 1e-9 {
            missed = missed.max((x[i].abs() - mu(t) * z[i]).abs() / z[i]);
        }
    }
    Ok(missed)
}

pub fn coefficients(trial: &mut Trial) -> Result<(), CaseError> {
    for mu in [0.0, 0.1, 0.5, 1.0, 2.0] {
        // Its shear stiffness is 50 x 0.5 / 0.1 = 250 under N = 2: a quarter of mu N is reached by t = 0.2.
        let far = 0.002 * mu;
        let top = json!({
            "x": { "table": [[0, 0], [0.1, 0], [0.2, far], [1, 0.2]] }, "y": 0,
            "z": { "table": [[0, 0], [0.1, -0.004], [1, -0.004]] }
        });
        let mut scene = block(plane(), top, Some(json!(mu)), 20);
        flat(&mut scene);
        let outcome = trial.done(&scene)?;
        trial.holds("contact", outcome.last("force.tool.z")? > 1.0);
        trial.within(
            format!("mu = {mu}: push against mu N"),
            missed(&outcome, |_| mu, 0.4)?,
            1e-12,
        );
        if mu > 0.0 {
            let (x, z) = (
                outcome.at("force.tool.x", 0.2)?,
                outcome.at("force.tool.z", 0.2)?,
            );
            let share = x.abs() / (mu * z);
            trial.holds(
                format!("mu = {mu}: a push of part of mu N is held"),
                share > 0.15 && share < 0.35,
            );
            trial.within(
                format!("mu = {mu}: points that slide then"),
                outcome.at("points.slip", 0.2)?,
                0.0,
            );
        }
    }
    trial.iterations(230);
    Ok(())
}

pub fn mu_in_time(trial: &mut Trial) -> Result<(), CaseError> {
    let table = [
        [0.0, 0.0],
        [0.2, 0.0],
        [0.4, 2.0],
        [0.6, 0.5],
        [0.7, 0.0],
        [0.8, 0.0],
        [1.0, 1.0],
    ];
    let mu = |t: f64| {
        let after = table
            .iter()
            .position(|p| p[0] >= t - 1e-12)
            .unwrap_or(table.len() - 1)
            .max(1);
        let [a, b] = [table[after - 1], table[after]];
        a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0])
    };
    let top = json!({
        "x": "max(0,t-0.1)", "y": 0, "z": { "table": [[0, 0], [0.1, -0.004], [1, -0.004]] }
    });
    let mut scene = block(plane(), top, Some(json!({ "table": table })), 40);
    flat(&mut scene);
    let outcome = trial.done(&scene)?;
    let largest = outcome.at("force.tool.x", 0.4)?.abs() / outcome.at("force.tool.z", 0.4)?;
    trial.equal("push / N at its largest", largest, 2.0, 1e-12);
    trial.within("push against mu(t) N", missed(&outcome, mu, 0.125)?, 1e-12);
    trial.iterations(180);
    Ok(())
}

pub fn closing_again(trial: &mut Trial) -> Result<(), CaseError> {
    let run = |trial: &mut Trial, x: Value, z: Value| {
        let top = json!({ "x": { "table": x }, "y": 0, "z": { "table": z } });
        trial.done(&block(plane(), top, Some(json!(0.3)), 20))
    };
    let before = run(
        trial,
        json!([
            [0, 0],
            [0.2, 0],
            [0.4, 0.1],
            [0.5, 0.1],
            [0.6, 0.2],
            [0.8, 0.2],
            [1, 0.25]
        ]),
        json!([
            [0, 0],
            [0.2, -0.02],
            [0.4, -0.02],
            [0.5, 0.05],
            [0.6, 0.05],
            [0.8, -0.02],
            [1, -0.02]
        ]),
    )?;
    let fresh = run(
        trial,
        json!([[0, 0], [0.4, 0], [0.6, 0.2], [0.8, 0.2], [1, 0.25]]),
        json!([[0, 0], [0.5, 0.05], [0.6, 0.05], [0.8, -0.02], [1, -0.02]]),
    )?;
    trial.holds(
        "it slid the first time",
        before.at("energy.dissipated", 0.5)? > 0.01,
    );
    trial.within(
        "traction while it is lifted",
        before.at("force.tool.x", 0.6)?,
        0.0,
    );
    let past = before.at("energy.dissipated", 0.6)? - fresh.at("energy.dissipated", 0.6)?;
    let times = before.column("time")?;
    for name in FRICTION {
        let (a, b) = (before.column(name)?, fresh.column(name)?);
        let scale = b.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        let gone = if name == "energy.dissipated" {
            past
        } else {
            0.0
        };
        let later = (0..times.len()).filter(|i| times[*i] > 0.6 + 1e-9);
        let off = later.fold(0.0f64, |s, i| s.max((a[i] - gone - b[i]).abs()));
        trial.within(format!("{name} after closing again"), off / scale, 1e-10);
    }
    trial.iterations(170);
    Ok(())
}

pub fn pole(trial: &mut Trial) -> Result<(), CaseError> {
    let center = Vec3::new(0.1, 0.05, -2.0);
    let broken = |e: primitives::PrimitiveError| CaseError::new(e.to_string());
    let one = |axis: Vec3| {
        Ok::<_, CaseError>(vec![primitives::sphere(2.0, center, axis).map_err(broken)?])
    };
    let six =
        primitives::sphere_without_poles(2.0, center, Vec3::new(1.0, 0.2, 1.0)).map_err(broken)?;
    let top = json!({
        "x": { "table": [[0, 0], [0.75, 0.3], [1, 0.25]] }, "y": 0,
        "z": { "table": [[0, 0], [0.25, -0.05], [1, -0.05]] }
    });
    let run = |trial: &mut Trial, name: &str, patches: Vec<NurbsPatch>| {
        let file = trial.cad(name, patches)?;
        let tool = json!({ "cad": { "file": file }, "side": { "point": [0, 0, 5] }, "depth": 0.4 });
        trial.done(&block(tool, top.clone(), Some(json!(0.3)), 20))
    };
    let reference = run(trial, "aside", one(Vec3::new(1.0, -2.0, 0.5))?)?;
    trial.holds("points slide", reference.at("points.slip", 0.75)? > 10.0);
    for (name, patches) in [("pole", one(Vec3::z())?), ("six", six.to_vec())] {
        let other = run(trial, name, patches)?;
        let off = difference(&reference, &other, &FRICTION)?;
        trial.within(format!("{name}: against the pole elsewhere"), off, 1e-9);
    }
    trial.iterations(500);
    Ok(())
}

pub fn fast_turn(trial: &mut Trial) -> Result<(), CaseError> {
    // 360 degrees in 0.8, from t = 0.2 on.
    let run = |trial: &mut Trial, a_step: f64, end: f64| {
        let mut tool = plane();
        tool["motion"] = json!({ "rotation": {
            "axis": [0, 0, 1], "angle": { "table": [[0, 0], [0.2, 0], [2.6, 1080]] }
        } });
        let top = json!({ "x": 0, "y": 0, "z": { "table": [[0, 0], [0.2, -0.06], [2.6, -0.06]] } });
        let mut scene = block(tool, top, Some(json!(0.3)), 1);
        scene["solution"] = steps(0.8 * a_step / 360.0, end);
        scene["solution"]["stops"] = json!([0.2, 0.6, 1.0, 1.4]);
        trial.done(&scene)
    };
    let force = ["force.tool.z", "moment.tool.z"];
    let [quarter, half] = [run(trial, 90.0, 1.8)?, run(trial, 180.0, 1.8)?];
    trial.holds("half a turn a step is cut", half.summary.cuts > 0);
    for name in force {
        let what = format!("{name} in half turns against quarters");
        trial.equal(what, half.last(name)?, quarter.last(name)?, 1e-9);
    }
    let settled = change(&quarter, &force, 1.6, 1.8)?;
    trial.within("quarter turns: last against the one before", settled, 1e-6);
    // Steps of 3.75 degrees, and their error of first order taken off.
    let z = |trial: &mut Trial, a_step: f64| run(trial, a_step, 1.0)?.last("force.tool.z");
    let [a, b, c, d] = [
        z(trial, 3.75)?,
        z(trial, 7.5)?,
        z(trial, 15.0)?,
        z(trial, 30.0)?,
    ];
    let exact = 2.0 * a - b;
    let errors = [b, c, d].map(|f| f / exact - 1.0);
    for (pair, of) in errors
        .windows(2)
        .zip(["15 against 7.5 degrees", "30 against 15 degrees"])
    {
        // Twice the step, twice the error; the second order of a turn of 30 degrees adds a tenth.
        trial.within(
            format!("growth of the error, {of}, beside 2"),
            pair[1] / pair[0] - 2.0,
            0.25,
        );
    }
    trial.within("pressing force at 15 degrees a step", errors[1], 1e-2);
    trial.iterations(700);
    Ok(())
}
