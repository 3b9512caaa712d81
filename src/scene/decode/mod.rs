//! From the JSON tree to the scene's types through serde, with the place of every fault.
//!
//! serde's derived code stops at the first fault. So that one round tells of all of them, a value that cannot be decoded is
//! reported, replaced by a plain value of the type that was expected, and the tree is decoded again: what else is
//! wrong shows then. Unknown keys are found here, all of them; one that is nearly a known key is read as that key.
mod access;
mod placeholder;
mod state;
mod stop;

use super::json::{Fault, Kind, Member, Node};
use super::problem::{MOST_PROBLEMS, nearest, shorten, suggestion};
use super::types::{BY_AXIS, STANDS_FOR};
use access::{Items, Members, Variant};
use placeholder::Placeholder;
use serde::de::{self, Deserializer, Visitor};
use state::State;
use std::collections::HashSet;
use stop::{Stop, unknown_key};

/// Bytes that are decoded at most, again after every fault: files of many faults are small.
const MOST_DECODED: usize = 64 << 20;

/// What became of a tree.
pub(super) struct Decoded<T> {
    /// The value; where there are faults, with placeholders in their place. None where too much is wrong.
    pub value: Option<T>,
    /// In no order.
    pub faults: Vec<Fault>,
    /// Where values start that placeholders stand for.
    pub replaced: HashSet<usize>,
    /// Where objects start that lack a key, or have one that nobody knows.
    pub incomplete: HashSet<usize>,
    /// Where objects start of which a misspelt key was read as the one that it is like.
    pub misspelt: HashSet<usize>,
}

/// Decodes a tree, and reports all that stands against it.
pub(super) fn decode<'de, T: de::Deserialize<'de>>(root: &'de Node) -> Decoded<T> {
    let rounds = (MOST_DECODED / root.span.len().max(1)).clamp(1, MOST_PROBLEMS);
    let mut stops = Vec::new();
    let mut state = State::default();
    for round in 1.. {
        state.faults.get_mut().clear();
        state.odd.get_mut().clear();
        state.misspelt.get_mut().clear();
        let decoder = Decoder {
            node: root,
            state: &state,
        };
        let stop = match T::deserialize(decoder) {
            Ok(value) => return state.finish(stops, Some(value)),
            Err(stop) => stop.within(root),
        };
        // A value that no placeholder can stand for takes the one around it along.
        let mut goes_on = round < rounds;
        if !state.replace(&stop) {
            goes_on &= state.replace_around(root, stop.node);
        } else {
            stops.push(Fault {
                message: stop.message,
                help: stop.help,
                span: stop.span.unwrap_or_else(|| root.span.clone()),
            });
        }
        if !goes_on {
            break;
        }
    }
    state.finish(stops, None)
}

#[derive(Clone, Copy)]
struct Decoder<'de, 'f> {
    node: &'de Node,
    state: &'f State,
}

impl<'de, 'f> Decoder<'de, 'f> {
    fn with(self, node: &'de Node) -> Self {
        Decoder { node, ..self }
    }

    fn expected(&self, what: &str) -> Stop {
        Stop::new(format!("expected {what}, found {}", self.node.describe())).at(&self.node.span)
    }

    fn number(&self) -> Result<f64, Stop> {
        match &self.node.kind {
            Kind::Number(n) => Ok(*n),
            Kind::Text(t) if t.trim().parse::<f64>().is_ok() => Err(self
                .expected("a number")
                .help("numbers are written without quotes")),
            Kind::Text(_) => Err(self.expected("a number").help(
                "expressions are possible for motions, prescribed displacements and loads only",
            )),
            _ => Err(self.expected("a number")),
        }
    }

    /// A whole number from `min` to `max`.
    fn whole(&self, min: i64, max: u64) -> Result<f64, Stop> {
        let what = match (min, max) {
            (0, max) if max > u64::from(u32::MAX) => "a whole number, 0 or more".to_string(),
            _ => format!("a whole number from {min} to {max}"),
        };
        match &self.node.kind {
            Kind::Number(n) if n.fract() == 0.0 && *n >= min as f64 && *n <= max as f64 => Ok(*n),
            _ => Err(self.expected(&what)),
        }
    }

    /// Passes an object's members with known keys to a visitor; unknown ones become faults.
    fn members<V: Visitor<'de>>(
        self,
        members: &'de [Member],
        known: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        let mut meant: Vec<(&'static str, &'de Node)> = Vec::new();
        let is_known = |m: &Member| known.contains(&m.key.as_str());
        if !members.iter().all(is_known) {
            let mut unused = known.to_vec();
            unused.retain(|k| !members.iter().any(|m| m.key == *k));
            for m in members.iter().filter(|m| !is_known(m)) {
                if self.state.faults.borrow().len() > MOST_PROBLEMS {
                    break;
                }
                match nearest(&m.key, unused.iter().copied()) {
                    Some(near) => {
                        self.state
                            .misspelt
                            .borrow_mut()
                            .insert(self.node.span.start);
                        unused.retain(|k| *k != near);
                        meant.extend(known.iter().filter(|k| **k == near).map(|k| (*k, &m.value)));
                    }
                    None => {
                        self.state.odd.borrow_mut().insert(self.node.span.start);
                    }
                }
                let stop = unknown_key(&m.key, known);
                self.state.faults.borrow_mut().push(Fault {
                    message: stop.message,
                    help: stop.help,
                    span: m.key_span.clone(),
                });
            }
        }
        let access = Members {
            decoder: self,
            members: members.iter(),
            known: Some(known),
            meant: meant.into_iter(),
            lacking: self.lacking(),
            value: None,
        };
        let open = self.node.span.start..self.node.span.start + 1;
        visitor.visit_map(access).map_err(|mut stop| {
            if stop.span.is_none()
                && let Some(missing) = stop.missing
            {
                stop.help = Some(match missing {
                    "covact" => {
                        "a scene starts with the version of its format, `\"covact\": 1`".into()
                    }
                    "covact_study" => {
                        "a study starts with the version of its format, `\"covact_study\": 1`"
                            .into()
                    }
                    _ => format!("known keys: {}", list(known)),
                });
            }
            stop.at(&open)
        })
    }

    /// Keys that this object lacks, as earlier rounds found.
    fn lacking(&self) -> std::slice::Iter<'f, &'static str> {
        let keys = self.state.lacking.get(&self.node.span.start);
        keys.map_or(&[][..], Vec::as_slice).iter()
    }

    /// Whether a placeholder stands for this value.
    fn is_replaced(&self) -> bool {
        matches!(self.node.kind, Kind::Broken)
            || self.state.replaced.contains(&self.node.span.start)
    }

    /// The key that this number or text stands for where an object or a choice of this type is expected.
    fn stands_for(&self, name: &str) -> Option<&'static str> {
        let number = match &self.node.kind {
            Kind::Text(_) => false,
            Kind::Number(_) => true,
            _ => return None,
        };
        let mut forms = STANDS_FOR.iter();
        let form = forms.find(|s| s.name == name && (s.numbers || !number));
        form.map(|s| s.key)
    }

    /// Reads the value as that of the only key of an object.
    fn only_member<V: Visitor<'de>>(self, key: &'static str, visitor: V) -> Result<V::Value, Stop> {
        visitor.visit_map(Members {
            decoder: self,
            members: [].iter(),
            known: None,
            meant: vec![(key, self.node)].into_iter(),
            lacking: [].iter(),
            value: None,
        })
    }

    /// Reads a list of three values as an object of `x`, `y` and `z`.
    fn by_axis<V: Visitor<'de>>(self, items: &'de [Node], visitor: V) -> Result<V::Value, Stop> {
        let [x, y, z] = items else {
            return Err(self
                .expected("an object, or a list of 3 values")
                .help("a list has one value each for `x`, `y` and `z`; `null` leaves one out"));
        };
        visitor.visit_map(Members {
            decoder: self,
            members: [].iter(),
            known: None,
            meant: vec![("x", x), ("y", y), ("z", z)].into_iter(),
            lacking: [].iter(),
            value: None,
        })
    }

    fn object<V: Visitor<'de>>(
        self,
        known: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        match &self.node.kind {
            Kind::Object(members) => self.members(members, known, visitor),
            _ => Err(self
                .expected("an object")
                .help(format!("known keys: {}", list(known)))),
        }
    }
}

/// Whether a word is like one of the names; paths and expressions are no words.
fn is_nearly(text: &str, names: &[&str]) -> bool {
    let word = text.chars().all(|c| c.is_alphanumeric() || c == '_');
    word && nearest(text, names.iter().copied()).is_some()
}

fn list(names: &[&str]) -> String {
    let quoted: Vec<String> = names
        .iter()
        .filter(|n| !n.starts_with('$'))
        .map(|n| format!("`{n}`"))
        .collect();
    quoted.join(", ")
}

macro_rules! whole_numbers {
    ($($method:ident $visit:ident $type:ty),*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
            if self.is_replaced() {
                return Placeholder.$method(visitor);
            }
            let n = self.whole(<$type>::MIN as i64, <$type>::MAX as u64)?;
            visitor.$visit(n as $type).map_err(|e: Stop| e.at(&self.node.span))
        }
    )*};
}

impl<'de> Deserializer<'de> for Decoder<'de, '_> {
    type Error = Stop;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        if self.is_replaced() {
            return Placeholder.deserialize_any(visitor);
        }
        let result = match &self.node.kind {
            Kind::Null | Kind::Broken => visitor.visit_unit(),
            Kind::Bool(b) => visitor.visit_bool(*b),
            Kind::Number(n) => visitor.visit_f64(*n),
            Kind::Text(t) => visitor.visit_borrowed_str(t),
            Kind::Array(_) => return self.deserialize_seq(visitor),
            Kind::Object(_) => return self.deserialize_map(visitor),
        };
        result.map_err(|e: Stop| e.at(&self.node.span))
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        if self.is_replaced() {
            return Placeholder.deserialize_bool(visitor);
        }
        match self.node.kind {
            Kind::Bool(b) => visitor
                .visit_bool(b)
                .map_err(|e: Stop| e.at(&self.node.span)),
            _ => Err(self.expected("true or false")),
        }
    }

    whole_numbers!(
        deserialize_u8 visit_u8 u8, deserialize_u16 visit_u16 u16, deserialize_u32 visit_u32 u32,
        deserialize_u64 visit_u64 u64, deserialize_i8 visit_i8 i8, deserialize_i16 visit_i16 i16,
        deserialize_i32 visit_i32 i32, deserialize_i64 visit_i64 i64
    );

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        self.deserialize_f64(visitor)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        if self.is_replaced() {
            return Placeholder.deserialize_f64(visitor);
        }
        visitor
            .visit_f64(self.number()?)
            .map_err(|e: Stop| e.at(&self.node.span))
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        if self.is_replaced() {
            return Placeholder.deserialize_str(visitor);
        }
        match &self.node.kind {
            Kind::Text(t) => visitor
                .visit_borrowed_str(t)
                .map_err(|e: Stop| e.at(&self.node.span)),
            _ => Err(self.expected("text between double quotes")),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        self.deserialize_str(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        if self.is_replaced() {
            return Placeholder.deserialize_option(visitor);
        }
        match self.node.kind {
            Kind::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        if self.is_replaced() {
            return Placeholder.deserialize_seq(visitor);
        }
        match &self.node.kind {
            Kind::Array(items) => {
                let access = Items {
                    decoder: self,
                    items: items.iter(),
                };
                visitor.visit_seq(access).map_err(|e| e.at(&self.node.span))
            }
            _ => Err(self.expected("a list `[...]`")),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Stop> {
        if self.is_replaced() {
            return Placeholder.deserialize_tuple(len, visitor);
        }
        match &self.node.kind {
            Kind::Array(items) if items.len() == len => self.deserialize_seq(visitor),
            _ => Err(self.expected(&format!("a list of {len} values"))),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        if self.is_replaced() {
            return Placeholder.deserialize_map(visitor);
        }
        match &self.node.kind {
            Kind::Object(members) => {
                let access = Members {
                    decoder: self,
                    members: members.iter(),
                    known: None,
                    meant: Vec::new().into_iter(),
                    lacking: self.lacking(),
                    value: None,
                };
                visitor.visit_map(access).map_err(|e| e.at(&self.node.span))
            }
            _ => Err(self.expected("an object `{\"name\": ...}`")),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        if self.is_replaced() {
            return Placeholder.deserialize_struct(name, fields, visitor);
        }
        match (self.stands_for(name), &self.node.kind) {
            (Some(key), _) => self.only_member(key, visitor),
            (None, Kind::Array(items)) if BY_AXIS.contains(&name) => self.by_axis(items, visitor),
            (None, _) => self.object(fields, visitor),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        type_name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        if self.is_replaced() {
            return Placeholder.deserialize_enum(type_name, variants, visitor);
        }
        let short = self.stands_for(type_name);
        let (name, span, content) = match &self.node.kind {
            Kind::Text(t) if variants.contains(&t.as_str()) => (t.as_str(), &self.node.span, None),
            // A word that is nearly the name of a variant is meant to be that.
            Kind::Text(t) => match short.filter(|_| !is_nearly(t, variants)) {
                Some(key) => (key, &self.node.span, Some(self.node)),
                None => (t.as_str(), &self.node.span, None),
            },
            Kind::Number(_) if short.is_some() => {
                (short.unwrap_or_default(), &self.node.span, Some(self.node))
            }
            Kind::Object(members) => match members.as_slice() {
                [only] => (only.key.as_str(), &only.key_span, Some(&only.value)),
                [] => {
                    return Err(self
                        .expected("an object with one key")
                        .help(format!("one of: {}", list(variants))));
                }
                [_, second, ..] => {
                    return Err(Stop::new(format!(
                        "`{}` is one key too many",
                        shorten(&second.key)
                    ))
                    .help(format!("exactly one of: {}", list(variants)))
                    .at(&second.key_span));
                }
            },
            _ => return Err(self.expected(&format!("one of {}", list(variants)))),
        };
        if !variants.contains(&name) {
            return Err(Stop::new(format!("unknown name `{}`", shorten(name)))
                .help(suggestion(name, "known names", variants.iter().copied()))
                .at(span));
        }
        let access = Variant {
            decoder: self,
            name,
            span,
            content,
        };
        visitor
            .visit_enum(access)
            .map_err(|e| e.at(&self.node.span))
    }

    serde::forward_to_deserialize_any! {
        char bytes byte_buf unit unit_struct newtype_struct tuple_struct identifier ignored_any
    }
}
