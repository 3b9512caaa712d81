//! The sets that something acts on.
use schemars::JsonSchema;
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A set, `body.set`, or a list of sets, which count as one.
#[derive(Debug, Clone, PartialEq, Eq, JsonSchema)]
#[schemars(untagged)]
pub enum SetNames {
    /// One set.
    One(String),
    /// Several sets.
    List(Vec<String>),
}

impl From<&str> for SetNames {
    fn from(set: &str) -> Self {
        SetNames::One(set.to_owned())
    }
}

impl<const N: usize> From<[&str; N]> for SetNames {
    fn from(sets: [&str; N]) -> Self {
        SetNames::List(sets.map(str::to_owned).to_vec())
    }
}

impl From<String> for SetNames {
    fn from(set: String) -> Self {
        SetNames::One(set)
    }
}

impl From<&String> for SetNames {
    fn from(set: &String) -> Self {
        SetNames::One(set.clone())
    }
}

impl SetNames {
    /// The only name; of several, or none, the empty one, which nothing has.
    pub fn single(&self) -> &str {
        match self.as_slice() {
            [name] => name,
            _ => "",
        }
    }

    /// The body of the first set.
    pub fn body(&self) -> &str {
        let first = self.iter().next().unwrap_or_default();
        first.split_once('.').map_or(first, |(body, _)| body)
    }

    /// The names in their order.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        self.as_slice().iter().map(String::as_str)
    }

    /// The names with the JSON pointers of each; `at` is that of the whole.
    pub fn places(&self, at: &str) -> impl Iterator<Item = (String, &str)> {
        let list = matches!(self, SetNames::List(_));
        (self.iter().enumerate()).map(move |(i, name)| match list {
            true => (format!("{at}/{i}"), name),
            false => (at.to_owned(), name),
        })
    }

    fn as_slice(&self) -> &[String] {
        match self {
            SetNames::One(name) => std::slice::from_ref(name),
            SetNames::List(names) => names,
        }
    }
}

impl fmt::Display for SetNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.as_slice().join(", "))
    }
}

impl Serialize for SetNames {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            SetNames::One(name) => serializer.serialize_str(name),
            SetNames::List(names) => names.serialize(serializer),
        }
    }
}

// serde's own reading of untagged enums forgets where a fault was.
impl<'de> Deserialize<'de> for SetNames {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<SetNames, D::Error> {
        deserializer.deserialize_newtype_struct("SetNames", SetNamesVisitor)
    }
}

struct SetNamesVisitor;

impl<'de> Visitor<'de> for SetNamesVisitor {
    type Value = SetNames;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a set, `\"body.set\"`, or a list of sets")
    }
    fn visit_newtype_struct<D: Deserializer<'de>>(self, inner: D) -> Result<SetNames, D::Error> {
        inner.deserialize_any(self)
    }
    fn visit_str<E: de::Error>(self, name: &str) -> Result<SetNames, E> {
        Ok(SetNames::One(name.to_owned()))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<SetNames, A::Error> {
        let mut names = Vec::new();
        while let Some(name) = seq.next_element()? {
            names.push(name);
        }
        Ok(SetNames::List(names))
    }
}
