//! `covact run --without`.
use crate::scenes::{coulomb, plate, with};
use covact::output::{Compared, compare};
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

fn covact(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_covact"));
    command
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn write(folder: &Path, name: &str, scene: &Value) {
    std::fs::write(folder.join(name), scene.to_string()).unwrap();
}

/// The plate with friction under a ball that also moves aside.
fn rubbed() -> Value {
    with(
        plate(),
        &[
            ("/contacts/press/friction", coulomb()),
            ("/contacts/press/tangential_penalty", json!({"scaled": 2})),
            (
                "/surfaces/ball/motion",
                json!({"translation": ["0.5*t", 0, "-2*t"]}),
            ),
        ],
    )
}

#[test]
fn what_is_turned_off_is_as_if_it_had_not_been_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "scene.json", &rubbed());
    let mut plain = rubbed();
    let press = plain["contacts"]["press"].as_object_mut().unwrap();
    press.remove("friction");
    press.remove("tangential_penalty");
    write(folder, "plain.json", &plain);
    let run = ["run", "scene.json", "-o", "out", "--without", "friction"];
    let output = covact(folder, &run);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let plain = covact(folder, &["run", "plain.json", "-o", "plain", "--quiet"]);
    assert_eq!(plain.status.code(), Some(0));
    let read = |path: &str| std::fs::read_to_string(folder.join(path)).unwrap();
    let (off, plain) = (
        read("out/without_friction/history.csv"),
        read("plain/history.csv"),
    );
    assert_eq!(off, plain);
    assert_ne!(off, read("out/history.csv"));
    let table = text(&output.stdout);
    for part in [
        "without friction: points slide freely",
        "force.ball.x",
        "force.ball.z",
        "energy.dissipated",
        "penetration.max",
        "wall seconds",
        "factorizations",
        "lu ",
        "llt ",
        "peak memory (MB)",
    ] {
        assert!(table.contains(part), "no `{part}` in\n{table}");
    }
    let told = text(&output.stderr);
    assert!(
        told.contains("without friction: into out/without_friction"),
        "{told}"
    );
    assert_eq!(told.matches("done: 2 steps").count(), 2, "{told}");
    // Continued runs have reached their ends; the comparison is told again.
    let again = covact(folder, &[&run[..], &["--resume", "--json"]].concat());
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
    let last = text(&again.stdout).lines().last().unwrap().to_owned();
    let json: Value = serde_json::from_str(&last).unwrap();
    assert_eq!(json["event"], "comparison");
    assert_eq!(
        (&json["without"], &json["exit_codes"]),
        (&json!("friction"), &json!([0, 0]))
    );
    let columns = json["columns"].as_array().unwrap();
    let dissipated = columns.iter().find(|c| c["name"] == "energy.dissipated");
    let end = &dissipated.unwrap()["end"];
    assert!(end[0].as_f64().unwrap() > 0.0 && end[1].is_null(), "{end}");
    assert!(json["cost"][1]["factorizations"]["llt"].as_u64() > Some(0));
}

#[test]
fn several_what_ifs_and_the_exit_code_of_the_full_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // The ball goes away and never touches.
    let away = with(
        rubbed(),
        &[(
            "/surfaces/ball/motion",
            json!({"translation": [0, 0, "0.5 + t"]}),
        )],
    );
    write(folder, "scene.json", &away);
    // Names of the plan are names, and what is given twice runs once.
    let run = "run scene.json -o out --quiet --without contact.friction.coulomb --without friction \
               --without contact";
    let output = covact(folder, &run.split(' ').collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(4), "{}", text(&output.stderr));
    let told = text(&output.stderr);
    assert!(
        told.contains("without friction: exit code 4 (the full run: 4)"),
        "{told}"
    );
    assert_eq!(told.matches("without friction: exit code").count(), 1);
    assert!(!told.contains("without contact: exit code"), "{told}");
    let table = text(&output.stdout);
    assert!(
        table.contains("without contact: nothing touches"),
        "{table}"
    );
    assert!(folder.join("out/without_contact/summary.json").is_file());
}

#[test]
fn what_is_not_there_cannot_be_turned_off() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "scene.json", &rubbed());
    for (name, parts) in [
        (
            "frction",
            &["no effect `frction`", "did you mean `friction`?"][..],
        ),
        (
            "augmentation",
            &["the scene has no effect `augmentation`", "`friction`"],
        ),
        (
            "curvature",
            &["cannot be turned off", "does not go with friction"],
        ),
    ] {
        let output = covact(
            folder,
            &["run", "scene.json", "-o", "out", "--without", name],
        );
        assert_eq!(output.status.code(), Some(2));
        let told = text(&output.stderr);
        for part in parts {
            assert!(told.contains(part), "no `{part}` in {told}");
        }
        assert!(!folder.join("out").exists());
    }
    // Augmentation does not go with small displacements: the scene says so.
    let augmented = with(rubbed(), &[("/contacts/press/augmentation", json!({}))]);
    write(folder, "scene.json", &augmented);
    let run = [
        "run",
        "scene.json",
        "-o",
        "out",
        "--without",
        "large_rotation",
    ];
    let output = covact(folder, &run);
    assert_eq!(output.status.code(), Some(3));
    let told = text(&output.stderr);
    assert!(told.contains("does not go with augmentation"), "{told}");
    assert!(told.contains("without large_rotation: "), "{told}");
}

/// A contact with friction keeps its tangent: the comparison says so.
#[test]
fn what_is_left_as_it_is_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut scene = plate();
    let other = with(plate(), &[("/contacts/press/friction", coulomb())]);
    scene["contacts"]["rub"] = other["contacts"]["press"].clone();
    scene["contacts"]["rub"]["slave"] = json!("plate.bottom");
    scene["contacts"]["rub"]["master"] = json!("under");
    scene["surfaces"]["under"] = json!({"sphere": {"radius": 25, "center": [0, 0, -26.5]}});
    write(folder, "scene.json", &scene);
    let run = "run scene.json -o out --quiet --without curvature";
    let output = covact(folder, &run.split(' ').collect::<Vec<_>>());
    let table = text(&output.stdout);
    assert!(
        table.contains("left as it is: contact `rub`, contact.tangent.curvature: "),
        "{table}{}",
        text(&output.stderr)
    );
    assert!(!table.contains("left as it is: contact `press`"), "{table}");
}

#[test]
fn differences_are_relative_to_what_is_not_rounding() {
    let column = |end: [f64; 2], least: f64| Compared {
        name: "force.ball.z".to_owned(),
        end: end.map(Some),
        peak: end.map(Some),
        least,
    };
    let change = column([-171.6, -124.9], 1e-7).change().unwrap();
    assert!((change - (124.9 / 171.6 - 1.0)).abs() < 1e-12, "{change}");
    let change = column([2.0, -1.0], 1e-7).peak_change().unwrap();
    assert!((change + 1.5).abs() < 1e-12, "{change}");
    assert_eq!(column([1e-8, 124.9], 1e-7).change(), None);
    assert_eq!(column([0.0, 0.0], 0.0).change(), None);
    // As files tell it: what is next to nothing beside the largest of its kind.
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "scene.json", &plate());
    let output = covact(folder, &["run", "scene.json", "-o", "out", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let table = "step,time,energy.internal,energy.contact\n1,1,4,1e-10\n";
    std::fs::write(folder.join("out/history.csv"), table).unwrap();
    let out = folder.join("out");
    let found = compare([&out, &out], &[]).unwrap();
    let of = |name: &str| found.columns.iter().find(|c| c.name == name).unwrap();
    assert_eq!(of("energy.internal").change(), Some(0.0));
    assert_eq!(of("energy.contact").change(), None);
}
