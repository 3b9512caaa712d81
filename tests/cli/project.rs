//! `covact project`.
use crate::support::{covact, moebius_band, stderr, stdout};
use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// A quarter of a cylinder of radius 2 about z and length 3, normal outwards, as geomdl writes it.
const QUARTER: &str = r#"{"shape": {"type": "surface", "count": 1, "data": [{
  "rational": true, "dimension": 3, "degree_u": 2, "degree_v": 1,
  "knotvector_u": [0, 0, 0, 1, 1, 1], "knotvector_v": [0, 0, 1, 1],
  "size_u": 3, "size_v": 2,
  "control_points": {
    "points": [[2, 0, 0], [2, 0, 3], [2, 2, 0], [2, 2, 3], [0, 2, 0], [0, 2, 3]],
    "weights": [1, 1, 0.7071067811865476, 0.7071067811865476, 1, 1]
  }
}]}}"#;

fn folder(points: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("quarter.json"), QUARTER).unwrap();
    std::fs::write(folder.path().join("points.txt"), points).unwrap();
    folder
}

fn files(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = names
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Points in front of the face, behind it, beyond an edge and a corner, on the axis (every point of a ring is as near) and
/// too far away.
const POINTS: &str = "# six points\n3 3 1\n0.6,0.8,2\n\n3,-1 1.5\n3 -1 4 # corner\n0 0 1\n90 0 0\n";

#[test]
fn rows_as_csv_and_as_json() {
    let folder = folder(POINTS);
    let run = |arguments: &[&str]| {
        let mut all = vec!["project", "quarter.json", "points.txt", "--reach", "10"];
        all.extend(arguments);
        covact(folder.path(), &all)
    };
    let output = run(&["-o", "out.csv", "--threads", "1"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stdout(&output), "");
    let told = stderr(&output);
    assert!(
        told.starts_with("6 points: 4 unique, 1 non-unique, 0 not converged, 1 beyond reach, ")
            && told.contains(" us per point for the projection (1 thread), ")
            && told.ends_with("; lengths in the unit of the CAD file\n"),
        "{told}"
    );
    let csv = std::fs::read_to_string(folder.path().join("out.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|l| l.split(',').collect()).collect();
    assert_eq!(
        rows[0].join(","),
        "entity,patch,xi1,xi2,x,y,z,signed_distance,where,number,kind,status"
    );
    assert_eq!(rows.len(), 7);
    // The radius is 2: distances follow by hand.
    let third = 1.0 / 3.0;
    let root = 2f64.sqrt();
    for (row, xi, foot, distance, place) in [
        (
            1,
            [0.5, third],
            [root, root, 1.0],
            18f64.sqrt() - 2.0,
            ["face", "", "", "unique"],
        ),
        (
            2,
            [f64::NAN, 2.0 * third],
            [1.2, 1.6, 2.0],
            -1.0,
            ["face", "", "", "unique"],
        ),
        (
            3,
            [0.0, 0.5],
            [2.0, 0.0, 1.5],
            root,
            ["edge", "0", "free", "unique"],
        ),
        (
            4,
            [0.0, 1.0],
            [2.0, 0.0, 3.0],
            3f64.sqrt(),
            ["corner", "2", "free", "unique"],
        ),
    ] {
        assert_eq!(rows[row][..2], ["1", "0"], "{row}");
        let numbers: Vec<f64> = rows[row][2..8].iter().map(|x| x.parse().unwrap()).collect();
        let expected = [xi[0], xi[1], foot[0], foot[1], foot[2], distance];
        for (found, expected) in numbers.iter().zip(expected) {
            assert!(
                expected.is_nan() || (found - expected).abs() < 1e-9,
                "{row}: {:?}",
                rows[row]
            );
        }
        assert_eq!(rows[row][8..], place, "{row}");
    }
    assert_eq!(rows[5][11], "non-unique");
    assert_eq!(rows[6].join(","), ",,,,,,,,,,,beyond reach");

    // The same as JSON, on the standard output.
    let output = run(&["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let lines = stdout(&output);
    for (line, row) in lines.lines().zip(&rows[1..]) {
        let line: serde_json::Value = serde_json::from_str(line).unwrap();
        for (name, cell) in rows[0].iter().zip(row) {
            let value = match &line[name] {
                serde_json::Value::Null => String::new(),
                serde_json::Value::String(text) => text.clone(),
                number => number.to_string(),
            };
            assert_eq!(value, *cell, "{name}");
        }
    }
    assert_eq!(lines.lines().count(), 6);
}

#[test]
fn a_bad_line_is_told_with_its_place_and_leaves_no_file() {
    let folder = folder("1 2 3\n1 2 x3\n");
    let output = covact(
        folder.path(),
        &["project", "quarter.json", "points.txt", "-o", "out.csv"],
    );
    assert_eq!(output.status.code(), Some(3));
    assert_eq!(
        stderr(&output),
        "error: points.txt:2:5: expected z (a number), found `x3`\n"
    );
    assert_eq!(files(folder.path()), ["points.txt", "quarter.json"]);
}

#[test]
fn files_and_options_that_are_wrong() {
    let folder = folder(POINTS);
    for (arguments, code, message) in [
        (
            &["quarter.jso", "points.txt"][..],
            3,
            "there is no file `quarter.jso`; did you mean `quarter.json`?",
        ),
        (
            &["quarter.json", "point.txt"],
            3,
            "there is no file `point.txt`; did you mean `points.txt`?",
        ),
        (
            &["quarter.json", "points.txt", "--reach", "-1"],
            2,
            "--reach: expected a length >= 0",
        ),
        (
            &["quarter.json", "points.txt", "--unit", "mmm"],
            2,
            "found `mmm`; did you mean `mm`?",
        ),
        (
            &["quarter.json", "points.txt", "-o", "none/out.csv"],
            5,
            "cannot write `none/out.csv`",
        ),
        (
            &["quarter.json", "points.txt", "-o", "."],
            5,
            "it exists and is not a regular file",
        ),
    ] {
        let mut all = vec!["project"];
        all.extend(arguments);
        let output = covact(folder.path(), &all);
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{told}");
        assert!(
            told.starts_with("error: ") && told.contains(message),
            "{told}"
        );
        assert_eq!(stdout(&output), "");
    }
    assert_eq!(files(folder.path()), ["points.txt", "quarter.json"]);
}

#[test]
fn units_are_converted_and_what_is_left_out_is_named() {
    let folder = folder("0 0 0\n");
    let sphere = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/sphere.igs");
    let distance = |unit: &str| {
        let output = covact(
            folder.path(),
            &["project", sphere, "points.txt", "--unit", unit],
        );
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stderr(&output).ends_with(&format!("; lengths in {unit}\n")));
        let text = stdout(&output);
        let row = text.lines().nth(1).unwrap();
        row.split(',').nth(7).unwrap().parse::<f64>().unwrap().abs()
    };
    let (mm, inch) = (distance("mm"), distance("in"));
    assert!(
        mm > 0.0 && (mm - 25.4 * inch).abs() < 1e-9 * mm,
        "{mm} {inch}"
    );
    // A file without a unit: its numbers are taken as they are, which is told.
    let output = covact(
        folder.path(),
        &["project", "quarter.json", "points.txt", "--unit", "m"],
    );
    assert_eq!(output.status.code(), Some(0));
    assert!(
        stderr(&output).starts_with(
            "warning: quarter.json states no length unit; its numbers are taken as m\n"
        ),
        "{}",
        stderr(&output)
    );
}

/// Points around the cylinder, as many as asked for.
fn many(n: u32) -> String {
    let mut text = String::new();
    for k in 0..n {
        let f = |a: f64| (f64::from(k) * a).fract() * 4.0 - 0.5;
        let (x, y, z) = (
            f(0.618_033_988_75),
            f(0.754_877_666_25),
            f(0.569_840_290_99),
        );
        writeln!(text, "{x} {y} {z}").unwrap();
    }
    text
}

#[test]
fn threads_change_nothing_and_the_order_is_kept() {
    let folder = folder(&many(3000));
    let run = |threads: &str| {
        let arguments = [
            "project",
            "quarter.json",
            "points.txt",
            "--threads",
            threads,
        ];
        let output = covact(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stdout(&output)
    };
    let one = run("1");
    assert_eq!(one.lines().count(), 3001);
    assert_eq!(one, run("3"));
    // The distance belongs to its point: 0 < x, y in a quarter of the cylinder.
    for (row, point) in one.lines().skip(1).zip(many(3000).lines()) {
        let x: Vec<f64> = point.split(' ').map(|x| x.parse().unwrap()).collect();
        let cells: Vec<&str> = row.split(',').collect();
        if cells[8] == "face" {
            let distance: f64 = cells[7].parse().unwrap();
            assert!(
                (distance - (x[0].hypot(x[1]) - 2.0)).abs() < 1e-9,
                "{row} {point}"
            );
        }
    }
}

/// The program waits for points on its standard input when the signal comes.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_file() {
    let folder = folder("");
    let mut child = Command::new(env!("CARGO_BIN_EXE_covact"))
        .current_dir(folder.path())
        .args(["project", "quarter.json", "-", "-o", "out.csv"])
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    std::io::Write::write_all(&mut input, many(40_000).as_bytes()).unwrap();
    // The pipe holds less than a megabyte: most points are read by now, so the temporary file is there.
    assert_eq!(files(folder.path()).len(), 3);
    let pid = child.id().to_string();
    let killed = Command::new("kill").args(["-INT", &pid]).status().unwrap();
    assert!(killed.success());
    let output = child.wait_with_output().unwrap();
    drop(input);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    assert_eq!(
        stderr(&output),
        "error: interrupted; `out.csv` was not written\n"
    );
    assert_eq!(files(folder.path()), ["points.txt", "quarter.json"]);
}

/// Points come through a pipe, so neither they nor the rows (13 MB for the larger run) can be held without being seen.
#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_points() {
    let folder = folder("");
    let peak = |n: u32| -> f64 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_covact"))
            .current_dir(folder.path())
            .args(["project", "quarter.json", "-", "-o", "out.csv"])
            .stdin(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut input = child.stdin.take().unwrap();
        std::io::Write::write_all(&mut input, many(n).as_bytes()).unwrap();
        drop(input);
        let output = child.wait_with_output().unwrap();
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{told}");
        assert!(told.starts_with(&format!("{n} points")), "{told}");
        let (_, memory) = told.split_once("peak memory ").unwrap();
        memory.split(' ').next().unwrap().parse().unwrap()
    };
    let (few, many) = (peak(35_000), peak(105_000));
    assert!(many < few + 4.0, "{few} MB, then {many} MB");
}

#[test]
fn distances_from_a_moebius_band_carry_no_sign() {
    let folder = folder("2 0 0.5\n2 0 -0.5\n0 0 0\n");
    std::fs::write(folder.path().join("band.json"), moebius_band()).unwrap();
    let output = covact(folder.path(), &["project", "band.json", "points.txt"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("distances from it carry no sign"));
    let text = stdout(&output);
    let distances: Vec<f64> = (text.lines().skip(1))
        .map(|l| l.split(',').nth(7).unwrap().parse().unwrap())
        .collect();
    assert_eq!(distances.len(), 3);
    assert!(distances.iter().all(|d| *d > 0.1), "{text}");
}
