//! Strings of an exchange structure (ISO 10303-21, clause 6.4.3) as text.

/// The text that the bytes between two quotes stand for.
///
/// `''` is a quote and `\\` a backslash; `\X\E9` is a character of ISO 8859-1, `\S\i` the one 128 places above,
/// `\X2\03B1\X0\` and `\X4\0001F600\X0\` characters of ISO 10646. Pages other than ISO 8859-1 (`\PB\` to `\PI\`) are not
/// known, their characters become U+FFFD. Bytes outside of ASCII, which the standard does not allow, are taken as UTF-8 or
/// else as ISO 8859-1; line ends inside of a string mean nothing.
pub fn decode(bytes: &[u8]) -> String {
    let mut out = String::with_capacity(bytes.len());
    let utf8 = std::str::from_utf8(bytes).is_ok();
    let mut raw = Vec::new();
    let mut known_page = true;
    let mut at = 0;
    let flush = |raw: &mut Vec<u8>, out: &mut String| {
        match utf8 {
            true => out.push_str(&String::from_utf8_lossy(raw)),
            false => out.extend(raw.iter().map(|&b| char::from(b))),
        }
        raw.clear();
    };
    while at < bytes.len() {
        let rest = &bytes[at..];
        let (length, found) = match rest {
            [b'\'', b'\'', ..] => (2, Some('\'')),
            [b'\\', b'\\', ..] => (2, Some('\\')),
            [b'\\', b'S', b'\\', b, ..] => {
                let high = char::from(b.wrapping_add(128));
                (
                    4,
                    Some(if known_page {
                        high
                    } else {
                        char::REPLACEMENT_CHARACTER
                    }),
                )
            }
            [b'\\', b'P', page @ b'A'..=b'I', b'\\', ..] => {
                known_page = *page == b'A';
                (4, None)
            }
            [b'\\', b'X', b'\\', h, l, ..] if h.is_ascii_hexdigit() && l.is_ascii_hexdigit() => {
                (5, Some(char::from((hex(*h) << 4 | hex(*l)) as u8)))
            }
            [b'\\', b'X', width @ (b'2' | b'4'), b'\\', ..] => {
                flush(&mut raw, &mut out);
                let digits = if *width == b'2' { 4 } else { 8 };
                at += 4 + wide(&rest[4..], digits, &mut out);
                continue;
            }
            [b'\r' | b'\n', ..] => (1, None),
            _ => {
                raw.push(rest[0]);
                at += 1;
                continue;
            }
        };
        flush(&mut raw, &mut out);
        out.extend(found);
        at += length;
    }
    flush(&mut raw, &mut out);
    out
}

fn hex(digit: u8) -> u32 {
    char::from(digit).to_digit(16).unwrap_or(0)
}

/// Characters of `digits` hexadecimal digits each up to `\X0\`; how many bytes they took.
fn wide(bytes: &[u8], digits: usize, out: &mut String) -> usize {
    let mut units: Vec<u16> = Vec::new();
    let mut at = 0;
    while let Some(code) = bytes.get(at..at + digits) {
        if !code.iter().all(u8::is_ascii_hexdigit) {
            break;
        }
        let code = code.iter().fold(0u32, |n, &d| n << 4 | hex(d));
        at += digits;
        match digits {
            // Writers use pairs of surrogates as well, which the standard leaves to \X4\.
            4 => units.push(code as u16),
            _ => out.push(char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)),
        }
    }
    let decoded = char::decode_utf16(units);
    out.extend(decoded.map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)));
    at + if bytes[at..].starts_with(b"\\X0\\") {
        4
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::decode;

    #[test]
    fn strings_of_the_standard() {
        assert_eq!(decode(b"it''s a \\\\ b"), "it's a \\ b");
        assert_eq!(decode(b"\\X\\E9t\\S\\i"), "\u{e9}t\u{e9}");
        assert_eq!(decode(b"\\X2\\03B103B2\\X0\\!"), "\u{3b1}\u{3b2}!");
        assert_eq!(decode(b"\\X4\\0001F600\\X0\\"), "\u{1f600}");
        assert_eq!(decode(b"\\X2\\D83DDE00\\X0\\"), "\u{1f600}");
        assert_eq!(decode(b"\\PE\\\\S\\a\\PA\\\\S\\i"), "\u{fffd}\u{e9}");
    }

    #[test]
    fn strings_as_they_are_written() {
        assert_eq!(decode("Deckel \u{fc}".as_bytes()), "Deckel \u{fc}");
        assert_eq!(decode(b"Deckel \xfc"), "Deckel \u{fc}");
        assert_eq!(decode(b"cut\nin two"), "cutin two");
        // Damaged directives stay as they are.
        assert_eq!(decode(b"\\X\\G1 \\X2\\03"), "\\X\\G1 03");
        assert_eq!(decode(b"\\"), "\\");
    }
}
