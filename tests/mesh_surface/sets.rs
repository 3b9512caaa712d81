//! Names of sides, borders, and the file's own sets.
use crate::support::{file, grid, h8};
use covact::mesh::{Mesh, MeshError, SurfaceError};
use covact::scene::{MeshFile, Thickness};
use covact_geometry::Vec3;

/// 6 x 4 elements over `[0, 6] x [0, 4]` without the two in the middle.
fn with_hole() -> crate::support::Surface {
    let mut surface = grid(6, 4, |u, v| [6.0 * u, 4.0 * v, 0.0]);
    surface.facets.remove(9);
    surface.facets.remove(8);
    surface
}

fn area(mesh: &Mesh, set: &str) -> f64 {
    let faces = mesh.face_set(set).unwrap();
    faces.iter().map(|&f| mesh.face_area_normal(f).0).sum()
}

fn all_on(mesh: &Mesh, set: &str, on: impl Fn(&Vec3) -> bool) -> usize {
    let nodes = mesh.node_set(set).unwrap();
    assert!(nodes.iter().all(|&n| on(&mesh.nodes[n as usize])), "{set}");
    nodes.len()
}

#[test]
fn borders_are_numbered_by_length() {
    for layers in [1, 3] {
        let wanted = MeshFile {
            layers: Some(layers),
            ..file(0.5)
        };
        let (mesh, report) = h8(&with_hole().inp(), &wanted).unwrap();
        assert!((area(&mesh, "border_1") - 20.0 * 0.5).abs() < 1e-12);
        assert!((area(&mesh, "border_2") - 6.0 * 0.5).abs() < 1e-12);
        assert!((area(&mesh, "border") - 26.0 * 0.5).abs() < 1e-12);
        assert!((area(&mesh, "top") - 22.0).abs() < 1e-12);
        let level = layers as usize + 1;
        assert_eq!(
            all_on(&mesh, "border_2", |x| (1.0..=5.0).contains(&x.x)),
            6 * level
        );
        assert_eq!(all_on(&mesh, "x_max", |x| x.x == 6.0), 5 * level);
        let told = "borders: `border_1` (20.0000 long), `border_2` (6.0000 long)";
        assert_eq!(report.notes, [told]);
        // The surface is flat: nothing is its lowest side.
        assert!(mesh.face_set("z_min").is_err());
    }
}

/// Element sets on both sides, lines along the border as faces, lines and nodes inside as nodes through the thickness.
#[test]
fn sets_of_the_file_keep_their_names() {
    let more = "*ELEMENT, TYPE=T3D2, ELSET=edge\n101, 1, 2\n102, 2, 3\n\
                *ELEMENT, TYPE=B31, ELSET=rib\n103, 15, 16\n\
                *ELSET, ELSET=left half, GENERATE\n1, 24, 6\n2, 20, 6\n*ELSET, ELSET=top\n1\n\
                *NSET, NSET=pins\n1, 7\n*SURFACE, NAME=rim\n1, E4\n*SURFACE, NAME=pad\nleft half, SPOS\n";
    let text = grid(6, 4, |u, v| [6.0 * u, 4.0 * v, 0.0]).inp() + more;
    let wanted = MeshFile {
        layers: Some(2),
        ..file(0.5)
    };
    let (mesh, report) = h8(&text, &wanted).unwrap();
    for (side, z) in [("top", 0.25), ("bottom", -0.25)] {
        assert!((area(&mesh, &format!("left half_{side}")) - 8.0).abs() < 1e-12);
        all_on(&mesh, &format!("left half_{side}"), |x| {
            x.z == z && x.x <= 2.0
        });
        assert!((area(&mesh, &format!("pad_{side}")) - 8.0).abs() < 1e-12);
    }
    assert_eq!(all_on(&mesh, "left half", |x| x.x <= 2.0), 3 * 5 * 3);
    assert!((area(&mesh, "edge") - 2.0 * 0.5).abs() < 1e-12);
    assert_eq!(all_on(&mesh, "edge", |x| x.y == 0.0), 3 * 3);
    assert!((area(&mesh, "rim") - 0.5).abs() < 1e-12);
    all_on(&mesh, "rim", |x| x.x == 0.0);
    assert!(mesh.face_set("rib").is_err());
    assert_eq!(all_on(&mesh, "rib", |x| x.y == 2.0), 2 * 3);
    assert_eq!(all_on(&mesh, "pins", |x| x.y == 0.0), 2 * 3);
    // `top` is the upper side; the file's set has another name.
    assert!((area(&mesh, "top") - 24.0).abs() < 1e-12);
    assert!((area(&mesh, "top_top") - 1.0).abs() < 1e-12);
    assert_eq!(mesh.node_set("file_top").unwrap().len(), 4 * 3);
    assert!(
        report
            .notes
            .iter()
            .any(|n| n.contains("`top` have `file_`")),
        "{:?}",
        report.notes
    );
}

/// The nodes that cutting adds belong to the sets around them.
#[test]
fn sets_grow_with_triangles() {
    let mut surface = grid(4, 4, |u, v| [4.0 * u, 4.0 * v, 0.0]);
    let last = surface.facets.pop().unwrap();
    surface.facets.push(vec![last[0], last[1], last[2]]);
    surface.facets.push(vec![last[0], last[2], last[3]]);
    let more = "*NSET, NSET=side, GENERATE\n1, 21, 5\n*NSET, NSET=patch\n1, 2, 3, 6, 7, 8\n\
                *ELSET, ELSET=corner\n16, 17\n";
    let (mesh, report) = h8(&(surface.inp() + more), &file(0.5)).unwrap();
    let told = "2 triangles were cut into three quadrilaterals each, and the 15 quadrilaterals beside them into four, so that \
                the 17 surface elements became 66";
    assert_eq!(report.notes, [told]);
    assert_eq!(mesh.elements(), 66);
    assert!((mesh.volume() - 8.0).abs() < 1e-12);
    assert_eq!(all_on(&mesh, "side", |x| x.x == 0.0), 9 * 2);
    assert_eq!(all_on(&mesh, "x_min", |x| x.x == 0.0), 9 * 2);
    assert_eq!(
        all_on(&mesh, "patch", |x| x.x <= 2.0 && x.y <= 1.0),
        5 * 3 * 2
    );
    assert!((area(&mesh, "corner_top") - 1.0).abs() < 1e-12);
    // Three corners of the square, its own middles and those of the diagonal: 4 + 5 + 2 centres.
    assert_eq!(
        all_on(&mesh, "corner", |x| x.x >= 3.0 && x.y >= 3.0),
        11 * 2
    );
    assert_eq!(report.element_tags.iter().filter(|t| **t == 16).count(), 3);
}

#[test]
fn thickness_by_set_holds_every_element_once() {
    let text = grid(4, 1, |u, v| [4.0 * u, v, 0.0]).inp()
        + "*ELSET, ELSET=left\n1, 2\n*ELSET, ELSET=right\n3, 4\n*ELSET, ELSET=inner\n2, 3\n";
    let by = |sets: &[(&str, f64)]| MeshFile {
        thickness: Some(Thickness::BySet(
            sets.iter().map(|(s, t)| (s.to_string(), *t)).collect(),
        )),
        ..MeshFile::new("a")
    };
    let (mesh, _) = h8(&text, &by(&[("left", 0.1), ("right", 0.3)])).unwrap();
    // The mean at the nodes between the two: 0.1, 0.1 .. 0.2, 0.2 .. 0.3, 0.3.
    assert!((mesh.volume() - (0.1 + 0.15 + 0.25 + 0.3)).abs() < 1e-12);
    let error = h8(&text, &by(&[("left", 0.1)])).unwrap_err();
    let MeshError::Surface { source, .. } = &error else {
        panic!("{error}");
    };
    assert!(
        matches!(
            source,
            SurfaceError::NoThickness {
                count: 2,
                element: 3,
                ..
            }
        ),
        "{error}"
    );
    assert!(
        error.to_string().contains("ALL, inner, left, right"),
        "{error}"
    );
    let error = h8(&text, &by(&[("left", 0.1), ("right", 0.3), ("inner", 0.2)])).unwrap_err();
    assert!(error.to_string().contains("`inner` and `left`"), "{error}");
    let error = h8(&text, &by(&[("lef", 0.1)])).unwrap_err();
    assert!(error.to_string().contains("did you mean `left`"), "{error}");
}
