//! Strips from thick to paper-thin.
use super::super::scenes::solution;
use super::super::{CaseError, Trial};
use serde_json::json;

const E: f64 = 1e4;
const WIDTH: f64 = 0.1;

/// A strip of length 1, clamped at x = 0, its free end pushed down by 1 % of its length by a cylinder across it.
///
/// ```text
/// |                              (o)  d
/// |================================
/// ```
pub fn thickness(trial: &mut Trial) -> Result<(), CaseError> {
    let depth = 1e-2;
    for (element, n, tolerance) in [("h8", 20, 1e-2), ("q18", 10, 5e-3)] {
        for t in [1e-1_f64, 1e-2, 1e-3, 1e-4] {
            let mut scene = json!({
                "covact": 1,
                "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": 0 } } },
                "bodies": { "strip": {
                    "mesh": { "plate": {
                        "size": [1, WIDTH], "thickness": t, "elements": [n, 1], "origin": [0, 0, -t / 2.0]
                    } },
                    "material": "m",
                    "element": element
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
            scene["solution"]["newton"]["tolerance"] = 1e-9.into();
            let out = trial.done(&scene)?;
            let d = depth - out.last("penetration.max")?;
            // Timoshenko: bending 4 L^3 / (E b t^3), shear 6/5 L / (G b t).
            let bending = 4.0 / (E * WIDTH * t.powi(3));
            let shear = 1.2 / (0.5 * E * WIDTH * t);
            let right = d / (bending + shear);
            let force = -out.last("force.tool.z")?;
            trial.equal(
                format!("force of {element} at t/L = {t}"),
                force,
                right,
                tolerance,
            );
            let other = out.last("force.clamp.z")?;
            trial.equal(format!("its clamp at t/L = {t}"), other, force, 1e-4);
            trial.within(
                format!("penetration of {element} at t/L = {t} over the path"),
                out.last("penetration.max")? / depth,
                // The error of the force that an automatic penalty aims at: for a point, all of its ratio to the way.
                1e-2,
            );
        }
    }
    trial.iterations(560);
    Ok(())
}
