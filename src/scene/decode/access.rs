//! Lists, objects and choices as serde walks through them.
use super::Decoder;
use super::placeholder::Placeholder;
use super::stop::Stop;
use crate::scene::json::{Kind, Member, Node};
use crate::scene::types::WITH_DEFAULTS;
use serde::de::value::MapDeserializer;
use serde::de::{self, DeserializeSeed, Deserializer, IntoDeserializer, Visitor};
use std::ops::Range;

pub(super) struct Items<'de, 'f> {
    pub decoder: Decoder<'de, 'f>,
    pub items: std::slice::Iter<'de, Node>,
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
        let value = seed.deserialize(self.decoder.with(node));
        value.map(Some).map_err(|e| e.within(node))
    }
    fn size_hint(&self) -> Option<usize> {
        Some(self.items.len())
    }
}

pub(super) struct Members<'de, 'f> {
    pub decoder: Decoder<'de, 'f>,
    pub members: std::slice::Iter<'de, Member>,
    /// Only these keys are passed on; none: all.
    pub known: Option<&'static [&'static str]>,
    /// Further keys: those that misspelt ones are read as, and those that are not written.
    pub meant: std::vec::IntoIter<(&'static str, &'de Node)>,
    /// Keys for which there are placeholders.
    pub lacking: std::slice::Iter<'f, &'static str>,
    /// The value of the key before; none: a placeholder.
    pub value: Option<&'de Node>,
}

impl<'de> de::MapAccess<'de> for Members<'de, '_> {
    type Error = Stop;
    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Stop> {
        let known = self.known;
        let written = (self.members)
            .find(|m| known.is_none_or(|k| k.contains(&m.key.as_str())))
            .map(|m| (m.key.as_str(), Some(&m.value), &m.key_span));
        let span = &self.decoder.node.span;
        let meant = || (self.meant.next()).map(|(key, node)| (key, Some(node), span));
        let Some((key, value, span)) =
            (written.or_else(meant)).or_else(|| self.lacking.next().map(|key| (*key, None, span)))
        else {
            return Ok(None);
        };
        self.value = value;
        let key = seed.deserialize(key.into_deserializer());
        key.map(Some).map_err(|e: Stop| e.at(span))
    }
    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Stop> {
        match self.value.take() {
            Some(node) => {
                let value = seed.deserialize(self.decoder.with(node));
                value.map_err(|e| e.within(node))
            }
            None => seed.deserialize(Placeholder),
        }
    }
}

pub(super) struct Variant<'de, 'f> {
    pub decoder: Decoder<'de, 'f>,
    pub name: &'de str,
    pub span: &'de Range<usize>,
    pub content: Option<&'de Node>,
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
        if self.content.is_none() && WITH_DEFAULTS.contains(&self.name) {
            let nothing = std::iter::empty::<(&str, &str)>();
            return seed.deserialize(MapDeserializer::new(nothing));
        }
        let content = self.content("...")?;
        (seed.deserialize(content)).map_err(|e| e.within(content.node))
    }
    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Stop> {
        self.content("[...]")?.deserialize_tuple(len, visitor)
    }
    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        let content = self.content("{...}")?;
        if content.is_replaced() {
            return Placeholder.deserialize_struct("", fields, visitor);
        }
        let result = match (fields, &content.node.kind) {
            // The only key need not be written.
            ([only], Kind::Number(_) | Kind::Text(_)) => content.only_member(only, visitor),
            _ => content.object(fields, visitor),
        };
        result.map_err(|e| e.within(content.node))
    }
}
