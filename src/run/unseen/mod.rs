//! What slave points do not see: edges of masters, how deep surfaces sink in between them, and faces whose nodes hang over a border.
mod aside;
mod between;
mod edges;
mod hanging;
mod rims;
mod slides;

use crate::model::Model;
pub(in crate::run) use between::Travel;
pub(in crate::run) use hanging::hanging;
pub(in crate::run) use slides::slides;

use between::Between;
use covact_geometry::Vec3;
use edges::EdgeWatch;
use rims::RimWatch;

/// Pairs whose slaves may see more in another variant of the run.
#[derive(Debug, Clone, Default)]
pub(in crate::run) struct MaySee {
    /// Those whose masters may have their edges as slaves.
    pub edges: Vec<usize>,
    /// Those that may have more slave points.
    pub points: Vec<usize>,
    /// Those whose masters may be smooth surfaces.
    pub smooth: Vec<usize>,
}

/// What is looked for in every accepted step.
#[derive(Debug, Default)]
pub(in crate::run) struct Unseen {
    pub rims: RimWatch,
    pub edges: EdgeWatch,
    pub between: Between,
    /// Pairs that may have more slave points in another variant of the run.
    pub more: Vec<usize>,
    /// Pairs whose masters may be smooth surfaces in another variant of the run.
    pub smooth: Vec<usize>,
}

impl Unseen {
    /// What may sink in unseen until the time `end`.
    pub fn new(model: &Model, end: f64, may: &MaySee) -> Self {
        Unseen {
            rims: RimWatch::new(model, end, &may.edges),
            edges: EdgeWatch::new(model, &may.edges),
            between: Between::new(model, end, &may.points),
            more: match model.small.is_some() || model.dynamics.is_some() {
                true => Vec::new(),
                false => may.points.clone(),
            },
            smooth: may.smooth.clone(),
        }
    }
}

/// The farthest that a node of some faces has moved against their mean motion, at displacements `u` (length).
fn deformed(nodes: &[u32], u: &[f64]) -> f64 {
    let at = |n: &u32| {
        let first = 3 * *n as usize;
        Vec3::new(u[first], u[first + 1], u[first + 2])
    };
    let mean = nodes.iter().map(at).sum::<Vec3>() / nodes.len().max(1) as f64;
    (nodes.iter().map(|n| (at(n) - mean).norm())).fold(0.0, f64::max)
}
