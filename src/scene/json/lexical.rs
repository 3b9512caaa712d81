//! Words of JSON: numbers and texts with their escape sequences.
use super::reader::Reader;
use super::{Fault, Kind};
use crate::scene::problem::shorten;

impl Reader<'_> {
    pub fn number(&mut self) -> Result<Kind, Fault> {
        let start = self.at;
        let rest = &self.text[start..];
        let length = rest
            .find(|c: char| !(c.is_alphanumeric() || matches!(c, '+' | '-' | '.')))
            .unwrap_or(rest.len());
        let (word, span) = (&rest[..length], start..start + length);
        self.at = span.end;
        if let Err(help) = number_form(word.as_bytes()) {
            let message = format!("`{}` is not a number", shorten(word));
            self.tell(self.fault(span, message, Some(help)))?;
            return Ok(Kind::Broken);
        }
        match word.parse::<f64>() {
            Ok(n) if n.is_finite() => Ok(Kind::Number(n)),
            _ => {
                let message = format!("the number `{}` is too large", shorten(word));
                self.tell(self.fault(span, message, None))?;
                Ok(Kind::Broken)
            }
        }
    }

    pub fn string(&mut self) -> Result<String, Fault> {
        let start = self.at;
        self.at += 1;
        let mut text = String::new();
        loop {
            let at = self.at;
            match self.peek() {
                Some('"') => {
                    self.at += 1;
                    return Ok(text);
                }
                Some('\\') => text.push(self.escape_sequence()?),
                Some(c) if c as u32 >= 0x20 => {
                    self.at += c.len_utf8();
                    text.push(c);
                }
                // The usual cause of a line break or the end of the file inside a text.
                Some('\n' | '\r') | None => {
                    let help = "the closing quote is missing";
                    return Err(self.fault(
                        start..at,
                        "a text that does not end in its line",
                        Some(help),
                    ));
                }
                Some(c) => {
                    let message = format!("control character U+{:04X} in a text", c as u32);
                    return Err(self.fault(
                        at..at + 1,
                        message,
                        Some("write it as \\t or \\u00XX"),
                    ));
                }
            }
        }
    }

    fn escape_sequence(&mut self) -> Result<char, Fault> {
        let start = self.at;
        self.at += 1;
        let Some(c) = self.peek() else {
            return Err(self.fault(
                start..start + 1,
                "a text that does not end in its line",
                None,
            ));
        };
        self.at += c.len_utf8();
        let plain = match c {
            '"' | '\\' | '/' => Some(c),
            'b' => Some('\u{8}'),
            'f' => Some('\u{c}'),
            'n' => Some('\n'),
            'r' => Some('\r'),
            't' => Some('\t'),
            'u' => self.unicode(),
            _ => None,
        };
        plain.ok_or_else(|| {
            let message = format!(
                "`{}` is no escape sequence of JSON",
                &self.text[start..self.at]
            );
            self.fault(
                start..self.at,
                message,
                Some("a backslash itself is written `\\\\`"),
            )
        })
    }

    /// Four hexadecimal digits, or two such groups for a surrogate pair.
    fn unicode(&mut self) -> Option<char> {
        let high = self.hex4()?;
        if !(0xD800..0xDC00).contains(&high) {
            return char::from_u32(high);
        }
        if !self.text[self.at..].starts_with("\\u") {
            return None;
        }
        self.at += 2;
        let low = self.hex4().filter(|l| (0xDC00..0xE000).contains(l))?;
        char::from_u32(0x10000 + ((high - 0xD800) << 10) + (low - 0xDC00))
    }

    fn hex4(&mut self) -> Option<u32> {
        let digits = self.text.get(self.at..self.at + 4)?;
        if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            return None;
        }
        self.at += 4;
        u32::from_str_radix(digits, 16).ok()
    }
}

/// The grammar of JSON numbers; the error is what to write instead.
fn number_form(word: &[u8]) -> Result<(), &'static str> {
    let digits = |from: usize| {
        word[from..]
            .iter()
            .take_while(|b| b.is_ascii_digit())
            .count()
    };
    let mut at = usize::from(word.first() == Some(&b'-'));
    if word.first() == Some(&b'+') {
        return Err("JSON has no leading `+`");
    }
    let whole = digits(at);
    if whole == 0 {
        return Err("a digit must come first, as in `0.5`");
    }
    if whole > 1 && word[at] == b'0' {
        return Err("JSON has no leading zeros");
    }
    at += whole;
    if word.get(at) == Some(&b'.') {
        let fraction = digits(at + 1);
        if fraction == 0 {
            return Err("digits must follow the point, as in `1.0`");
        }
        at += 1 + fraction;
    }
    if matches!(word.get(at), Some(b'e' | b'E')) {
        at += 1 + usize::from(matches!(word.get(at + 1), Some(b'+' | b'-')));
        let exponent = if at <= word.len() { digits(at) } else { 0 };
        if exponent == 0 {
            return Err("digits must follow the exponent's `e`, as in `1e-3`");
        }
        at += exponent;
    }
    match at == word.len() {
        true => Ok(()),
        false => {
            Err("write it as in `-12.5` or `1e-3`; expressions are written between double quotes")
        }
    }
}
