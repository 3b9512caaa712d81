//! Abaqus and CalculiX input files: one written by gmsh 4.15 (`assets/mesh/make.py`), the others by hand.
use covact::mesh::{
    ElementKind, Mesh, MeshError, MeshReport, Position, ThicknessRule, build, read_gmsh, read_inp,
};
use covact::scene::{MeshFile, MeshSource};
use covact_geometry::Vec3;
use std::path::Path;

fn read(text: &str) -> Result<(Mesh, MeshReport), MeshError> {
    read_inp(text.as_bytes(), Path::new("a.inp"), 1.0)
}

/// Two cubes along x, the first of 8 nodes in the usual order, in the words of `element` and what follows it.
fn two(element: &str, more: &str) -> String {
    format!(
        "*HEADING\ntwo cubes\n** a comment\n*Node, nset=ALL\n1, 0., 0., 0.\n2, 1., 0, 0\n3, 1.0d0, 1., 0.\n4,,1.,\n\
         5, 0., 0., 1.\n6, 1., 0., 1.\n7, 1., 1., 1.\n8, 0., 1., 1.\n12, 2., 0., 0.\n13, 2., 1., 0.\n\
         16, 2., 0., 1.\n17, 2., 1., 1.\n{element}\n10, 1, 2, 3, 4,\n5, 6, 7, 8\n20, 2, 12, 13, 3, 6, 16, 17, 7\n{more}"
    )
}

const C3D8: &str = "*ELEMENT, TYPE=C3D8,\nELSET=Both";

#[test]
fn gmsh_writes_the_same_plate_as_inp_and_msh() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/mesh");
    let source = |name: &str| {
        MeshSource::File(MeshFile {
            path: name.into(),
            scale: 2.0,
            ..MeshFile::new("")
        })
    };
    let (mesh, report) = build(&source("plate.inp"), ElementKind::H8, &dir).unwrap();
    let (other, _) = build(&source("plate.msh"), ElementKind::H8, &dir).unwrap();
    assert_eq!(report.thickness, ThicknessRule::Surface);
    assert_eq!(mesh.connectivity, other.connectivity);
    assert_eq!(
        mesh.node_set("top").unwrap(),
        other.node_set("top").unwrap()
    );
    assert_eq!(
        mesh.face_set("top").unwrap(),
        other.face_set("top").unwrap()
    );
    assert_eq!(
        mesh.face_set("clamped_edge").unwrap(),
        other.face_set("clamped edge").unwrap()
    );
    let all = report.notes.join("\n");
    assert!(
        !all.contains("left out: T3D2") && mesh.node_set("line").unwrap().len() == 4,
        "{all}"
    );
}

#[test]
fn sets_and_surfaces_are_read() {
    let more = "*NSET, NSET=ends\n1, 4\n5, 8,\n*NSET, NSET=more\nENDS, 12\n*NSET, NSET=row, GENERATE\n1, 5, 2\n\
                *ELSET, ELSET=right\n20\n*ELSET, ELSET=pair, GENERATE\n10, 20, 10\n\
                *SURFACE, NAME=lid, TYPE=ELEMENT\nboth, S2\n*SURFACE, NAME=sides\n10, S6\nRIGHT, S4\n10, S3\n20, S5\n\
                *SURFACE, NAME=floor\nPair, s1\n*MATERIAL, NAME=steel\n*ELASTIC\n210000., .3\n";
    let (mesh, report) = read(&two(C3D8, more)).unwrap();
    mesh.check().unwrap();
    assert_eq!((mesh.nodes.len(), mesh.elements()), (12, 2));
    assert!((mesh.volume() - 2.0).abs() < 1e-14);
    assert_eq!(report.element_tags, [10, 20]);
    assert_eq!(mesh.node_set("ends").unwrap(), [0, 3, 4, 7]);
    assert_eq!(mesh.node_set("more").unwrap(), [0, 3, 4, 7, 8]);
    assert_eq!(mesh.node_set("row").unwrap(), [0, 2, 4]);
    assert_eq!(mesh.node_set("right").unwrap().len(), 8);
    assert_eq!(mesh.node_set("ALL").unwrap().len(), 12);
    assert_eq!(mesh.node_set("lid").unwrap().len(), 6);
    // Every face S1 to S6 by its normal.
    let normals = |set: &str| -> Vec<Vec3> {
        let faces = mesh.face_set(set).unwrap();
        faces.iter().map(|&f| mesh.face_area_normal(f).1).collect()
    };
    assert_eq!(normals("lid"), [Vec3::z(); 2]);
    assert_eq!(normals("floor"), [-Vec3::z(); 2]);
    let sides = normals("sides");
    for n in [-Vec3::x(), -Vec3::y(), Vec3::x(), Vec3::y()] {
        assert!(sides.contains(&n), "{sides:?}");
    }
    let all = report.notes.join("\n");
    assert!(
        all.contains("keywords left out: *ELASTIC, *MATERIAL"),
        "{all}"
    );
    assert!(
        all.contains("2 of 2 elements have no clearly shortest way"),
        "{all}"
    );
}

/// SC8R stacks along its own direction 3, whatever the shape.
#[test]
fn continuum_shells_keep_their_direction() {
    let (mesh, report) = read(&two(
        "*ELEMENT, TYPE=SC8R",
        "*SURFACE, NAME=s\n10, SPOS\n20, SNEG\n",
    ))
    .unwrap();
    assert_eq!(report.thickness, ThicknessRule::FileOrder);
    assert!(report.notes.is_empty(), "{:?}", report.notes);
    assert_eq!(mesh.connectivity[..8], [0, 1, 3, 2, 4, 5, 7, 6]);
    let faces: Vec<u8> = mesh.face_set("s").unwrap().iter().map(|f| f.face).collect();
    assert_eq!(faces, [5, 4]);
}

#[test]
fn errors_point_at_line_and_column() {
    let at = |text: &str| match read(text).unwrap_err() {
        MeshError::Syntax {
            at: Position::Text { line, column },
            expected,
            found,
            ..
        } => (line, column, format!("{expected} | {found}")),
        other => panic!("{other}"),
    };
    let more = |more: &str| at(&two(C3D8, more));
    let after = 23;
    for (text, line, column, message) in [
        (
            "*NSET, NSET=a\n1, 99\n",
            after,
            4,
            "the number or set of nodes of this file | node 99",
        ),
        (
            "*NSET, NSET=a\n1, lost\n",
            after,
            4,
            "the number or set of nodes of this file | lost",
        ),
        (
            "*ELSET, ELSET=a\n11\n",
            after,
            1,
            "the number or set of elements of this file | element 11",
        ),
        (
            "*SURFACE, NAME=a\nboth, S7\n",
            after,
            7,
            "a face from S1 to S6 | S7",
        ),
        (
            "*SURFACE, NAME=a\nboth\n",
            after,
            1,
            "a face from S1 to S6 | both",
        ),
        ("*NSET\n1\n", after - 1, 1, "*NSET with NSET=name | *NSET"),
        (
            "*ELEMENT, TYPE=C3D8\n30, 1, 2, 3, 4\n",
            after,
            14,
            "8 nodes of element 30 | 4",
        ),
        (
            "*ELEMENT, TYPE=C3D8\n10, 1\n",
            after,
            1,
            "an element number used once | 10",
        ),
        (
            "*ELEMENT, TYPE=C3D8\n30, 1, 2, 3, 44\n",
            after,
            14,
            "the number of a node that stands above | node 44",
        ),
        (
            "*NODE\n1, 0, 0, 0\n",
            after,
            1,
            "a node number used once | 1",
        ),
        ("*NODE\n31, 0, x, 0\n", after, 8, "a coordinate | x"),
        ("*NODE\n31, 0, inf, 0\n", after, 8, "a coordinate | inf"),
        (
            "*NSET, NSET=a, GENERATE\n4, 1, 1\n",
            after,
            1,
            "first <= last and a step of at least 1 | 4, 1, 1",
        ),
        (
            "*NSET, NSET=a, GENERATE\n1000, 18446744073709551615, 1\n",
            after,
            1,
            "the number or set of nodes of this file | node 1000 to 18446744073709551615",
        ),
    ] {
        assert_eq!(more(text), (line, column, message.to_string()), "{text}");
    }
}

#[test]
fn what_is_not_supported_is_refused_with_advice() {
    for (text, part) in [
        (
            "*ELEMENT, TYPE=C3D10\n",
            "a.inp:1:11: element type C3D10 is not supported: solid elements are C3D8",
        ),
        ("*ELEMENT, TYPE=C3D6\n", "C3D6"),
        (
            "*INCLUDE, INPUT=mesh.inp\n",
            "a.inp:1:1: *INCLUDE is not supported: put",
        ),
        ("*NODE, SYSTEM=C\n", "coordinate system C"),
        ("*NGEN\n", "*NGEN"),
    ] {
        let error = read(text).unwrap_err();
        assert!(matches!(error, MeshError::Unsupported { .. }), "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
    let error = read("*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=T3D2\n1, 1, 1\n").unwrap_err();
    assert!(matches!(error, MeshError::NoElements { .. }), "{error}");
    // Not this format at all.
    let msh =
        std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/mesh/plate_binary.msh"))
            .unwrap();
    assert!(read_inp(&msh, Path::new("a.inp"), 1.0).is_err());
    assert!(read_gmsh(two(C3D8, "").as_bytes(), Path::new("a.msh"), 1.0).is_err());
}

#[test]
fn inverted_elements_carry_the_files_number() {
    let more = "*ELEMENT, TYPE=C3D8\n";
    let mirrored = two(C3D8, more).replace(
        "20, 2, 12, 13, 3, 6, 16, 17, 7",
        "20, 6, 16, 17, 7, 2, 12, 13, 3",
    );
    let error = read(&mirrored).unwrap_err();
    assert!(
        matches!(
            error,
            MeshError::Inverted {
                element: 1,
                tag: Some(20),
                ..
            }
        ),
        "{error}"
    );
}

/// Nodes at the same place too: a slit between the two cubes.
#[test]
fn coincident_nodes_carry_the_files_numbers() {
    let slit = two(C3D8, "").replace("20, 2, 12", "20, 32, 12");
    let slit = slit.replace("17, 2., 1., 1.\n", "17, 2., 1., 1.\n32, 1., 0, 0\n");
    let error = read(&slit).unwrap_err().to_string();
    assert!(
        error.contains("(numbers 2 and 32 in the file) lie at the same place (1.000000, 0.000000, 0.000000); 1 such"),
        "{error}"
    );
}

#[test]
fn truncated_and_damaged_files_do_not_panic() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/mesh/plate.inp");
    let all = std::fs::read(&path).unwrap();
    let (mut refused, mut read) = (0, 0);
    for cut in (0..all.len()).step_by(50) {
        match read_inp(&all[..cut], &path, 1.0) {
            Ok(_) => read += 1,
            Err(_) => refused += 1,
        }
    }
    // A text file that ends after its elements, or between two of them, is still a mesh.
    assert!(refused > 30 && read > 0, "{refused} {read}");
    for at in (0..all.len()).step_by(3) {
        let mut damaged = all.clone();
        for value in [0, b'*', b',', b'9', 0xff] {
            damaged[at] = value;
            refused += usize::from(read_inp(&damaged, &path, 1.0).is_err());
        }
    }
    assert!(refused > 500, "{refused}");
}
