//! Runs that fail are results, with their reason.
use crate::support::*;
use covact::study::record::{Ending, Record};
use serde_json::{Value, json};
use std::path::Path;

/// A run that is done beside one with these changes.
fn beside(folder: &Path, set: Value) -> Value {
    let variants = json!({ "variants": { "name": "case", "values": [
        { "label": "right" }, { "label": "failing", "set": set },
    ] } });
    let study = study(json!([{ "choices": [variants] }]));
    write(folder, "scene.json", &scene());
    write(folder, "study.json", &study);
    study
}

fn reason(record: &Record) -> &str {
    assert_eq!(record.runs[0].ending, Ending::Done);
    assert!(record.runs[0].measured[0].value.is_some());
    let failed = &record.runs[1];
    assert!(
        failed.measured[0].missing.is_some(),
        "{:?}",
        failed.measured
    );
    match &failed.ending {
        Ending::Failed(reason) => reason,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_run_that_does_not_converge() {
    let folder = tempfile::tempdir().unwrap();
    let set = json!({ "/solution/newton/max_iterations": 1, "/solution/step/min": 0.5 });
    let mut study = beside(folder.path(), set);
    let output = covact(folder.path(), &["study", "study.json", "-o", "out"]);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    let out = folder.path().join("out");
    let first = record(&out);
    assert!(
        reason(&first).starts_with("not converged: "),
        "{}",
        reason(&first)
    );
    let said = stderr(&output);
    assert!(
        said.contains("error: failed: 002_failing: not converged: "),
        "{said}"
    );
    assert!(
        said.contains("2 runs: 1 done, 1 failed, 0 missing"),
        "{said}"
    );

    // It is not tried again, and a study that asks for it has no fault.
    study["may_fail"] = json!(true);
    write(folder.path(), "study.json", &study);
    let output = covact(
        folder.path(),
        &["study", "study.json", "-o", "out", "--json"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(events(&output).iter().all(|e| e["before"] == true));
    assert_eq!(record(&out).runs[1], first.runs[1]);
}

/// What the run said before it ended without a summary.
#[test]
fn a_run_that_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("broken.igs"), "no CAD file").unwrap();
    let set = json!({ "/surfaces/ball": { "cad": { "file": "broken.igs" } } });
    beside(folder.path(), set);
    let output = covact(
        folder.path(),
        &["study", "study.json", "-o", "out", "--quiet"],
    );
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    let record = record(&folder.path().join("out"));
    let reason = reason(&record);
    assert!(reason.contains("runs/002_failing/scene.json:"), "{reason}");
    assert!(reason.contains("broken.igs"), "{reason}");
}

/// A run over its limit is stopped; with a higher limit it is done anew, as one that was cut short by chance.
#[test]
fn a_run_that_takes_too_long() {
    let folder = tempfile::tempdir().unwrap();
    let set = json!({ "/solution/step": { "initial": 1e-4, "max": 1e-4, "min": 1e-6 } });
    let mut study = beside(folder.path(), set);
    study["timing"] = json!({ "limit": 1.5 });
    write(folder.path(), "study.json", &study);
    let output = covact(
        folder.path(),
        &["study", "study.json", "-o", "out", "--quiet"],
    );
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    let out = folder.path().join("out");
    let record = record(&out);
    assert_eq!(reason(&record), "stopped at its limit of 1.5 s");
    let wall = record.runs[1].wall.unwrap();
    assert!((1.5..3.0).contains(&wall.median), "{wall:?}");
    let again = |limit: f64| {
        study["timing"]["limit"] = json!(limit);
        write(folder.path(), "study.json", &study);
        let output = covact(
            folder.path(),
            &["study", "study.json", "-o", "out", "--json"],
        );
        let events = events(&output);
        events.iter().find(|e| e["id"] == "002_failing").unwrap()["before"]
            .as_bool()
            .unwrap()
    };
    let mut again = again;
    assert!(again(1.0));
    assert!(!again(1.7));
}

/// Changes a file of JSON.
fn change(path: &Path, by: impl Fn(&mut Value)) {
    let mut content: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    by(&mut content);
    std::fs::write(path, content.to_string()).unwrap();
}

/// What is left of runs that were cut short, or done again elsewhere.
#[test]
fn what_is_left_of_runs() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = beside(folder.path(), json!({ "/solution/end_time": 0.5 }));
    study["timing"] = json!({ "repeats": 3 });
    write(folder.path(), "study.json", &study);
    let play = ["study", "study.json", "-o", "out", "--json"];
    let collect = ["study", "study.json", "-o", "out", "--collect"];
    assert_eq!(covact(folder.path(), &play).status.code(), Some(0));
    let out = folder.path().join("out");
    let [one, two, three] = ["1", "2", "3"].map(|repeat| out.join("runs/002_failing").join(repeat));
    // A summary that says done is later than an account of a process that was stopped.
    change(&one.join("process.json"), |a| {
        a["stopped_after"] = json!(1e-3);
        a["exit_code"] = Value::Null;
        a["wall_s"] = json!(5e5);
    });
    // What an interrupted repeat took is no time of the run.
    change(&two.join("summary.json"), |s| {
        s["status"] = json!("interrupted");
        s["cpu_s"] = json!(7e5);
        s["peak_memory_mb"] = json!(7e9);
    });
    let output = covact(folder.path(), &collect);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    let said = stderr(&output);
    assert!(said.contains("1 of 3 repeats are missing"), "{said}");
    let run = &record(&out).runs[1];
    assert_eq!(run.ending, Ending::Done);
    let (wall, cpu) = (run.wall.unwrap(), run.cpu.unwrap());
    assert_eq!((wall.repeats, cpu.repeats), (2, 2));
    assert!(wall.most < 1e5 && cpu.most < 1e5, "{wall:?} {cpu:?}");
    assert!(run.peak_memory_mb.unwrap() < 1e9);

    // Half a summary is none, and jobs that are to be done anew do not inherit failures.
    std::fs::write(one.join("summary.json"), "{ \"status\": \"do").unwrap();
    std::fs::remove_file(three.join("summary.json")).unwrap();
    change(&three.join("process.json"), |a| a["exit_code"] = json!(1));
    let jobs = ["study", "study.json", "-o", "out", "--jobs", "--quiet"];
    assert_eq!(covact(folder.path(), &jobs).status.code(), Some(0));
    assert!(!three.join("process.json").exists());
    assert!(out.join("runs/001_right/1/process.json").exists());
    let output = covact(folder.path(), &collect);
    let said = stderr(&output);
    assert!(
        said.contains("results in runs/002_failing/1 are not taken: ")
            && said.contains("error: missing: 002_failing\n"),
        "{said}"
    );
    // A folder that the program does not know is not removed.
    for file in std::fs::read_dir(&three).unwrap() {
        std::fs::remove_file(file.unwrap().path()).unwrap();
    }
    std::fs::write(three.join("thesis.tex"), "mine").unwrap();
    let output = covact(folder.path(), &play);
    assert_eq!(output.status.code(), Some(5));
    assert!(stderr(&output).contains("holds something else"));
    assert!(three.join("thesis.tex").exists());
    std::fs::remove_file(three.join("thesis.tex")).unwrap();
    let output = covact(folder.path(), &play);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}
