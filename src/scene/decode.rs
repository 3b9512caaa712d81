//! From the JSON tree to the scene's types through serde, with the place of every fault.
//!
//! serde's derived code tells a deserializer the keys and variants it knows, so unknown ones are found here, all of
//! them, before the derived code would stop at the first.
use super::json::{Fault, Kind, MORE, Member, Node};
use super::problem::{MOST_PROBLEMS, nearest, shorten, suggestion};
use serde::de::{self, DeserializeSeed, Deserializer, IntoDeserializer, Unexpected, Visitor};
use std::cell::RefCell;
use std::fmt;
use std::ops::Range;

/// Decodes a tree. All unknown keys are reported, and the first fault of another kind.
pub(super) fn decode<'de, T: de::Deserialize<'de>>(root: &'de Node) -> Result<T, Vec<Fault>> {
    let faults = RefCell::new(Vec::new());
    let decoded = T::deserialize(Decoder {
        node: root,
        faults: &faults,
    });
    let mut faults = faults.into_inner();
    match decoded {
        Ok(value) if faults.is_empty() => Ok(value),
        Ok(_) => Err(faults),
        Err(stop) => {
            // A key that is missing because it was misspelt is one mistake, not two.
            if !stop.told || faults.is_empty() {
                faults.push(Fault {
                    message: stop.message,
                    help: stop.help,
                    span: stop.span.unwrap_or_else(|| root.span.clone()),
                });
            }
            Err(faults)
        }
    }
}

/// The fault that stops decoding.
#[derive(Debug)]
pub(super) struct Stop {
    message: String,
    help: Option<String>,
    span: Option<Range<usize>>,
    /// The key that is missing.
    missing: Option<&'static str>,
    /// Already explained by another fault.
    told: bool,
}

impl Stop {
    fn new(message: impl Into<String>) -> Stop {
        Stop {
            message: message.into(),
            help: None,
            span: None,
            missing: None,
            told: false,
        }
    }

    fn help(mut self, help: impl Into<String>) -> Stop {
        self.help = Some(help.into());
        self
    }

    /// Sets the place unless a more inner one is known.
    fn at(mut self, span: &Range<usize>) -> Stop {
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
            Unexpected::Seq => "a list".into(),
            Unexpected::Map => "an object".into(),
            Unexpected::Unit | Unexpected::Option => "null".into(),
            other => other.to_string(),
        };
        Stop::new(format!("expected {expected}, found {found}"))
    }
}

fn unknown_key(key: &str, known: &'static [&'static str]) -> Stop {
    Stop::new(format!("unknown key `{}`", shorten(key))).help(suggestion(
        key,
        "known keys",
        known.iter().copied().filter(|k| !k.starts_with('$')),
    ))
}

#[derive(Clone, Copy)]
struct Decoder<'de, 'f> {
    node: &'de Node,
    faults: &'f RefCell<Vec<Fault>>,
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
        let mut meant: Vec<&str> = Vec::new();
        let mut unused = known.to_vec();
        if members.iter().any(|m| !known.contains(&m.key.as_str())) {
            unused.retain(|k| !members.iter().any(|m| m.key == *k));
        }
        for m in members.iter().filter(|m| !known.contains(&m.key.as_str())) {
            if self.faults.borrow().len() >= MOST_PROBLEMS {
                return Err(Stop::new(MORE).at(&m.key_span));
            }
            meant.extend(nearest(&m.key, unused.iter().copied()));
            let stop = unknown_key(&m.key, known);
            self.faults.borrow_mut().push(Fault {
                message: stop.message,
                help: stop.help,
                span: m.key_span.clone(),
            });
        }
        let access = Members {
            decoder: self,
            members: members.iter(),
            known: Some(known),
            value: None,
        };
        let open = self.node.span.start..self.node.span.start + 1;
        visitor.visit_map(access).map_err(|mut stop| {
            if stop.span.is_none()
                && let Some(missing) = stop.missing
            {
                stop.told = meant.contains(&missing);
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
            let n = self.whole(<$type>::MIN as i64, <$type>::MAX as u64)?;
            visitor.$visit(n as $type).map_err(|e: Stop| e.at(&self.node.span))
        }
    )*};
}

impl<'de> Deserializer<'de> for Decoder<'de, '_> {
    type Error = Stop;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        let result = match &self.node.kind {
            Kind::Null => visitor.visit_unit(),
            Kind::Bool(b) => visitor.visit_bool(*b),
            Kind::Number(n) => visitor.visit_f64(*n),
            Kind::Text(t) => visitor.visit_borrowed_str(t),
            Kind::Array(_) => return self.deserialize_seq(visitor),
            Kind::Object(_) => return self.deserialize_map(visitor),
        };
        result.map_err(|e: Stop| e.at(&self.node.span))
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
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
        visitor
            .visit_f64(self.number()?)
            .map_err(|e: Stop| e.at(&self.node.span))
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
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
        match self.node.kind {
            Kind::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
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
        match &self.node.kind {
            Kind::Array(items) if items.len() == len => self.deserialize_seq(visitor),
            _ => Err(self.expected(&format!("a list of {len} values"))),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        match &self.node.kind {
            Kind::Object(members) => {
                let access = Members {
                    decoder: self,
                    members: members.iter(),
                    known: None,
                    value: None,
                };
                visitor.visit_map(access).map_err(|e| e.at(&self.node.span))
            }
            _ => Err(self.expected("an object `{\"name\": ...}`")),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        self.object(fields, visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        let (name, span, content) = match &self.node.kind {
            Kind::Text(t) => (t, &self.node.span, None),
            Kind::Object(members) => match members.as_slice() {
                [only] => (&only.key, &only.key_span, Some(&only.value)),
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
        if !variants.contains(&name.as_str()) {
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

struct Items<'de, 'f> {
    decoder: Decoder<'de, 'f>,
    items: std::slice::Iter<'de, Node>,
}

impl<'de> de::SeqAccess<'de> for Items<'de, '_> {
    type Error = Stop;
    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Stop> {
        let Some(node) = self.items.next() else {
            return Ok(None);
        };
        seed.deserialize(self.decoder.with(node)).map(Some)
    }
    fn size_hint(&self) -> Option<usize> {
        Some(self.items.len())
    }
}

struct Members<'de, 'f> {
    decoder: Decoder<'de, 'f>,
    members: std::slice::Iter<'de, Member>,
    /// Only these keys are passed on; none: all.
    known: Option<&'static [&'static str]>,
    value: Option<&'de Node>,
}

impl<'de> de::MapAccess<'de> for Members<'de, '_> {
    type Error = Stop;
    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Stop> {
        let known = self.known;
        let Some(m) = self
            .members
            .find(|m| known.is_none_or(|k| k.contains(&m.key.as_str())))
        else {
            return Ok(None);
        };
        self.value = Some(&m.value);
        let key = m.key.as_str().into_deserializer();
        seed.deserialize(key)
            .map(Some)
            .map_err(|e: Stop| e.at(&m.key_span))
    }
    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Stop> {
        match self.value.take() {
            Some(node) => seed.deserialize(self.decoder.with(node)),
            None => Err(Stop::new("a value was asked for before its key")),
        }
    }
}

struct Variant<'de, 'f> {
    decoder: Decoder<'de, 'f>,
    name: &'de str,
    span: &'de Range<usize>,
    content: Option<&'de Node>,
}

impl<'de, 'f> Variant<'de, 'f> {
    fn content(&self, form: &str) -> Result<Decoder<'de, 'f>, Stop> {
        let missing = || {
            Stop::new(format!("`{}` needs a value", self.name))
                .help(format!("write `{{\"{}\": {form}}}`", self.name))
                .at(self.span)
        };
        self.content
            .map(|node| self.decoder.with(node))
            .ok_or_else(missing)
    }
}

impl<'de, 'f> de::EnumAccess<'de> for Variant<'de, 'f> {
    type Error = Stop;
    type Variant = Self;
    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Stop> {
        let variant = seed.deserialize(self.name.into_deserializer());
        variant.map(|v| (v, self))
    }
}

impl<'de> de::VariantAccess<'de> for Variant<'de, '_> {
    type Error = Stop;
    fn unit_variant(self) -> Result<(), Stop> {
        match self.content {
            None => Ok(()),
            Some(_) => Err(Stop::new(format!("`{}` takes no value", self.name))
                .help(format!("write `\"{}\"`", self.name))
                .at(self.span)),
        }
    }
    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Stop> {
        seed.deserialize(self.content("...")?)
    }
    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Stop> {
        self.content("[...]")?.deserialize_tuple(len, visitor)
    }
    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        self.content("{...}")?.object(fields, visitor)
    }
}
