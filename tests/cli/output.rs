//! Folders and files that cannot be written: exit code 5, and what was there before stays whole.
use crate::support::*;
use std::collections::BTreeMap;
use std::path::Path;

#[test]
fn folders_that_cannot_be_made() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    std::fs::write(folder.path().join("taken"), "mine").unwrap();
    for (out, message) in [
        (
            "taken",
            "error: cannot create the folder `taken`: a file of this name is in the way",
        ),
        (
            "taken/results",
            "error: cannot create the folder `taken/results`: a part of the path is a file",
        ),
    ] {
        let output = covact(folder.path(), &["run", "scene.json", "-o", out, "--quiet"]);
        assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
        assert_parts(&stderr(&output), &[message]);
        assert_eq!(
            std::fs::read_to_string(folder.path().join("taken")).unwrap(),
            "mine"
        );
        let output = covact(folder.path(), &["run", "scene.json", "-o", out, "--json"]);
        assert_eq!(output.status.code(), Some(5));
        let text = stdout(&output);
        let last: serde_json::Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
        assert_eq!(
            (&last["event"], &last["exit_code"]),
            (&"error".into(), &5.into())
        );
    }
    // A folder in the place of a result.
    std::fs::create_dir_all(folder.path().join("out/history.csv")).unwrap();
    let output = covact(
        folder.path(),
        &["run", "scene.json", "-o", "out", "--quiet"],
    );
    assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
    assert_parts(
        &stderr(&output),
        &["cannot write `out/history.csv`: it exists and is not a regular file"],
    );
}

/// All files of a folder.
#[cfg(unix)]
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let name = |p: &Path| p.file_name().unwrap().to_str().unwrap().to_owned();
    (std::fs::read_dir(folder).unwrap())
        .map(|e| e.unwrap().path())
        .map(|p| (name(&p), std::fs::read(&p).unwrap()))
        .collect()
}

/// The shell's limit on the size of files stands in for a full device: a write stops in the middle of a file.
#[cfg(unix)]
#[test]
fn a_device_that_takes_no_more() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    let program = env!("CARGO_BIN_EXE_covact");
    // In blocks of 512 bytes (POSIX) or 1024 (bash).
    let script = format!("trap '' XFSZ; ulimit -f 4; exec {program} run scene.json -o out --quiet");
    let limited = || {
        std::process::Command::new("sh")
            .current_dir(folder.path())
            .args(["-c", &script])
            .output()
            .unwrap()
    };
    let output = limited();
    assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
    assert_parts(
        &stderr(&output),
        &["error: cannot write `out/plate_0000.vtu`: the file is larger than the system allows"],
    );
    // No part of the file, and no temporary one.
    let files = contents(&folder.path().join("out"));
    assert!(
        files
            .keys()
            .all(|f| !f.ends_with(".vtu") && !f.contains(".tmp")),
        "{:?}",
        files.keys()
    );
    let status = |files: &BTreeMap<String, Vec<u8>>| {
        let summary: serde_json::Value = serde_json::from_slice(&files["summary.json"]).unwrap();
        summary["status"].as_str().unwrap().to_owned()
    };
    assert_eq!(status(&files), "failed");
    // Over the results of an earlier run: its fields stay as they were.
    let whole = covact(
        folder.path(),
        &["run", "scene.json", "-o", "out", "--quiet"],
    );
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    let before = contents(&folder.path().join("out"));
    assert_eq!(limited().status.code(), Some(5));
    let after = contents(&folder.path().join("out"));
    assert_eq!(
        before.keys().collect::<Vec<_>>(),
        after.keys().collect::<Vec<_>>()
    );
    assert_eq!(
        (status(&before), status(&after)),
        ("done".into(), "failed".into())
    );
    for (name, bytes) in &before {
        if name.ends_with(".vtu") {
            assert!(after[name] == *bytes, "{name} changed");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    for arguments in [&["schema"][..], &["check", "scene.json"]] {
        let full = std::fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = command(folder.path(), arguments)
            .stdout(full)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
        assert_parts(
            &stderr(&output),
            &["error: cannot write to the standard output: "],
        );
    }
}
