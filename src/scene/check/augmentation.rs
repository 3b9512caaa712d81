//! What can be wrong with the augmentation and the offset of a contact.
use super::checker::Checker;
use super::{Contact, Passes, Tangent};

/// Problems of augmentation and offset of the contact at `at`.
pub(super) fn check(c: &mut Checker, at: &str, contact: &Contact) {
    let tangent = &format!("{at}/tangent");
    if contact.offset != 0.0 {
        let at = format!("{at}/offset");
        c.positive(&at, "the offset", contact.offset);
        published(c, tangent, contact);
    }
    let Some(augmentation) = &contact.augmentation else {
        return;
    };
    let at = format!("{at}/augmentation");
    let tolerances = [("gap", augmentation.gap), ("slip", augmentation.slip)];
    for (name, value) in tolerances {
        c.positive(&format!("{at}/{name}"), "the tolerance", value);
    }
    c.whole(&format!("{at}/max"), augmentation.max, 1, 1000);
    let mut without = |with: &str, help: &str| {
        c.add(
            &at,
            format!("augmentation does not go with {with}"),
            Some(help.into()),
        );
    };
    if contact.passes == Passes::TwoHalf {
        let with = "two half passes, whose multipliers nothing would make agree";
        without(with, "take `\"passes\": \"one\"`");
    }
}

/// The published tangent leaves out what is small with the normal coordinate, which an offset makes large. (Augmentation lets
/// it vanish: there the published form is the exact one.)
fn published(c: &mut Checker, at: &str, contact: &Contact) {
    if let Tangent::Published { .. } = contact.tangent {
        c.add(
            at,
            "the published tangent, which is right on the surface, does not go with an offset: points lie far from it",
            Some("take `exact`".into()),
        );
    }
}
