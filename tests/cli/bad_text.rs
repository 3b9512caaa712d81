//! What users see when the input is wrong: message, place, exit code.
use crate::support::{assert_parts, covact, refused_in, stderr, stdout};

/// A plate under a ball.
fn starter() -> String {
    SCENE.to_owned()
}

const SCENE: &str = r#"{
  "covact": 1,
  "title": "A ball presses on a quarter of a clamped plate. Units: N, mm, MPa. `covact schema` describes every key.",
  "units": { "length": "mm" },
  "materials": {
    "steel": { "st_venant_kirchhoff": { "E": 210000, "nu": 0.3 } }
  },
  "bodies": {
    "plate": {
      "mesh": { "plate": { "size": [50, 50], "thickness": 1, "elements": [12, 12] } },
      "material": "steel"
    }
  },
  "surfaces": {
    "ball": {
      "sphere": { "radius": 25, "center": [0, 0, 25.5] },
      "motion": { "translation": [0, 0, "-2*t"] }
    }
  },
  "contacts": {
    "press": { "slave": "plate.top", "master": "ball" }
  },
  "supports": {
    "clamped_x": { "on": "plate.x_max", "fixed": true },
    "clamped_y": { "on": "plate.y_max", "fixed": true },
    "symmetry_x": { "on": "plate.x_min", "symmetry": "x" },
    "symmetry_y": { "on": "plate.y_min", "symmetry": "y" }
  },
  "solution": { "end_time": 1, "step": { "initial": 0.1, "max": 0.1 } }
}
"#;

/// `covact check` and `covact run` of a scene of this text both fail with exit code 3 and the same message.
fn refused(text: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    refused_in(folder.path(), text)
}

/// As [`refused`], for the starter with `from` replaced.
fn refused_with(from: &str, to: &str) -> String {
    let text = starter();
    assert!(text.contains(from), "{from}");
    refused(text.replacen(from, to, 1).as_bytes())
}

#[test]
fn misspelt_key() {
    let message = refused_with("\"thickness\"", "\"thicknes\"");
    assert_parts(
        &message,
        &[
            "error: scene.json:10:46: unknown key `thicknes`\n",
            // The line, with a mark under the key.
            "10 │       \"mesh\": { \"plate\": { \"size\": [50, 50], \"thicknes\": 1,",
            "·                                              ──────────\n",
            "help: did you mean `thickness`? known keys: `size`, `thickness`, `elements`, `layers`, `origin`, `center`, `spacing`\n",
        ],
    );
    assert!(!message.contains('\x1b'), "colours without a terminal");
}

#[test]
fn wrong_type() {
    let message = refused_with("\"nu\": 0.3", "\"nu\": \"0.3\"");
    let parts = [
        "scene.json:6:60: expected a number, found the text \"0.3\"",
        "help: numbers are written without",
    ];
    assert_parts(&message, &parts);
}

#[test]
fn unknown_names() {
    assert_parts(
        &refused_with("\"material\": \"steel\"", "\"material\": \"stele\""),
        &[
            "scene.json:11:19: there is no material `stele`",
            "help: did you mean `steel`? materials: `steel`",
        ],
    );
    assert_parts(
        &refused_with("plate.top", "plat.top"),
        &[
            "scene.json:21:25: there is no body `plat`",
            "help: did you mean `plate.top`? bodies: `plate`",
        ],
    );
    assert_parts(
        &refused_with("plate.x_max", "plate.xmax"),
        &[
            "scene.json:24:26: the body `plate` has no set `xmax`",
            "help: did you mean `x_max`?",
        ],
    );
    assert_parts(
        &refused_with("\"master\": \"ball\"", "\"master\": \"boll\""),
        &[
            "scene.json:21:48: there is no surface `boll`",
            "help: did you mean `ball`? surfaces: `ball`",
        ],
    );
}

#[test]
fn missing_files() {
    let sphere = "\"sphere\": { \"radius\": 25, \"center\": [0, 0, 25.5] }";
    assert_parts(
        &refused_with(sphere, "\"cad\": { \"file\": \"tools/punch.igs\" }"),
        &[
            "scene.json:16:24: there is no file `./tools/punch.igs`",
            "help: paths are relative to the scene file",
        ],
    );
    assert_parts(
        &refused_with(sphere, "\"cad\": { \"file\": \"scne.json\" }"),
        &[
            "scene.json:16:24: there is no file `./scne.json`",
            "help: did you mean `scene.json`?",
        ],
    );
}

#[test]
fn wrong_version() {
    assert_parts(
        &refused_with("\"covact\": 1", "\"covact\": 3"),
        &[
            "scene.json:2:13: version 3 of the scene format is not known",
            "reads version 1",
        ],
    );
}

#[test]
fn key_given_twice() {
    assert_parts(
        &refused_with("\"thickness\": 1", "\"thickness\": 1, \"thickness\": 2"),
        &[
            "scene.json:10:62: the key `thickness` is given twice",
            "help: the first one is in line 10",
        ],
    );
}

#[test]
fn bad_expression() {
    assert_parts(
        &refused_with("\"-2*t\"", "\"-2*sine(t)\""),
        &[
            "scene.json:17:45: unknown function `sine`",
            "help: did you mean `sin`?",
        ],
    );
    assert_parts(
        &refused_with("\"-2*t\"", "\"-2*(t\""),
        &["scene.json:17:45: this `(` is not closed"],
    );
}

#[test]
fn several_problems_at_once() {
    let text = starter()
        .replace("210000", "-1")
        .replace("plate.top", "plate.tp")
        .replace("-2*t", "-2*x");
    let message = refused(text.as_bytes());
    assert_parts(
        &message,
        &[
            "scene.json:6:46: Young's",
            "scene.json:17:45: unknown variable `x`",
            "21:25: the body",
            "3 problems in scene.json",
        ],
    );
}

#[test]
fn not_json_and_not_text() {
    assert_parts(
        &refused(b"{\n  # remark\n}"),
        &["scene.json:2:3: a comment does not start with `#`"],
    );
    assert_parts(&refused(b""), &["scene.json:1:1: the file is empty"]);
    assert_parts(
        &refused(b"{\"covact\": 1,\n\"title\": \"\xe9\"}"),
        &["scene.json:2:11: the file is not UTF-8 text: byte 0xE9"],
    );
    assert_parts(
        &refused(b"\xff\xfe{\0}\0"),
        &[
            "scene.json:1:1: the file is not UTF-8",
            "it looks like UTF-16",
        ],
    );
    assert_parts(
        &refused("[".repeat(100_000).as_bytes()),
        &["nested more than 64 deep"],
    );
}

#[test]
fn scenes_that_cannot_be_opened() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("press.json"), "").unwrap();
    let output = covact(folder.path(), &["check", "pres.json"]);
    assert_eq!(output.status.code(), Some(3));
    assert_eq!(
        stderr(&output),
        "error: there is no scene file `pres.json`; did you mean `press.json`?\n"
    );
    let output = covact(folder.path(), &["check", "."]);
    assert_eq!(output.status.code(), Some(5));
    assert_parts(
        &stderr(&output),
        &["error: cannot read the scene `.`: it is a folder"],
    );
}

#[test]
fn failures_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let text = starter().replace("\"nu\": 0.3", "\"nu\": 0.7");
    std::fs::write(folder.path().join("scene.json"), text).unwrap();
    for arguments in [
        &["check", "scene.json", "--json"][..],
        &["run", "scene.json", "-o", "out", "--json"],
    ] {
        let output = covact(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(3));
        let failure: serde_json::Value = serde_json::from_str(stdout(&output).trim()).unwrap();
        assert_eq!(failure["event"], "error");
        assert_eq!(failure["exit_code"], 3);
        let problem = &failure["problems"][0];
        assert_eq!(
            problem["pointer"],
            "/materials/steel/st_venant_kirchhoff/nu"
        );
        assert_eq!(
            (&problem["line"], &problem["column"]),
            (&6.into(), &60.into())
        );
        assert_eq!(problem["message"], "Poisson's ratio `nu` is 0.7");
    }
}

#[test]
fn wrong_usage() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &[][..],
        &["runn"],
        &["run", "scene.json"],
        &["run", "scene.json", "-o", "out", "--threads", "many"],
        &["run", "scene.json", "-o", "out", "--json", "--quiet"],
        &["check"],
        &["check", "a", "b"],
    ] {
        let output = covact(folder.path(), arguments);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{arguments:?}: {}",
            stderr(&output)
        );
        assert!(
            !output.stderr.is_empty() && output.stdout.is_empty(),
            "{arguments:?}"
        );
    }
    let output = covact(folder.path(), &["--help"]);
    assert_eq!(output.status.code(), Some(0));
    assert_parts(
        &stdout(&output),
        &[
            "run",
            "check",
            "inspect",
            "schema",
            "new",
            "Exit codes: 0 done, 1 a bug",
        ],
    );
    assert_eq!(covact(folder.path(), &["--version"]).status.code(), Some(0));
}

#[test]
fn nothing_is_overwritten_by_new() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.json"), "mine").unwrap();
    let output = covact(folder.path(), &["new", "a"]);
    assert_eq!(output.status.code(), Some(5));
    assert_parts(&stderr(&output), &["a.json exists already"]);
    assert_eq!(
        std::fs::read_to_string(folder.path().join("a.json")).unwrap(),
        "mine"
    );
    assert_eq!(
        covact(folder.path(), &["new", "no/such/folder"])
            .status
            .code(),
        Some(5)
    );
}

/// Of a value of many lines the first ones are shown, and those around.
#[test]
fn a_long_value_is_shown_in_part() {
    let rows: Vec<String> = (0..30).map(|k| format!("      [{k}, {k}, 0]")).collect();
    let list = format!("\"translation\": [\n{}\n    ] }}", rows.join(",\n"));
    let text = refused_with("\"translation\": [0, 0, \"-2*t\"] }", &list);
    assert_parts(&text, &["expected a list of 3 values", "[4, 4, 0]"]);
    assert!(!text.contains("[7, 7, 0]"), "{text}");
    let shown = text.lines().filter(|line| line.contains(" │ ")).count();
    assert!((6..=9).contains(&shown), "{shown} lines of\n{text}");
}

/// A scene in one line, as programs write them: what is around the mistake is shown, within the width of a terminal.
#[test]
fn a_long_line_is_shown_in_part() {
    let scene: serde_json::Value = serde_json::from_str(&starter()).expect("JSON");
    let line = scene.to_string();
    assert!(line.len() > 400);
    let text = refused(line.replacen("\"thickness\"", "\"thicknes\"", 1).as_bytes());
    assert_parts(&text, &["unknown key `thicknes`", "...", "\"thicknes\":"]);
    let lines: Vec<&str> = text.lines().collect();
    let shown = lines
        .iter()
        .position(|l| l.starts_with(" 1 │ "))
        .expect(&text);
    let under = |line: &str, what: char| line.chars().position(|c| c == what);
    let mark = under(lines[shown + 1], '─');
    let key = lines[shown]
        .find("\"thicknes\"")
        .map(|at| lines[shown][..at].chars().count());
    assert_eq!(mark, key, "{text}");
    let wide = |l: &&str| l.contains(" │ ") && l.chars().count() > 100;
    assert!(!lines.iter().any(wide), "{text}");
}
