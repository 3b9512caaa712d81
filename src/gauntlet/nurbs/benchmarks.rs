//! Closed forms of beams and membranes.
use super::{body, face};
use crate::gauntlet::scenes::arc;
use crate::gauntlet::{CaseError, Trial};
use covact_geometry::Vec3;
use serde_json::json;
use std::f64::consts::{FRAC_PI_2, PI};

pub fn rolled(trial: &mut Trial) -> Result<(), CaseError> {
    let (length, thickness, e) = (12.0, 0.1f64, 1.2e6);
    let couple = 2.0 * PI * e * thickness.powi(3) / 12.0 / length;
    let patch = face(Vec3::zeros(), Vec3::new(length, 0.0, 0.0), Vec3::y())?;
    let mut errors = Vec::new();
    for n in [8, 16] {
        let keys = json!({ "thickness": thickness, "elements": [n, 1] });
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": e, "nu": 0 } } },
            "bodies": { "sheet": body(trial, "strip", vec![patch.clone()], keys)? },
            "supports": { "clamp": { "on": "sheet.edge.1", "clamped": true } },
            "loads": { "roll": { "on": "sheet.edge.2", "couple": format!("{couple:?}*t") } },
            "probes": { "tip": { "on": "sheet.corner.2" } },
            "solution": { "step": { "initial": 0.1 } },
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        let [x, z] = ["x", "z"].map(|a| out.last(&format!("probe.tip.{a}")));
        errors.push([
            (x? + length).hypot(z?) / length,
            (out.last("energy.internal")? / (couple * PI) - 1.0).abs(),
        ]);
    }
    trial.within(
        "end from the start by length, 16 elements",
        errors[1][0],
        1e-3,
    );
    trial.within("energy, 16 elements", errors[1][1], 1e-3);
    // Cubic elements: of fourth order in the energy, to which 8 of them on a circle come near.
    trial.within(
        "error of 16 elements by that of 8",
        errors[1][1] / errors[0][1],
        0.1,
    );
    trial.iterations(385);
    Ok(())
}

pub fn frame(trial: &mut Trial) -> Result<(), CaseError> {
    let (arm, foot, thickness, e, force) = (4.0, 6.0, 0.1f64, 1e6, 1e-4);
    let stiffness = e * thickness.powi(3) / 12.0;
    let up = face(Vec3::zeros(), Vec3::new(0.0, 0.0, foot), Vec3::y())?;
    let out = face(
        Vec3::new(0.0, 0.0, foot),
        Vec3::new(arm, 0.0, 0.0),
        Vec3::y(),
    )?;
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": e, "nu": 0 } } },
        "bodies": { "frame": body(trial, "frame", vec![up, out], json!({ "thickness": thickness, "size": 1 }))? },
        "supports": { "foot": { "on": "frame.1.edge.1", "clamped": true } },
        "loads": { "push": { "on": "frame.2.edge.2", "force": [0, 0, format!("-{force:?}*t")] } },
        "probes": { "tip": { "on": "frame.2.corner.2" } },
        // Positions have sixteen digits, of which small displacements leave few.
        "solution": { "step": { "initial": 1, "max": 1 }, "newton": { "tolerance": 1e-7 } },
        "output": { "every": 0 }
    });
    let out = trial.done(&scene)?;
    let down = force * (arm * arm * foot + arm.powi(3) / 3.0) / stiffness;
    let aside = force * arm * foot * foot / 2.0 / stiffness;
    trial.equal("down", out.last("probe.tip.z")?, -down, 5e-4);
    trial.equal("aside", out.last("probe.tip.x")?, aside, 5e-4);
    trial.iterations(24);
    Ok(())
}

pub fn tube(trial: &mut Trial) -> Result<(), CaseError> {
    let (mu, thickness, radius, nu, stretch) = (1.0, 0.01, 10.0, 0.4999, 1.3f64);
    let pressure = mu * thickness / radius * (1.0 - stretch.powi(-4));
    // From z towards x, so that the normal points outside.
    let patch = arc([0.0, 0.0], radius, [FRAC_PI_2, 0.0], [0.0, 5.0])?;
    let keys = json!({ "thickness": thickness, "elements": [4, 2] });
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 2.0 * mu * (1.0 + nu), "nu": nu } } },
        "bodies": { "tube": body(trial, "tube", vec![patch], keys)? },
        "supports": {
            "x": { "on": "tube.edge.1", "symmetry": "x" },
            "z": { "on": "tube.edge.2", "symmetry": "z" },
            "ends": { "on": ["tube.edge.3", "tube.edge.4"], "symmetry": "y" }
        },
        "loads": { "blow": { "on": "tube.bottom", "pressure": format!("{pressure:?}*t"), "follower": true } },
        "probes": { "side": { "on": "tube.corner.2" } },
        "solution": { "step": { "initial": 0.1 } },
        "output": { "every": 0 }
    });
    let out = trial.done(&scene)?;
    let grown = out.last("probe.side.x")? / radius;
    trial.equal("widening", grown, stretch - 1.0, 1e-3);
    trial.iterations(32);
    Ok(())
}
