//! Runs the program on small scenes.
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

/// The program with these arguments, in a folder, without a terminal.
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_covact"));
    command
        .current_dir(folder)
        .args(arguments)
        .env_remove("NO_COLOR");
    command
}

/// Runs [`command`] to its end.
pub fn covact(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// `covact check` and `covact run` of a scene of this text both fail with exit code 3 and the same message, and make no
/// folder.
pub fn refused_in(folder: &Path, text: &[u8]) -> String {
    std::fs::write(folder.join("scene.json"), text).unwrap();
    let check = covact(folder, &["check", "scene.json"]);
    let run = covact(folder, &["run", "scene.json", "-o", "out", "--quiet"]);
    assert_eq!(check.status.code(), Some(3), "{}", stderr(&check));
    assert_eq!(run.status.code(), Some(3), "{}", stderr(&run));
    assert_eq!(stderr(&check), stderr(&run));
    assert_eq!(stdout(&check), "");
    assert!(!folder.join("out").exists());
    stderr(&check)
}

/// The text with lines joined that go on below, by four columns farther in.
pub fn unfolded(text: &str) -> String {
    let mut out = String::new();
    let mut before = 0;
    for line in text.lines() {
        let inside = line.len() - line.trim_start().len();
        if inside == before + 4 {
            out.pop();
            out += &format!(" {}\n", line.trim_start());
        } else {
            out += &format!("{line}\n");
            before = inside;
        }
    }
    out
}

/// All parts occur, in this order.
pub fn assert_parts(message: &str, parts: &[&str]) {
    let mut rest = message;
    for part in parts {
        let at = rest
            .find(part)
            .unwrap_or_else(|| panic!("no `{part}` in\n{message}"));
        rest = &rest[at + part.len()..];
    }
}

/// A quarter of a clamped plate of 4 x 4 elements under a ball that pushes it down by 2.
pub fn plate_scene() -> Value {
    json!({
        "covact": 1,
        "title": "plate under a ball",
        "units": { "length": "mm" },
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

/// [`plate_scene`] with values at JSON pointers replaced or, in objects, added.
pub fn plate_with(changes: &[(&str, Value)]) -> Value {
    let mut scene = plate_scene();
    for (pointer, value) in changes {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = scene.pointer_mut(parent).expect(pointer);
        parent[key] = value.clone();
    }
    scene
}

/// The scene as text, and where the value (of objects and lists: the key) of a JSON pointer starts: `line:column`.
pub fn text_and_place(scene: &Value, pointer: &str) -> (String, String) {
    let text = serde_json::to_string_pretty(scene).unwrap();
    // A pretty-printed key stands in a line of its own, two blanks in for every level.
    let mut from = 0;
    for (level, key) in pointer.split('/').skip(1).enumerate() {
        let key = format!("\n{}\"{key}\": ", "  ".repeat(level + 1));
        from += text[from..].find(&key).expect(&key) + 1;
    }
    let line = text[..from].matches('\n').count() + 1;
    let content = text[from..].lines().next().unwrap();
    let key = content.find('"').unwrap();
    let value = content.find("\": ").unwrap() + 3;
    let column = match content[value..].starts_with(['{', '[']) {
        true => key,
        false => value,
    };
    (text, format!("{line}:{}", column + 1))
}

/// Runs `check` and `run` on a changed plate; both refuse it with the place of `pointer` and these parts of the message.
pub fn plate_refused(changes: &[(&str, Value)], pointer: &str, parts: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    plate_refused_in(folder.path(), changes, pointer, parts)
}

/// [`plate_refused`] where files of the scene lie.
pub fn plate_refused_in(
    folder: &Path,
    changes: &[(&str, Value)],
    pointer: &str,
    parts: &[&str],
) -> String {
    let (text, place) = text_and_place(&plate_with(changes), pointer);
    let message = refused_in(folder, text.as_bytes());
    let start = format!("error: scene.json:{place}: ");
    assert!(message.starts_with(&start), "not at {place}:\n{message}");
    assert_parts(&message, parts);
    message
}

/// Writes a changed plate to `scene.json`.
pub fn write_plate(folder: &Path, changes: &[(&str, Value)]) {
    let text = serde_json::to_string_pretty(&plate_with(changes)).unwrap();
    std::fs::write(folder.join("scene.json"), text).unwrap();
}

/// JSON of a Moebius band of eight patches with entities 1 to 8 about the z axis, of radius 2 and width 1.
pub fn moebius_band() -> String {
    let point = |k: usize, end: f64| {
        let angle = std::f64::consts::TAU * k as f64 / 8.0;
        let r = 2.0 + end * 0.5 * (0.5 * angle).cos();
        let z = end * 0.5 * (0.5 * angle).sin();
        json!([r * angle.cos(), r * angle.sin(), z, 1])
    };
    let patch = |k: usize| {
        json!({
            "entity": k + 1,
            "degree": [1, 1],
            "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
            "points": [point(k, -1.0), point(k + 1, -1.0), point(k, 1.0), point(k + 1, 1.0)],
        })
    };
    let patches: Vec<Value> = (0..8).map(patch).collect();
    json!({"covact_geometry": 1, "unit": "mm", "resolution": null, "patches": patches}).to_string()
}

/// What is wrong with a text, as `covact check` tells it before any file is read.
pub fn problems(text: &str) -> Vec<String> {
    let problems = match covact::scene::parse(text, "scene.json") {
        Ok(loaded) => covact::scene::check(&loaded),
        Err(covact::scene::SceneError::Wrong { problems, .. }) => problems,
        Err(other) => panic!("{other}"),
    };
    problems.iter().map(ToString::to_string).collect()
}
