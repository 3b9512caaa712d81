//! Nodes, elements and sets with numbers and names of their own: a part, an instance, or the whole of a flat file.
use super::types::Shape;
use crate::mesh::field::Field;
use crate::mesh::raw::NONE;
use covact_geometry::Vec3;
use std::collections::{BTreeMap, HashMap};

/// An element: its shape, and its nodes among those of all elements.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element {
    pub tag: u64,
    pub shape: Shape,
    pub first: usize,
    /// Line and column of its last node.
    pub at: (u32, u32),
}

impl Element {
    /// Where it stands, for messages.
    pub fn at(&self) -> Field<'static> {
        Field {
            text: "",
            line: self.at.0 as usize,
            column: self.at.1 as usize,
        }
    }
}

/// What an entry of a set names.
#[derive(Debug)]
pub(super) enum Reference {
    Number(u64),
    /// First, last, step.
    Range(Box<[u64; 3]>),
    /// A set, of this scope or, as `instance.set`, of another.
    Name(Box<str>),
}

/// An entry of a set, and where it stands.
#[derive(Debug)]
pub(super) struct Entry {
    pub what: Reference,
    /// Face or edge of the elements, in a surface.
    pub side: Side,
    pub line: u32,
    pub column: u32,
    /// Whose numbers they are, an index into the names of [`Set::instances`].
    pub instance: u32,
}

/// Which part of an element a surface takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// No surface: the element.
    None,
    /// `S1` to `S6` as local face, of hexahedra.
    Face(u8),
    /// `E1` to `E4` as edge, of surface elements.
    Edge(u8),
}

/// A set as it is written; it is resolved when the whole file is known.
#[derive(Debug, Default)]
pub(super) struct Set {
    pub entries: Vec<Entry>,
    /// Names of instances that entries refer to.
    pub instances: Vec<String>,
}

impl Set {
    /// Index of an instance's name; [`NONE`] for none.
    pub fn instance(&mut self, name: Option<&str>) -> u32 {
        let Some(name) = name else { return NONE };
        match self.instances.last() {
            Some(last) if last == name => {}
            _ => self.instances.push(name.to_string()),
        }
        self.instances.len() as u32 - 1
    }
}

/// Sets by their names in capitals, with the first spelling: names do not depend on case.
#[derive(Debug, Default)]
pub(super) struct Sets {
    pub by_name: BTreeMap<String, (String, Set)>,
}

impl Sets {
    pub fn get(&mut self, name: &str) -> &mut Set {
        let entry = self.by_name.entry(name.to_uppercase());
        &mut entry
            .or_insert_with(|| (name.to_string(), Set::default()))
            .1
    }
}

#[derive(Debug, Default)]
pub(super) struct Scope {
    /// Empty for the flat file or the assembly.
    pub name: String,
    pub nodes: Vec<Vec3>,
    pub node_tags: Vec<u64>,
    pub node_index: HashMap<u64, u32>,
    pub elements: Vec<Element>,
    pub connectivity: Vec<u32>,
    pub element_index: HashMap<u64, u32>,
    pub node_sets: Sets,
    pub element_sets: Sets,
    pub surfaces: Sets,
}

impl Scope {
    pub fn new(name: &str) -> Scope {
        Scope {
            name: name.to_string(),
            ..Scope::default()
        }
    }

    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty() && self.elements.is_empty()
    }

    /// Nodes of an element.
    pub fn nodes_of(&self, element: &Element) -> &[u32] {
        &self.connectivity[element.first..element.first + element.shape.nodes()]
    }
}

impl Shape {
    /// Number of nodes of an element.
    pub fn nodes(self) -> usize {
        match self {
            Shape::Solid { nodes, .. } | Shape::Facet(nodes) | Shape::Line(nodes) => nodes,
            Shape::OtherSolid | Shape::Other => 0,
        }
    }
}

impl Entry {
    pub fn new(what: Reference, at: &Field, instance: u32) -> Entry {
        Entry {
            what,
            side: Side::None,
            line: at.line as u32,
            column: at.column as u32,
            instance,
        }
    }

    /// Where it stands, for messages.
    pub fn at(&self) -> Field<'static> {
        Field {
            text: "",
            line: self.line as usize,
            column: self.column as usize,
        }
    }
}
