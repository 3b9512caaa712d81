//! Bodies that friction or damping bring to rest.
use super::super::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use serde_json::json;

pub fn slides(trial: &mut Trial) -> Result<(), CaseError> {
    let (mu, g, v, height, penalty) = (0.3, 10.0, 2.0, 0.5, 2e4);
    let (time, way) = (v / (mu * g), v * v / (2.0 * mu * g));
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1e5, "nu": 0.3, "density": 1 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [2, 1, height], "elements": [4, 2, 1] } },
            "material": "m",
            "velocity": [v, 0, 0],
            // Sunk in by what carries its weight from the start.
            "placement": { "translation": [0, 0, -g * height / penalty] }
        } },
        "surfaces": { "floor": {
            "plane": { "center": [1, 0.5, 0], "size": [20, 20] }, "side": { "point": [1, 0.5, 1] }
        } },
        "contacts": { "rub": {
            "slave": "block.bottom", "master": "floor", "penalty": { "value": penalty }, "friction": mu
        } },
        "loads": { "weight": { "on": "block", "gravity": [0, 0, -g] } },
        "probes": { "block": { "body": "block" } },
        "solution": {
            "dynamics": {}, "end_time": 1.3 * time, "step": { "initial": time / 100.0, "max": time / 100.0 }
        },
        "output": { "every": 0 }
    });
    let out = trial.done(&scene)?;
    trial.equal("way", out.last("probe.block.x")?, way, 1e-3);
    // Mass and half of the square of the velocity.
    let energy = 2.0 * height * 0.5 * v * v;
    let taken = out.last("energy.dissipated")?;
    trial.equal("energy that friction took", taken, energy, 3e-3);
    trial.iterations(430);
    Ok(())
}

pub fn settles(trial: &mut Trial) -> Result<(), CaseError> {
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 100, "nu": 0.3, "density": 1 } } },
        "bodies": { "strip": {
            "mesh": { "plate": { "size": [4, 1], "thickness": 0.4, "elements": [8, 1] } }, "material": "m"
        } },
        "surfaces": { "bar": {
            "cylinder": { "radius": 1, "length": 4, "center": [2, 0.5, -1.3], "axis": [0, 1, 0] }, "side": "outward"
        } },
        "contacts": { "land": {
            "slave": "strip.bottom", "master": "bar", "penalty": { "value": 1000 }, "points": { "gauss": 2 }
        } },
        "supports": {
            "clamp": { "on": "strip.x_min", "fixed": true },
            "faces": { "on": ["strip.y_min", "strip.y_max"], "symmetry": "y" }
        },
        "loads": { "weight": { "on": "strip", "gravity": [0, 0, "-t"] } },
        "solution": solution(4),
        "output": { "every": 0 }
    });
    let still = trial.done(&scene)?;
    // The whole weight from the start on. By then exp(-30) of the vibrations is left.
    scene["loads"]["weight"]["gravity"] = json!([0, 0, -1]);
    scene["solution"] = json!({
        "dynamics": { "damping": { "mass": 3 } }, "end_time": 20, "step": { "max": 1 }, "newton": { "tolerance": 1e-10 }
    });
    let moved = trial.done(&scene)?;
    let kinetic = moved.column("energy.kinetic")?;
    let highest = kinetic.iter().copied().fold(0.0, f64::max);
    let stored = still.last("energy.internal")?;
    trial.holds("it vibrates", highest > 0.1 * stored);
    for name in [
        "force.bar.z",
        "force.bar.x",
        "energy.internal",
        "pressure.max",
    ] {
        trial.equal(name, moved.last(name)?, still.last(name)?, 1e-4);
    }
    trial.iterations(725);
    Ok(())
}
