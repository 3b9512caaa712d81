//! Scenes that cases change.
use super::CaseError;
use covact_geometry::{NurbsPatch, Vec3};
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

/// Part of a cylinder along y about (x, 0, z) from one angle to another (from x towards z, radians), between two values of y.
///
/// # Errors
/// The angles are the same, or half a turn apart.
pub fn arc(
    [x, z]: [f64; 2],
    radius: f64,
    [from, to]: [f64; 2],
    y: [f64; 2],
) -> Result<NurbsPatch, CaseError> {
    let (half, middle) = (0.5 * (to - from), 0.5 * (to + from));
    let w = half.cos();
    let at = |angle: f64, r: f64, y: f64| Vec3::new(x + r * angle.cos(), y, z + r * angle.sin());
    let points: Vec<Vec3> = (y.iter())
        .flat_map(|y| {
            [
                at(from, radius, *y),
                at(middle, radius / w, *y),
                at(to, radius, *y),
            ]
        })
        .collect();
    let knots = [vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let weights = [1.0, w, 1.0, 1.0, w, 1.0];
    NurbsPatch::new([2, 1], knots, [3, 2], &points, Some(&weights))
        .map_err(|e| CaseError::new(e.to_string()))
}
