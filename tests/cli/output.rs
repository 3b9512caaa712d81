//! Folders and files that cannot be written: exit code 5, and what was there before stays whole.
use crate::support::*;
use serde_json::json;
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
    // In blocks of 512 bytes (POSIX) or 1024 (bash). The signal is the program's to deal with.
    let script = format!("ulimit -f 4; exec {program} run scene.json -o out --quiet --force");
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
    // In place of an earlier run, nothing of which passes for this one's.
    let whole = covact(
        folder.path(),
        &["run", "scene.json", "-o", "out", "--quiet", "--force"],
    );
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    let before = contents(&folder.path().join("out"));
    assert!(before.contains_key("plate_0002.vtu"));
    assert_eq!(limited().status.code(), Some(5));
    let after = contents(&folder.path().join("out"));
    assert_eq!(
        (status(&before), status(&after)),
        ("done".into(), "failed".into())
    );
    assert!(after.keys().all(|name| !name.ends_with(".vtu")));
}

/// Runs a scene with a limit on the size of files, in blocks of 512 bytes (POSIX) or 1024 (bash).
#[cfg(unix)]
fn limited(folder: &Path, blocks: u32) -> std::process::Output {
    let program = env!("CARGO_BIN_EXE_covact");
    let script =
        format!("ulimit -f {blocks}; exec {program} run scene.json -o out --quiet --force");
    let mut shell = std::process::Command::new("sh");
    shell.current_dir(folder).args(["-c", &script]);
    shell.output().unwrap()
}

/// Full in the middle of a run, at one kind of file after the other: what was written before is whole, and the message
/// names the file.
#[cfg(unix)]
#[test]
fn a_device_that_fills_during_a_run() {
    let steps = |every: u32, size: f64| {
        [
            ("/solution/step/initial", serde_json::json!(size)),
            ("/solution/step/max", serde_json::json!(size)),
            (
                "/output",
                serde_json::json!({ "every": every, "tessellation": 1 }),
            ),
            (
                "/bodies/plate/mesh/plate/elements",
                serde_json::json!([2, 2]),
            ),
        ]
    };
    // The table: rows are small, and no fields are written.
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &steps(0, 0.01));
    let output = limited(folder.path(), 12);
    assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
    let message =
        "error: cannot write `out/history.csv`: the file is larger than the system allows";
    assert_parts(&stderr(&output), &[message]);
    let out = folder.path().join("out");
    let table = covact::output::read_csv(&out.join("history.csv")).unwrap();
    let rows = table.rows.len();
    assert!((2..100).contains(&rows), "{rows}");
    let steps_ = table.column("step").unwrap();
    assert!(steps_.iter().enumerate().all(|(i, s)| *s == (i + 1) as f64));
    let summary: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["status"], "failed");
    assert!(summary["reason"].as_str().unwrap().contains("history.csv"));
}

/// Starts a run and returns when its first step is done, with what it goes on to print.
#[cfg(unix)]
fn begun(folder: &Path) -> (std::process::Child, impl Iterator<Item = String> + use<>) {
    use std::io::BufRead;
    let mut child = command(folder, &["run", "scene.json", "-o", "out", "--json"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let lines = std::io::BufReader::new(child.stdout.take().unwrap()).lines();
    let mut lines = lines.map(Result::unwrap);
    assert!(lines.any(|l| l.contains("step_accepted")));
    (child, lines)
}

/// Small steps, and fields after so many of them.
#[cfg(unix)]
fn small_steps(every: u32) -> [(&'static str, serde_json::Value); 3] {
    [
        ("/solution/step/initial", serde_json::json!(0.002)),
        ("/solution/step/max", serde_json::json!(0.002)),
        ("/output", serde_json::json!({ "every": every })),
    ]
}

/// The listing of fields cannot be replaced any more: fields and rows until then are whole.
#[cfg(unix)]
#[test]
fn a_listing_that_cannot_be_written() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &small_steps(1));
    let (child, lines) = begun(folder.path());
    let out = folder.path().join("out");
    // The run may write the listing anew between the two calls.
    let listing = out.join("results.pvd");
    let replaced = (0..1000).any(|_| {
        let _ = std::fs::remove_file(&listing);
        std::fs::create_dir(&listing).is_ok()
    });
    assert!(replaced, "the listing is always written anew");
    lines.for_each(drop);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
    let message = "cannot write `out/results.pvd`: it exists and is not a regular file";
    assert_parts(&stderr(&output), &[message]);
    let table = covact::output::read_csv(&out.join("history.csv")).unwrap();
    assert!(!table.rows.is_empty());
    for step in 0..=table.rows.len() {
        let fields = std::fs::read(out.join(format!("plate_{step:04}.vtu"))).unwrap();
        let fields = String::from_utf8_lossy(&fields);
        assert!(fields.trim_end().ends_with("</VTKFile>"), "step {step}");
    }
    let left = std::fs::read_dir(&out)
        .unwrap()
        .map(|e| e.unwrap().file_name());
    assert!(
        left.into_iter()
            .all(|f| !f.to_string_lossy().contains(".tmp"))
    );
}

/// Nothing fits, not even the summary: that of an earlier run must not pass for this one's.
#[cfg(unix)]
#[test]
fn a_summary_that_does_not_fit() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(
        folder.path(),
        &[("/output", serde_json::json!({ "every": 0 }))],
    );
    std::fs::create_dir(folder.path().join("out")).unwrap();
    let whole = covact(
        folder.path(),
        &["run", "scene.json", "-o", "out", "--quiet"],
    );
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    assert!(folder.path().join("out/summary.json").is_file());
    let output = limited(folder.path(), 1);
    assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
    let after = contents(&folder.path().join("out"));
    assert!(!after.contains_key("summary.json"), "{:?}", after.keys());
}

/// Somebody removes the folder, or the table, while the program runs.
#[cfg(unix)]
#[test]
fn results_removed_during_a_run() {
    for what in ["out", "out/history.csv"] {
        let folder = tempfile::tempdir().unwrap();
        write_plate(folder.path(), &small_steps(0));
        let (child, lines) = begun(folder.path());
        let path = folder.path().join(what);
        // The program may just be writing its summary there.
        while path.exists() {
            let _ = match path.is_dir() {
                true => std::fs::remove_dir_all(&path),
                false => std::fs::remove_file(&path),
            };
        }
        lines.for_each(drop);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
        // Without the folder, the first file of the step that is under way is named.
        let parts: &[&str] = match what {
            "out" => &["cannot write `out/", ": no such file or folder"],
            _ => &[
                "cannot write `out/history.csv`: no such file or folder (it was removed during the run)",
            ],
        };
        assert_parts(&stderr(&output), parts);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn places_that_take_no_results() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    let long = "x".repeat(300);
    for (out, reason) in [
        (long.as_str(), "a name in the path is too long"),
        (
            "/proc/results",
            "cannot create the folder `/proc/results`: ",
        ),
        ("/dev/null", "cannot create the folder `/dev/null`: "),
    ] {
        let output = covact(folder.path(), &["run", "scene.json", "-o", out, "--quiet"]);
        assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
        assert_parts(&stderr(&output), &[reason]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    for arguments in [
        &["schema"][..],
        &["check", "scene.json"],
        &["run", "scene.json", "-o", "out", "--json"],
    ] {
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
        // However many lines there were.
        assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
    }
    // The results are not lost with the lines.
    assert!(folder.path().join("out/summary.json").is_file());
}

/// The numbers of a field on the points of the last step of the plate.
fn points_of(folder: &Path, name: &str) -> Vec<f64> {
    use vtkio::model::{Attribute, DataSet, Piece, Vtk};
    let bytes = std::fs::read(folder.join("out/plate_0002.vtu")).unwrap();
    let bytes = covact::output::inlined(&bytes).unwrap();
    let vtk = Vtk::parse_xml(&bytes[..]).unwrap();
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else {
        panic!("no grid");
    };
    let Some(Piece::Inline(grid)) = pieces.into_iter().next() else {
        panic!("no piece");
    };
    let named = grid.data.point.into_iter().find_map(|a| match a {
        Attribute::DataArray(a) if a.name == name => a.data.cast_into(),
        _ => None,
    });
    named.expect(name)
}

/// The digits that are left out by default are those that no result of a mesh is worth: displacements keep nearly ten, all else nearly
/// five, and the files take less room for it.
#[test]
fn fields_are_rounded_unless_full_precision_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let fields = [
        "displacement",
        "cauchy_stress",
        "contact_pressure",
        "reaction",
    ];
    let [(rounded, less), (full, more)] = [false, true].map(|full| {
        write_plate(
            folder.path(),
            &[("/output", json!({"full_precision": full}))],
        );
        let run = covact(
            folder.path(),
            &[
                "run",
                "scene.json",
                "-o",
                "out",
                "--quiet",
                "--force",
                "--no-report",
            ],
        );
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        let out = std::fs::read_dir(folder.path().join("out")).unwrap();
        let files = out.map(|entry| entry.unwrap().path());
        let name =
            |path: &std::path::PathBuf| path.file_name().unwrap().to_str().unwrap().to_owned();
        let written = files.filter(|path| name(path).starts_with("plate_"));
        let bytes: u64 = written.map(|path| path.metadata().unwrap().len()).sum();
        (fields.map(|name| points_of(folder.path(), name)), bytes)
    });
    for ((name, rounded), full) in fields.iter().zip(&rounded).zip(&full) {
        let part = match *name {
            "displacement" => 2f64.powi(-33),
            _ => 2f64.powi(-16),
        };
        let mut changed = 0;
        for (a, b) in rounded.iter().zip(full) {
            assert!((a - b).abs() <= part * b.abs(), "{name}: {a} for {b}");
            changed += usize::from(a != b);
        }
        assert!(changed > 0, "{name}");
    }
    assert!(10 * less < 8 * more, "{less} and {more} bytes");
}

#[test]
fn fields_that_are_derived_agree_with_what_they_are_derived_from() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(
        folder.path(),
        &[("/output", json!({"full_precision": true}))],
    );
    let run = covact(
        folder.path(),
        &["run", "scene.json", "-o", "out", "--quiet"],
    );
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let field = |name: &str| points_of(folder.path(), name);
    let rounding = 1e-12;
    let (pressure, traction) = (field("contact_pressure"), field("contact_traction"));
    let mut pressed = 0;
    for (p, t) in pressure.iter().zip(traction.chunks_exact(3)) {
        // A ball above presses down and, being round, a little outwards; normals around a node differ.
        let size = t.iter().map(|t| t * t).sum::<f64>().sqrt();
        assert!(
            size <= p * (1.0 + rounding) && size >= 0.98 * p,
            "{size} {p}"
        );
        if *p > 0.0 {
            assert!(t[2] < -0.9 * p, "{t:?} {p}");
            pressed += 1;
        }
    }
    assert!(pressed > 0);
    let (stress, principal, mises) = (
        field("cauchy_stress"),
        field("principal_stress"),
        field("von_mises"),
    );
    let largest = mises.iter().copied().fold(0.0, f64::max);
    assert!(largest > 0.0);
    for ((s, p), m) in stress
        .chunks_exact(6)
        .zip(principal.chunks_exact(3))
        .zip(&mises)
    {
        assert!(p[0] >= p[1] && p[1] >= p[2], "{p:?}");
        assert!((p.iter().sum::<f64>() - s[..3].iter().sum::<f64>()).abs() < rounding * largest);
        let differences = [p[0] - p[1], p[1] - p[2], p[2] - p[0]].map(|d| d * d);
        let own = (0.5 * differences.iter().sum::<f64>()).sqrt();
        assert!((own - m).abs() < rounding * largest, "{own} {m}");
    }
    // Large bending stretches the plate of thickness 2, which gets thinner by a few per cent.
    let (thickness, thinning) = (field("thickness"), field("thinning"));
    for (now, lost) in thickness.iter().zip(&thinning) {
        assert!((now / 2.0 + lost - 1.0).abs() < rounding);
        assert!(lost.abs() < 0.1, "{lost}");
    }
    assert!(thinning.iter().any(|lost| *lost > 1e-4));
    let strain = field("principal_log_strain");
    assert!(
        strain
            .chunks_exact(3)
            .all(|e| e[0] >= e[2] && e[0].abs() < 0.5)
    );
}
