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

/// The bytes of an array in base64 behind its length, as the serialiser writes it. None where the text is not such an array.
pub(super) fn array_of(text: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = STANDARD.decode(text.trim_ascii()).ok()?;
    let (length, data) = bytes.split_at_checked(LENGTH)?;
    if u64::from_le_bytes(length.try_into().ok()?) != data.len() as u64 {
        return None;
    }
    bytes.drain(..LENGTH);
    Some(bytes)
}

/// Bytes of an array in base64 behind its length.
pub(super) fn inline_size(data: &[u8]) -> usize {
    4 * (LENGTH + data.len()).div_ceil(3)
}

/// An array in compressed blocks: their number, their length and that of a shorter last one before compression, and their lengths
/// after it, then the blocks (format: "VTK file formats", VTK user's guide).
pub(super) fn compressed(data: &[u8], level: Compression) -> Option<Vec<u8>> {
    let blocks = data.chunks(BLOCK);
    let head = [blocks.len(), BLOCK, data.len() % BLOCK];
    let start = LENGTH * (head.len() + blocks.len());
    let mut out: Vec<u8> = head.into_iter().flat_map(number).collect();
    out.reserve(start + data.len() / 2);
    out.resize(start, 0);
    for (k, block) in blocks.enumerate() {
        let before = out.len();
        let mut encoder = ZlibEncoder::new(&mut out, level);
        encoder.write_all(block).ok()?;
        encoder.finish().ok()?;
        let size = number(out.len() - before);
        out[LENGTH * (head.len() + k)..][..LENGTH].copy_from_slice(&size);
    }
    Some(out)
}

fn number(n: usize) -> [u8; LENGTH] {
    (n as u64).to_le_bytes()
}

/// The array at the start of `data`, in compressed blocks: what tells of the blocks, and the blocks. None where it is cut off.
pub(super) fn first_array(data: &[u8]) -> Option<(&[u8], &[u8])> {
    let at = |k: usize| {
        let bytes = data.get(LENGTH * k..)?.first_chunk()?;
        usize::try_from(u64::from_le_bytes(*bytes)).ok()
    };
    let count = at(0)?;
    if count > data.len() {
        return None;
    }
    let mut length = 0usize;
    for k in 0..count {
        length = length.checked_add(at(3 + k)?)?;
    }
    let (head, rest) = data.split_at_checked(LENGTH * (3 + count))?;
    Some((head, rest.get(..length)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn numbers_of_blocks_that_are_too_large() {
        for numbers in [[u64::MAX, 1, 1, 1], [2, 1, 1, u64::MAX]] {
            let data: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
            assert_eq!(first_array(&data), None);
        }
    }

    #[test]
    fn blocks_lead_back() {
        for n in [0, 1, 1000, BLOCK, 2 * BLOCK + 5] {
            let data: Vec<u8> = (0..n).map(|k| (k / 7 % 251) as u8).collect();
            let text = STANDARD.encode([&(n as u64).to_le_bytes()[..], &data].concat());
            assert_eq!(text.len(), inline_size(&data));
            let array = array_of(text.as_bytes()).unwrap();
            let mut packed = compressed(&array, Compression::fast()).unwrap();
            let length = packed.len();
            packed.extend_from_slice(b"what follows");
            let count = n.div_ceil(BLOCK);
            let (head, body) = first_array(&packed).unwrap();
            assert_eq!(
                (head.len(), head.len() + body.len()),
                (8 * (3 + count), length)
            );
            assert_eq!(first_array(&packed[..length - 1]), None);
            let number =
                |k: usize| u64::from_le_bytes(head[8 * k..8 * k + 8].try_into().unwrap()) as usize;
            assert_eq!([number(0), number(1), number(2)], [count, BLOCK, n % BLOCK]);
            let (mut at, mut back) = (0, Vec::new());
            for k in 0..count {
                let block = &body[at..at + number(3 + k)];
                at += block.len();
                ZlibDecoder::new(block).read_to_end(&mut back).unwrap();
            }
            assert!(back == data && at == body.len(), "{n}");
        }
        assert_eq!(array_of(b"no array"), None);
        assert_eq!(array_of(STANDARD.encode([9u8; 12]).as_bytes()), None);
    }
}
