//! Probes: which nodes a curve of the history is about.
use super::BodyModel;
use crate::scene::{ProbeQuantity, ProbeTake};
use covact_geometry::Vec3;

/// A probe whose nodes are known.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeModel {
    pub name: String,
    pub quantity: ProbeQuantity,
    pub take: ProbeTake,
    /// Nodes of the model, ascending.
    pub nodes: Vec<u32>,
}

impl ProbeModel {
    /// Whether it has a single column; else one for each axis.
    pub fn is_scalar(&self) -> bool {
        self.quantity == ProbeQuantity::VonMises || self.take == ProbeTake::Max
    }
}

/// The node of some bodies that is nearest to a point of the undeformed configuration.
pub fn nearest_node<'b>(
    bodies: impl Iterator<Item = &'b BodyModel>,
    point: [f64; 3],
) -> Option<u32> {
    let point = Vec3::from(point);
    let distances = bodies.flat_map(|body| {
        let nodes = body.mesh.nodes.iter().zip(body.first_node..);
        nodes.map(move |(x, n)| ((x - point).norm_squared(), n))
    });
    let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, node)| node)
}
