//! Damaged files: an error with its place, never a panic, never a surface too few without a word.

use crate::samples::{other_files, own_files};
use covact_geometry::io::{CadError, read_iges, read_json, read_path};
use std::path::{Path, PathBuf};

fn read(bytes: &[u8], path: &Path) -> Result<covact_geometry::io::CadFile, CadError> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("json") => read_json(bytes, "file"),
        _ => read_iges(bytes, "file"),
    }
}

fn cut_everywhere(path: &PathBuf, step: usize) {
    let bytes = std::fs::read(path).unwrap();
    // A missing line end alone is no damage.
    let whole = bytes.trim_ascii_end().len();
    for end in (0..whole).step_by(step) {
        let error = read(&bytes[..end], path).expect_err("a truncated file was accepted");
        let (line, column) = error.place().expect("an error without a place");
        assert!(line >= 1 && column >= 1, "{error}");
        let lines = bytes[..end].iter().filter(|&&b| b == b'\n').count() + 1;
        assert!(line <= lines, "{error}: line {line} of {lines}");
    }
}

#[test]
fn truncated_own_samples() {
    for path in own_files() {
        cut_everywhere(&path, 100);
    }
}

#[test]
fn truncated_samples_of_other_writers() {
    for path in other_files() {
        // Large files less often: a prime number of bytes, so that every column is met.
        let size = std::fs::metadata(&path).unwrap().len() as usize;
        cut_everywhere(&path, if size < 100_000 { 100 } else { (size / 97) | 1 });
    }
}

/// Bytes overwritten in pseudo-random places by characters that mean something in these formats.
#[test]
fn overwritten_bytes_never_panic() {
    let mut state = 12345u64;
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as usize % below
    };
    let signs = b"0123456789-+.,;HDE SGDPT\xff\xe9{}[]\"\n";
    let mut failed = 0;
    for path in own_files() {
        let bytes = std::fs::read(&path).unwrap();
        if bytes.len() > 20_000 {
            continue;
        }
        for _ in 0..150 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + random(3) {
                let at = random(damaged.len());
                damaged[at] = signs[random(signs.len())];
            }
            failed += usize::from(read(&damaged, &path).is_err());
        }
    }
    // Most of the damage must be noticed.
    assert!(failed > 500, "{failed}");
}

fn error(change: impl Fn(&mut Vec<String>)) -> String {
    let path = crate::support::assets().join("cad/bicubic_patch_faces.igs");
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    change(&mut lines);
    read_iges(lines.join("\n").as_bytes(), "part.igs")
        .unwrap_err()
        .to_string()
}

/// Line 11 is the first of the 128: `128,11,9,3,3,0,0,1,0,0,0.,0.,...`.
#[test]
fn messages_say_where_what_was_expected_and_what_is_there() {
    let replace = |line: usize, from: &str, to: &str| {
        error(|lines| {
            assert!(lines[line - 1].contains(from), "{}", lines[line - 1]);
            lines[line - 1] = lines[line - 1].replacen(from, to, 1);
        })
    };
    assert_eq!(
        replace(12, "0.329604093", "0.3296x4093"),
        "part.igs:12:1: expected a knot of the first direction (a real number), found \"0.3296x4093\""
    );
    assert_eq!(
        replace(11, "128,11,9,", "128,99,9,"),
        "part.igs:88:48: expected 4132 values for 100 x 10 control points of degree 3 x 3, \
         found the end of the data after 524 values"
    );
    // A count that no file could fill must not be allocated.
    assert_eq!(
        replace(11, "128,11,9,3,3,0,0,1,0,0,", "128,99999999,9,3,3,0,0,"),
        "part.igs:11:5: expected an upper index K1 that the 521 values of this entity can fill, \
         found \"99999999\""
    );
    assert_eq!(
        replace(10, "144,3,", "144,9,"),
        "part.igs:10:5: expected the surface of a trimmed surface (144): an odd directory number \
         from 1 to 4, found 9"
    );
    assert_eq!(
        replace(8, "       2 ", "      99 "),
        "part.igs:8:9: expected the sequence number of parameter data, 1 to 79, found \"99\""
    );
    assert_eq!(
        replace(20, "P0000011", "P0000012"),
        "part.igs:20:74: expected sequence number P11, found \"0000012\""
    );
    assert_eq!(
        replace(4, "2,2HMM", "3,2HXX"),
        "part.igs:4:7: expected the name of a length unit (MM, IN, M, ...), as the units flag is 3, \
         found \"XX\""
    );
    assert_eq!(
        error(|lines| lines.truncate(50)),
        "part.igs:50:81: expected the terminate record T (the file is cut off), found the end of the file"
    );
    assert_eq!(
        error(|lines| {
            lines.remove(40);
        }),
        "part.igs:41:74: expected sequence number P32, found \"0000033\""
    );
}

#[test]
fn other_kinds_of_files_are_named() {
    let dir = std::env::temp_dir().join(format!("covact-io-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    for (text, found) in [
        ("solid part\n facet normal 0 0 1\n", "an STL file"),
        ("  \n", "an empty file"),
        ("a\0b", "binary data"),
    ] {
        let path = dir.join("part.igs");
        std::fs::write(&path, text).unwrap();
        let message = read_path(&path).unwrap_err().to_string();
        assert!(message.ends_with(&format!("found {found}")), "{message}");
    }
    std::fs::remove_dir_all(&dir).unwrap();
    let error = read_path(&dir.join("missing.igs")).unwrap_err();
    assert!(matches!(error, CadError::Read { .. }), "{error}");
}
