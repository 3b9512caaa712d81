//! Numbers of a page: rounded, stored as differences, packed by deflate.
//!
//! A page unpacks a chunk by `web/unpack.js`. Whole numbers stand component by component; of each the differences from one
//! to the next, modulo the range of their bytes, and of these first all lowest bytes, then the next ones: neighbours
//! resemble each other, and such bytes pack well.
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;
use std::io::Write;

/// Value of a byte that stands for no number.
pub(super) const NONE: u8 = 255;

/// Where a chunk is in the bytes of a page.
pub(super) type Chunk = [usize; 2];

/// Chunks of a page, one behind the other.
#[derive(Debug, Default)]
pub(super) struct Pack {
    pub bytes: Vec<u8>,
}

impl Pack {
    /// Adds a chunk.
    pub fn add(&mut self, raw: &[u8]) -> Chunk {
        let start = self.bytes.len();
        let mut encoder = ZlibEncoder::new(&mut self.bytes, Compression::new(4));
        // Writing to memory does not fail.
        let _ = encoder.write_all(raw).and_then(|()| encoder.try_finish());
        drop(encoder);
        [start, self.bytes.len() - start]
    }
}

/// Numbers `components` to a point as differences of `bytes` bytes each.
pub(super) fn planes(out: &mut Vec<u8>, values: &[i64], components: usize, bytes: usize) {
    for c in 0..components {
        let of = || values.iter().skip(c).step_by(components);
        let before = std::iter::once(&0).chain(of());
        let differences: Vec<i64> = of().zip(before).map(|(b, a)| b.wrapping_sub(*a)).collect();
        for k in 0..bytes {
            out.extend(differences.iter().map(|d| (d >> (8 * k)) as u8));
        }
    }
}

/// Numbers between -`largest` and `largest` as whole ones of so many bytes.
pub(super) fn rounded(values: impl Iterator<Item = f64>, largest: f64, bytes: usize) -> Vec<i64> {
    let most = ((1i64 << (8 * bytes - 1)) - 1) as f64;
    let scale = if largest > 0.0 { most / largest } else { 0.0 };
    // NaN becomes zero; nothing passes the range.
    values
        .map(|v| (v * scale).round().clamp(-most, most) as i64)
        .collect()
}

/// Smallest and largest of a field in a step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Span(pub f32, pub f32);

/// A field in 255 levels between its smallest and its largest value; [`NONE`] where there is no number.
pub(super) fn levels(values: &[f64]) -> (Span, Vec<i64>) {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    let high = finite().fold(f64::NEG_INFINITY, f64::max);
    if low > high {
        let none = vec![NONE.into(); values.len()];
        return (Span(0.0, 0.0), none);
    }
    let scale = match high > low {
        true => f64::from(NONE - 1) / (high - low),
        false => 0.0,
    };
    let level = |v: &f64| match v.is_finite() {
        true => ((v - low) * scale).round() as i64,
        false => NONE.into(),
    };
    // Ends of the range of f32 are beyond what a page shows.
    let single = |v: f64| (v as f32).clamp(f32::MIN, f32::MAX);
    (
        Span(single(low), single(high)),
        values.iter().map(level).collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn differences_lead_back() {
        let values: Vec<i64> = vec![5, -7, 300, 2, -40_000, 0, 8_388_607, -8_388_607];
        let mut raw = Vec::new();
        planes(&mut raw, &values, 2, 3);
        let mut pack = Pack::default();
        pack.add(b"before");
        let [start, length] = pack.add(&raw);
        let mut back = Vec::new();
        ZlibDecoder::new(&pack.bytes[start..start + length])
            .read_to_end(&mut back)
            .unwrap();
        assert_eq!(back, raw);
        let n = values.len() / 2;
        for c in 0..2 {
            let mut sum = 0i64;
            for k in 0..n {
                let byte = |b: usize| i64::from(back[(c * 3 + b) * n + k]) << (8 * b);
                sum = (sum + byte(0) + byte(1) + byte(2)) & 0xff_ffff;
                let signed = if sum >> 23 == 1 { sum - (1 << 24) } else { sum };
                assert_eq!(signed, values[2 * k + c]);
            }
        }
    }

    #[test]
    fn fields_become_levels_and_gaps_in_them_stay() {
        let (Span(low, high), levels) = levels(&[1.0, f64::NAN, 3.0, 2.0]);
        assert_eq!((low, high), (1.0, 3.0));
        assert_eq!(levels, [0, 255, 254, 127]);
        assert_eq!(super::levels(&[f64::NAN]).1, [255]);
        assert_eq!(super::levels(&[4.0, 4.0]), (Span(4.0, 4.0), vec![0, 0]));
    }

    #[test]
    fn coordinates_are_rounded_to_their_bytes() {
        assert_eq!(
            rounded([1.0, -1.0, 0.5, f64::NAN].into_iter(), 1.0, 2),
            [32767, -32767, 16384, 0]
        );
        assert_eq!(rounded([0.0].into_iter(), 0.0, 2), [0]);
    }
}
