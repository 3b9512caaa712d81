//! `covact inspect`.
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
    assert!((area - 3.0 * std::f64::consts::PI).abs() < 1e-4, "{area}");
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
    let (code, _, error) = inspect("tool.igs", "ISO-10303-21;\n", &["tool.igs"]);
    assert_eq!(code, Some(3));
    assert!(
        error.contains("tool.igs: expected an IGES file") && error.contains("found a STEP file"),
        "{error}"
    );
    let (code, _, error) = inspect("tool.json", "{\"shape\": ", &["tool.json"]);
    assert_eq!(code, Some(3));
    assert!(error.starts_with("error: tool.json:1:"), "{error}");
}
