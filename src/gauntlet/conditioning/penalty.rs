//! Blocks pressed by planes: springs in series.
use super::super::scenes::{block_under, solution};
use super::super::{CaseError, Trial};
use serde_json::{Value, json};

/// A block of edge 1 on a frictionless floor, pressed from above by a plane that comes down by `depth` in `steps` steps.
fn pressed(element: &str, law: Value, depth: f64, steps: u32) -> Value {
    let n = if element == "q18" { 2 } else { 4 };
    json!({
        "covact": 1,
        "materials": { "m": law },
        "bodies": { "block": {
            "mesh": { "plate": {
                "size": [1, 1], "thickness": 1, "elements": [n, n], "layers": 2, "origin": [0, 0, 0.5]
            } },
            "material": "m",
            "element": element
        } },
        "surfaces": { "tool": {
            "plane": { "center": [0, 0, 1], "normal": [0, 0, -1], "size": [4, 4] },
            "motion": { "translation": [0, 0, format!("-{depth}*t")] }
        } },
        "contacts": { "press": { "slave": "block.top", "master": "tool", "points": { "gauss": 2 } } },
        "supports": {
            "floor": { "on": "block.bottom", "symmetry": "z" },
            "left": { "on": "block.x_min", "symmetry": "x" },
            "front": { "on": "block.y_min", "symmetry": "y" }
        },
        "solution": solution(steps),
        "output": { "every": 0 }
    })
}

pub fn poisson(trial: &mut Trial) -> Result<(), CaseError> {
    let (e, depth) = (100.0, 1e-3);
    for element in ["h8", "q18", "h8_displacement"] {
        for nu in [0.0, 0.3, 0.49, 0.4999] {
            let law = json!({ "neo_hooke": { "E": e, "nu": nu } });
            let mut scene = pressed(element, law, depth, 1);
            scene["supports"]["right"] = json!({ "on": "block.x_max", "symmetry": "x" });
            scene["supports"]["back"] = json!({ "on": "block.y_max", "symmetry": "y" });
            let out = trial.done(&scene)?;
            let (lambda, mu) = lame(e, nu);
            let l = 1.0 - depth + out.last("penetration.max")?;
            // P = mu (l - 1/l) + lambda ln l / l for neo-Hooke without lateral strain.
            let right = mu * (l - 1.0 / l) + lambda * l.ln() / l;
            let force = out.last("force.tool.z")?;
            trial.equal(
                format!("force of {element} at nu = {nu}"),
                force,
                right,
                1e-9,
            );
            // Confined compression is (1 - nu) / (1 + nu) / (1 - 2 nu) times as stiff as E.
            let stiffness = force / (l - 1.0) / e;
            let confined = (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
            trial.equal(
                format!("stiffness of {element} at nu = {nu}"),
                stiffness,
                confined,
                3e-3,
            );
        }
    }
    trial.iterations(60);
    Ok(())
}

fn lame(e: f64, nu: f64) -> (f64, f64) {
    (
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        0.5 * e / (1.0 + nu),
    )
}

/// Root of an increasing function between `low` and `high`.
fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match f(middle) > 0.0 {
            true => high = middle,
            false => low = middle,
        }
    }
    0.5 * (low + high)
}

/// Force that shortens a bar of St. Venant and Kirchhoff's law, nu = 0, length and section 1, by `d`.
fn bar(e: f64, d: f64) -> f64 {
    let l = 1.0 - d;
    0.5 * e * l * (1.0 - l * l)
}

/// The elements are 1/2 high: their stiffness is 2 E.
const MULTIPLES: [f64; 8] = [0.1, 1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6];

pub fn penalty(trial: &mut Trial) -> Result<(), CaseError> {
    let (e, depth) = (100.0, 1e-2);
    let rigid = bar(e, depth);
    for multiple in MULTIPLES {
        let eps = 2.0 * e * multiple;
        let law = json!({ "st_venant_kirchhoff": { "E": e, "nu": 0 } });
        let mut scene = pressed("h8", law, depth, 2);
        scene["contacts"]["press"]["penalty"] = json!({ "value": eps });
        let out = trial.done(&scene)?;
        let force = -out.last("force.tool.z")?;
        let g = root(0.0, depth, |g| eps * g - bar(e, depth - g));
        let right = bar(e, depth - g);
        // A position's rounding times the penalty is 2e-16 * 2e8 of a force of 1.
        trial.equal(
            format!("force at {multiple:e}"),
            force,
            right,
            1e-8 + 1e-13 * multiple,
        );
        // Springs in series: 1/F = 1/F_rigid + 1/(eps d), to first order of the strain.
        let lost = (rigid / force - 1.0) * eps / e;
        trial.equal(
            format!("error times penalty at {multiple:e}"),
            lost,
            1.0,
            0.04,
        );
    }
    trial.iterations(60);
    Ok(())
}

pub fn under_ball(trial: &mut Trial) -> Result<(), CaseError> {
    let mut forces = Vec::new();
    for multiple in MULTIPLES {
        let ball = json!({
            "sphere": { "radius": 0.5 },
            "placement": { "translation": [0, 0, 1.0] },
            "motion": { "translation": [0, 0, "-0.1*t"] }
        });
        let mut scene = block_under(ball, 6, 4);
        // Elements 1/4 high of modulus 100.
        scene["contacts"]["press"]["penalty"] = json!({ "value": 400.0 * multiple });
        let out = trial.done(&scene)?;
        trial.holds(
            "no step is cut",
            out.column("cuts")?.iter().all(|c| *c == 0.0),
        );
        forces.push(-out.last("force.tool.z")?);
    }
    let rigid = forces[7];
    trial.holds("contact", rigid > 1.0);
    for i in 3..6 {
        let rate = (1.0 - forces[i] / rigid) / (1.0 - forces[i + 1] / rigid);
        // First order; points that come into contact make it a little less or more.
        trial.within(
            format!("order from {:e} on", MULTIPLES[i]),
            rate.log10() - 1.0,
            0.1,
        );
    }
    trial.iterations(400);
    Ok(())
}

pub fn stiffness_ratio(trial: &mut Trial) -> Result<(), CaseError> {
    let depth = 1e-2;
    for (lower, upper) in [(1e2, 1e8), (1e8, 1e2)] {
        let mut forces = Vec::new();
        for (slave, master) in [("lower.top", "upper.bottom"), ("upper.bottom", "lower.top")] {
            let block = |material: &str, z: f64| {
                json!({
                    "mesh": { "plate": {
                        "size": [1, 1], "thickness": 1, "elements": [2, 2], "origin": [0, 0, z]
                    } },
                    "material": material
                })
            };
            let scene = json!({
                "covact": 1,
                "materials": {
                    "lower": { "st_venant_kirchhoff": { "E": lower, "nu": 0 } },
                    "upper": { "st_venant_kirchhoff": { "E": upper, "nu": 0 } }
                },
                "bodies": { "lower": block("lower", 0.5), "upper": block("upper", 1.5) },
                "contacts": { "press": { "slave": slave, "master": master, "points": { "gauss": 2 } } },
                "supports": {
                    "floor": { "on": "lower.bottom", "fixed": true },
                    "head": { "on": "upper.top", "displacement": { "x": 0, "y": 0, "z": format!("-{depth}*t") } }
                },
                "solution": solution(2),
                "output": { "every": 0 }
            });
            let out = trial.done(&scene)?;
            let d = depth - out.last("penetration.max")?;
            let first = root(0.0, d, |x| bar(lower, x) - bar(upper, d - x));
            // The softer side keeps the digits of the difference.
            let right = if lower < upper {
                bar(lower, first)
            } else {
                bar(upper, d - first)
            };
            let force = -out.last("force.head.z")?;
            trial.equal(
                format!("force with {slave} as the slave"),
                force,
                right,
                1e-8,
            );
            trial.within("balance", out.last("imbalance.force.press")? / force, 1e-12);
            forces.push(force);
        }
        trial.equal("both roles", forces[1], forces[0], 1e-8);
    }
    trial.iterations(32);
    Ok(())
}
