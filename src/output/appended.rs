//! Files whose arrays stand behind the tree, as they are (VTK's "raw" appended data).
//!
//! vtkio writes arrays inline in base64 and reads no raw ones: [`Appended`] moves them behind the tree, and [`inlined`] takes them
//! back before it reads a file.
use super::packed::{array_of, compressed, first_array, inline_size};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use std::borrow::Cow;

/// What stands in front of the arrays; the offset of the first is 0.
const START: &[u8] = b"<AppendedData encoding=\"raw\">_";
/// What stands behind them. meshio needs a line of its own.
const END: &[u8] = b"\n</AppendedData></VTKFile>\n";
const ARRAY: &str = "<DataArray ";
const ARRAY_END: &str = "</DataArray>";
const INLINE: &str = " format=\"binary\"";
const APPENDED: &str = " format=\"appended\"";

/// A file in two parts, of which the second changes from step to step.
#[derive(Debug)]
pub(super) struct Appended {
    /// All up to the last array.
    pub head: Vec<u8>,
    /// The last array, in compressed blocks.
    pub last: Vec<u8>,
}

impl Appended {
    /// The file of a serialised one with arrays inline in base64. `tag` changes tags, and the array with the name `last` comes
    /// after the others.
    pub fn new(bytes: &[u8], last: Option<&str>, tag: impl Fn(&str) -> String) -> Self {
        let name = last.map(|name| format!(" Name=\"{name}\""));
        let (mut head, mut body, mut contents) = (Vec::new(), Body::default(), Vec::new());
        // Where the offset of the last array belongs in the head.
        let mut open = None;
        let mut rest = bytes;
        // Between tags there is base64, which has no `<`.
        while let Some((text, own)) = next_tag(&mut rest) {
            if own == b"</VTKFile>" {
                break;
            }
            head.extend_from_slice(text);
            let Ok(own) = std::str::from_utf8(own) else {
                head.extend_from_slice(own);
                continue;
            };
            let own = tag(own);
            let mut ahead = rest;
            let array = match own.starts_with(ARRAY) && own.contains(INLINE) {
                true => next_tag(&mut ahead).and_then(|(text, _)| array_of(text)),
                false => None,
            };
            let Some(array) = array else {
                head.extend_from_slice(own.as_bytes());
                continue;
            };
            // The tag that ends the array is read, too.
            rest = ahead;
            let is_last = open.is_none() && name.as_ref().is_some_and(|name| own.contains(name));
            let own = own.replace(INLINE, APPENDED);
            head.extend_from_slice(own.trim_end_matches('>').as_bytes());
            if is_last {
                contents = compressed(&array, Compression::fast()).unwrap_or_default();
                open = Some(head.len());
            } else {
                head.extend_from_slice(offset(body.bytes.len()).as_bytes());
                body.push(&array);
            }
            head.extend_from_slice(b"/>");
        }
        if let Some(at) = open {
            head.splice(at..at, offset(body.bytes.len()).into_bytes());
        }
        head.extend_from_slice(START);
        head.extend(body.bytes);
        Appended {
            head,
            last: contents,
        }
    }

    pub fn file(&self) -> Vec<u8> {
        self.file_with(&self.last)
    }

    /// The file with another last array.
    pub fn file_with(&self, last: &[u8]) -> Vec<u8> {
        [&self.head, last, END].concat()
    }
}

/// Arrays one after the other.
///
/// meshio (5.3) takes them inline, one by one: it finds the tag of the next by its offset, and writes there where the array starts in
/// its own text, in base64. Where an offset equals one that was written before, it finds the tag of another array, whose numbers it
/// then reads for this one. One file in two hundred would have such an offset.
#[derive(Debug, Default)]
struct Body {
    bytes: Vec<u8>,
    /// Where arrays start in meshio's text, and where that ends.
    starts: Vec<usize>,
    end: usize,
}

impl Body {
    /// Appends an array, compressed otherwise where the offset of the next one would be taken for another.
    fn push(&mut self, array: &[u8]) {
        self.starts.push(self.end);
        self.end += inline_size(array);
        let levels = [1, 2, 3, 4, 5, 6, 7, 8, 9, 0].map(Compression::new);
        let mut each = levels.iter().filter_map(|level| compressed(array, *level));
        let clear = |packed: &Vec<u8>| !self.starts.contains(&(self.bytes.len() + packed.len()));
        let first = each.next().unwrap_or_default();
        let found = match clear(&first) {
            true => None,
            false => each.find(clear),
        };
        self.bytes.extend(found.unwrap_or(first));
    }
}

fn offset(n: usize) -> String {
    format!(" offset=\"{n}\"")
}

/// The text up to the next tag, and that tag; `rest` is what follows.
fn next_tag<'a>(rest: &mut &'a [u8]) -> Option<(&'a [u8], &'a [u8])> {
    let start = rest.iter().position(|&b| b == b'<')?;
    let (text, from) = rest.split_at(start);
    let length = from.iter().position(|&b| b == b'>')? + 1;
    let (tag, after) = from.split_at(length);
    *rest = after;
    Some((text, tag))
}

/// A file as vtkio reads it, its arrays inline in base64; a file without appended arrays as it is. None where an array is cut
/// off.
pub fn inlined(bytes: &[u8]) -> Option<Cow<'_, [u8]>> {
    let Some(start) = bytes.windows(START.len()).position(|w| w == START) else {
        return Some(Cow::Borrowed(bytes));
    };
    let data = &bytes[start + START.len()..];
    let mut out = Vec::with_capacity(2 * bytes.len());
    let mut rest = &bytes[..start];
    while let Some((text, tag)) = next_tag(&mut rest) {
        out.extend_from_slice(text);
        let own = std::str::from_utf8(tag).ok()?;
        if !own.starts_with(ARRAY) || !own.contains(APPENDED) {
            out.extend_from_slice(tag);
            continue;
        }
        let (before, after) = own.split_once(" offset=\"")?;
        let (at, after) = after.split_once('"')?;
        let (head, blocks) = first_array(data.get(at.parse::<usize>().ok()?..)?)?;
        let mut array = before.replace(APPENDED, INLINE);
        array.push_str(after.strip_suffix("/>")?);
        array.push('>');
        STANDARD.encode_string(head, &mut array);
        STANDARD.encode_string(blocks, &mut array);
        array.push_str(ARRAY_END);
        out.extend_from_slice(array.as_bytes());
    }
    out.extend_from_slice(rest);
    out.extend_from_slice(b"</VTKFile>");
    Some(Cow::Owned(out))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::packed::compressed;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    /// A file of two arrays that vtkio may have written.
    fn file(numbers: [&[u8]; 2]) -> String {
        let text = |of: &[u8]| STANDARD.encode([&(of.len() as u64).to_le_bytes()[..], of].concat());
        let [first, second] = numbers.map(text);
        format!(
            "<VTKFile><DataArray Name=\"u\" format=\"binary\" more=\"\">{first}</DataArray>\
             <DataArray Name=\"v\" format=\"binary\">{second}</DataArray></VTKFile>"
        )
    }

    /// Of two arrays the second would stand where the first starts in meshio's text, or the third where the second does: they do not.
    #[test]
    fn no_offset_is_one_that_meshio_has_given_before() {
        let mut moved = 0;
        // Noise, which does not get shorter, in front of what does.
        let noise = |n: usize| -> Vec<u8> {
            let step = |s: &mut u32| {
                *s = s.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                Some((*s >> 24) as u8)
            };
            std::iter::repeat_n((), n)
                .scan(n as u32, |s, ()| step(s))
                .collect()
        };
        for n in 100..400 {
            let arrays = [noise(n), vec![7; 50], noise(n / 3 + 1), noise(5)];
            let mut body = Body::default();
            let (mut offsets, mut plain) = (Vec::new(), 0);
            for array in &arrays {
                offsets.push(body.bytes.len());
                body.push(array);
                plain += compressed(array, Compression::fast()).unwrap().len();
            }
            moved += usize::from(plain != body.bytes.len());
            for (k, at) in offsets.iter().enumerate().skip(1) {
                assert!(!body.starts[..k].contains(at), "{n}: {at}");
            }
            for (at, array) in offsets.iter().zip(&arrays) {
                let (_, blocks) = first_array(&body.bytes[*at..]).unwrap();
                let mut back = Vec::new();
                ZlibDecoder::new(blocks).read_to_end(&mut back).unwrap();
                assert!(back == *array, "{n}");
            }
        }
        assert!(moved > 0);
    }

    /// Arrays stand behind the tree, the one that is named after the others; they lead back, whatever bytes they hold.
    #[test]
    fn arrays_are_moved_and_taken_back() {
        let all: Vec<u8> = (0..=255).cycle().take(3000).collect();
        let other = b"</AppendedData><DataArray >\n_";
        let text = file([&all, other]);
        let parts = Appended::new(text.as_bytes(), Some("u"), |tag| {
            tag.replace("more=", "less=")
        });
        let [u, v] = [&all[..], other].map(|a| compressed(a, Compression::fast()).unwrap());
        let expected = format!(
            "<VTKFile><DataArray Name=\"u\" format=\"appended\" less=\"\" offset=\"{}\"/>\
             <DataArray Name=\"v\" format=\"appended\" offset=\"0\"/><AppendedData encoding=\"raw\">_",
            v.len()
        );
        let end = b"\n</AppendedData></VTKFile>\n";
        assert_eq!(parts.file(), [expected.as_bytes(), &v, &u, end].concat());
        let back = inlined(&parts.file()).unwrap().into_owned();
        let inline = |of: &[u8]| {
            let (head, blocks) = first_array(of).unwrap();
            STANDARD.encode(head) + &STANDARD.encode(blocks)
        };
        let expected = format!(
            "<VTKFile><DataArray Name=\"u\" format=\"binary\" less=\"\">{}</DataArray>\
             <DataArray Name=\"v\" format=\"binary\">{}</DataArray></VTKFile>",
            inline(&u),
            inline(&v)
        );
        assert_eq!(String::from_utf8(back).unwrap(), expected);
        // Cut off within its arrays, a file is refused; one without any is left as it is.
        let whole = parts.file();
        let cut = &whole[..whole.len() - END.len() - 1];
        assert!(inlined(cut).is_none());
        assert_eq!(inlined(text.as_bytes()).unwrap(), text.as_bytes());
    }
}
