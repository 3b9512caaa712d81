//! `covact convert`.
use crate::support::{covact, stderr, stdout};
use covact_geometry::io::read_path;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("assets")
        .join(name)
}

fn inspect(folder: &Path, file: &str) -> Value {
    let output = covact(folder, &["inspect", file, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    serde_json::from_str(&stdout(&output)).unwrap()
}

/// Trims, seams and poles among them.
#[test]
fn what_is_converted_is_the_same_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    for (name, trimmed) in [
        ("punch.igs", 0),
        ("cad/cone_faces.igs", 2),
        ("cad/trimmed_patch_faces.igs", 1),
        ("cad/torus_brep.igs", 0),
        ("cad/quarter_cylinder.cad.json", 0),
        ("cad/ruled.geomdl.json", 0),
    ] {
        let from = asset(name);
        let source = from.display().to_string();
        let output = covact(folder.path(), &["convert", &source, "-o", "out.json"]);
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{told}");
        assert_eq!(stdout(&output), "");
        let (old, new) = (
            read_path(&from).unwrap(),
            read_path(&folder.path().join("out.json")).unwrap(),
        );
        let end = format!("({trimmed} trimmed), unit {}, in out.json\n", old.unit.name);
        assert!(told.ends_with(&end), "{told}");
        // A warning for each surface that is left out.
        assert_eq!(told.lines().count(), 1 + old.skipped.len(), "{told}");
        for (old, new) in old.patches.iter().zip(&new.patches) {
            // Compares trims, too. A patch of floats equals another where all bits do, up to the sign of zero.
            assert_eq!(old.patch, new.patch, "{name}, entity {}", old.entity);
            assert_eq!(old.patch.trim().is_some(), new.patch.trim().is_some());
        }
        let (before, after) = (
            inspect(folder.path(), &source),
            inspect(folder.path(), "out.json"),
        );
        for part in ["unit", "resolution", "patches", "surface"] {
            assert_eq!(before[part], after[part], "{name}: {part}");
        }
        assert_eq!(after["format"], "covact");
        for part in ["patches", "trimmed", "rectangles"] {
            assert_eq!(
                before["summary"][part], after["summary"][part],
                "{name}: {part}"
            );
        }
        // Once more, to the standard output: the same text.
        let output = covact(folder.path(), &["convert", "out.json", "-o", "-"]);
        let text = std::fs::read_to_string(folder.path().join("out.json")).unwrap();
        assert!(stdout(&output) == text, "{name}");
    }
}

#[test]
fn units_and_faults() {
    let folder = tempfile::tempdir().unwrap();
    let sphere = asset("sphere.igs").display().to_string();
    let run = |arguments: &[&str]| covact(folder.path(), &[&["convert"], arguments].concat());
    let output = run(&[&sphere, "-o", "inch.json", "--unit", "in"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let inch = inspect(folder.path(), "inch.json");
    assert_eq!(inch["unit"]["name"], "in");
    let areas =
        [&inch, &inspect(folder.path(), &sphere)].map(|f| f["surface"]["area"].as_f64().unwrap());
    assert!(
        (areas[0] * 25.4 * 25.4 / areas[1] - 1.0).abs() < 1e-12,
        "{areas:?}"
    );
    std::fs::write(folder.path().join("t.stp"), "ISO-10303-21;\n").unwrap();
    for (arguments, code, message) in [
        (
            &[&sphere, "-o", "out.json", "--unit", "inn"][..],
            2,
            "did you mean `in`?",
        ),
        (
            &[&sphere, "-o", "none/out.json"],
            5,
            "cannot write `none/out.json`",
        ),
        (
            &["sphere.igs", "-o", "out.json"],
            3,
            "there is no file `sphere.igs`",
        ),
        (
            &["t.stp", "-o", "out.json"],
            3,
            "t.stp:2:1: expected a section (HEADER, DATA) or END-ISO-10303-21",
        ),
    ] {
        let output = run(arguments);
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{told}");
        assert!(
            told.starts_with("error: ") && told.contains(message),
            "{told}"
        );
    }
    assert!(!folder.path().join("out.json").exists());
}

/// By its ending: the same faces, areas and unit, and a message where IGES cannot have them.
#[test]
fn iges_faces() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| covact(folder.path(), &[&["convert"], arguments].concat());
    for name in ["cad/cone_faces.igs", "cad/trimmed_patch_faces.igs"] {
        let source = asset(name).display().to_string();
        let output = run(&[&source, "-o", "out.igs"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let (before, after) = (
            inspect(folder.path(), &source),
            inspect(folder.path(), "out.igs"),
        );
        assert_eq!(after["format"], "iges");
        assert_eq!(before["unit"], after["unit"]);
        let areas = |found: &Value| -> Vec<f64> {
            let patches = found["patches"].as_array().unwrap().iter();
            patches.map(|p| p["area"].as_f64().unwrap()).collect()
        };
        let (one, two) = (areas(&before), areas(&after));
        assert_eq!(one.len(), two.len());
        for (a, b) in one.into_iter().zip(two) {
            assert!((a / b - 1.0).abs() < 1e-9, "{name}: {a} {b}");
        }
    }
    let source = asset("cad/quarter_cylinder.cad.json").display().to_string();
    let output = run(&[&source, "-o", "out.IGES"]);
    assert_eq!(output.status.code(), Some(3));
    let told = stderr(&output);
    assert!(
        told.contains("the file states no length unit, and IGES must name one; --unit names one"),
        "{told}"
    );
    let output = run(&[&source, "-o", "out.IGES", "--unit", "mm"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = run(&[&source, "-o", "out.stp"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("STEP is read, not written"));
}
