//! Why a surface cannot be given a thickness.
use crate::mesh::error::listed;
use crate::scene::ValueError;

/// Position in a message.
type Place = [f64; 3];

fn at(place: &Place) -> String {
    format!("({:.6}, {:.6}, {:.6})", place[0], place[1], place[2])
}

/// What keeps a surface mesh from becoming a body. Elements and nodes are named by their numbers in the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// An element has no area.
    #[error(
        "element {element} at {} has no area or a corner that sticks inward: repair it in the mesher",
        at(position)
    )]
    Flat {
        /// The element.
        element: u64,
        /// Where it is.
        position: Place,
    },
    /// Two elements have the same corners.
    #[error(
        "elements {} and {} have the same corners, at {}: delete one of them",
        elements[0], elements[1], at(position)
    )]
    Twice {
        /// The two elements.
        elements: [u64; 2],
        /// Where it is.
        position: Place,
    },
    /// More than two elements share an edge.
    #[error(
        "elements {} meet in one edge at {}: the surface branches there. Leave one branch out (`only` takes the elements of \
         one set), or mesh the part with hexahedra",
        listed(elements),
        at(position)
    )]
    Branching {
        /// The elements that share the edge.
        elements: Vec<u64>,
        /// Where it is.
        position: Place,
    },
    /// Parts of the surface hang together by a node only.
    #[error(
        "node {node} at {} joins parts of the surface that have no edge in common there: join them along edges, or give \
         each a node of its own",
        at(position)
    )]
    Pinched {
        /// The node.
        node: u64,
        /// Where it is.
        position: Place,
    },
    /// Borders of one part touch, but are not joined.
    #[error(
        "nodes {} and {} lie at the same place {}; {count} such pair(s) in all: the surface has a slit there, join them in \
         the mesher, or say `\"slits\": true` of the file where it is meant",
        nodes[0], nodes[1], at(position)
    )]
    Unjoined {
        /// The first pair.
        nodes: [u64; 2],
        /// Where it is.
        position: Place,
        /// How many such pairs there are.
        count: usize,
    },
    /// The surface has one side only.
    #[error(
        "elements {} and {} at {} cannot both look the same way as their neighbours: the surface has only one side (like a \
         Moebius strip)",
        elements[0], elements[1], at(position)
    )]
    OneSided {
        /// Two neighbours that look opposite ways.
        elements: [u64; 2],
        /// Where it is.
        position: Place,
    },
    /// A fold is too sharp for a thickness.
    #[error(
        "the surface is folded by {angle:.0} degrees at {}: no thickness fits there. Give the fold a radius in the mesher",
        at(position)
    )]
    SharpFold {
        /// Angle between the sides of the fold (degrees).
        angle: f64,
        /// Where it is.
        position: Place,
    },
    /// Elements without a thickness.
    #[error(
        "{count} element(s) are in no set of `thickness`, the first is element {element} at {}; element sets of the file: {}",
        at(position),
        sets
    )]
    NoThickness {
        /// How many such elements there are.
        count: usize,
        /// The first of them.
        element: u64,
        /// Where it is.
        position: Place,
        /// The sets of the file, in words.
        sets: String,
    },
    /// The expression of the thickness is wrong, or gives no number somewhere.
    #[error("thickness: {0}")]
    Field(ValueError),
    /// A field of thickness is zero or less.
    #[error(
        "the thickness is {value} at {}{}, where it must be positive",
        at(position),
        if *node > 0 { format!(" (node {node})") } else { String::new() }
    )]
    NotPositive {
        /// The thickness there (length).
        value: f64,
        /// 0 for nodes that the file does not have.
        node: u64,
        /// Where it is.
        position: Place,
    },
    /// An element with two thicknesses.
    #[error(
        "element {element} at {} is in the sets `{}` and `{}`, which have different thicknesses",
        at(position), sets[0], sets[1]
    )]
    TwoThicknesses {
        /// The element.
        element: u64,
        /// Where it is.
        position: Place,
        /// Names of both sets.
        sets: [String; 2],
    },
}
