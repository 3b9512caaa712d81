//! `covact run --resume`: processes that are killed, checkpoints that cannot be continued, disks that are full.
use crate::support::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use std::time::Duration;

const RUN: [&str; 5] = ["run", "scene.json", "-o", "out", "--quiet"];

/// Continues a run, or replaces it.
fn run(folder: &Path, resume: bool) -> Output {
    let how = if resume { "--resume" } else { "--force" };
    covact(folder, &[&RUN[..], &[how]].concat())
}

fn write(folder: &Path, scene: &Value) {
    let text = serde_json::to_string_pretty(scene).unwrap();
    std::fs::write(folder.join("scene.json"), text).unwrap();
}

/// All files of the results but those that tell times: the summary, the log, the page; and what tells who is at work.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let name = |p: &Path| p.file_name().unwrap().to_str().unwrap().to_owned();
    (std::fs::read_dir(folder.join("out")).unwrap())
        .map(|e| e.unwrap().path())
        .filter(|p| {
            !["summary.json", "run.log", "report.html", ".covact.lock"]
                .iter()
                .any(|f| p.ends_with(f))
        })
        .map(|p| (name(&p), std::fs::read(&p).unwrap()))
        .collect()
}

fn assert_same(a: &Path, b: &Path) {
    let (a, b) = (contents(a), contents(b));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (name, bytes) in &a {
        assert!(b[name] == *bytes, "{name} differs");
    }
}

fn summary(folder: &Path) -> Value {
    let text = std::fs::read_to_string(folder.join("out/summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// What does not depend on how often a run was interrupted.
fn counts(folder: &Path) -> Vec<Value> {
    let summary = summary(folder);
    let keys = [
        "status",
        "time",
        "steps",
        "cuts",
        "newton_iterations",
        "factorizations",
        "pattern_rebuilds",
        "warnings",
        "scene",
    ];
    keys.map(|key| summary[key].clone()).to_vec()
}

/// Number of the checkpoint in a slot, where there is one.
fn number(path: &Path) -> Option<u64> {
    let bytes = std::fs::read(path).ok()?;
    Some(u64::from_le_bytes(bytes.get(20..28)?.try_into().ok()?))
}

/// The newest slot of the results.
fn newest(folder: &Path) -> Option<PathBuf> {
    let slots = (0..3).map(|i| folder.join(format!("out/checkpoint.{i}.bin")));
    let found = slots.filter_map(|path| Some((number(&path)?, path)));
    found.max().map(|(_, path)| path)
}

/// Leaves the newest slot as the only one, and returns it.
fn only_newest(folder: &Path) -> PathBuf {
    let kept = newest(folder).unwrap();
    for path in (0..3).map(|i| folder.join(format!("out/checkpoint.{i}.bin"))) {
        if path != kept && path.exists() {
            std::fs::remove_file(path).unwrap();
        }
    }
    kept
}

/// The last step whose row in the table is whole.
fn last_row(folder: &Path) -> Option<u32> {
    let text = std::fs::read_to_string(folder.join("out/history.csv")).ok()?;
    let rows = text[..=text.rfind('\n')?].lines().skip(1);
    let step = |row: &str| row.split(',').next().unwrap().parse().unwrap();
    Some(rows.last().map_or(0, step))
}

/// Starts the program and kills it after it has told `lines` events and `wait` more; nothing where it has ended before, else the
/// step after which it has told to continue.
fn kill(folder: &Path, resume: bool, lines: usize, wait: Duration) -> Option<Option<u32>> {
    let mut arguments = vec!["run", "scene.json", "-o", "out", "--json"];
    arguments.push(if resume { "--resume" } else { "--force" });
    let mut child = command(folder, &arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let told = BufReader::new(child.stdout.take().unwrap()).lines();
    let told: Vec<String> = told.take(lines).filter_map(Result::ok).collect();
    std::thread::sleep(wait);
    // SIGKILL.
    child.kill().unwrap();
    let ended = child.wait().unwrap().success();
    let continued = told.iter().find_map(|line| {
        let rest = line.split_once("continued after step ")?.1;
        rest.split_once(' ')?.0.parse().ok()
    });
    (told.len() == lines && !ended).then_some(continued)
}

/// Kills a run at moments that a fixed list gives, up to ten times, and lets it end; the same scene runs at once beside it.
fn killed(scene: &Value) {
    let (whole, pieces) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    for folder in [&whole, &pieces] {
        write(folder.path(), scene);
    }
    let output = run(whole.path(), false);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let moments = [
        (1, 2000),
        (14, 0),
        (7, 700),
        (11, 3100),
        (19, 150),
        (3, 0),
        (9, 1700),
        (16, 400),
        (5, 90),
        (12, 5000),
    ];
    let (mut kills, mut resumed) = (0, 0);
    let mut redone = Vec::new();
    for (lines, micros) in moments {
        let resume = newest(pieces.path()).is_some();
        let wait = Duration::from_micros(micros);
        let before = last_row(pieces.path());
        let Some(continued) = kill(pieces.path(), resume, lines, wait) else {
            break;
        };
        kills += 1;
        resumed += u32::from(resume);
        if let Some(step) = continued {
            redone.push(before.unwrap() - step);
        }
    }
    // A row is written just before its checkpoint.
    println!("steps whose rows are written again: {redone:?}");
    assert!(redone.len() >= 4 && redone.iter().all(|steps| *steps <= 1));
    assert!(
        kills >= 6 && resumed >= 5,
        "{kills} kills, {resumed} resumed"
    );
    let output = run(pieces.path(), true);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_same(whole.path(), pieces.path());
    assert_eq!(counts(whole.path()), counts(pieces.path()));
    let counted = summary(pieces.path())["resumed"].as_u64().unwrap();
    println!("{kills} kills, {counted} times continued");
    // Those that were killed before they had read anything are not known.
    assert!(counted >= 2 && counted <= u64::from(resumed) + 1);
    assert_eq!(summary(whole.path())["resumed"], json!(0));
}

fn metal() -> Value {
    json!({"metal": {"j2": {
        "E": 200e3, "nu": 0.3, "hardening": {"swift": {"strength": 500, "offset": 0.01, "exponent": 0.2}}
    }}})
}

/// A strip of [`metal`].
fn strip() -> Value {
    json!({"strip": {
        "mesh": {"plate": {"size": [40, 5], "thickness": 1, "elements": [16, 1]}},
        "material": "metal"
    }})
}

/// A metal sheet that is bent over a tool and let go: what its points remember is continued.
#[test]
fn killed_while_it_flows() {
    killed(&json!({
        "covact": 1,
        "materials": metal(),
        "bodies": strip(),
        "supports": {
            "clamped": {"on": "strip.x_min", "fixed": true},
            "side": {"on": "strip.y_min", "symmetry": "y"},
            "tip": {"on": "strip.x_max", "displacement": {"z": {"table": [[0, 0], [0.6, 8], [1, 6]]}}}
        },
        "solution": {"step": {"initial": 0.02, "max": 0.02}},
    }));
}

/// A metal sheet whose yield surface moves, bent to and fro in steps of which some are too large: its back stress is continued.
#[test]
fn killed_while_its_yield_surface_moves() {
    killed(&json!({
        "covact": 1,
        "materials": {"metal": {"armstrong_frederick": {
            "E": 200e3, "nu": 0.3, "hardening": {"linear": {"yield_stress": 200}},
            "back_stress": {"modulus": 20e3, "recovery": 100}
        }}},
        "bodies": strip(),
        "supports": {
            "clamped": {"on": "strip.x_min", "fixed": true},
            "side": {"on": "strip.y_min", "symmetry": "y"},
            "tip": {"on": "strip.x_max", "displacement": {"z": {"table": [[0, 0], [0.4, 8], [1, -8]]}}}
        },
        "solution": {"step": {"initial": 0.02, "max": 0.02}},
    }));
}

/// A metal strip that a tool bends with friction and that is released in a second stage: what is let down and what holds the strip is
/// continued.
#[test]
fn killed_while_it_is_released() {
    killed(&json!({
        "covact": 1,
        "materials": metal(),
        "bodies": strip(),
        "surfaces": {"tool": {
            "cylinder": {"center": [35, 2.5, 5.5], "axis": [0, 1, 0], "radius": 5, "length": 20}, "side": "outward"
        }},
        "contacts": {"press": {"slave": "strip.top", "master": "tool", "friction": 0.1}},
        "supports": {
            "clamped": {"on": "strip.x_min", "fixed": true},
            "side": {"on": "strip.y_min", "symmetry": "y"}
        },
        "stages": [
            {"name": "bend", "until": 0.6, "tools": {"tool": [0, 0, -6]}},
            {"name": "release", "release": "forces", "supports": ["side", "automatic"]}
        ],
        "solution": {"step": {"initial": 0.02, "max": 0.02}},
    }));
}

/// Friction and augmentation on a rigid surface, enhanced strains; slave points are written.
#[test]
fn killed_while_it_slides() {
    killed(&json!({
        "covact": 1,
        "materials": {"rubber": {"neo_hooke": {"E": 10, "nu": 0.3}}},
        "bodies": {"slab": {
            "mesh": {"block": {"min": [0, 0, -2], "max": [6, 0.5, 0], "elements": [12, 1, 2]}},
            "material": "rubber"
        }},
        "surfaces": {"die": {
            "cylinder": {"radius": 3, "length": 2, "center": [2, 0, 3]},
            "motion": {"translation": [
                {"table": [[0, 0], [0.2, 0], [1, 1.2]]}, 0, {"table": [[0, 0], [0.2, -0.3], [1, -0.3]]}
            ]}
        }},
        "contacts": {"iron": {
            "slave": "slab.top", "master": "die", "points": {"gauss": 2}, "penalty": {"scaled": 3},
            "friction": {"coulomb": {"mu": 0.3}},
            "augmentation": {"gap": 1e-3, "slip": 1e-3, "max": 25}
        }},
        "supports": {
            "floor": {"on": "slab.bottom", "fixed": true},
            "front": {"on": "slab.y_min", "symmetry": "y"},
            "back": {"on": "slab.y_max", "symmetry": "y"}
        },
        "solution": {"step": {"initial": 0.05, "max": 0.05}},
        "output": {"contact_points": true}
    }));
}

/// A block that is drawn over another with friction, up to a wall whose facets cut its front into segments, while a ball that
/// is driven by force lies on the other.
#[test]
fn killed_between_bodies() {
    let block = |min: Value, max: Value, elements: Value| {
        json!({
            "mesh": {"block": {"min": min, "max": max, "elements": elements}}, "material": "m"
        })
    };
    killed(&json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
        "bodies": {
            "bed": block(json!([0, 0, -1]), json!([4, 1, 0]), json!([12, 1, 1])),
            "sledge": block(json!([0.5, 0, 0.01]), json!([1.5, 1, 0.6]), json!([4, 1, 1])),
            "wall": block(json!([2.3, 0, 0.05]), json!([2.8, 1, 0.55]), json!([1, 1, 3]))
        },
        "surfaces": {"ball": {
            "sphere": {"radius": 1, "center": [3.4, 0.5, 1.05]},
            "motion": {"free": {"force": {"z": {"table": [[0, -0.1], [0.2, -1], [1, -2]]}}}}
        }},
        "contacts": {
            "rub": {
                "slave": "sledge.bottom", "master": "bed.top", "points": {"gauss": 2},
                "friction": {"coulomb": {"mu": 0.2}}
            },
            "load": {"slave": "bed.top", "master": "ball", "points": {"gauss": 2}},
            "bump": {"slave": "sledge.x_max", "master": "wall.x_min", "points": {"segments": 2}}
        },
        "supports": {
            "ground": {"on": "bed.bottom", "fixed": true},
            "base": {"on": "wall.x_max", "fixed": true},
            "bed_y": {"on": "bed.y_min", "symmetry": "y"},
            "wall_y": {"on": "wall.y_min", "symmetry": "y"},
            "sledge_y": {"on": "sledge.y_min", "symmetry": "y"},
            "push": {"on": "sledge.top", "displacement": {
                "x": {"table": [[0, 0], [0.2, 0], [1, 0.88]]}, "y": 0,
                "z": {"table": [[0, 0], [0.2, -0.03], [1, -0.03]]}
            }}
        },
        "solution": {"step": {"initial": 0.05, "max": 0.05}}
    }));
}

/// Runs `scene.json` until it has told some events, and kills it.
fn cut_short(folder: &Path) {
    assert!(kill(folder, false, 12, Duration::ZERO).is_some());
    assert!(newest(folder).is_some());
}

/// The plate in many steps.
fn plate_in_steps(folder: &Path, changes: &[(&str, Value)]) {
    let step = ("/solution", json!({"step": {"initial": 0.1, "max": 0.1}}));
    let without = ("/output", json!({"every": 0}));
    write_plate(folder, &[&[step, without], changes].concat());
}

#[test]
fn a_run_that_has_reached_its_end() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    let output = run(folder.path(), true);
    assert_eq!(output.status.code(), Some(5));
    assert_parts(
        &stderr(&output),
        &["error: nothing to continue: `out/checkpoint.0.bin` is missing; run without `--resume`"],
    );
    assert!(!folder.path().join("out").exists());
    assert_eq!(run(folder.path(), false).status.code(), Some(0));
    let before = (contents(folder.path()), summary(folder.path()));
    let output = covact(
        folder.path(),
        &["run", "scene.json", "-o", "out", "--resume"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_parts(
        &stderr(&output),
        &["the run in out has reached its end already"],
    );
    assert!(before == (contents(folder.path()), summary(folder.path())));
    // A tool that never touches has its own end.
    write_plate(
        folder.path(),
        &[("/surfaces/ball/motion/translation", json!([0, 0, "0.1*t"]))],
    );
    let output = run(folder.path(), true);
    assert_eq!(output.status.code(), Some(3));
    assert_parts(&stderr(&output), &["of another scene", "`--resume`"]);
    assert_eq!(run(folder.path(), false).status.code(), Some(4));
    let output = run(folder.path(), true);
    assert_eq!(output.status.code(), Some(4));
    assert_parts(&stderr(&output), &["no contact", "never touched"]);
}

#[test]
fn a_scene_that_has_changed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // Two triangles under the ball's path.
    let stl = |z: &str| {
        let facet = |corners: [&str; 3]| {
            let lines = corners.map(|c| format!("vertex {c} {z}\n")).concat();
            format!("facet normal 0 0 -1\nouter loop\n{lines}endloop\nendfacet\n")
        };
        let (a, b) = (
            ["-50 -50", "50 50", "50 -50"],
            ["-50 -50", "-50 50", "50 50"],
        );
        format!("solid s\n{}{}endsolid s\n", facet(a), facet(b))
    };
    std::fs::write(path.join("flat.stl"), stl("9")).unwrap();
    let flat = json!({"cad": {"file": "flat.stl"}});
    let with = |more: &[(&str, Value)]| {
        let flat = ("/surfaces/flat", flat.clone());
        plate_in_steps(path, &[&[flat], more].concat());
    };
    with(&[]);
    cut_short(path);
    let before = contents(path);
    let refused = |parts: &[&str]| {
        let output = run(path, true);
        assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
        assert_parts(
            &stderr(&output),
            &["error: the run in `out` is of another scene: "],
        );
        assert_parts(&stderr(&output), parts);
        assert!(before == contents(path));
    };
    with(&[("/materials/steel/st_venant_kirchhoff/nu", json!(0.2))]);
    refused(&["`/materials/steel` has changed; take the scene as it was"]);
    with(&[("/contacts/press/points", json!("auto"))]);
    std::fs::write(path.join("flat.stl"), stl("8")).unwrap();
    refused(&["file `flat.stl` has changed"]);
    // As it was, written in another way, and on another number of threads.
    std::fs::write(path.join("flat.stl"), stl("9")).unwrap();
    with(&[]);
    let text = std::fs::read_to_string(path.join("scene.json")).unwrap();
    let text = text.replace("12000.0", "1.2e4").replace("12000", "1.2e4");
    std::fs::write(path.join("scene.json"), text.replace("  ", " ")).unwrap();
    let output = covact(path, &[&RUN[..], &["--resume", "--threads", "2"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let pieces = contents(path);
    assert_eq!(run(path, false).status.code(), Some(0));
    assert!(pieces == contents(path));
}

#[test]
fn files_that_are_not_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    plate_in_steps(path, &[]);
    cut_short(path);
    let file = only_newest(path);
    let named = |words: &str| {
        let name = file.file_name().unwrap().to_str().unwrap();
        format!("`out/{name}` {words}")
    };
    let mut good = std::fs::read(&file).unwrap();
    // Behind it there may be the end of a longer one.
    good.truncate(u64::from_le_bytes(good[12..20].try_into().unwrap()) as usize);
    let refused = |parts: &[&str]| {
        let before = contents(path);
        let output = run(path, true);
        assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
        assert_parts(&stderr(&output), parts);
        assert!(before == contents(path));
    };
    let damaged = &named("is damaged: ");
    for length in [1, 8, 27, 28, 36, 100, good.len() - 1] {
        std::fs::write(&file, &good[..length]).unwrap();
        refused(&["error: ", damaged, "not whole"]);
    }
    std::fs::write(&file, []).unwrap();
    refused(&[damaged, "empty"]);
    for at in [22, 40, good.len() / 2, good.len() - 4] {
        let mut bytes = good.clone();
        bytes[at] ^= 4;
        std::fs::write(&file, &bytes).unwrap();
        refused(&[damaged, "its checksum is wrong"]);
    }
    std::fs::write(&file, "a text of somebody\n".repeat(9)).unwrap();
    refused(&[&named("is no checkpoint of covact")]);
    std::fs::write(&file, &good).unwrap();
    // The table must begin as it was then; a part of a line at its end is what a kill may leave.
    let table = path.join("out/history.csv");
    let rows = std::fs::read(&table).unwrap();
    std::fs::write(&table, &rows[..20]).unwrap();
    refused(&["error: `out/history.csv` is not as the run left it"]);
    let mut other = rows.clone();
    other[3] ^= 1;
    std::fs::write(&table, &other).unwrap();
    refused(&["error: `out/history.csv` is not as the run left it"]);
    std::fs::remove_file(&table).unwrap();
    refused(&["error: `out/history.csv` is not as the run left it"]);
    std::fs::write(&table, [&rows[..], b"7,0.7,0."].concat()).unwrap();
    let left = path.join("out/.checkpoint.bin.123-4.tmp");
    std::fs::write(&left, "half").unwrap();
    assert_eq!(run(path, true).status.code(), Some(0));
    assert!(!left.exists());
    let pieces = contents(path);
    // Started anew over an unfinished run, which is told.
    cut_short(path);
    let output = covact(path, &["run", "scene.json", "-o", "out", "--force"]);
    assert_eq!(output.status.code(), Some(0));
    assert_parts(&stderr(&output), &["note: the run in out is replaced"]);
    assert!(pieces == contents(path));
    assert!(newest(path).is_none());
}

/// The shell's limit on the size of files stands in for a full device.
#[cfg(unix)]
#[test]
fn a_device_that_takes_no_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    plate_in_steps(path, &[]);
    cut_short(path);
    let kept = only_newest(path);
    let kept = kept.file_name().unwrap().to_str().unwrap();
    let before = contents(path);
    let program = env!("CARGO_BIN_EXE_covact");
    let script = format!("ulimit -f 4; exec {program} run scene.json -o out --quiet --resume");
    let output = std::process::Command::new("sh")
        .current_dir(path)
        .args(["-c", &script])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
    assert_parts(
        &stderr(&output),
        &[
            "error: cannot write `out/checkpoint.",
            ".bin`: the file is larger than the system allows",
        ],
    );
    assert_eq!(summary(path)["status"], json!("failed"));
    let after = contents(path);
    assert!(before[kept] == after[kept]);
    assert_eq!(newest(path).map(|path| path.ends_with(kept)), Some(false));
    assert!(before["history.csv"].starts_with(&after["history.csv"]));
    assert!(after.keys().all(|name| !name.contains(".tmp")));
    // With room it goes on, from the one that is whole.
    let output = covact(path, &["run", "scene.json", "-o", "out", "--resume"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let notes = stderr(&output);
    assert_parts(
        &notes,
        &[
            "note: `out/checkpoint.",
            ".bin` is damaged: it is not whole; the checkpoint before it is taken",
            "note: continued after step",
        ],
    );
    let pieces = contents(path);
    // A folder in its place.
    std::fs::create_dir(path.join("out/checkpoint.1.bin")).unwrap();
    for resume in [false, true] {
        let output = run(path, resume);
        assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
        assert_parts(&stderr(&output), &["`out/checkpoint.1.bin`"]);
    }
    std::fs::remove_dir(path.join("out/checkpoint.1.bin")).unwrap();
    assert_eq!(run(path, false).status.code(), Some(0));
    assert!(pieces == contents(path));
}

/// A folder that may not be written to; whoever may do everything is not kept out.
#[cfg(unix)]
#[test]
fn a_folder_that_is_read_only() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    plate_in_steps(path, &[]);
    cut_short(path);
    let before = contents(path);
    let out = path.join("out");
    let permit = |mode| {
        std::fs::set_permissions(&out, std::fs::Permissions::from_mode(mode)).unwrap();
    };
    permit(0o555);
    let kept_out = std::fs::write(out.join("probe"), "").is_err();
    let output = run(path, true);
    permit(0o755);
    if kept_out {
        assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
        assert_parts(&stderr(&output), &["permission denied"]);
        let slots = |of: &BTreeMap<String, Vec<u8>>| {
            let slot = |name: &String| name.starts_with("checkpoint");
            of.clone()
                .into_iter()
                .filter(|(name, _)| slot(name))
                .collect::<Vec<_>>()
        };
        assert!(slots(&before) == slots(&contents(path)));
        assert_eq!(run(path, true).status.code(), Some(0));
    } else {
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
}
