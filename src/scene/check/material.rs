//! What can be wrong with a material.
use super::checker::{Checker, path};
use super::{Body, Element, HardeningCurve, Kinematics, Material, MaterialChoice, Scene, Units};

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
    if let Some(hardening) = law.hardening() {
        if elastic.nu > 0.49 {
            let help = "metals have about 0.3; plastic flow keeps the volume by itself";
            let message = format!("Poisson's ratio `nu` is {}, above 0.49", elastic.nu);
            c.add(&format!("{at}/nu"), message, Some(help.into()));
        }
        check_hardening(c, &format!("{at}/hardening"), hardening);
    }
    if let Material::ArmstrongFrederick(metal) = law {
        for (key, value) in [
            ("modulus", metal.back_stress.modulus),
            ("recovery", metal.back_stress.recovery),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                let help = match key {
                    "modulus" => "it must not be negative; 0 is isotropic hardening alone (`j2`)",
                    _ => "it must not be negative; 0 is a back stress without limit",
                };
                let message = format!("the `{key}` of the back stress is {value}");
                c.add(
                    &format!("{at}/back_stress/{key}"),
                    message,
                    Some(help.into()),
                );
            }
        }
    }
    if let Material::Hill48(sheet) = law {
        for (i, r) in sheet.r.into_iter().enumerate() {
            let angle = [
                "along the rolling direction",
                "at 45 degrees to it",
                "across it",
            ][i];
            c.positive(&format!("{at}/r/{i}"), &format!("the r-value {angle}"), r);
        }
        let length = sheet.rolling.iter().map(|x| x * x).sum::<f64>();
        if !(length > 0.0 && length.is_finite()) {
            let help = "a direction in space, as `[1, 0, 0]`";
            c.add(
                &format!("{at}/rolling"),
                "the rolling direction has no length",
                Some(help.into()),
            );
        }
    }
}

fn check_hardening(c: &mut Checker, at: &str, hardening: &HardeningCurve) {
    let not_negative = |c: &mut Checker, key: &str, what: &str, value: f64| {
        if !(value >= 0.0 && value.is_finite()) {
            let help = "it must not be negative: softening has no single solution";
            let message = format!("{what} is {value}");
            c.add(&format!("{at}/{key}"), message, Some(help.into()));
        }
    };
    match hardening {
        HardeningCurve::Linear(h) => {
            let key = format!("{at}/linear/yield_stress");
            c.positive(&key, "the `yield_stress`", h.yield_stress);
            not_negative(c, "linear/slope", "the `slope`", h.slope);
        }
        HardeningCurve::Swift(h) => {
            c.positive(
                &format!("{at}/swift/strength"),
                "the `strength`",
                h.strength,
            );
            // No offset: no yield stress at the beginning.
            c.positive(&format!("{at}/swift/offset"), "the `offset`", h.offset);
            not_negative(c, "swift/exponent", "the `exponent`", h.exponent);
            if h.exponent > 1.0 {
                let message = format!("the `exponent` is {}", h.exponent);
                let help = "at most 1; metals have 0.1 to 0.3";
                c.add(&format!("{at}/swift/exponent"), message, Some(help.into()));
            }
        }
        HardeningCurve::Voce(h) => {
            let key = format!("{at}/voce/yield_stress");
            c.positive(&key, "the `yield_stress`", h.yield_stress);
            not_negative(c, "voce/rise", "the `rise`", h.rise);
            c.positive(&format!("{at}/voce/rate"), "the `rate`", h.rate);
        }
        HardeningCurve::Table(table) => check_table(c, &format!("{at}/table"), table.rows()),
    }
}

/// Plastic strains rise from 0; yield stresses are positive and do not fall.
fn check_table(c: &mut Checker, at: &str, rows: &[[f64; 2]]) {
    let Some([first, stress]) = rows.first() else {
        let help = "rows of plastic strain and yield stress, as in `[[0, 200], [0.1, 250]]`";
        c.add(
            at,
            "a table of yield stresses without rows",
            Some(help.into()),
        );
        return;
    };
    if *first != 0.0 {
        let message = format!("the first row has a plastic strain of {first}");
        let help = "it must be 0: flow begins at its yield stress";
        c.add(&format!("{at}/0/0"), message, Some(help.into()));
    }
    c.positive(&format!("{at}/0/1"), "the yield stress", *stress);
    for (row, pair) in rows.windows(2).enumerate() {
        let ([from, low], [to, high]) = (pair[0], pair[1]);
        if !(to > from && to.is_finite()) {
            let message = format!("a plastic strain of {to} follows {from}");
            let help = "plastic strains must rise from row to row";
            c.add(&format!("{at}/{}/0", row + 1), message, Some(help.into()));
        }
        if !(high >= low && high.is_finite()) {
            let message = format!("a yield stress of {high} follows {low}");
            let help = "yield stresses must not fall: softening has no single solution";
            c.add(&format!("{at}/{}/1", row + 1), message, Some(help.into()));
        }
    }
}

/// Problems of a body with its material.
pub(super) fn check_body(c: &mut Checker, name: &str, body: &Body, scene: &Scene) {
    let law = (scene.materials.get(&body.material)).and_then(|m| m.law(&scene.units));
    if body.element == Element::Nurbs
        && let Some(law) = &law
        && !matches!(law, Material::StVenantKirchhoff(_) | Material::NeoHooke(_))
    {
        c.add(
            &path(&["bodies", name, "material"]),
            format!(
                "the material `{}` has the law {}, which has no form in plane stress here",
                body.material,
                law.title()
            ),
            Some("a body of kind `nurbs` takes `st_venant_kirchhoff` or `neo_hooke`".into()),
        );
        return;
    }
    if !law.is_some_and(|law| law.flows()) {
        return;
    }
    let material = &body.material;
    let two_points = match body.element {
        Element::Q18 => Some("q18"),
        Element::H8Eas3 => Some("h8_eas3"),
        // Its law is looked at below.
        Element::H8 | Element::H8Displacement | Element::H8MeanDilatation | Element::Nurbs => None,
    };
    if let Some(element) = two_points {
        c.add(
            &path(&["bodies", name, "element"]),
            format!("the material `{material}` flows, which `{element}` with its two points over the thickness does not follow"),
            Some("take `h8`, which has six for such materials".into()),
        );
    }
    if scene.solution.kinematics == Kinematics::Small {
        c.add(
            "/solution/kinematics",
            format!("`\"kinematics\": \"small\"` is linear, but the material `{material}` of body `{name}` flows"),
            Some("take `\"kinematics\": \"large\"`".into()),
        );
    }
}
