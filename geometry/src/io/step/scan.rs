//! Tokens and values of an exchange structure (ISO 10303-21, clauses 6 and 10).

use super::super::error::show;

/// Lists may be nested this deep; it bounds the stack.
const MAX_DEPTH: usize = 64;

/// Damage at a byte of the file.
#[derive(Debug, Clone)]
pub struct Damage {
    pub at: usize,
    pub expected: String,
    pub found: String,
}

/// A value of a parameter list. Texts are as the file spells them.
#[derive(Debug, Clone)]
pub enum Value<'a> {
    /// `$`
    Omitted,
    /// `*`
    Derived,
    Integer(i64),
    Real(f64),
    /// Between the quotes.
    Text(&'a [u8]),
    /// Between the dots.
    Enumeration(&'a [u8]),
    /// Between the double quotes.
    Binary,
    /// The name of an instance.
    Reference(u64),
    List(Vec<Item<'a>>),
    /// A value with the name of its type.
    Typed(&'a [u8], Vec<Item<'a>>),
}

/// A value and where it stands.
#[derive(Debug, Clone)]
pub struct Item<'a> {
    pub value: Value<'a>,
    pub at: usize,
}

impl Value<'_> {
    /// The value in words, for messages.
    pub fn describe(&self) -> String {
        match self {
            Self::Omitted => "$ (no value)".to_owned(),
            Self::Derived => "* (a derived value)".to_owned(),
            Self::Integer(i) => i.to_string(),
            Self::Real(x) => x.to_string(),
            Self::Text(t) => format!("the string {}", show(t)),
            Self::Enumeration(t) => format!(".{}.", String::from_utf8_lossy(t)),
            Self::Binary => "a binary value".to_owned(),
            Self::Reference(n) => format!("#{n}"),
            Self::List(items) => format!("a list of {} values", items.len()),
            Self::Typed(name, _) => format!("a value of type {}", String::from_utf8_lossy(name)),
        }
    }
}

/// Reads tokens from left to right.
#[derive(Clone)]
pub struct Scanner<'a> {
    bytes: &'a [u8],
    pub at: usize,
}

impl<'a> Scanner<'a> {
    pub fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    pub fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at.min(self.bytes.len())..]
    }

    pub fn damage(&self, expected: impl Into<String>) -> Damage {
        let rest = self.rest();
        let line = rest.split(|&b| b == b'\n' || b == b'\r').next();
        let found = match line {
            _ if rest.is_empty() => "the end of the file".to_owned(),
            Some(line) if !line.is_empty() => show(&line[..line.len().min(24)]),
            _ => "the end of the line".to_owned(),
        };
        Damage {
            at: self.at,
            expected: expected.into(),
            found,
        }
    }

    /// Skips blanks, comments, and the print control directives `\N\` and `\F\`.
    pub fn blank(&mut self) -> Result<(), Damage> {
        loop {
            let rest = self.rest();
            match rest {
                [b, ..] if b.is_ascii_whitespace() || *b == 0 => self.at += 1,
                [b'/', b'*', inner @ ..] => {
                    let Some(end) = inner.windows(2).position(|w| w == b"*/") else {
                        return Err(self.damage("a comment that ends (*/)"));
                    };
                    self.at += end + 4;
                }
                [b'\\', b'N' | b'F', b'\\', ..] => self.at += 3,
                _ => return Ok(()),
            }
        }
    }

    /// Takes `sign` after blanks.
    pub fn expect(&mut self, sign: u8, what: &str) -> Result<(), Damage> {
        self.blank()?;
        if self.peek() == Some(sign) {
            self.at += 1;
            return Ok(());
        }
        Err(self.damage(what))
    }

    /// A keyword after blanks: capitals, digits and underscores; small letters and minus signs are tolerated.
    pub fn keyword(&mut self, what: &str) -> Result<&'a [u8], Damage> {
        self.blank()?;
        let rest = self.rest();
        let own = usize::from(rest.first() == Some(&b'!'));
        let part = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-');
        let length = own + rest[own..].iter().take_while(|b| part(b)).count();
        if !rest
            .get(own)
            .is_some_and(|b| b.is_ascii_alphabetic() || *b == b'_')
        {
            return Err(self.damage(what));
        }
        self.at += length;
        Ok(&rest[..length])
    }

    /// The name of an instance, with the `#` in front.
    pub fn name(&mut self, what: &str) -> Result<u64, Damage> {
        self.blank()?;
        let rest = self.rest();
        let digits = match rest {
            [b'#', digits @ ..] => digits,
            _ => return Err(self.damage(what)),
        };
        let length = digits.iter().take_while(|b| b.is_ascii_digit()).count();
        let text = std::str::from_utf8(&digits[..length]).unwrap_or("");
        let Ok(name) = text.parse() else {
            return Err(self.damage(what));
        };
        self.at += 1 + length;
        Ok(name)
    }

    /// A parameter list, from its opening parenthesis on.
    pub fn list(&mut self) -> Result<Vec<Item<'a>>, Damage> {
        self.expect(b'(', "a list of values in parentheses")?;
        self.list_body(0)
    }

    fn list_body(&mut self, depth: usize) -> Result<Vec<Item<'a>>, Damage> {
        if depth > MAX_DEPTH {
            return Err(self.damage(format!("lists nested at most {MAX_DEPTH} deep")));
        }
        let mut items = Vec::new();
        self.blank()?;
        if self.peek() == Some(b')') {
            self.at += 1;
            return Ok(items);
        }
        loop {
            self.blank()?;
            let at = self.at;
            let value = match self.peek() {
                Some(b'(') => {
                    self.at += 1;
                    Value::List(self.list_body(depth + 1)?)
                }
                Some(b) if b.is_ascii_alphabetic() || b == b'!' => {
                    let name = self.keyword("the name of a type")?;
                    self.expect(b'(', "a value in parentheses after the name of its type")?;
                    Value::Typed(name, self.list_body(depth + 1)?)
                }
                _ => self.atom()?,
            };
            items.push(Item { value, at });
            self.blank()?;
            match self.peek() {
                Some(b',') => self.at += 1,
                Some(b')') => {
                    self.at += 1;
                    return Ok(items);
                }
                _ => return Err(self.damage("a comma or a closing parenthesis")),
            }
        }
    }

    /// Passes over a parameter list whose opening parenthesis is next, checking it without keeping anything.
    pub fn skip_list(&mut self) -> Result<(), Damage> {
        self.expect(b'(', "a list of values in parentheses")?;
        let mut depth = 1;
        // Whether a value must come, and whether the list may end here although it would.
        let (mut wanted, mut opened) = (true, true);
        loop {
            self.blank()?;
            match self.peek() {
                Some(b')') if !wanted || opened => {
                    self.at += 1;
                    depth -= 1;
                    (wanted, opened) = (false, false);
                    if depth == 0 {
                        return Ok(());
                    }
                }
                Some(b',') if !wanted => {
                    self.at += 1;
                    (wanted, opened) = (true, false);
                }
                _ if !wanted => return Err(self.damage("a comma or a closing parenthesis")),
                Some(b'(') => {
                    self.at += 1;
                    depth += 1;
                    opened = true;
                }
                Some(b) if b.is_ascii_alphabetic() || b == b'!' => {
                    self.keyword("the name of a type")?;
                    self.expect(b'(', "a value in parentheses after the name of its type")?;
                    depth += 1;
                    opened = true;
                }
                _ => {
                    self.atom()?;
                    (wanted, opened) = (false, false);
                }
            }
            // One less than the values are read with, which count from the list inside.
            if depth > MAX_DEPTH + 1 {
                return Err(self.damage(format!("lists nested at most {MAX_DEPTH} deep")));
            }
        }
    }

    /// A value that is no list.
    fn atom(&mut self) -> Result<Value<'a>, Damage> {
        let rest = self.rest();
        match rest {
            [b'$', ..] => {
                self.at += 1;
                Ok(Value::Omitted)
            }
            [b'*', ..] => {
                self.at += 1;
                Ok(Value::Derived)
            }
            [b'\'', ..] => Ok(Value::Text(self.text()?)),
            [b'"', inner @ ..] => {
                let length = inner.iter().take_while(|b| b.is_ascii_hexdigit()).count();
                if inner.get(length) != Some(&b'"') {
                    return Err(self.damage("a binary value: hexadecimal digits in double quotes"));
                }
                self.at += length + 2;
                Ok(Value::Binary)
            }
            [b'#', ..] => Ok(Value::Reference(
                self.name("the name of an instance (#12)")?,
            )),
            [b'.', b, ..] if !b.is_ascii_digit() => {
                let inner = &rest[1..];
                let part = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_';
                let length = inner.iter().take_while(|b| part(b)).count();
                if length == 0 || inner.get(length) != Some(&b'.') {
                    return Err(self.damage("an enumeration value between dots"));
                }
                self.at += length + 2;
                Ok(Value::Enumeration(&inner[..length]))
            }
            [b'0'..=b'9' | b'+' | b'-' | b'.', ..] => self.number(),
            _ => Err(self.damage("a value")),
        }
    }

    fn number(&mut self) -> Result<Value<'a>, Damage> {
        let rest = self.rest();
        let digits = |from: usize| {
            rest[from..]
                .iter()
                .take_while(|b| b.is_ascii_digit())
                .count()
        };
        let mut end = usize::from(matches!(rest[0], b'+' | b'-'));
        let sign = end;
        let whole = digits(end);
        end += whole;
        let (mut real, mut fraction) = (false, 0);
        if rest.get(end) == Some(&b'.') {
            real = true;
            fraction = digits(end + 1);
            end += 1 + fraction;
        }
        let expected = "a number";
        if whole + fraction == 0 {
            return Err(self.damage(expected));
        }
        if matches!(rest.get(end), Some(b'E' | b'e')) {
            let signed = usize::from(matches!(rest.get(end + 1), Some(b'+' | b'-')));
            let power = digits((end + 1 + signed).min(rest.len()));
            if power == 0 {
                return Err(self.damage(expected));
            }
            real = true;
            end += 1 + signed + power;
        }
        // Digits and signs only.
        let text = std::str::from_utf8(&rest[..end]).unwrap_or("");
        let text = if sign == 1 && rest[0] == b'+' {
            &text[1..]
        } else {
            text
        };
        let value = match text.parse::<i64>() {
            Ok(i) if !real => Value::Integer(i),
            _ => match text.parse::<f64>() {
                Ok(x) if x.is_finite() => Value::Real(x),
                _ => return Err(self.damage("a number of a size that can be computed with")),
            },
        };
        if rest
            .get(end)
            .is_some_and(|b| b.is_ascii_alphanumeric() || matches!(b, b'#' | b'.'))
        {
            return Err(self.damage(expected));
        }
        self.at += end;
        Ok(value)
    }

    /// A string from its quote on; two quotes inside stand for one.
    fn text(&mut self) -> Result<&'a [u8], Damage> {
        let rest = self.rest();
        let mut end = 1;
        loop {
            match rest[end..].iter().position(|&b| b == b'\'') {
                None => return Err(self.damage("a string that ends (')")),
                Some(k) if rest.get(end + k + 1) == Some(&b'\'') => end += k + 2,
                Some(k) => {
                    self.at += end + k + 1;
                    return Ok(&rest[1..end + k]);
                }
            }
        }
    }
}
