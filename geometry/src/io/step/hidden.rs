//! What the CAD system does not show: INVISIBILITY of styled items, layers and representations (ISO 10303-46).
//!
//! A null style alone hides nothing: systems give it to items that inherit their appearance.

use super::entity::{Entity, Told};
use super::exchange::Exchange;
use super::schema::is_a;
use std::collections::HashMap;

/// Numbers of the instances that are hidden, each with that of the INVISIBILITY that hides it.
#[derive(Default)]
pub struct Hidden {
    everywhere: HashMap<u32, u32>,
    /// Pairs of an occurrence (or mapped item) and an item that is hidden in that copy of its product only.
    within: HashMap<(u32, u32), u32>,
}

impl Hidden {
    pub fn read(exchange: &Exchange) -> Self {
        let mut hidden = Self::default();
        for index in 0..exchange.len() as u32 {
            let keywords = exchange.keywords(index);
            // Of a subtype with a context, which hides in one view only, nothing is read.
            if keywords == [b"INVISIBILITY"]
                && let Ok(entity) = Entity::read(exchange, index)
                && let Ok(items) = entity.targets("INVISIBILITY", 0, "a hidden item")
            {
                for item in items {
                    hidden.hide(exchange, item, index);
                }
            }
        }
        hidden
    }

    fn hide(&mut self, exchange: &Exchange, index: u32, by: u32) {
        let keywords = exchange.keywords(index);
        let is = |kind: &str| keywords.iter().any(|k| is_a(k, kind));
        if is("PRESENTATION_LAYER_ASSIGNMENT") {
            let kind = "PRESENTATION_LAYER_ASSIGNMENT";
            let items = Entity::read(exchange, index)
                .and_then(|layer| layer.targets(kind, 2, "an item of a layer"));
            for item in items.unwrap_or_default() {
                let keywords = exchange.keywords(item);
                match keywords.iter().any(|k| is_a(k, "STYLED_ITEM")) {
                    true => self.styled(exchange, item, by),
                    false => self.everywhere(item, by),
                }
            }
        } else if is("STYLED_ITEM") {
            self.styled(exchange, index, by);
        } else {
            self.everywhere(index, by);
        }
    }

    fn everywhere(&mut self, item: u32, by: u32) {
        self.everywhere.entry(item).or_insert(by);
    }

    /// Hides what a styled item styles: in the copies that its styles are for, or wherever it stands.
    fn styled(&mut self, exchange: &Exchange, index: u32, by: u32) {
        let read = || -> Told<(u32, Vec<u32>)> {
            let entity = Entity::read(exchange, index)?;
            let item = entity.reference("STYLED_ITEM", 1, "a styled item")?;
            let styles = entity.targets("STYLED_ITEM", 0, "a style")?;
            let copies = styles.iter().filter_map(|&s| copy_of(exchange, s));
            Ok((item, copies.collect()))
        };
        let Ok((item, copies)) = read() else {
            return;
        };
        for &copy in &copies {
            self.within.entry((copy, item)).or_insert(by);
        }
        if copies.is_empty() {
            self.everywhere(item, by);
        }
    }

    /// What hides an instance wherever it stands.
    pub fn item(&self, index: u32) -> Option<u32> {
        self.everywhere.get(&index).copied()
    }

    /// What hides an item in one of the copies `chain`.
    pub fn within(&self, chain: &[u32], item: u32) -> Option<u32> {
        if self.within.is_empty() {
            return None;
        }
        let found = chain.iter().filter_map(|&c| self.within.get(&(c, item)));
        found.copied().next()
    }
}

/// The occurrence or mapped item that a PRESENTATION_STYLE_BY_CONTEXT is for.
fn copy_of(exchange: &Exchange, style: u32) -> Option<u32> {
    let style = Entity::read(exchange, style).ok()?;
    let kind = "PRESENTATION_STYLE_BY_CONTEXT";
    if !style.is(kind) {
        return None;
    }
    let context = style.reference(kind, 0, "the context of a style").ok()?;
    let context = Entity::read(exchange, context).ok()?;
    let kind = "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION";
    if context.is(kind) {
        let what = "an occurrence";
        let shape = context.member(kind, 1, "PROPERTY_DEFINITION", what).ok()?;
        return shape.reference("PROPERTY_DEFINITION", 2, what).ok();
    }
    let copy = context.is("MAPPED_ITEM") || context.is("NEXT_ASSEMBLY_USAGE_OCCURRENCE");
    copy.then_some(context.index)
}
