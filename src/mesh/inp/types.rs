//! Element types by their names: family, number of nodes, variant.

/// What an element type is here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// Hexahedron of 8, 20 or 27 nodes; `given`: its thickness is its direction 3.
    Solid { nodes: usize, given: bool },
    /// Triangle or quadrilateral of 3, 4, 6, 8 or 9 nodes.
    Facet(usize),
    /// Line of 2 nodes, or of 3 with the middle one second.
    Line(usize),
    /// Solid that is no hexahedron.
    OtherSolid,
    /// Springs, masses, fluids in pipes and the like.
    Other,
}

/// Families of hexahedra and other solids, of surfaces, of lines; longer names before those that they begin with.
const SOLIDS: [&str; 9] = [
    "C3D", "DC3D", "AC3D", "FC3D", "F3D", "Q3D", "CSS", "SC", "CCL",
];
const FACETS: [&str; 16] = [
    "SFM3D", "STRI", "DC2D", "AC2D", "DCAX", "ACAX", "CPEG", "R3D", "M3D", "F2D", "CPS", "CPE",
    "CGAX", "CAX", "DS", "S",
];
const LINES: [&str; 5] = ["T3D", "T2D", "RB3D", "R2D", "RAX"];

impl Shape {
    /// The shape of a type, its name in capitals.
    pub fn of(name: &str) -> Shape {
        let nodes = |family: &&str| -> Option<usize> {
            let rest = name.strip_prefix(family)?;
            let end = rest
                .find(|c: char| !c.is_ascii_digit())
                .unwrap_or(rest.len());
            rest[..end].parse().ok()
        };
        if let Some(nodes) = SOLIDS.iter().find_map(nodes) {
            let given = name.starts_with("SC") || name.starts_with("CSS");
            return match nodes {
                8 | 20 | 27 => Shape::Solid { nodes, given },
                _ => Shape::OtherSolid,
            };
        }
        // Solids without a number of nodes too.
        if SOLIDS[..6].iter().any(|family| name.starts_with(family)) {
            return Shape::OtherSolid;
        }
        if name.starts_with("STRI65") {
            return Shape::Facet(6);
        }
        if let Some(nodes @ (3 | 4 | 6 | 8 | 9)) = FACETS.iter().find_map(nodes) {
            return Shape::Facet(nodes);
        }
        if let Some(nodes @ (2 | 3)) = LINES.iter().find_map(nodes) {
            return Shape::Line(nodes);
        }
        // Beams: B31 and B21 have two nodes, B32 and B22 three, B33 and B23 two.
        let mut digits = name.strip_prefix('B').unwrap_or_default().chars();
        match (digits.next(), digits.next()) {
            (Some('2' | '3'), Some('1' | '3')) => Shape::Line(2),
            (Some('2' | '3'), Some('2')) => Shape::Line(3),
            _ => Shape::Other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_the_shape() {
        let solid = |nodes| Shape::Solid {
            nodes,
            given: false,
        };
        for (name, shape) in [
            ("C3D8", solid(8)),
            ("C3D8RH", solid(8)),
            ("C3D20R", solid(20)),
            ("C3D27", solid(27)),
            ("F3D8", solid(8)),
            (
                "SC8R",
                Shape::Solid {
                    nodes: 8,
                    given: true,
                },
            ),
            ("C3D4", Shape::OtherSolid),
            ("C3D10", Shape::OtherSolid),
            ("C3DX", Shape::OtherSolid),
            ("S4", Shape::Facet(4)),
            ("S4R5", Shape::Facet(4)),
            ("S3R", Shape::Facet(3)),
            ("STRI3", Shape::Facet(3)),
            ("STRI65", Shape::Facet(6)),
            ("S8R", Shape::Facet(8)),
            ("S9R5", Shape::Facet(9)),
            ("CPS4", Shape::Facet(4)),
            ("CAX4P", Shape::Facet(4)),
            ("M3D3", Shape::Facet(3)),
            ("R3D3", Shape::Facet(3)),
            ("SFM3D4R", Shape::Facet(4)),
            ("T3D2", Shape::Line(2)),
            ("T3D3", Shape::Line(3)),
            ("B31H", Shape::Line(2)),
            ("B32R", Shape::Line(3)),
            ("SPRINGA", Shape::Other),
            ("D", Shape::Other),
            ("GAPUNI", Shape::Other),
            ("", Shape::Other),
        ] {
            assert_eq!(Shape::of(name), shape, "{name}");
        }
    }
}
