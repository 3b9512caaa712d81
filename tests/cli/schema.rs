//! The schema and the example scenes that are committed.
use covact::scene;
use std::path::{Path, PathBuf};
use std::process::Command;

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes")
}

/// To renew it: `cargo run -- schema > examples/scenes/schema.json`.
#[test]
fn the_committed_schema_is_up_to_date() {
    let output = Command::new(env!("CARGO_BIN_EXE_covact"))
        .arg("schema")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0));
    let printed = String::from_utf8(output.stdout).unwrap();
    let committed = std::fs::read_to_string(scenes().join("schema.json")).unwrap();
    assert!(
        printed == committed,
        "run `cargo run -- schema > examples/scenes/schema.json`"
    );
}

/// To renew it: `cargo run -- schema --study > examples/studies/schema.json`.
#[test]
fn the_committed_schema_of_studies_is_up_to_date() {
    let output = Command::new(env!("CARGO_BIN_EXE_covact"))
        .args(["schema", "--study"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0));
    let printed = String::from_utf8(output.stdout).unwrap();
    let path = scenes().join("../studies/schema.json");
    let committed = std::fs::read_to_string(path).unwrap();
    assert!(
        printed == committed,
        "run `cargo run -- schema --study > examples/studies/schema.json`"
    );
}

#[test]
fn the_schemas_describe_what_is_read() {
    described(&covact::study::schema());
    let schema = described(&scene::schema());
    assert_eq!(without_description(&schema, ""), Vec::<String>::new());
    let surface = &schema["$defs"]["Surface"];
    assert_eq!(surface["oneOf"].as_array().unwrap().len(), 4, "{surface}");
}

/// Properties that say nothing of themselves.
fn without_description(schema: &serde_json::Value, at: &str) -> Vec<String> {
    let mut found = Vec::new();
    if let Some(properties) = schema["properties"].as_object() {
        let bare = properties
            .iter()
            .filter(|(_, p)| !p["description"].is_string());
        found.extend(bare.map(|(name, _)| format!("{at}/{name}")));
    }
    let children: Vec<(String, &serde_json::Value)> = match schema {
        serde_json::Value::Object(o) => o.iter().map(|(k, v)| (k.clone(), v)).collect(),
        serde_json::Value::Array(a) => a
            .iter()
            .enumerate()
            .map(|(i, v)| (i.to_string(), v))
            .collect(),
        _ => Vec::new(),
    };
    for (key, child) in children {
        found.extend(without_description(child, &format!("{at}/{key}")));
    }
    found
}

fn described(schema: &str) -> serde_json::Value {
    let schema: serde_json::Value = serde_json::from_str(schema).unwrap();
    assert_eq!(schema["additionalProperties"], false);
    assert!(schema["properties"]["$schema"].is_object());
    for (name, definition) in schema["$defs"].as_object().unwrap() {
        let text = definition.to_string();
        assert!(
            text.contains("\"description\""),
            "{name} is not described: {text}"
        );
        // Objects take no other keys, wherever they are.
        assert!(
            text.matches("\"properties\"").count()
                == text.matches("\"additionalProperties\":false").count(),
            "{name}: {text}"
        );
    }
    schema
}

#[test]
fn example_scenes_are_right() {
    let mut found = 0;
    for entry in std::fs::read_dir(scenes()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "json") || path.ends_with("schema.json") {
            continue;
        }
        let loaded = scene::load(&path).unwrap_or_else(|e| panic!("{e}"));
        let problems = scene::check(&loaded);
        assert!(problems.is_empty(), "{}", loaded.error(problems));
        found += 1;
    }
    assert!(found >= 2, "{found} scenes");
}
