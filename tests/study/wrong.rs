//! Wrong studies, with the place of what is wrong.
use crate::support::*;
use covact::scene::{Problem, SceneError};
use covact::study::expand;
use serde_json::{Value, json};

fn problems(content: &Value) -> Vec<Problem> {
    let folder = tempfile::tempdir().unwrap();
    match expand(&loaded(folder.path(), content)) {
        Err(SceneError::Wrong { name, problems, .. }) => {
            assert!(name.ends_with("study.json"), "{name}");
            problems
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("it is right: {content:#}"),
    }
}

/// The study has one problem, at this pointer, with these words.
fn refused(content: &Value, pointer: &str, message: &str, help: &str) {
    let found = problems(content);
    let [problem] = &found[..] else {
        panic!("{found:#?}");
    };
    assert_eq!(problem.pointer, pointer, "{problem}");
    assert!(problem.message.contains(message), "{problem}");
    assert!(
        problem.help.as_deref().unwrap_or("").contains(help),
        "{problem}"
    );
}

fn grid(choice: Value) -> Value {
    study(json!([{ "choices": [choice] }]))
}

fn right() -> Value {
    grid(json!({ "shell": { "values": [{ "h8": [2, 2] }] } }))
}

fn with(changes: &[(&str, Value)]) -> Value {
    let mut study = right();
    for (key, value) in changes {
        study[*key] = value.clone();
    }
    study
}

#[test]
fn names_of_the_scene() {
    refused(
        &grid(json!({ "master": { "surface": "bal", "values": ["exact"] } })),
        "/grids/0/choices/0/master/surface",
        "the scene has no surface `bal`",
        "did you mean `ball`? surfaces: `ball`",
    );
    refused(
        &grid(json!({ "shell": { "body": "sheet", "values": [{ "h8": [2, 2] }] } })),
        "/grids/0/choices/0/shell/body",
        "the scene has no body `sheet`",
        "bodies: `plate`",
    );
    refused(
        &grid(json!({ "penalty": { "contact": "pres", "values": ["auto"] } })),
        "/grids/0/choices/0/penalty/contact",
        "the scene has no contact `pres`",
        "did you mean `press`?",
    );
    refused(
        &with(&[("scene", json!("scen.json"))]),
        "/scene",
        "there is no scene file `",
        "did you mean `scene.json`?",
    );
    refused(
        &with(&[("scene", json!("."))]),
        "/scene",
        "is a folder, and no scene file",
        "name a file",
    );
    let field =
        json!([{ "name": "u", "of": { "field": { "body": "plat", "name": "displacement" } } }]);
    refused(
        &with(&[("quantities", field)]),
        "/quantities/0/of/field/body",
        "there is no body `plat`",
        "did you mean `plate`?",
    );
}

#[test]
fn shells_that_the_mesh_does_not_have() {
    let at = "/grids/0/choices/0/shell/values/0";
    let shell = |value: Value| grid(json!({ "shell": { "values": [value] } }));
    refused(
        &shell(json!({ "h9": [2, 2] })),
        at,
        "unknown element `h9`",
        "did you mean `h8`? elements: h8, h8_displacement, h8_mean_dilatation, h8_eas3, q18",
    );
    refused(
        &shell(json!({ "h8": [2, 2, 2] })),
        at,
        "expected 2 numbers of elements, found 3",
        "body `plate` is a plate",
    );
    refused(
        &shell(json!({ "h8": [2, 2], "q18": [2, 2] })),
        at,
        "a shell is one element and its numbers",
        "{\"h8\": [10, 10]}",
    );
    refused(
        &shell(json!({ "h8": [0, 2] })),
        &format!("{at}/h8"),
        "with H8 0 x 2, the scene is wrong at `/bodies/plate/mesh/plate/elements/0`",
        "whole number from 1",
    );
}

#[test]
fn what_the_variants_of_the_scene_say() {
    // The message names the variant, the place is that of the value in the study.
    refused(
        &grid(json!({ "master": { "values": ["exact", { "bilinear": { "chord": -1 } }] } })),
        "/grids/0/choices/0/master/values/1",
        "with bilinear, chord -1, the scene is wrong at `/surfaces/ball/facets/chord`: the chord error is -1",
        "it must be positive",
    );
    refused(
        &grid(json!({ "points": { "values": [{ "averaged": "nodes" }] } })),
        "/grids/0/choices/0/points/values/0",
        "an averaged gap is the mean over points of the faces",
        "",
    );
    refused(
        &with(&[("set", json!({ "/solution/newton/max_iteration": 5 }))]),
        "/set/~1solution~1newton~1max_iteration",
        "unknown key `max_iteration`",
        "did you mean `max_iterations`?",
    );
    refused(
        &with(&[("set", json!({ "/contacts/pres/gap": "averaged" }))]),
        "/set/~1contacts~1pres~1gap",
        "there is no `pres` in `/contacts` of the scene",
        "did you mean `press`?",
    );
    // Said once, not for every combination.
    let both = study(json!([{ "choices": [
        { "step": { "values": [0.5, 1e-9] } },
        { "shell": { "values": [{ "h8": [2, 2] }, { "h8": [3, 3] }] } },
    ] }]));
    refused(
        &both,
        "/grids/0/choices/0/step/values/1",
        "with step 1e-9, H8 2 x 2, the scene is wrong at `/solution/step/",
        "min <= initial <= max",
    );
    refused(
        &with(&[(
            "references",
            json!({ "fine": { "runs": [{}, { "/output/tessellation": 0 }] } }),
        )]),
        "/references/fine/runs/1/~1output~1tessellation",
        "with run 2 of the reference `fine`, the scene is wrong",
        "from 1 to 200",
    );
}

#[test]
fn numbers_and_lists() {
    for (changes, pointer, message) in [
        (("grids", json!([])), "/grids", "at least one grid"),
        (
            ("grids", json!([{ "choices": [] }])),
            "/grids/0/choices",
            "has no choices",
        ),
        (
            ("quantities", json!([])),
            "/quantities",
            "a quantity to measure",
        ),
        (
            ("timing", json!({ "repeats": 0 })),
            "/timing/repeats",
            "`repeats` is 0",
        ),
        (
            ("timing", json!({ "limit": 0 })),
            "/timing/limit",
            "the limit is 0",
        ),
        (
            ("timing", json!({ "threads": 0 })),
            "/timing/threads",
            "`threads` is 0",
        ),
        (
            ("targets", json!([0.1, -0.1])),
            "/targets/1",
            "a relative error is -0.1",
        ),
        (
            ("references", json!({ "a": { "runs": [{}] } })),
            "/references/a/runs",
            "a reference has 1 run(s)",
        ),
        (
            (
                "references",
                json!({ "a": { "runs": [{}, {}], "ratio": 1 } }),
            ),
            "/references/a/ratio",
            "the ratio of mesh sizes is 1",
        ),
    ] {
        refused(&with(&[changes]), pointer, message, "");
    }
    for (choice, pointer, message) in [
        (
            json!({ "step": { "values": [] } }),
            "/step/values",
            "the choice has no values",
        ),
        (
            json!({ "step": { "values": [0] } }),
            "/step/values/0",
            "the step is 0",
        ),
        (
            json!({ "key": { "name": "k", "at": [], "values": [1] } }),
            "/key/at",
            "no key of the scene is named",
        ),
        (
            json!({ "master": { "values": [{ "stl": { "chord": 0 } }] } }),
            "/master/values/0/stl/chord",
            "the chord error is 0",
        ),
        (
            json!({ "master": { "values": [{ "stl": { "file": "no.stl" } }] } }),
            "/master/values/0/stl/file",
            "there is no file `",
        ),
        (
            json!({ "augmentation": { "values": ["all"] } }),
            "/augmentation/values/0",
            "expected \"none\" or an object, found \"all\"",
        ),
    ] {
        refused(
            &grid(choice),
            &format!("/grids/0/choices/0{pointer}"),
            message,
            "",
        );
    }
}

#[test]
fn names_that_are_taken_and_references_that_are_not_there() {
    let column = |name: &str, reference: Value| json!({ "name": name, "of": { "column": { "name": "force.ball.z" } }, "reference": reference });
    refused(
        &with(&[(
            "quantities",
            json!([column("f", Value::Null), column("f", Value::Null)]),
        )]),
        "/quantities/1/name",
        "two quantities are called `f`",
        "another name",
    );
    refused(
        &with(&[
            (
                "references",
                json!({ "fine": { "runs": [{}, { "/solution/end_time": 1 }] } }),
            ),
            (
                "quantities",
                json!([column("f", json!({ "finest": "fin" }))]),
            ),
        ]),
        "/quantities/0/reference/finest",
        "there is no reference `fin`",
        "did you mean `fine`?",
    );
    let curve = json!({ "curve": { "file": "no.csv", "x": "t", "y": "f", "source": "nobody" } });
    refused(
        &with(&[("quantities", json!([column("f", curve)]))]),
        "/quantities/0/reference/curve/file",
        "there is no file `",
        "study file",
    );
    let twice = study(
        json!([{ "choices": [{ "step": { "values": [1] } }, { "step": { "values": [0.5] } }] }]),
    );
    refused(
        &twice,
        "/grids/0/choices/1/step",
        "two choices of the grid are called `step`",
        "",
    );
}

/// As users see it: place, line, exit code, and nothing is written.
#[test]
fn the_program_points_into_the_study() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.json", &scene());
    let text = "{ \"covact_study\": 1, \"scene\": \"scene.json\",\n  \"grids\": [{ \"choices\": [{ \"steps\": { \"values\": [1] } }] }],\n  \"quantities\": [] }\n";
    std::fs::write(folder.path().join("study.json"), text).unwrap();
    let output = covact(folder.path(), &["study", "study.json", "-o", "out"]);
    assert_eq!(output.status.code(), Some(3));
    let said = stderr(&output);
    assert!(
        said.starts_with("error: study.json:2:29: unknown name `steps`"),
        "{said}"
    );
    assert!(said.contains("did you mean `step`?"), "{said}");
    assert!(!folder.path().join("out").exists());

    let output = covact(folder.path(), &["study", "stud.json", "-o", "out"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(
        stderr(&output).contains("there is no study file `stud.json`; did you mean `study.json`?"),
        "{}",
        stderr(&output)
    );
    for (text, part) in [
        (
            "{}",
            "a study starts with the version of its format, `\"covact_study\": 1`",
        ),
        (
            "{ \"covact_study\": 2 }",
            "version 2 of the study format is not known",
        ),
        ("", "the file is empty"),
    ] {
        std::fs::write(folder.path().join("study.json"), text).unwrap();
        let output = covact(folder.path(), &["study", "study.json", "-o", "out"]);
        assert_eq!(output.status.code(), Some(3));
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
    // A wrong scene is told as such.
    std::fs::write(folder.path().join("study.json"), right().to_string()).unwrap();
    std::fs::write(folder.path().join("scene.json"), "{ \"covact\": 1 }").unwrap();
    let output = covact(folder.path(), &["study", "study.json", "-o", "out"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(
        stderr(&output).contains("scene.json:1:1: the key `materials` is missing"),
        "{}",
        stderr(&output)
    );
}

/// What a study says itself, and what could not be told apart.
#[test]
fn output_and_labels() {
    for (at, value) in [
        ("/output/every", json!(1)),
        ("/output", json!({ "every": 1 })),
    ] {
        refused(
            &grid(json!({ "key": { "name": "output", "at": [at], "values": [value] } })),
            "/grids/0/choices/0/key/values/0",
            "`/output/every` cannot be chosen",
            "where a quantity is a `field`",
        );
    }
    refused(
        &grid(json!({ "variants": { "name": "case", "values": [
            { "label": "a" },
            { "label": "a", "set": { "/solution/end_time": 0.5 } },
        ] } })),
        "/grids/0/choices/0/variants/values/1/label",
        "two variants are called `a`",
        "a label of its own",
    );
}
