//! Steps too large, and ways to and fro.
use crate::gauntlet::drawn::{FRICTION, STATE, block, plane, steps};
use crate::gauntlet::{CaseError, Outcome, Trial};
use serde_json::json;

pub fn through(trial: &mut Trial) -> Result<(), CaseError> {
    // A quarter of a clamped sheet, 0.2 thick; the ball goes 1.49 deep.
    let scene = |steps: u32| {
        let step = 1.0 / f64::from(steps);
        json!({
            "covact": 1,
            "materials": { "m": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
            "bodies": { "sheet": {
                "mesh": { "plate": { "size": [4, 4], "thickness": 0.2, "elements": [8, 8] } }, "material": "m"
            } },
            "surfaces": { "ball": {
                "sphere": { "radius": 1, "center": [0, 0, 1.11] }, "motion": { "translation": [0, 0, "-1.5*t"] }
            } },
            "contacts": { "press": {
                "slave": "sheet.top", "master": "ball", "points": { "gauss": 3 }, "penalty": { "value": 2000 }
            } },
            "supports": {
                "far_x": { "on": "sheet.x_max", "fixed": true },
                "far_y": { "on": "sheet.y_max", "fixed": true },
                "near_x": { "on": "sheet.x_min", "symmetry": "x" },
                "near_y": { "on": "sheet.y_min", "symmetry": "y" }
            },
            "solution": { "step": { "initial": step, "max": step }, "newton": { "tolerance": 1e-11 } },
            "output": { "every": 0 }
        })
    };
    let small = trial.done(&scene(16))?;
    let force = small.last("force.ball.z")?;
    trial.holds("the ball is resisted", force < -1.0);
    for steps in [2, 1] {
        let large = trial.done(&scene(steps))?;
        for name in ["force.ball.z", "energy.internal", "energy.contact"] {
            let what = format!("{name} in {steps} step(s) against 16");
            trial.equal(what, large.last(name)?, small.last(name)?, 1e-8);
        }
    }
    trial.iterations(800);
    Ok(())
}

pub fn mirrored(trial: &mut Trial) -> Result<(), CaseError> {
    // A sphere beside the axis that it turns about: half a turn carries its crown by more than half of the block.
    let run = |trial: &mut Trial, a_step: f64| {
        let tool = json!({
            "sphere": { "radius": 2, "center": [0.15, 0, -2] },
            "motion": { "rotation": { "axis": [0, 0, 1], "angle": { "table": [[0, 0], [0.2, 0], [1, 360]] } } }
        });
        let top = json!({ "x": 0, "y": 0, "z": { "table": [[0, 0], [0.2, -0.06], [1, -0.06]] } });
        let mut scene = block(tool, top, None, 1);
        scene["solution"] = steps(0.8 * a_step / 360.0, 1.0);
        scene["solution"]["stops"] = json!([0.2]);
        trial.done(&scene)
    };
    let small = run(trial, 30.0)?;
    trial.holds("contact", small.last("force.tool.z")? > 1.0);
    for a_step in [60.0, 90.0] {
        let large = run(trial, a_step)?;
        for name in STATE {
            let what = format!("{name} after steps of {a_step} degrees against 30");
            trial.equal(what, large.last(name)?, small.last(name)?, 1e-8);
        }
    }
    trial.iterations(800);
    Ok(())
}

pub fn reversal(trial: &mut Trial) -> Result<(), CaseError> {
    let push = json!({ "table": [[0, 0], [1, 0.1], [3, -0.1], [5, 0.1], [7, -0.1], [8, 0]] });
    for mu in [0.0, 0.3] {
        let tool = |z: f64| json!({ "cylinder": { "radius": 1, "length": 4, "center": [2.5, 0.5, z], "axis": [0, 1, 0] } });
        let contact = |slave: &str, master: &str| {
            let mut contact = json!({
                "slave": slave, "master": master, "points": { "gauss": 2 }, "penalty": { "value": 5000 }
            });
            if mu > 0.0 {
                contact["friction"] = json!({ "coulomb": { "mu": mu } });
            }
            contact
        };
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
            "bodies": { "sheet": {
                "mesh": { "plate": { "size": [4, 1], "thickness": 0.3, "elements": [12, 1] } }, "material": "m"
            } },
            "surfaces": { "up": tool(1.2), "down": tool(-1.2) },
            "contacts": {
                "above": contact("sheet.top", "up"), "below": contact("sheet.bottom", "down")
            },
            "supports": { "clamp": { "on": "sheet.x_min", "fixed": true } },
            "loads": { "push": { "on": "sheet.x_max", "force": [0, 0, push] } },
            "solution": steps(0.125, 8.0),
            "output": { "every": 0 }
        });
        let outcome = trial.done(&scene)?;
        let word = if mu > 0.0 { "with friction" } else { "without" };
        let [up, down, along] =
            ["force.up.z", "force.down.z", "force.up.x"].map(|c| outcome.column(c));
        let ([up, down, along], below) = ([up?, down?, along?], outcome.column("force.down.x")?);
        let stored = outcome.column("energy.internal")?;
        let largest = up.iter().fold(0.0f64, |s, f| s.max(f.abs()));
        let most = stored.iter().fold(0.0f64, |s, e| s.max(*e));
        trial.holds(
            "contact on both sides in turn",
            largest > 0.1 && up[23] == 0.0 && down[7] == 0.0,
        );
        // A half cycle is 16 steps. The first begins at rest, with a touch that no step before it tells of.
        let (mut mirror, mut repeated) = (0.0f64, 0.0f64);
        for i in 16..32 {
            mirror = mirror
                .max((down[i] + up[i + 16]).abs())
                .max((below[i] - along[i + 16]).abs());
            repeated = repeated.max((down[i] - down[i + 32]).abs());
        }
        trial.within(
            format!("below against above, {word}"),
            mirror / largest,
            1e-9,
        );
        trial.within(
            format!("next cycle against the one before, {word}"),
            repeated / largest,
            1e-9,
        );
        let left = [15, 31, 47, 63]
            .map(|i| stored[i])
            .into_iter()
            .fold(0.0, f64::max);
        trial.within(
            format!("energy left between / largest, {word}"),
            left / most,
            1e-12,
        );
    }
    trial.iterations(750);
    Ok(())
}

pub fn fifty_times(trial: &mut Trial) -> Result<(), CaseError> {
    const CYCLES: usize = 50;
    const STEPS: usize = 6;
    let mut tool = plane();
    tool["placement"] = json!({ "translation": [0, 0, -0.02] });
    let (mut x, mut z) = (vec![json!([0, 0])], vec![json!([0, 0])]);
    for i in 0..CYCLES {
        let at = |part: f64, way: f64| json!([i as f64 + part, way]);
        z.extend([at(0.5, -0.05), at(1.0, 0.0)]);
        x.extend([at(0.25, 0.0), at(0.5, 0.03), at(1.0, 0.0)]);
    }
    for (mu, columns) in [(None, &STATE[1..]), (Some(json!(0.3)), &FRICTION[..6])] {
        let word = if mu.is_some() {
            "with friction"
        } else {
            "without"
        };
        let aside = if mu.is_some() {
            json!({ "table": x })
        } else {
            json!(0)
        };
        let top = json!({ "x": aside, "y": 0, "z": { "table": z } });
        let mut scene = block(tool.clone(), top, mu.clone(), 1);
        scene["bodies"]["block"]["mesh"]["block"]["elements"] = json!([4, 1, 1]);
        scene["solution"] = steps(1.0 / STEPS as f64, CYCLES as f64);
        let outcome = trial.done(&scene)?;
        trial.holds("contact", largest(&outcome, "force.tool.z")? > 1.0);
        for name in columns {
            let off = drift(&outcome, name)? / largest(&outcome, name)?;
            trial.within(
                format!("{name} of the 50th cycle against the first, {word}"),
                off,
                1e-10,
            );
        }
        let times = outcome.column("time")?;
        let a_cycle = times.iter().filter(|t| **t < 1.0 + 1e-9).count();
        if mu.is_some() {
            let dissipated = outcome.column("energy.dissipated")?;
            let first = dissipated[a_cycle - 1];
            trial.holds("friction dissipates", first > 0.0);
            let each = dissipated[dissipated.len() - 1] / (CYCLES as f64 * first) - 1.0;
            trial.within(
                "energy dissipated by 50 cycles against 50 times the first",
                each,
                1e-10,
            );
        }
    }
    trial.iterations(4000);
    Ok(())
}

/// Largest size of a column.
fn largest(outcome: &Outcome, name: &str) -> Result<f64, CaseError> {
    Ok((outcome.column(name)?.iter()).fold(0.0f64, |s, v| s.max(v.abs())))
}

/// Largest difference of a column between the first and the last cycle.
fn drift(outcome: &Outcome, name: &str) -> Result<f64, CaseError> {
    let (times, column) = (outcome.column("time")?, outcome.column(name)?);
    let a_cycle = times.iter().filter(|t| **t < 1.0 + 1e-9).count();
    let last = column.len().saturating_sub(a_cycle);
    let off = column[..a_cycle.min(column.len())]
        .iter()
        .zip(&column[last..]);
    Ok(off.fold(0.0f64, |s, (a, b)| s.max((a - b).abs())))
}
