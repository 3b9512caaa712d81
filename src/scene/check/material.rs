//! What can be wrong with a material.
use super::checker::{Checker, path};
use super::{MaterialChoice, Units};

/// Problems of a material: constants out of range, or a name in a scene that does not say its units.
pub(super) fn check(c: &mut Checker, name: &str, material: &MaterialChoice, units: &Units) {
    let Some(law) = material.written() else {
        let length = c.has("/units/length");
        if units.force.is_none() || !length {
            let known = material.name().unwrap_or_default();
            let message = format!("the constants of `{known}` are not known in the scene's units");
            let help = "say them, as in `\"units\": {\"length\": \"mm\", \"force\": \"N\"}`, or write the law with its constants";
            c.add(&path(&["materials", name]), message, Some(help.into()));
        }
        return;
    };
    let elastic = law.elastic();
    let at = path(&["materials", name, law.key()]);
    c.positive(&format!("{at}/E"), "Young's modulus `E`", elastic.e);
    if let Some(density) = elastic.density {
        c.positive(&format!("{at}/density"), "the `density`", density);
    }
    if !(elastic.nu > -1.0 && elastic.nu < 0.5) {
        let help = "-1 < nu < 0.5; nearly incompressible materials take e.g. 0.499";
        let message = format!("Poisson's ratio `nu` is {}", elastic.nu);
        c.add(&format!("{at}/nu"), message, Some(help.into()));
    }
}
