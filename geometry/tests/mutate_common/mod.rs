//! Damaged files for tests.

/// Pseudo-random numbers.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % n
    }
}

/// A file with one of several kinds of damage: signs, an end, a reference of STEP, a number, a line.
pub fn damaged(file: &[u8], random: &mut Random) -> Vec<u8> {
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
            if starts.is_empty() {
                return out;
            }
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
