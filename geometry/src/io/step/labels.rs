//! Layers and colours (ISO 10303-46).

use super::entity::Entity;
use super::exchange::Exchange;
use super::scan::{Item, Value};
use super::schema::is_a;
use std::collections::HashMap;
use std::rc::Rc;

/// From a styled item down to its colour there are at most this many references.
const DEPTH: usize = 8;
/// Instances looked at for the colour of one item.
const STEPS: usize = 64;

/// Names of the layers and colours of items.
#[derive(Default)]
pub struct Labels {
    layers: HashMap<u32, Rc<str>>,
    colours: HashMap<u32, Rc<str>>,
}

impl Labels {
    pub fn read(exchange: &Exchange) -> Self {
        let mut labels = Self::default();
        let mut assignments = Vec::new();
        // What a styled item styles: layers may name either.
        let mut styled = HashMap::new();
        for index in 0..exchange.len() as u32 {
            let keywords = exchange.keywords(index);
            let is = |kind: &str| keywords.iter().any(|k| is_a(k, kind));
            if is("PRESENTATION_LAYER_ASSIGNMENT") {
                assignments.push(index);
            } else if is("STYLED_ITEM")
                && let Ok(entity) = Entity::read(exchange, index)
                && let Ok(item) = entity.reference("STYLED_ITEM", 1, "a styled item")
            {
                styled.insert(index, item);
                if let Some(colour) = colour_of(exchange, &entity) {
                    // Another style of the same item overrides: the first one that is read stays.
                    labels.colours.entry(item).or_insert(colour.into());
                }
            }
        }
        for index in assignments {
            let Ok(entity) = Entity::read(exchange, index) else {
                continue;
            };
            let kind = "PRESENTATION_LAYER_ASSIGNMENT";
            let name = entity.text(kind, 0).or_else(|| entity.text(kind, 1));
            let items = entity.targets(kind, 2, "an item of a layer");
            if let (Some(name), Ok(items)) = (name, items) {
                let name: Rc<str> = name.into();
                for item in items {
                    let item = styled.get(&item).copied().unwrap_or(item);
                    labels.layers.entry(item).or_insert(Rc::clone(&name));
                }
            }
        }
        labels
    }

    /// The layer of the first of some items that has one.
    pub fn layer(&self, items: &[u32]) -> Option<String> {
        let found = items.iter().find_map(|item| self.layers.get(item));
        found.map(|name| name.to_string())
    }

    /// The colour of the first of some items that has one.
    pub fn colour(&self, items: &[u32]) -> Option<String> {
        let found = items.iter().find_map(|item| self.colours.get(item));
        found.map(|name| name.to_string())
    }
}

/// The colour of the surfaces of a styled item, by following its styles.
fn colour_of(exchange: &Exchange, item: &Entity) -> Option<String> {
    let mut open: Vec<(u32, usize)> = Vec::new();
    let styles = item.targets("STYLED_ITEM", 0, "a style").ok()?;
    open.extend(styles.into_iter().rev().map(|s| (s, 0)));
    for _ in 0..STEPS {
        let (index, depth) = open.pop()?;
        let Ok(entity) = Entity::read(exchange, index) else {
            continue;
        };
        if entity.is("COLOUR_RGB") {
            if let Some(name) = entity.text("COLOUR_SPECIFICATION", 0) {
                return Some(name);
            }
            let part = |k: usize| {
                let share = entity.real("COLOUR_RGB", k, "a part of a colour").ok()?;
                // The cast takes what is outside to the limits.
                Some((share * 255.0).round() as u8)
            };
            let (r, g, b) = (part(0)?, part(1)?, part(2)?);
            return Some(format!("#{r:02x}{g:02x}{b:02x}"));
        }
        if entity.is("PRE_DEFINED_COLOUR") {
            return entity.text("PRE_DEFINED_ITEM", 0);
        }
        // The colours of edges and points are others.
        let kind = entity.kind();
        if depth < DEPTH && !kind.contains("CURVE_STYLE") && !kind.contains("POINT_STYLE") {
            let mut next = Vec::new();
            entity.each_reference(&mut |item| next.push(item));
            let found = next.into_iter().filter_map(|name| exchange.find(name));
            open.extend(found.map(|index| (index, depth + 1)));
        }
    }
    None
}

/// Calls `f` with every name among values, lists inside of lists included.
pub fn references(items: &[Item], f: &mut impl FnMut(u64)) {
    for item in items {
        match &item.value {
            Value::Reference(name) => f(*name),
            // Lists are nested no deeper than they are read.
            Value::List(inner) | Value::Typed(_, inner) => references(inner, f),
            _ => {}
        }
    }
}
