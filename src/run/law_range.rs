//! Strains at the end of a run beyond those that an elastic law is for.
use super::strain_fields::largest_strain;
use crate::model::error::number;
use crate::model::{BodyModel, Model};
use crate::scene::Material;
use covact_geometry::Vec3;

/// Principal logarithmic strain, either way, up to which a law between Green-Lagrange strain and second Piola-Kirchhoff stress is
/// for: there both strains differ by a tenth.
const SMALL: f64 = 0.1;

/// The same of a linear law in logarithmic strains: stretches of 1/2 to 2.
const MODERATE: f64 = std::f64::consts::LN_2;

/// Bodies that are strained beyond the range of their law, with the largest strain.
pub(super) fn notes(model: &Model, u: &[f64]) -> impl Iterator<Item = String> {
    // What small displacements neglect is told elsewhere.
    let bodies = model.bodies.iter().filter(|_| model.small.is_none());
    bodies.filter_map(|body| note(body, u))
}

fn note(body: &BodyModel, u: &[f64]) -> Option<String> {
    let (limit, help) = match body.material {
        Material::StVenantKirchhoff(_) => (SMALL, "take `neo_hooke` or `hencky`"),
        Material::Hencky(_) => (MODERATE, "take `neo_hooke`"),
        Material::NeoHooke(_)
        | Material::J2(_)
        | Material::Hill48(_)
        | Material::ArmstrongFrederick(_) => return None,
    };
    let nodes = body.first_node as usize..body.first_node as usize + body.mesh.nodes.len();
    let displacement: Vec<Vec3> = nodes
        .map(|n| Vec3::new(u[3 * n], u[3 * n + 1], u[3 * n + 2]))
        .collect();
    let strain = largest_strain(&body.mesh, &displacement);
    (strain.abs() > limit).then(|| {
        format!(
            "body `{}`: a principal logarithmic strain is {} at the end, and the law of {} is for strains up to {}: {help}",
            body.name,
            number(strain),
            body.material.title(),
            number(limit)
        )
    })
}
