//! What is wrong in the text of a scene is found, and its place.
use covact::scene::{
    Placement, Points, Problem, SceneError, Selection, SetNames, Spacing, Value, check, parse,
    pointer,
};

/// A small valid scene; tests replace parts of it.
const SCENE: &str = r#"{
  "covact": 1,
  "title": "sheet",
  "materials": {"steel": {"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}}},
  "bodies": {
    "sheet": {
      "mesh": {"plate": {"size": [10, 10], "thickness": 0.8, "elements": [4, 4]}},
      "material": "steel"
    }
  },
  "surfaces": {
    "ball": {"sphere": {"radius": 5, "center": [0, 0, 5.5]}, "motion": {"translation": [0, 0, "-t"]}}
  },
  "contacts": {"c1": {"slave": "sheet.top", "master": "ball", "points": {"gauss": 2}}},
  "supports": {"edge": {"on": "sheet.x_min", "fixed": true}}
}
"#;

fn problems(text: &str) -> Vec<Problem> {
    match parse(text, "scene.json") {
        Ok(_) => panic!("no problem found in\n{text}"),
        Err(SceneError::Wrong { problems, .. }) => problems,
        Err(other) => panic!("{other}"),
    }
}

/// The scene with `from` replaced, which must be there.
fn changed(from: &str, to: &str) -> String {
    assert!(SCENE.contains(from), "{from}");
    SCENE.replacen(from, to, 1)
}

/// The only problem of the scene with `from` replaced, as `line:column: message (help)`.
fn the_problem(from: &str, to: &str) -> String {
    let problems = problems(&changed(from, to));
    assert_eq!(problems.len(), 1, "{problems:?}");
    problems[0].to_string()
}

/// Pairs of (replaced, by, start of the only problem).
fn check_all(cases: &[(&str, &str, &str)]) {
    for (from, to, expected) in cases {
        let found = the_problem(from, to);
        assert!(
            found.starts_with(expected),
            "found    {found}\nexpected {expected}"
        );
    }
}

#[test]
fn the_scene_itself_is_valid() {
    let loaded = parse(SCENE, "scene.json").unwrap();
    assert_eq!(loaded.scene.contacts["c1"].points, Points::Gauss(2));
    assert_eq!(
        loaded.scene.surfaces["ball"].motion.translation[2],
        Value::Expression("-t".into())
    );
    // Defaults.
    assert_eq!(loaded.scene.solution.newton.max_iterations, 25);
}

#[test]
fn what_was_read_is_written_and_read_alike() {
    let scene = parse(SCENE, "a").unwrap().scene;
    let text = serde_json::to_string(&scene).unwrap();
    assert_eq!(parse(&text, "b").unwrap().scene, scene);
    assert_eq!(
        serde_json::from_str::<covact::scene::Scene>(&text).unwrap(),
        scene
    );
}

#[test]
fn misspelt_keys() {
    check_all(&[(
        "\"thickness\"",
        "\"thicknes\"",
        "7:44: unknown key `thicknes` (did you mean `thickness`? known keys: `size`, `thickness`, `elements`, \
         `layers`, `origin`, `center`, `spacing`)",
    )]);
    // Several misspelt keys are reported together, in the order of the file.
    let found = problems(&changed("\"size\"", "\"sizes\"").replace("\"elements\"", "\"element\""));
    let pointers: Vec<&str> = found.iter().map(|p| p.pointer.as_str()).collect();
    let plate = "/bodies/sheet/mesh/plate/";
    assert_eq!(
        pointers,
        [format!("{plate}sizes"), format!("{plate}element")]
    );
    let found =
        problems(&changed("\"title\"", "\"titel\"").replace("\"fixed\": true", "\"fix\": true"));
    assert_eq!(found.len(), 2, "{found:?}");
    // Inside a variant, too.
    let spacing =
        r#""elements": [4, 4], "spacing": ["uniform", {"geometric": {"ratio": 2, "ration": 3}}]"#;
    assert!(the_problem("\"elements\": [4, 4]", spacing).contains("unknown key `ration`"));
}

#[test]
fn missing_keys_and_unknown_names() {
    let names = "known names: `st_venant_kirchhoff`, `neo_hooke`, `hencky`, `j2`, `hill48`, `armstrong_frederick`, `steel`, ";
    let kirchoff = format!(
        "4:27: unknown name `st_venant_kirchoff` (did you mean `st_venant_kirchhoff`? {names}"
    );
    check_all(&[
        (
            ", \"nu\": 0.3",
            "",
            "4:50: the key `nu` is missing (known keys: `E`, `nu`, `density`)",
        ),
        (
            "\"covact\": 1,",
            "",
            "1:1: the key `covact` is missing (a scene starts with the version",
        ),
        (
            "\"st_venant_kirchhoff\"",
            "\"st_venant_kirchoff\"",
            &kirchoff,
        ),
        (
            "{\"gauss\": 2}",
            "\"node\"",
            "14:73: unknown name `node` (did you mean `nodes`?",
        ),
        (
            "{\"gauss\": 2}",
            "\"gauss\"",
            "14:73: `gauss` needs a value (write `{\"gauss\": ...}`)",
        ),
        (
            "{\"gauss\": 2}",
            "{\"nodes\": 2}",
            "14:74: `nodes` takes no value (write `\"nodes\"`)",
        ),
        (
            "{\"gauss\": 2}",
            "{}",
            "14:73: expected an object with one key, found an object (one of: `auto`, `nodes`,",
        ),
        (
            "{\"gauss\": 2}",
            "{\"gauss\": 2, \"lobatto\": 3}",
            "14:86: `lobatto` is one key too many (exactly one of: `auto`, `nodes`, `gauss`, `lobatto`, `segments`)",
        ),
    ]);
}

#[test]
fn wrong_types() {
    check_all(&[
        (
            "0.8",
            "\"0.8\"",
            "7:57: expected a number, found the text \"0.8\" (numbers are written without quotes)",
        ),
        (
            "0.8",
            "\"t\"",
            "7:57: expected a number, found the text \"t\" (expressions are possible for",
        ),
        (
            "0.8",
            "[1]",
            "7:57: expected a number, found a list of 1 value",
        ),
        (
            "[10, 10]",
            "[10]",
            "7:34: expected a list of 2 values, found a list of 1 value",
        ),
        (
            "[10, 10]",
            "10",
            "7:34: expected a list of 2 values, found the number 10",
        ),
        (
            "[4, 4]",
            "[4, 4.5]",
            "7:78: expected a whole number from 0 to 4294967295, found the number 4.5",
        ),
        (
            "[4, 4]",
            "[4, -4]",
            "7:78: expected a whole number from 0 to 4294967295, found the number -4",
        ),
        (
            "{\"gauss\": 2}",
            "{\"gauss\": 256}",
            "14:83: expected a whole number from 0 to 255, found the number 256",
        ),
        (
            "true",
            "\"yes\"",
            "15:55: expected true or false, found the text \"yes\"",
        ),
        (
            "\"steel\"\n",
            "7\n",
            "8:19: expected text between double quotes, found the number 7",
        ),
        (
            "{\"steel\": {\"st_venant_kirchhoff\": {\"E\": 210000, \"nu\": 0.3}}}",
            "[]",
            "4:16: expected an object `{\"name\": ...}`, found a list of 0 values",
        ),
        (
            "\"-t\"",
            "true",
            "12:95: expected a number, `{\"table\": [[t, value], ...]}` or an expression between double quotes, found true",
        ),
        (
            "\"-t\"",
            "{\"tabel\": []}",
            "12:96: unknown key `tabel` (did you mean `table`? known keys: `table`)",
        ),
        (
            "\"-t\"",
            "{\"table\": [[0, 1, 2]]}",
            "12:106: expected a list of 2 values, found a list of 3 values",
        ),
        ("\"-t\"", "{}", "12:95: the key `table` is missing"),
    ]);
}

#[test]
fn the_text_is_json() {
    check_all(&[
        (
            "\"title\"",
            "title",
            "3:3: expected a key, found `title` (keys are written between double quotes)",
        ),
        (
            "\"sheet\",",
            "\"sheet\"",
            "4:3: expected `,` or `}`, found `\"` (perhaps a comma is missing before it)",
        ),
        (
            "\"sheet\",",
            "\"sheet,",
            "3:12: a text that does not end in its line (the closing quote is missing)",
        ),
        (
            "0.8",
            ".8",
            "7:57: `.8` is not a number (a digit must come first, as in `0.5`)",
        ),
        ("0.8", "0x8", "7:57: `0x8` is not a number"),
        (
            "0.8",
            "08",
            "7:57: `08` is not a number (JSON has no leading zeros)",
        ),
        (
            "0.8",
            "+8",
            "7:57: `+8` is not a number (JSON has no leading `+`)",
        ),
        (
            "0.8",
            "1e",
            "7:57: `1e` is not a number (digits must follow the exponent's `e`, as in `1e-3`)",
        ),
        ("0.8", "1.", "7:57: `1.` is not a number"),
        ("0.8", "1e400", "7:57: the number `1e400` is too large"),
        (
            "0.8",
            "NaN",
            "7:57: expected a value, found `NaN` (only finite numbers are allowed)",
        ),
        (
            "true",
            "True",
            "15:55: expected a value, found `True` (JSON writes `true`)",
        ),
        (
            "\"sheet\",",
            "\"\\q\",",
            "3:13: `\\q` is no escape sequence of JSON",
        ),
        (
            "\"sheet\",",
            "\"\\ud800\",",
            "3:13: `\\ud800` is no escape sequence of JSON",
        ),
        (
            "\"title\":",
            "\"title\"",
            "3:11: expected `:` after the key `title`",
        ),
    ]);
    let found = problems(&format!("{SCENE}}}"));
    let expected =
        "17:1: there is more text after the end of the scene (perhaps a closing bracket too early)";
    assert_eq!(found[0].to_string(), expected);
    let found = problems(&SCENE[..SCENE.find("\"contacts\"").unwrap()]);
    assert_eq!(
        found[0].to_string(),
        "14:3: the file ends inside the object that starts in line 1"
    );
    assert!(problems("")[0].message.contains("empty"));
    assert!(
        problems(&"[".repeat(1_000_000))[0]
            .message
            .contains("nested more than 64 deep")
    );
    assert!(
        problems(&"{\"a\":".repeat(1_000_000))[0]
            .message
            .contains("nested more than 64 deep")
    );
}

#[test]
fn keys_given_twice() {
    check_all(&[(
        "\"thickness\": 0.8",
        "\"thickness\": 0.8, \"thickness\": 0.9",
        "7:62: the key `thickness` is given twice (the first one is in line 7)",
    )]);
}

#[test]
fn other_versions() {
    // Keys of another version are not reported.
    let found = the_problem("\"covact\": 1,", "\"covact\": 2, \"new_key\": 1,");
    assert!(
        found.starts_with("2:13: version 2 of the scene format is not known (this program ("),
        "{found}"
    );
    assert!(
        the_problem("\"covact\": 1,", "\"covact\": \"1\",")
            .starts_with("2:13: expected a whole number")
    );
}

#[test]
fn columns_count_characters_and_escapes_are_read() {
    check_all(&[(
        "\"title\": \"sheet\",",
        "\"title\": \"Blé 🦀\", \"titel\": 1,",
        "3:21: unknown key `titel`",
    )]);
    let loaded = parse(
        &changed("\"sheet\",", "\"\\u00e9\\ud83e\\udd80\\n\\\\\","),
        "a",
    )
    .unwrap();
    assert_eq!(loaded.scene.title, "é🦀\n\\");
    let loaded = parse(&format!("\u{feff}{SCENE}"), "a").unwrap();
    assert_eq!(loaded.scene.title, "sheet");
    let crlf = SCENE.replace('\n', "\r\n").replace("\"fixed\"", "\"fixt\"");
    assert!(
        problems(&crlf)[0]
            .to_string()
            .starts_with("15:46: unknown key `fixt`")
    );
}

#[test]
fn places_of_pointers() {
    let loaded = parse(SCENE, "scene.json").unwrap();
    for (at, place) in [
        ("/contacts/c1/slave", "14:32"),
        ("/bodies/sheet/mesh/plate/elements/1", "7:78"),
        ("/bodies/sheet", "6:5"),
        // Not in the file: the innermost value that is.
        ("/contacts/c1/penalty/value", "14:16"),
        ("/output", "1:1"),
        ("", "1:1"),
    ] {
        assert_eq!(loaded.place_of(at).to_string(), place, "{at}");
    }
    let odd = parse(&SCENE.replace("steel", "a/b~c"), "scene.json").unwrap();
    assert_eq!(
        odd.place_of(&pointer(&["materials", "a/b~c"])).to_string(),
        "4:17"
    );
}

#[test]
fn other_forms_are_read() {
    let spacing =
        r#""elements": [4, 4], "spacing": ["uniform", {"fine": {"length": 2, "fine": 3}}]"#;
    let loaded = parse(&changed("\"elements\": [4, 4]", spacing), "a").unwrap();
    let covact::scene::MeshSource::Plate(plate) = &loaded.scene.bodies["sheet"].mesh else {
        panic!("no plate");
    };
    let fine = Spacing::Fine {
        length: 2.0,
        fine: 3,
        from_end: false,
        from_middle: false,
    };
    assert_eq!(plate.spacing[1], fine);
    let sets = r#""material": "steel", "sets": {"mid": {"nodes_near_point": {"point": [0, 0, 0], "tolerance": 1e-6}}}"#;
    let loaded = parse(&changed("\"material\": \"steel\"", sets), "a").unwrap();
    let mid = Selection::NodesNearPoint {
        point: [0.0; 3],
        tolerance: 1e-6,
    };
    assert_eq!(loaded.scene.bodies["sheet"].sets["mid"], mid);
    let table = parse(&changed("\"-t\"", "{\"table\": [[0, 0], [1, -2.5]]}"), "a").unwrap();
    let z = table.scene.surfaces["ball"].motion.translation[2]
        .compile(&["t"])
        .unwrap();
    assert_eq!(z.eval(0.5).unwrap(), -1.25);
}

/// The scene with `from` replaced, as it is read.
fn read(from: &str, to: &str) -> covact::scene::Scene {
    let text = changed(from, to);
    parse(&text, "scene.json").unwrap().scene
}

#[test]
fn lists_of_three_stand_for_components() {
    let prescribed = |to: &str| {
        let scene = read("\"fixed\": true", &format!("\"displacement\": {to}"));
        scene.supports["edge"].displacement.clone().unwrap()
    };
    let object = prescribed(r#"{"x": 0, "z": "-t"}"#);
    assert_eq!(prescribed(r#"[0, null, "-t"]"#), object);
    assert_eq!(object.y, None);
    let free = |to: &str| {
        let motion = format!(r#""motion": {{"free": {{"force": {to}}}}}"#);
        let scene = read(r#""motion": {"translation": [0, 0, "-t"]}"#, &motion);
        scene.surfaces["ball"].motion.free.clone().unwrap().force
    };
    assert_eq!(free("[null, null, -5]"), free(r#"{"z": -5}"#));
    check_all(&[
        (
            "\"fixed\": true",
            "\"displacement\": [0, 0]",
            "15:62: expected an object, or a list of 3 values, found a list of 2 values (a list has one value each",
        ),
        (
            "\"fixed\": true",
            "\"displacement\": [0, 0, true]",
            "15:69: expected a number, `{\"table\": [[t, value], ...]}` or an expression",
        ),
        (
            "\"-t\"",
            "null",
            "12:95: expected a number, `{\"table\": [[t, value], ...]}` or an expression",
        ),
    ]);
    // What is wrong with a component is told at its place in the list.
    let text = changed("\"fixed\": true", "\"displacement\": [0, null, \"s\"]");
    let loaded = parse(&text, "scene.json").unwrap();
    let found = check(&loaded);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(
        (
            found[0].place.to_string().as_str(),
            found[0].pointer.as_str()
        ),
        ("15:73", "/supports/edge/displacement/z")
    );
}

#[test]
fn placements_are_turned_in_the_words_of_motions() {
    let placed = |placement: &str| {
        let to = format!(r#""placement": {placement}, "motion""#);
        read("\"motion\"", &to).surfaces["ball"].placement
    };
    let by_axis = placed(r#"{"axis": [1, 0, 0], "angle": 90}"#);
    assert_eq!(by_axis.angle, 90.0);
    let rotation = r#""rotation": {"axis": [1, 0, 0], "angle": 90}"#;
    assert_eq!(placed(&format!("{{{rotation}}}")), by_axis);
    let about =
        placed(r#"{"scale": 2, "rotation": {"axis": [0, 1, 0], "angle": 9, "center": [1, 2, 3]}}"#);
    let expected = Placement {
        scale: 2.0,
        axis: [0.0, 1.0, 0.0],
        angle: 9.0,
        center: [1.0, 2.0, 3.0],
        translation: [0.0; 3],
    };
    assert_eq!(about, expected);
    // What is written is read alike.
    for placement in [by_axis, about] {
        let text = serde_json::to_string(&placement).unwrap();
        assert_eq!(placed(&text), placement, "{text}");
    }
    let twice = format!(r#""placement": {{{rotation}, "angle": 3}}, "motion""#);
    check_all(&[(
        "\"motion\"",
        &twice,
        "12:75: the rotation is given twice, by `rotation` and by `axis` or `angle`: leave one of them out",
    )]);
}

#[test]
fn sides_of_contacts_are_sets_lists_or_bodies() {
    let slave = |to: &str| read("\"sheet.top\"", to).contacts["c1"].slave.clone();
    assert_eq!(slave("\"sheet.top\""), SetNames::from("sheet.top"));
    assert_eq!(slave("\"sheet\""), SetNames::from("sheet"));
    let list = slave(r#"["sheet.top", "sheet.x_max"]"#);
    assert_eq!(list, SetNames::from(["sheet.top", "sheet.x_max"]));
    assert_eq!((list.single(), list.body()), ("", "sheet"));
}
