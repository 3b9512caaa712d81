//! Bending.
use super::super::scenes::solution;
use super::super::{CaseError, Trial};
use serde_json::json;
use std::f64::consts::PI;

const E: f64 = 1000.0;
const WIDTH: f64 = 0.1;

/// The free end of a strip of length 1 follows the end of an arc of that length, from straight to a full circle.
pub fn full_circle(trial: &mut Trial) -> Result<(), CaseError> {
    let t = 1e-3;
    let moment = E * WIDTH * t * t * t / 12.0 * 2.0 * PI;
    let mut errors = Vec::new();
    for (element, n, tolerance) in [("h8", 16, 4e-2), ("h8", 32, 1e-2), ("q18", 16, 2e-4)] {
        // Centre of the arc at height R = 1 / angle.
        let angle = format!("({:?}*(t+1e-9))", 2.0 * PI);
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": 0 } } },
            "bodies": { "strip": {
                "mesh": { "plate": { "size": [1, WIDTH], "thickness": t, "elements": [n, 1] } },
                "material": "m",
                "element": element
            } },
            "supports": {
                "end": { "on": "strip.x_max", "displacement": {
                    "x": format!("(1/{angle}-z)*sin({angle})-1"),
                    "z": format!("1/{angle}-(1/{angle}-z)*cos({angle})-z")
                } },
                "clamp": { "on": "strip.x_min", "fixed": true },
                "front": { "on": "strip.y_min", "symmetry": "y" },
                "back": { "on": "strip.y_max", "symmetry": "y" }
            },
            "solution": {
                "step": { "initial": 0.05, "max": 0.05 },
                "newton": { "tolerance": 1e-8 }
            },
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        let name = format!("{element} of {n}");
        let found = out.last("moment.clamp.y")?;
        trial.equal(format!("moment, {name}"), found, moment, tolerance);
        let other = out.last("moment.end.y")?;
        trial.equal(
            format!("moment of the other end, {name}"),
            -other,
            found,
            1e-6,
        );
        let work = moment * PI;
        trial.equal(
            format!("energy, {name}"),
            out.last("energy.internal")?,
            work,
            tolerance,
        );
        let pull = out.last("force.clamp.x")?.hypot(out.last("force.clamp.z")?);
        trial.within(format!("pull over moment, {name}"), pull / moment, 1e-3);
        trial.holds("stable", out.warnings("negative pivot").is_empty());
        errors.push((found / moment - 1.0).abs());
    }
    trial.within(
        "error of h8 at half the length, over a quarter",
        4.0 * errors[1] / errors[0],
        1.1,
    );
    trial.iterations(1300);
    Ok(())
}

/// The strip of `conditioning/thickness`, in layers.
pub fn layers(trial: &mut Trial) -> Result<(), CaseError> {
    let (t, depth) = (0.02_f64, 1e-2);
    for layers in [1, 2, 8] {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "neo_hooke": { "E": E, "nu": 0 } } },
            "bodies": { "strip": {
                "mesh": { "plate": {
                    "size": [1, WIDTH], "thickness": t, "elements": [20, 1], "layers": layers, "origin": [0, 0, -t / 2.0]
                } },
                "material": "m"
            } },
            "surfaces": { "tool": {
                "cylinder": { "radius": 0.02, "length": 0.4, "center": [1, WIDTH / 2.0, 0.02], "axis": [0, 1, 0] },
                "motion": { "translation": [0, 0, format!("-{depth}*t")] }
            } },
            "contacts": { "press": { "slave": "strip.top", "master": "tool" } },
            "supports": {
                "clamp": { "on": "strip.x_min", "fixed": true },
                "front": { "on": "strip.y_min", "symmetry": "y" },
                "back": { "on": "strip.y_max", "displacement": { "y": 0 } }
            },
            "solution": solution(2),
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        let d = depth - out.last("penetration.max")?;
        let bending = 4.0 / (E * WIDTH * t.powi(3));
        let shear = 1.2 / (0.5 * E * WIDTH * t);
        let force = -out.last("force.tool.z")?;
        trial.equal(
            format!("force, {layers} layer(s)"),
            force,
            d / (bending + shear),
            1e-2,
        );
    }
    trial.iterations(210);
    Ok(())
}
