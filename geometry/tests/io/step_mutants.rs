//! Damaged STEP files: never a panic, never without end, never a face less without a word.

use covact_geometry::io::read_step;
use std::path::PathBuf;

/// Pseudo-random numbers.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % n
    }
}

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

/// A file with one of several kinds of damage.
fn damaged(file: &[u8], random: &mut Random) -> Vec<u8> {
    let mut out = file.to_vec();
    match random.below(5) {
        0 => {
            let signs = b"0123456789-+.,;'#()$*EHT/\\ \n\xff";
            for _ in 0..1 + random.below(4) {
                let at = random.below(out.len());
                out[at] = signs[random.below(signs.len())];
            }
        }
        1 => out.truncate(random.below(file.len())),
        // One reference for another.
        2 => {
            let starts: Vec<usize> = (0..file.len()).filter(|&k| file[k] == b'#').collect();
            let name = |k: usize| {
                let digits = file[k + 1..]
                    .iter()
                    .take_while(|b| b.is_ascii_digit())
                    .count();
                k..k + 1 + digits
            };
            let (a, b) = (
                name(starts[random.below(starts.len())]),
                name(starts[random.below(starts.len())]),
            );
            out.splice(a, file[b].iter().copied());
        }
        // A number of another size.
        3 => {
            let digits: Vec<usize> = (0..file.len())
                .filter(|&k| file[k].is_ascii_digit())
                .collect();
            let at = digits[random.below(digits.len())];
            let numbers = ["0.", "-1.", "1.E30", "1.E-30", "99999999", "0", "3"];
            let number = numbers[random.below(numbers.len())];
            out.splice(at..=at, number.bytes());
        }
        // A line less or twice.
        _ => {
            let lines: Vec<&[u8]> = file.split_inclusive(|&b| b == b'\n').collect();
            let at = random.below(lines.len());
            let copies = 2 * random.below(2);
            let one = |(k, line): (usize, &&[u8])| line.repeat(if k == at { copies } else { 1 });
            out = lines.iter().enumerate().flat_map(one).collect();
        }
    }
    out
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
