//! What does not go with small displacements, where normals and feet are those of the start.
use super::checker::{Checker, path};
use super::{Contact, Element, Gap, Kinematics, Passes, Points, Scene, Stabilization, Tangent};

/// Problems of a scene that asks for small displacements; none of any other.
pub(super) fn check(c: &mut Checker, scene: &Scene) {
    if scene.solution.kinematics != Kinematics::Small {
        return;
    }
    for (name, body) in &scene.bodies {
        if body.element == Element::Nurbs {
            let at = path(&["bodies", name, "nurbs"]);
            refuse(c, &at, "a body of kind `nurbs`", "take a `mesh`");
        }
    }
    for (name, contact) in &scene.contacts {
        check_contact(c, &path(&["contacts", name]), contact, scene);
    }
    for (name, surface) in &scene.surfaces {
        if surface.motion.free.is_some() {
            let at = format!("{}/motion/free", path(&["surfaces", name]));
            refuse(
                c,
                &at,
                "a surface driven by force",
                "prescribe its `translation`",
            );
        }
    }
    if let Stabilization::Viscous { .. } = scene.solution.stabilization {
        let help = "leave it out: a linear system needs none where supports hold the bodies";
        refuse(c, "/solution/stabilization", "stabilization", help);
    }
}

fn check_contact(c: &mut Checker, at: &str, contact: &Contact, scene: &Scene) {
    let mut refuse = |key: &str, what: &str, help: &str| {
        refuse(c, &format!("{at}/{key}"), what, help);
    };
    if contact.augmentation.is_some() {
        let help = "leave it out, and give a `penalty`";
        refuse("augmentation", "augmentation", help);
    }
    if contact.gap == Gap::Averaged {
        refuse("gap", "an averaged gap", "take `pointwise`");
    }
    if let Points::Segments(_) = contact.points {
        let help = "take `{\"gauss\": n}`";
        refuse("points/segments", "segments", help);
    }
    if contact.passes == Passes::TwoHalf {
        refuse("passes", "two half passes", "take `one`");
    }
    if let Tangent::Published { .. } = contact.tangent {
        let help = "take `exact`: normals stay, so that there is no other part than the main one";
        refuse("tangent", "the published tangent", help);
    }
    if contact.is_own(&scene.surfaces) {
        let help = "what touches itself has moved far";
        refuse("master", "contact of a body with itself", help);
    }
}

fn refuse(c: &mut Checker, at: &str, what: &str, help: &str) {
    c.add(
        at,
        format!("`\"kinematics\": \"small\"` does not go with {what}"),
        Some(format!(
            "{help}; or take `\"kinematics\": \"large\"` in `solution`"
        )),
    );
}
