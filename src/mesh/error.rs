//! Errors of mesh generators, readers, checks and sets.
use super::extrude::SurfaceError;
use crate::machine::memory::Shortage;
use std::fmt;
use std::path::PathBuf;

/// Largest number of nodes a generator or reader makes; beyond it the input is taken for a mistake.
pub const MAX_NODES: u64 = 50_000_000;

/// Members that the sets of a file may have in all, for each of its nodes and elements: short files must not grow
/// without bound by sets of sets.
pub const MEMBERS: u64 = 64;

/// Bytes of the name of a set in a file.
pub(super) const MOST_IN_NAME: usize = 1000;

/// Names and numbers that a message or a note lists; of more it gives the number.
const MOST_LISTED: usize = 20;

/// Names or numbers for a message, the first ones where there are many.
pub(super) fn listed<T: fmt::Display>(all: impl IntoIterator<Item = T>) -> String {
    let mut all = all.into_iter();
    let mut list: Vec<String> = (all.by_ref().take(MOST_LISTED))
        .map(|one| shorten(&one.to_string()))
        .collect();
    match all.count() {
        0 => {}
        more => list.push(format!("and {more} more")),
    }
    list.join(", ")
}

/// At most 40 characters of a text of a file.
pub(super) fn shorten(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((i, _)) => format!("{}...", &text[..i]),
        None => text.to_string(),
    }
}

/// Members that the sets of a file with so many nodes and elements may have in all; a few more, so that small files may
/// do what they like.
pub(super) fn most_members(nodes: usize, elements: usize) -> u64 {
    MEMBERS * (nodes + elements) as u64 + 10_000
}

/// Place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Position {
    /// Text file: line and column, both counted from 1.
    Text {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
    },
    /// Binary file: byte offset from 0.
    Byte(usize),
    /// Arrays that a program gave.
    Memory,
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Position::Text { line, column } => write!(f, "{line}:{column}"),
            Position::Byte(offset) => write!(f, "byte {offset}"),
            Position::Memory => f.write_str("in memory"),
        }
    }
}

/// What a set holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SetKind {
    /// Set of nodes.
    Node,
    /// Set of faces of elements.
    Face,
    /// Set of elements in a file.
    Element,
}

impl fmt::Display for SetKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            SetKind::Node => "node",
            SetKind::Face => "face",
            SetKind::Element => "element",
        })
    }
}

/// What is wrong with a mesh or with its description.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// A field of a generator or a selection has a value that cannot be meant.
    #[error("{what}: {field} is {value}, expected {expected}")]
    Invalid {
        /// Generator or selection, by its name in the scene.
        what: &'static str,
        /// Field of it.
        field: String,
        /// The value that was given.
        value: String,
        /// What it may be, in words.
        expected: String,
    },
    /// More nodes than [`MAX_NODES`].
    #[error("{what}: {nodes} nodes are more than the limit of {MAX_NODES}")]
    TooManyNodes {
        /// Generator or file that asks for them.
        what: &'static str,
        /// Number of nodes asked for.
        nodes: u128,
    },
    /// The mesh does not fit in memory.
    #[error("{what} of {nodes} nodes: {shortage}")]
    Memory {
        /// Generator or file that asks for it.
        what: &'static str,
        /// Number of nodes of the mesh.
        nodes: u64,
        /// How much there is and how much is needed.
        shortage: Shortage,
    },
    /// Named sets of a file are so long that their lines must be wrong: sets of sets, again and again.
    #[error("{}: its sets hold more than {most} members in all, {MEMBERS} for each node and element", path.display())]
    LongSets {
        /// The mesh file.
        path: PathBuf,
        /// Number of members up to which sets are read.
        most: u64,
    },
    /// The elements cannot be spaced as asked.
    #[error("spacing along {axis}: {reason}")]
    Spacing {
        /// Axis of the generator.
        axis: String,
        /// What is wrong with the spacing.
        reason: String,
    },
    /// A file cannot be read.
    #[error("cannot read mesh file {}: {source}", path.display())]
    Io {
        /// The mesh file.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The name of a file does not tell its format.
    #[error(
        "{}: mesh files end in .msh (gmsh), .inp (Abaqus, CalculiX), .bdf or .nas (Nastran), .vtk, .vtu or .stl",
        path.display()
    )]
    UnknownFormat {
        /// The mesh file.
        path: PathBuf,
    },
    /// A file does not follow its format.
    #[error("{}:{at}: expected {expected}, found {found}", path.display())]
    Syntax {
        /// The mesh file.
        path: PathBuf,
        /// Place in the file.
        at: Position,
        /// What the format asks for there.
        expected: String,
        /// What stands there.
        found: String,
    },
    /// A file holds something valid that is not supported.
    #[error("{}:{at}: {what} is not supported: {help}", path.display())]
    Unsupported {
        /// The mesh file.
        path: PathBuf,
        /// Place in the file.
        at: Position,
        /// What is not supported.
        what: String,
        /// What to do about it.
        help: String,
    },
    /// A file holds no elements of the kind that is wanted.
    #[error("{}: no {wanted} in this file (its elements: {found}): {help}", path.display())]
    NoElements {
        /// The mesh file.
        path: PathBuf,
        /// `hexahedra`, or `quadrilaterals or triangles` for a surface.
        wanted: &'static str,
        /// The elements of the file, in words.
        found: String,
        /// What to do about it.
        help: String,
    },
    /// The nodes midway through the thickness of a 20-node hexahedron do not lie midway.
    #[error(
        "{}: element {tag} at ({:.6}, {:.6}, {:.6}): its nodes midway through the thickness lie {off:.1} % of the thickness \
         off the straight lines between bottom and top, where the 18-node element is straight: mesh with linear elements, \
         or with more of them",
        path.display(), position[0], position[1], position[2]
    )]
    Crooked {
        /// The mesh file.
        path: PathBuf,
        /// Number of the worst element in the file.
        tag: u64,
        /// Its centre.
        position: [f64; 3],
        /// Percent of the thickness.
        off: f64,
    },
    /// A surface cannot be given a thickness.
    #[error("{}: {source}", path.display())]
    Surface {
        /// The mesh file.
        path: PathBuf,
        /// What is wrong with the surface.
        source: SurfaceError,
    },
    /// A node position is not finite.
    #[error("node {node} has the position ({}, {}, {})", position[0], position[1], position[2])]
    NotFinite {
        /// Number of the node, from 0.
        node: u32,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// An element or a set names a node or an element that does not exist.
    #[error("{what} refers to {kind} {number}, but there are only {count}")]
    OutOfRange {
        /// The element or set, in words.
        what: String,
        /// `node`, `element` or what else is referred to.
        kind: &'static str,
        /// The number that does not exist.
        number: u64,
        /// How many of the kind there are.
        count: usize,
    },
    /// An element is turned inside out or has no volume.
    #[error(
        "element {element}{} at ({:.6}, {:.6}, {:.6}) is inverted or degenerate: its smallest Jacobian is {jacobian:.3e}; {count} element(s) in all",
        tag.map(|t| format!(" (number {t} in the file)")).unwrap_or_default(),
        position[0], position[1], position[2]
    )]
    Inverted {
        /// First such element, counted from 0.
        element: u32,
        /// Its number in the mesh file.
        tag: Option<u64>,
        /// Its centre.
        position: [f64; 3],
        /// Smallest Jacobian determinant at its nodes (volume per volume of the cube [-1, 1]^3).
        jacobian: f64,
        /// How many elements are inverted.
        count: usize,
    },
    /// Two nodes lie at the same place: parts that touch but are not joined.
    #[error(
        "nodes {first} and {second}{} lie at the same place ({:.6}, {:.6}, {:.6}); {count} such pair(s) in all: join them in the mesher, or \
         say `\"slits\": true` of the file where a slit is meant",
        tags.map(|[a, b]| format!(" (numbers {a} and {b} in the file)")).unwrap_or_default(),
        position[0], position[1], position[2]
    )]
    DuplicateNodes {
        /// The first node of the first such pair, from 0.
        first: u32,
        /// The second node of that pair.
        second: u32,
        /// Their numbers in the mesh file.
        tags: Option<[u64; 2]>,
        /// Where it is.
        position: [f64; 3],
        /// How many such pairs there are.
        count: usize,
    },
    /// A node belongs to no element.
    #[error(
        "node {node} at ({:.6}, {:.6}, {:.6}) belongs to no element; {count} such node(s) in all",
        position[0], position[1], position[2]
    )]
    UnusedNode {
        /// The first such node, from 0.
        node: u32,
        /// Where it is.
        position: [f64; 3],
        /// How many such nodes there are.
        count: usize,
    },
    /// A face is shared by more than two elements, or by two on the same side.
    #[error(
        "elements {} meet in one face at ({:.6}, {:.6}, {:.6}): a face belongs to at most two elements, on opposite sides",
        listed(elements),
        position[0], position[1], position[2]
    )]
    NonManifold {
        /// The elements that meet there, from 0.
        elements: Vec<u32>,
        /// Centre of the face.
        position: [f64; 3],
    },
    /// Two elements share the corners of a face, but not the nodes between them.
    #[error(
        "elements {} and {} share the corners of a face at ({:.6}, {:.6}, {:.6}), but not the nodes between them: one of \
         them has its thickness along that face; name surfaces `top` and `bottom` so that both agree",
        elements[0], elements[1], position[0], position[1], position[2]
    )]
    UnlikeFaces {
        /// The two elements, from 0.
        elements: [u32; 2],
        /// Centre of the face.
        position: [f64; 3],
    },
    /// A file holds elements of another shape than the scene asks for.
    #[error("{}: holds {found}, but {wanted}: {help}", path.display())]
    OtherElements {
        /// The mesh file.
        path: PathBuf,
        /// The file's elements.
        found: &'static str,
        /// What the scene's element needs.
        wanted: &'static str,
        /// What to do about it.
        help: &'static str,
    },
    /// No set of this name.
    #[error(
        "no {kind} set `{name}`{}; {}",
        suggestion.as_ref().map(|s| format!(" (did you mean `{s}`?)")).unwrap_or_default(),
        if available.is_empty() { format!("the mesh has no {kind} sets") } else { format!("{kind} sets: {}", listed(available)) }
    )]
    UnknownSet {
        /// The kind of set that was looked for.
        kind: SetKind,
        /// The name that was asked for.
        name: String,
        /// The most similar name of a set.
        suggestion: Option<String>,
        /// Names of all sets of the kind.
        available: Vec<String>,
    },
    /// A set of this name exists already.
    #[error("the mesh already has a set `{name}`")]
    SetExists {
        /// Name of the set.
        name: String,
    },
    /// A selection finds nothing.
    #[error(
        "{selection} selects nothing: the nearest {candidate} is {nearest:.6} {unit} away from it"
    )]
    EmptySelection {
        /// The selection in words.
        selection: String,
        /// `node` or `outer face`.
        candidate: &'static str,
        /// Distance by which the nearest candidate misses it, in `unit`.
        nearest: f64,
        /// `length units` or `degrees`.
        unit: &'static str,
    },
}
