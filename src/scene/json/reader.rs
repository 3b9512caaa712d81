//! The structure of JSON: values, objects, lists, and what stands between them.
use super::{Fault, Kind, MORE, Member, Node};
use crate::scene::problem::{MOST_PROBLEMS, shorten};
use std::collections::HashMap;
use std::ops::Range;

/// Values may be nested this deep; scenes need less than ten.
const MAX_DEPTH: usize = 64;
/// Objects of more keys than this keep a table of them while they are read.
const FEW_KEYS: usize = 32;
/// Reads a text, which messages call `what`; `start` tells what to do about an empty one. Faults that do not stop reading
/// (keys given twice: the first one counts) are added to `faults`.
pub(in crate::scene) fn read(
    text: &str,
    what: &str,
    start: &str,
    faults: &mut Vec<Fault>,
) -> Result<Node, Fault> {
    let mut reader = Reader {
        text,
        at: 0,
        depth: 0,
        faults,
    };
    if text.starts_with('\u{FEFF}') {
        reader.at = 3;
    }
    reader.skip_space()?;
    if reader.at == text.len() {
        return Err(reader.fault(0..0, "the file is empty", Some(start)));
    }
    let root = reader.value()?;
    reader.skip_space()?;
    if reader.at < text.len() {
        return Err(reader.fault(
            reader.here(),
            format!("there is more text after the end of the {what}"),
            Some("perhaps a closing bracket too early"),
        ));
    }
    Ok(root)
}

pub(super) struct Reader<'a> {
    pub text: &'a str,
    pub at: usize,
    depth: usize,
    faults: &'a mut Vec<Fault>,
}

impl Reader<'_> {
    pub fn fault(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        help: Option<&str>,
    ) -> Fault {
        Fault {
            message: message.into(),
            help: help.map(str::to_string),
            span,
        }
    }

    /// Records a fault and goes on, as long as there is room for more.
    pub fn tell(&mut self, fault: Fault) -> Result<(), Fault> {
        if self.faults.len() >= MOST_PROBLEMS {
            return Err(self.fault(fault.span, MORE, None));
        }
        self.faults.push(fault);
        Ok(())
    }

    pub fn peek(&self) -> Option<char> {
        self.text[self.at..].chars().next()
    }

    /// The next character or word.
    fn here(&self) -> Range<usize> {
        let rest = &self.text[self.at..];
        let word = rest
            .find(|c: char| !(c.is_alphanumeric() || c == '_'))
            .unwrap_or(rest.len());
        let length = word.max(rest.chars().next().map_or(0, char::len_utf8));
        self.at..self.at + length
    }

    /// Skips blanks and comments.
    fn skip_space(&mut self) -> Result<(), Fault> {
        loop {
            let rest = &self.text[self.at..];
            self.at += rest.len() - rest.trim_start_matches([' ', '\t', '\n', '\r']).len();
            let rest = &self.text[self.at..];
            // Only where a comment is: lines may be as long as the file.
            let line = || rest.find('\n').unwrap_or(rest.len());
            if rest.starts_with("//") {
                self.at += line();
            } else if rest.starts_with("/*") {
                let Some(end) = rest.find("*/") else {
                    let help = Some("close it with `*/`");
                    let span = self.at..self.at + 2;
                    return Err(self.fault(span, "a comment that does not end", help));
                };
                self.at += end + 2;
            } else if rest.starts_with('#') {
                let help = "write `// ...` or `/* ... */`";
                let end = self.at + line();
                let span = self.at..end;
                self.tell(self.fault(span, "a comment does not start with `#`", Some(help)))?;
                self.at = end;
            } else {
                return Ok(());
            }
        }
    }

    fn value(&mut self) -> Result<Node, Fault> {
        let start = self.at;
        let kind = match self.peek() {
            Some('{') => self.nested(Self::object)?,
            Some('[') => self.nested(Self::array)?,
            Some('"') => Kind::Text(self.string()?),
            Some('-' | '0'..='9' | '+' | '.') => self.number()?,
            Some(_) => self.word()?,
            None => {
                return Err(self.fault(
                    start..start,
                    "the file ends where a value is expected",
                    None,
                ));
            }
        };
        Ok(Node {
            kind,
            span: start..self.at,
        })
    }

    fn nested(&mut self, read: fn(&mut Self) -> Result<Kind, Fault>) -> Result<Kind, Fault> {
        if self.depth == MAX_DEPTH {
            let message = format!("values are nested more than {MAX_DEPTH} deep");
            return Err(self.fault(self.at..self.at + 1, message, None));
        }
        self.depth += 1;
        let kind = read(self);
        self.depth -= 1;
        kind
    }

    fn word(&mut self) -> Result<Kind, Fault> {
        let span = self.here();
        let word = &self.text[span.clone()];
        let (kind, help) = match word {
            "null" => (Some(Kind::Null), None),
            "true" => (Some(Kind::Bool(true)), None),
            "false" => (Some(Kind::Bool(false)), None),
            "True" | "TRUE" | "yes" | "on" => (None, Some("JSON writes `true`")),
            "False" | "FALSE" | "no" | "off" => (None, Some("JSON writes `false`")),
            "None" | "nil" => (
                None,
                Some("JSON writes `null`; a key that is not wanted is left out"),
            ),
            "NaN" | "nan" | "Infinity" | "inf" => (None, Some("only finite numbers are allowed")),
            "'" => (None, Some("text is written between double quotes")),
            _ => (None, None),
        };
        match kind {
            Some(kind) => {
                self.at = span.end;
                Ok(kind)
            }
            None => {
                let plain = word.chars().all(|c| c.is_alphanumeric() || c == '_');
                let quotes = "text is written between double quotes";
                let help = help.or(plain.then_some(quotes));
                let message = format!("expected a value, found `{}`", shorten(word));
                let fault = self.fault(span.clone(), message, help);
                // Without a word there is nothing to skip.
                if !plain {
                    return Err(fault);
                }
                self.tell(fault)?;
                self.at = span.end;
                Ok(Kind::Broken)
            }
        }
    }

    fn object(&mut self) -> Result<Kind, Fault> {
        let open = self.at;
        let mut members: Vec<Member> = Vec::new();
        // Where keys are, once there are more than a search through all of them is good for.
        let mut places: HashMap<String, usize> = HashMap::new();
        self.at += 1;
        loop {
            self.skip_space()?;
            if self.peek() == Some('}') {
                self.at += 1;
                return Ok(Kind::Object(members));
            }
            let key_start = self.at;
            let key = self.key(open)?;
            let key_span = key_start..self.at;
            self.skip_space()?;
            match self.peek() {
                Some(':') => self.at += 1,
                None => return Err(self.unfinished(open, "object")),
                Some(c) => {
                    let message = format!("expected `:` after the key `{}`", shorten(&key));
                    let fault = self.fault(self.here(), message, None);
                    if !starts_value(c) {
                        return Err(fault);
                    }
                    self.tell(fault)?;
                }
            }
            self.skip_space()?;
            let value = self.value()?;
            if members.len() == FEW_KEYS {
                places.extend(members.iter().enumerate().map(|(i, m)| (m.key.clone(), i)));
            }
            let first = match members.len() < FEW_KEYS {
                true => members.iter().find(|m| m.key == key),
                false => places.get(&key).map(|&i| &members[i]),
            };
            match first {
                Some(first) => {
                    let line = 1 + self.text[..first.key_span.start].matches('\n').count();
                    let message = format!("the key `{}` is given twice", shorten(&key));
                    let help = format!("the first one is in line {line}");
                    self.tell(self.fault(key_span, message, Some(&help)))?;
                }
                None => {
                    if members.len() >= FEW_KEYS {
                        places.insert(key.clone(), members.len());
                    }
                    members.push(Member {
                        key,
                        key_span,
                        value,
                    });
                }
            }
            if self.end_of_item(open, '}', "object")? {
                return Ok(Kind::Object(members));
            }
        }
    }

    /// A key; one without quotes is reported and read.
    fn key(&mut self, open: usize) -> Result<String, Fault> {
        match self.peek() {
            Some('"') => self.string(),
            None => Err(self.unfinished(open, "object")),
            Some(first) => {
                let span = self.here();
                let word = self.text[span.clone()].to_owned();
                let message = format!("expected a key, found `{}`", shorten(&word));
                let help = "keys are written between double quotes";
                let fault = self.fault(span.clone(), message, Some(help));
                if !(first.is_alphabetic() || first == '_') {
                    return Err(fault);
                }
                self.tell(fault)?;
                self.at = span.end;
                Ok(word)
            }
        }
    }

    fn array(&mut self) -> Result<Kind, Fault> {
        let open = self.at;
        let mut items = Vec::new();
        self.at += 1;
        loop {
            self.skip_space()?;
            if self.peek() == Some(']') {
                self.at += 1;
                return Ok(Kind::Array(items));
            }
            if self.peek().is_none() {
                return Err(self.unfinished(open, "list"));
            }
            items.push(self.value()?);
            if self.end_of_item(open, ']', "list")? {
                return Ok(Kind::Array(items));
            }
        }
    }

    /// After an item: a comma (false) or the closing bracket (true).
    fn end_of_item(&mut self, open: usize, close: char, what: &str) -> Result<bool, Fault> {
        self.skip_space()?;
        match self.peek() {
            Some(',') => {
                self.at += 1;
                Ok(false)
            }
            Some(c) if c == close => {
                self.at += 1;
                Ok(true)
            }
            Some(c) => {
                let found = shorten(&self.text[self.here()]);
                let message = format!("expected `,` or `{close}`, found `{found}`");
                let help = "perhaps a comma is missing before it";
                let fault = self.fault(self.here(), message, Some(help));
                if !starts_value(c) {
                    return Err(fault);
                }
                self.tell(fault)?;
                Ok(false)
            }
            None => Err(self.unfinished(open, what)),
        }
    }

    fn unfinished(&self, open: usize, what: &str) -> Fault {
        let line = 1 + self.text[..open].matches('\n').count();
        let message = format!("the file ends inside the {what} that starts in line {line}");
        self.fault(self.text.len()..self.text.len(), message, None)
    }
}

/// Whether a value or a key surely starts like this, so that reading can go on there.
fn starts_value(c: char) -> bool {
    c.is_ascii_digit() || matches!(c, '"' | '{' | '[' | '-')
}
