//! What a scene may not ask for, and files that are none: one message, quickly, and the memory stays free.
use crate::support::*;
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

/// `check` and `run` refuse a changed plate at `pointer`. (Their messages differ in what memory was available.)
fn refused_at(changes: &[(&str, Value)], pointer: &str, parts: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let (text, place) = text_and_place(&plate_with(changes), pointer);
    std::fs::write(folder.path().join("scene.json"), text).unwrap();
    let start = format!("error: scene.json:{place}: ");
    for arguments in [
        &["check", "scene.json"][..],
        &["run", "scene.json", "-o", "out", "--quiet"],
    ] {
        let output = covact(folder.path(), arguments);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{message}");
        assert!(message.starts_with(&start), "not at {place}:\n{message}");
        assert_parts(&message, parts);
        assert!(!folder.path().join("out").exists());
    }
}

#[test]
fn more_elements_than_memory() {
    const KEY: &str = "/bodies/plate/mesh/plate/elements";
    for (elements, parts) in [
        (
            json!([4000, 4000]),
            &[
                "body `plate` with 4000 x 4000 x 1 elements: about ",
                "B of memory are needed, but ",
                "help: take fewer elements",
            ][..],
        ),
        (json!([7000, 7000]), &["7000 x 7000 x 1 elements: about "]),
        (
            json!([4294967295u32, 4294967295u32]),
            &["1.845e19 elements in all", "help: at most 5e7"],
        ),
    ] {
        refused_at(&[(KEY, elements)], KEY, parts);
    }
    let block =
        json!({ "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [300, 300, 300] } });
    refused_at(
        &[("/bodies/plate/mesh", block)],
        "/bodies/plate/mesh/block/elements",
        &["body `plate` with 300 x 300 x 300 elements: about "],
    );
}

#[test]
fn more_facets_than_possible() {
    let facets = json!({ "kind": "smooth", "count": [100000, 100000] });
    refused_at(
        &[("/surfaces/ball/facets", facets)],
        "/surfaces/ball/facets/count",
        &[
            "surface `ball`: more than ",
            " facets would be needed",
            "help: ask for coarser facets",
        ],
    );
}

/// The program with a limit on its address space.
#[cfg(target_os = "linux")]
fn with_memory(folder: &Path, megabytes: u64, arguments: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_covact");
    let script = format!("ulimit -v {}; exec {program} {arguments}", 1000 * megabytes);
    // A thread's own heap would take 64 MB of the address space.
    let mut shell = Command::new("sh");
    shell.current_dir(folder).args(["-c", &script]);
    shell
        .env("MALLOC_ARENA_MAX", "1")
        .env("RAYON_NUM_THREADS", "1");
    shell.output().unwrap()
}

/// What fits into a small machine runs there, and what does not is refused before it is tried, by its key.
#[cfg(target_os = "linux")]
#[test]
fn limits_of_the_process_count() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    let output = with_memory(folder.path(), 150, "check scene.json");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let forty = ("/bodies/plate/mesh/plate/elements", json!([40, 40]));
    let tools = json!({ "sphere": { "radius": 25, "center": [0, 0, 26] } });
    for (changes, key, parts) in [
        (
            vec![forty, ("/contacts/press/points", json!({ "gauss": 10 }))],
            "/contacts/press/points",
            &[
                "contact `press`: 100 slave points on each of 1600 faces: about ",
                " MB of memory are needed, but ",
                " are left of the process's limit",
                "help: take fewer points",
            ][..],
        ),
        (
            vec![
                ("/output", json!({ "tessellation": 200 })),
                ("/surfaces/other", tools),
            ],
            "/output/tessellation",
            &[
                "200 x 200 quadrilaterals for each of 16 pieces of surfaces: about 2",
                "help: take a smaller number",
            ],
        ),
        (
            vec![("/bodies/plate/mesh/plate/elements", json!([150, 150]))],
            "/bodies/plate/mesh/plate/elements",
            &["help: take fewer elements"],
        ),
    ] {
        let (text, place) = text_and_place(&plate_with(&changes), key);
        std::fs::write(folder.path().join("scene.json"), text).unwrap();
        let output = with_memory(folder.path(), 150, "check scene.json");
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{message}");
        let start = format!("error: scene.json:{place}: ");
        assert!(message.starts_with(&start), "not at {place}:\n{message}");
        assert_parts(&message, parts);
    }
}

/// The dense kernels end the process where they cannot have the buffers they pack into; the run is refused before.
#[cfg(target_os = "linux")]
#[test]
fn room_for_the_kernels_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[("/output", json!({ "every": 0 }))]);
    let buffers = covact::machine::packing(1) / 1_000_000;
    let run = "run scene.json -o out --quiet --threads 1";
    let mut refused = 0;
    for megabytes in [60, 100, 150, 300, 600, buffers + 20, buffers + 60] {
        let output = with_memory(folder.path(), megabytes, run);
        let message = stderr(&output);
        // Whatever the machine's caches are: done, or refused with the number.
        match output.status.code() {
            Some(0) => {
                assert!(
                    megabytes > buffers,
                    "{megabytes} MB, {buffers} MB of buffers"
                );
                std::fs::remove_dir_all(folder.path().join("out")).unwrap();
            }
            Some(3) => {
                refused += 1;
                assert_parts(
                    &message,
                    &[
                        "memory are needed",
                        "are left of the process's limit",
                        "help: ",
                    ],
                );
                assert!(!folder.path().join("out").exists());
            }
            code => panic!("{megabytes} MB: exit code {code:?}\n{message}"),
        }
    }
    assert!(refused >= 1);
    let output = with_memory(folder.path(), buffers + 400, run);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// No more threads are started than can run.
#[test]
fn threads_beyond_the_machine() {
    let there = covact::machine::processors() as u64;
    let told = format!("threads are asked for, and {there} can run at once here: {there} are used");
    let folder = tempfile::tempdir().unwrap();
    let (no_fields, many) = (("/output", json!({ "every": 0 })), 100_000);
    for (scene, arguments, asked) in [
        (vec![no_fields.clone()], &["--threads", "100000"][..], many),
        (
            vec![no_fields, ("/solution/threads", json!(there + 1))],
            &[],
            there + 1,
        ),
    ] {
        write_plate(folder.path(), &scene);
        let run = ["run", "scene.json", "-o", "out", "--force"];
        let output = covact(folder.path(), &[&run[..], arguments].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert_parts(&stderr(&output), &[&format!("note: {asked} {told}")]);
        let summary = std::fs::read(folder.path().join("out/summary.json")).unwrap();
        let summary: Value = serde_json::from_slice(&summary).unwrap();
        assert_eq!(summary["threads"], json!(there));
    }
}

/// A driven surface whose coordinates leave no digits for gaps is refused at once; one that is merely large is not.
#[test]
fn driven_surfaces_beyond_all_measure() {
    let sphere = |radius: f64, height: f64| {
        [
            (
                "/surfaces/ball/sphere",
                json!({ "radius": radius, "center": [0, 0, height] }),
            ),
            (
                "/surfaces/ball/motion",
                json!({ "free": { "force": { "z": "-t" } } }),
            ),
        ]
    };
    for (radius, height) in [(1e17, 1e17), (25.0, 1e30), (1e17, 0.0)] {
        plate_refused(
            &sphere(radius, height),
            "/surfaces/ball",
            &[
                "surface `ball` has coordinates up to ",
                "the contact cannot be resolved",
                "help: check the units",
            ],
        );
    }
    // Squares of lengths overflow.
    plate_refused(
        &sphere(1e300, 1e300),
        "/surfaces/ball",
        &["the patches have no usable size"],
    );
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &sphere(1e5, 1e5 + 1.5));
    let check = covact(folder.path(), &["check", "scene.json"]);
    assert_eq!(check.status.code(), Some(0), "{}", stderr(&check));
}

/// Pipes, devices and folders are not read, and files larger than the memory are not either.
#[cfg(unix)]
#[test]
fn what_is_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.igs");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let big = ["big.igs", "big.msh", "big.inp", "big.json"];
    for name in big {
        let file = std::fs::File::create(folder.path().join(name)).unwrap();
        file.set_len(10_000_000_000).unwrap();
    }
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("zero.msh")).unwrap();
    let cad = |file: &str| [("/surfaces/ball", json!({ "cad": { "file": file } }))];
    let mesh = |file: &str| [("/bodies/plate/mesh", json!({ "file": { "path": file } }))];
    let (at_cad, at_mesh) = ("/surfaces/ball/cad/file", "/bodies/plate/mesh/file/path");
    let too_large = "it has 10.0 GB, more than the ";
    for (changes, pointer, part) in [
        (
            cad("pipe.igs"),
            at_cad,
            "cannot read `./pipe.igs`: it is a pipe, not a file",
        ),
        (
            cad("/dev/zero"),
            at_cad,
            "cannot read `/dev/zero`: it is a device, not a file",
        ),
        (cad("."), at_cad, "`./.` is a folder, not a file"),
        (
            mesh("zero.msh"),
            at_mesh,
            "cannot read `./zero.msh`: it is a device, not a file",
        ),
        (cad("big.igs"), at_cad, too_large),
        (mesh("big.msh"), at_mesh, too_large),
        (mesh("big.inp"), at_mesh, too_large),
    ] {
        let (text, place) = text_and_place(&plate_with(&changes), pointer);
        std::fs::write(folder.path().join("scene.json"), text).unwrap();
        let output = covact(folder.path(), &["check", "scene.json"]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{message}");
        assert_parts(&message, &[&format!("error: scene.json:{place}: "), part]);
    }
    for (arguments, part) in [
        (
            ["check", "/dev/zero"],
            "cannot read the scene `/dev/zero`: it is a device, not a file",
        ),
        (
            ["check", "pipe.igs"],
            "cannot read the scene `pipe.igs`: it is a pipe, not a file",
        ),
        (
            ["check", "big.json"],
            "it is larger than 64 MB, too large for a scene",
        ),
        (["inspect", "/dev/zero"], "it is a device, not a file"),
        (["inspect", "pipe.igs"], "it is a pipe, not a file"),
        (["inspect", "big.igs"], too_large),
    ] {
        let output = covact(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
        assert_parts(&stderr(&output), &[part]);
    }
}

/// What `check` expects a run to take is what it takes, within a factor of two.
#[cfg(target_os = "linux")]
#[test]
fn the_estimate_holds() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes");
    for name in ["ball_on_plate", "strip_over_cylinder", "q18_on_h8"] {
        let text = std::fs::read_to_string(scenes.join(format!("{name}.json"))).unwrap();
        let mut scene: Value = serde_json::from_str(&text).unwrap();
        // The first step takes as much as the last.
        scene["solution"]["end_time"] = json!(1e-3);
        scene["solution"]["step"] = json!({ "initial": 1e-3, "max": 1e-3, "min": 1e-6 });
        if let Some(solution) = scene["solution"].as_object_mut() {
            solution.remove("stops");
        }
        let surfaces = scene.get_mut("surfaces").and_then(Value::as_object_mut);
        for surface in surfaces.into_iter().flatten() {
            if let Some(file) = surface.1.pointer_mut("/cad/file") {
                *file = json!(scenes.join(file.as_str().unwrap()));
            }
        }
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
        let check = covact(folder.path(), &["check", "scene.json", "--json"]);
        assert_eq!(check.status.code(), Some(0), "{}", stderr(&check));
        let found: Value = serde_json::from_str(&stdout(&check)).unwrap();
        let estimate = found["memory"]["total"].as_f64().unwrap() / 1e6;
        covact(
            folder.path(),
            &["run", "scene.json", "-o", "out", "--quiet"],
        );
        let summary = std::fs::read(folder.path().join("out/summary.json")).unwrap();
        let summary: Value = serde_json::from_slice(&summary).unwrap();
        let peak = summary["peak_memory_mb"].as_f64().unwrap();
        println!("{name}: estimated {estimate:.1} MB, measured {peak:.1} MB");
        assert!(
            (0.5..2.0).contains(&(estimate / peak)),
            "{name}: {estimate} MB, {peak} MB"
        );
    }
}
