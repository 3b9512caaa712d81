//! Folders that hold a run already, files of others, or links; and two runs in one folder.
use crate::support::*;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// All files of the results.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let name = |p: &Path| p.file_name().unwrap().to_str().unwrap().to_owned();
    // The lock that a killed run leaves behind is nothing of the run's results.
    (std::fs::read_dir(folder.join("out")).unwrap())
        .map(|e| e.unwrap().path())
        .filter(|p| name(p) != ".covact.lock")
        .map(|p| (name(&p), std::fs::read(&p).unwrap()))
        .collect()
}

fn run(folder: &Path, more: &[&str]) -> std::process::Output {
    covact(
        folder,
        &[&["run", "scene.json", "-o", "out", "--quiet"], more].concat(),
    )
}

/// Refused with exit code 2 and these parts of the message, and nothing is changed.
fn refused(folder: &Path, more: &[&str], parts: &[&str]) {
    let before = contents(folder);
    let output = run(folder, more);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert_parts(&stderr(&output), parts);
    assert!(before == contents(folder));
}

#[test]
fn a_run_is_replaced_on_demand_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_plate(path, &[]);
    assert_eq!(run(path, &[]).status.code(), Some(0));
    refused(
        path,
        &[],
        &[
            "error: `out` holds the results of a run",
            "`--resume`",
            "`--force`",
        ],
    );
    let output = covact(path, &["run", "scene.json", "-o", "out", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let text = stdout(&output);
    let last: serde_json::Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    assert_eq!(last["exit_code"], 2);
    // Both ways at once are none.
    assert_eq!(run(path, &["--force", "--resume"]).status.code(), Some(2));
    // Files of others stay, though one is called like fields; those of the longer run go.
    let out = path.join("out");
    std::fs::write(out.join("notes.txt"), "mine").unwrap();
    std::fs::copy(out.join("plate_0001.vtu"), out.join("saved_0001.vtu")).unwrap();
    let steps = json!({ "step": { "initial": 1, "max": 1 } });
    write_plate(path, &[("/solution", steps)]);
    let output = covact(path, &["run", "scene.json", "-o", "out", "--force"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_parts(&stderr(&output), &["note: the run in out is replaced"]);
    let names: Vec<String> = contents(path).into_keys().collect();
    let expected = [
        "ball_0000.vtu",
        "ball_0001.vtu",
        "ball_tessellated_0000.vtu",
        "ball_tessellated_0001.vtu",
        "history.csv",
        "notes.txt",
        "plate_0000.vtu",
        "plate_0001.vtu",
        "report.html",
        "results.pvd",
        "results_tessellated.pvd",
        "run.log",
        "saved_0001.vtu",
        "summary.json",
    ];
    assert_eq!(names, expected);
}

#[test]
fn files_of_others_are_never_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_plate(path, &[]);
    std::fs::create_dir(path.join("out")).unwrap();
    for name in [
        "checkpoint.0.bin",
        "history.csv",
        "summary.json",
        "results.pvd",
        "plate_0007.vtu",
    ] {
        let file = path.join("out").join(name);
        std::fs::write(&file, "a text of somebody\n").unwrap();
        for how in [&[][..], &["--force"]] {
            let named = format!("error: `out/{name}` was not written by covact");
            refused(path, how, &[&named, "choose another folder"]);
        }
        std::fs::remove_file(&file).unwrap();
    }
    // An unfinished run beside one of them.
    assert_eq!(run(path, &[]).status.code(), Some(0));
    std::fs::write(path.join("out/checkpoint.2.bin"), "a text of somebody\n").unwrap();
    refused(
        path,
        &["--force"],
        &["`out/checkpoint.2.bin` was not written"],
    );
}

#[cfg(unix)]
#[test]
fn links_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_plate(path, &[]);
    let (out, away) = (path.join("out"), path.join("away"));
    std::fs::create_dir_all(&out).unwrap();
    std::fs::create_dir_all(&away).unwrap();
    let names = [
        "history.csv",
        "plate_0001.vtu",
        "results.pvd",
        "summary.json",
        "checkpoint.0.bin",
        "checkpoint.1.bin",
        ".covact.lock",
    ];
    for name in names {
        std::fs::write(away.join(name), "mine").unwrap();
        std::os::unix::fs::symlink(away.join(name), out.join(name)).unwrap();
    }
    let output = run(path, &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for name in names {
        assert_eq!(std::fs::read_to_string(away.join(name)).unwrap(), "mine");
    }
    for name in &names[..4] {
        assert!(std::fs::symlink_metadata(out.join(name)).unwrap().is_file());
    }
    // A run does not go on with a table elsewhere.
    std::fs::remove_dir_all(&out).unwrap();
    let (mut child, _) = begun(path, &[]);
    child.kill().unwrap();
    child.wait().unwrap();
    std::fs::rename(out.join("history.csv"), away.join("history.csv")).unwrap();
    std::os::unix::fs::symlink(away.join("history.csv"), out.join("history.csv")).unwrap();
    let before = std::fs::read(away.join("history.csv")).unwrap();
    let output = run(path, &["--resume"]);
    assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
    assert_parts(
        &stderr(&output),
        &["`out/history.csv` is not as the run left it"],
    );
    assert!(before == std::fs::read(away.join("history.csv")).unwrap());
}

/// Starts a run of many steps and returns when its first one is done, with what it goes on to print.
fn begun(
    folder: &Path,
    more: &[&str],
) -> (std::process::Child, impl Iterator<Item = String> + use<>) {
    use std::io::BufRead;
    let steps = json!({ "step": { "initial": 0.002, "max": 0.002 } });
    write_plate(folder, &[("/solution", steps)]);
    let arguments = [&["run", "scene.json", "-o", "out", "--json"], more].concat();
    let mut child = command(folder, &arguments)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let lines = std::io::BufReader::new(child.stdout.take().unwrap()).lines();
    let mut lines = lines.map(Result::unwrap);
    assert!(lines.any(|l| l.contains("step_accepted")));
    (child, lines)
}

#[cfg(unix)]
#[test]
fn one_run_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let (mut child, mut lines) = begun(path, &[]);
    let by = format!(
        "error: another run is writing to `out` (process {} on ",
        child.id()
    );
    for how in [&[][..], &["--force"], &["--resume"]] {
        let output = run(path, how);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert_parts(
            &stderr(&output),
            &[&by, ", since 20", " UTC)", "wait until it has ended"],
        );
    }
    // The first one has not been touched.
    assert!(lines.any(|l| l.contains("step_accepted")));
    assert!(child.try_wait().unwrap().is_none());
    // One that is killed locks nothing.
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(path.join("out/.covact.lock").exists());
    refused(
        path,
        &[],
        &[
            "error: `out` holds an unfinished run",
            "`--resume`",
            "`--force`",
        ],
    );
    let (child, lines) = begun(path, &["--resume"]);
    let asked = std::process::Command::new("kill")
        .arg(child.id().to_string())
        .status();
    assert!(asked.unwrap().success());
    lines.for_each(drop);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(4));
    assert!(!path.join("out/.covact.lock").exists());
}

/// The folder of a what-if is looked at before the full run.
#[test]
fn what_ifs_replace_nothing_either() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_plate(
        path,
        &[(
            "/contacts/press/friction",
            json!({ "coulomb": { "mu": 0.1 } }),
        )],
    );
    let without = ["--without", "friction"];
    let output = run(path, &without);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for entry in std::fs::read_dir(path.join("out")).unwrap() {
        let entry = entry.unwrap().path();
        if entry.is_file() {
            std::fs::remove_file(entry).unwrap();
        }
    }
    let output = run(path, &without);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert_parts(
        &stderr(&output),
        &["`out/without_friction` holds the results of a run"],
    );
    assert!(!path.join("out/history.csv").exists());
    let output = run(path, &["--without", "friction", "--force"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}
