//! Limits: small displacements, and contact that does not give way.
use crate::gauntlet::elements::between_planes;
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use serde_json::{Value, json};

/// A block with its bottom fixed, under a plane that starts flush on it.
fn block(depth: f64, kinematics: &str) -> Value {
    let mut solution = solution(2);
    solution["newton"]["tolerance"] = json!(1e-10);
    solution["kinematics"] = kinematics.into();
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 100, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 0.5], "elements": [4, 4, 2] } },
            "material": "m",
            "element": "h8_displacement"
        } },
        "surfaces": { "plane": {
            "plane": { "size": [9, 9], "center": [0, 0, 0.5], "normal": [0, 0, -1] },
            "motion": { "translation": [0, 0, format!("{:?}*t", -depth)] }
        } },
        "contacts": { "press": {
            "slave": "block.top", "master": "plane", "penalty": { "value": 2e3 }, "points": { "gauss": 2 }
        } },
        "supports": { "floor": { "on": "block.bottom", "fixed": true } },
        "solution": solution,
        "output": { "every": 0 }
    })
}

pub fn limit(trial: &mut Trial) -> Result<(), CaseError> {
    let (mut errors, mut stiffness) = (Vec::new(), Vec::new());
    for depth in [4e-3, 2e-3, 1e-3] {
        let large = trial.done(&block(depth, "large"))?;
        let small = trial.done(&block(depth, "small"))?;
        let [a, b] = [&large, &small].map(|out| out.last("force.plane.z"));
        let (a, b) = (a?, b?);
        errors.push((b / a - 1.0).abs());
        stiffness.push(b / depth);
    }
    for i in 1..3 {
        // Half the depth, half the difference, and an eighth of second order.
        trial.equal(
            "difference of half the depth",
            errors[i] / errors[i - 1],
            0.5,
            0.02,
        );
        trial.equal(
            "stiffness of small displacements",
            stiffness[i],
            stiffness[0],
            1e-9,
        );
    }
    trial.iterations(32);
    Ok(())
}

pub fn superposed(trial: &mut Trial) -> Result<(), CaseError> {
    // The plane presses enough for every point to stay in contact under the side's pressure.
    let side = json!({ "on": "block.x_min", "pressure": "0.02*t" });
    let plane = trial.done(&block(2e-3, "small"))?;
    let mut both = block(2e-3, "small");
    both["loads"]["side"] = side.clone();
    let both = trial.done(&both)?;
    let mut more = block(3e-3, "small");
    more["loads"]["side"] = side;
    let more = trial.done(&more)?;
    let shallow = trial.done(&block(1e-3, "small"))?;
    for (name, out) in [("plane", &plane), ("both", &both), ("more", &more)] {
        let all = out.last("points.active")? == 64.0;
        trial.holds(format!("all points touch, {name}"), all);
    }
    for name in ["force.plane.z", "force.floor.x", "moment.plane.y"] {
        let [a, b] = [more.last(name)? - both.last(name)?, shallow.last(name)?];
        let scale = both.last(name)?.abs();
        trial.holds(format!("{name} is something"), scale > 1e-3);
        trial.within(
            format!("{name} of 1e-3 more, with the side's pressure and without"),
            (a - b) / scale,
            1e-9,
        );
    }
    // And what the side adds does not depend on the depth.
    let pressed = both.last("force.floor.x")? - plane.last("force.floor.x")?;
    trial.equal("force along x", pressed, -0.02 * 0.5, 1e-8);
    trial.iterations(12);
    Ok(())
}

pub fn multipliers(trial: &mut Trial) -> Result<(), CaseError> {
    let (right, _) = between_planes(0.7, false, 1e13);
    for penalty in [100.0, 1e4] {
        for points in [json!("nodes"), json!({ "gauss": 2 })] {
            let scene = json!({
                "covact": 1,
                "materials": { "m": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
                "bodies": { "block": {
                    "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [3, 3, 2] } },
                    "material": "m",
                    "element": "h8_displacement"
                } },
                "surfaces": { "tool": {
                    "plane": { "size": [9, 9], "center": [0, 0, 1], "normal": [0, 0, -1] },
                    "motion": { "translation": [0, 0, "-0.3*t"] }
                } },
                "contacts": { "press": {
                    "slave": "block.top", "master": "tool", "penalty": { "value": penalty }, "points": points,
                    "augmentation": { "gap": 1e-7, "max": 200 }
                } },
                "supports": {
                    "z": { "on": "block.bottom", "symmetry": "z" },
                    "x": { "on": "block.x_min", "symmetry": "x" },
                    "y": { "on": "block.y_min", "symmetry": "y" }
                },
                "solution": solution(3),
                "output": { "every": 0 }
            });
            let out = trial.done(&scene)?;
            let name = format!("penalty {penalty}, {points}");
            trial.equal(
                format!("force, {name}"),
                out.last("force.tool.z")?,
                right,
                1e-6,
            );
            trial.equal(
                format!("pressure, {name}"),
                out.last("pressure.max")?,
                -right,
                1e-6,
            );
        }
    }
    trial.iterations(225);
    Ok(())
}
