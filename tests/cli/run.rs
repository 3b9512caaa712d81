//! `covact run`: results, what is printed, and how runs end.
use crate::support::*;
use covact::output::{documented, read_csv};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

fn summary(folder: &Path) -> Value {
    let text = std::fs::read_to_string(folder.join("out/summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

const RUN: [&str; 4] = ["run", "scene.json", "-o", "out"];

fn run_with(folder: &Path, more: &[&str]) -> std::process::Output {
    covact(folder, &[&RUN, more].concat())
}

#[test]
fn results_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    let output = run_with(folder.path(), &["--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(
        (stdout(&output), stderr(&output)),
        (String::new(), String::new())
    );
    let out = folder.path().join("out");
    let pvd = std::fs::read_to_string(out.join("results.pvd")).unwrap();
    for step in ["0000", "0001", "0002"] {
        for part in ["plate", "ball"] {
            let file = format!("{part}_{step}.vtu");
            assert!(pvd.contains(&file), "no {file} in\n{pvd}");
            let text = std::fs::read(out.join(&file)).unwrap();
            assert!(
                text.ends_with(b"</VTKFile>") || text.ends_with(b"</VTKFile>\n"),
                "{file}"
            );
        }
    }
    let history = read_csv(&out.join("history.csv")).unwrap();
    assert_eq!(history.column("time").unwrap(), [0.5, 1.0]);
    for column in &history.columns {
        assert!(documented(column), "{column}");
    }
    for column in [
        "step",
        "iterations",
        "force.ball.z",
        "moment.clamp_x.y",
        "energy.internal",
        "penetration.max",
        "points.active",
    ] {
        assert!(history.column(column).is_some(), "{column}");
    }
    // The ball is held by the plate's supports.
    let sum: f64 = ["ball", "clamp_x", "clamp_y", "symmetry_x", "symmetry_y"]
        .map(|n| history.column(&format!("force.{n}.z")).unwrap()[1])
        .iter()
        .sum();
    let force = history.column("force.ball.z").unwrap()[1];
    assert!(
        force < -1.0 && sum.abs() < 1e-6 * force.abs(),
        "{force} {sum}"
    );
    let summary = summary(folder.path());
    assert_eq!(
        (&summary["status"], &summary["steps"]),
        (&json!("done"), &json!(2))
    );
    assert_eq!(
        (&summary["dofs"], &summary["contact_points"]),
        (&json!(80), &json!(25))
    );
    for field in ["wall_s", "cpu_s", "peak_memory_mb", "newton_iterations"] {
        assert!(summary[field].is_number(), "{field}: {summary}");
    }
    assert!(summary["wall_s"].as_f64().unwrap() > 0.0);
    assert!(summary["peak_memory_mb"].as_f64().unwrap() > 1.0);
    let phases = summary["phases"].as_object().unwrap();
    for phase in ["model", "assembly", "factorization", "output"] {
        assert!(phases[phase].as_f64().unwrap() > 0.0, "{phase}");
    }
    let factorizations = &summary["factorizations"];
    assert_eq!(factorizations["llt"], summary["newton_iterations"]);
    assert_eq!(factorizations.as_object().unwrap().len(), 1);
    let effects = summary["effects"].as_array().unwrap();
    assert!(effects.contains(&json!("contact.normal.penalty")));
    assert!(summary["versions"]["covact"].is_string());
    // Nothing is left over of writing.
    for entry in std::fs::read_dir(&out).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(!name.contains(".tmp"), "{name}");
    }
}

#[test]
fn lines_without_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[("/output", json!({ "every": 0 }))]);
    for set in [false, true] {
        let mut command = command(folder.path(), &[&RUN[..], &["--force"]].concat());
        if set {
            command.env("NO_COLOR", "1");
        }
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        assert_eq!(stdout(&output), "");
        let text = stderr(&output);
        assert!(!text.contains(['\x1b', '\r']), "{text:?}");
        assert_parts(
            &text,
            &[
                "80 dofs, 25 contact points\n",
                "effects: contact.master.rigid",
                "note: contact `press`: penalty 14.9813",
                " step       time         dt  iter   active  penetration\n",
                "    1        0.5        0.5",
                "    2          1        0.5",
                "done: 2 steps,",
                "results in out\n",
            ],
        );
    }
}

#[test]
fn events_as_json() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[("/output", json!({ "every": 0 }))]);
    let output = run_with(folder.path(), &["--json"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(stderr(&output), "");
    let events: Vec<Value> = (stdout(&output).lines())
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let count = |name: &str| events.iter().filter(|e| e["event"] == name).count();
    assert_eq!(events[0]["event"], "model");
    assert_eq!((count("step_started"), count("step_accepted")), (2, 2));
    assert!(count("iteration") >= 4);
    let last = events.last().unwrap();
    assert_eq!(
        (&last["event"], &last["status"]),
        (&json!("finished"), &json!("done"))
    );
}

#[test]
fn a_tool_that_never_touches() {
    let folder = tempfile::tempdir().unwrap();
    let still = json!([0, 0, "t"]);
    write_plate(
        folder.path(),
        &[("/surfaces/ball/motion/translation", still)],
    );
    assert_eq!(
        covact(folder.path(), &["check", "scene.json"])
            .status
            .code(),
        Some(0)
    );
    let output = run_with(folder.path(), &["--quiet"]);
    assert_eq!(output.status.code(), Some(4));
    assert_parts(
        &stderr(&output),
        &[
            "error: no contact: the surfaces of contact `press` never touched: check the motion",
            "2 steps up to time 1 are in out",
        ],
    );
    let summary = summary(folder.path());
    assert_eq!(summary["status"], "no_contact");
    assert_parts(
        summary["reason"].as_str().unwrap(),
        &["`press` never touched"],
    );
}

#[test]
fn a_run_that_does_not_converge() {
    let folder = tempfile::tempdir().unwrap();
    let smash = json!({ "smash": { "on": "plate.top", "force": [0, 0, "if(t > 0.6, -1e9, -1)"] } });
    let smash = match covact::scene::Value::Expression("if(t > 0.6, -1e9, -1)".into())
        .compile(&covact::scene::TIME)
    {
        Ok(_) => smash,
        // Without conditions in expressions: a table.
        Err(_) => json!({ "smash": {
            "on": "plate.top", "force": [0, 0, { "table": [[0, 0], [0.5, -1], [0.6, -1e9], [1, -1e9]] }]
        } }),
    };
    write_plate(
        folder.path(),
        &[
            ("/loads", smash),
            (
                "/solution",
                json!({ "step": { "initial": 0.5, "max": 0.5, "min": 0.05 } }),
            ),
        ],
    );
    let output = run_with(folder.path(), &["--quiet"]);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    assert_parts(
        &stderr(&output),
        &[
            "error: not converged: step 2 from time 0.5 failed",
            "1 steps up to time 0.5 are in out",
        ],
    );
    let summary = summary(folder.path());
    assert_eq!(
        (&summary["status"], &summary["steps"]),
        (&json!("not_converged"), &json!(1))
    );
    let history = read_csv(&folder.path().join("out/history.csv")).unwrap();
    assert_eq!(history.column("time").unwrap(), [0.5]);
}

#[cfg(unix)]
#[test]
fn an_interrupted_run() {
    let folder = tempfile::tempdir().unwrap();
    // Far more steps than can be done before the signal arrives.
    write_plate(
        folder.path(),
        &[
            ("/output", json!({ "every": 1 })),
            (
                "/solution",
                json!({ "step": { "initial": 1e-4, "max": 1e-4 } }),
            ),
        ],
    );
    let mut child = command(folder.path(), &[&RUN[..], &["--json"]].concat())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let accepted = lines.any(|line| line.unwrap().contains("\"step_accepted\""));
    assert!(accepted);
    let pid = child.id().to_string();
    let killed = std::process::Command::new("kill")
        .args(["-INT", &pid])
        .status()
        .unwrap();
    assert!(killed.success());
    let last = lines.last().unwrap().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    assert_parts(
        &stderr(&output),
        &[
            "stopping after this step",
            "error: interrupted: stopped by the user;",
            "are in out",
        ],
    );
    assert_parts(&last, &["\"finished\"", "\"interrupted\""]);
    let summary = summary(folder.path());
    assert_eq!(summary["status"], "interrupted");
    let steps = summary["steps"].as_u64().unwrap() as usize;
    assert!((1..10_000).contains(&steps), "{steps}");
    let history = read_csv(&folder.path().join("out/history.csv")).unwrap();
    assert_eq!(history.column("step").unwrap().len(), steps);
    assert!(folder.path().join("out/plate_0001.vtu").exists());
}

/// Under `nohup` a run outlives its terminal, and stops after its step when it is asked to.
#[cfg(unix)]
#[test]
fn a_run_without_hangups() {
    let folder = tempfile::tempdir().unwrap();
    let steps = json!({ "step": { "initial": 1e-4, "max": 1e-4 } });
    write_plate(
        folder.path(),
        &[("/output", json!({ "every": 0 })), ("/solution", steps)],
    );
    let program = env!("CARGO_BIN_EXE_covact");
    let script = format!("trap '' HUP; exec {program} run scene.json -o out --json");
    let mut child = std::process::Command::new("sh")
        .current_dir(folder.path())
        .args(["-c", &script])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut goes_on = || {
        let accepted = |line: std::io::Result<String>| line.unwrap().contains("\"step_accepted\"");
        (0..3).all(|_| lines.any(accepted))
    };
    assert!(goes_on());
    let pid = child.id().to_string();
    let signal = |name: &str| {
        let killed = std::process::Command::new("kill")
            .args([name, &pid])
            .status();
        assert!(killed.unwrap().success());
    };
    signal("-HUP");
    assert!(goes_on());
    signal("-TERM");
    let last = lines.last().unwrap().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    assert_parts(
        &stderr(&output),
        &[
            "stopping after this step",
            "error: interrupted: stopped by the user;",
        ],
    );
    assert_parts(&last, &["\"finished\"", "\"interrupted\""]);
}

/// A plate that a ball dents in a single step: the first starts of the step fail, and the step ends all the same.
fn troubled() -> [(&'static str, Value); 5] {
    [
        ("/contacts/press/points", json!("nodes")),
        (
            "/bodies/plate/mesh/plate",
            json!({"size": [40, 40], "thickness": 0.5, "elements": [8, 8], "origin": [0, 0, 0.75]}),
        ),
        ("/surfaces/ball/motion/translation", json!([0, 0, "-4.7*t"])),
        ("/contacts/press/penalty", json!({"scaled": 100})),
        ("/solution", json!({"step": {"initial": 1, "max": 1}})),
    ]
}

/// Iterations of failed starts are counted in the table and in the summary, and nothing frightens while all is well.
#[test]
fn failed_starts_are_counted_and_told_calmly() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &troubled());
    let output = run_with(folder.path(), &[]);
    let told = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{told}");
    let history = read_csv(&folder.path().join("out/history.csv")).unwrap();
    let sum = |name: &str| history.column(name).unwrap().iter().sum::<f64>();
    let summary = summary(folder.path());
    let number = |name: &str| summary[name].as_f64().unwrap();
    let (good, failed) = (sum("iterations"), sum("iterations.failed"));
    assert!(failed > 0.0, "{told}");
    assert_eq!(number("newton_iterations"), good + failed);
    assert_eq!(number("failed_iterations"), failed);
    let parts = format!(
        "{} iterations ({failed} in attempts that failed)",
        good + failed
    );
    assert!(told.contains(&parts), "{told}");
    // No step was cut, so that there is nothing to worry about.
    assert_eq!(number("cuts"), 0.0, "{told}");
    for word in ["inside out", "again from", "no convergence"] {
        assert!(!told.contains(word), "{told}");
    }
    assert!(told.contains(&format!("(+{failed} that failed)")), "{told}");
}
