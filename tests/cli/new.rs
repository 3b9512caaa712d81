//! `covact new`: templates that run as they are.
use crate::support::{covact, stderr};
use covact::output::{Summary, read_csv};
use covact::scene;

/// Every template is a scene with comments that names its schema, is right, and runs to its end with a contact force that more
/// than a few slave points carry.
#[test]
fn templates_run_to_their_end() {
    for (template, tool) in [
        ("press", "ball"),
        ("draw", "cylinder"),
        ("squeeze", "plate"),
        ("hertz", "roll"),
        ("snap", "roll"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let made = covact(folder.path(), &["new", "mine", "--template", template]);
        assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
        let path = folder.path().join("mine.json");
        let loaded = scene::load(&path).unwrap_or_else(|e| panic!("{template}: {e}"));
        let schema = loaded.scene.schema.as_deref().expect("a schema");
        let schema = std::fs::read_to_string(folder.path().join(schema)).expect("the schema");
        assert_eq!(schema, scene::schema());
        let run = covact(folder.path(), &["run", "mine.json", "-o", "out", "--quiet"]);
        assert_eq!(run.status.code(), Some(0), "{template}: {}", stderr(&run));
        let summary = Summary::read(&folder.path().join("out/summary.json")).unwrap();
        for contact in &summary.accuracy.contacts {
            assert!(contact.active >= 8, "{template}: {contact:?}");
            assert_eq!(contact.few, None, "{template}: {contact:?}");
        }
        let table = read_csv(&folder.path().join("out/history.csv")).unwrap();
        let force = table.column(&format!("force.{tool}.z")).unwrap();
        assert!(force.last().unwrap().abs() > 0.01, "{template}: {force:?}");
    }
}

#[test]
fn unknown_templates_are_refused_with_the_known_ones() {
    let folder = tempfile::tempdir().unwrap();
    let made = covact(folder.path(), &["new", "mine", "--template", "pres"]);
    assert_eq!(made.status.code(), Some(2));
    let said = stderr(&made);
    for name in ["press", "draw", "squeeze", "hertz", "snap"] {
        assert!(said.contains(name), "{said}");
    }
    assert!(!folder.path().join("mine.json").exists());
}

#[test]
fn a_schema_that_is_there_is_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let schema = folder.path().join("covact.schema.json");
    std::fs::write(&schema, "mine").unwrap();
    let made = covact(folder.path(), &["new", "mine"]);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    assert_eq!(std::fs::read_to_string(&schema).unwrap(), "mine");
}
