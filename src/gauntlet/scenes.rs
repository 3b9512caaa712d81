//! Scenes that cases change.
use serde_json::{Value, json};

/// A step of `1 / steps` from time 0 to 1, a tolerance below what is compared, nothing written but the history.
pub fn solution(steps: u32) -> Value {
    let step = 1.0 / f64::from(steps);
    json!({
        "step": { "initial": step, "max": step },
        "newton": { "tolerance": 1e-11 }
    })
}

/// A block of 1 x 1 x 0.5 on `n` x `n` x 2 elements, its bottom fixed at z = 0, under the rigid surface `tool`.
///
/// ```text
///        tool
///      +-------+  z = 0.5
///      | block |
///      +-------+  z = 0, fixed
/// ```
pub fn block_under(tool: Value, n: u32, steps: u32) -> Value {
    json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [-0.5, -0.5, 0], "max": [0.5, 0.5, 0.5], "elements": [n, n, 2] } },
            "material": "rubber",
            "element": "h8_displacement"
        } },
        "surfaces": { "tool": tool },
        "contacts": { "press": {
            "slave": "block.top", "master": "tool", "points": { "gauss": 2 }, "penalty": { "value": 2e4 }
        } },
        "supports": { "floor": { "on": "block.bottom", "fixed": true } },
        "solution": solution(steps),
        "output": { "every": 0 }
    })
}

/// Leaves the contact of a scene to the slave's points alone, where edges of the tool would become slaves as well: what is compared
/// is how the points see them.
pub fn alone(scene: &mut Value) {
    scene["contacts"]["press"]["passes"] = "one".into();
}
