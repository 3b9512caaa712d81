//! The entity types that are read, with their supertypes and the number of attributes that each adds (ISO 10303-41, -42,
//! -43, -44, -46). Of several supertypes the one stands here whose attributes come first.

/// Name, supertype, attributes of its own.
type Row = (&'static str, &'static str, usize);

/// Sorted by name.
const TYPES: &[Row] = &[
    (
        "ADVANCED_BREP_SHAPE_REPRESENTATION",
        "SHAPE_REPRESENTATION",
        0,
    ),
    ("ADVANCED_FACE", "FACE_SURFACE", 0),
    ("ASSEMBLY_COMPONENT_USAGE", "PRODUCT_DEFINITION_USAGE", 1),
    ("AXIS1_PLACEMENT", "PLACEMENT", 1),
    ("AXIS2_PLACEMENT_2D", "PLACEMENT", 1),
    ("AXIS2_PLACEMENT_3D", "PLACEMENT", 2),
    ("BEZIER_CURVE", "B_SPLINE_CURVE", 0),
    ("BEZIER_SURFACE", "B_SPLINE_SURFACE", 0),
    ("BOUNDARY_CURVE", "COMPOSITE_CURVE_ON_SURFACE", 0),
    ("BOUNDED_CURVE", "CURVE", 0),
    ("BOUNDED_PCURVE", "PCURVE", 0),
    ("BOUNDED_SURFACE", "SURFACE", 0),
    ("BOUNDED_SURFACE_CURVE", "SURFACE_CURVE", 0),
    ("BREP_WITH_VOIDS", "MANIFOLD_SOLID_BREP", 1),
    ("B_SPLINE_CURVE", "BOUNDED_CURVE", 5),
    ("B_SPLINE_CURVE_WITH_KNOTS", "B_SPLINE_CURVE", 3),
    ("B_SPLINE_SURFACE", "BOUNDED_SURFACE", 7),
    ("B_SPLINE_SURFACE_WITH_KNOTS", "B_SPLINE_SURFACE", 5),
    ("CARTESIAN_POINT", "POINT", 1),
    ("CIRCLE", "CONIC", 1),
    ("CLOSED_SHELL", "CONNECTED_FACE_SET", 0),
    ("COLOUR", "", 0),
    ("COLOUR_RGB", "COLOUR_SPECIFICATION", 3),
    ("COLOUR_SPECIFICATION", "COLOUR", 1),
    ("COMPOSITE_CURVE", "BOUNDED_CURVE", 2),
    ("COMPOSITE_CURVE_ON_SURFACE", "COMPOSITE_CURVE", 0),
    ("COMPOSITE_CURVE_SEGMENT", "", 3),
    ("CONIC", "CURVE", 1),
    ("CONICAL_SURFACE", "ELEMENTARY_SURFACE", 2),
    ("CONNECTED_FACE_SET", "TOPOLOGICAL_REPRESENTATION_ITEM", 1),
    ("CONNECTED_FACE_SUB_SET", "CONNECTED_FACE_SET", 1),
    (
        "CONSTRUCTIVE_GEOMETRY_REPRESENTATION_RELATIONSHIP",
        "REPRESENTATION_RELATIONSHIP",
        0,
    ),
    ("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION", "", 2),
    ("CONTEXT_DEPENDENT_UNIT", "NAMED_UNIT", 1),
    ("CONVERSION_BASED_UNIT", "NAMED_UNIT", 2),
    ("CSG_SHAPE_REPRESENTATION", "SHAPE_REPRESENTATION", 0),
    ("CURVE", "GEOMETRIC_REPRESENTATION_ITEM", 0),
    ("CURVE_BOUNDED_SURFACE", "BOUNDED_SURFACE", 3),
    ("CYLINDRICAL_SURFACE", "ELEMENTARY_SURFACE", 1),
    ("DEFINITIONAL_REPRESENTATION", "REPRESENTATION", 0),
    ("DEGENERATE_PCURVE", "POINT", 2),
    ("DEGENERATE_TOROIDAL_SURFACE", "TOROIDAL_SURFACE", 1),
    ("DIRECTION", "GEOMETRIC_REPRESENTATION_ITEM", 1),
    ("DRAUGHTING_PRE_DEFINED_COLOUR", "PRE_DEFINED_COLOUR", 0),
    ("EDGE", "TOPOLOGICAL_REPRESENTATION_ITEM", 2),
    ("EDGE_CURVE", "EDGE", 2),
    ("EDGE_LOOP", "PATH", 0),
    (
        "ELEMENTARY_BREP_SHAPE_REPRESENTATION",
        "SHAPE_REPRESENTATION",
        0,
    ),
    ("ELEMENTARY_SURFACE", "SURFACE", 1),
    ("ELLIPSE", "CONIC", 2),
    ("FACE", "TOPOLOGICAL_REPRESENTATION_ITEM", 1),
    ("FACETED_BREP", "MANIFOLD_SOLID_BREP", 0),
    (
        "FACETED_BREP_SHAPE_REPRESENTATION",
        "SHAPE_REPRESENTATION",
        0,
    ),
    (
        "FACE_BASED_SURFACE_MODEL",
        "GEOMETRIC_REPRESENTATION_ITEM",
        1,
    ),
    ("FACE_BOUND", "TOPOLOGICAL_REPRESENTATION_ITEM", 2),
    ("FACE_OUTER_BOUND", "FACE_BOUND", 0),
    ("FACE_SURFACE", "FACE", 2),
    ("FILL_AREA_STYLE", "", 2),
    ("FILL_AREA_STYLE_COLOUR", "", 2),
    (
        "GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION",
        "SHAPE_REPRESENTATION",
        0,
    ),
    ("GEOMETRIC_CURVE_SET", "GEOMETRIC_SET", 0),
    (
        "GEOMETRIC_REPRESENTATION_CONTEXT",
        "REPRESENTATION_CONTEXT",
        1,
    ),
    ("GEOMETRIC_REPRESENTATION_ITEM", "REPRESENTATION_ITEM", 0),
    ("GEOMETRIC_SET", "GEOMETRIC_REPRESENTATION_ITEM", 1),
    (
        "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT",
        "REPRESENTATION_CONTEXT",
        1,
    ),
    ("GLOBAL_UNIT_ASSIGNED_CONTEXT", "REPRESENTATION_CONTEXT", 1),
    ("HYPERBOLA", "CONIC", 2),
    ("INTERSECTION_CURVE", "SURFACE_CURVE", 0),
    ("INVISIBILITY", "", 1),
    ("ITEM_DEFINED_TRANSFORMATION", "", 4),
    ("LENGTH_MEASURE_WITH_UNIT", "MEASURE_WITH_UNIT", 0),
    ("LENGTH_UNIT", "NAMED_UNIT", 0),
    ("LINE", "CURVE", 2),
    ("LOOP", "TOPOLOGICAL_REPRESENTATION_ITEM", 0),
    ("MANIFOLD_SOLID_BREP", "SOLID_MODEL", 1),
    (
        "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
        "SHAPE_REPRESENTATION",
        0,
    ),
    ("MAPPED_ITEM", "REPRESENTATION_ITEM", 2),
    ("MEASURE_WITH_UNIT", "", 2),
    ("NAMED_UNIT", "", 1),
    (
        "NEXT_ASSEMBLY_USAGE_OCCURRENCE",
        "ASSEMBLY_COMPONENT_USAGE",
        0,
    ),
    (
        "NON_MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
        "SHAPE_REPRESENTATION",
        0,
    ),
    ("OFFSET_CURVE_3D", "CURVE", 4),
    ("OFFSET_SURFACE", "SURFACE", 3),
    ("OPEN_SHELL", "CONNECTED_FACE_SET", 0),
    ("ORIENTED_CLOSED_SHELL", "CLOSED_SHELL", 2),
    ("ORIENTED_EDGE", "EDGE", 2),
    ("ORIENTED_FACE", "FACE", 2),
    ("ORIENTED_OPEN_SHELL", "OPEN_SHELL", 2),
    ("OUTER_BOUNDARY_CURVE", "BOUNDARY_CURVE", 0),
    ("OVER_RIDING_STYLED_ITEM", "STYLED_ITEM", 1),
    ("PARABOLA", "CONIC", 1),
    ("PATH", "TOPOLOGICAL_REPRESENTATION_ITEM", 1),
    ("PCURVE", "CURVE", 2),
    ("PLACEMENT", "GEOMETRIC_REPRESENTATION_ITEM", 1),
    ("PLANE", "ELEMENTARY_SURFACE", 0),
    ("PLANE_ANGLE_MEASURE_WITH_UNIT", "MEASURE_WITH_UNIT", 0),
    ("PLANE_ANGLE_UNIT", "NAMED_UNIT", 0),
    ("POINT", "GEOMETRIC_REPRESENTATION_ITEM", 0),
    ("POLYLINE", "BOUNDED_CURVE", 1),
    ("POLY_LOOP", "LOOP", 1),
    ("PRESENTATION_LAYER_ASSIGNMENT", "", 3),
    ("PRESENTATION_STYLE_ASSIGNMENT", "", 1),
    (
        "PRESENTATION_STYLE_BY_CONTEXT",
        "PRESENTATION_STYLE_ASSIGNMENT",
        1,
    ),
    ("PRE_DEFINED_COLOUR", "PRE_DEFINED_ITEM", 0),
    ("PRE_DEFINED_ITEM", "", 1),
    ("PRODUCT", "", 4),
    ("PRODUCT_DEFINITION", "", 4),
    ("PRODUCT_DEFINITION_FORMATION", "", 3),
    (
        "PRODUCT_DEFINITION_FORMATION_WITH_SPECIFIED_SOURCE",
        "PRODUCT_DEFINITION_FORMATION",
        1,
    ),
    ("PRODUCT_DEFINITION_RELATIONSHIP", "", 5),
    ("PRODUCT_DEFINITION_SHAPE", "PROPERTY_DEFINITION", 0),
    (
        "PRODUCT_DEFINITION_USAGE",
        "PRODUCT_DEFINITION_RELATIONSHIP",
        0,
    ),
    (
        "PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS",
        "PRODUCT_DEFINITION",
        1,
    ),
    ("PROPERTY_DEFINITION", "", 3),
    ("PROPERTY_DEFINITION_REPRESENTATION", "", 2),
    ("QUASI_UNIFORM_CURVE", "B_SPLINE_CURVE", 0),
    ("QUASI_UNIFORM_SURFACE", "B_SPLINE_SURFACE", 0),
    ("RATIONAL_B_SPLINE_CURVE", "B_SPLINE_CURVE", 1),
    ("RATIONAL_B_SPLINE_SURFACE", "B_SPLINE_SURFACE", 1),
    ("RECTANGULAR_COMPOSITE_SURFACE", "BOUNDED_SURFACE", 1),
    ("RECTANGULAR_TRIMMED_SURFACE", "BOUNDED_SURFACE", 7),
    (
        "REPARAMETRISED_COMPOSITE_CURVE_SEGMENT",
        "COMPOSITE_CURVE_SEGMENT",
        1,
    ),
    ("REPRESENTATION", "", 3),
    ("REPRESENTATION_CONTEXT", "", 2),
    ("REPRESENTATION_ITEM", "", 1),
    ("REPRESENTATION_MAP", "", 2),
    ("REPRESENTATION_RELATIONSHIP", "", 4),
    (
        "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION",
        "REPRESENTATION_RELATIONSHIP",
        1,
    ),
    ("SEAM_CURVE", "SURFACE_CURVE", 0),
    (
        "SHAPE_DEFINITION_REPRESENTATION",
        "PROPERTY_DEFINITION_REPRESENTATION",
        0,
    ),
    ("SHAPE_REPRESENTATION", "REPRESENTATION", 0),
    (
        "SHAPE_REPRESENTATION_RELATIONSHIP",
        "REPRESENTATION_RELATIONSHIP",
        0,
    ),
    (
        "SHAPE_REPRESENTATION_WITH_PARAMETERS",
        "SHAPE_REPRESENTATION",
        0,
    ),
    (
        "SHELL_BASED_SURFACE_MODEL",
        "GEOMETRIC_REPRESENTATION_ITEM",
        1,
    ),
    ("SI_UNIT", "NAMED_UNIT", 2),
    ("SOLID_MODEL", "GEOMETRIC_REPRESENTATION_ITEM", 0),
    ("SPHERICAL_SURFACE", "ELEMENTARY_SURFACE", 1),
    ("STYLED_ITEM", "REPRESENTATION_ITEM", 2),
    ("SUBEDGE", "EDGE", 1),
    ("SUBFACE", "FACE", 1),
    ("SURFACE", "GEOMETRIC_REPRESENTATION_ITEM", 0),
    ("SURFACED_OPEN_SHELL", "OPEN_SHELL", 0),
    ("SURFACE_CURVE", "CURVE", 3),
    ("SURFACE_OF_LINEAR_EXTRUSION", "SWEPT_SURFACE", 1),
    ("SURFACE_OF_REVOLUTION", "SWEPT_SURFACE", 1),
    ("SURFACE_REPLICA", "SURFACE", 2),
    ("SURFACE_SIDE_STYLE", "", 2),
    ("SURFACE_STYLE_FILL_AREA", "", 1),
    ("SURFACE_STYLE_RENDERING", "", 2),
    (
        "SURFACE_STYLE_RENDERING_WITH_PROPERTIES",
        "SURFACE_STYLE_RENDERING",
        1,
    ),
    ("SURFACE_STYLE_USAGE", "", 2),
    ("SWEPT_SURFACE", "SURFACE", 1),
    (
        "TESSELLATED_SHAPE_REPRESENTATION",
        "SHAPE_REPRESENTATION",
        0,
    ),
    ("TOPOLOGICAL_REPRESENTATION_ITEM", "REPRESENTATION_ITEM", 0),
    ("TOROIDAL_SURFACE", "ELEMENTARY_SURFACE", 2),
    ("TRIMMED_CURVE", "BOUNDED_CURVE", 5),
    ("UNCERTAINTY_MEASURE_WITH_UNIT", "MEASURE_WITH_UNIT", 2),
    ("UNIFORM_CURVE", "B_SPLINE_CURVE", 0),
    ("UNIFORM_SURFACE", "B_SPLINE_SURFACE", 0),
    ("VECTOR", "GEOMETRIC_REPRESENTATION_ITEM", 2),
    ("VERTEX", "TOPOLOGICAL_REPRESENTATION_ITEM", 0),
    ("VERTEX_LOOP", "LOOP", 1),
    ("VERTEX_POINT", "VERTEX", 1),
];

fn row(name: &[u8]) -> Option<&'static Row> {
    let k = TYPES
        .binary_search_by(|row| row.0.as_bytes().cmp(name))
        .ok()?;
    Some(&TYPES[k])
}

/// A type and its supertypes.
fn line(name: &[u8]) -> impl Iterator<Item = &'static Row> {
    std::iter::successors(row(name), |r| row(r.1.as_bytes()))
}

/// Whether an instance of the type `name` is one of `kind`. There are many kinds of shape representations, alike but for
/// what they may hold, so that their names alone tell them.
pub fn is_a(name: &[u8], kind: &str) -> bool {
    let shape: &[u8] = b"SHAPE_REPRESENTATION";
    let known = |name: &[u8]| name == kind.as_bytes() || line(name).any(|r| r.0 == kind);
    known(name) || (name.ends_with(shape) && row(name).is_none() && known(shape))
}

/// The number of attributes in front of those that `kind` adds; zero where it is not known.
pub fn inherited(kind: &str) -> usize {
    line(kind.as_bytes()).skip(1).map(|r| r.2).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_are_sorted_and_their_supertypes_known() {
        assert!(
            TYPES
                .windows(2)
                .all(|w| w[0].0.as_bytes() < w[1].0.as_bytes())
        );
        for (name, parent, _) in TYPES {
            assert!(
                parent.is_empty() || row(parent.as_bytes()).is_some(),
                "{name}"
            );
        }
    }

    #[test]
    fn attributes_of_supertypes_come_first() {
        assert!(is_a(b"ADVANCED_FACE", "FACE_SURFACE"));
        assert!(!is_a(b"FACE_SURFACE", "ADVANCED_FACE"));
        assert_eq!(inherited("B_SPLINE_SURFACE_WITH_KNOTS"), 8);
        assert_eq!(inherited("FACE_SURFACE"), 2);
        assert_eq!(inherited("ORIENTED_EDGE"), 3);
    }
}
