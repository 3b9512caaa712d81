//! A block drawn over a rigid surface: the scene that cases of motion and of friction change, and what they compare.
//!
//! ```text
//!       top: prescribed
//!      +-----------+
//!      |   block   |        z
//!      +-----------+        |_ x
//!   ~~~~~ surface "tool" ~~~~~
//! ```
use super::{CaseError, Outcome};
use serde_json::{Value, json};

/// Equal steps of `dt` to `end`, at a tolerance below what is compared; the step is cut where it must be, never enlarged.
pub fn steps(dt: f64, end: f64) -> Value {
    json!({
        "end_time": end,
        "step": { "initial": dt, "max": dt, "min": dt / 1024.0, "adaptive": false },
        "newton": { "tolerance": 1e-11 }
    })
}

/// A block of 1 x 0.5 x 0.5 on `tool`, `count` equal steps from time 0 to 1; its top has the displacement `top`.
pub fn block(tool: Value, top: Value, mu: Option<Value>, count: u32) -> Value {
    let mut scene = json!({
        "covact": 1,
        "materials": { "rubber": { "st_venant_kirchhoff": { "E": 100, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [-0.5, -0.25, 0], "max": [0.5, 0.25, 0.5], "elements": [5, 2, 2] } },
            "material": "rubber",
            "element": "h8_displacement"
        } },
        "surfaces": { "tool": tool },
        "contacts": { "slide": {
            "slave": "block.bottom", "master": "tool", "points": { "gauss": 2 }, "penalty": { "value": 2e4 }
        } },
        "supports": { "top": { "on": "block.top", "displacement": top } },
        "solution": steps(1.0 / f64::from(count), 1.0),
        "output": { "every": 0 }
    });
    if let Some(mu) = mu {
        scene["contacts"]["slide"]["friction"] = json!({ "coulomb": { "mu": mu } });
        // What is compared is to have one tangential penalty throughout.
        scene["contacts"]["slide"]["tangential_penalty"] = json!({ "scaled": 1 });
    }
    scene
}

/// A flat block, 0.1 high, without Poisson's effect: its points all slide at once.
pub fn flat(scene: &mut Value) {
    scene["bodies"]["block"]["mesh"]["block"] =
        json!({ "min": [-0.5, -0.25, 0], "max": [0.5, 0.25, 0.1], "elements": [4, 2, 1] });
    scene["materials"]["rubber"]["st_venant_kirchhoff"]["nu"] = json!(0);
}

/// A plane under the block.
pub fn plane() -> Value {
    json!({ "plane": { "size": [8, 8] }, "side": { "point": [0, 0, 5] } })
}

/// A cylinder of radius 2 along y whose crown touches the block at `x`.
pub fn cylinder(x: f64) -> Value {
    json!({ "cylinder": { "radius": 2, "length": 4, "center": [x, 0, -2], "axis": [0, 1, 0] } })
}

/// Columns that tell the state of a block on a tool.
pub const STATE: [&str; 5] = [
    "force.tool.x",
    "force.tool.z",
    "energy.internal",
    "energy.contact",
    "pressure.max",
];

/// Those and what friction adds.
pub const FRICTION: [&str; 7] = [
    "force.tool.x",
    "force.tool.z",
    "energy.internal",
    "energy.contact",
    "pressure.max",
    "energy.friction",
    "energy.dissipated",
];

/// Largest difference of columns over all steps, relative to the largest value of each.
///
/// # Errors
/// Different numbers of steps, or a column that is zero throughout: it would compare nothing.
pub fn difference(a: &Outcome, b: &Outcome, columns: &[&str]) -> Result<f64, CaseError> {
    let mut largest = 0.0f64;
    for name in columns {
        let (a, b) = (a.column(name)?, b.column(name)?);
        if a.len() != b.len() {
            return Err(CaseError::new("the runs took different steps"));
        }
        let scale = a.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        if scale == 0.0 {
            return Err(CaseError::new(format!("`{name}` is zero throughout")));
        }
        let off = a.iter().zip(&b).map(|(a, b)| (a - b).abs() / scale);
        largest = off.fold(largest, f64::max);
    }
    Ok(largest)
}

/// Largest difference of columns between steps of one run that end at `a` and at `b`, relative to their value at `a`.
///
/// # Errors
/// No such step, or a column that is zero at `a`.
pub fn change(outcome: &Outcome, columns: &[&str], a: f64, b: f64) -> Result<f64, CaseError> {
    let mut largest = 0.0f64;
    for name in columns {
        let (at, then) = (outcome.at(name, a)?, outcome.at(name, b)?);
        if at == 0.0 {
            return Err(CaseError::new(format!("`{name}` is zero at {a}")));
        }
        largest = largest.max(((then - at) / at).abs());
    }
    Ok(largest)
}
