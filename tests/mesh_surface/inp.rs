//! Input files of Abaqus and CalculiX: parts and instances, sets before their definition, quadratic elements.
use crate::support::{close, file, grid, h8, load};
use covact::mesh::{ElementKind, Mesh, MeshError, MeshReport};
use covact::scene::MeshFile;
use covact_geometry::Vec3;

const SQUARE: &str = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n";

fn assembly(instances: &str) -> String {
    format!(
        "*HEADING\n*PART, NAME=Sheet\n{SQUARE}*ELEMENT, TYPE=S4R\n1, 1, 2, 3, 4\n*NSET, NSET=low\n1, 2\n\
         *ELSET, ELSET=all\n1\n*END PART\n*ASSEMBLY, NAME=A\n{instances}*END ASSEMBLY\n"
    )
}

const TWO: &str = "*INSTANCE, NAME=one, PART=sheet\n*END INSTANCE\n\
                   *INSTANCE, NAME=two, PART=Sheet\n5., 0., 1.\n5., 0., 1., 5., 1., 1., 90.\n*END INSTANCE\n\
                   *NSET, NSET=picked, INSTANCE=two\n3, 4\n*NSET, NSET=both\none.low, two.low\n\
                   *ELSET, ELSET=pair\none.all, two.all\n";

/// Each instance is put in its place: moved, then turned about its axis.
#[test]
fn instances_are_placed() {
    let (mesh, report) = h8(&assembly(TWO), &file(0.1)).unwrap();
    assert_eq!((mesh.elements(), report.components), (2, 2));
    close(mesh.volume(), 0.2, 1e-13);
    let at = |set: &str| {
        let nodes = mesh.node_set(set).unwrap();
        nodes.iter().map(|&n| mesh.nodes[n as usize]).sum::<Vec3>() / nodes.len() as f64
    };
    // x goes to -z about an axis along y.
    assert!(
        (at("two") - Vec3::new(5.0, 0.5, 0.5)).norm() < 1e-13,
        "{}",
        at("two")
    );
    assert!((at("picked") - Vec3::new(5.0, 1.0, 0.5)).norm() < 1e-13);
    assert!((at("one.low") - Vec3::new(0.5, 0.0, 0.0)).norm() < 1e-13);
    assert!((at("two.low") - Vec3::new(5.0, 0.0, 0.5)).norm() < 1e-13);
    assert_eq!(mesh.node_set("both").unwrap().len(), 8);
    assert_eq!(mesh.face_set("pair_top").unwrap().len(), 2);
    // One of them alone.
    let wanted = MeshFile {
        only: Some("two".into()),
        ..file(0.1)
    };
    let (mesh, report) = h8(&assembly(TWO), &wanted).unwrap();
    assert_eq!((mesh.elements(), report.components), (1, 1));
    assert!(mesh.node_set("one").is_err());
    let wanted = MeshFile {
        only: Some("tvo".into()),
        ..file(0.1)
    };
    let text = h8(&assembly(TWO), &wanted).unwrap_err().to_string();
    assert!(
        text.contains("no element set `tvo`") && text.contains("did you mean `two`"),
        "{text}"
    );
}

#[test]
fn one_instance_keeps_the_names_of_its_part() {
    let (mesh, _) = h8(
        &assembly("*INSTANCE, NAME=I, PART=Sheet\n*END INSTANCE\n"),
        &file(0.1),
    )
    .unwrap();
    assert_eq!(mesh.node_set("low").unwrap().len(), 4);
    assert!(mesh.face_set("all_top").is_ok());
    // A part without an assembly stands where it is.
    let text = assembly("");
    let (mesh, _) = h8(&text, &file(0.1)).unwrap();
    assert_eq!(mesh.node_set("low").unwrap().len(), 4);
    let text = assembly("*INSTANCE, NAME=I, PART=Shet\n");
    let error = h8(&text, &file(0.1)).unwrap_err().to_string();
    assert!(
        error.contains("a part that stands above (Sheet), found Shet"),
        "{error}"
    );
    // The mesh may belong to the instance.
    let text = format!(
        "*PART, NAME=P\n*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n{SQUARE}*ELEMENT, TYPE=CPS4, ELSET=E\n\
         1, 1, 2, 3, 4\n*END INSTANCE\n*END ASSEMBLY\n"
    );
    assert_eq!(h8(&text, &file(0.1)).unwrap().0.elements(), 1);
}

/// Elements of plane stress are faces of a surface, triangles too.
#[test]
fn plane_stress_elements_are_surfaces() {
    let quad = format!("{SQUARE}*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n");
    let triangles = format!("{SQUARE}*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n2, 1, 3, 4\n");
    for (text, elements) in [(quad, 1), (triangles, 6)] {
        let (mesh, _) = h8(&text, &file(0.1)).unwrap();
        assert_eq!(mesh.elements(), elements);
        close(mesh.volume(), 0.1, 1e-13);
    }
}

/// Sets in any order; a circle is refused where it closes.
#[test]
fn sets_before_their_definition() {
    let sets = "*ELSET, ELSET=A\nB, C\n*NSET, NSET=N\nM\n*ELSET, ELSET=B\nC\n*ELSET, ELSET=C\n1\n*NSET, NSET=M\n2\n3,\n";
    let text = format!("{SQUARE}*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n{sets}");
    let (mesh, _) = h8(&text, &file(0.1)).unwrap();
    assert_eq!(mesh.face_set("A_top").unwrap().len(), 1);
    assert_eq!(mesh.node_set("N").unwrap().len(), 4);
    let error = h8(&(text.clone() + "*ELSET, ELSET=C\nA\n"), &file(0.1))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("sets that do not hold themselves"),
        "{error}"
    );
    let error = h8(&(text + "*ELSET, ELSET=D\nBB\n"), &file(0.1))
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("a.inp:20:1: ") && error.contains("did you mean `B`?"),
        "{error}"
    );
    // A long chain takes no deep recursion.
    let mut text = format!("{SQUARE}*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n");
    for k in 0..20_000 {
        text += &format!("*ELSET, ELSET=S{k}\nS{}\n", k + 1);
    }
    text += "*ELSET, ELSET=S20000\n1\n";
    let found = h8(&text, &file(0.1));
    assert!(found.is_ok() || matches!(found, Err(MeshError::LongSets { .. })));
}

/// The numbers that meshio writes of gmsh's geometry are no elements.
#[test]
fn sets_that_meshio_writes() {
    let text = format!(
        "{SQUARE}*ELEMENT, TYPE=CAX4P\n1,1,2,3,4\n*ELSET, ELSET=gmsh:bounding_entities\n-4,12\n*ELSET, ELSET=skin\n1\n"
    );
    let (mesh, report) = h8(&text, &file(0.1)).unwrap();
    assert!(mesh.face_set("skin_top").is_ok());
    assert!(
        report.notes[0].contains("`gmsh:bounding_entities` holds no elements"),
        "{:?}",
        report.notes
    );
}

/// A curved quadrilateral of eight nodes: as corners for linear elements, and said so; with all its nodes for quadratic
/// ones.
#[test]
fn quadratic_surface_elements() {
    let at = |u: f64, v: f64| {
        let phi = 0.8 * u;
        format!("{}, {}, {}", 10.0 * phi.sin(), 8.0 * v, 10.0 * phi.cos())
    };
    let places = [
        (0., 0.),
        (1., 0.),
        (1., 1.),
        (0., 1.),
        (0.5, 0.),
        (1., 0.5),
        (0.5, 1.),
        (0., 0.5),
    ];
    let mut text = "*NODE\n".to_string();
    for (k, (u, v)) in places.into_iter().enumerate() {
        text += &format!("{}, {}\n", k + 1, at(u, v));
    }
    text += "*ELEMENT, TYPE=S8R, ELSET=E\n7, 1, 2, 3, 4, 5, 6, 7, 8\n";
    let (mesh, report) = h8(&text, &file(0.5)).unwrap();
    assert_eq!((mesh.elements(), mesh.nodes.len()), (1, 8));
    assert!(
        report.notes[0].starts_with("1 quadratic elements: only their corners"),
        "{:?}",
        report.notes
    );
    let (mesh, report) = load(text.as_bytes(), "inp", &file(0.5), ElementKind::Q18).unwrap();
    assert_eq!((mesh.elements(), mesh.nodes.len()), (1, 18));
    assert!(report.notes.is_empty(), "{:?}", report.notes);
    // The middle of the shell lies on the cylinder up to the parabola's deviation, as does its thickness.
    for &n in mesh.node_set("top").unwrap() {
        let x = mesh.nodes[n as usize];
        close(x.x.hypot(x.z), 10.25, 5e-3);
    }
}

/// Two blocks with nodes of their own at the same places: contact partners, kept apart and told of.
#[test]
fn coincident_nodes_of_partners_stay_apart() {
    let mut text = "*NODE\n".to_string();
    for part in 0..2 {
        for n in 0..8 {
            let (x, y, z) = (n & 1, n >> 1 & 1, part + (n >> 2));
            text += &format!("{}, {x}, {y}, {z}\n", 8 * part + n + 1);
        }
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=low\n1, 1, 2, 4, 3, 5, 6, 8, 7\n\
             *ELEMENT, TYPE=C3D8, ELSET=high\n2, 9, 10, 12, 11, 13, 14, 16, 15\n";
    let solid = MeshFile::new("a");
    let (mesh, report) = h8(&text, &solid).unwrap();
    assert_eq!((mesh.nodes.len(), report.components), (16, 2));
    let told = "4 pair(s) of nodes of unconnected parts lie at the same place and are kept apart";
    assert!(
        report.notes.iter().any(|n| n.contains(told)),
        "{:?}",
        report.notes
    );
    let only = MeshFile {
        only: Some("HIGH".into()),
        ..solid
    };
    assert!(h8(&text, &only).is_err());
    let only = MeshFile {
        only: Some("high".into()),
        ..only
    };
    let (mesh, report) = h8(&text, &only).unwrap();
    assert_eq!((mesh.elements(), report.components), (1, 1));
    assert_eq!(report.element_tags, [2]);
}

/// A brick of 20 nodes whose upper face is at `z`, its middle nodes at `middle`; curved in its plane.
fn brick(middle: f64) -> String {
    let places = [
        [0, 0, 0],
        [2, 0, 0],
        [2, 2, 0],
        [0, 2, 0],
        [0, 0, 2],
        [2, 0, 2],
        [2, 2, 2],
        [0, 2, 2],
        [1, 0, 0],
        [2, 1, 0],
        [1, 2, 0],
        [0, 1, 0],
        [1, 0, 2],
        [2, 1, 2],
        [1, 2, 2],
        [0, 1, 2],
        [0, 0, 1],
        [2, 0, 1],
        [2, 2, 1],
        [0, 2, 1],
    ];
    let mut text = "*NODE\n".to_string();
    for (k, [i, j, l]) in places.into_iter().enumerate() {
        let r = 10.0
            + match l {
                0 => 0.0,
                1 => middle,
                _ => 0.4,
            };
        let phi = 0.3 * i as f64;
        text += &format!(
            "{}, {}, {}, {}\n",
            k + 1,
            r * phi.sin(),
            2.0 * j as f64,
            r * phi.cos()
        );
    }
    text + "*ELEMENT, TYPE=C3D20R, ELSET=E\n5"
        + &(1..=20)
            .map(|n| format!(",{}{n}", if n == 12 { "\n" } else { "" }))
            .collect::<String>()
        + "\n*SURFACE, NAME=top\nE, S2\n"
}

fn solid(text: &str, kind: ElementKind) -> Result<(Mesh, MeshReport), MeshError> {
    load(text.as_bytes(), "inp", &MeshFile::new("a"), kind)
}

/// 20 nodes give 18, the middles of bottom and top after the serendipity functions; crooked ones are refused by name.
#[test]
fn bricks_of_20_nodes() {
    let (mesh, report) = solid(&brick(0.2), ElementKind::Q18).unwrap();
    assert_eq!((mesh.kind, mesh.nodes.len()), (ElementKind::Q18, 18));
    for &n in mesh.node_set("top").unwrap() {
        let x = mesh.nodes[n as usize];
        close(x.x.hypot(x.z), 10.4, 1e-13);
    }
    assert!(report.notes[0].contains("20-node"), "{:?}", report.notes);
    let error = solid(&brick(0.22), ElementKind::Q18).unwrap_err();
    assert!(
        matches!(error, MeshError::Crooked { tag: 5, .. }),
        "{error}"
    );
    assert!(
        error.to_string().contains("5.0 % of the thickness"),
        "{error}"
    );
    let error = solid(&brick(0.2), ElementKind::H8).unwrap_err().to_string();
    assert!(error.contains("\"q18\""), "{error}");
}

/// What CalculiX reads is read, and what has no effect on the mesh is told.
#[test]
fn lines_that_only_calculix_takes() {
    let text = grid(2, 2, |u, v| [u, v, 0.0]).inp()
        + "*ELEMENT, TYPE=CAX4, ELSET=AXIS\n10, 1, 2, 5, 4, 6, 7\n*NSET, NSET=MANY, GENERATE\n2, 5000\n\
           *SUBMODEL, TYPE=NODE, INPUT=other.frd\nMANY\n";
    // The four elements of the grid stay.
    let text = text.replacen("1, 1, 2, 5, 4\n", "", 1);
    let (mesh, report) = h8(&text, &file(0.1)).unwrap();
    assert_eq!(
        (mesh.elements(), report.element_tags),
        (4, vec![2, 3, 4, 10])
    );
    assert_eq!(mesh.node_set("MANY").unwrap().len(), 2 * 8);
    for told in [
        "1 element(s) have more numbers in their lines than their type has nodes",
        "set `MANY`: 4991 number(s) within its ranges are no nodes",
        "axisymmetric elements (CAX4) are taken for a plane surface",
        "*SUBMODEL",
    ] {
        let found = report.notes.iter().any(|n| n.contains(told));
        assert!(found, "{told}: {:?}", report.notes);
    }
    // Ranges that name no node at all are a mistake.
    let error = h8(&text.replace("2, 5000", "200, 5000"), &file(0.1)).unwrap_err();
    assert!(error.to_string().contains("node 200 to 5000"), "{error}");
}
