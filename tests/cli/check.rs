//! `covact check` of scenes that are right.
use crate::support::*;
use serde_json::{Value, json};
use std::process::Output;

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
        &unfolded(&stdout(&output)),
        &[
            "plate under a ball\n",
            // 50 nodes: 5 x 5 on two faces; 4 x 4 pairs are free, in two components on the two symmetry planes.
            "16 elements, 50 nodes, 80 unknown displacements (dofs), 400 contact points; lengths in mm\n",
            "body `plate`\n",
            "  sets            bottom (16 faces), top (16 faces), x_max (4 faces), x_min (4 faces), y_max (4 faces), y_min",
            "St. Venant-Kirchhoff, E 12000, nu 0.3\n",
            "x 0 to 40, y 0 to 40, z -1 to 1\n",
            "edges 10, layers 2 thick\n",
            "1 at worst (1: right-angled, 0: collapsed)\n",
            "distortion      none\n",
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
            "14.9813 (pressure per penetration), a start from the stiffness of",
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

/// What the penalty of the plate starts with: a thousandth of `20 E / t`, and less with the square of its slenderness over
/// a tenth; `E` is 12000, `t` 2, the length that of the diagonal.
const PENALTY: f64 =
    1e-3 * 20.0 * 12000.0 / 2.0 * (2.0 * 2.0 * 100.0) / (40.0 * 40.0 + 40.0 * 40.0 + 2.0 * 2.0);

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
    assert!((penalty / PENALTY - 1.0).abs() < 1e-12, "{penalty}");
    // Corner of the plate to the sphere.
    let far = (2.0 * 40.0f64.powi(2) + 25.0f64.powi(2)).sqrt() - 25.0;
    let gap = pair["gap"].as_array().unwrap();
    assert!(gap[0].as_f64().unwrap().abs() < 1e-12, "{gap:?}");
    assert!((gap[1].as_f64().unwrap() - far).abs() < 1e-10, "{gap:?}");
    assert_eq!(found["bodies"][0]["worst_shape"], 1.0);
    // 5 x 5 nodes on the upper face, at half of the thickness.
    let top = json!({ "name": "top", "faces": 16, "nodes": 25, "bounds": [[0.0, 0.0, 1.0], [40.0, 40.0, 1.0]] });
    assert!(
        found["bodies"][0]["sets"]
            .as_array()
            .unwrap()
            .contains(&top),
        "{}",
        found["bodies"][0]["sets"]
    );
}

/// Both faces of a CAD surface that bends are all of its elements, and a corner is one control point.
#[test]
fn sets_of_a_surface_that_bends() {
    let scene = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/scenes/panel_pressed.json"
    );
    let output = covact(std::path::Path::new("."), &["check", "--json", scene]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let body = &found["bodies"][0];
    let set = |name: &str| {
        let mut sets = body["sets"].as_array().unwrap().iter();
        sets.find(|s| s["name"] == name).unwrap().clone()
    };
    for face in ["bottom", "top"] {
        assert_eq!(set(face)["faces"], body["elements"]);
    }
    let corner = set("corner.1");
    assert_eq!([&corner["faces"], &corner["nodes"]], [&json!(0), &json!(1)]);
    assert_eq!(corner["bounds"][0], corner["bounds"][1]);
}

/// A plate of 2 x 2 elements from a file, its middle vertex moved along the diagonal by a part of the elements' length.
fn distorted_plate(folder: &std::path::Path, part: f64) -> Output {
    let mut text = "*NODE\n".to_owned();
    for k in 0..2 {
        for j in 0..3 {
            for i in 0..3 {
                let off = if i == 1 && j == 1 { part } else { 0.0 };
                let (x, y) = (20.0 * (i as f64 + off), 20.0 * (j as f64 + off));
                text += &format!("{}, {x}, {y}, {}\n", 1 + i + 3 * j + 9 * k, 2 * k - 1);
            }
        }
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=all\n";
    for (e, n) in [1, 2, 4, 5].into_iter().enumerate() {
        let nodes = [n, n + 1, n + 4, n + 3].map(|n| format!("{n}, {}", n + 9));
        let (low, high): (Vec<&str>, Vec<&str>) =
            nodes.iter().map(|n| n.split_once(", ").unwrap()).unzip();
        text += &format!("{}, {}, {}\n", e + 1, low.join(", "), high.join(", "));
    }
    text += "*NSET, NSET=edge\n1, 4, 7, 10, 13, 16\n*SURFACE, NAME=top, TYPE=ELEMENT\nall, S2\n";
    std::fs::write(folder.join("plate.inp"), text).unwrap();
    let scene = json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 12000, "nu": 0.3 } } },
        "bodies": { "plate": { "mesh": { "file": { "path": "plate.inp" } }, "material": "steel" } },
        "supports": { "edge": { "on": "plate.edge", "fixed": true } },
        "loads": { "weight": { "on": "plate.top", "pressure": 1e-3 } }
    });
    std::fs::write(folder.join("scene.json"), scene.to_string()).unwrap();
    covact(folder, &["check", "scene.json"])
}

/// The most distorted element is named, and warned of above the limit.
#[test]
fn distortion() {
    let folder = tempfile::tempdir().unwrap();
    let output = distorted_plate(folder.path(), 0.125);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
    // ln(3.5 / 3) of the middle diagonal's stretch at the corner: 0.154 of 0.55.
    assert_parts(
        &unfolded(&stdout(&output)),
        &[
            "distortion      0.28",
            " of the limit at worst: element 3 at (30.625, 30.625, 0), skewed or tapered in the surface\n",
            "no warnings\n",
        ],
    );
    let output = distorted_plate(folder.path(), 0.375);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_parts(&stdout(&output), &["1 warning(s)\n"]);
    assert_parts(
        &stderr(&output)
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" "),
        &[
            "body `plate`: ",
            "element(s) so distorted",
            "the worst is element 3",
        ],
    );
}
