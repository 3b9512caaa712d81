//! Contact pairs between bodies that cannot be meant.
use crate::support::*;
use serde_json::{Value, json};

/// Two blocks, the upper one pressed on the lower one.
fn blocks() -> Value {
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0 } } },
        "bodies": {
            "lower": { "mesh": { "block": {
                "min": [0, 0, -1], "max": [2, 2, 0], "elements": [2, 2, 1]
            } }, "material": "m" },
            "upper": { "mesh": { "block": {
                "min": [0, 0, 0], "max": [2, 2, 1], "elements": [3, 3, 1]
            } }, "material": "m" }
        },
        "contacts": { "press": { "slave": "upper.bottom", "master": "lower.top" } },
        "supports": {
            "ground": { "on": "lower.bottom", "fixed": true },
            "push": { "on": "upper.top", "displacement": { "x": 0, "y": 0, "z": "-0.01*t" } }
        }
    })
}

/// The scene is refused at `pointer` with these parts of the message, in this order.
fn refused(scene: &Value, files: &[(&str, &str)], pointer: &str, parts: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let (text, place) = text_and_place(scene, pointer);
    let message = refused_in(folder.path(), text.as_bytes());
    assert!(
        message.starts_with(&format!("error: scene.json:{place}: ")),
        "not at {place}:\n{message}"
    );
    assert_parts(&message, parts);
}

#[test]
fn a_face_set_on_the_wrong_side() {
    for (role, set, good) in [
        ("slave", "upper.top", "lower.top"),
        ("master", "lower.bottom", "upper.bottom"),
    ] {
        let mut scene = blocks();
        scene["contacts"]["press"][role] = json!(set);
        let (slave, master) = match role {
            "slave" => (set, good),
            _ => (good, set),
        };
        refused(
            &scene,
            &[],
            &format!("/contacts/press/{role}"),
            &[
                &format!(
                    "the faces `{slave}` and `{master}` look the same way where they are closest"
                ),
                &format!("`{set}` lies on the side of its body that is turned away from the other"),
                "help: take the faces on the other side of that body, whose outward normals point at the other faces",
            ],
        );
    }
}

/// A mesh put in upside down: the sets are those meant, and the normals point the same way.
#[test]
fn a_body_upside_down() {
    let mut scene = blocks();
    scene["bodies"]["upper"]["placement"] =
        json!({ "axis": [1, 0, 0], "angle": 180, "translation": [0, 2, 1] });
    refused(
        &scene,
        &[],
        "/contacts/press/slave",
        &["look the same way", "`upper.bottom` lies on the side"],
    );
}

/// Bricks that share an edge alone, and of each the face beside that edge: the outside changes sides there.
#[test]
fn a_master_that_folds() {
    let mesh = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n9,2,0,1\n10,2,1,1\n\
                11,1,0,2\n12,2,0,2\n13,2,1,2\n14,1,1,2\n*ELEMENT, TYPE=C3D8, ELSET=all\n1,1,2,3,4,5,6,7,8\n\
                2,6,9,10,7,11,12,13,14\n*SURFACE, NAME=wall, TYPE=ELEMENT\n1,S4\n2,S6\n";
    let mut scene = blocks();
    scene["bodies"]["lower"]["mesh"] = json!({ "file": { "path": "bricks.inp" } });
    scene["contacts"]["press"]["master"] = json!("lower.wall");
    scene["supports"]["ground"]["on"] = json!("lower.wall");
    refused(
        &scene,
        &[("bricks.inp", mesh)],
        "/contacts/press/master",
        &[
            "`lower.wall` folds: two faces that share the edge near (1, 0.5, 1) have their outsides on different sides",
            "help: take outer faces of the body that lie side by side",
        ],
    );
}
