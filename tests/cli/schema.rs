//! The schema and the example scenes that are committed.
use covact::scene;
use serde_json::{Value, json};
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

/// Whether a value is what a schema of the keywords that ours have asks for.
fn fits(value: &Value, schema: &Value, root: &Value) -> bool {
    let Some(keys) = schema.as_object() else {
        return schema != &Value::Bool(false);
    };
    let is = |kind: &str| match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|x| x.fract() == 0.0),
        other => panic!("type {other}"),
    };
    let all = |schemas: &Value| -> usize {
        let schemas = schemas.as_array().unwrap().iter();
        schemas.filter(|s| fits(value, s, root)).count()
    };
    let length = value.as_array().map_or(0, Vec::len) as u64;
    keys.iter().all(|(key, of)| match key.as_str() {
        "$ref" => fits(
            value,
            root.pointer(&of.as_str().unwrap()[1..]).unwrap(),
            root,
        ),
        "type" => match of {
            Value::Array(kinds) => kinds.iter().any(|kind| is(kind.as_str().unwrap())),
            kind => is(kind.as_str().unwrap()),
        },
        "properties" => (value.as_object().into_iter().flatten())
            .all(|(name, inner)| of.get(name).is_none_or(|s| fits(inner, s, root))),
        "additionalProperties" => (value.as_object().into_iter().flatten())
            .all(|(name, inner)| schema["properties"].get(name).is_some() || fits(inner, of, root)),
        "required" => (of.as_array().unwrap().iter())
            .all(|name| !value.is_object() || value.get(name.as_str().unwrap()).is_some()),
        "items" => (value.as_array().into_iter().flatten()).all(|item| fits(item, of, root)),
        "minItems" => !value.is_array() || length >= of.as_u64().unwrap(),
        "maxItems" => !value.is_array() || length <= of.as_u64().unwrap(),
        "minimum" => value.as_f64().is_none_or(|x| x >= of.as_f64().unwrap()),
        "maximum" => value.as_f64().is_none_or(|x| x <= of.as_f64().unwrap()),
        "const" => value == of,
        "enum" => of.as_array().unwrap().contains(value),
        "anyOf" => all(of) > 0,
        "oneOf" => all(of) == 1,
        "not" => !fits(value, of, root),
        "$defs" | "$schema" | "title" | "description" | "default" | "format" => true,
        other => panic!("keyword {other}"),
    })
}

/// A scene with a value put in a place of it.
fn with(pointer: &str, value: Value) -> Value {
    let mut scene = json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 10, "nu": 0.3 } } },
        "bodies": { "sheet": { "mesh": { "plate": { "size": [4, 2], "thickness": 1, "elements": [4, 2] } }, "material": "rubber" } },
        "surfaces": { "tool": { "sphere": { "radius": 5 }, "motion": {} } },
        "contacts": { "press": { "slave": "sheet.top", "master": "tool" } },
        "supports": { "held": { "on": "sheet.x_min", "fixed": true } },
    });
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    scene.pointer_mut(parent).unwrap()[key] = value;
    scene
}

/// The program and the schema, by which editors judge, take the same spellings.
#[test]
fn the_schema_takes_what_the_program_takes() {
    let schema: Value = serde_json::from_str(&scene::schema()).unwrap();
    let panel = |kind: &str, key: &str, value: Value| {
        let mut panel = json!({ "radius": 5, "thickness": 1, "elements": [3, 3] });
        panel["angles"] = json!([0, 90]);
        panel["y"] = json!([0, 1]);
        if kind == "sphere_panel" {
            panel = json!({ "radius": 5, "thickness": 1, "elements": [3, 3], "latitude": [0, 10], "longitude": [0, 10] });
        }
        panel[key] = value;
        json!({ kind: panel })
    };
    let on = |what: Value| {
        let mut support = json!({ "on": "sheet.x_min" });
        support["displacement"] = what;
        support
    };
    let (mesh, tool) = ("/bodies/sheet/mesh", "/surfaces/tool");
    let at = json!([1, 2, 3]);
    let turned = json!({ "axis": [0, 0, 1], "angle": 9 });
    let cases = [
        (true, with("/contacts/press/friction", json!(0.2))),
        (true, with("/contacts/press/friction", json!("0.1*t"))),
        (
            true,
            with("/contacts/press/friction", json!({ "coulomb": 0.2 })),
        ),
        (
            true,
            with(
                "/contacts/press/friction",
                json!({ "coulomb": { "mu": 0.2 } }),
            ),
        ),
        (false, with("/contacts/press/friction", json!([0.2]))),
        (
            true,
            with(
                "/contacts/press/initial_overclosure",
                json!({ "shrink": 1 }),
            ),
        ),
        (true, with("/contacts/press/slave", json!("sheet"))),
        (
            true,
            with("/contacts/press/slave", json!(["sheet.top", "sheet.x_max"])),
        ),
        (
            false,
            with("/contacts/press/slave", json!({ "on": "sheet.top" })),
        ),
        (true, with("/contacts/press/master", json!(["tool"]))),
        (true, with("/solution", json!({ "linear_solver": "mumps" }))),
        (
            true,
            with("/solution", json!({ "linear_solver": { "mumps": {} } })),
        ),
        (
            true,
            with("/supports/held", on(json!({ "x": 1, "y": null }))),
        ),
        (true, with("/supports/held", on(json!([1, null, "t"])))),
        (false, with("/supports/held", on(json!([1, null])))),
        (false, with("/supports/held", on(json!([1, null, true])))),
        (
            true,
            with(
                "/surfaces/tool/motion/free",
                json!({ "force": [null, null, -5] }),
            ),
        ),
        (
            true,
            with(
                "/surfaces/tool/motion/free",
                json!({ "moment": { "z": -5 } }),
            ),
        ),
        (
            true,
            with(
                "/surfaces/tool/placement",
                json!({ "axis": [0, 0, 1], "angle": 9 }),
            ),
        ),
        (
            true,
            with("/surfaces/tool/placement", json!({ "rotation": turned })),
        ),
        (
            false,
            with(
                "/surfaces/tool/placement",
                json!({ "rotation": turned, "angle": 9 }),
            ),
        ),
        (
            true,
            with(
                "/bodies/sheet/placement",
                json!({ "rotation": turned, "scale": 2 }),
            ),
        ),
        (true, with(mesh, json!("sheet.msh"))),
        (true, with(mesh, json!({ "file": "sheet.msh" }))),
        (
            true,
            with(
                mesh,
                json!({ "plate": { "size": [4, 2], "thickness": 1, "elements": [4, 2], "center": at } }),
            ),
        ),
        (
            true,
            with(
                mesh,
                json!({ "plate": { "size": [4, 2], "thickness": 1, "elements": [4, 2], "origin": at } }),
            ),
        ),
        (
            true,
            with(
                mesh,
                json!({ "block": { "size": [4, 2, 1], "elements": [4, 2, 1], "center": at } }),
            ),
        ),
        (
            true,
            with(
                mesh,
                json!({ "block": { "min": [0, 0, 0], "max": at, "elements": [4, 2, 1] } }),
            ),
        ),
        (
            true,
            with(mesh, panel("cylinder_panel", "center", at.clone())),
        ),
        (
            true,
            with(mesh, panel("cylinder_panel", "origin", at.clone())),
        ),
        (
            true,
            with(mesh, panel("sphere_panel", "center", at.clone())),
        ),
        (
            true,
            with(mesh, panel("sphere_panel", "origin", at.clone())),
        ),
        (
            false,
            with(mesh, panel("sphere_panel", "centre", at.clone())),
        ),
        (true, with(tool, json!({ "cad": "tool.step" }))),
        (
            true,
            with(tool, json!({ "sphere": { "radius": 5, "origin": at } })),
        ),
        (
            true,
            with(tool, json!({ "sphere": { "radius": 5, "center": at } })),
        ),
        (
            false,
            with(
                tool,
                json!({ "sphere": { "radius": 5, "center": at, "origin": at } }),
            ),
        ),
        (
            true,
            with(
                tool,
                json!({ "cylinder": { "radius": 5, "length": 2, "origin": at } }),
            ),
        ),
        (
            true,
            with(tool, json!({ "plane": { "size": [5, 5], "center": at } })),
        ),
        (
            false,
            with(tool, json!({ "plane": { "size": [5, 5], "origin": at } })),
        ),
        (
            true,
            with(
                tool,
                json!({ "plane": { "size": [5, 5] }, "side": "outward" }),
            ),
        ),
    ];
    let mut wrong = String::new();
    for (right, scene) in cases {
        let read = scene::parse(&scene.to_string(), "scene.json").is_ok();
        let fits = fits(&scene, &schema, &schema);
        if read != right || fits != right {
            wrong += &format!("{scene}\nread: {read}, fits the schema: {fits}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn example_scenes_are_right() {
    let schema: Value = serde_json::from_str(&scene::schema()).unwrap();
    let mut found = 0;
    for entry in std::fs::read_dir(scenes()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "json") || path.ends_with("schema.json") {
            continue;
        }
        let loaded = scene::load(&path).unwrap_or_else(|e| panic!("{e}"));
        let problems = scene::check(&loaded);
        assert!(problems.is_empty(), "{}", loaded.error(problems));
        let text = std::fs::read_to_string(&path).unwrap();
        let plain: Value = serde_json::from_str(&text).unwrap();
        assert!(fits(&plain, &schema, &schema), "{}", path.display());
        found += 1;
    }
    assert!(found >= 2, "{found} scenes");
}
