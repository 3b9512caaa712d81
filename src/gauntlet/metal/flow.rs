//! Von Mises' flow: cubes in uniform states, and a sheet under a ball.
use crate::gauntlet::drawn::difference;
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Outcome, Trial};
use serde_json::{Value, json};

/// Young's modulus, yield stress and slope of the hardening.
const E: f64 = 200e3;
const YIELD: f64 = 200.0;
const SLOPE: f64 = 800.0;
const PENALTY: f64 = 1e7;

/// A law of this name with linear hardening.
pub fn metal(law: &str) -> Value {
    json!({ law: {
        "E": E, "nu": 0.3, "hardening": { "linear": { "yield_stress": YIELD, "slope": SLOPE } }
    } })
}

/// A cube under a plane that moves along z.
fn cube(element: &str, way: Value, solution: Value) -> Value {
    json!({
        "covact": 1,
        "materials": { "m": metal("j2") },
        "bodies": { "cube": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [2, 2, 2] } },
            "material": "m",
            "element": element
        } },
        "surfaces": { "tool": {
            "plane": { "center": [0, 0, 1], "normal": [0, 0, -1], "size": [9, 9] },
            "motion": { "translation": [0, 0, way] }
        } },
        "contacts": { "press": {
            "slave": "cube.top", "master": "tool", "points": { "gauss": 2 }, "penalty": { "value": PENALTY }
        } },
        "supports": {
            "z": { "on": "cube.bottom", "symmetry": "z" },
            "x": { "on": "cube.x_min", "symmetry": "x" },
            "y": { "on": "cube.y_min", "symmetry": "y" }
        },
        "solution": solution,
        "output": { "every": 0 }
    })
}

/// Root of a function that falls from positive to negative values between two places.
fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match f(middle) > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

/// Force of the plane at this height on the cube, and the plastic strain of the cube.
fn pressed(height: f64) -> (f64, f64) {
    // Kirchhoff's stress at a stretch: that of the hardening at the strain that is left for flow.
    let stress = |stretch: f64| {
        let strain = -stretch.ln();
        root(0.0, E * strain, |s| {
            YIELD + SLOPE * (strain - s / E).max(0.0) - s
        })
    };
    let stretch = root(height, 1.0, |l| stress(l) / l - PENALTY * (l - height));
    let stress = stress(stretch);
    (stress / stretch, -stretch.ln() - stress / E)
}

pub fn upset(trial: &mut Trial) -> Result<(), CaseError> {
    let (force, p) = pressed(0.7);
    let work = YIELD * p + 0.5 * SLOPE * p * p;
    for element in ["h8", "h8_displacement", "h8_mean_dilatation"] {
        let out = trial.done(&cube(element, json!("-0.3*t"), solution(8)))?;
        let name = format!("force, {element}");
        trial.equal(name, out.last("force.tool.z")?, -force, 1e-9);
        let name = format!("largest pressure, {element}");
        trial.equal(name, out.last("pressure.max")?, force, 1e-9);
        // The trapezoidal rule counts the first step, which begins without stress, by half.
        let tolerance = 0.6 / out.summary.steps as f64;
        let name = format!("plastic work, {element}");
        trial.equal(name, out.last("energy.plastic")?, work, tolerance);
    }
    trial.iterations(175);
    Ok(())
}

pub fn any_step(trial: &mut Trial) -> Result<(), CaseError> {
    let (force, _) = pressed(0.9);
    let mut steps = Vec::new();
    for n in [1, 4, 20] {
        let out = trial.done(&cube("h8_displacement", json!("-0.1*t"), solution(n)))?;
        trial.equal(
            format!("force, {n} step(s)"),
            out.last("force.tool.z")?,
            -force,
            1e-9,
        );
        steps.push(out.summary.steps);
    }
    trial.holds("one step is one", steps[0] == 1 && steps[2] >= 20);
    trial.iterations(93);
    Ok(())
}

pub fn reloaded(trial: &mut Trial) -> Result<(), CaseError> {
    let until = |end: u32| {
        let mut solution = solution(8);
        solution["end_time"] = end.into();
        solution
    };
    let way = json!({ "table": [[0, 0], [1, -0.1], [2, -0.05], [3, -0.1], [4, -0.2]] });
    let paused = trial.done(&cube("h8_displacement", way, until(4)))?;
    let way = json!({ "table": [[0, 0], [1, -0.1], [2, -0.2]] });
    let straight = trial.done(&cube("h8_displacement", way, until(2)))?;
    let force = paused.at("force.tool.z", 1.0)?;
    trial.equal("force", force, -pressed(0.9).0, 1e-9);
    trial.holds("let go", paused.at("force.tool.z", 2.0)? == 0.0);
    trial.within(
        "strain energy once let go",
        paused.at("energy.internal", 2.0)? / paused.at("energy.internal", 1.0)?,
        1e-12,
    );
    let again = paused.at("force.tool.z", 3.0)?;
    trial.equal("force at the same strain again", again, force, 1e-8);
    for name in ["force.tool.z", "energy.internal", "energy.plastic"] {
        let what = format!("{name} at the end");
        trial.equal(what, paused.last(name)?, straight.last(name)?, 1e-8);
    }
    trial.iterations(140);
    Ok(())
}

/// A quarter of a clamped sheet of `size` under a ball with friction, lengths times `length`, forces times `force`.
pub fn sheet(material: Value, size: [f64; 2], length: f64, force: f64) -> Value {
    let stress = force / (length * length);
    let elements = size.map(|s| (s / 2.0).round());
    json!({
        "covact": 1,
        "materials": { "m": material },
        "bodies": { "sheet": {
            "mesh": { "plate": {
                "size": size.map(|s| s * length), "thickness": length, "elements": elements.map(|e| e as u32)
            } },
            "material": "m"
        } },
        "surfaces": { "ball": {
            "sphere": { "radius": 4.0 * length, "center": [0, 0, 4.5 * length] },
            "motion": { "translation": [0, 0, format!("{:?}*t", -1.5 * length)] }
        } },
        "contacts": { "press": {
            "slave": "sheet.top", "master": "ball", "points": { "gauss": 2 }, "friction": 0.1,
            "penalty": { "value": 2e4 * stress / length }, "tangential_penalty": { "value": 2e4 * stress / length }
        } },
        "supports": {
            "x": { "on": "sheet.x_min", "symmetry": "x" },
            "y": { "on": "sheet.y_min", "symmetry": "y" },
            "rim": { "on": ["sheet.x_max", "sheet.y_max"], "fixed": true }
        },
        "solution": solution(6),
        "output": { "every": 0 }
    })
}

/// Columns that tell the state of the sheet.
pub const SHEET: [&str; 6] = [
    "force.ball.z",
    "energy.internal",
    "energy.contact",
    "energy.plastic",
    "energy.dissipated",
    "pressure.max",
];

/// That the sheet has flowed.
pub fn flows(trial: &mut Trial, out: &Outcome) -> Result<(), CaseError> {
    let part = out.last("energy.plastic")? / out.last("energy.external")?;
    trial.holds("most of the work flows", part > 0.5);
    Ok(())
}

pub fn one_curve(trial: &mut Trial) -> Result<(), CaseError> {
    let line = trial.done(&sheet(metal("j2"), [10.0, 10.0], 1.0, 1.0))?;
    flows(trial, &line)?;
    for (name, hardening) in [
        (
            "table",
            json!({ "table": [[0, YIELD], [1, YIELD + SLOPE]] }),
        ),
        (
            "power law",
            json!({ "swift": { "strength": SLOPE, "offset": YIELD / SLOPE, "exponent": 1 } }),
        ),
    ] {
        let mut material = metal("j2");
        material["j2"]["hardening"] = hardening;
        let other = trial.done(&sheet(material, [10.0, 10.0], 1.0, 1.0))?;
        let off = difference(&line, &other, &SHEET)?;
        trial.within(format!("difference, {name}"), off, 1e-9);
    }
    trial.iterations(195);
    Ok(())
}

pub fn units(trial: &mut Trial) -> Result<(), CaseError> {
    let here = trial.done(&sheet(metal("j2"), [10.0, 10.0], 1.0, 1.0))?;
    flows(trial, &here)?;
    let (length, force) = (25.4e-3, 4.4e5);
    let stress = force / (length * length);
    let mut material = metal("j2");
    let law = &mut material["j2"];
    law["E"] = json!(E * stress);
    law["hardening"]["linear"] = json!({ "yield_stress": YIELD * stress, "slope": SLOPE * stress });
    let there = trial.done(&sheet(material, [10.0, 10.0], length, force))?;
    for name in SHEET {
        let unit = match name {
            "force.ball.z" => force,
            "pressure.max" => stress,
            _ => force * length,
        };
        trial.equal(name, there.last(name)? / unit, here.last(name)?, 1e-9);
    }
    trial.iterations(130);
    Ok(())
}

pub fn swings(trial: &mut Trial) -> Result<(), CaseError> {
    let (modulus, recovery, swing, yields) = (20e3, 100.0, 0.02f64, 300.0);
    let mut way = vec![[0.0, 0.0]];
    for k in 1..=12 {
        let strain = if k % 2 == 1 { swing } else { -swing };
        way.push([f64::from(k), strain.exp() - 1.0]);
    }
    let mut solution = solution(20);
    solution["end_time"] = 12.into();
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "armstrong_frederick": {
            "E": E, "nu": 0.3, "hardening": { "linear": { "yield_stress": yields } },
            "back_stress": { "modulus": modulus, "recovery": recovery }
        } } },
        "bodies": { "bar": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1] } }, "material": "m"
        } },
        "supports": {
            "z": { "on": "bar.bottom", "symmetry": "z" },
            "x": { "on": "bar.x_min", "symmetry": "x" },
            "y": { "on": "bar.y_min", "symmetry": "y" },
            "pull": { "on": "bar.x_max", "displacement": { "x": { "table": way } } }
        },
        "solution": solution,
        "output": { "every": 0 }
    });
    let out = trial.done(&scene)?;
    // The plastic strain of a swing follows from the stress: a fixed point.
    let mut right = yields;
    for _ in 0..100 {
        let plastic = 2.0 * swing - 2.0 * right / E;
        right = yields + modulus / recovery * (0.5 * recovery * plastic).tanh();
    }
    for (time, side) in [(11.0, 1.0), (12.0, -1.0)] {
        let force = out.at("force.pull.x", time)?;
        let stress = force * (side * swing).exp();
        trial.equal(format!("stress at {time}"), side * stress, right, 1e-9);
    }
    trial.iterations(745);
    Ok(())
}
