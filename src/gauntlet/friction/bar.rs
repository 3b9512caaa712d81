//! A bar on a plane that is pressed against it evenly: friction takes up the pull along a border of slip that moves.
//!
//! With `q = mu p w` the friction per length and `EA` the bar's stiffness, slip has gone the length `F / q` when its end is
//! pulled by `F`, and the end has moved by `F^2 / (2 EA q)`. Turned back it follows the same curve at twice the scale
//! (G. Masing, 1926); a full cycle between `-u` and `u` dissipates `4/3 F u`.
use crate::gauntlet::{CaseError, Outcome, Trial};
use serde_json::json;

const LENGTH: f64 = 8.0;
const HEIGHT: f64 = 0.125;
const WIDTH: f64 = 0.25;
const E: f64 = 1000.0;
const MU: f64 = 0.002;
/// Compression that the plane makes (strain).
const PRESSED: f64 = 1e-3;
const ELEMENTS: u32 = 40;
/// Way of the end: slip reaches three quarters of the bar.
fn way() -> f64 {
    let q = MU * E * PRESSED * WIDTH;
    (0.75 * LENGTH * q).powi(2) / (2.0 * E * HEIGHT * WIDTH * q)
}

/// The end at parts of the way at times; 20 steps for the whole of it.
fn bar(trial: &mut Trial, path: &[[f64; 2]]) -> Result<Outcome, CaseError> {
    let end: Vec<[f64; 2]> = path.iter().map(|[t, part]| [*t, part * way()]).collect();
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": 0 } } },
        "bodies": { "bar": {
            "mesh": { "block": {
                "min": [0, 0, 0], "max": [LENGTH, WIDTH, HEIGHT], "elements": [ELEMENTS, 1, 1]
            } },
            "material": "m",
            "element": "h8_displacement"
        } },
        "surfaces": { "plane": {
            "plane": { "size": [32, 4] }, "side": { "point": [0, 0, 1] },
            "motion": { "translation": [0, 0, { "table": [[0, 0], [0.2, PRESSED * HEIGHT], [99, PRESSED * HEIGHT]] }] }
        } },
        "contacts": { "hold": {
            "slave": "bar.bottom", "master": "plane", "points": { "lobatto": 2 }, "penalty": { "value": 1e6 },
            "tangential_penalty": { "value": 1e5 }, "friction": { "coulomb": { "mu": MU } }
        } },
        "supports": {
            "front": { "on": "bar.y_min", "symmetry": "y" },
            "back": { "on": "bar.y_max", "symmetry": "y" },
            "middle": { "on": "bar.top", "symmetry": "z" },
            "end": { "on": "bar.x_max", "displacement": { "x": { "table": end } } }
        },
        "solution": {
            "end_time": path[path.len() - 1][0],
            "step": { "initial": 0.05, "max": 0.05, "adaptive": false },
            "newton": { "tolerance": 1e-11 }
        },
        "output": { "every": 0 }
    });
    trial.done(&scene)
}

pub fn slip_front(trial: &mut Trial) -> Result<(), CaseError> {
    let outcome = bar(trial, &[[0.0, 0.0], [0.2, 0.0], [1.2, 1.0]])?;
    let normal = outcome.last("force.plane.z")?;
    trial.equal(
        "pressing force",
        normal,
        E * PRESSED * WIDTH * LENGTH,
        0.011,
    );
    let (q, ea) = (MU * normal / LENGTH, E * HEIGHT * WIDTH);
    let (mut off, mut border) = (0.0f64, 0.0f64);
    let (times, force) = (outcome.column("time")?, outcome.column("force.end.x")?);
    let (slip, stick) = (
        outcome.column("points.slip")?,
        outcome.column("points.stick")?,
    );
    for i in (0..times.len()).filter(|i| times[*i] > 0.3 - 1e-9) {
        let u = (times[i] - 0.2) * way();
        off = off
            .max(force[i] / (2.0 * ea * q * u).sqrt() - 1.0)
            .max(1.0 - force[i] / (2.0 * ea * q * u).sqrt());
        // Columns of nodes that slide, each a length of an element; the border lies within the one after.
        let columns = slip[i] / (slip[i] + stick[i]) * f64::from(ELEMENTS + 1);
        border = border.max((columns - force[i] / q / LENGTH * f64::from(ELEMENTS)).abs());
    }
    trial.within("pull against sqrt(2 EA q u)", off, 1e-3);
    trial.within("border of slip against F / q (elements)", border, 1.0);
    trial.holds(
        "half of the bar slides",
        slip[times.len() - 1] > stick[times.len() - 1],
    );
    trial.iterations(100);
    Ok(())
}

pub fn hysteresis(trial: &mut Trial) -> Result<(), CaseError> {
    let outcome = bar(
        trial,
        &[[0.0, 0.0], [0.2, 0.0], [1.2, 1.0], [3.2, -1.0], [5.2, 1.0]],
    )?;
    let force = |t: f64| outcome.at("force.end.x", t);
    let pull = force(1.2)?;
    trial.holds("friction pulls back", pull > 0.0);
    let mut off = 0.0f64;
    // From a fifth of the way on the slip covers several elements.
    for i in 4..=20 {
        let part = 0.05 * f64::from(i);
        off = off.max((pull - force(1.2 + 2.0 * part)? - 2.0 * force(0.2 + part)?).abs());
    }
    trial.within(
        "turned back against twice the first curve / largest pull",
        off / pull,
        3e-4,
    );
    // Positions are rounded to 1e-16 of their size, which under this penalty is some 1e-10 of the pressure at every step.
    trial.equal("pull at the end of the cycle", force(5.2)?, pull, 5e-9);
    let dissipated =
        outcome.at("energy.dissipated", 5.2)? - outcome.at("energy.dissipated", 1.2)?;
    trial.equal(
        "dissipated by a cycle against 4/3 F u",
        dissipated,
        4.0 / 3.0 * pull * way(),
        1e-3,
    );
    // Work of the end round the loop, by the trapezoidal rule.
    let (times, f) = (outcome.column("time")?, outcome.column("force.end.x")?);
    let at = |t: f64| if t < 3.2 { 1.0 - (t - 1.2) } else { -1.0 + (t - 3.2) } * way();
    let work: f64 = (1..times.len())
        .filter(|i| times[*i] > 1.2 + 1e-9)
        .map(|i| 0.5 * (f[i] + f[i - 1]) * (at(times[i]) - at(times[i - 1])))
        .sum();
    trial.equal(
        "area of the loop against what was dissipated",
        work,
        dissipated,
        6e-3,
    );
    trial.iterations(330);
    Ok(())
}
