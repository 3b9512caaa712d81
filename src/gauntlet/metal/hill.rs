//! Rolled sheets: Hill's law of 1948.
use super::flow::{SHEET, flows, metal, sheet};
use crate::gauntlet::drawn::difference;
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use serde_json::{Value, json};

/// Hill's law with r-values at 0, 45 and 90 degrees to the rolling direction.
fn rolled(r: [f64; 3], rolling: [f64; 3]) -> Value {
    let mut material = metal("hill48");
    material["hill48"]["r"] = json!(r);
    material["hill48"]["rolling"] = json!(rolling);
    material
}

/// r-values of a steel for deep drawing.
const STEEL: [f64; 3] = [1.8, 1.4, 2.2];

pub fn mises(trial: &mut Trial) -> Result<(), CaseError> {
    let one = trial.done(&sheet(metal("j2"), [12.0, 10.0], 1.0, 1.0))?;
    flows(trial, &one)?;
    let material = rolled([1.0; 3], [1.0, 0.0, 0.0]);
    let other = trial.done(&sheet(material, [12.0, 10.0], 1.0, 1.0))?;
    trial.within("difference", difference(&one, &other, &SHEET)?, 1e-9);
    trial.iterations(132);
    Ok(())
}

pub fn across(trial: &mut Trial) -> Result<(), CaseError> {
    let along = trial.done(&sheet(
        rolled(STEEL, [1.0, 0.0, 0.0]),
        [12.0, 10.0],
        1.0,
        1.0,
    ))?;
    let turned = trial.done(&sheet(
        rolled(STEEL, [0.0, 1.0, 0.0]),
        [10.0, 12.0],
        1.0,
        1.0,
    ))?;
    let across = trial.done(&sheet(
        rolled(STEEL, [0.0, 1.0, 0.0]),
        [12.0, 10.0],
        1.0,
        1.0,
    ))?;
    flows(trial, &along)?;
    trial.within("difference", difference(&along, &turned, &SHEET)?, 1e-9);
    trial.equal(
        "force of the rim",
        turned.last("force.rim.y")?,
        along.last("force.rim.x")?,
        1e-9,
    );
    let other = difference(&along, &across, &SHEET)?;
    trial.holds("the rolling direction matters", other > 1e-3);
    trial.iterations(230);
    Ok(())
}

pub fn strips(trial: &mut Trial) -> Result<(), CaseError> {
    for (angle, r) in [(0.0f64, STEEL[0]), (45.0, STEEL[1]), (90.0, STEEL[2])] {
        let (s, c) = angle.to_radians().sin_cos();
        let mut material = rolled(STEEL, [c, -s, 0.0]);
        // Elastic strains are 1e-5 of the plastic ones.
        material["hill48"]["E"] = json!(200e8);
        let scene = json!({
            "covact": 1,
            "materials": { "m": material },
            "bodies": { "strip": {
                "mesh": { "plate": { "size": [1, 1], "thickness": 1, "elements": [2, 2] } },
                "material": "m",
                // Beside its axes the material shears when it is drawn, which must stay free.
                "sets": { "corner": { "nodes_in_box": { "min": [-0.1, -0.1, -1], "max": [0.1, 0.1, 1] } } }
            } },
            "supports": {
                "x": { "on": "strip.x_min", "symmetry": "x" },
                "y": { "on": "strip.corner", "displacement": { "y": 0 } },
                "z": { "on": "strip.bottom", "symmetry": "z" },
                "pull": { "on": "strip.x_max", "displacement": { "x": "1e-3*t" } }
            },
            "probes": {
                "left": { "on": "strip.y_min" }, "right": { "on": "strip.y_max" },
                "thickness": { "on": "strip.top" }
            },
            "solution": solution(4),
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        let width = out.last("probe.right.y")? - out.last("probe.left.y")?;
        let width = width.ln_1p();
        let thickness = out.last("probe.thickness.z")?.ln_1p();
        trial.holds("it flows", out.last("energy.plastic")? > 0.1);
        trial.equal(format!("r at {angle} degrees"), width / thickness, r, 2e-5);
    }
    trial.iterations(55);
    Ok(())
}
