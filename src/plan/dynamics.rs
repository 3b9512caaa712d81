//! The effects of inertia.
use super::{Effect, Held, Per, Reporter, why};
use crate::assembly::sizes;
use crate::model::EffectKind;
use crate::model::error::number;
use crate::scene::ContactTiming;

impl Reporter<'_> {
    /// Inertia, damping, and viscous material.
    pub(super) fn dynamics(&self) -> [Effect; 3] {
        let model = self.model;
        let own = model.dynamics.as_ref().map(|d| d.settings);
        let mut held = vec![Held::assembler(
            "inertia",
            Per::Node,
            sizes::Inertia::NODE,
            model.nodes.len(),
        )];
        for body in &model.bodies {
            let (each, count) = (sizes::Mass::of_element(body), body.block.elements());
            held.push(Held::assembler("inertia", Per::Element, each, count));
        }
        held.push(Held::run("motion", Per::Node, 48, model.nodes.len()));
        let inertia = match own {
            Some(own) => Ok(format!(
                "`dynamics`: generalised-alpha with `rho_inf` {}, contact and friction {}",
                number(own.rho_inf),
                match own.contact {
                    ContactTiming::Implicit => "at the end of steps",
                    ContactTiming::Weighted => "weighted between the ends of steps",
                }
            )),
            None => Err("no `dynamics`: a run is a sequence of equilibria".to_owned()),
        };
        let inertia = self
            .effect(EffectKind::Inertia, "/solution/dynamics", inertia)
            .costs("a mass for each pair of an element's nodes, added to its tangent; steps by the error in time")
            .holds(held);
        let factor = own.map_or(0.0, |d| d.damping.mass);
        let damping = self
            .effect(
                EffectKind::MassDamping,
                "/solution/dynamics/damping",
                why(
                    factor > 0.0,
                    format!("`damping` of {} times mass and velocity", number(factor)),
                    match own {
                        Some(_) => "no `damping`",
                        None => "no `dynamics`",
                    },
                ),
            )
            .costs("a product with the mass for each evaluation");
        [inertia, damping, self.viscosity()]
    }

    fn viscosity(&self) -> Effect {
        let model = self.model;
        let own = model.dynamics.as_ref().map(|d| d.settings);
        let mut held: Vec<Held> = (model.bodies.iter())
            .map(|body| {
                let (each, count) = (sizes::Dashpots::of_element(body), body.block.elements());
                Held::assembler("dashpots", Per::Element, each, count)
            })
            .collect();
        held.push(Held::assembler(
            "dashpots",
            Per::Node,
            24,
            model.nodes.len(),
        ));
        held.extend(model.bodies.iter().map(|body| {
            let (each, count) = (body.block.shape_bytes(), body.block.elements());
            Held::model("dashpots", Per::Element, each, count)
        }));
        let room = sizes::Dashpots::room(model);
        held.push(Held::assembler("dashpots", Per::Whole, room, 1));
        let time = own.map_or(0.0, |d| d.damping.viscosity);
        self.effect(
            EffectKind::Viscosity,
            "/solution/dynamics/damping/viscosity",
            why(
                time > 0.0,
                format!("`viscosity` of {} times the moduli", number(time)),
                match own {
                    Some(_) => "no `viscosity`",
                    None => "no `dynamics`",
                },
            ),
        )
        .costs("dashpots beside all elements: as many tangents of elements once more")
        .holds(held)
    }
}
