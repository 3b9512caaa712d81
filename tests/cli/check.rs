//! `covact check` of scenes that are right.
use crate::support::*;
use serde_json::{Value, json};

#[test]
fn everything_a_scene_amounts_to() {
    let folder = tempfile::tempdir().unwrap();
    let punch = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/punch.igs");
    std::fs::copy(punch, folder.path().join("punch.igs")).unwrap();
    let changes = [
        (
            "/surfaces/ball",
            json!({ "cad": { "file": "punch.igs" }, "placement": { "translation": [0, 0, 1.25] } }),
        ),
        ("/contacts/press/points", json!({ "gauss": 5 })),
        (
            "/loads",
            json!({ "weight": { "on": "plate.top", "pressure": 1e-3 } }),
        ),
    ];
    write_plate(folder.path(), &changes);
    let output = covact(folder.path(), &["check", "scene.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
    assert_parts(
        &stdout(&output),
        &[
            "plate under a ball\n",
            // 50 nodes: 5 x 5 on two faces; 4 x 4 pairs are free, in two components on the two symmetry planes.
            "16 elements, 50 nodes, 80 unknown displacements (dofs), 400 contact points; lengths in mm\n",
            "body `plate`\n",
            "St. Venant-Kirchhoff, E 12000, nu 0.3\n",
            "x 0 to 40, y 0 to 40, z -1 to 1\n",
            "edges 10, layers 2 thick\n",
            "1 at worst (1: right-angled, 0: collapsed)\n",
            "surface `ball` (rigid)\n",
            "punch.igs\n",
            "45, all connected\n",
            "84 shared and smooth, 0 shared and sharp, 12 free (the surface ends there)",
            "5 convex (bulging), none concave (hollow)\n",
            "where the slave starts (normals of 0 of 45 patch(es) turned round)",
            "contact `press`\n",
            "plate.top: 400 points, 5 x 5 Gauss points a face, 2 apart\n",
            "ball\n",
            // 20 E / thickness.
            "120000 (pressure per penetration), chosen from",
            "from 0.25 to ",
            "0 of them in contact\n",
            "supports\n",
            "clamp_x         holds x, y and z on plate.x_max (30 components)\n",
            "symmetry_x      symmetry: holds x on plate.x_min (8 components)\n",
            "loads\n",
            "weight          pressure on plate.top\n",
            "effects that are on",
            "contact.normal.penalty",
            "no warnings\n",
        ],
    );
}

#[test]
fn every_effect_has_a_meaning() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(
        folder.path(),
        &[
            (
                "/materials/steel",
                json!({ "neo_hooke": { "E": 12000, "nu": 0.3 } }),
            ),
            ("/contacts/press/points", json!({ "lobatto": 2 })),
            ("/contacts/press/tangent", json!({ "published": {} })),
            (
                "/loads",
                json!({
                    "p": { "on": "plate.top", "pressure": 1e-3, "follower": true },
                    "q": { "on": "plate.top", "force": [0, 0, "-t"] }
                }),
            ),
            ("/supports/clamp_x/mid_surface", json!(true)),
        ],
    );
    let output = covact(folder.path(), &["check", "scene.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    let effects = text.split_once("effects that are on").unwrap().1;
    let lines: Vec<&str> = effects
        .lines()
        .skip(1)
        .take_while(|l| !l.is_empty())
        .collect();
    assert!(lines.len() >= 10, "{effects}");
    for line in lines {
        assert!(line.split_whitespace().count() > 2, "no meaning: {line}");
    }
}

#[test]
fn the_same_as_data() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    let output = covact(folder.path(), &["check", "scene.json", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(
        (&found["dofs"], &found["contact_points"]),
        (&json!(80), &json!(25))
    );
    let surface = &found["surfaces"][0];
    let radius = surface["smallest_convex_radius"].as_f64().unwrap();
    assert!((radius - 25.0).abs() < 1e-10, "{radius}");
    assert_eq!(surface["smallest_concave_radius"], Value::Null);
    assert_eq!(surface["free_edges"], 0);
    let pair = &found["pairs"][0];
    assert_eq!(pair["automatic"], json!(true));
    let penalty = pair["penalty"].as_f64().unwrap();
    assert!((penalty / 120000.0 - 1.0).abs() < 1e-14, "{penalty}");
    // Corner of the plate to the sphere.
    let far = (2.0 * 40.0f64.powi(2) + 25.0f64.powi(2)).sqrt() - 25.0;
    let gap = pair["gap"].as_array().unwrap();
    assert!(gap[0].as_f64().unwrap().abs() < 1e-12, "{gap:?}");
    assert!((gap[1].as_f64().unwrap() - far).abs() < 1e-10, "{gap:?}");
    assert_eq!(found["bodies"][0]["worst_shape"], 1.0);
}
