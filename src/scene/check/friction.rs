//! What can be wrong with the friction of a contact.
use super::checker::Checker;
use super::{Contact, Friction, Gap, Passes, Penalty, Scene, TIME, Tangent, check_penalty};
use crate::scene::Value;

/// Problems of the friction of the contact at `at`.
pub(super) fn check(c: &mut Checker, at: &str, contact: &Contact, scene: &Scene) {
    let Some(friction) = &contact.friction else {
        if contact.tangential_penalty != Penalty::Auto {
            c.add(
                &format!("{at}/tangential_penalty"),
                "a tangential penalty without friction",
                Some("add `\"friction\": {\"coulomb\": {\"mu\": 0.2}}`, or leave it out".into()),
            );
        }
        return;
    };
    check_penalty(
        c,
        &format!("{at}/tangential_penalty"),
        contact.tangential_penalty,
    );
    match friction {
        Friction::Coulomb { mu } => coefficient(c, &format!("{at}/friction/coulomb/mu"), mu),
        Friction::ShearLimited { mu, limit } => {
            let at = format!("{at}/friction/shear_limited");
            coefficient(c, &format!("{at}/mu"), mu);
            let what = "the largest traction of friction";
            not_negative(c, &format!("{at}/limit"), what, limit);
        }
        Friction::Orthotropic { mu, direction } => {
            // What slides over the slave would need a direction that turns with the slave's points.
            let others = match contact.passes {
                Passes::Edges => Some("edges as slaves"),
                // A rigid surface has no pass of its own, which is told there.
                Passes::TwoHalf if contact.surface(&scene.surfaces).is_none() => {
                    Some("two half passes")
                }
                _ => None,
            };
            if let Some(others) = others {
                c.add(
                    &format!("{at}/passes"),
                    format!(
                        "{others} do not go with orthotropic friction: its direction is one of the master, whose points \
                         slide over the slave there"
                    ),
                    Some("leave `passes` out, or take `coulomb`".into()),
                );
            }
            let at = format!("{at}/friction/orthotropic");
            for (k, mu) in mu.iter().enumerate() {
                coefficient(c, &format!("{at}/mu/{k}"), mu);
            }
            let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            if !(length > 0.0 && length.is_finite()) {
                c.add(
                    &format!("{at}/direction"),
                    "the direction has no length",
                    Some("give a vector along which the first coefficient holds".into()),
                );
            }
        }
    }
    // The published forms are of normal contact, and multipliers of averaged gaps are those of nodes, friction is that of points.
    let mut without = |field: &str, with: &str, help: &str| {
        c.add(
            &format!("{at}/{field}"),
            format!("friction does not go with {with}"),
            Some(help.into()),
        );
    };
    if contact.gap == Gap::Averaged && contact.augmentation.is_some() {
        let with = "averaged gaps and multipliers at once: the latter are those of nodes, whereas points rub";
        without("augmentation", with, "leave one of them out");
    }
    if let Tangent::Published { .. } = contact.tangent {
        without("tangent", "the published tangent", "take `exact`");
    }
}

fn coefficient(c: &mut Checker, at: &str, mu: &Value) {
    not_negative(c, at, "the coefficient of friction", mu);
}

fn not_negative(c: &mut Checker, at: &str, what: &str, mu: &Value) {
    c.value(at, mu, &TIME);
    if let Value::Number(mu) = mu
        && *mu < 0.0
    {
        c.add(
            at,
            format!("{what} is {mu}"),
            Some("it must not be negative".into()),
        );
    }
}
