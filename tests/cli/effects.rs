//! `covact check` tells every effect that is on, and what it means.
use crate::support::*;
use covact::model::EffectKind;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Effects that the check of a scene lists, with their meanings.
fn effects(folder: &Path, scene: &Value) -> BTreeMap<String, String> {
    std::fs::write(folder.join("scene.json"), scene.to_string()).unwrap();
    let output = covact(folder, &["check", "scene.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = unfolded(&stdout(&output));
    let (_, list) = text.split_once("effects that are on").unwrap();
    let lines = list
        .lines()
        .skip(1)
        .take_while(|line| line.starts_with("  "));
    let split = |line: &str| {
        let (name, meaning) = line.trim().split_once(' ').unwrap_or((line.trim(), ""));
        (name.to_owned(), meaning.trim().to_owned())
    };
    lines.map(split).collect()
}

/// Two blocks one on the other.
fn blocks(changes: &[(&str, Value)]) -> Value {
    let block = |low: f64, n: u32| {
        json!({"mesh": {"block": {
            "min": [0, 0, low], "max": [1, 1, low + 1.0], "elements": [n, n, 1]
        }}, "material": "m"})
    };
    changed(
        json!({
            "covact": 1,
            "materials": {"m": {"st_venant_kirchhoff": {"E": 1e6, "nu": 0}}},
            "bodies": {"lower": block(-1.0, 2), "upper": block(0.0, 3)},
            "contacts": {"press": {
                "slave": "upper.bottom", "master": "lower.top", "points": {"gauss": 2}
            }},
            "supports": {
                "ground": {"on": "lower.bottom", "fixed": true},
                "push": {"on": "upper.top", "displacement": {"x": 0, "y": 0, "z": "-0.01*t"}}
            }
        }),
        changes,
    )
}

/// Half of a tube whose walls may touch each other.
fn tube() -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0}}},
        "bodies": {"tube": {"mesh": {"cylinder_panel": {
            "radius": 10, "thickness": 0.5, "angles": [0, 180], "y": [0, 1], "elements": [16, 1]
        }}, "material": "m"}},
        "contacts": {"walls": {"slave": "tube.inner", "master": "tube.inner"}},
        "supports": {
            "top": {"on": "tube.phi_min", "symmetry": "x"},
            "bottom": {"on": "tube.phi_max", "fixed": true},
            "front": {"on": "tube.y_min", "symmetry": "y"}
        }
    })
}

/// Two tubes that are shrunk one on the other, by less than their facets lie off a circle.
fn tubes() -> Value {
    let tube = |radius: f64, thickness: f64, n: u32| {
        json!({"mesh": {"cylinder_panel": {
            "radius": radius, "thickness": thickness, "angles": [0, 90], "y": [0, 3], "elements": [n, 1]
        }}, "material": "m"})
    };
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0}}},
        "bodies": {"outer": tube(20.0, 5.0, 8), "inner": tube(15.0, 5.02, 12)},
        "contacts": {"fit": {"slave": "inner.outer", "master": "outer.inner"}},
        "supports": {
            "x": {"on": ["outer.phi_min", "inner.phi_min"], "symmetry": "x"},
            "z": {"on": ["outer.phi_max", "inner.phi_max"], "symmetry": "z"},
            "y": {"on": ["outer.y_min", "inner.y_min"], "symmetry": "y"}
        }
    })
}

/// A CAD surface as a thin shell, clamped along an edge.
fn panel() -> Value {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/cad/panel.igs");
    json!({
        "covact": 1,
        "units": {"length": "mm"},
        "materials": {"m": {"st_venant_kirchhoff": {"E": 70000, "nu": 0.33}}},
        "bodies": {"panel": {
            "nurbs": {"file": file, "thickness": 1, "size": 12}, "material": "m"
        }},
        "supports": {"clamped": {"on": "panel.edge.1", "clamped": true}}
    })
}

/// Faces of a CAD file that are joined, clamped along their free edges.
fn joined() -> Value {
    let mut scene = panel();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/cad/flanged.igs");
    scene["bodies"]["panel"]["nurbs"]["file"] = json!(file);
    scene["supports"]["clamped"]["on"] = json!("panel.rim");
    scene
}

/// A plate on the face of a die that a trimming curve bounds.
fn trimmed() -> Value {
    let die = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/die.igs");
    json!({
        "covact": 1,
        "units": {"length": "mm"},
        "materials": {"m": {"st_venant_kirchhoff": {"E": 2000, "nu": 0.3}}},
        "bodies": {"plate": {"mesh": {"plate": {
            "size": [38, 38], "thickness": 1, "elements": [4, 4], "origin": [0, 0, 0.5]
        }}, "material": "m"}},
        "surfaces": {"die": {"cad": {"file": die, "entities": [3]}}},
        "contacts": {"rest": {"slave": "plate.bottom", "master": "die"}},
        "supports": {"clamped": {"on": "plate.x_max", "fixed": true}}
    })
}

fn changed(mut scene: Value, changes: &[(&str, Value)]) -> Value {
    for (pointer, value) in changes {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        scene.pointer_mut(parent).expect(pointer)[key] = value.clone();
    }
    scene
}

/// Small scenes that use every effect at least once.
fn scenes() -> Vec<Value> {
    let ball = |key: &str| format!("/surfaces/ball/{key}");
    let facets =
        |kind: &str| plate_with(&[(&ball("facets"), json!({"kind": kind, "count": [6, 6]}))]);
    let overlapping = |what: Value| {
        plate_with(&[
            ("/surfaces/ball/sphere/center", json!([0, 0, 25.9])),
            ("/contacts/press/initial_overclosure", what),
        ])
    };
    vec![
        plate_with(&[]),
        plate_with(&[
            (
                "/materials/steel",
                json!({"neo_hooke": {"E": 12000, "nu": 0.3}}),
            ),
            ("/contacts/press/points", json!({"lobatto": 2})),
            ("/contacts/press/tangent", json!({"published": {}})),
            (
                "/loads",
                json!({
                    "p": {"on": "plate.top", "pressure": 1e-3, "follower": true},
                    "q": {"on": "plate.top", "force": [0, 0, "-t"]}
                }),
            ),
            ("/supports/clamp_x/mid_surface", json!(true)),
        ]),
        plate_with(&[("/solution/kinematics", json!("small"))]),
        plate_with(&[
            ("/bodies/plate/element", json!("q18")),
            (
                "/materials/steel",
                json!({"hencky": {"E": 12000, "nu": 0.3}}),
            ),
            ("/contacts/press/points", json!({"gauss": 2})),
            ("/contacts/press/friction", json!({"coulomb": {"mu": 0.3}})),
            (
                "/output",
                json!({"contact_points": true, "shell_stresses": true}),
            ),
        ]),
        plate_with(&[
            ("/bodies/plate/element", json!("h8_displacement")),
            (
                "/contacts/press/friction",
                json!({
                    "orthotropic": {"mu": [0.1, 0.3], "direction": [1, 0, 0]}
                }),
            ),
            ("/contacts/press/offset", json!(0.1)),
            ("/solution/stabilization", json!({"viscous": {}})),
        ]),
        plate_with(&[
            (
                "/materials/steel",
                json!({"j2": {
                    "E": 12000, "nu": 0.3, "hardening": {"linear": {"yield_stress": 20}}
                }}),
            ),
            (
                "/stages",
                json!([{"name": "press", "until": 0.5}, {"name": "back", "release": "forces"}]),
            ),
        ]),
        plate_with(&[(
            "/materials/steel",
            json!({"hill48": {
                "E": 12000, "nu": 0.3, "hardening": {"linear": {"yield_stress": 20}}, "r": [1.8, 1.4, 2.2], "rolling": [1, 0, 0]
            }}),
        )]),
        plate_with(&[(
            "/materials/steel",
            json!({"armstrong_frederick": {
                "E": 12000, "nu": 0.3, "hardening": {"linear": {"yield_stress": 20}},
                "back_stress": {"modulus": 100, "recovery": 20}
            }}),
        )]),
        facets("bilinear"),
        facets("biquadratic"),
        facets("smooth"),
        plate_with(&[(
            "/surfaces/ball/motion",
            json!({"free": {"force": {"z": "-t"}}}),
        )]),
        plate_with(&[("/contacts/press/augmentation", json!({}))]),
        overlapping(json!("stress_free")),
        overlapping(json!({"shrink": {"until": 0.5}})),
        trimmed(),
        blocks(&[("/contacts/press/gap", json!("averaged"))]),
        blocks(&[("/contacts/press/passes", json!("two_half"))]),
        blocks(&[
            ("/bodies/lower/element", json!("h8_eas3")),
            ("/bodies/upper/element", json!("h8_mean_dilatation")),
        ]),
        blocks(&[(
            "/contacts/press/friction",
            json!({"shear_limited": {"mu": 0.1, "limit": 1}}),
        )]),
        blocks(&[
            ("/contacts/press/passes", json!("edges")),
            ("/bodies/lower/mesh/block/min", json!([0.4, 0, -1])),
        ]),
        blocks(&[("/contacts/press/points", json!({"segments": 2}))]),
        blocks(&[
            ("/materials/m/st_venant_kirchhoff/density", json!(1)),
            (
                "/solution",
                json!({"dynamics": {"damping": {"mass": 1, "viscosity": 0.01}}}),
            ),
        ]),
        blocks(&[("/contacts/press/master_surface", json!("smooth"))]),
        tube(),
        panel(),
        joined(),
        tubes(),
    ]
}

#[test]
fn every_effect_is_listed_with_its_meaning() {
    let folder = tempfile::tempdir().unwrap();
    let mut found = BTreeMap::new();
    for scene in scenes() {
        found.extend(effects(folder.path(), &scene));
    }
    for kind in EffectKind::ALL {
        assert!(kind.meaning().split_whitespace().count() > 1, "{kind:?}");
        let told = found.get(kind.name()).map(String::as_str);
        assert_eq!(told, Some(kind.meaning()), "{}", kind.name());
    }
    assert_eq!(found.len(), EffectKind::ALL.len());
}
