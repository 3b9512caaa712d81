//! Files that would mislead a trusting reader: chains and cycles of entities, deep nesting, paths to other files, and what
//! is no file at all. Every one is answered with a message, quickly, on a small stack.

use crate::builder::{Builder, Entity};
use covact_geometry::io::{CadError, read_iges, read_json, read_path, read_within};
use std::time::{Duration, Instant};

/// Does the work on a stack of 512 kB, a quarter of what threads usually have, and within ten seconds.
fn small<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    let start = Instant::now();
    let thread = std::thread::Builder::new().stack_size(512 << 10);
    let out = thread.spawn(work).unwrap().join().unwrap();
    assert!(
        start.elapsed() < Duration::from_secs(10),
        "{:?}",
        start.elapsed()
    );
    out
}

/// A surface of revolution of a curve about the z axis, the curve being `file`'s next entity but one.
fn revolve(file: &mut Builder, curve: u32) {
    let axis = file.add(110, "0.,0.,0.,0.,0.,1.");
    file.add(120, &format!("{axis},{curve},0.,1."));
}

/// What the reader says of the file: the reasons of all it skipped, or its error.
fn said(file: &Builder) -> String {
    let text = file.text();
    small(move || match read_iges(text.as_bytes(), "chain.igs") {
        Ok(file) => {
            let reasons = file.skipped.iter().map(|s| s.reason.clone());
            format!(
                "{} patches; {}",
                file.patches.len(),
                reasons.collect::<Vec<_>>().join("; ")
            )
        }
        Err(e) => e.to_string(),
    })
}

#[test]
fn chains_of_composite_curves_end() {
    // Each composite curve holds the one before: 5000 deep.
    let mut file = Builder::new();
    let mut curve = file.add(110, "1.,0.,0.,1.,0.,1.");
    for _ in 0..5000 {
        curve = file.add(102, &format!("1,{curve}"));
    }
    revolve(&mut file, curve);
    let text = said(&file);
    assert!(
        text.starts_with("0 patches") && text.contains("more than 16 deep"),
        "{text}"
    );
    // One that holds itself, and two that hold each other.
    for pointers in [["1", "1"], ["3", "1"]] {
        let mut file = Builder::new();
        for pointer in pointers {
            file.add(102, &format!("1,{pointer}"));
        }
        revolve(&mut file, 1);
        let said = said(&file);
        println!("{said}");
        assert!(!said.starts_with("1 patches"), "{said}");
    }
}

#[test]
fn chains_of_offsets_matrices_and_groups_end() {
    // Offset curves of offset curves, also of themselves.
    let mut file = Builder::new();
    let mut curve = file.add(110, "1.,0.,0.,1.,0.,1.");
    for _ in 0..2000 {
        curve = file.add(
            130,
            &format!("{curve},1,0,0,0,.001,0.,0.,0.,0.,1.,0.,0.,1."),
        );
    }
    revolve(&mut file, curve);
    let text = said(&file);
    assert!(
        text.starts_with("0 patches") && text.contains("more than 16 deep"),
        "{text}"
    );
    let mut file = Builder::new();
    file.add(130, "1,1,0,0,0,.001,0.,0.,0.,0.,1.,0.,0.,1.");
    revolve(&mut file, 1);
    let text = said(&file);
    assert!(!text.starts_with("1 patches"), "{text}");
    // Matrices placed by matrices, the last by the first.
    let mut file = Builder::new();
    let count = 5000;
    for k in 0..count {
        let next = 2 * ((k + 1) % count) + 1;
        file.entity(Entity {
            matrix: next,
            ..Entity::new(124, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0.")
        });
    }
    let curve = file.entity(Entity {
        matrix: 1,
        ..Entity::new(110, "1.,0.,0.,1.,0.,1.")
    });
    revolve(&mut file, curve);
    let text = said(&file);
    println!("{text}");
    assert!(!text.starts_with("1 patches"), "{text}");
    // Groups in groups, and in a circle.
    for last in [0, 1] {
        let mut file = Builder::new();
        let count = 5000;
        for k in 0..count {
            let next = if k + 1 < count { 2 * (k + 1) + 1 } else { last };
            if next > 0 {
                file.entity(Entity {
                    form: 7,
                    ..Entity::new(402, &format!("1,{next}"))
                });
            }
        }
        let line = file.add(110, "1.,0.,0.,1.,0.,1.");
        revolve(&mut file, line);
        assert!(!said(&file).is_empty());
    }
}

#[test]
fn paths_in_a_file_are_not_opened() {
    // External references (416): by file and entity, by file alone.
    let folder = std::env::temp_dir().join(format!("covact_untrusted_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let other = folder.join("other.igs");
    let mut file = Builder::new();
    let line = file.add(110, "1.,0.,0.,1.,0.,1.");
    revolve(&mut file, line);
    std::fs::write(&other, file.text()).unwrap();
    let path = other.display().to_string();
    let mut file = Builder::new();
    for form in [0, 1, 2] {
        file.entity(Entity {
            form,
            ..Entity::new(416, &format!("{}H{path},1HA", path.len()))
        });
    }
    let axis = file.add(110, "0.,0.,0.,0.,0.,1.");
    file.add(120, &format!("{axis},1,0.,1."));
    let read = read_iges(file.text().as_bytes(), "references.igs").unwrap();
    assert_eq!(read.patches.len(), 0);
    let reasons: Vec<&str> = read.skipped.iter().map(|s| s.reason.as_str()).collect();
    println!("{reasons:?}");
    assert!(reasons.iter().any(|r| r.contains("416")), "{reasons:?}");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn deep_json_is_refused() {
    for (open, close) in [("[", "]"), ("{\"a\":", "}")] {
        for key in ["breps", "shape", "covact_geometry", "other"] {
            let text = format!(
                "{{\"{key}\": {}1{}}}",
                open.repeat(200_000),
                close.repeat(200_000)
            );
            let error = small(move || read_json(text.as_bytes(), "deep.json").unwrap_err());
            assert!(error.to_string().len() < 500);
        }
    }
}

#[test]
#[cfg(unix)]
fn what_is_no_file_is_not_read() {
    let folder = std::env::temp_dir().join(format!("covact_no_file_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let pipe = folder.join("pipe.igs");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    let mut cases = vec![("/dev/zero".into(), "it is a device, not a file")];
    cases.push((folder.clone(), "it is a folder"));
    if made.is_ok_and(|s| s.success()) {
        cases.push((pipe, "it is a pipe, not a file"));
    }
    for (path, expected) in cases {
        let error = small(move || read_path(&path).unwrap_err());
        assert!(matches!(error, CadError::Read { .. }));
        assert!(error.to_string().ends_with(expected), "{error}");
    }
    // Ten gigabytes that take no room on the disk.
    let sparse = folder.join("sparse.igs");
    std::fs::File::create(&sparse)
        .unwrap()
        .set_len(10_000_000_000)
        .unwrap();
    let error = small({
        let sparse = sparse.clone();
        move || read_path(&sparse).unwrap_err()
    });
    assert!(
        error.to_string().contains("it has 10.0 GB, more than the "),
        "{error}"
    );
    let error = read_within(&sparse, 1000).unwrap_err();
    assert_eq!(
        error.to_string(),
        "it has 10.0 GB, more than the 1 kB that can be read here"
    );
    std::fs::write(&sparse, "12345").unwrap();
    assert_eq!(read_within(&sparse, 5).unwrap(), b"12345");
    std::fs::remove_dir_all(&folder).unwrap();
}
