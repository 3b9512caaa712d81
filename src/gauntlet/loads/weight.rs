//! Bodies under their own weight.
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use serde_json::json;

pub fn column(trial: &mut Trial) -> Result<(), CaseError> {
    let (e, weight, height, penalty) = (1.0, 1e-2, 10.0, 100.0);
    // The bar of St. Venant and Kirchhoff: E / 2 (l^2 - 1) l is the weight above. Midpoint rule, error below 1e-8.
    let (parts, mut shorter, mut stored) = (2000, 0.0, 0.0);
    for i in 0..parts {
        let above = weight * height * (f64::from(i) + 0.5) / f64::from(parts);
        let (mut low, mut high) = (0.6f64, 1.0f64);
        for _ in 0..100 {
            let l = 0.5 * (low + high);
            match 0.5 * e * (l * l - 1.0) * l > -above {
                true => high = l,
                false => low = l,
            }
        }
        let strain = 0.5 * (low * low - 1.0);
        shorter += (1.0 - low) * height / f64::from(parts);
        stored += 0.5 * e * strain * strain * height / f64::from(parts);
    }
    let total = weight * height;
    let mut errors = Vec::new();
    for n in [5, 10] {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": e, "nu": 0, "density": 1e-3 } } },
            "bodies": { "column": {
                "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, height], "elements": [1, 1, n] } }, "material": "m"
            } },
            "surfaces": { "floor": { "plane": { "size": [9, 9] } } },
            "contacts": { "stand": { "slave": "column.bottom", "master": "floor", "penalty": { "value": penalty } } },
            "supports": {
                "x": { "on": "column.x_min", "symmetry": "x" }, "y": { "on": "column.y_min", "symmetry": "y" }
            },
            "loads": { "weight": { "on": "column", "gravity": [0, 0, format!("{:?}*t", -weight / 1e-3)] } },
            "probes": { "top": { "on": "column.top" } },
            "solution": solution(2),
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        let what = format!("force of the floor, {n} elements");
        // The body without supports along z is stabilised until it stands.
        trial.equal(what, out.last("force.floor.z")?, total, 1e-5);
        let top = -out.last("probe.top.z")? - total / penalty;
        errors.push([
            (top / shorter - 1.0).abs(),
            (out.last("energy.internal")? / stored - 1.0).abs(),
        ]);
    }
    trial.within("shortening, 10 elements", errors[1][0], 5e-4);
    for (i, name) in ["shortening", "energy"].into_iter().enumerate() {
        let what = format!("error of the {name} of 10 elements by that of 5");
        trial.within(what, errors[1][i] / errors[0][i], 0.27);
    }
    trial.iterations(22);
    Ok(())
}

pub fn lifted(trial: &mut Trial) -> Result<(), CaseError> {
    let (e, thickness, weight, lift, width, length) = (1e6, 0.1f64, 0.2, 0.4, 0.4, 24.0);
    let stiffness = e * thickness.powi(3) / 12.0;
    let free = (24.0 * stiffness * lift / weight).powf(0.25);
    let mut solution = solution(10);
    solution["newton"]["tolerance"] = json!(1e-9);
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": e, "nu": 0, "density": weight / thickness } } },
        "bodies": { "strip": {
            "mesh": { "plate": {
                "size": [length, width], "thickness": thickness, "elements": [60, 1], "origin": [0, 0, 0.5 * thickness]
            } },
            "material": "m"
        } },
        "surfaces": { "floor": { "plane": { "size": [99, 9] } } },
        "contacts": { "lie": { "slave": "strip.bottom", "master": "floor", "penalty": { "value": 300 } } },
        "supports": {
            "x": { "on": "strip.x_min", "symmetry": "x" },
            "faces": { "on": ["strip.y_min", "strip.y_max"], "symmetry": "y" },
            "lift": { "on": "strip.x_max", "mid_surface": true, "displacement": { "z": format!("{lift}*t") } }
        },
        "loads": { "weight": { "on": "strip", "gravity": [0, 0, { "table": [[0, 0], [0.2, -1], [1, -1]] }] } },
        "solution": solution,
        "output": { "every": 0 }
    });
    let out = trial.done(&scene)?;
    let right = 0.5 * weight * width * free;
    // The slopes are a twentieth, whose square is what the beam leaves out.
    trial.equal("force of the lift", out.last("force.lift.z")?, right, 3e-3);
    let lying = out.last("area.contact")? / width;
    trial.holds(
        "a part lies on the floor",
        lying > 0.5 && lying < length - 1.0,
    );
    trial.equal(
        "floor and lift bear the weight",
        out.last("force.floor.z")? + out.last("force.lift.z")?,
        weight * width * length,
        1e-9,
    );
    trial.iterations(62);
    Ok(())
}

pub fn catenary(trial: &mut Trial) -> Result<(), CaseError> {
    // Half of a strip of length S per half, tension in its middle q a.
    let (half, a, e, thickness, weight, width) = (5.0f64, 4.0f64, 1e7, 0.002, 1.0, 0.3);
    let stretch = weight / (e * thickness);
    let span = a * (half / a).asinh() + stretch * a * half;
    let sag = half.hypot(a) - a + 0.5 * stretch * half * half;
    let mut errors = Vec::new();
    for n in [20, 40] {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": e, "nu": 0, "density": weight / thickness } } },
            "bodies": { "strip": {
                "mesh": { "plate": { "size": [half, width], "thickness": thickness, "elements": [n, 1] } },
                "material": "m"
            } },
            "supports": {
                "middle": { "on": "strip.x_min", "symmetry": "x" },
                "faces": { "on": ["strip.y_min", "strip.y_max"], "symmetry": "y" },
                "hang": { "on": "strip.x_max", "mid_surface": true, "displacement": {
                    "x": format!("{:?}*t", span - half), "y": 0, "z": 0
                } }
            },
            "loads": { "weight": { "on": "strip", "gravity": [0, 0, { "table": [[0, -1e-3], [0.1, -1], [1, -1]] }] } },
            "probes": { "middle": { "on": "strip.x_min" } },
            "solution": { "step": { "initial": 0.01, "max": 0.1 }, "newton": { "tolerance": 1e-9 } },
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        errors.push((-out.last("probe.middle.z")? / sag - 1.0).abs());
        let what = format!("force that holds an end up, {n} elements");
        trial.equal(what, out.last("force.hang.z")?, weight * half * width, 1e-8);
        let what = format!("tension in the middle, {n} elements");
        trial.equal(what, out.last("force.hang.x")?, weight * a * width, 4e-4);
    }
    trial.within("sag, 40 elements", errors[1], 2e-4);
    // Bending takes a part of the sag that does not fall with the size of elements.
    trial.within(
        "error of 40 elements by that of 20",
        errors[1] / errors[0],
        0.35,
    );
    trial.iterations(700);
    Ok(())
}
