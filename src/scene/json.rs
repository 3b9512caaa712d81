//! JSON text as a tree in which every value and key knows its place.
//!
//! A scene is written by hand, so what matters is to say precisely what is wrong and where. Strict JSON (RFC 8259):
//! no comments, no trailing commas; a key may be given once.
use super::problem::{MOST_IN_NAME, MOST_PROBLEMS, shorten};
use std::collections::HashMap;
use std::ops::Range;

/// Values may be nested this deep; scenes need less than ten.
const MAX_DEPTH: usize = 64;
/// Objects of more keys than this keep a table of them while they are read.
const FEW_KEYS: usize = 32;
/// Said instead of the problems beyond the number that is told.
pub(super) const MORE: &str = "there are more problems, which are not listed";

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub kind: Kind,
    /// Bytes of the text.
    pub span: Range<usize>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Kind {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    Array(Vec<Node>),
    Object(Vec<Member>),
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Member {
    pub key: String,
    pub key_span: Range<usize>,
    pub value: Node,
}

/// Something wrong at a span of the text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    pub message: String,
    pub help: Option<String>,
    pub span: Range<usize>,
}

/// Reads a text, which messages call `what`; `start` tells what to do about an empty one. Faults that do not stop reading
/// (keys given twice: the first one counts) are added to `faults`.
pub(super) fn read(
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

impl Node {
    /// In words, for messages.
    pub fn describe(&self) -> String {
        match &self.kind {
            Kind::Null => "null".into(),
            Kind::Bool(b) => b.to_string(),
            Kind::Number(n) => format!("the number {n}"),
            Kind::Text(t) => format!("the text \"{}\"", shorten(t)),
            Kind::Array(items) if items.len() == 1 => "a list of 1 value".into(),
            Kind::Array(items) => format!("a list of {} values", items.len()),
            Kind::Object(_) => "an object".into(),
        }
    }

    /// The child of a JSON pointer's reference token (already unescaped), with the span of its key.
    pub fn child(&self, token: &str) -> Option<(&Node, Range<usize>)> {
        match &self.kind {
            Kind::Object(members) => members
                .iter()
                .find(|m| m.key == token)
                .map(|m| (&m.value, m.key_span.clone())),
            Kind::Array(items) => items
                .get(token.parse::<usize>().ok()?)
                .map(|n| (n, n.span.clone())),
            _ => None,
        }
    }

    /// JSON pointer of the innermost value (or its key) that holds a byte of the text. It ends above a key that is longer
    /// than any name may be: many problems below such a key would repeat it.
    pub fn pointer_at(&self, offset: usize) -> String {
        let mut pointer = String::new();
        let mut node = self;
        loop {
            let next = match &node.kind {
                Kind::Object(members) => members
                    .iter()
                    .find(|m| {
                        (m.key_span.start..m.value.span.end.max(m.key_span.end)).contains(&offset)
                    })
                    .map(|m| (escape(&m.key), &m.value)),
                Kind::Array(items) => items
                    .iter()
                    .enumerate()
                    .find(|(_, n)| n.span.contains(&offset))
                    .map(|(i, n)| (i.to_string(), n)),
                _ => None,
            };
            let Some((token, child)) = next.filter(|(token, _)| token.len() <= 2 * MOST_IN_NAME)
            else {
                return pointer;
            };
            pointer.push('/');
            pointer.push_str(&token);
            node = child;
        }
    }
}

/// Reference token of a JSON pointer: `~` and `/` are escaped.
pub(super) fn escape(token: &str) -> String {
    token.replace('~', "~0").replace('/', "~1")
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    faults: &'a mut Vec<Fault>,
}

impl Reader<'_> {
    fn fault(&self, span: Range<usize>, message: impl Into<String>, help: Option<&str>) -> Fault {
        Fault {
            message: message.into(),
            help: help.map(str::to_string),
            span,
        }
    }

    fn peek(&self) -> Option<char> {
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

    fn skip_space(&mut self) -> Result<(), Fault> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start_matches([' ', '\t', '\n', '\r']).len();
        let rest = &self.text[self.at..];
        if rest.starts_with("//") || rest.starts_with("/*") || rest.starts_with('#') {
            let end = self.at + rest.find('\n').unwrap_or(rest.len());
            return Err(self.fault(
                self.at..end,
                "comments are not allowed in JSON",
                Some("remove it; the key `title` may hold a remark"),
            ));
        }
        Ok(())
    }

    fn value(&mut self) -> Result<Node, Fault> {
        let start = self.at;
        let kind = match self.peek() {
            Some('{') => self.nested(Self::object)?,
            Some('[') => self.nested(Self::array)?,
            Some('"') => Kind::Text(self.string()?),
            Some('-' | '0'..='9' | '+' | '.') => Kind::Number(self.number()?),
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
                Err(self.fault(
                    span.clone(),
                    format!("expected a value, found `{}`", shorten(word)),
                    help,
                ))
            }
        }
    }

    fn object(&mut self) -> Result<Kind, Fault> {
        let open = self.at;
        let mut members: Vec<Member> = Vec::new();
        // Where keys are, once there are more than a search through all of them is good for.
        let mut places: HashMap<String, usize> = HashMap::new();
        self.at += 1;
        self.skip_space()?;
        if self.peek() == Some('}') {
            self.at += 1;
            return Ok(Kind::Object(members));
        }
        loop {
            self.skip_space()?;
            let key_start = self.at;
            match self.peek() {
                Some('"') => {}
                None => return Err(self.unfinished(open, "object")),
                Some(_) => {
                    let help = "keys are written between double quotes";
                    let found = shorten(&self.text[self.here()]);
                    let message = format!("expected a key, found `{found}`");
                    return Err(self.fault(self.here(), message, Some(help)));
                }
            }
            let key = self.string()?;
            let key_span = key_start..self.at;
            self.skip_space()?;
            match self.peek() {
                Some(':') => self.at += 1,
                None => return Err(self.unfinished(open, "object")),
                Some(_) => {
                    let message = format!("expected `:` after the key `{}`", shorten(&key));
                    return Err(self.fault(self.here(), message, None));
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
                Some(_) if self.faults.len() >= MOST_PROBLEMS => {
                    return Err(self.fault(key_span, MORE, None));
                }
                Some(first) => {
                    let line = 1 + self.text[..first.key_span.start].matches('\n').count();
                    self.faults.push(Fault {
                        message: format!("the key `{}` is given twice", shorten(&key)),
                        help: Some(format!("the first one is in line {line}")),
                        span: key_span,
                    });
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

    fn array(&mut self) -> Result<Kind, Fault> {
        let open = self.at;
        let mut items = Vec::new();
        self.at += 1;
        self.skip_space()?;
        if self.peek() == Some(']') {
            self.at += 1;
            return Ok(Kind::Array(items));
        }
        loop {
            self.skip_space()?;
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
                let comma = self.at;
                self.at += 1;
                self.skip_space()?;
                if self.peek() == Some(close) {
                    let message = format!("a comma before `{close}` is not allowed in JSON");
                    return Err(self.fault(comma..comma + 1, message, Some("remove the comma")));
                }
                Ok(false)
            }
            Some(c) if c == close => {
                self.at += 1;
                Ok(true)
            }
            Some(_) => {
                let found = shorten(&self.text[self.here()]);
                let message = format!("expected `,` or `{close}`, found `{found}`");
                Err(self.fault(
                    self.here(),
                    message,
                    Some("perhaps a comma is missing before it"),
                ))
            }
            None => Err(self.unfinished(open, what)),
        }
    }

    fn unfinished(&self, open: usize, what: &str) -> Fault {
        let line = 1 + self.text[..open].matches('\n').count();
        let message = format!("the file ends inside the {what} that starts in line {line}");
        self.fault(self.text.len()..self.text.len(), message, None)
    }

    fn number(&mut self) -> Result<f64, Fault> {
        let start = self.at;
        let rest = &self.text[start..];
        let length = rest
            .find(|c: char| !(c.is_alphanumeric() || matches!(c, '+' | '-' | '.')))
            .unwrap_or(rest.len());
        let (word, span) = (&rest[..length], start..start + length);
        self.at = span.end;
        if let Err(help) = number_form(word.as_bytes()) {
            let message = format!("`{}` is not a number", shorten(word));
            return Err(self.fault(span, message, Some(help)));
        }
        match word.parse::<f64>() {
            Ok(n) if n.is_finite() => Ok(n),
            _ => Err(self.fault(
                span,
                format!("the number `{}` is too large", shorten(word)),
                None,
            )),
        }
    }

    fn string(&mut self) -> Result<String, Fault> {
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
