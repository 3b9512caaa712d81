//! Sense of rotation, and surfaces that cannot become a body.
use crate::support::{Surface, file, grid, h8};
use covact::mesh::{MeshError, SurfaceError};
use covact_geometry::Vec3;

fn refused(surface: &Surface) -> (SurfaceError, String) {
    let error = h8(&surface.inp(), &file(0.1)).unwrap_err();
    let text = error.to_string();
    assert!(text.starts_with("a.inp: "), "{text}");
    match error {
        MeshError::Surface { source, .. } => (source, text),
        other => panic!("{other}"),
    }
}

fn flat() -> Surface {
    grid(4, 3, |u, v| [4.0 * u, 3.0 * v, 0.0])
}

/// Whatever elements are turned around, the body is the same; the side of the majority is the top.
#[test]
fn turned_elements_are_turned_back() {
    let (expected, report) = h8(&flat().inp(), &file(0.1)).unwrap();
    assert!(report.notes.is_empty(), "{:?}", report.notes);
    let mut surface = flat();
    for k in [0, 3, 7, 8] {
        surface.facets[k].reverse();
    }
    let (mesh, report) = h8(&surface.inp(), &file(0.1)).unwrap();
    assert!(report.notes[0].starts_with("4 of 12 surface elements looked against"));
    assert_eq!(mesh.nodes, expected.nodes);
    for set in ["top", "bottom", "x_min", "border"] {
        let [a, b] = [&mesh, &expected].map(|m| m.node_set(set).unwrap());
        assert_eq!(a, b, "{set}");
    }
    // Most of them turned: the other side is the top.
    for facet in &mut surface.facets {
        facet.reverse();
    }
    let (mesh, _) = h8(&surface.inp(), &file(0.1)).unwrap();
    for &face in mesh.face_set("top").unwrap() {
        assert!((mesh.face_area_normal(face).1 + Vec3::z()).norm() < 1e-14);
    }
}

#[test]
fn a_moebius_strip_has_no_thickness() {
    let n = 24;
    let mut surface = Surface::default();
    for i in 0..n {
        let phi = std::f64::consts::TAU * i as f64 / n as f64;
        for s in [-1.0, 1.0] {
            let r = 5.0 + s * (0.5 * phi).cos();
            surface
                .points
                .push([r * phi.cos(), r * phi.sin(), s * (0.5 * phi).sin()]);
        }
    }
    for i in 0..n {
        let [a, b] = [2 * i, 2 * i + 1];
        let next = if i + 1 == n { [1, 0] } else { [a + 2, b + 2] };
        surface.facets.push(vec![a, next[0], next[1], b]);
    }
    let (error, text) = refused(&surface);
    assert!(matches!(error, SurfaceError::OneSided { .. }), "{text}");
    assert!(text.contains("only one side"), "{text}");
}

/// A wall upon a floor: the elements at the joint are named.
#[test]
fn branches_are_named() {
    let mut surface = flat();
    let wall = surface.points.len();
    for j in 0..=3 {
        surface.points.push([2.0, j as f64, 1.0]);
    }
    for j in 0..3 {
        surface
            .facets
            .push(vec![2 + 5 * j, 2 + 5 * (j + 1), wall + j + 1, wall + j]);
    }
    let (error, text) = refused(&surface);
    let SurfaceError::Branching { elements, position } = error else {
        panic!("{text}");
    };
    assert_eq!(elements, [2, 3, 13]);
    assert_eq!(position, [2.0, 0.5, 0.0]);
    assert!(
        text.contains("elements 2, 3, 13 meet in one edge at (2.000000, 0.500000"),
        "{text}"
    );
}

#[test]
fn parts_joined_by_a_node_are_refused() {
    let mut surface = grid(2, 2, |u, v| [u, v, 0.0]);
    // Opposite quarters only.
    surface.facets = vec![surface.facets[0].clone(), surface.facets[3].clone()];
    let (error, text) = refused(&surface);
    assert!(
        matches!(error, SurfaceError::Pinched { node: 5, .. }),
        "{text}"
    );
}

#[test]
fn sharp_folds_flat_and_doubled_elements() {
    // A strip folded back by 160 degrees.
    let a = 160f64.to_radians();
    let surface = grid(4, 2, |u, v| match u <= 0.5 {
        true => [u - 0.5, v, 0.0],
        false => [(u - 0.5) * a.cos(), v, (u - 0.5) * a.sin()],
    });
    let (error, text) = refused(&surface);
    let SurfaceError::SharpFold { angle, position } = error else {
        panic!("{text}");
    };
    assert!(
        (angle - 160.0).abs() < 1e-6 && position[0].abs() < 1e-12,
        "{text}"
    );

    let mut surface = flat();
    surface.points[6] = surface.points[5];
    let (error, text) = refused(&surface);
    assert!(matches!(error, SurfaceError::Flat { .. }), "{text}");

    let mut surface = flat();
    surface.facets.push(vec![6, 11, 12, 7]);
    let (error, text) = refused(&surface);
    let SurfaceError::Twice { mut elements, .. } = error else {
        panic!("{text}");
    };
    elements.sort_unstable();
    assert_eq!(elements, [6, 13]);

    // A quadrilateral whose corner is there twice is a triangle.
    let mut surface = flat();
    surface.facets[0] = vec![0, 1, 6, 6];
    let (mesh, report) = h8(&surface.inp(), &file(0.1)).unwrap();
    assert!(
        report.notes[0].contains("taken for triangles"),
        "{:?}",
        report.notes
    );
    assert!((mesh.volume() - 0.1 * 11.5).abs() < 1e-12);
}

/// A ring whose ends touch, but have nodes of their own, would gape. Two plates that touch are two parts.
#[test]
fn borders_that_touch() {
    let ring = grid(12, 1, |u, v| {
        let phi = std::f64::consts::TAU * u;
        [phi.sin(), v, phi.cos()]
    });
    let (error, text) = refused(&ring);
    let SurfaceError::Unjoined { nodes, count, .. } = error else {
        panic!("{text}");
    };
    assert_eq!((nodes, count), ([1, 13], 2));
    assert!(
        text.contains("nodes 1 and 13 lie at the same place"),
        "{text}"
    );

    let mut angle = flat();
    let first = angle.points.len();
    let wall = grid(2, 3, |u, v| [4.0, 3.0 * v, u]);
    angle.points.extend(&wall.points);
    let moved = |f: &Vec<usize>| f.iter().map(|n| n + first).collect();
    angle.facets.extend(wall.facets.iter().map(moved));
    let (_, report) = h8(&angle.inp(), &file(0.1)).unwrap();
    assert_eq!(report.components, 2);
    let told = |text: &str| report.notes.iter().any(|n| n.starts_with(text));
    assert!(
        told("4 pair(s) of nodes of unconnected parts lie at the same place"),
        "{:?}",
        report.notes
    );
}

/// A thickness far above the radius of a bend turns elements inside out; the element is named by its number in the file.
#[test]
fn too_thick_for_a_bend() {
    let surface = grid(12, 1, |u, v| {
        let phi = 3.0 * u;
        [phi.sin(), v, phi.cos()]
    });
    let error = h8(&surface.inp(), &file(3.0)).unwrap_err();
    // The nodes of both ends stand upright, so that their elements keep half of their length at the bottom.
    let MeshError::Inverted {
        element,
        tag,
        count,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!((element, tag, count), (1, Some(2), 10));
}

/// Solid elements have no surface, surfaces no volume: each is told what to do.
#[test]
fn the_other_kind_of_mesh() {
    let solid = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
                 *ELEMENT, TYPE=C3D8\n1,1,2,3,4,5,6,7,8\n";
    let text = h8(solid, &file(0.1)).unwrap_err().to_string();
    assert!(
        text.contains("no quadrilaterals or triangles") && text.contains("leave `thickness` out"),
        "{text}"
    );
    let mut wanted = file(0.1);
    wanted.thickness = None;
    let text = h8(&flat().inp(), &wanted).unwrap_err().to_string();
    assert!(
        text.contains("no hexahedra") && text.contains("\"thickness\": 1"),
        "{text}"
    );
}
