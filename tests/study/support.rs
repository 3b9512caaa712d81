//! A small scene and studies of it.
use covact::study::record::Record;
use covact::study::{Expansion, LoadedStudy, Planned, expand, load};
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

/// A quarter of a clamped plate of 4 x 4 elements that a ball pushes down in two steps.
pub fn scene() -> Value {
    json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 12000, "nu": 0.3 } } },
        "bodies": { "plate": {
            "mesh": { "plate": { "size": [40, 40], "thickness": 2, "elements": [4, 4] } },
            "material": "steel"
        } },
        "surfaces": { "ball": {
            "sphere": { "radius": 25, "center": [0, 0, 26] },
            "motion": { "translation": [0, 0, "-2*t"] }
        } },
        "contacts": { "press": { "slave": "plate.top", "master": "ball" } },
        "supports": {
            "clamp_x": { "on": "plate.x_max", "fixed": true },
            "clamp_y": { "on": "plate.y_max", "fixed": true },
            "symmetry_x": { "on": "plate.x_min", "symmetry": "x" },
            "symmetry_y": { "on": "plate.y_min", "symmetry": "y" }
        },
        "solution": { "step": { "initial": 0.5, "max": 0.5 } }
    })
}

/// A study of [`scene`] with these grids.
pub fn study(grids: Value) -> Value {
    json!({
        "covact_study": 1,
        "title": "small",
        "scene": "scene.json",
        "grids": grids,
        "quantities": [{ "name": "force", "of": { "column": { "name": "force.ball.z" } } }]
    })
}

pub fn write(folder: &Path, name: &str, content: &Value) {
    let text = serde_json::to_string_pretty(content).unwrap();
    std::fs::write(folder.join(name), text).unwrap();
}

/// Writes [`scene`] and a study of it, and reads the study.
pub fn loaded(folder: &Path, content: &Value) -> LoadedStudy {
    write(folder, "scene.json", &scene());
    write(folder, "study.json", content);
    load(folder.join("study.json")).unwrap_or_else(|e| panic!("{e}"))
}

/// The runs that a study asks for.
pub fn expanded(folder: &Path, content: &Value) -> Expansion {
    expand(&loaded(folder, content)).unwrap_or_else(|e| panic!("{e}"))
}

/// The value of a run's scene at a pointer; null where there is none.
pub fn at<'r>(run: &'r Planned, pointer: &str) -> &'r Value {
    run.scene.pointer(pointer).unwrap_or(&Value::Null)
}

/// The program in a folder.
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_covact"));
    command.current_dir(folder).args(arguments);
    command
}

pub fn covact(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The runs that `--json` told of.
pub fn events(output: &Output) -> Vec<Value> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let lines = text.lines().map(|l| serde_json::from_str(l).unwrap());
    let mut events: Vec<Value> = lines.collect();
    assert_eq!(events.pop().unwrap()["event"], "finished");
    assert!(events.iter().all(|e| e["event"] == "run"));
    events
}

/// `OUT/study.json`.
pub fn record(out: &Path) -> Record {
    let text = std::fs::read_to_string(out.join("study.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}
