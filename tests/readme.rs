//! What README and the pages of docs state is what the program does.
use covact::output::column_table;
use covact::run::exit_table;
use serde_json::{Value, json};

#[test]
fn docs_lists_the_columns_of_the_history() {
    let page = include_str!("../docs/outputs.md");
    assert!(
        page.contains(&column_table()),
        "put this into docs/outputs.md:\n{}",
        column_table()
    );
}

#[test]
fn docs_lists_the_exit_codes() {
    let page = include_str!("../docs/messages.md");
    assert!(
        page.contains(&exit_table()),
        "put this into docs/messages.md:\n{}",
        exit_table()
    );
}

#[test]
fn docs_lists_the_effects() {
    let page = include_str!("../docs/effects.md");
    for kind in covact::model::EffectKind::ALL {
        let listed = if kind.is_detail() { "no" } else { "yes" };
        let row = format!("| `{}` | {} | {listed} |", kind.name(), kind.meaning());
        assert!(page.contains(&row), "docs/effects.md lacks {row}");
    }
    let rows = page.lines().filter(|line| line.starts_with("| `")).count();
    assert_eq!(rows, covact::model::EffectKind::ALL.len());
}

/// Names of properties and values of a schema.
fn names(schema: &Value, found: &mut std::collections::BTreeSet<String>) {
    match schema {
        Value::Object(object) => {
            if let Some(Value::Object(properties)) = object.get("properties") {
                found.extend(properties.keys().cloned());
            }
            let values = object.get("enum").and_then(Value::as_array);
            let values = values.into_iter().flatten().chain(object.get("const"));
            found.extend(values.filter_map(|v| v.as_str().map(str::to_owned)));
            object.values().for_each(|part| names(part, found));
        }
        Value::Array(parts) => parts.iter().for_each(|part| names(part, found)),
        _ => {}
    }
}

#[test]
fn docs_has_every_key_of_the_schemas() {
    let scenes = include_str!("../docs/scene_format.md");
    let studies = format!("{scenes}{}", include_str!("../docs/studies.md"));
    for (schema, page, least) in [
        (covact::scene::schema(), scenes, 200),
        (covact::study::schema(), &studies, 60),
    ] {
        let schema: Value = serde_json::from_str(&schema).expect("JSON");
        let mut found = std::collections::BTreeSet::new();
        names(&schema, &mut found);
        let word = |c: char| !(c.is_alphanumeric() || c == '_' || c == '$');
        let words: std::collections::BTreeSet<&str> = page.split(word).collect();
        for name in &found {
            assert!(words.contains(name.as_str()), "the pages lack `{name}`");
        }
        assert!(found.len() > least, "{}", found.len());
    }
}

#[test]
fn docs_lists_the_shipped_scenes() {
    let page = include_str!("../docs/scenes.md");
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenes");
    let mut scenes = 0;
    for entry in std::fs::read_dir(folder).expect("scenes") {
        let path = entry.expect("entry").path();
        let stem = path
            .file_stem()
            .and_then(|s| s.to_str())
            .expect("name")
            .to_owned();
        if stem != "schema" {
            assert!(
                page.contains(&format!("`{stem}`")),
                "docs/scenes.md does not list {stem}"
            );
            scenes += 1;
        }
    }
    assert!(scenes >= 4);
}

#[test]
fn scenes_in_readme_and_docs_are_well_formed() {
    for (name, page) in [
        ("README.md", include_str!("../README.md")),
        ("docs/scenes.md", include_str!("../docs/scenes.md")),
    ] {
        let start = page.find("```json\n").expect("a scene") + 8;
        let end = start + page[start..].find("```").expect("its end");
        let scene = covact::scene::parse(&page[start..end], name).expect("a scene");
        let problems = covact::scene::check(&scene);
        // The CAD file it names does not lie beside the page.
        assert!(
            (problems.iter()).all(|p| p.pointer.starts_with("/surfaces/punch/cad")),
            "{name}: {problems:?}"
        );
    }
}

/// Every fragment of the reference is read, with what a scene needs beside it where it is none by itself.
#[test]
fn fragments_of_the_reference_are_read() {
    let page = include_str!("../docs/scene_format.md");
    let base = json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 10, "nu": 0.45 } } },
        "bodies": { "sheet": {
            "mesh": { "plate": { "size": [50, 40], "thickness": 1, "elements": [40, 32] } }, "material": "rubber"
        } },
        "surfaces": { "punch": { "sphere": { "radius": 20, "center": [25, 20, 20.6] } } },
        "contacts": { "press": { "slave": "sheet.top", "master": "punch" } },
        "supports": { "held": { "on": ["sheet.x_min"], "fixed": true } }
    });
    let mut fragments = 0;
    for block in page.split("```json\n").skip(1) {
        let text = block.split("```").next().expect("its end");
        let fragment: serde_json::Map<String, Value> =
            serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"));
        let whole = fragment.contains_key("covact");
        let mut scene = if whole { json!({}) } else { base.clone() };
        for (key, value) in fragment {
            match (scene.get_mut(&key).and_then(Value::as_object_mut), value) {
                (Some(named), Value::Object(more)) => named.extend(more),
                (_, value) => scene[key] = value,
            }
        }
        let scene = scene.to_string();
        let read = covact::scene::parse(&scene, "docs/scene_format.md");
        let read = read.unwrap_or_else(|e| panic!("{e:?}: {text}"));
        // Files that are named do not lie beside the page.
        let problems = covact::scene::check(&read);
        let files = |p: &str| p.contains("/cad") || p.contains("/mesh") || p.contains("/nurbs");
        assert!(
            problems.iter().all(|p| files(&p.pointer)),
            "{problems:?}: {text}"
        );
        fragments += 1;
    }
    assert!(fragments >= 30, "{fragments}");
}

#[test]
fn docs_lists_the_cases_of_the_gauntlet() {
    let page = include_str!("../docs/hard_cases.md");
    let mut cases = 0;
    for group in covact::gauntlet::GROUPS {
        for case in group.cases {
            let row = format!(
                "| {}: {} | {} | {} |",
                group.name,
                case.name.replace('_', " "),
                case.what,
                case.right
            );
            assert!(page.contains(&row), "docs/hard_cases.md lacks {row}");
            cases += 1;
        }
    }
    assert!(cases >= 130);
}

#[test]
fn the_study_in_the_docs_is_right() {
    use covact::study::{expand, load};
    let page = include_str!("../docs/studies.md");
    let start = page.find("{\n  \"covact_study\"").expect("a study");
    let end = start + page[start..].find("```").expect("its end");
    let folder = tempfile::tempdir().expect("a folder");
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenes");
    let scene = "ball_on_plate.json";
    std::fs::copy(format!("{scenes}/{scene}"), folder.path().join(scene)).expect("its scene");
    let study = folder.path().join("study.json");
    std::fs::write(&study, &page[start..end]).expect("written");
    let study = load(&study).expect("well-formed");
    let expansion = expand(&study).expect("right");
    // Three masters with three shells, and two runs of a reference.
    assert_eq!(expansion.runs.len(), 11);
}

#[test]
fn docs_lists_the_shipped_studies() {
    let page = include_str!("../docs/accuracy.md");
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/studies");
    let mut studies = 0;
    for entry in std::fs::read_dir(folder).expect("studies") {
        let path = entry.expect("entry").path();
        let stem = path.file_stem().and_then(|s| s.to_str()).expect("name");
        if path.extension().is_some_and(|e| e == "json") && stem != "schema" {
            assert!(
                page.contains(&format!("`{stem}`")),
                "docs/accuracy.md does not list {stem}"
            );
            // What it found is beside it.
            let found = path.with_file_name("found").join(stem).join("study.csv");
            assert!(found.is_file(), "{}", found.display());
            studies += 1;
        }
    }
    assert!(studies >= 5);
}

#[test]
fn readme_is_short_and_leads_on() {
    let readme = include_str!("../README.md");
    assert!(readme.lines().count() <= 150, "{}", readme.lines().count());
    // The book has every page (`tests/book`).
    for page in ["SUMMARY.md", "book.md", "tutorials/first_press.md"] {
        assert!(readme.contains(&format!("](docs/{page})")), "{page}");
    }
    // Its rows of rivals are those of the full table.
    let all = include_str!("../docs/hard_cases.md");
    let rows = (readme.lines()).skip_while(|l| !l.starts_with("| case | covact |"));
    let rows: Vec<&str> = rows.take_while(|l| l.starts_with('|')).collect();
    assert_eq!(rows.len(), 2 + 5);
    for row in rows {
        assert!(all.contains(row), "docs/hard_cases.md lacks {row}");
    }
}
