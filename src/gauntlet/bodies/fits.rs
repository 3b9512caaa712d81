//! Closed forms of elastic contact: Lame's tubes and Hertz's line.
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Young's modulus and Poisson's ratio.
const E: f64 = 1000.0;
const NU: f64 = 0.3;

/// Quarter of a tube about y of these radii.
fn tube([inner, outer]: [f64; 2], elements: u32, layers: u32) -> Value {
    json!({
        "mesh": { "cylinder_panel": {
            "radius": 0.5 * (inner + outer), "thickness": outer - inner, "angles": [0, 90], "y": [0, 0.2],
            "elements": [elements, 1], "layers": layers
        } },
        "material": "m",
        "element": "h8_displacement"
    })
}

pub fn shrunk(trial: &mut Trial) -> Result<(), CaseError> {
    let ([a, b, c], fit) = ([1.0f64, 1.5, 2.0], 0.002);
    // Both tubes are of one material, so that its Poisson's ratio enters by the modulus of plane strain alone.
    let plane = E / (1.0 - NU * NU);
    let (a2, b2, c2) = (a * a, b * b, c * c);
    let pressure = plane * fit / b * (b2 - a2) * (c2 - b2) / (2.0 * b2 * (c2 - a2));
    let mut errors = Vec::new();
    for n in [8, 16] {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": NU } } },
            "bodies": {
                "pin": tube([a, b + 0.5 * fit], n, n / 4),
                "ring": tube([b - 0.5 * fit, c], 3 * n / 2, n / 4)
            },
            "contacts": { "fit": {
                "slave": "pin.outer", "master": "ring.inner", "penalty": { "value": 1e6 }, "points": { "gauss": 2 },
                "depth": 0.1, "initial_overclosure": { "shrink": { "until": 1 } }
            } },
            "supports": {
                "x": { "on": ["pin.phi_min", "ring.phi_min"], "symmetry": "x" },
                "z": { "on": ["pin.phi_max", "ring.phi_max"], "symmetry": "z" },
                "y": { "on": ["pin.y_min", "pin.y_max", "ring.y_min", "ring.y_max"], "symmetry": "y" }
            },
            "solution": solution(2),
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        let [x, z] = ["x", "z"].map(|axis| out.last(&format!("slave.force.fit.{axis}")));
        let (x, z) = (x?, z?);
        trial.equal("force along x and z", x, z, 1e-7);
        errors.push((-x / (0.2 * b) / pressure - 1.0).abs());
    }
    trial.within("mean pressure, 16 elements", errors[1], 5e-3);
    trial.within(
        "error of 16 elements by that of 8",
        errors[1] / errors[0],
        0.5,
    );
    trial.iterations(12);
    Ok(())
}

pub fn line(trial: &mut Trial) -> Result<(), CaseError> {
    let (n, radius) = (24u32, 100.0);
    let fine =
        |from_end: bool| json!({ "fine": { "length": 1, "fine": n / 2, "from_end": from_end } });
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": NU } } },
        "bodies": { "block": {
            "mesh": { "block": {
                "min": [0, 0, -8], "max": [8, 0.2, 0], "elements": [n, 1, n],
                "spacing": [fine(false), "uniform", fine(true)]
            } },
            "material": "m",
            "element": "h8_displacement"
        } },
        "surfaces": { "roller": {
            "cylinder": { "radius": radius, "length": 4, "center": [0, 0.1, radius], "axis": [0, 1, 0] },
            "side": "outward",
            "motion": { "translation": [0, 0, "-0.006*t"] }
        } },
        "contacts": { "press": {
            "slave": "block.top", "master": "roller", "points": { "gauss": 2 }, "penalty": { "value": 1e6 }
        } },
        "supports": {
            "middle": { "on": "block.x_min", "symmetry": "x" },
            "flat": { "on": "block", "plane_strain": "y" },
            "floor": { "on": "block.bottom", "fixed": true }
        },
        "solution": solution(2),
        "output": { "every": 0 }
    });
    let out = trial.done(&scene)?;
    // Of the whole block, per length.
    let force = -2.0 * out.last("force.roller.z")? / 0.2;
    let plane = E / (1.0 - NU * NU);
    let peak = (force * plane / (PI * radius)).sqrt();
    let half_width = 2.0 * (force * radius / (PI * plane)).sqrt();
    trial.equal("largest pressure", out.last("pressure.max")?, peak, 5e-3);
    let width = out.last("area.contact")? / 0.2;
    trial.within(
        "half width, off by elements",
        (width - half_width) * f64::from(n / 2),
        1.0,
    );
    trial.iterations(24);
    Ok(())
}
