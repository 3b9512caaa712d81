//! Tools that forces drive and friction holds.
use crate::gauntlet::drawn::{plane, steps};
use crate::gauntlet::{CaseError, Trial};
use crate::output::RunStatus;
use serde_json::{Value, json};

/// Half a wedge of half angle `degrees`, its flank against a block whose back is held; driven down by `force`.
///
/// ```text
///   |  F  /+--------+
///   |  | //         / held
///   |  v// block   /
/// ```
fn driven(degrees: f64, mu: f64, force: Value) -> Value {
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 100, "nu": 0 } } },
        "bodies": { "block": {
            "mesh": { "block": {
                "min": [0, -0.25, -0.5], "max": [0.25, 0.25, 0.5], "elements": [2, 1, 4]
            } },
            "material": "m",
            "element": "h8_displacement",
            "placement": { "axis": [0, 1, 0], "angle": degrees }
        } },
        "surfaces": { "wedge": {
            "plane": { "normal": [1, 0, 0], "size": [6, 6] },
            "placement": { "axis": [0, 1, 0], "angle": degrees },
            "side": { "point": [5, 0, 0] },
            "motion": { "free": { "force": { "z": force } } }
        } },
        "contacts": { "flank": {
            "slave": "block.x_min", "master": "wedge", "points": { "gauss": 2 }, "penalty": { "value": 2e4 },
            "friction": { "coulomb": { "mu": mu } }
        } },
        "supports": { "back": { "on": "block.x_max", "fixed": true } },
        "solution": steps(0.05, 1.0),
        "output": { "every": 0 }
    })
}

pub fn wedge(trial: &mut Trial) -> Result<(), CaseError> {
    let degrees = 10.0f64;
    let a = degrees.to_radians();
    // tan a = 0.1763.
    for mu in [0.17, 0.18] {
        let phi = f64::atan(mu);
        // Below the tangent the least pull takes it out.
        let end = if mu > a.tan() { 0.0 } else { 0.01 };
        let force = json!({ "table": [[0, 0], [0.5, -2], [1, end]] });
        let outcome = trial.solve(&driven(degrees, mu, force))?;
        let ratio = |t: f64| {
            Ok::<_, CaseError>(-outcome.at("force.wedge.z", t)? / outcome.at("force.wedge.x", t)?)
        };
        for t in [0.25, 0.5] {
            trial.equal(
                format!("mu = {mu}: force ratio inwards at {t}"),
                ratio(t)?,
                (a + phi).tan(),
                1e-9,
            );
        }
        let sunk = -outcome.at("displacement.wedge.z", 0.5)?;
        trial.holds("it went in", sunk > 0.1);
        if mu > a.tan() {
            let stays = outcome.summary.status == RunStatus::Done;
            trial.holds("above the tangent it stays, without any force", stays);
            let (x, z) = (
                outcome.last("force.wedge.x")?,
                outcome.last("force.wedge.z")?,
            );
            trial.within("force left along the wedge / across", z / x, 1e-9);
            trial.holds("pressed still", x > 0.9 * outcome.at("force.wedge.x", 0.5)?);
            trial.holds(
                "where it was, but for what it springs back",
                -outcome.last("displacement.wedge.z")? > 0.8 * sunk,
            );
        } else {
            trial.equal(
                "below it slides out: force ratio outwards",
                last_ratio(&outcome)?,
                (a - phi).tan(),
                1e-6,
            );
            let left =
                outcome.summary.status == RunStatus::NotConverged && outcome.summary.time > 0.99;
            trial.holds("and leaves as the force ends", left);
            trial.says(
                outcome.reason(),
                &["surface `wedge`", "along z", "lost all contact"],
            );
        }
    }
    trial.iterations(600);
    Ok(())
}

fn last_ratio(outcome: &crate::gauntlet::Outcome) -> Result<f64, CaseError> {
    Ok(-outcome.last("force.wedge.z")? / outcome.last("force.wedge.x")?)
}

pub fn sled(trial: &mut Trial) -> Result<(), CaseError> {
    let run = |trial: &mut Trial, push: f64, end: f64| {
        let mut plate = plane();
        plate["plane"]["size"] = json!([4, 4]);
        plate["placement"] = json!({ "translation": [0, 0, 0.5] });
        plate["side"] = json!({ "point": [0, 0, -1] });
        plate["motion"] = json!({ "free": { "force": {
            "z": { "table": [[0, 0], [0.2, -2], [1, -2]] },
            "x": { "table": [[0, 0], [0.2, 0], [0.6, push], [1, end]] }
        } } });
        let mut scene = crate::gauntlet::drawn::block(plate, json!(0), Some(json!(1)), 10);
        scene["contacts"]["slide"]["slave"] = json!("block.top");
        scene["supports"] = json!({ "floor": { "on": "block.bottom", "fixed": true } });
        scene["solution"]["step"]["min"] = json!(1e-3);
        trial.solve(&scene)
    };
    // Below: nothing slides, so that the plate springs back.
    let held = run(trial, 0.5, 0.0)?;
    trial.holds("the run ends", held.summary.status == RunStatus::Done);
    let aside = held.at("displacement.tool.x", 0.6)?;
    trial.holds(
        "it is pushed aside, and nothing slides",
        aside > 1e-3 && held.at("points.slip", 0.6)? == 0.0,
    );
    trial.within(
        "way left after the push / way",
        held.last("displacement.tool.x")? / aside,
        1e-9,
    );
    trial.equal("pressing force", held.last("force.tool.z")?, -2.0, 1e-9);
    // Above mu N = 2 there is no equilibrium.
    let slides = run(trial, 2.4, 2.4)?;
    trial.holds(
        "above mu N it does not stay",
        slides.summary.status == RunStatus::NotConverged,
    );
    let most = slides.last("force.tool.x")?;
    trial.holds("carried up to mu N", most > 1.9 && most < 2.0 + 1e-6);
    trial.says(
        slides.reason(),
        &["surface `tool`", "along x", "contact `slide`"],
    );
    trial.iterations(1300);
    Ok(())
}
