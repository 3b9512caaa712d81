//! Studies that are run elsewhere: a list of jobs, and what comes back.
use crate::support::*;
use covact::study::record::Ending;
use serde_json::json;
use std::path::Path;
use std::process::Command;

/// A study with a mesh, an STL file that is made, and a field to measure.
fn prepare(folder: &Path) {
    let master = json!({ "master": { "values": ["exact", { "stl": { "count": [4, 4] } }] } });
    let mut study = study(json!([{ "choices": [master] }]));
    study["references"] = json!({ "fine": { "order": 2, "runs": [
        { "/bodies/plate/mesh/plate/elements": [4, 4] },
        { "/bodies/plate/mesh/plate/elements": [8, 8] },
    ] } });
    study["quantities"] = json!([
        { "name": "force", "of": { "column": { "name": "force.ball.z" } }, "reference": { "finest": "fine" } },
    ]);
    study["timing"] = json!({ "repeats": 2 });
    let mut scene = scene();
    scene["contacts"]["press"]["accuracy"] = json!(1e-4);
    write(folder, "scene.json", &scene);
    write(folder, "study.json", &study);
}

/// The job list, done by a shell in another place, gives what the study itself gives.
#[cfg(unix)]
#[test]
fn jobs_by_hand_are_the_study() {
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let direct = covact(
        folder.path(),
        &["study", "study.json", "-o", "direct", "--quiet"],
    );
    assert_eq!(direct.status.code(), Some(0), "{}", stderr(&direct));
    let program = env!("CARGO_BIN_EXE_covact");
    let arguments = [
        "study",
        "study.json",
        "-o",
        "jobs",
        "--jobs",
        "--program",
        program,
    ];
    let output = covact(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let list = std::fs::read_to_string(folder.path().join("jobs/jobs.txt")).unwrap();
    assert_eq!(list.lines().count(), 6, "{list}");
    assert!(
        list.lines()
            .all(|l| l.starts_with(program)
                && l.ends_with(" --quiet --no-report --force --threads 1")),
        "{list}"
    );
    // Only the folder goes to another machine.
    let elsewhere = tempfile::tempdir().unwrap();
    let moved = elsewhere.path().join("there");
    std::fs::rename(folder.path().join("jobs"), &moved).unwrap();
    let shell = Command::new("sh")
        .arg("jobs.txt")
        .current_dir(&moved)
        .output()
        .unwrap();
    assert!(shell.status.success(), "{}", stderr(&shell));
    std::fs::rename(&moved, folder.path().join("jobs")).unwrap();

    let collected = covact(
        folder.path(),
        &["study", "study.json", "-o", "jobs", "--collect"],
    );
    assert_eq!(collected.status.code(), Some(0), "{}", stderr(&collected));
    let (direct, collected) = (
        record(&folder.path().join("direct")),
        record(&folder.path().join("jobs")),
    );
    assert_eq!(direct.runs.len(), 3);
    for (a, b) in direct.runs.iter().zip(&collected.runs) {
        assert_eq!(
            (&a.id, &a.choices, &a.ending, &a.reference),
            (&b.id, &b.choices, &b.ending, &b.reference)
        );
        assert_eq!(
            (&a.measured, &a.steps_taken, a.dofs),
            (&b.measured, &b.steps_taken, b.dofs)
        );
        assert_eq!((a.wall.unwrap().repeats, b.wall.unwrap().repeats), (2, 2));
    }
    // Only its pole touches, which is a point of the facets, too.
    let force = |i: usize| direct.runs[i].measured[0].value.unwrap();
    let [exact, facets] = [force(0), force(1)];
    assert!(exact < -100.0 && exact != facets, "{exact} {facets}");
    assert!((facets / exact - 1.0).abs() < 1e-3, "{exact} {facets}");
    assert_eq!(direct.quantities, collected.quantities);
    // The scenes are written for people, with their files beside them.
    let scene = folder.path().join("direct/runs/001_STL_4_x_4/scene.json");
    let scene = std::fs::read_to_string(scene).unwrap();
    assert!(
        scene.starts_with("{\n  \"covact\": 1,\n  \"materials\": {\n    \"steel\": {"),
        "{scene}"
    );
    assert!(
        scene.contains("\"file\": \"../../files/ball_count_4_4.stl\""),
        "{scene}"
    );
    assert!(
        collected
            .warnings
            .iter()
            .any(|w| w.starts_with("6 of the runs were not done by this command"))
    );
}

/// What has not come back is named.
#[test]
fn missing_runs_are_named() {
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    covact(
        folder.path(),
        &["study", "study.json", "-o", "out", "--jobs", "--quiet"],
    );
    let out = folder.path().join("out");
    let list = std::fs::read_to_string(out.join("jobs.txt")).unwrap();
    let first = list.lines().next().unwrap();
    assert_eq!(
        first,
        "covact run runs/reference_fine_1/scene.json -o runs/reference_fine_1/1 --quiet --no-report --force --threads 1"
    );
    let arguments: Vec<&str> = first.split(' ').skip(1).collect();
    assert!(covact(&out, &arguments).status.success());
    // Results of another scene are none of this one's.
    let other = out.join("runs/001_STL_4_x_4/1");
    std::fs::create_dir(&other).unwrap();
    std::fs::copy(
        out.join("runs/reference_fine_1/1/summary.json"),
        other.join("summary.json"),
    )
    .unwrap();

    let output = covact(
        folder.path(),
        &["study", "study.json", "-o", "out", "--collect"],
    );
    assert_eq!(output.status.code(), Some(4));
    let said = stderr(&output);
    for part in [
        "warning: run reference_fine_1: 1 of 2 repeats are missing",
        "warning: results in runs/001_STL_4_x_4/1 are not taken: the scene or a file that it names has changed since",
        "error: missing: 001_STL_4_x_4\n",
        "error: missing: reference_fine_2\n",
        "3 runs: 1 done, 0 failed, 2 missing",
    ] {
        assert!(said.contains(part), "no `{part}` in\n{said}");
    }
    let record = record(&out);
    let endings: Vec<bool> = record
        .runs
        .iter()
        .map(|r| r.ending == Ending::Missing)
        .collect();
    assert_eq!(endings, [false, true, true]);
}

/// A study in the folder of its own study file, or in that of another study, writes nothing.
#[test]
fn files_of_others_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let before = std::fs::read(folder.path().join("study.json")).unwrap();
    let output = covact(folder.path(), &["study", "study.json", "-o", ".", "--jobs"]);
    assert_eq!(output.status.code(), Some(5));
    let said = stderr(&output);
    assert!(said.contains("is no record of a study"), "{said}");
    assert_eq!(
        std::fs::read(folder.path().join("study.json")).unwrap(),
        before
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);

    let arguments = ["study", "study.json", "-o", "out", "--collect", "--quiet"];
    for _ in 0..2 {
        assert_eq!(covact(folder.path(), &arguments).status.code(), Some(4));
    }
    let out = folder.path().join("out");
    let first = record(&out);
    let mut other: serde_json::Value = serde_json::from_slice(&before).unwrap();
    other["title"] = json!("another");
    write(folder.path(), "study.json", &other);
    let output = covact(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(5));
    let said = stderr(&output);
    assert!(
        said.contains("another study: its title is `small`, not `another`"),
        "{said}"
    );
    assert_eq!(record(&out), first);
}
