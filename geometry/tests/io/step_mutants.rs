//! Damaged STEP files: never a panic, never without end, never a face less without a word.

use crate::mutate::{Random, damaged};
use covact_geometry::io::read_step;
use std::path::PathBuf;

fn files() -> Vec<Vec<u8>> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/step"));
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    paths.sort();
    let files = paths.iter().map(|p| std::fs::read(p).unwrap());
    files.filter(|f| f.len() < 20_000).collect()
}

#[test]
fn two_thousand_mutants() {
    let files = files();
    assert!(files.len() >= 8);
    let mut random = Random(20261122);
    let [mut failed, mut fewer, mut whole] = [0, 0, 0];
    for k in 0..2000 {
        let file = &files[k % files.len()];
        let damaged = damaged(file, &mut random);
        match read_step(&damaged, "file") {
            Err(error) => {
                failed += 1;
                let (line, column) = error.place().expect("an error without a place");
                let lines = damaged.iter().filter(|&&b| b == b'\n').count() + 1;
                assert!(line >= 1 && line <= lines && column >= 1, "{error}");
            }
            Ok(read) => {
                let text = String::from_utf8_lossy(&damaged).into_owned();
                // A face that is neither read nor named would be lost in silence.
                let faces = text.matches("ADVANCED_FACE(").count();
                let told = read.patches.len() + read.skipped.len() + read.notes.len();
                assert!(faces == 0 || told > 0, "{text}");
                match read.skipped.is_empty() && read.patches.len() >= faces {
                    true => whole += 1,
                    false => fewer += 1,
                }
            }
        }
    }
    // All three happen.
    assert!(
        failed > 300 && fewer > 100 && whole > 100,
        "{failed} {fewer} {whole}"
    );
}
