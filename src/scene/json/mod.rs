//! JSON text as a tree in which every value and key knows its place.
//!
//! A scene is written by hand, so what matters is to say precisely what is wrong and where. JSON (RFC 8259) with comments
//! (`// ...`, `/* ... */`) and trailing commas; a key may be given once. After a fault that leaves the structure clear
//! (a missing comma, a malformed number) reading goes on, so that one round tells of all of them.
mod lexical;
mod reader;

use super::problem::{MOST_IN_NAME, shorten};
pub(super) use reader::read;
use serde_json::Value as Json;
use std::ops::Range;

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
    /// Something that is no value, which has been reported.
    Broken,
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
            Kind::Broken => "no value".into(),
        }
    }

    /// The same as plain JSON.
    pub fn to_json(&self) -> Json {
        // Whole numbers without a fraction, as they are written.
        let number = |n: f64| match n.fract() == 0.0 && n.abs() < 9e15 {
            true => Json::from(n as i64),
            false => Json::from(n),
        };
        match &self.kind {
            Kind::Null | Kind::Broken => Json::Null,
            Kind::Bool(b) => Json::Bool(*b),
            Kind::Number(n) => number(*n),
            Kind::Text(t) => Json::String(t.clone()),
            Kind::Array(items) => items.iter().map(Node::to_json).collect(),
            Kind::Object(members) => {
                let members = members.iter().map(|m| (m.key.clone(), m.value.to_json()));
                Json::Object(members.collect())
            }
        }
    }

    /// The child of a JSON pointer's reference token (already unescaped), with the span of its key.
    pub fn child(&self, token: &str) -> Option<(&Node, Range<usize>)> {
        match &self.kind {
            Kind::Object(members) => members
                .iter()
                .find(|m| m.key == token)
                .map(|m| (&m.value, m.key_span.clone())),
            Kind::Array(items) => {
                // Of a list that stands for an object of `x`, `y` and `z`.
                let axis = ["x", "y", "z"].iter().position(|axis| *axis == token);
                let index = axis.filter(|_| items.len() == 3);
                let node = items.get(index.or_else(|| token.parse().ok())?);
                node.map(|n| (n, n.span.clone()))
            }
            _ => None,
        }
    }

    /// The child that holds a byte of the text.
    pub fn child_at(&self, offset: usize) -> Option<&Node> {
        match &self.kind {
            Kind::Object(members) => {
                (members.iter().map(|m| &m.value)).find(|n| n.span.contains(&offset))
            }
            Kind::Array(items) => items.iter().find(|n| n.span.contains(&offset)),
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
