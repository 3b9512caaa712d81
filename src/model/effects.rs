//! The effects a scene calls for, by name: what the run then does, and nothing else.
use super::Model;
use super::friction::LawModel;
use crate::scene::{
    Element, FacetKind, Gap, MasterSurface, Material, Passes, Points, Scene, Stabilization, Tangent,
};
use std::collections::BTreeSet;

/// Names of the effects that are on, sorted.
pub fn effects(scene: &Scene, model: &Model) -> Vec<String> {
    let mut on = BTreeSet::new();
    let mut add = |name: &str| {
        on.insert(name.to_owned());
    };
    add(model
        .small
        .as_ref()
        .map_or("large_rotation", |_| "small_displacements"));
    for body in scene.bodies.values() {
        add(match body.element {
            Element::H8 => "element.h8_solid_shell",
            Element::H8Displacement => "element.h8_displacement",
            Element::Q18 => "element.q18_solid_shell",
        });
        match scene.materials.get(&body.material) {
            Some(Material::StVenantKirchhoff(_)) => add("material.st_venant_kirchhoff"),
            Some(Material::NeoHooke(_)) => add("material.neo_hooke"),
            None => {}
        }
    }
    for contact in scene.contacts.values() {
        add("contact.normal.penalty");
        if scene.surfaces.contains_key(&contact.master) {
            add("contact.master.rigid");
        } else {
            add("contact.master.deformable");
        }
        if contact.master_surface == Some(MasterSurface::Smooth) {
            add("contact.master.smooth");
        }
        let master = model.surfaces.iter().find(|s| s.name == contact.master);
        if let Some(facets) = master.and_then(|s| s.facets.as_ref()) {
            add(match facets.kind {
                FacetKind::Bilinear => "contact.master.rigid.facets.bilinear",
                FacetKind::Biquadratic => "contact.master.rigid.facets.biquadratic",
                FacetKind::Smooth => "contact.master.rigid.facets.smooth",
            });
        }
        add(match contact.points {
            Points::Nodes => "contact.points.nodes",
            Points::Gauss(_) => "contact.points.gauss",
            Points::Lobatto(_) => "contact.points.lobatto",
            Points::Segments(_) => "contact.points.segments",
        });
        if contact.gap == Gap::Averaged {
            add("contact.gap.averaged");
        }
        if contact.passes == Passes::TwoHalf {
            add("contact.passes.two_half");
        }
        add(match contact.tangent {
            Tangent::Exact => "contact.tangent.exact",
            Tangent::Published { .. } => "contact.tangent.published",
        });
    }
    for pair in &model.pairs {
        if pair.augmentation.is_some() {
            add("contact.augmentation");
        }
        if pair.offset > 0.0 {
            add("contact.offset");
        }
    }
    for friction in model.pairs.iter().filter_map(|p| p.friction.as_ref()) {
        add(match friction.law {
            LawModel::Coulomb { .. } => "contact.friction.coulomb",
            LawModel::Orthotropic { .. } => "contact.friction.orthotropic",
        });
    }
    if model
        .pairs
        .iter()
        .any(|p| p.body_master().is_some_and(|m| m.own.is_some()))
    {
        add("contact.self");
    }
    if model.driven().next().is_some() {
        add("surface.driven_by_force");
    }
    if !model.dead_loads.is_empty() {
        add("load.dead");
    }
    if !model.follower_loads.is_empty() {
        add("load.follower_pressure");
    }
    if let Stabilization::Viscous { .. } = scene.solution.stabilization {
        add("stabilization.viscous");
    }
    if !model.symmetric {
        add("system.unsymmetric");
    }
    if !model.means.is_empty() {
        add("support.mid_surface");
    }
    on.into_iter().collect()
}
