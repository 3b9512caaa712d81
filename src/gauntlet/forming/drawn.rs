//! Sheets drawn against friction.
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use serde_json::json;

pub fn holder(trial: &mut Trial) -> Result<(), CaseError> {
    let (force, mu) = (8.0, 0.15);
    let contact = |slave: &str, master: &str| {
        json!({
            "slave": slave, "master": master, "friction": mu, "penalty": { "value": 1e4 }, "points": { "gauss": 2 }
        })
    };
    let mut solution = solution(20);
    solution["newton"]["tolerance"] = json!(1e-10);
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1e4, "nu": 0.3 } } },
        "bodies": { "strip": {
            "mesh": { "plate": { "size": [10, 1], "thickness": 0.2, "elements": [20, 2] } }, "material": "m"
        } },
        "surfaces": {
            "holder": {
                "plane": { "size": [4, 4], "center": [4, 0.5, 0.15], "normal": [0, 0, -1] },
                "motion": { "free": { "force": { "z": { "table": [[0, 0], [0.1, -force], [1, -force]] } } } }
            },
            "plate": { "plane": { "size": [4, 4], "center": [4, 0.5, -0.1] } }
        },
        "contacts": { "above": contact("strip.top", "holder"), "below": contact("strip.bottom", "plate") },
        "supports": { "pull": { "on": "strip.x_max", "displacement": {
            "x": { "table": [[0, 0], [0.1, 0], [1, 1.5]] }, "y": 0
        } } },
        "solution": solution,
        "output": { "every": 0 }
    });
    let out = trial.done(&scene)?;
    let pull = out.column("force.pull.x")?;
    let times = out.column("time")?;
    let late = (times.iter().zip(&pull)).filter(|(t, _)| **t > 0.3);
    let off = late.map(|(_, p)| (p / (2.0 * mu * force) - 1.0).abs());
    trial.within("pull in every step", off.fold(0.0, f64::max), 1e-6);
    trial.equal(
        "force of the plate",
        out.last("force.plate.z")?,
        force,
        1e-6,
    );
    trial.holds(
        "it slides",
        out.last("points.slip")? > 0.0 && out.last("points.stick")? == 0.0,
    );
    trial.iterations(62);
    Ok(())
}

pub fn belt(trial: &mut Trial) -> Result<(), CaseError> {
    let (radius, mu, pull) = (5.0, 0.3, 1.0);
    let wrap = 120f64.to_radians();
    let (s, c) = (0.5 * wrap).sin_cos();
    let grown = |value: f64| json!({ "table": [[0, 0], [0.5, value], [1, value]] });
    let mut exponents = Vec::new();
    for (thickness, elements) in [(0.05, 80), (0.025, 160)] {
        let mut solution = solution(20);
        solution["newton"]["tolerance"] = json!(1e-9);
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 2e4, "nu": 0 } } },
            "bodies": { "belt": {
                "mesh": { "cylinder_panel": {
                    "radius": radius + 0.5 * thickness, "thickness": thickness, "angles": [-60, 60], "y": [0, 0.5],
                    "elements": [elements, 1]
                } },
                "material": "m"
            } },
            "surfaces": { "drum": {
                "cylinder": { "radius": radius, "length": 4, "center": [0, 0.25, 0], "axis": [0, 1, 0] },
                "side": "outward",
                "motion": { "rotation": { "axis": [0, 1, 0], "angle": { "table": [[0, 0], [0.5, 0], [1, 4]] } } }
            } },
            "contacts": { "rub": {
                "slave": "belt.inner", "master": "drum", "friction": mu, "points": { "gauss": 2 },
                "penalty": { "value": 2e4 }, "tangential_penalty": { "value": 2e4 }
            } },
            "supports": {
                "faces": { "on": ["belt.y_min", "belt.y_max"], "symmetry": "y" },
                "hold": { "on": "belt.phi_min", "mid_surface": true, "displacement": { "x": 0, "z": 0 } }
            },
            "loads": { "pull": { "on": "belt.phi_max", "force": [grown(pull * c), 0, grown(-pull * s)] } },
            "solution": solution,
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        trial.holds("all of it slides", out.last("points.stick")? == 0.0);
        let held = out.last("force.hold.x")?.hypot(out.last("force.hold.z")?);
        exponents.push((held / pull).ln() / wrap);
        // The moment of friction about the drum's axis is that of both tensions.
        let arm = radius + 0.5 * thickness;
        trial.equal(
            "moment of the drum",
            out.last("moment.drum.y")?,
            (held - pull) * arm,
            2e-3,
        );
    }
    // A belt of some thickness has friction at its face and tension in its middle: an error that goes with the thickness.
    let [thick, thin] = [exponents[0], exponents[1]];
    trial.within("exponent of the thin belt", thin / mu - 1.0, 1e-2);
    let limit = 2.0 * thin - thick;
    trial.equal("exponent without thickness", limit, mu, 3e-3);
    trial.iterations(170);
    Ok(())
}

pub fn cup(trial: &mut Trial) -> Result<(), CaseError> {
    let mut left = Vec::new();
    for n in [16, 32] {
        let mut solution = solution(n);
        solution["newton"]["tolerance"] = json!(1e-9);
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "j2": {
                "E": 200e3, "nu": 0.3, "hardening": { "linear": { "yield_stress": 200, "slope": 800 } }
            } } },
            "bodies": { "sheet": {
                "mesh": { "plate": { "size": [10, 10], "thickness": 0.5, "elements": [7, 7], "origin": [0, 0, 0.25] } },
                "material": "m"
            } },
            "surfaces": { "ball": {
                "sphere": { "radius": 3, "center": [0, 0, 3.5] },
                "side": "outward",
                "motion": { "translation": [0, 0, "-2*t"] }
            } },
            "contacts": { "press": {
                "slave": "sheet.top", "master": "ball", "penalty": { "value": 2e4 }, "points": { "gauss": 2 }, "friction": 0.1
            } },
            "supports": {
                "x": { "on": "sheet.x_min", "symmetry": "x" },
                "y": { "on": "sheet.y_min", "symmetry": "y" },
                "rim": { "on": ["sheet.x_max", "sheet.y_max"], "fixed": true }
            },
            "solution": solution,
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        let work = out.last("energy.external")?;
        trial.holds("it flows", out.last("energy.plastic")? > 0.5 * work);
        trial.holds("it rubs", out.last("energy.dissipated")? > 1e-4 * work);
        left.push(out.last("energy.imbalance")?.abs() / work);
    }
    trial.within("energy left in the smaller steps", left[1], 2e-3);
    trial.within("energy left in half the step", left[1] / left[0], 0.45);
    trial.iterations(270);
    Ok(())
}
