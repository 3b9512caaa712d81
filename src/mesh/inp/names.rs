//! What numbers and names of a file mean: in a part, or in the assembly with its instances.
use super::resolve::{Meaning, Members};
use super::scope::{Entry, Reference, Scope};
use std::collections::HashMap;

/// Numbers and sets of one scope, or of the assembly with its instances.
pub(super) struct Names<'s> {
    pub index: &'s HashMap<u64, u32>,
    /// Numbers may be missing because elements were passed over.
    pub lenient: bool,
    /// Instances that can be named.
    pub others: &'s [Placed],
    /// Nodes; else elements.
    pub nodes: bool,
}

/// An instance in the mesh: its numbers and sets.
pub(super) struct Placed {
    name: String,
    /// Members of node sets and element sets.
    sets: [Members; 2],
    /// Nodes and elements by their numbers.
    numbers: [HashMap<u64, u32>; 2],
}

impl Placed {
    /// `first`: where the nodes and elements of the scope begin in the mesh.
    pub fn new(name: &str, scope: &Scope, first: [u32; 2], sets: [Members; 2]) -> Placed {
        let moved = |index: &HashMap<u64, u32>, first: u32| {
            index.iter().map(|(&tag, &k)| (tag, k + first)).collect()
        };
        Placed {
            name: name.to_string(),
            sets,
            numbers: [
                moved(&scope.node_index, first[0]),
                moved(&scope.element_index, first[1]),
            ],
        }
    }
}

pub(super) struct Nodes<'s>(pub Names<'s>);
pub(super) struct Elements<'s>(pub Names<'s>);

impl Names<'_> {
    fn instance(&self, name: &str) -> Option<&Placed> {
        self.others
            .iter()
            .find(|p| p.name.eq_ignore_ascii_case(name))
    }

    fn number(&self, instance: Option<&str>, number: u64) -> Option<u32> {
        match instance {
            None => self.index.get(&number).copied(),
            Some(name) => {
                let numbers = &self.instance(name)?.numbers[usize::from(!self.nodes)];
                numbers.get(&number).copied()
            }
        }
    }

    /// `instance.set`, or a set of a given instance.
    fn named(&self, instance: Option<&str>, name: &str) -> Option<&[u32]> {
        let (instance, set) = match instance {
            Some(instance) => (instance, name),
            None => name.split_once('.')?,
        };
        let sets = &self.instance(instance)?.sets[usize::from(!self.nodes)];
        sets.get(&set.to_uppercase()).map(Vec::as_slice)
    }

    /// Elements that an entry of a surface names: by number or set of `own`, or by a set of an instance.
    pub fn find(own: &Placed, others: &[Placed], entry: &Entry) -> Option<Vec<u32>> {
        match &entry.what {
            Reference::Number(number) => {
                let element = own.numbers[1].get(number).copied();
                element.map(|e| vec![e])
            }
            Reference::Name(name) => {
                let set = own.sets[1].get(&name.to_uppercase());
                set.cloned().or_else(|| {
                    let (instance, set) = name.split_once('.')?;
                    let named = |p: &&Placed| p.name.eq_ignore_ascii_case(instance);
                    let instance = others.iter().find(named)?;
                    instance.sets[1].get(&set.to_uppercase()).cloned()
                })
            }
            Reference::Range(_) => None,
        }
    }

    fn within(&self, instance: Option<&str>, first: u64, last: u64) -> Vec<u64> {
        let index = match instance.map(|name| self.instance(name)) {
            None => self.index,
            Some(Some(placed)) => &placed.numbers[usize::from(!self.nodes)],
            Some(None) => return Vec::new(),
        };
        let mut all: Vec<u64> = (index.keys().copied())
            .filter(|n| (first..=last).contains(n))
            .collect();
        all.sort_unstable();
        all
    }

    fn count(&self) -> usize {
        let of = |p: &Placed| p.numbers[usize::from(!self.nodes)].len();
        self.index.len() + self.others.iter().map(of).sum::<usize>()
    }
}

macro_rules! meaning {
    ($type:ident, $kind:literal) => {
        impl Meaning for $type<'_> {
            const KIND: &'static str = $kind;
            fn number(&self, instance: Option<&str>, number: u64) -> Option<u32> {
                self.0.number(instance, number)
            }
            fn named(&self, instance: Option<&str>, name: &str) -> Option<&[u32]> {
                self.0.named(instance, name)
            }
            fn lenient(&self) -> bool {
                self.0.lenient
            }
            fn count(&self) -> usize {
                self.0.count()
            }
            fn within(&self, instance: Option<&str>, first: u64, last: u64) -> Vec<u64> {
                self.0.within(instance, first, last)
            }
        }
    };
}
meaning!(Nodes, "node");
meaning!(Elements, "element");
