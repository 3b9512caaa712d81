//! Tools that turn, by large angles a step.
use crate::gauntlet::drawn::{STATE, block, change, cylinder, difference, plane, steps};
use crate::gauntlet::{CaseError, Trial};
use serde_json::{Value, json};

/// Pressed until t = 0.2; what turns does so from then on.
fn pressed() -> Value {
    json!({ "x": 0, "y": 0, "z": { "table": [[0, 0], [0.2, -0.06], [1, -0.06]] } })
}

/// Steps in which `degrees` from t = 0.2 to 1 pass `a_step` at a time.
fn turning(degrees: f64, a_step: f64) -> Value {
    let mut solution = steps(0.8 * a_step / degrees, 1.0);
    solution["stops"] = json!([0.2]);
    solution
}

pub fn full_turn(trial: &mut Trial) -> Result<(), CaseError> {
    let mut tool = cylinder(0.0);
    tool["motion"] = json!({ "rotation": {
        "center": [0, 0, -2], "axis": [0, 1, 0], "angle": { "table": [[0, 0], [0.2, 0], [1, 720]] }
    } });
    let columns = [
        "force.tool.z",
        "energy.internal",
        "energy.contact",
        "pressure.max",
    ];
    for mu in [0.0, 0.3] {
        let mut scene = block(tool.clone(), pressed(), (mu > 0.0).then(|| json!(mu)), 1);
        scene["solution"] = turning(720.0, 90.0);
        let outcome = trial.done(&scene)?;
        trial.holds("contact", outcome.last("force.tool.z")? > 1.0);
        if mu == 0.0 {
            for quarter in 1..=8 {
                let t = 0.2 + 0.1 * f64::from(quarter);
                let off = change(&outcome, &columns, 0.2, t)?;
                trial.within(
                    format!("{} degrees without friction", 90 * quarter),
                    off,
                    1e-9,
                );
            }
            continue;
        }
        let off = change(
            &outcome,
            &[&columns[..], &["force.tool.x"]].concat(),
            0.6,
            1.0,
        )?;
        trial.within("second turn against the first, with friction", off, 1e-9);
        // Everything slides: every force leans by phi, and has the arm R sin phi about the axis, but that the points are
        // spread over an angle of up to 0.2.
        let [x, z] = [outcome.last("force.tool.x")?, outcome.last("force.tool.z")?];
        let torque = outcome.last("moment.tool.y")? + 2.0 * x;
        let arm = torque / (2.0 * x.hypot(z));
        trial.equal(
            "arm of the force about the axis / R",
            arm,
            f64::atan(mu).sin(),
            0.02,
        );
    }
    trial.iterations(130);
    Ok(())
}

pub fn cam(trial: &mut Trial) -> Result<(), CaseError> {
    let e = 0.02;
    let mut turned = cylinder(0.0);
    turned["motion"] = json!({ "rotation": {
        "center": [e, 0, -2.0 + e], "axis": [0, 1, 0], "angle": { "table": [[0, 0], [0.2, 0], [1, 360]] }
    } });
    // A cylinder's own turn says nothing without friction: its axis goes round on a circle.
    let a = "(2*pi*max(0,t-0.2)/0.8)";
    let mut moved = cylinder(0.0);
    moved["motion"] = json!({ "translation": [
        format!("{e}*(1-cos{a}-sin{a})"), 0, format!("{e}*(sin{a}-cos{a}+1)")
    ] });
    let run = |trial: &mut Trial, tool: &Value, a_step: f64| {
        let mut scene = block(tool.clone(), pressed(), None, 1);
        scene["solution"] = turning(360.0, a_step);
        trial.done(&scene)
    };
    let fine = run(trial, &turned, 15.0)?;
    let rise = fine.at("force.tool.z", 0.6)? / fine.at("force.tool.z", 0.2)?;
    trial.holds("the cam presses on by half", rise > 1.5);
    for a_step in [45.0, 90.0] {
        let coarse = run(trial, &turned, a_step)?;
        for name in STATE {
            let right = fine.at(name, 0.6)?;
            let what = format!("{name} half round, {a_step} degrees a step against 15");
            trial.equal(what, coarse.at(name, 0.6)?, right, 1e-9);
        }
        let back = change(&coarse, &STATE[1..], 0.2, 1.0)?;
        trial.within(
            format!("after a turn by {a_step} degrees a step"),
            back,
            1e-9,
        );
    }
    let circle = run(trial, &moved, 15.0)?;
    trial.within(
        "turned against moved on a circle",
        difference(&fine, &circle, &STATE)?,
        1e-9,
    );
    trial.iterations(550);
    Ok(())
}

pub fn together(trial: &mut Trial) -> Result<(), CaseError> {
    let a = "(2*pi*max(0,t-0.2)/0.8)";
    let (dx, dz) = ("(0.002*min(t/0.2,1))", "(-0.02*min(t/0.2,1))");
    let columns = [
        "energy.internal",
        "energy.contact",
        "energy.friction",
        "pressure.max",
    ];
    for (axis, name) in [
        ([0, 0, 1], "about the normal"),
        ([0, 1, 0], "with the normal"),
    ] {
        let mut tool = plane();
        tool["motion"] = json!({ "rotation": {
            "axis": axis, "angle": { "table": [[0, 0], [0.2, 0], [1, 360]] }
        } });
        let top = match name {
            "about the normal" => json!({
                "x": format!("cos{a}*(x+{dx}) - sin{a}*y - x"),
                "y": format!("sin{a}*(x+{dx}) + cos{a}*y - y"),
                "z": dz
            }),
            _ => json!({
                "x": format!("cos{a}*(x+{dx}) + sin{a}*(z+{dz}) - x"),
                "y": 0,
                "z": format!("-sin{a}*(x+{dx}) + cos{a}*(z+{dz}) - z")
            }),
        };
        let mut scene = block(tool, top, Some(json!(0.8)), 1);
        scene["contacts"]["slide"]["tangential_penalty"] = json!({ "scaled": 1 });
        scene["solution"] = turning(360.0, 60.0);
        let outcome = trial.done(&scene)?;
        let force = |t: f64| {
            let f = ["x", "y", "z"].map(|c| outcome.at(&format!("force.tool.{c}"), t));
            let [x, y, z] = f;
            Ok::<_, CaseError>([x?, y?, z?])
        };
        let [before, after] = [force(0.2)?, force(1.0)?];
        trial.holds(
            "pressed and sheared",
            before[2] > 1.0 && before[0].abs() > 1e-3,
        );
        for third in 1..=3 {
            let t = 0.2 + 0.8 * f64::from(third) / 3.0;
            let off = change(&outcome, &columns, 0.2, t)?;
            trial.within(format!("{name}, {} degrees", 120 * third), off, 1e-9);
        }
        for (c, axis) in ["x", "y", "z"].iter().enumerate() {
            let off = (after[c] - before[c]) / before[2];
            trial.within(
                format!("{name}: force along {axis} after a turn"),
                off,
                1e-9,
            );
        }
    }
    trial.iterations(1200);
    Ok(())
}
