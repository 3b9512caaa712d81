//! Slave points near the centre of curvature of a hollow tool, and beyond it.
use super::super::scenes::solution;
use super::{Case, CaseError, Trial, difference};
use serde_json::{Value, json};

pub const FOCAL: Case = Case {
    name: "focal",
    what: "a tube in a bore blown up against it by pressure; the bore 100 times the tube's size with an offset",
    right: "Lame's tube on springs, of second order; offset R - r in a bore R as a bore r, to 1e-8",
    run: focal,
};

pub const BEYOND_FOCAL: Case = Case {
    name: "beyond_focal",
    what: "a block from the axis of a bore, all round it alike near, to its wall; an offset past the axis",
    right: "as the block that starts at the wall, to 1e-9; the offset is refused with the remedy",
    run: beyond_focal,
};

/// Young's modulus.
const E: f64 = 100.0;

/// Quarter of a tube about y of inner and outer radius `a`, `b` in plane strain under inner pressure, in a bore of radius
/// `bore` with an offset that leaves just room for the tube.
fn tube([a, b]: [f64; 2], n: u32, bore: f64, offset: f64, pressure: f64) -> Value {
    json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": E, "nu": 0.3 } } },
        "bodies": { "tube": {
            "mesh": { "cylinder_panel": {
                "radius": 0.5 * (a + b), "thickness": b - a, "angles": [0, 90], "y": [0, 1], "elements": [2 * n, 1],
                "layers": n
            } },
            "material": "steel",
            "element": "h8_displacement"
        } },
        "surfaces": { "bore": {
            "cylinder": { "radius": bore, "length": 4.0 * bore, "axis": [0, 1, 0] },
            "side": { "point": [0, 0, 0.5 * bore] }
        } },
        "contacts": { "press": {
            "slave": "tube.outer", "master": "bore", "points": "nodes", "offset": offset,
            "penalty": { "value": E / b }
        } },
        "supports": {
            "x": { "on": "tube.phi_min", "symmetry": "x" },
            "z": { "on": "tube.phi_max", "symmetry": "z" },
            "front": { "on": "tube.y_min", "symmetry": "y" },
            "back": { "on": "tube.y_max", "symmetry": "y" }
        },
        "loads": { "air": { "on": "tube.inner", "pressure": format!("{pressure}*t") } },
        "solution": solution(2),
        "output": { "every": 0 }
    })
}

fn focal(trial: &mut Trial) -> Result<(), CaseError> {
    let [a, b] = [0.75, 1.0];
    let pressure = 1e-3;
    // Lame in plane strain, u = A r + B / r: s_r(a) = -p and s_r(b) = -k u(b), k = E / b.
    let (e, nu) = (E, 0.3);
    let mu = e / (2.0 * (1.0 + nu));
    let bulk = mu / (1.0 - 2.0 * nu);
    let k = e / b;
    // 2 bulk A - 2 mu B / a^2 = -p; (2 bulk + k b) A + (k / b - 2 mu / b^2) B = 0.
    let m = [
        2.0 * bulk,
        -2.0 * mu / (a * a),
        2.0 * bulk + k * b,
        k / b - 2.0 * mu / (b * b),
    ];
    let det = m[0] * m[3] - m[1] * m[2];
    let u = -pressure * (m[3] * b - m[2] / b) / det;
    // On a quarter of the bore, 1 long, the pressure k u acts along x and z alike.
    let force = k * u * b;
    let mut errors = Vec::new();
    for n in [4, 8] {
        let plain = trial.done(&tube([a, b], n, b, 0.0, pressure))?;
        let [x, z] = [plain.last("force.bore.x")?, plain.last("force.bore.z")?];
        trial.equal("force along x and z", x, z, 1e-9);
        errors.push((-x / force - 1.0).abs());
    }
    trial.within("force of 16 elements round", errors[1], 4e-3);
    trial.within(
        "error of 16 elements by that of 8",
        errors[1] / errors[0],
        0.3,
    );
    // Large displacements, and the bore much larger than the tube.
    let pressure = 4.0;
    let plain = trial.done(&tube([a, b], 8, b, 0.0, pressure))?;
    for bore in [10.0, 100.0] {
        let other = trial.done(&tube([a, b], 8, bore, bore - b, pressure))?;
        for name in [
            "force.bore.x",
            "force.bore.z",
            "energy.internal",
            "energy.contact",
            "pressure.max",
        ] {
            let what = format!("{name} at radius {bore}");
            trial.equal(what, other.last(name)?, plain.last(name)?, 1e-8);
        }
    }
    trial.iterations(60);
    Ok(())
}

/// A block of 1 x 1 x 1, its top fixed, whose bottom lies `start` from the axis of a bore of radius 4 that comes up until the
/// block is pressed by 0.05 at its edges.
fn in_bore(start: f64, table: &Value) -> Value {
    json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": E, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [-0.5, -0.5, 0], "max": [0.5, 0.5, 1], "elements": [4, 4, 2] } },
            "material": "rubber",
            "element": "h8_displacement"
        } },
        "surfaces": { "tool": {
            "cylinder": { "radius": 4, "length": 4, "center": [0, 0, start], "axis": [0, 1, 0] },
            "side": { "point": [0, 0, start] },
            "motion": { "translation": [0, 0, { "table": table }] }
        } },
        "contacts": { "press": {
            "slave": "block.bottom", "master": "tool", "points": "nodes", "penalty": { "value": 2e4 }
        } },
        "supports": { "top": { "on": "block.top", "fixed": true } },
        "solution": solution(4),
        "output": { "every": 0 }
    })
}

fn beyond_focal(trial: &mut Trial) -> Result<(), CaseError> {
    // The edges at x = 0.5 touch when the axis is this high above the bottom.
    let touch = (16.0f64 - 0.25).sqrt();
    let near = touch - 0.01;
    let far = json!([[0, 0], [0.5, near], [1, touch + 0.05]]);
    let near = trial.done(&in_bore(near, &json!([[0, 0], [0.5, 0], [1, 0.06]])))?;
    let far = trial.done(&in_bore(0.0, &far))?;
    trial.holds("contact", near.last("force.tool.z")? > 0.5);
    trial.within("difference", difference(&near, &far)?, 1e-9);
    let message = trial.refused(&tube([0.75, 1.0], 8, 10.0, 10.5, 1.0))?;
    trial.says(
        &message,
        &["`press`", "`bore`", "`tube`", "a smaller `offset`"],
    );
    trial.iterations(30);
    Ok(())
}
