//! Arrays of a serialised grid, compressed the way VTK does it.
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// Attribute of the file's root that tells of the compression.
pub(super) const COMPRESSOR: &str = " compressor=\"vtkZLibDataCompressor\"";
/// Bytes of a block before compression.
const BLOCK: usize = 1 << 20;
/// Bytes of the length that stands in front of an array.
const LENGTH: usize = 8;

/// An array in base64 behind its length, as the serialiser writes it, in compressed blocks: in base64 their number, their
/// length and that of a shorter last one before compression, and their lengths after it, then in base64 the blocks (format:
/// "VTK file formats", VTK user's guide). None where the text is not such an array.
pub(super) fn packed(text: &[u8]) -> Option<String> {
    let bytes = STANDARD.decode(text.trim_ascii()).ok()?;
    let (length, data) = bytes.split_at_checked(LENGTH)?;
    if u64::from_le_bytes(length.try_into().ok()?) != data.len() as u64 {
        return None;
    }
    compressed(data)
}

/// An array in compressed blocks, as [`packed`] leaves it.
pub(super) fn compressed(data: &[u8]) -> Option<String> {
    let blocks = data.chunks(BLOCK);
    let mut head = vec![blocks.len(), BLOCK, data.len() % BLOCK];
    let mut body = Vec::with_capacity(data.len() / 2);
    for block in blocks {
        let before = body.len();
        let mut encoder = ZlibEncoder::new(&mut body, Compression::fast());
        encoder.write_all(block).ok()?;
        encoder.finish().ok()?;
        head.push(body.len() - before);
    }
    let head: Vec<u8> = head
        .iter()
        .flat_map(|n| (*n as u64).to_le_bytes())
        .collect();
    let mut out = STANDARD.encode(head);
    STANDARD.encode_string(body, &mut out);
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn blocks_lead_back() {
        for n in [0, 1, 1000, BLOCK, 2 * BLOCK + 5] {
            let data: Vec<u8> = (0..n).map(|k| (k / 7 % 251) as u8).collect();
            let text = STANDARD.encode([&(n as u64).to_le_bytes()[..], &data].concat());
            let packed = packed(text.as_bytes()).unwrap();
            let count = n.div_ceil(BLOCK);
            let head = 4 * ((3 + count) * 8).div_ceil(3);
            let numbers = STANDARD.decode(&packed[..head]).unwrap();
            let number = |k: usize| {
                u64::from_le_bytes(numbers[8 * k..8 * k + 8].try_into().unwrap()) as usize
            };
            assert_eq!([number(0), number(1), number(2)], [count, BLOCK, n % BLOCK]);
            let body = STANDARD.decode(&packed[head..]).unwrap();
            let (mut at, mut back) = (0, Vec::new());
            for k in 0..count {
                let block = &body[at..at + number(3 + k)];
                at += block.len();
                ZlibDecoder::new(block).read_to_end(&mut back).unwrap();
            }
            assert!(back == data && at == body.len(), "{n}");
        }
        assert_eq!(packed(b"no array"), None);
        assert_eq!(packed(STANDARD.encode([9u8; 12]).as_bytes()), None);
    }
}
