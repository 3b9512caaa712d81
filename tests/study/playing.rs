//! Runs in processes: rounds of repeats, and studies that go on.
use crate::support::*;
use covact::study::record::Ending;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

/// Two shells, two repeats, one run at a time.
fn two_by_two(folder: &Path) {
    let shells = json!({ "shell": { "values": [{ "h8": [2, 2] }, { "h8": [4, 4] }] } });
    let mut study = study(json!([{ "choices": [shells] }]));
    study["timing"] = json!({ "repeats": 2, "one_at_a_time": true });
    write(folder, "scene.json", &scene());
    write(folder, "study.json", &study);
}

const STUDY: [&str; 5] = ["study", "study.json", "-o", "out", "--json"];
const RUNS: [&str; 2] = ["001_H8_2_x_2", "002_H8_4_x_4"];

fn told(events: &[Value]) -> Vec<(&str, u64, bool)> {
    let one = |e: &'_ Value| {
        let text = e["id"].as_str().unwrap();
        let id = RUNS.into_iter().find(|r| *r == text).unwrap();
        (
            id,
            e["repeat"].as_u64().unwrap(),
            e["before"].as_bool().unwrap(),
        )
    };
    events.iter().map(one).collect()
}

#[test]
fn repeats_are_done_round_after_round() {
    let folder = tempfile::tempdir().unwrap();
    two_by_two(folder.path());
    let output = covact(folder.path(), &STUDY);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let events = events(&output);
    let order = [
        (RUNS[0], 1, false),
        (RUNS[1], 1, false),
        (RUNS[0], 2, false),
        (RUNS[1], 2, false),
    ];
    assert_eq!(told(&events), order);
    assert!(
        events
            .iter()
            .all(|e| e["ending"] == "done" && e["steps"] == 2),
        "{events:?}"
    );

    let out = folder.path().join("out");
    let record = record(&out);
    assert_eq!(record.choices, ["shell"]);
    assert_eq!(record.scene, "scene.json");
    assert!(record.machine.cores >= 1 && !record.machine.system.is_empty());
    assert_eq!(record.warnings, [""; 0]);
    for (run, id) in record.runs.iter().zip(RUNS) {
        assert_eq!((run.id.as_str(), &run.ending), (id, &Ending::Done));
        let wall = run.wall.unwrap();
        assert_eq!(wall.repeats, 2);
        assert!(wall.least > 0.0 && wall.least <= wall.median && wall.median <= wall.most);
        // The process takes longer than what the run itself tells.
        let summary = std::fs::read(out.join(format!("runs/{id}/1/summary.json"))).unwrap();
        let summary: Value = serde_json::from_slice(&summary).unwrap();
        assert!(wall.most > summary["wall_s"].as_f64().unwrap());
        assert_eq!(
            run.newton_iterations,
            summary["newton_iterations"].as_u64().unwrap()
        );
        assert_eq!(
            run.steps_taken.iter().map(|s| s.0).collect::<Vec<_>>(),
            [0.5, 1.0]
        );
        let force = run.measured[0].value.unwrap();
        assert!(force < -1.0, "{force}");
    }
    assert!(record.runs[0].dofs < record.runs[1].dofs);
    for file in ["report.html", "study.csv"] {
        assert!(out.join(file).is_file(), "{file}");
    }
    // No fields are asked for, so that none are written.
    let fields = std::fs::read_dir(out.join("runs/001_H8_2_x_2/1")).unwrap();
    assert!(
        fields
            .flatten()
            .all(|f| f.path().extension().is_none_or(|e| e != "vtu"))
    );
}

/// What is done is not done again; what is half done, or of another scene, is.
#[test]
fn a_study_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    two_by_two(folder.path());
    covact(folder.path(), &STUDY);
    let out = folder.path().join("out");
    let first = record(&out);
    let half = out.join("runs").join(RUNS[1]).join("1");
    std::fs::remove_file(half.join("summary.json")).unwrap();
    std::fs::remove_file(half.join("process.json")).unwrap();
    std::fs::write(half.join("history.csv"), "step,ti").unwrap();
    std::fs::remove_dir_all(out.join("runs").join(RUNS[0]).join("2")).unwrap();

    let output = covact(folder.path(), &STUDY);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let done = [
        (RUNS[0], 1, true),
        (RUNS[1], 2, true),
        (RUNS[1], 1, false),
        (RUNS[0], 2, false),
    ];
    assert_eq!(told(&events(&output)), done);
    let second = record(&out);
    for (a, b) in first.runs.iter().zip(&second.runs) {
        assert_eq!(
            (&a.steps_taken, &a.measured, a.dofs),
            (&b.steps_taken, &b.measured, b.dofs)
        );
    }

    // Another stiffness: every scene is another.
    let mut scene = scene();
    scene["materials"]["steel"]["st_venant_kirchhoff"]["E"] = json!(6000);
    write(folder.path(), "scene.json", &scene);
    let output = covact(folder.path(), &STUDY);
    assert!(told(&events(&output)).iter().all(|(_, _, before)| !before));
    let third = record(&out);
    let force = |r: &covact::study::record::Record| r.runs[1].measured[0].value.unwrap();
    let ratio = force(&third) / force(&second);
    assert!((0.4..0.7).contains(&ratio), "{ratio}");
}

/// A run that is repeated by itself, with more slave points here, is one of the study, and is not done again.
#[test]
fn a_run_that_is_repeated_by_itself() {
    let folder = tempfile::tempdir().unwrap();
    let mut small = scene();
    small["surfaces"]["ball"]["sphere"] = json!({ "radius": 12, "center": [15, 15, 13] });
    write(folder.path(), "scene.json", &small);
    let shells = json!({ "shell": { "values": [{ "h8": [4, 4] }] } });
    write(
        folder.path(),
        "study.json",
        &study(json!([{ "choices": [shells] }])),
    );
    let output = covact(folder.path(), &STUDY);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let out = folder.path().join("out");
    let summary = std::fs::read(
        out.join("runs")
            .join(RUNS[1].replace("002", "001"))
            .join("1/summary.json"),
    );
    let summary: Value = serde_json::from_slice(&summary.unwrap()).unwrap();
    assert_eq!(summary["given_up"]["runs"], 1, "{summary}");
    let run = &record(&out).runs[0];
    assert_eq!((&run.ending, run.dofs), (&Ending::Done, 80));
    let output = covact(folder.path(), &STUDY);
    assert_eq!(events(&output)[0]["before"], true);
}

/// Fields are written where one is measured, at the end only, and times of other numbers of threads are not mixed in.
#[test]
fn fields_and_threads() {
    let folder = tempfile::tempdir().unwrap();
    two_by_two(folder.path());
    let path = folder.path().join("study.json");
    let mut study: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    study["references"] = json!({ "fine": { "order": 2, "runs": [
        { "/bodies/plate/mesh/plate/elements": [4, 4] },
        { "/bodies/plate/mesh/plate/elements": [8, 8] },
    ] } });
    study["quantities"] = json!([{
        "name": "displacement",
        "of": { "field": { "body": "plate", "name": "displacement" } },
        "reference": { "finest": "fine" }
    }]);
    study["timing"] = json!({ "repeats": 1 });
    write(folder.path(), "study.json", &study);
    let output = covact(folder.path(), &STUDY);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let out = folder.path().join("out");
    let record = record(&out);
    assert_eq!(record.runs.len(), 3);
    let error = |i: usize| record.runs[i].measured[0].error.unwrap();
    // The coarser plate is farther from the truth.
    assert!(
        error(0) > 1.5 * error(1) && error(1) > 1e-4,
        "{} {}",
        error(0),
        error(1)
    );
    let files = std::fs::read_dir(out.join("runs").join(RUNS[0]).join("1")).unwrap();
    let mut fields: Vec<String> = files
        .map(|f| f.unwrap().file_name().into_string().unwrap())
        .collect();
    fields.retain(|name| name.starts_with("plate_") && name.ends_with(".vtu"));
    fields.sort();
    assert_eq!(fields.last().map(String::as_str), Some("plate_0002.vtu"));
    assert!(!fields.contains(&"plate_0001.vtu".to_owned()), "{fields:?}");

    study["timing"]["threads"] = json!(2);
    write(folder.path(), "study.json", &study);
    let output = covact(
        folder.path(),
        &["study", "study.json", "-o", "out", "--collect"],
    );
    assert_eq!(output.status.code(), Some(4));
    let said = stderr(&output);
    assert!(
        said.contains("are not taken: they took 1 thread(s), and the study asks for 2"),
        "{said}"
    );
    let output = covact(folder.path(), &STUDY);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(events(&output).iter().all(|e| e["before"] == false));
}

/// An interrupt ends the study; what is done is kept, what is open is named, and the same command goes on.
#[cfg(unix)]
#[test]
fn an_interrupted_study_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    two_by_two(folder.path());
    // The second run takes long enough to be interrupted.
    let mut study: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("study.json")).unwrap()).unwrap();
    study["grids"][0]["choices"][0] = json!({ "variants": { "name": "length", "values": [
        { "label": "short" },
        { "label": "long", "set": {
            "/solution/step": { "initial": 1e-4, "max": 1e-4, "min": 1e-6 },
            "/bodies/plate/mesh/plate/elements": [12, 12],
        } },
    ] } });
    study["timing"]["repeats"] = json!(1);
    write(folder.path(), "study.json", &study);
    let mut child = command(folder.path(), &STUDY)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let first: Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
    assert_eq!(first["id"], "001_short");
    let killed = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    let last: Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
    assert_eq!(
        last,
        json!({ "event": "finished", "done": 1, "failed": 0, "missing": 1, "incomplete": 0 })
    );
    assert!(lines.next().is_none());
    assert_eq!(child.wait().unwrap().code(), Some(4));
    let left = record(&folder.path().join("out"));
    assert_eq!(left.runs[0].ending, Ending::Done);
    assert_eq!(left.runs[1].ending, Ending::Missing);

    study["grids"][0]["choices"][0]["variants"]["values"][1]["set"] =
        json!({ "/solution/end_time": 0.5 });
    write(folder.path(), "study.json", &study);
    let output = covact(folder.path(), &STUDY);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let events = events(&output);
    let before: Vec<bool> = events
        .iter()
        .map(|e| e["before"].as_bool().unwrap())
        .collect();
    assert_eq!(before, [true, false]);
}
