//! How far a drawn tool is above a drawn body.
use super::draw::{BodyKind, Tool};

/// Where a tool is: displaced, and turned about the vertical through its centre by an angle in radians.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Place {
    pub aside: [f64; 2],
    pub turn: f64,
}

/// Points of a side that are looked at, along each direction.
const SAMPLES: usize = 41;

impl BodyKind {
    /// Half of the lengths along x and y, seen from above.
    pub fn half(&self) -> [f64; 2] {
        match *self {
            BodyKind::Sheet { size, .. }
            | BodyKind::Block { size, .. }
            | BodyKind::SheetOnBlock { size, .. } => size.map(|s| 0.5 * s),
            BodyKind::Arch {
                radius,
                thickness,
                half_angle,
                half_width,
            } => [
                (radius + 0.5 * thickness) * half_angle.to_radians().sin(),
                half_width,
            ],
        }
    }

    /// Height of the side that the tool meets.
    fn height(&self, x: f64) -> f64 {
        match *self {
            BodyKind::Arch {
                radius, thickness, ..
            } => {
                let outer = radius + 0.5 * thickness;
                (outer * outer - x * x).max(0.0).sqrt() - outer
            }
            _ => 0.0,
        }
    }
}

/// Smallest height of the tool above the points of the body's side that `wanted` picks by x and y; infinite where the
/// tool is above none of them.
pub fn clearance(
    tool: &Tool,
    center: [f64; 3],
    at: Place,
    body: &BodyKind,
    wanted: impl Fn(f64, f64) -> bool,
) -> f64 {
    let half = body.half();
    let (s, c) = at.turn.sin_cos();
    let mut least = f64::INFINITY;
    let mut look = |x: f64, y: f64, z: f64| {
        // A little beyond the edges too, between which and the samples of a patch there is a slope.
        if x.abs() <= half[0] + 0.3 && y.abs() <= half[1] + 0.3 && wanted(x, y) {
            least = least.min(z - body.height(x));
        }
    };
    let steps = |k: usize| k as f64 / (SAMPLES - 1) as f64;
    for (i, j) in (0..SAMPLES).flat_map(|j| (0..SAMPLES).map(move |i| (i, j))) {
        let (u, v) = (steps(i), steps(j));
        if let Tool::Patch(patch) = tool {
            let [d1, d2] = patch.domain();
            let p = patch.point([d1[0] + u * (d1[1] - d1[0]), d2[0] + v * (d2[1] - d2[0])]);
            let [x, y] = [c * p.x - s * p.y, s * p.x + c * p.y];
            look(x + at.aside[0], y + at.aside[1], p.z);
            continue;
        }
        let [x, y] = [(2.0 * u - 1.0) * half[0], (2.0 * v - 1.0) * half[1]];
        let [dx, dy] = [x - center[0] - at.aside[0], y - center[1] - at.aside[1]];
        if let Some(z) = below(tool, [c * dx + s * dy, c * dy - s * dx]) {
            look(x, y, center[2] + z);
        }
    }
    least
}

/// Height of the lower side of a tool over its centre, at a horizontal distance from it; none: it is not there.
fn below(tool: &Tool, [dx, dy]: [f64; 2]) -> Option<f64> {
    let root = |discriminant: f64| (discriminant >= 0.0).then(|| discriminant.sqrt());
    match tool {
        Tool::Sphere { radius } => Some(-root(radius * radius - dx * dx - dy * dy)?),
        Tool::Cylinder { radius, axis } => {
            let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
            let [ax, ay, az] = axis.map(|a| a / length);
            let (along, across) = (dx * ax + dy * ay, 1.0 - az * az);
            let rest = dx * dx + dy * dy - along * along - radius * radius;
            let up = az * along;
            Some((up - root(up * up - across * rest)?) / across)
        }
        Tool::Plane { normal } => Some(-(normal[0] * dx + normal[1] * dy) / normal[2]),
        Tool::Patch(_) => None,
    }
}
