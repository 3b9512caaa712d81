//! What README states is what the program does.
use covact::output::column_table;

#[test]
fn readme_lists_the_columns_of_the_history() {
    let readme = include_str!("../README.md");
    assert!(
        readme.contains(&column_table()),
        "put this into README.md:\n{}",
        column_table()
    );
}

#[test]
fn readme_lists_the_shipped_scenes() {
    let readme = include_str!("../README.md");
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
                readme.contains(&format!("`{stem}`")),
                "README does not list {stem}"
            );
            scenes += 1;
        }
    }
    assert!(scenes >= 4);
}

#[test]
fn the_scene_in_the_readme_is_well_formed() {
    let readme = include_str!("../README.md");
    let start = readme.find("```json\n").expect("a scene") + 8;
    let end = start + readme[start..].find("```").expect("its end");
    let scene = covact::scene::parse(&readme[start..end], "README.md").expect("a scene");
    let problems = covact::scene::check(&scene);
    // The CAD file it names does not lie beside README.
    assert!(
        problems
            .iter()
            .all(|p| p.pointer == "/surfaces/punch/cad/file"),
        "{problems:?}"
    );
}

#[test]
fn readme_lists_the_cases_of_the_gauntlet() {
    let readme = include_str!("../README.md");
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
            assert!(readme.contains(&row), "README lacks {row}");
            cases += 1;
        }
    }
    assert!(cases >= 40);
}

#[test]
fn the_study_in_the_readme_is_right() {
    use covact::study::{expand, load};
    let readme = include_str!("../README.md");
    let start = readme.find("{\n  \"covact_study\"").expect("a study");
    let end = start + readme[start..].find("```").expect("its end");
    let folder = tempfile::tempdir().expect("a folder");
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenes");
    let scene = "ball_on_plate.json";
    std::fs::copy(format!("{scenes}/{scene}"), folder.path().join(scene)).expect("its scene");
    let study = folder.path().join("study.json");
    std::fs::write(&study, &readme[start..end]).expect("written");
    let study = load(&study).expect("well-formed");
    let expansion = expand(&study).expect("right");
    // Three masters with three shells, and two runs of a reference.
    assert_eq!(expansion.runs.len(), 11);
}

#[test]
fn readme_lists_the_shipped_studies() {
    let readme = include_str!("../README.md");
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/studies");
    let mut studies = 0;
    for entry in std::fs::read_dir(folder).expect("studies") {
        let path = entry.expect("entry").path();
        let stem = path.file_stem().and_then(|s| s.to_str()).expect("name");
        if path.extension().is_some_and(|e| e == "json") && stem != "schema" {
            assert!(
                readme.contains(&format!("`{stem}`")),
                "README does not list {stem}"
            );
            // What it found is beside it.
            let found = path.with_file_name("found").join(stem).join("study.csv");
            assert!(found.is_file(), "{}", found.display());
            studies += 1;
        }
    }
    assert!(studies >= 5);
}
