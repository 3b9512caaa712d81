//! The whole traction of contact at the nodes, for the output.
use crate::contact::points::SlavePoint;
use crate::model::{BodyModel, Model};
use crate::output::{Field, Place};
use covact_geometry::Vec3;

/// Traction that masters exert on slaves, normal and tangential, at all nodes of the model; empty where no fields are
/// written.
#[derive(Default)]
pub(super) struct TractionFields {
    /// Three numbers a node (force / length^2).
    traction: Vec<f64>,
    /// Weighted tractions of the pair at hand, with their weights; zero outside a pair.
    sums: Vec<(Vec3, f64)>,
}

impl TractionFields {
    pub fn new(nodes: usize) -> Self {
        TractionFields {
            traction: vec![0.0; 3 * nodes],
            sums: vec![(Vec3::zeros(), 0.0); nodes],
        }
    }

    /// Forgets what was gathered.
    pub fn clear(&mut self) {
        self.traction.fill(0.0);
    }

    /// Takes over the traction at a point, by shape functions and area.
    pub fn add(&mut self, model: &Model, point: &SlavePoint, traction: Vec3) {
        if self.sums.is_empty() {
            return;
        }
        for (node, n) in model.terms(point) {
            let (sum, weight) = &mut self.sums[node];
            *sum += n * point.area * traction;
            *weight += n * point.area;
        }
    }

    /// Adds a traction at a node.
    pub fn add_at(&mut self, node: usize, traction: Vec3) {
        if let Some(at) = self.traction.get_mut(3 * node..3 * node + 3) {
            at.iter_mut().zip(&traction).for_each(|(at, t)| *at += t);
        }
    }

    /// Ends a pair: tractions of several surfaces on the same face add up.
    pub fn end(&mut self, model: &Model, points: &[SlavePoint]) {
        if self.sums.is_empty() {
            return;
        }
        for (node, _) in points.iter().flat_map(|p| model.terms(p)) {
            let (sum, weight) = std::mem::take(&mut self.sums[node]);
            if weight > 0.0 {
                for (k, t) in (sum / weight).iter().enumerate() {
                    self.traction[3 * node + k] += t;
                }
            }
        }
    }

    /// The field of a body; none where it is no slave, or where a pair of it has averaged gaps, whose pressures belong to
    /// nodes and not to points with a direction.
    pub fn of(&self, model: &Model, index: usize, body: &BodyModel) -> Option<Field<'_>> {
        let mut own = model.pairs.iter().filter(|p| p.body == index).peekable();
        own.peek()?;
        if own.any(|pair| pair.averaged.is_some()) {
            return None;
        }
        let first = 3 * body.first_node as usize;
        Some(Field {
            name: "contact_traction",
            components: 3,
            component_names: &[],
            data: self
                .traction
                .get(first..first + 3 * body.mesh.nodes.len())?,
            place: Place::Point,
        })
    }
}
