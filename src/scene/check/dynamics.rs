//! Motion with inertia: its numbers, and what does not go with it.
use super::checker::{Checker, path};
use super::{Dynamics, Kinematics, MeshSource, Scene, Stabilization};

/// Problems of a scene with inertia, and of one without it whose bodies have velocities.
pub(super) fn check(c: &mut Checker, scene: &Scene) {
    for (name, body) in &scene.bodies {
        let at = path(&["bodies", name]);
        for (key, given) in [
            ("velocity", body.velocity.is_some()),
            ("spin", body.spin.is_some()),
        ] {
            if given && scene.solution.dynamics.is_none() {
                let message = format!("a `{key}` needs inertia, and this run has none");
                let help = "ask for it: `\"dynamics\": {}` in `solution`, or leave the key out";
                c.add(&format!("{at}/{key}"), message, Some(help.into()));
            }
        }
        c.finite(
            &format!("{at}/velocity"),
            &body.velocity.unwrap_or_default(),
        );
        if let Some(spin) = &body.spin {
            c.finite(&format!("{at}/spin/rate"), &spin.rate);
            c.finite(&format!("{at}/spin/about"), &spin.about.unwrap_or_default());
        }
    }
    let Some(dynamics) = &scene.solution.dynamics else {
        return;
    };
    check_numbers(c, dynamics);
    check_densities(c, scene);
    for (at, what, help) in refused(scene) {
        c.add(
            &at,
            format!("`dynamics` does not go with {what}"),
            Some(format!("{help}; or leave out `dynamics` in `solution`")),
        );
    }
}

fn check_numbers(c: &mut Checker, dynamics: &Dynamics) {
    let at = |key: &str| format!("/solution/dynamics/{key}");
    let rho = dynamics.rho_inf;
    if !(0.0..=1.0).contains(&rho) {
        let help = "from 0, which damps most, to 1, which damps nothing; usually 0.8";
        c.add(
            &at("rho_inf"),
            format!("`rho_inf` is {rho}"),
            Some(help.into()),
        );
    }
    for (key, what, value) in [
        ("mass", "damping", dynamics.damping.mass),
        ("viscosity", "viscosity", dynamics.damping.viscosity),
    ] {
        if !(value >= 0.0 && value.is_finite()) {
            let help = "it must not be negative: energy would come from nowhere";
            let message = format!("the {what} is {value}");
            c.add(&at(&format!("damping/{key}")), message, Some(help.into()));
        }
    }
    let tolerance = dynamics.tolerance;
    if !(1e-8..=0.1).contains(&tolerance) {
        let help = "a part of the largest displacement, from 1e-8 to 0.1, usually 1e-3";
        let message = format!("the tolerance is {tolerance}");
        c.add(&at("tolerance"), message, Some(help.into()));
    }
}

fn check_densities(c: &mut Checker, scene: &Scene) {
    for (name, body) in &scene.bodies {
        let material = scene.materials.get(&body.material);
        let law = material.and_then(|m| m.law(&scene.units));
        if law.is_none_or(|law| law.elastic().density.is_some()) {
            continue;
        }
        let message = format!(
            "the material `{}` of body `{name}` has no density, which `dynamics` needs",
            body.material
        );
        let help = "give it one: `\"density\": 7.85e-9` is steel in N, mm and s";
        let at = format!("{}/material", path(&["bodies", name]));
        c.add(&at, message, Some(help.into()));
    }
}

/// Everything of the scene that does not go with inertia: where it is, what it is, and what to do.
fn refused(scene: &Scene) -> Vec<(String, &'static str, &'static str)> {
    let solution = &scene.solution;
    let mut out = Vec::new();
    if solution.kinematics == Kinematics::Small {
        out.push((
            "/solution/kinematics".to_owned(),
            "small displacements, whose system is made once",
            "take `\"kinematics\": \"large\"`",
        ));
    }
    if let Stabilization::Viscous { .. } = solution.stabilization {
        out.push((
            "/solution/stabilization".to_owned(),
            "viscous stabilisation: inertia holds what nothing else does",
            "leave it out; `damping` slows what moves",
        ));
    }
    for (name, body) in &scene.bodies {
        if matches!(body.mesh, MeshSource::Nurbs(_)) {
            out.push((
                format!("{}/nurbs", path(&["bodies", name])),
                "a CAD surface that bends, whose mass is not integrated",
                "take a `mesh` of solid-shells for the body",
            ));
        }
    }
    for (name, contact) in &scene.contacts {
        if contact.augmentation.is_some() {
            out.push((
                format!("{}/augmentation", path(&["contacts", name])),
                "augmentation: the multiplier of a contact that has just opened is none of the next impact",
                "leave it out, and give a `penalty`",
            ));
        }
        if contact.accuracy.is_some() {
            out.push((
                format!("{}/accuracy", path(&["contacts", name])),
                "a penalty that is ruled by its accuracy: one that changes under a contact puts in energy",
                "leave it out, or give a `penalty`",
            ));
        }
    }
    for (name, surface) in &scene.surfaces {
        if surface.motion.free.is_some() {
            out.push((
                format!("{}/motion/free", path(&["surfaces", name])),
                "a surface driven by force, which would need a mass",
                "prescribe its `translation`",
            ));
        }
    }
    out
}
