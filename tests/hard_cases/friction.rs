//! Scenes with friction that the tests change: a small block whose top is moved, on a rigid surface.
//!
//! ```text
//!       top: prescribed
//!      +-----------+
//!      |   block   |        z
//!      +-----------+        |_ x
//!   ~~~~~ surface "tool" ~~~~~
//! ```
use crate::support::{Outcome, solve};
use serde_json::{Value, json};

/// The block of 1 x 0.5 x 0.5 on `tool`, `steps` equal steps from 0 to 1; its top has the displacement `top`.
pub fn block(tool: Value, top: Value, mu: Value, steps: u32) -> Value {
    let step = 1.0 / f64::from(steps);
    json!({
        "covact": 1,
        "materials": { "rubber": { "st_venant_kirchhoff": { "E": 100, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [-0.5, -0.25, 0], "max": [0.5, 0.25, 0.5], "elements": [5, 2, 2] } },
            "material": "rubber",
            "element": "h8_displacement"
        } },
        "surfaces": { "tool": tool },
        "contacts": { "slide": {
            "slave": "block.bottom", "master": "tool", "points": { "gauss": 2 },
            "penalty": { "value": 2e4 }, "tangential_penalty": { "scaled": 1 },
            "friction": { "coulomb": { "mu": mu } }
        } },
        "supports": { "top": { "on": "block.top", "displacement": top } },
        "solution": {
            "step": { "initial": step, "max": step, "adaptive": false },
            "newton": { "tolerance": 1e-11 },
            "threads": 1
        },
        "output": { "every": 0 }
    })
}

/// A plane under the block.
pub fn plane() -> Value {
    json!({ "plane": { "size": [8, 8] }, "side": { "point": [0, 0, 5] } })
}

/// Runs a scene to its end.
pub fn done(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    outcome
}

/// What is stored and dissipated at the end of a run.
pub fn book(outcome: &Outcome) -> f64 {
    let columns = &outcome.history.columns;
    ["internal", "contact", "friction", "dissipated"]
        .iter()
        // Without friction the last two are not there.
        .filter(|part| columns.contains(&format!("energy.{part}")))
        .map(|part| outcome.column(&format!("energy.{part}")).last().copied())
        .map(|v| v.expect("a step"))
        .sum()
}

/// Work of a generalised force, a column of the history, along `way(t)` by the trapezoidal rule; both zero at the start.
pub fn work(outcome: &Outcome, force: &[f64], way: impl Fn(f64) -> f64) -> f64 {
    let times = outcome.column("time");
    let (mut sum, mut before) = (0.0, (0.0, way(0.0)));
    for (t, f) in times.into_iter().zip(force) {
        let now = (*f, way(t));
        sum += 0.5 * (before.0 + now.0) * (now.1 - before.1);
        before = now;
    }
    sum
}

/// The value of a table at `t`.
pub fn table(points: &[[f64; 2]], t: f64) -> f64 {
    let at = (points.windows(2)).find(|w| t <= w[1][0] + 1e-12);
    let [a, b] = at
        .map(|w| [w[0], w[1]])
        .unwrap_or([points[0], points[points.len() - 1]]);
    a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0])
}
