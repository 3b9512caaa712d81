//! `covact inspect`.
use crate::support::{covact, stderr, stdout, unfolded};
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;
use std::process::{Command, Output};

/// A quarter of a cylinder of radius 2 and length 3, as geomdl writes it.
const QUARTER: &str = r#"{"shape": {"type": "surface", "count": 1, "data": [{
  "rational": true, "dimension": 3, "degree_u": 2, "degree_v": 1,
  "knotvector_u": [0, 0, 0, 1, 1, 1], "knotvector_v": [0, 0, 1, 1],
  "size_u": 3, "size_v": 2,
  "control_points": {
    "points": [[2, 0, 0], [2, 0, 3], [2, 2, 0], [2, 2, 3], [0, 2, 0], [0, 2, 3]],
    "weights": [1, 1, 0.7071067811865476, 0.7071067811865476, 1, 1]
  }
}]}}"#;

fn inspect(name: &str, content: &str, arguments: &[&str]) -> (Option<i32>, String, String) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), content).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_covact"));
    let Output {
        status,
        stdout,
        stderr,
    } = command
        .current_dir(folder.path())
        .arg("inspect")
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code(), text(stdout), text(stderr))
}

#[test]
fn findings_as_text_and_as_data() {
    let (code, text, _) = inspect("quarter.json", QUARTER, &["quarter.json"]);
    assert_eq!(code, Some(0));
    for part in [
        "patches: 1",
        "2x1",
        "3x2",
        "[0.0000, 2.0000] [0.0000, 2.0000] [0.0000, 3.0000]",
        "skipped: 0",
    ] {
        assert!(text.contains(part), "no {part} in\n{text}");
    }
    let (code, text, _) = inspect("quarter.json", QUARTER, &["quarter.json", "--json"]);
    assert_eq!(code, Some(0));
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["format"], "geomdl");
    let patch = &found["patches"][0];
    assert_eq!(patch["degree"], serde_json::json!([2, 1]));
    assert_eq!(patch["rational"], true);
    // The exact radius; the area, a quarter of 2 pi r l, within its quadrature.
    let curvature = &patch["curvature"];
    let radii = [
        &curvature["smallest_convex_radius"],
        &curvature["smallest_concave_radius"],
    ];
    let radius: Vec<f64> = radii.iter().filter_map(|r| r.as_f64()).collect();
    assert_eq!(radius.len(), 1, "{curvature}");
    assert!((radius[0] - 2.0).abs() < 1e-12, "{curvature}");
    let area = found["surface"]["area"].as_f64().unwrap();
    assert!((area - 3.0 * PI).abs() < 1e-4, "{area}");
    assert_eq!(found["surface"]["free_edges"], 4);
}

#[test]
fn files_that_cannot_be_read() {
    let (code, text, error) = inspect("tool.igs", "", &["tol.igs"]);
    assert_eq!((code, text.as_str()), (Some(3), ""));
    assert_eq!(
        error,
        "error: there is no file `tol.igs`; did you mean `tool.igs`?\n"
    );
    let (code, _, error) = inspect("tool.igs", "a\0b", &["tool.igs"]);
    assert_eq!(code, Some(3));
    assert!(
        error.contains("tool.igs: expected a STEP or IGES file, or JSON")
            && error.contains("found binary data"),
        "{error}"
    );
    let (code, _, error) = inspect(
        "tool.step",
        "ISO-10303-21;\nHEADER;\nENDSEC\n",
        &["tool.step"],
    );
    assert_eq!(code, Some(3));
    assert_eq!(
        error,
        "error: tool.step:4:1: expected a semicolon after ENDSEC, found the end of the file\n"
    );
    let (code, _, error) = inspect("tool.json", "{\"shape\": ", &["tool.json"]);
    assert_eq!(code, Some(3));
    assert!(error.starts_with("error: tool.json:1:"), "{error}");
}

/// A STEP file with its body, by its product's name, and the exact area of a torus of radii 10 and 3.
#[test]
fn bodies_of_step_files() {
    let path = format!(
        "{}/geometry/tests/data/step/torus.step",
        env!("CARGO_MANIFEST_DIR")
    );
    let output = covact(Path::new("."), &["inspect", &path]);
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for part in [
        "Step file, unit mm",
        "ADVANCED_FACE",
        "bodies: 1",
        "solid",
        "patches: 1",
    ] {
        assert!(text.contains(part), "no {part} in\n{text}");
    }
    let output = covact(Path::new("."), &["inspect", &path, "--json"]);
    let found: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(found["format"], "step");
    assert_eq!(found["bodies"][0]["faces"], 1);
    assert_eq!(found["patches"][0]["body"], 0);
    let area = found["surface"]["area"].as_f64().unwrap();
    assert!((area / (120.0 * PI * PI) - 1.0).abs() < 1e-4, "{area}");
}

/// The findings of an asset, as data.
fn asset(name: &str) -> Value {
    let path = format!("{}/assets/{name}", env!("CARGO_MANIFEST_DIR"));
    let output = covact(Path::new("."), &["inspect", &path, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    serde_json::from_str(&stdout(&output)).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap().iter();
    list.flat_map(|x| match x.as_f64() {
        Some(x) => vec![x],
        None => numbers(x),
    })
    .collect()
}

/// Entities, and area and box of every face, against Open CASCADE (`geometry/tests/data/cad_reference.py`), of the assets
/// with this ending; returns the number of faces.
fn against_an_independent_kernel(ending: &str) -> usize {
    let table = include_str!("../../geometry/tests/data/cad_table.json");
    let table: Value = serde_json::from_str(table).unwrap();
    let mut faults = Vec::new();
    let mut faces = 0;
    for (name, row) in table["files"].as_object().unwrap() {
        let Some(own) = name.strip_prefix("made_here/") else {
            continue;
        };
        if !own.ends_with(ending) {
            continue;
        }
        let found = asset(&format!("cad/{own}"));
        let entities: BTreeMap<String, u64> = (found["entities"].as_array().unwrap().iter())
            .map(|e| {
                let kind = format!("{}.{}", e["type_number"], e["form"]);
                (kind, e["count"].as_u64().unwrap())
            })
            .collect();
        let expected: BTreeMap<String, u64> =
            serde_json::from_value(row["entities"].clone()).unwrap();
        assert_eq!(entities, expected, "{name}");
        assert_eq!(found["summary"]["skipped"], 0, "{name}");
        let rows = row["surfaces"].as_array().unwrap();
        assert_eq!(found["summary"]["patches"], rows.len(), "{name}");
        for row in rows {
            faces += 1;
            let patch = (found["patches"].as_array().unwrap().iter())
                .find(|p| p["entity"] == row["entity"])
                .unwrap();
            let what = format!("{name}, entity {}", row["entity"]);
            let (area, expected) = (patch["area"].as_f64().unwrap(), &row["area"]);
            let error = (area / expected.as_f64().unwrap() - 1.0).abs();
            if error > 1e-6 {
                faults.push(format!("{what}: area {area}, not {expected}: {error:.1e}"));
            }
            let (bounds, expected) = (numbers(&patch["bounds"]), numbers(&row["box"]));
            let diagonal = (0..3)
                .map(|k| (expected[k + 3] - expected[k]).powi(2))
                .sum::<f64>()
                .sqrt();
            let error = (0..6).map(|k| (bounds[k] - expected[k]).abs());
            let error = error.fold(0.0, f64::max);
            // The kernel widens boxes by its confusion distance of 1e-7.
            if error > 1e-6 * diagonal + 1.5e-7 {
                faults.push(format!(
                    "{what}: box {bounds:?}, not {expected:?}: {error:.1e}"
                ));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    faces
}

#[test]
fn faces_agree_with_an_independent_kernel() {
    assert_eq!(against_an_independent_kernel("_faces.igs"), 19);
}

#[test]
fn solids_agree_with_an_independent_kernel() {
    assert_eq!(against_an_independent_kernel("_brep.igs"), 19);
}

/// What hangs together, what is closed and what it encloses.
#[test]
fn edges_parts_and_volumes() {
    let boxed = asset("cad/box_faces.igs");
    let surface = &boxed["surface"];
    assert_eq!(boxed["summary"]["rectangles"], 6);
    assert_eq!(
        [
            &surface["shared_edges"],
            &surface["sharp_edges"],
            &surface["free_edges"]
        ],
        [12, 12, 0]
    );
    assert!(surface["largest_gap"].as_f64().unwrap() < 1e-9);
    assert_eq!(numbers(&surface["largest_gap_at"]["at"]).len(), 3);
    let parts = surface["parts"].as_array().unwrap();
    assert_eq!((parts.len(), &parts[0]["closed"]), (1, &Value::Bool(true)));
    // 10 x 20 x 30.
    assert!((parts[0]["volume"].as_f64().unwrap() - 6000.0).abs() < 1e-8);

    let ball = asset("sphere.igs");
    let volume = ball["surface"]["parts"][0]["volume"].as_f64().unwrap();
    assert!(
        (volume / (4.0 / 3.0 * PI * 125.0) - 1.0).abs() < 1e-5,
        "{volume}"
    );

    // A sheet with a round hole: two closed rims.
    let sheet = asset("cad/trimmed_patch_faces.igs");
    assert_eq!(sheet["summary"]["trimmed"], 1);
    assert_eq!(sheet["patches"][0]["border"], "trimmed");
    assert!(sheet["trims"]["curves"].as_u64().unwrap() > 0);
    let rims = sheet["surface"]["borders"].as_array().unwrap();
    assert_eq!(rims.len(), 2, "{rims:?}");
    assert!(rims.iter().all(|r| r["closed"] == true));
    assert_eq!(sheet["surface"]["parts"][0]["volume"], Value::Null);
}

/// A plate, and beside it another one that is a little too far away.
const APART: &str = r#"{"covact_geometry": 1, "unit": "mm", "resolution": null, "patches": [
{"entity": 7, "degree": [1, 1], "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
 "points": [[0, 0, 0, 1], [10, 0, 0, 1], [0, 10, 0, 1], [10, 10, 0, 1]]},
{"entity": 8, "degree": [1, 1], "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
 "points": [[10.02, 0, 0, 1], [20, 0, 0, 1], [10.02, 10, 0, 1], [20, 10, 0, 1]]}
]}"#;

#[test]
fn gaps_are_named_with_their_places() {
    let (code, text, error) = inspect("apart.json", APART, &["apart.json"]);
    assert_eq!((code, error.as_str()), (Some(0), ""));
    let text = unfolded(&text);
    for part in [
        "Covact file, unit mm",
        "  open gap   2.000e-2 at (10.010000, ",
        "between entity 7 side 1 and entity 8 side 0",
        "  free rim   closed of length 40.000000: entity 7 side ",
        "  part       1 patch, area 100.000000, open",
    ] {
        assert!(text.contains(part), "no {part} in\n{text}");
    }
    let (_, text, _) = inspect("apart.json", APART, &["apart.json", "--json"]);
    let found: Value = serde_json::from_str(&text).unwrap();
    let gap = &found["surface"]["open_gaps"][0];
    assert!((gap["gap"].as_f64().unwrap() - 0.02).abs() < 1e-12);
    let edges = &gap["edges"];
    assert_eq!([&edges[0]["entity"], &edges[1]["entity"]], [7, 8]);
    assert_eq!(found["surface"]["parts"].as_array().unwrap().len(), 2);
}

/// Two plates of 15 x 15: one in the plane z = 0, the other moved by (x, 0, z).
fn plates(x: f64, z: f64) -> String {
    let patch = |entity: u32, x: f64, z: f64| {
        serde_json::json!({
            "entity": entity,
            "degree": [1, 1],
            "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
            "points": [[x, 0, z, 1], [x + 15.0, 0, z, 1], [x, 15, z, 1], [x + 15.0, 15, z, 1]],
        })
    };
    let patches = [patch(7, 0.0, 0.0), patch(8, x, z)];
    serde_json::json!({"covact_geometry": 1, "unit": "mm", "resolution": null, "patches": patches})
        .to_string()
}

#[test]
fn what_is_joined_over_a_gap_and_what_is_not_is_told() {
    let (code, text, _) = inspect("two.json", &plates(0.0, 1e-3), &["two.json"]);
    assert_eq!(code, Some(0));
    let text = unfolded(&text);
    for part in [
        "edges      0 shared",
        "  stacked    1.000e-3 at (",
        "between entity 7 side 0 and entity 8 side 0: not joined, both patches leave the edge in the same direction",
        "1 patch, area 225.000000, open",
    ] {
        assert!(text.contains(part), "no {part} in\n{text}");
    }
    assert!(!text.contains("closed, volume"), "{text}");
    let (_, text, _) = inspect("two.json", &plates(15.001, 0.0), &["two.json"]);
    let text = unfolded(&text);
    for part in [
        "edges      1 shared",
        "  bridged    gap of 1.000e-3 at (15.000500, ",
        "between entity 7 side 1 and entity 8 side 0",
        "2 patches, area 450.000000, open",
    ] {
        assert!(text.contains(part), "no {part} in\n{text}");
    }
}

#[test]
fn a_moebius_band_has_one_side() {
    let band = crate::support::moebius_band();
    let (code, text, error) = inspect("band.json", &band, &["band.json"]);
    assert_eq!((code, error.as_str()), (Some(0), ""));
    assert!(
        text.contains("8 patches, area ") && text.contains("with one side only"),
        "{text}"
    );
    let (_, text, _) = inspect("band.json", &band, &["band.json", "--json"]);
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["surface"]["parts"][0]["one_sided"], true);
}

#[test]
fn skipped_surfaces_are_counted_by_reason() {
    let bad = QUARTER.replace(
        "\"rational\": true",
        r#""rational": true, "trims": {"data": [{"type": "freeform", "points": [[0, 0], [0.5, 0.5], [0.5, 0]]}]}"#,
    );
    let (code, text, error) = inspect("bad.json", &bad, &["bad.json"]);
    assert_eq!(
        (code, error.as_str()),
        (Some(0), "warning: 1 surface was not read\n")
    );
    assert!(
        text.contains("skipped: 1 (1 with boundary curves that give no trim)\n  entity 1, surface: its trim curves"),
        "{text}"
    );
    let (_, text, _) = inspect("bad.json", &bad, &["bad.json", "--json"]);
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["summary"]["skipped_by_kind"]["boundary"], 1);
    assert_eq!(found["surface"], Value::Null);
}

/// A tetrahedron with corners at the origin and at 1 on the axes; the last face is left out where it is open.
fn tetrahedron(faces: usize) -> String {
    let x = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];
    let mut text = "solid tetrahedron\n".to_string();
    for [a, b, c] in &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]][..faces] {
        text += "facet normal 0 0 0\nouter loop\n";
        for k in [a, b, c] {
            text += &format!("vertex {}\n", x[*k]);
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid tetrahedron\n"
}

#[test]
fn triangles_of_stl_files() {
    let (code, text, error) = inspect("t.stl", &tetrahedron(4), &["t.stl", "--json"]);
    assert_eq!((code, error.as_str()), (Some(0), ""));
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["format"], "stl");
    assert_eq!(
        [&found["triangles"], &found["nodes"], &found["free_edges"]],
        [4, 4, 0]
    );
    assert!((found["volume"].as_f64().unwrap() - 1.0 / 6.0).abs() < 1e-15);
    let area = 1.5 + 0.75f64.sqrt();
    assert!((found["area"].as_f64().unwrap() - area).abs() < 1e-14);
    let (_, text, _) = inspect("t.stl", &tetrahedron(3), &["t.stl"]);
    for part in [
        "t.stl: Stl file (ascii), states no unit",
        "triangles  3, 0 of them without area",
        "nodes      4 of 9 vertices",
        "edges      3 free",
        "  open",
    ] {
        assert!(text.contains(part), "no {part} in\n{text}");
    }
    let broken = tetrahedron(4).replace("vertex 0 0 1", "vertex 0 0 one");
    let (code, _, error) = inspect("t.stl", &broken, &["t.stl"]);
    assert_eq!(code, Some(3));
    assert!(error.starts_with("error: t.stl:"), "{error}");
    // Not a list of surfaces to project onto.
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.stl"), tetrahedron(4)).unwrap();
    let output = covact(folder.path(), &["project", "t.stl", "-"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(
        stderr(&output).contains("found an STL file"),
        "{}",
        stderr(&output)
    );
}

/// A box with one of its faces listed twice: closed all the same, and said; nothing is measured with `--brief`.
#[test]
fn faces_left_out_and_brief_lists() {
    let path = format!(
        "{}/geometry/tests/data/step/box.step",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).unwrap();
    let start = text.find("ADVANCED_FACE").unwrap();
    let end = start + text[start..].find(';').unwrap();
    let copy = format!("#9001={};\nENDSEC;\nEND-ISO", &text[start..end]);
    let (body, _) = text.rsplit_once("ENDSEC;").unwrap();
    let (before, after) = body.split_once("CLOSED_SHELL('',(").unwrap();
    let twice = format!("{before}CLOSED_SHELL('',(#9001,{after}{copy}-10303-21;\n");
    let (code, shown, _) = inspect("box.step", &twice, &["box.step"]);
    assert_eq!(code, Some(0), "{shown}");
    // Whatever the width of the terminal.
    let shown = shown.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        // How far apart is rounding.
        "left out: 0 sliver(s), the widest 0.0e0; 1 duplicate face(s), at most ",
        "coincides with entity",
        "6 patches, area",
        "closed, volume",
    ] {
        assert!(shown.contains(part), "no {part} in\n{shown}");
    }
    let (_, json, _) = inspect("box.step", &twice, &["box.step", "--json"]);
    let found: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(found["healing"]["duplicates"], 1);
    assert_eq!(found["healing"]["left_out"][0]["kind"], "duplicate");
    assert_eq!(found["surface"]["turned"], serde_json::json!([]));

    let (code, json, _) = inspect("box.step", &text, &["box.step", "--json", "--brief"]);
    let found: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(code, Some(0));
    assert_eq!(found["summary"]["patches"], 6);
    assert!(found["surface"].is_null() && found["patches"][0]["area"].is_null());
    let (_, shown, _) = inspect("box.step", &text, &["box.step", "--brief"]);
    assert!(!shown.contains("all patches") && shown.contains("bodies: 1"));
}

/// A face that a file turns over among its neighbours is turned back, and named.
#[test]
fn turned_faces_are_named() {
    let path = format!(
        "{}/geometry/tests/data/step/box.step",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).unwrap();
    let start = text.find("ADVANCED_FACE").unwrap();
    let end = start + text[start..].find(';').unwrap();
    let face = &text[start..end];
    let other = match face.contains(".T.)") {
        true => face.replace(".T.)", ".F.)"),
        false => face.replace(".F.)", ".T.)"),
    };
    let turned = text.replace(face, &other);
    let (_, json, _) = inspect("box.step", &turned, &["box.step", "--json"]);
    let found: Value = serde_json::from_str(&json).unwrap();
    let list = found["surface"]["turned"].as_array().unwrap();
    assert_eq!(list.len(), 1);
    assert_eq!(found["surface"]["largest_turned"], list[0]["area"]);
    let (_, shown, _) = inspect("box.step", &turned, &["box.step"]);
    assert!(
        shown.contains("1 face(s) were turned over to agree with their neighbours"),
        "{shown}"
    );
}
