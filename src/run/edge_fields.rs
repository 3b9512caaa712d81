//! What edges that are slaves carry, in the contact fields of the body that they press on.
//!
//! Points on edges of a master are slaves on the faces of the slave ([`PairModel::edges_of`]). Their forces act on these faces beside
//! those of the slave's own points. At a node they are its shares of them by the shape functions of the face, over the area that
//! the slave's own points give it: fields sum to the whole force.
use super::traction_fields::TractionFields;
use crate::model::master::BodySurface;
use crate::model::state::State;
use crate::model::{Model, PairModel};
use covact_geometry::{Hint, ShapeRows, Vec3};
use std::collections::BTreeMap;

/// The force of a point on an edge.
pub(super) struct EdgeForce {
    /// Where on the faces.
    pub at: Hint,
    /// On the faces.
    pub force: Vec3,
    /// The normal part of it, which presses.
    pub normal: f64,
}

/// Adds the forces of the points of a pair whose slaves are `edges` to the pressures and the tractions at the nodes of `surface`.
pub(super) fn spread(
    (model, state): (&Model, &State),
    edges: &PairModel,
    surface: &BodySurface,
    forces: &[EdgeForce],
    (pressure, traction): (&mut [f64], &mut TractionFields),
) {
    let (Some(of), false) = (edges.edges_of, forces.is_empty()) else {
        return;
    };
    let mut shares: BTreeMap<usize, (Vec3, f64)> = BTreeMap::new();
    let mut rows = ShapeRows::default();
    for force in forces {
        surface.facets.shape(force.at.patch, force.at.xi, &mut rows);
        let nodes = surface.facets.nodes(force.at.patch);
        for (node, n) in nodes.iter().zip(&rows.n[..rows.count]) {
            let (sum, normal) = shares.entry(*node as usize).or_default();
            *sum += *n * force.force;
            *normal += n * force.normal;
        }
    }
    let mut areas: BTreeMap<usize, f64> = BTreeMap::new();
    for point in state.slaves(model, of) {
        for (node, n) in model.terms(point) {
            if shares.contains_key(&node) {
                *areas.entry(node).or_default() += n * point.area;
            }
        }
    }
    for (node, (force, normal)) in shares {
        let area = areas.get(&node).copied().unwrap_or(0.0);
        if area > 0.0 {
            pressure[node] += normal / area;
            traction.add_at(node, force / area);
        }
    }
}
