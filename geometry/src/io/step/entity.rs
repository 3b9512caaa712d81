//! Instances with their attributes by type and number, and errors that say where the file is wrong.

use super::exchange::{Exchange, Leaf};
use super::scan::{Item, Value};
use super::schema::{inherited, is_a};
use super::text::decode;

/// Characters of a text that are kept: names are copied to everything that bears them.
const LONGEST: usize = 1024;

/// An instance of a file.
pub struct Entity<'e, 'a> {
    pub exchange: &'e Exchange<'a>,
    /// Its number.
    pub index: u32,
    leaves: Vec<Leaf<'a>>,
}

/// Why something cannot be read, in words, with its place in the file where there is one.
pub type Told<T> = Result<T, String>;

impl<'e, 'a> Entity<'e, 'a> {
    pub fn read(exchange: &'e Exchange<'a>, index: u32) -> Told<Self> {
        let leaves = exchange.leaves(index)?;
        Ok(Self {
            exchange,
            index,
            leaves,
        })
    }

    /// Whether the instance is one of `kind`.
    pub fn is(&self, kind: &str) -> bool {
        self.leaves.iter().any(|l| is_a(l.keyword, kind))
    }

    /// The type, or the types of an instance of several.
    pub fn kind(&self) -> String {
        kind_of(self.leaves.iter().map(|l| l.keyword))
    }

    /// "#12 (PLANE)"
    pub fn describe(&self) -> String {
        format!("#{} ({})", self.exchange.name(self.index), self.kind())
    }

    /// Attribute `k` of those that the type `kind` adds to its supertypes'.
    pub fn attribute(&self, kind: &str, k: usize, what: &str) -> Told<&Item<'a>> {
        let (leaf, at) = match &self.leaves[..] {
            [one] if is_a(one.keyword, kind) => (Some(one), inherited(kind) + k),
            several => {
                let own = |l: &&Leaf| l.keyword == kind.as_bytes();
                (several.iter().find(own), k)
            }
        };
        let Some(leaf) = leaf else {
            let place = self.exchange.at(self.index);
            let text = self
                .exchange
                .told(place, &format!("{what} of a {kind}"), &self.kind());
            return Err(text);
        };
        leaf.items.get(at).ok_or_else(|| {
            let found = format!("{} values", leaf.items.len());
            self.exchange
                .told(leaf.at, &format!("{what} as value {}", at + 1), &found)
        })
    }

    /// An error about a value.
    pub fn wrong(&self, item: &Item, expected: &str) -> String {
        self.exchange
            .told(item.at, expected, &item.value.describe())
    }

    pub fn real(&self, kind: &str, k: usize, what: &str) -> Told<f64> {
        let item = self.attribute(kind, k, what)?;
        self.number(item, what)
    }

    /// A number, in the parentheses of a measure or not.
    pub fn number(&self, item: &Item, what: &str) -> Told<f64> {
        match &item.value {
            Value::Real(x) => Ok(*x),
            Value::Integer(i) => Ok(*i as f64),
            Value::Typed(_, items) if items.len() == 1 && !is_typed(&items[0]) => {
                self.number(&items[0], what)
            }
            _ => Err(self.wrong(item, &format!("{what} (a number)"))),
        }
    }

    pub fn integer(&self, item: &Item, what: &str) -> Told<i64> {
        match item.value {
            Value::Integer(i) => Ok(i),
            // Some writers print a point.
            Value::Real(x) if x.fract() == 0.0 && x.abs() < 1e15 => Ok(x as i64),
            _ => Err(self.wrong(item, &format!("{what} (an integer)"))),
        }
    }

    /// A number of something, at most `most`.
    pub fn count(&self, item: &Item, most: usize, what: &str) -> Told<usize> {
        let value = self.integer(item, what)?;
        let count = usize::try_from(value).ok().filter(|&c| c <= most);
        count.ok_or_else(|| self.wrong(item, &format!("{what} (from 0 to {most})")))
    }

    pub fn list(&self, kind: &str, k: usize, what: &str) -> Told<&[Item<'a>]> {
        let item = self.attribute(kind, k, what)?;
        self.items(item, what)
    }

    pub fn items<'i>(&self, item: &'i Item<'a>, what: &str) -> Told<&'i [Item<'a>]> {
        match &item.value {
            Value::List(items) => Ok(items),
            Value::Typed(_, items)
                if matches!(
                    items[..],
                    [Item {
                        value: Value::List(_),
                        ..
                    }]
                ) =>
            {
                self.items(&items[0], what)
            }
            _ => Err(self.wrong(item, &format!("{what} (a list)"))),
        }
    }

    pub fn numbers(&self, item: &Item<'a>, what: &str) -> Told<Vec<f64>> {
        let items = self.items(item, what)?;
        items.iter().map(|i| self.number(i, what)).collect()
    }

    /// A string, `None` where it is omitted or empty.
    pub fn text(&self, kind: &str, k: usize) -> Option<String> {
        let item = self.attribute(kind, k, "a text").ok()?;
        texts(&item.value)
    }

    /// The name of a representation item, where it has one. Writers put the word NONE for none.
    pub fn label(&self) -> Option<String> {
        // Types that are not known are named by their first value like all others.
        let first = || match &self.leaves[..] {
            [one] => texts(&one.items.first()?.value),
            _ => None,
        };
        let name = self.text("REPRESENTATION_ITEM", 0).or_else(first)?;
        (!name.eq_ignore_ascii_case("NONE")).then_some(name)
    }

    /// Calls `f` with the name of every instance that this one refers to.
    pub fn each_reference(&self, f: &mut impl FnMut(u64)) {
        for leaf in &self.leaves {
            super::labels::references(&leaf.items, f);
        }
    }

    pub fn flag(&self, kind: &str, k: usize, what: &str) -> Told<bool> {
        let item = self.attribute(kind, k, what)?;
        match item.value {
            Value::Enumeration(b"T" | b"t") => Ok(true),
            Value::Enumeration(b"F" | b"f") => Ok(false),
            _ => Err(self.wrong(item, &format!("{what} (.T. or .F.)"))),
        }
    }

    /// The instance that an attribute refers to.
    pub fn reference(&self, kind: &str, k: usize, what: &str) -> Told<u32> {
        let item = self.attribute(kind, k, what)?;
        self.target(item, what)
    }

    pub fn target(&self, item: &Item, what: &str) -> Told<u32> {
        let name = match &item.value {
            Value::Reference(name) => *name,
            _ => return Err(self.wrong(item, &format!("{what} (an instance)"))),
        };
        self.exchange.find(name).ok_or_else(|| {
            let found = format!("#{name}, which is not in the file");
            self.exchange.told(item.at, what, &found)
        })
    }

    /// The instances in a list.
    pub fn targets(&self, kind: &str, k: usize, what: &str) -> Told<Vec<u32>> {
        let items = self.list(kind, k, what)?;
        items.iter().map(|item| self.target(item, what)).collect()
    }

    /// The last five values of a transformation operator: axis 1 and 2, origin, scale, axis 3.
    pub fn operator_values(&self) -> Told<[&Item<'a>; 5]> {
        let flat: Vec<&Item> = match &self.leaves[..] {
            [one] => one.items.iter().collect(),
            several => [
                "CARTESIAN_TRANSFORMATION_OPERATOR",
                "CARTESIAN_TRANSFORMATION_OPERATOR_3D",
            ]
            .iter()
            .filter_map(|kind| several.iter().find(|l| l.keyword == kind.as_bytes()))
            .flat_map(|l| &l.items)
            .collect(),
        };
        let tail = flat.len().checked_sub(5).map(|from| &flat[from..]);
        match tail {
            Some(&[a, b, c, d, e]) => Ok([a, b, c, d, e]),
            _ => {
                let at = self.exchange.at(self.index);
                let expected = "axes, origin and scale of a transformation";
                let found = format!("{} values", flat.len());
                Err(self.exchange.told(at, expected, &found))
            }
        }
    }

    /// The instance that an attribute refers to, if it is one of `wanted`.
    pub fn member(&self, kind: &str, k: usize, wanted: &str, what: &str) -> Told<Entity<'e, 'a>> {
        let item = self.attribute(kind, k, what)?;
        let entity = Entity::read(self.exchange, self.target(item, what)?)?;
        if entity.is(wanted) {
            return Ok(entity);
        }
        let found = entity.describe();
        Err(self
            .exchange
            .told(item.at, &format!("{what} (a {wanted})"), &found))
    }
}

/// A string in the parentheses of its type or not, `None` where it is empty.
fn texts(value: &Value) -> Option<String> {
    let bytes = match value {
        Value::Text(bytes) => *bytes,
        Value::Typed(_, items) => match items.first()?.value {
            Value::Text(bytes) => bytes,
            _ => return None,
        },
        _ => return None,
    };
    let text: String = decode(bytes).chars().take(LONGEST).collect();
    let text = text.trim();
    (!text.is_empty()).then(|| text.to_owned())
}

fn is_typed(item: &Item) -> bool {
    matches!(item.value, Value::Typed(..))
}

/// The name of an entity type, of several types with blanks between them.
pub fn kind_of<'k>(keywords: impl Iterator<Item = &'k [u8]>) -> String {
    let words: Vec<_> = keywords.map(String::from_utf8_lossy).collect();
    words.join(" ")
}
