//! Element types of gmsh and the order of their nodes.

/// gmsh numbers the nodes of a face around it; tensor node `a` is gmsh node `TENSOR[a]`.
pub(super) const TENSOR: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// Node of gmsh's 27-node hexahedron at tensor place `i + 3 j + 9 k`; those below 20 are the nodes of its 20-node one.
pub(super) const TENSOR_27: [usize; 27] = [
    0, 8, 1, 9, 20, 11, 3, 13, 2, // bottom
    10, 21, 12, 22, 26, 23, 15, 24, 14, // middle
    4, 16, 5, 17, 25, 18, 7, 19, 6, // top
];

/// An element type of gmsh.
#[derive(Debug)]
pub(super) struct ElementType {
    pub number: i32,
    pub name: &'static str,
    pub nodes: usize,
    pub dim: i32,
    /// Of use here: points, lines, triangles, quadrilaterals and hexahedra.
    pub used: bool,
}

const fn element_type(
    number: i32,
    name: &'static str,
    nodes: usize,
    dim: i32,
    used: bool,
) -> ElementType {
    ElementType {
        number,
        name,
        nodes,
        dim,
        used,
    }
}

pub(super) const TYPES: [ElementType; 19] = [
    element_type(15, "points", 1, 0, true),
    element_type(1, "lines", 2, 1, true),
    element_type(8, "quadratic lines", 3, 1, true),
    element_type(2, "triangles", 3, 2, true),
    element_type(3, "quadrilaterals", 4, 2, true),
    element_type(9, "quadratic triangles", 6, 2, true),
    element_type(10, "quadratic quadrilaterals (9 nodes)", 9, 2, true),
    element_type(16, "quadratic quadrilaterals (8 nodes)", 8, 2, true),
    element_type(4, "tetrahedra", 4, 3, false),
    element_type(5, "hexahedra", 8, 3, true),
    element_type(6, "prisms", 6, 3, false),
    element_type(7, "pyramids", 5, 3, false),
    element_type(11, "quadratic tetrahedra", 10, 3, false),
    element_type(12, "quadratic hexahedra (27 nodes)", 27, 3, true),
    element_type(13, "quadratic prisms (18 nodes)", 18, 3, false),
    element_type(14, "quadratic pyramids (14 nodes)", 14, 3, false),
    element_type(17, "quadratic hexahedra (20 nodes)", 20, 3, true),
    element_type(18, "quadratic prisms (15 nodes)", 15, 3, false),
    element_type(19, "quadratic pyramids (13 nodes)", 13, 3, false),
];
