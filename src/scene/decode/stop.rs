//! Why decoding stops, in the words of scenes.
use crate::scene::json::Node;
use crate::scene::problem::{shorten, suggestion};
use serde::de::{self, Unexpected};
use std::fmt;
use std::ops::Range;

/// The fault that stops decoding.
#[derive(Debug)]
pub(in crate::scene) struct Stop {
    pub message: String,
    pub help: Option<String>,
    pub span: Option<Range<usize>>,
    /// The key that is missing.
    pub missing: Option<&'static str>,
    /// Start of the innermost value that could not be decoded.
    pub node: Option<usize>,
}

impl Stop {
    pub fn new(message: impl Into<String>) -> Stop {
        Stop {
            message: message.into(),
            help: None,
            span: None,
            missing: None,
            node: None,
        }
    }

    pub fn help(mut self, help: impl Into<String>) -> Stop {
        self.help = Some(help.into());
        self
    }

    /// Names the value that cannot be decoded, unless a more inner one is known.
    pub fn within(mut self, node: &Node) -> Stop {
        self.node.get_or_insert(node.span.start);
        self.at(&node.span)
    }

    /// Sets the place unless a more inner one is known.
    pub fn at(mut self, span: &Range<usize>) -> Stop {
        self.span.get_or_insert_with(|| span.clone());
        self
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}
impl std::error::Error for Stop {}

impl de::Error for Stop {
    fn custom<T: fmt::Display>(message: T) -> Stop {
        Stop::new(message.to_string())
    }
    fn missing_field(field: &'static str) -> Stop {
        let mut stop = Stop::new(format!("the key `{field}` is missing"));
        stop.missing = Some(field);
        stop
    }
    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Stop {
        unknown_key(field, expected)
    }
    fn invalid_type(found: Unexpected<'_>, expected: &dyn de::Expected) -> Stop {
        let found = match found {
            Unexpected::Bool(b) => b.to_string(),
            Unexpected::Str(s) => format!("the text \"{}\"", shorten(s)),
            Unexpected::Float(n) => format!("the number {n}"),
            Unexpected::Seq => "a list".into(),
            Unexpected::Map => "an object".into(),
            Unexpected::Unit | Unexpected::Option => "null".into(),
            other => other.to_string(),
        };
        Stop::new(format!("expected {expected}, found {found}"))
    }
}

pub fn unknown_key(key: &str, known: &'static [&'static str]) -> Stop {
    Stop::new(format!("unknown key `{}`", shorten(key))).help(suggestion(
        key,
        "known keys",
        known.iter().copied().filter(|k| !k.starts_with('$')),
    ))
}
