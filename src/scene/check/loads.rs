//! Supports and loads.
use super::checker::Checker;
use super::names::Sets;
use super::{POSITION_AND_TIME, TIME, check_sets};
use crate::scene::types::*;

pub(super) fn check_support(c: &mut Checker, at: &str, support: &Support, sets: &Sets) {
    check_sets(c, at, &support.on, sets, (false, "a support"));
    c.exactly_one(
        at,
        "support",
        &[
            ("fixed", support.fixed),
            ("clamped", support.clamped),
            ("symmetry", support.symmetry.is_some()),
            ("plane_strain", support.plane_strain.is_some()),
            // Beside a clamp it says how that moves.
            (
                "displacement",
                support.displacement.is_some() && !support.clamped,
            ),
        ],
    );
    if let Some(components) = &support.displacement {
        let all = [
            ("x", &components.x),
            ("y", &components.y),
            ("z", &components.z),
        ];
        if all.iter().all(|(_, v)| v.is_none()) {
            let message = "no component is prescribed";
            c.add(
                &format!("{at}/displacement"),
                message,
                Some("give one of `x`, `y`, `z`".into()),
            );
        }
        for (axis, value) in all {
            if let Some(value) = value {
                c.value(
                    &format!("{at}/displacement/{axis}"),
                    value,
                    &POSITION_AND_TIME,
                );
            }
        }
    }
}

/// Gravity acts on bodies whose density is known.
pub(super) fn check_weight(c: &mut Checker, at: &str, load: &Load, sets: &Sets, scene: &Scene) {
    for (at, name) in load.on.places(&format!("{at}/on")) {
        let Some(body) = scene.bodies.get(name) else {
            sets.not_a_body(c, &at, name);
            continue;
        };
        let material = scene.materials.get(&body.material);
        let law = material.and_then(|m| m.law(&scene.units));
        if law.is_some_and(|law| law.elastic().density.is_none()) {
            c.add(
                &at,
                format!(
                    "the material `{}` of body `{name}` has no density",
                    body.material
                ),
                Some("give it one: `\"density\": 7.85e-9` is steel in N, mm and s".into()),
            );
        }
    }
}

pub(super) fn check_load(c: &mut Checker, at: &str, load: &Load, sets: &Sets, scene: &Scene) {
    let on_faces = load.force.is_none() && load.couple.is_none();
    let what = if load.pressure.is_some() {
        "a pressure"
    } else {
        "a traction"
    };
    let user = match on_faces {
        true => what,
        false if load.couple.is_some() => "a couple",
        false => "a force",
    };
    match load.gravity {
        None => check_sets(c, at, &load.on, sets, (on_faces, user)),
        Some(_) => check_weight(c, at, load, sets, scene),
    }
    c.exactly_one(
        at,
        "load",
        &[
            ("force", load.force.is_some()),
            ("traction", load.traction.is_some()),
            ("pressure", load.pressure.is_some()),
            ("couple", load.couple.is_some()),
            ("gravity", load.gravity.is_some()),
        ],
    );
    // A total force is one vector for the whole set, so it cannot depend on position.
    for (key, values, variables) in [
        ("force", &load.force, &TIME[..]),
        ("gravity", &load.gravity, &TIME[..]),
        ("traction", &load.traction, &POSITION_AND_TIME[..]),
    ] {
        for (i, value) in values.iter().flatten().enumerate() {
            c.value(&format!("{at}/{key}/{i}"), value, variables);
        }
    }
    if let Some(value) = &load.couple {
        c.value(&format!("{at}/couple"), value, &TIME);
    }
    if let Some(value) = &load.pressure {
        // The position that a follower would depend on moves with the body.
        let variables = if load.follower {
            &TIME[..]
        } else {
            &POSITION_AND_TIME
        };
        c.value(&format!("{at}/pressure"), value, variables);
    } else if load.follower {
        let help = "forces and tractions keep their direction";
        c.add(
            &format!("{at}/follower"),
            "only a pressure can follow the faces",
            Some(help.into()),
        );
    }
}
