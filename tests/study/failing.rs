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
