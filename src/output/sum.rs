//! A checksum: 64 bits that tell whether bytes are still the same. It finds accidents, not intent.

/// Sum of the bytes seen so far. Every step is one-to-one in the sum and in the word, so that a change within one word
/// always shows; other changes show but for a chance of about one in 2^64.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sum {
    sum: u64,
    /// Bytes that do not fill a word yet, and their number.
    rest: [u8; 8],
    length: u64,
}

impl Sum {
    pub fn new() -> Self {
        Sum {
            sum: 0x243f_6a88_85a3_08d3,
            rest: [0; 8],
            length: 0,
        }
    }

    /// The sum of `bytes`.
    pub fn of(bytes: &[u8]) -> u64 {
        let mut sum = Sum::new();
        sum.add(bytes);
        sum.value()
    }

    /// Goes on with `bytes`; where they are divided makes no difference.
    pub fn add(&mut self, mut bytes: &[u8]) {
        let open = (self.length % 8) as usize;
        self.length += bytes.len() as u64;
        if open > 0 {
            let take = bytes.len().min(8 - open);
            self.rest[open..open + take].copy_from_slice(&bytes[..take]);
            bytes = &bytes[take..];
            if open + take < 8 {
                return;
            }
            self.sum = step(self.sum, u64::from_le_bytes(self.rest));
        }
        let words = bytes.chunks_exact(8);
        let end = words.remainder();
        for word in words {
            let mut w = [0; 8];
            w.copy_from_slice(word);
            self.sum = step(self.sum, u64::from_le_bytes(w));
        }
        self.rest[..end.len()].copy_from_slice(end);
    }

    /// The sum of all bytes so far.
    pub fn value(&self) -> u64 {
        let mut rest = [0; 8];
        let open = (self.length % 8) as usize;
        rest[..open].copy_from_slice(&self.rest[..open]);
        step(step(self.sum, u64::from_le_bytes(rest)), self.length)
    }
}

/// The finalizer of splitmix64 (Steele, Lea, Flood 2014) without its second round, which spreads a bit over most others.
#[inline]
fn step(sum: u64, word: u64) -> u64 {
    let h = (sum ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    h ^ (h >> 29)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_add_up_and_every_bit_counts() {
        let bytes: Vec<u8> = (0..61u8).map(|i| i.wrapping_mul(37)).collect();
        let whole = Sum::of(&bytes);
        for at in 0..bytes.len() {
            let mut sum = Sum::new();
            sum.add(&bytes[..at]);
            sum.add(&bytes[at..]);
            assert_eq!(sum.value(), whole);
            assert_ne!(Sum::of(&bytes[..at]), whole);
            for bit in 0..8 {
                let mut other = bytes.clone();
                other[at] ^= 1 << bit;
                assert_ne!(Sum::of(&other), whole, "byte {at}, bit {bit}");
            }
        }
        // Zeros at the end count too.
        assert_ne!(Sum::of(&[1, 0]), Sum::of(&[1]));
    }
}
