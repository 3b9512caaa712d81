//! Memory that a mesh takes.
use super::ElementKind;
use crate::machine::memory::times;

/// Bytes of the faces of an element in the table that finds shared ones.
pub const FACES: u64 = 6 * 28;

/// Bytes of a mesh while it is made and checked: positions and marks of nodes, connectivity, and the table of all faces.
pub fn bytes(nodes: u64, elements: u64, kind: ElementKind) -> u64 {
    let each = 4 * kind.nodes() as u64 + FACES;
    times(nodes, 24 + 8).saturating_add(times(elements, each))
}
