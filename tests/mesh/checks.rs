//! Checks, sets, selections, columns and sizes of meshes.
use covact::mesh::{
    ElementKind, Face, Mesh, MeshError, Selected, SetKind, ThicknessColumns, build, cylinder_panel,
    plate,
};
use covact::scene::{Corners, CylinderPanel, MeshFile, MeshSource, Plate, Selection};
use covact_geometry::Vec3;
use std::path::Path;

/// 4 x 3 elements of 1 x 1 x 0.2 in two layers of 0.1, mid-surface at z = 0.
fn sheet() -> Mesh {
    plate(&sheet_plate(), ElementKind::H8).unwrap()
}

fn sheet_plate() -> Plate {
    Plate {
        size: [4.0, 3.0],
        thickness: 0.2,
        elements: [4, 3],
        layers: 2,
        origin: [0.0; 3],
        spacing: Default::default(),
    }
}

#[test]
fn inverted_elements_are_named() {
    let mut mesh = sheet();
    // A node pushed down through the layer below it: all four elements above... and below it are affected.
    let top = mesh.node_set("top").unwrap()[6] as usize;
    mesh.nodes[top].z = -0.5;
    let error = mesh.check().unwrap_err();
    let MeshError::Inverted {
        element,
        tag,
        position,
        jacobian,
        count,
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!((element, tag, count), (12, None, 4));
    assert!((position[0] - 0.5).abs() < 1e-12 && (position[1] - 0.5).abs() < 1e-12);
    // At that node: edges 1 and 1 halved, and a thickness of -0.5 instead of 0.1, halved.
    assert!((jacobian + 0.5 * 0.5 * 0.25).abs() < 1e-12, "{jacobian}");

    // Mirrored as a whole.
    let mut mesh = sheet();
    mesh.connectivity[..8].rotate_left(4);
    let text = mesh.check().unwrap_err().to_string();
    assert!(
        text.starts_with("element 0 at (0.500000, 0.500000, -0.050000) is inverted"),
        "{text}"
    );

    // Flat.
    let mut mesh = sheet();
    mesh.nodes.iter_mut().for_each(|x| x.z = 0.0);
    assert!(matches!(
        mesh.check(),
        Err(MeshError::Inverted { count: 24, .. })
    ));
}

#[test]
fn stray_and_coincident_nodes_are_named() {
    let mut mesh = sheet();
    mesh.nodes.push(Vec3::new(9.0, 9.0, 9.0));
    mesh.nodes.push(Vec3::new(9.0, 9.0, 8.0));
    assert!(matches!(
        mesh.check(),
        Err(MeshError::UnusedNode {
            node: 60,
            count: 2,
            ..
        })
    ));

    // Two parts that touch in a face with nodes of their own are kept apart: they may be partners in contact.
    let joined = |shift: f64| {
        let mut mesh = sheet();
        let other = sheet();
        let n = mesh.nodes.len() as u32;
        mesh.connectivity
            .extend(other.connectivity.iter().map(|i| i + n));
        let moved = other.nodes.iter().map(|x| x + Vec3::new(shift, 0.0, 0.0));
        mesh.nodes.extend(moved);
        assert_eq!(mesh.components(), 2);
        mesh
    };
    joined(4.0 + 1e-9).check().unwrap();
    joined(4.01).check().unwrap();
    // One part twice in the same place is a mistake.
    let error = joined(1e-9).check().unwrap_err();
    let MeshError::DuplicateNodes {
        first,
        second,
        tags,
        count,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!((first, second, tags, count), (0, 60, None, 60));
    // And so are two nodes at one place within a part: a slit.
    let mut mesh = sheet();
    let shared = mesh.connectivity[1];
    assert!(mesh.element(1).contains(&shared));
    mesh.nodes.push(mesh.nodes[shared as usize]);
    mesh.connectivity[1] = mesh.nodes.len() as u32 - 1;
    let error = mesh.check().unwrap_err();
    assert!(matches!(error, MeshError::DuplicateNodes { .. }), "{error}");
    assert!(error.to_string().contains("`\"slits\": true`"), "{error}");

    let mut mesh = sheet();
    mesh.nodes[3].y = f64::NAN;
    assert!(matches!(
        mesh.check(),
        Err(MeshError::NotFinite { node: 3, .. })
    ));
    let mut mesh = sheet();
    mesh.connectivity[9] = 60;
    let text = mesh.check().unwrap_err().to_string();
    assert_eq!(text, "element 1 refers to node 60, but there are only 60");
    let mut mesh = sheet();
    mesh.face_sets.insert(
        "bad".to_string(),
        vec![Face {
            element: 24,
            face: 0,
        }],
    );
    assert!(matches!(mesh.check(), Err(MeshError::OutOfRange { .. })));
}

#[test]
fn non_manifold_faces_are_named() {
    let mut mesh = sheet();
    let copy = mesh.element(5).to_vec();
    mesh.connectivity.extend(copy);
    let error = mesh.check().unwrap_err();
    let MeshError::NonManifold { elements, .. } = &error else {
        panic!("{error}");
    };
    assert!(elements.contains(&5) && elements.contains(&24), "{error}");
    // Two equal elements alone: two on the same side of each face.
    let mut mesh = sheet();
    mesh.connectivity.truncate(8);
    mesh.connectivity.extend_from_within(..);
    let used: Vec<u32> = mesh.connectivity[..8].to_vec();
    mesh.nodes = used.iter().map(|&n| mesh.nodes[n as usize]).collect();
    mesh.connectivity = (0..8).chain(0..8).collect();
    mesh.node_sets.clear();
    mesh.face_sets.clear();
    assert!(matches!(mesh.check(), Err(MeshError::NonManifold { .. })));
}

#[test]
fn columns_go_through_all_layers() {
    let mesh = sheet();
    let columns = ThicknessColumns::new(&mesh);
    let opposite = mesh.opposite_nodes();
    let mut pairs = 0;
    for &node in mesh.node_set("bottom").unwrap() {
        let partner = columns.partner(node).unwrap();
        assert!(mesh.node_set("top").unwrap().contains(&partner));
        let step = mesh.nodes[partner as usize] - mesh.nodes[node as usize];
        assert!((step - Vec3::new(0.0, 0.0, 0.2)).norm() < 1e-14);
        assert_eq!(columns.partner(partner), Some(node));
        assert_eq!(opposite[node as usize], Some(partner));
        assert_eq!(mesh.thickness_partner(node), Some(partner));
        assert_eq!(columns.ends(node), Some([node, partner]));
        assert_eq!(columns.ends(partner), Some([node, partner]));
        pairs += 1;
    }
    assert_eq!(pairs, 20);
    // The nodes between the layers have no partner but know the ends of their column.
    let inside: Vec<u32> = (0..60)
        .filter(|n| opposite[*n as usize].is_none())
        .collect();
    assert_eq!(inside, (20..40).collect::<Vec<u32>>());
    assert_eq!(columns.ends(20), Some([0, 40]));
    assert_eq!(columns.partner(60), None);
    assert_eq!(columns.ends(60), None);
}

#[test]
fn columns_that_branch_or_circle_have_no_partner() {
    // Turned on its side, the thickness of the first element runs along x into its neighbours: no straight columns.
    let mut mesh = sheet();
    let nodes = mesh.element(0).to_vec();
    for a in 0..8 {
        let old = (a >> 2 & 1) | (a & 1) << 1 | (a >> 1 & 1) << 2;
        mesh.connectivity[a] = nodes[old];
    }
    mesh.check().unwrap();
    let opposite = mesh.opposite_nodes();
    assert!(opposite.iter().filter(|n| n.is_none()).count() > 20);

    // A closed ring whose thickness runs around it.
    let ring = cylinder_panel(
        &CylinderPanel {
            radius: 5.0,
            thickness: 1.0,
            angles: [0.0, 360.0],
            y: [0.0, 1.0],
            elements: [8, 1],
            layers: 1,
            origin: [0.0; 3],
        },
        ElementKind::H8,
    );
    let mut ring = ring.unwrap();
    for e in 0..8 {
        let nodes = ring.element(e).to_vec();
        for a in 0..8 {
            let old = (a >> 2 & 1) | (a & 1) << 1 | (a >> 1 & 1) << 2;
            ring.connectivity[8 * e + a] = nodes[old];
        }
    }
    ring.check().unwrap();
    assert!(ring.opposite_nodes().iter().all(Option::is_none));
    assert_eq!(ThicknessColumns::new(&ring).ends(0), None);
}

#[test]
fn selections_find_what_they_describe() {
    let mut mesh = sheet();
    let nodes = |mesh: &Mesh, s: Selection| match mesh.select(&s).unwrap() {
        Selected::Nodes(nodes) => nodes,
        Selected::Faces(_) => panic!("faces"),
    };
    let faces = |mesh: &Mesh, s: Selection| match mesh.select(&s).unwrap() {
        Selected::Faces(faces) => faces,
        Selected::Nodes(_) => panic!("nodes"),
    };
    // Borders count, although 0.1 + (-0.2 / 2) is not exact.
    let box_ = Selection::NodesInBox(Corners {
        min: [1.0, 1.0, -0.1],
        max: [2.0, 2.0, 0.1],
    });
    assert_eq!(nodes(&mesh, box_).len(), 2 * 2 * 3);
    let half = Selection::NodesInBox(Corners {
        min: [f64::NEG_INFINITY; 3],
        max: [f64::INFINITY, f64::INFINITY, 0.05],
    });
    assert_eq!(nodes(&mesh, half).len(), 40);
    let plane = Selection::NodesNearPlane {
        point: [0.0; 3],
        normal: [0.0, 0.0, 4.0],
        tolerance: 0.0,
    };
    assert_eq!(nodes(&mesh, plane), (20..40).collect::<Vec<u32>>());
    let point = Selection::NodesNearPoint {
        point: [4.0, 3.0, 0.0],
        tolerance: 0.1,
    };
    assert_eq!(nodes(&mesh, point).len(), 3);
    let facing = Selection::FacesFacing {
        normal: [0.0, 0.0, 1.0],
        angle: 0.0,
    };
    assert_eq!(faces(&mesh, facing.clone()), mesh.face_sets["top"]);
    let both = Selection::FacesFacing {
        normal: [-1.0, -1.0, 0.0],
        angle: 45.0,
    };
    assert_eq!(faces(&mesh, both).len(), 4 * 2 + 3 * 2);
    let in_box = Selection::FacesInBox(Corners {
        min: [-1.0, -1.0, 0.1],
        max: [2.0, 9.0, 0.1],
    });
    assert_eq!(faces(&mesh, in_box).len(), 2 * 3);

    mesh.add_set("upper", &facing).unwrap();
    assert_eq!(
        mesh.face_set("upper").unwrap(),
        mesh.face_set("top").unwrap()
    );
    assert_eq!(
        mesh.node_set("upper").unwrap(),
        mesh.node_set("top").unwrap()
    );
    assert!(matches!(
        mesh.add_set("upper", &facing),
        Err(MeshError::SetExists { .. })
    ));
}

#[test]
fn empty_selections_tell_how_far_off_they_are() {
    let mesh = sheet();
    let miss = |s: Selection| match mesh.select(&s).unwrap_err() {
        MeshError::EmptySelection { nearest, unit, .. } => (nearest, unit),
        other => panic!("{other}"),
    };
    let close = |(a, unit): (f64, &str), b: f64, expected: &str| {
        assert!((a - b).abs() < 1e-9 && unit == expected, "{a} {unit}");
    };
    let length = "length units";
    close(
        miss(Selection::NodesInBox(Corners {
            min: [7.0, 7.0, 0.0],
            max: [8.0; 3],
        })),
        5.0,
        length,
    );
    close(
        miss(Selection::NodesNearPlane {
            point: [0.0, 0.0, 1.0],
            normal: [0.0, 0.0, -2.0],
            tolerance: 0.5,
        }),
        0.4,
        length,
    );
    close(
        miss(Selection::NodesNearPoint {
            point: [5.0, 3.0, 0.1],
            tolerance: 0.25,
        }),
        0.75,
        length,
    );
    // An upper face of the last column, x from 3 to 4, sticks out by 0.2 on both sides.
    close(
        miss(Selection::FacesInBox(Corners {
            min: [3.2, 0.0, 0.1],
            max: [3.8, 9.0, 0.1],
        })),
        0.2,
        length,
    );
    close(
        miss(Selection::FacesFacing {
            normal: [0.0, 1.0, 1.0],
            angle: 30.0,
        }),
        15.0,
        "degrees",
    );
    let text = mesh
        .select(&Selection::NodesNearPoint {
            point: [5.0, 3.0, 0.1],
            tolerance: 0.25,
        })
        .unwrap_err();
    assert_eq!(
        text.to_string(),
        "nodes_near_point (point (5, 3, 0.1), tolerance 0.25) selects nothing: the nearest node is 0.750000 length units away from it"
    );
}

#[test]
fn selections_without_meaning_are_refused() {
    let mesh = sheet();
    for (selection, part) in [
        (
            Selection::NodesInBox(Corners {
                min: [0.0, 1.0, 0.0],
                max: [1.0, 0.0, 1.0],
            }),
            "min[1], max[1] is 1 > 0",
        ),
        (
            Selection::FacesInBox(Corners {
                min: [f64::NAN; 3],
                max: [1.0; 3],
            }),
            "NaN",
        ),
        (
            Selection::NodesNearPlane {
                point: [0.0; 3],
                normal: [0.0; 3],
                tolerance: 1.0,
            },
            "normal is (0, 0, 0)",
        ),
        (
            Selection::NodesNearPoint {
                point: [0.0; 3],
                tolerance: -1.0,
            },
            "tolerance is -1",
        ),
        (
            Selection::FacesFacing {
                normal: [f64::INFINITY, 0.0, 0.0],
                angle: 1.0,
            },
            "normal",
        ),
        (
            Selection::FacesFacing {
                normal: [1.0, 0.0, 0.0],
                angle: f64::NAN,
            },
            "angle is NaN",
        ),
    ] {
        let error = mesh.select(&selection).unwrap_err();
        assert!(matches!(error, MeshError::Invalid { .. }), "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
}

#[test]
fn misspelt_sets_get_a_suggestion() {
    let mesh = sheet();
    let error = mesh.face_set("botom").unwrap_err();
    assert_eq!(
        error.to_string(),
        "no face set `botom` (did you mean `bottom`?); face sets: bottom, top, x_max, x_min, y_max, y_min"
    );
    let MeshError::UnknownSet {
        kind,
        suggestion,
        available,
        ..
    } = mesh.node_set("qqq").unwrap_err()
    else {
        panic!();
    };
    assert_eq!(
        (kind, suggestion, available.len()),
        (SetKind::Node, None, 6)
    );
}

#[test]
fn sizes_are_measured() {
    let size = sheet().element_size().unwrap();
    for (value, expected) in [
        (size.edge.min, 1.0),
        (size.edge.mean, 1.0),
        (size.edge.max, 1.0),
        (size.thickness.min, 0.1),
        (size.thickness.max, 0.1),
        (size.shape.min, 1.0),
    ] {
        assert!((value - expected).abs() < 1e-12, "{value} {expected}");
    }
    // Sheared by 45 degrees in its plane.
    let mut mesh = sheet();
    mesh.nodes.iter_mut().for_each(|x| x.x += x.y);
    let size = mesh.element_size().unwrap();
    assert!((size.shape.max - 0.5f64.sqrt()).abs() < 1e-12);
    assert!((size.edge.max - 2f64.sqrt()).abs() < 1e-12);
}

#[test]
fn build_reports_and_refuses() {
    let (mesh, report) = build(
        &MeshSource::Plate(sheet_plate()),
        ElementKind::H8,
        Path::new("."),
    )
    .unwrap();
    assert_eq!(
        (mesh.elements(), report.components, report.notes.len()),
        (24, 1, 0)
    );
    // Valid numbers, but the thickness drowns in the origin's round-off.
    let mut far = sheet_plate();
    far.origin[2] = 1e17;
    assert!(matches!(
        build(&MeshSource::Plate(far), ElementKind::H8, Path::new(".")),
        Err(MeshError::Inverted { .. })
    ));

    let file = |path: &str, scale| {
        MeshSource::File(MeshFile {
            scale,
            ..MeshFile::new(path)
        })
    };
    let error = |source| {
        build(&source, ElementKind::H8, Path::new("some/where"))
            .unwrap_err()
            .to_string()
    };
    let missing = error(file("nothing.msh", 1.0));
    assert!(
        missing.starts_with("cannot read mesh file some/where/nothing.msh: "),
        "{missing}"
    );
    assert!(error(file("mesh.obj", 1.0)).contains("mesh.obj: mesh files end in .msh"));
    assert!(error(file("mesh.msh", 0.0)).contains("scale is 0"));
}
