//! Reads numbers from a text or binary file alike, and knows where it is.
use crate::mesh::{MeshError, Position};
use std::path::Path;

/// How the data of a file are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    /// 4-byte integers, 8-byte sizes and reals; `swap`: of the other byte order.
    Binary {
        swap: bool,
    },
}

pub(super) struct Cursor<'a> {
    pub path: &'a Path,
    pub bytes: &'a [u8],
    pub pos: usize,
    pub encoding: Encoding,
}

impl<'a> Cursor<'a> {
    /// Position of a byte, as the user will look for it.
    pub fn position(&self, pos: usize) -> Position {
        match self.encoding {
            Encoding::Binary { .. } => Position::Byte(pos),
            Encoding::Text => {
                let before = &self.bytes[..pos.min(self.bytes.len())];
                let start = before
                    .iter()
                    .rposition(|&b| b == b'\n')
                    .map_or(0, |i| i + 1);
                Position::Text {
                    line: before.iter().filter(|&&b| b == b'\n').count() + 1,
                    column: before.len() - start + 1,
                }
            }
        }
    }

    pub fn syntax(&self, pos: usize, expected: &str, found: impl Into<String>) -> MeshError {
        MeshError::Syntax {
            path: self.path.to_path_buf(),
            at: self.position(pos),
            expected: expected.to_string(),
            found: found.into(),
        }
    }

    pub fn unsupported(&self, pos: usize, what: String, help: &str) -> MeshError {
        MeshError::Unsupported {
            path: self.path.to_path_buf(),
            at: self.position(pos),
            what,
            help: help.to_string(),
        }
    }

    fn skip_blanks(&mut self) {
        let rest = self.bytes.get(self.pos..).unwrap_or_default();
        self.pos += rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
    }

    /// Where the next number starts.
    pub fn mark(&mut self) -> usize {
        if self.encoding == Encoding::Text {
            self.skip_blanks();
        }
        self.pos
    }

    /// Only blanks are left.
    pub fn at_end(&mut self) -> bool {
        self.skip_blanks();
        self.pos >= self.bytes.len()
    }

    /// Next word, and where it starts.
    pub fn word(&mut self, expected: &str) -> Result<(&'a [u8], usize), MeshError> {
        if self.at_end() {
            return Err(self.syntax(self.bytes.len(), expected, "the end of the file"));
        }
        let start = self.pos;
        let rest = &self.bytes[start..];
        let length = rest
            .iter()
            .position(|b| b.is_ascii_whitespace())
            .unwrap_or(rest.len());
        self.pos += length;
        Ok((&rest[..length], start))
    }

    /// Rest of the current line without its end.
    pub fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.bytes.get(self.pos..).unwrap_or_default();
        let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.pos += (length + 1).min(rest.len());
        &rest[..length]
    }

    /// A number written as text.
    pub fn text_number<T: std::str::FromStr>(&mut self, expected: &str) -> Result<T, MeshError> {
        let (word, start) = self.word(expected)?;
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number.ok_or_else(|| self.syntax(start, expected, quoted(word)))
    }

    fn raw<const N: usize>(&mut self, expected: &str) -> Result<[u8; N], MeshError> {
        let chunk = self
            .bytes
            .get(self.pos..)
            .and_then(|rest| rest.first_chunk::<N>());
        let Some(chunk) = chunk else {
            return Err(self.syntax(self.bytes.len(), expected, "the end of the file"));
        };
        self.pos += N;
        let mut chunk = *chunk;
        if self.encoding == (Encoding::Binary { swap: true }) {
            chunk.reverse();
        }
        Ok(chunk)
    }

    /// A 4-byte integer.
    pub fn int(&mut self, expected: &str) -> Result<i32, MeshError> {
        match self.encoding {
            Encoding::Text => self.text_number(expected),
            Encoding::Binary { .. } => Ok(i32::from_le_bytes(self.raw(expected)?)),
        }
    }

    /// An 8-byte unsigned integer.
    pub fn size(&mut self, expected: &str) -> Result<u64, MeshError> {
        match self.encoding {
            Encoding::Text => self.text_number(expected),
            Encoding::Binary { .. } => Ok(u64::from_le_bytes(self.raw(expected)?)),
        }
    }

    /// A finite real.
    pub fn real(&mut self, expected: &str) -> Result<f64, MeshError> {
        let start = self.mark();
        let value = match self.encoding {
            Encoding::Text => self.text_number(expected)?,
            Encoding::Binary { .. } => f64::from_le_bytes(self.raw(expected)?),
        };
        if f64::is_finite(value) {
            Ok(value)
        } else {
            Err(self.syntax(start, expected, value.to_string()))
        }
    }

    /// How many things follow, each of at least `words` words (text) or `bytes` bytes (binary): more than the rest of
    /// the file can hold is refused, so that a broken count allocates nothing.
    pub fn count(&mut self, what: &str, words: u64, bytes: u64) -> Result<usize, MeshError> {
        let start = self.mark();
        let count = self.size(what)?;
        let each = match self.encoding {
            Encoding::Text => 2 * words,
            Encoding::Binary { .. } => bytes,
        };
        let rest = self.bytes.len() as u64 - self.pos as u64;
        let most = rest / each.max(1);
        if count > most {
            let expected = format!("{what} that the rest of the file can hold (at most {most})");
            return Err(self.syntax(start, &expected, count.to_string()));
        }
        Ok(count as usize)
    }
}

/// A word of the file for a message: readable and short.
pub(super) fn quoted(word: &[u8]) -> String {
    let text: String = String::from_utf8_lossy(word)
        .chars()
        .take(40)
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    format!("`{text}`")
}

impl Cursor<'_> {
    /// A real of 4 bytes where the file is binary.
    pub fn single(&mut self, expected: &str) -> Result<f64, MeshError> {
        if self.encoding == Encoding::Text {
            return self.real(expected);
        }
        let start = self.pos;
        let value = f64::from(f32::from_le_bytes(self.raw(expected)?));
        match value.is_finite() {
            true => Ok(value),
            false => Err(self.syntax(start, expected, value.to_string())),
        }
    }

    /// A whole number of 1, 2, 4 or 8 bytes where the file is binary.
    pub fn whole(&mut self, bytes: u8, signed: bool, expected: &str) -> Result<i64, MeshError> {
        if self.encoding == Encoding::Text {
            return self.text_number(expected);
        }
        Ok(match (bytes, signed) {
            (1, true) => i8::from_le_bytes(self.raw(expected)?).into(),
            (1, false) => u8::from_le_bytes(self.raw(expected)?).into(),
            (2, true) => i16::from_le_bytes(self.raw(expected)?).into(),
            (2, false) => u16::from_le_bytes(self.raw(expected)?).into(),
            (4, true) => i32::from_le_bytes(self.raw(expected)?).into(),
            (4, false) => u32::from_le_bytes(self.raw(expected)?).into(),
            (_, true) => i64::from_le_bytes(self.raw(expected)?),
            // Beyond what any count or number of a file can be.
            (_, false) => i64::try_from(u64::from_le_bytes(self.raw(expected)?)).unwrap_or(-1),
        })
    }
}
