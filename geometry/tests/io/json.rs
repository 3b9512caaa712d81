//! JSON of Kratos and geomdl: the order of the control points, and errors with their places.

use crate::support::assets;
use covact_geometry::Vec3;
use covact_geometry::io::{CadFile, CadFormat, read_json, read_path};

/// Both files hold degree 2 x 1 over 3 x 2 points, so that a wrong order gives another surface.
#[test]
fn kratos_runs_through_the_first_direction_first() {
    let file = read_path(&assets().join("cad/quarter_cylinder.cad.json")).unwrap();
    assert_eq!((file.format, file.unit.to_metre), (CadFormat::Kratos, None));
    assert_eq!(file.resolution, Some(1e-6));
    let patch = &file.patches[0].patch;
    assert_eq!((file.patches[0].entity, patch.counts()), (2, [3, 2]));
    for (u, y) in [(0.0, 0.0), (0.3, 1.0), (0.5, 4.0), (0.9, 2.5)] {
        let x = patch.point([u, y]);
        assert!(
            (x.y - y).abs() < 1e-15 && (x.x.hypot(x.z) - 2.0).abs() < 1e-15,
            "{x:?}"
        );
    }
    let area = crate::support::area(patch);
    assert!((area - 4.0 * std::f64::consts::PI).abs() < 1e-12, "{area}");
    assert_eq!(file.skipped[0].entity, 3);
    assert!(
        file.skipped[0]
            .reason
            .starts_with("its boundary gives no trim: trim loop 0: has no curves")
    );
}

/// Written by geomdl 5.3 (`exchange.export_json`), which evaluates the point below.
#[test]
fn geomdl_runs_through_the_second_direction_first() {
    let file = read_path(&assets().join("cad/ruled.geomdl.json")).unwrap();
    assert_eq!(file.format, CadFormat::Geomdl);
    let patch = &file.patches[0].patch;
    assert_eq!((patch.counts(), patch.degree()), ([3, 2], [2, 1]));
    let reference = Vec3::new(
        0.49586776859504134,
        0.49586776859504134,
        0.02975206611570248,
    );
    assert!((patch.point([0.3, 0.6]) - reference).norm() < 1e-15);
}

fn change(name: &str, from: &str, to: &str) -> Result<CadFile, String> {
    let text = std::fs::read_to_string(assets().join(name)).unwrap();
    assert!(text.contains(from), "{from}");
    read_json(text.replacen(from, to, 1).as_bytes(), "f.json").map_err(|e| e.to_string())
}

#[test]
fn errors_have_a_place() {
    let kratos = "cad/quarter_cylinder.cad.json";
    let geomdl = "cad/ruled.geomdl.json";
    for (file, from, to, expected) in [
        (
            kratos,
            "\"degrees\": [2, 1]",
            "\"degrees\": [2, -1]",
            "f.json:14:29: expected usize (in Kratos CAD JSON), found invalid value: integer `-1`",
        ),
        (
            kratos,
            "[1, [2.0, 0.0, 0.0, 1.0]],\n",
            "",
            "f.json:26:11: expected a NURBS surface (in Kratos CAD JSON), \
             found 5 control points where 6 are needed",
        ),
        (
            kratos,
            "[1, [2.0, 0.0, 0.0, 1.0]]",
            "[1, [2.0, 1.0]]",
            "f.json:27:11: expected [x, y, z, w] (in Kratos CAD JSON), found control point 1 with 2 numbers",
        ),
        (
            kratos,
            "\"is_rational\": true",
            "\"is_rational\": false",
            "f.json:27:11: expected 1 as is_rational is false (in Kratos CAD JSON), \
             found control point 2 with weight 0.7071067811865476",
        ),
        (
            geomdl,
            "\"size_u\": 3",
            "\"size_u\": 300000000000",
            "expected size_u * size_v = 300000000000 * 2 (in geomdl JSON), found 6 control points",
        ),
        (
            geomdl,
            "\"shape\"",
            "\"form\"",
            "f.json:1:1: expected the key \"breps\" (Kratos), \"shape\" (geomdl) or \"covact_geometry\", found the keys [form]",
        ),
        (
            geomdl,
            "\"degree_u\"",
            "\"degree\"",
            "missing field `degree_u`",
        ),
    ] {
        let message = change(file, from, to).unwrap_err();
        assert!(message.contains(expected), "{message}\n{expected}");
        assert!(message.starts_with("f.json:"), "{message}");
    }
}

#[test]
fn what_is_no_surface_is_named() {
    let file = change(
        "cad/ruled.geomdl.json",
        "\"type\": \"surface\"",
        "\"type\": \"curve\"",
    )
    .unwrap();
    assert_eq!((file.patches.len(), file.skipped.len()), (0, 1));
    assert_eq!(file.skipped[0].reason, "a curve, only surfaces are read");
    let trims = "\"size_u\": 3, \"trims\": {\"count\": 1, \"data\": [{\"type\": \"container\", \"data\": []}]}";
    let file = change("cad/ruled.geomdl.json", "\"size_u\": 3", trims).unwrap();
    assert!(
        file.skipped[0]
            .reason
            .starts_with("its trim curves give no trim: trim loop 0: has no curves")
    );
    let error = change("cad/ruled.geomdl.json", "\"shape\"", "\"shape\"")
        .unwrap()
        .convert_to(&covact_geometry::io::LengthUnit::from_name("mm").unwrap());
    assert!(
        error
            .unwrap_err()
            .to_string()
            .contains("states no length unit")
    );
}
