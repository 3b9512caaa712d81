//! Free-format values of the global section and of parameter data, each with its place in the file.

use super::super::error::{Fail, show};
use super::number;
use super::records::Record;

/// Characters that separate values and end a list of them.
#[derive(Debug, Clone, Copy)]
pub struct Delimiters {
    pub parameter: u8,
    pub record: u8,
}

#[derive(Clone, Copy)]
struct Token {
    /// Where it begins, the count of a string included.
    at: usize,
    start: usize,
    end: usize,
    string: bool,
}

/// A list of values up to the record delimiter.
pub struct Params<'a> {
    records: &'a [Record<'a>],
    width: usize,
    text: Vec<u8>,
    tokens: Vec<Token>,
    /// Place of the record delimiter in `text`.
    end: usize,
    /// Places of strings whose stated length was too long, see `shorter`.
    pub too_long: Vec<(usize, usize)>,
}

impl<'a> Params<'a> {
    /// Reads the values in columns 1 to `width` (64 or 72) of `records`, from byte `start` of that text on.
    pub fn read(
        records: &'a [Record<'a>],
        width: usize,
        start: usize,
        delimiters: Delimiters,
    ) -> Result<Self, Fail> {
        let text = join(records, width);
        let mut params = Self {
            records,
            width,
            text,
            tokens: Vec::new(),
            end: 0,
            too_long: Vec::new(),
        };
        params.end = params.scan(start, delimiters)?;
        Ok(params)
    }

    /// Splits the text into tokens; returns the place of the record delimiter.
    fn scan(&mut self, mut at: usize, delimiters: Delimiters) -> Result<usize, Fail> {
        loop {
            while self.text.get(at) == Some(&b' ') {
                at += 1;
            }
            let token = at;
            let string = self.string_length(at)?;
            let (start, mut end) = match string {
                Some((from, length)) => (from, from + length),
                None => (token, token),
            };
            at = end;
            let closing = loop {
                match self.text.get(at) {
                    Some(&c) if c == delimiters.parameter || c == delimiters.record => break c,
                    Some(b' ') => at += 1,
                    Some(_) if string.is_none() => {
                        at += 1;
                        end = at;
                    }
                    Some(&c) => {
                        let Some(shorter) = self.shorter(start, end, delimiters) else {
                            let expected = "a delimiter after the string";
                            return Err(Fail::new(self.place(at), expected, show(&[c])));
                        };
                        self.too_long.push(self.place(token));
                        at = shorter;
                        end = shorter;
                    }
                    None => {
                        let expected = format!(
                            "the record delimiter \"{}\" (the data is cut off)",
                            delimiters.record as char
                        );
                        return Err(Fail::new(self.place(at), expected, "the end of the data"));
                    }
                }
            };
            self.tokens.push(Token {
                at: token,
                start,
                end,
                string: string.is_some(),
            });
            if closing == delimiters.record {
                return Ok(at);
            }
            at += 1;
        }
    }

    /// For a Hollerith constant (`4Hname`) at `at`: start and length of its characters.
    fn string_length(&self, at: usize) -> Result<Option<(usize, usize)>, Fail> {
        let digits = self.text[at..]
            .iter()
            .take_while(|b| b.is_ascii_digit())
            .count();
        if digits == 0 || !matches!(self.text.get(at + digits), Some(b'H' | b'h')) {
            return Ok(None);
        }
        let from = at + digits + 1;
        let left = self.text.len() - from;
        let length = number::integer(&self.text[at..at + digits]);
        match length.and_then(|n| usize::try_from(n).ok()) {
            Some(length) if length <= left => Ok(Some((from, length))),
            _ => {
                let expected = format!("a string of at most {left} characters, which are left");
                let found = format!("a length of {}", show(&self.text[at..at + digits]));
                Err(Fail::new(self.place(at), expected, found))
            }
        }
    }

    /// End of a string whose stated length is wrong, as after an edit by hand: no delimiter follows the stated end, but
    /// inside of it stands a last delimiter with nothing but blanks behind.
    fn shorter(&self, start: usize, end: usize, delimiters: Delimiters) -> Option<usize> {
        let last = self.text[start..end].iter().rposition(|&b| b != b' ')?;
        let byte = self.text[start + last];
        (byte == delimiters.parameter || byte == delimiters.record).then_some(start + last)
    }

    /// Line and column (from 1) of a byte of the text.
    fn place(&self, at: usize) -> (usize, usize) {
        match self.records.get(at / self.width) {
            Some(record) => (record.line, at % self.width + 1),
            None => (self.records.last().map_or(1, |r| r.line), self.width + 1),
        }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.tokens.len()
    }

    /// Place of value `i`, or of the record delimiter if there are fewer values.
    pub fn place_of(&self, i: usize) -> (usize, usize) {
        self.place(self.tokens.get(i).map_or(self.end, |t| t.at))
    }

    /// An error at value `i` that says what is there.
    pub fn fail(&self, i: usize, expected: impl Into<String>) -> Fail {
        let found = match self.tokens.get(i) {
            None => format!("the end of the data after {} values", self.len()),
            Some(t) if t.start == t.end => "an omitted value".to_owned(),
            Some(t) => show(&self.text[t.start..t.end]),
        };
        Fail::new(self.place_of(i), expected, found)
    }

    /// Bytes of value `i` unless it is a string, missing or left out.
    fn bare(&self, i: usize) -> Option<&[u8]> {
        let token = self
            .tokens
            .get(i)
            .filter(|t| !t.string && t.start < t.end)?;
        Some(&self.text[token.start..token.end])
    }

    /// Whether value `i` is left out (`,,`) or beyond the end.
    pub fn is_default(&self, i: usize) -> bool {
        self.tokens
            .get(i)
            .is_none_or(|t| t.start == t.end && !t.string)
    }

    /// Integer value `i`; 0 if it is left out, as the standard says.
    pub fn integer(&self, i: usize, what: &str) -> Result<i64, Fail> {
        if i < self.len() && self.is_default(i) {
            return Ok(0);
        }
        self.bare(i)
            .and_then(number::integer)
            .ok_or_else(|| self.fail(i, format!("{what} (an integer)")))
    }

    /// Number that counts things, at least 0.
    pub fn count(&self, i: usize, what: &str) -> Result<usize, Fail> {
        let value = self.integer(i, what)?;
        usize::try_from(value).map_err(|_| self.fail(i, format!("{what} (0 or more)")))
    }

    /// Real value `i`; 0 if it is left out, as the standard says.
    pub fn real(&self, i: usize, what: &str) -> Result<f64, Fail> {
        if i < self.len() && self.is_default(i) {
            return Ok(0.0);
        }
        self.bare(i)
            .and_then(number::real)
            .ok_or_else(|| self.fail(i, format!("{what} (a real number)")))
    }

    /// Real values `from..from + count`. Nothing is allocated before it is known that so many are there.
    pub fn reals(&self, from: usize, count: usize, what: &str) -> Result<Vec<f64>, Fail> {
        if from.checked_add(count).is_none_or(|end| end > self.len()) {
            return Err(self.fail(self.len(), format!("{count} numbers: {what}")));
        }
        (from..from + count).map(|i| self.real(i, what)).collect()
    }

    /// String value `i` (latin-1), `None` if it is left out or beyond the end.
    pub fn string(&self, i: usize, what: &str) -> Result<Option<String>, Fail> {
        match self.tokens.get(i) {
            Some(t) if t.string => Ok(Some(
                self.text[t.start..t.end]
                    .iter()
                    .map(|&b| b as char)
                    .collect(),
            )),
            _ if self.is_default(i) => Ok(None),
            _ => Err(self.fail(i, format!("{what} (a string such as 2HMM)"))),
        }
    }
}

/// Columns 1 to `width` of all records in one piece.
pub fn join(records: &[Record], width: usize) -> Vec<u8> {
    let mut text = Vec::with_capacity(records.len() * width);
    for record in records {
        text.extend_from_slice(record.columns(1, width));
    }
    text
}
