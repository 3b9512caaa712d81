//! gmsh 4.1 files, written by gmsh 4.15 (`assets/mesh/make.py`) or by hand, good and bad.
use covact::mesh::{
    ElementKind, Mesh, MeshError, MeshReport, Position, ThicknessRule, build, read_gmsh,
};
use covact::scene::{MeshFile, MeshSource};
use covact_geometry::Vec3;
use std::path::Path;

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("assets/mesh")
            .join(name),
    )
    .unwrap()
}

fn read(name: &str) -> (Mesh, MeshReport) {
    read_gmsh(&bytes(name), Path::new(name), 1.0).unwrap()
}

fn error(text: &str) -> MeshError {
    read_gmsh(text.as_bytes(), Path::new("a.msh"), 1.0).unwrap_err()
}

/// Position and message of a syntax error.
fn syntax(text: &str) -> (usize, usize, String) {
    match error(text) {
        MeshError::Syntax {
            at: Position::Text { line, column },
            expected,
            found,
            ..
        } => (line, column, format!("{expected} | {found}")),
        other => panic!("{other}"),
    }
}

fn area(mesh: &Mesh, set: &str) -> f64 {
    let faces = mesh.face_set(set).unwrap();
    faces.iter().map(|&f| mesh.face_area_normal(f).0).sum()
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-12 * b.abs(), "{a} is not {b}");
}

const PLATES: [&str; 5] = [
    "plate.msh",
    "plate_binary.msh",
    "plate_parametric.msh",
    "plate_parametric_binary.msh",
    "plate_partitioned.msh",
];

/// The plate stands: thickness 0.1 along x, 2 x 1 in y and z, 2 x 4 x 3 elements.
#[test]
fn plates_have_their_sets_and_thickness() {
    for name in PLATES {
        let (mesh, report) = read(name);
        mesh.check().unwrap();
        assert_eq!((mesh.nodes.len(), mesh.elements()), (60, 24), "{name}");
        assert_eq!(
            (report.node_tags.len(), report.element_tags.len()),
            (60, 24)
        );
        assert_eq!(
            (report.components, report.thickness),
            (1, ThicknessRule::Surface)
        );
        assert_eq!(report.notes, Vec::<String>::new(), "{name}");
        close(mesh.volume(), 0.2);
        close(area(&mesh, "top"), 2.0);
        close(area(&mesh, "clamped edge"), 0.1);
        let names: Vec<_> = mesh
            .node_sets
            .iter()
            .map(|(n, s)| (n.as_str(), s.len()))
            .collect();
        assert_eq!(
            names,
            [
                ("clamped edge", 12),
                ("corner", 1),
                ("line", 4),
                ("sheet", 60),
                ("top", 20)
            ]
        );
        assert_eq!(mesh.face_sets.len(), 2);
        for &face in mesh.face_set("top").unwrap() {
            assert_eq!(face.face, 5);
            assert!((mesh.face_area_normal(face).1 - Vec3::x()).norm() < 1e-12);
        }
        for &face in mesh.face_set("clamped edge").unwrap() {
            assert!((mesh.face_area_normal(face).1 + Vec3::y()).norm() < 1e-12);
        }
        let corner = mesh.node_set("corner").unwrap()[0];
        assert!(mesh.nodes[corner as usize].norm() < 1e-12);
        let partner = mesh.thickness_partner(corner).unwrap();
        assert!((mesh.nodes[partner as usize] - Vec3::new(0.1, 0.0, 0.0)).norm() < 1e-12);
        close(report.size.thickness.max, 0.05);
    }
}

#[test]
fn text_and_binary_give_the_same_mesh() {
    let (text, _) = read("plate.msh");
    for name in &PLATES[1..4] {
        let (other, _) = read(name);
        assert_eq!(text.connectivity, other.connectivity, "{name}");
        assert_eq!(
            (&text.node_sets, &text.face_sets),
            (&other.node_sets, &other.face_sets)
        );
        for (a, b) in text.nodes.iter().zip(&other.nodes) {
            assert!((a - b).norm() < 1e-12);
        }
    }
}

/// The shortest way: radial, one of three different lengths; the sense is the same everywhere.
#[test]
fn ring_without_a_top_takes_its_shortest_way() {
    let (mesh, report) = read("cylinder.msh");
    mesh.check().unwrap();
    assert_eq!(report.thickness, ThicknessRule::ShortestWay);
    assert_eq!(report.notes.len(), 2, "{:?}", report.notes);
    assert!(report.notes[0].contains("physical volume 7 has no name; its set is `volume_7`"));
    assert!(report.notes[1].contains("shortest way"));
    assert_eq!(mesh.node_set("volume_7").unwrap().len(), 2 * 9 * 4);
    close(report.size.thickness.min, 1.0);
    close(report.size.thickness.max, 1.0);
    let a = std::f64::consts::FRAC_PI_2 / 8.0;
    close(
        mesh.volume(),
        4.0 * a.sin() * (10.5f64.powi(2) - 9.5f64.powi(2)) * 8.0,
    );
    let mut signs = Vec::new();
    for e in 0..mesh.elements() {
        let x = mesh.element_positions(e);
        let center = mesh.element_center(e);
        let radial = Vec3::new(center.x, 0.0, center.z).normalize();
        signs.push((x[4] - x[0]).dot(&radial));
    }
    assert!(
        signs.iter().all(|s| *s > 0.9) || signs.iter().all(|s| *s < -0.9),
        "{signs:?}"
    );
}

#[test]
fn build_reads_and_scales_files() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let file = MeshFile {
        path: "mesh/plate.msh".into(),
        scale: 10.0,
        ..MeshFile::new("")
    };
    let (mesh, report) = build(&MeshSource::File(file), ElementKind::H8, &dir).unwrap();
    close(mesh.volume(), 200.0);
    close(report.size.thickness.max, 0.5);
}

#[test]
fn foreign_meshes_are_refused_with_advice() {
    let refused = |name: &str, parts: &[&str]| {
        let error = read_gmsh(&bytes(name), Path::new(name), 1.0).unwrap_err();
        assert!(matches!(error, MeshError::Unsupported { .. }), "{error}");
        for part in parts {
            assert!(
                error.to_string().contains(part),
                "{error}: {part} is missing"
            );
        }
    };
    let text = error("$MeshFormat\n4 0 8\n").to_string();
    assert!(text.contains("a.msh:2:1: gmsh format version 4") && text.contains("-format msh41"));
    refused(
        "tetrahedra.msh",
        &["tetrahedra (gmsh type 4)", "hexahedra of 8 nodes"],
    );
    assert!(error("$NOD\n").to_string().contains("format 1"));
    let text = error("(1 \"meshio 5.3.5\")\n").to_string();
    assert!(text.contains("a.msh:1:1: a mesh of ANSYS Fluent is not supported"));
    let text = error("$MeshFormat\n4.1 0 4\n").to_string();
    assert!(text.contains("a.msh:2:7: data size `4`"), "{text}");
}

/// Every cut of every kind of file gives an error, never a panic and never a mesh.
#[test]
fn truncated_files_are_refused() {
    for name in PLATES.iter().chain(&["cylinder.msh"]) {
        let all = bytes(name);
        // The last line may lack its end.
        for cut in (0..all.len() - 1)
            .step_by(50)
            .chain(all.len() - 30..all.len() - 1)
        {
            let error = read_gmsh(&all[..cut], Path::new(name), 1.0).unwrap_err();
            assert!(
                matches!(
                    error,
                    MeshError::Syntax { .. } | MeshError::Unsupported { .. }
                ),
                "{name} cut at {cut}: {error}"
            );
        }
    }
}

/// Single wrong bytes: anything but a panic or a large allocation.
#[test]
fn damaged_files_do_not_panic() {
    let mut refused = 0;
    for name in [
        "plate_binary.msh",
        "plate_parametric.msh",
        "plate_partitioned.msh",
    ] {
        let all = bytes(name);
        for at in (0..all.len()).step_by(7) {
            let mut damaged = all.clone();
            for value in [0, b'-', b'9', 0x7f, 0xff] {
                damaged[at] = value;
                refused += usize::from(read_gmsh(&damaged, Path::new(name), 1.0).is_err());
            }
        }
    }
    assert!(refused > 1000, "{refused}");
}

#[test]
fn binary_files_of_the_other_byte_order_are_recognised() {
    let mut all = bytes("plate_binary.msh");
    let start = all.windows(4).position(|w| w == [1, 0, 0, 0]).unwrap();
    all[start..start + 4].reverse();
    // Read with the wrong order the first count is absurd, and refused as such at its offset.
    let error = read_gmsh(&all, Path::new("b.msh"), 1.0).unwrap_err();
    let MeshError::Syntax { at, expected, .. } = &error else {
        panic!("{error}");
    };
    assert!(
        matches!(at, Position::Byte(_)) && expected.contains("can hold"),
        "{error}"
    );
}

const HEAD: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";

/// A file with one element on the unit cube; `elements` and `entities` are replaced.
fn cube(entities: &str, elements: &str) -> String {
    let nodes = "$Nodes\n1 9 100 1000000000000\n3 1 0 9\n100\n200\n300\n400\n500\n600\n700\n1000000000000\n900\n\
                 0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n5 5 5\n$EndNodes\n";
    format!("{HEAD}{entities}{nodes}$Elements\n{elements}\n$EndElements\n")
}

const HEXAHEDRON: &str = "1 1 1 1\n3 1 5 1\n7 100 200 300 400 500 600 700 1000000000000";

#[test]
fn cube_without_groups_keeps_the_files_order_and_says_so() {
    let (mesh, report) =
        read_gmsh(cube("", HEXAHEDRON).as_bytes(), Path::new("c.msh"), 1.0).unwrap();
    assert_eq!(mesh.connectivity, [0, 1, 3, 2, 4, 5, 7, 6]);
    assert_eq!(
        report.node_tags,
        [100, 200, 300, 400, 500, 600, 700, 1_000_000_000_000]
    );
    assert_eq!(
        (report.thickness, report.element_tags.as_slice()),
        (ThicknessRule::FileOrder, &[7][..])
    );
    let all = report.notes.join("\n");
    for part in [
        "1 node(s) of the file belong to no hexahedron",
        "no physical groups",
        "1 of 1 elements have no clearly",
    ] {
        assert!(all.contains(part), "{all}");
    }
}

/// All six faces as `top`, and as `bottom`: t points to it, the frame stays right-handed, sets follow.
#[test]
fn any_face_can_be_the_top() {
    let faces = [
        [4, 3, 2, 1],
        [5, 6, 7, 8],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 4, 8, 7],
        [4, 1, 5, 8],
    ];
    let normals = [
        -Vec3::z(),
        Vec3::z(),
        -Vec3::y(),
        Vec3::x(),
        Vec3::y(),
        -Vec3::x(),
    ];
    let tags = [100u64, 200, 300, 400, 500, 600, 700, 1_000_000_000_000];
    for (face, normal) in faces.iter().zip(normals) {
        for name in ["top", "bottom"] {
            let quad: Vec<String> = face
                .iter()
                .map(|&n: &usize| tags[n - 1].to_string())
                .collect();
            let entities = format!(
                "$PhysicalNames\n1\n2 3 \"{name}\"\n$EndPhysicalNames\n\
                 $Entities\n0 0 1 1\n4 0 0 0 1 1 1 1 -3 0\n1 0 0 0 1 1 1 0 0\n$EndEntities\n"
            );
            let elements = format!(
                "2 2 1 9\n2 4 3 1\n9 {}\n3 1 5 1\n1 {}",
                quad.join(" "),
                &HEXAHEDRON[18..]
            );
            let (mesh, report) = read_gmsh(
                cube(&entities, &elements).as_bytes(),
                Path::new("c.msh"),
                1.0,
            )
            .unwrap();
            mesh.check().unwrap();
            assert_eq!(report.thickness, ThicknessRule::Surface);
            let set = mesh.face_set(name).unwrap();
            assert_eq!(
                (set.len(), set[0].face),
                (1, if name == "top" { 5 } else { 4 })
            );
            assert!((mesh.face_area_normal(set[0]).1 - normal).norm() < 1e-14);
            assert_eq!(mesh.node_set(name).unwrap().len(), 4);
        }
    }
}

#[test]
fn inverted_elements_carry_the_files_number() {
    let elements = "1 1 1 1\n3 1 5 1\n77 500 600 700 1000000000000 100 200 300 400";
    let error = error(&cube("", elements));
    let MeshError::Inverted {
        element,
        tag,
        jacobian,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!((element, tag), (0, Some(77)));
    close(jacobian, -0.125);
}

#[test]
fn errors_point_at_line_and_column() {
    let cases: &[(&str, (usize, usize, &str))] = &[
        ("", (1, 1, "$MeshFormat | the end of the file")),
        ("hello", (1, 1, "$MeshFormat | `hello`")),
        (
            "$MeshFormat\nfour 0 8\n",
            (2, 1, "the format's version, 4.1 or 2.2 | `four`"),
        ),
        (
            "$MeshFormat\n4.1 2 8\n",
            (2, 5, "0 (text) or 1 (binary) | `2`"),
        ),
        (
            "$MeshFormat\n4.1 0 8\n$EndNodes\n",
            (3, 1, "$EndMeshFormat | `$EndNodes`"),
        ),
    ];
    for (text, (line, column, message)) in cases {
        assert_eq!(syntax(text), (*line, *column, message.to_string()));
    }
    let (line, column, message) = syntax(&cube(
        "",
        "1 1 1 1\n3 1 5 1\n7 100 200 300 400 501 600 700 800",
    ));
    assert_eq!((line, column), (29, 19));
    assert_eq!(message, "the number of a node in $Nodes | 501 in element 7");
    let (line, column, message) = syntax(&cube("", "1 1 1 1\n3 1 5 1\n7 100 x"));
    assert_eq!(
        (line, column, message.as_str()),
        (29, 7, "a node number | `x`")
    );
    let (_, _, message) = syntax(&cube(
        "",
        "1 2 1 1\n3 1 5 1\n7 100 200 300 400 500 600 700 1000000000000",
    ));
    assert_eq!(message, "2 elements in all, as the section announces | 1");
    let (_, _, message) = syntax(&cube("", "1 1 1 1\n2 1 5 1\n7 100"));
    assert_eq!(message, "dimension 3 of hexahedra | 2");
    let (_, _, message) = syntax(&format!("{HEAD}$Elements\n0 0 0 0\n$EndElements\n"));
    assert_eq!(message, "a section $Nodes before $Elements | $Elements");
    let (_, _, message) = syntax(&format!("{HEAD}$Nodes\n0 0 0 0\n$EndNodes\n"));
    assert_eq!(message, "a section $Elements | the end of the file");
    let (line, _, message) = syntax(&format!(
        "{HEAD}$Nodes\n1 2 1 2\n3 1 0 2\n5\n5\n0 0 0\n1 0 0\n$EndNodes\n"
    ));
    assert_eq!(
        (line, message.as_str()),
        (8, "a node number used once | 5 again")
    );
    let (line, column, message) = syntax(&format!(
        "{HEAD}$Nodes\n1 1 1 1\n3 1 0 1\n5\n0 nan 0\n$EndNodes\n"
    ));
    assert_eq!((line, column, message.as_str()), (8, 3, "a node's y | NaN"));
    let (line, column, message) = syntax(&format!("{HEAD}$PhysicalNames\n1\n2 3 top\n"));
    assert_eq!(
        (line, column, message.as_str()),
        (6, 5, "a name in double quotes | `top`")
    );
    assert!(
        error(&cube("", "1 1 1 1\n3 1 93 1\n7"))
            .to_string()
            .contains("gmsh element type 93")
    );
}

#[test]
fn absurd_counts_are_refused_before_anything_is_allocated() {
    for count in ["1000000000000000", "18446744073709551615"] {
        for text in [
            format!("{HEAD}$Nodes\n1 {count} 1 2\n"),
            format!("{HEAD}$Nodes\n{count} 1 1 2\n"),
            format!("{HEAD}$Nodes\n1 1 1 2\n3 1 0 {count}\n"),
            format!("{HEAD}$Entities\n{count} 0 0 0\n"),
            cube("", &format!("1 {count} 1 1\n3 1 5 1\n")),
            cube("", &format!("1 1 1 1\n3 1 5 {count}\n")),
        ] {
            let (_, _, message) = syntax(&text);
            assert!(
                message.contains("that the rest of the file can hold"),
                "{message}"
            );
            assert!(message.ends_with(count), "{message}");
        }
    }
}

#[test]
fn what_is_left_out_is_told() {
    // A triangle in a named group, a named group without elements, and a surface beside the element.
    let entities = "$PhysicalNames\n3\n2 3 \"skin\"\n2 4 \"lost\"\n2 5 \"off\"\n$EndPhysicalNames\n\
                    $Entities\n0 0 2 1\n4 0 0 0 1 1 1 1 3 0\n5 0 0 0 1 1 1 1 5 0\n1 0 0 0 1 1 1 0 0\n$EndEntities\n\
                    $Periodic\n0\n$EndPeriodic\n";
    let elements = format!(
        "3 3 1 9\n2 4 2 1\n9 100 200 300\n2 5 3 1\n10 100 200 300 900\n3 1 5 1\n1 {}",
        &HEXAHEDRON[18..]
    );
    let (mesh, report) = read_gmsh(
        cube(entities, &elements).as_bytes(),
        Path::new("c.msh"),
        1.0,
    )
    .unwrap();
    let all = report.notes.join("\n");
    for part in [
        "sections left out: $Periodic",
        "1 triangles were left out",
        "surface `skin`: 1 triangles were left out",
        "physical surface `lost` holds no elements",
        "surface `off`: 1 of 1 quadrilaterals are not faces of hexahedra",
    ] {
        assert!(all.contains(part), "{part} is missing in\n{all}");
    }
    assert!(mesh.face_sets.is_empty());
    // No hexahedra at all.
    let error = error(&cube("", "1 1 1 1\n2 1 3 1\n7 100 200 300 400"));
    assert!(matches!(error, MeshError::NoElements { .. }));
    assert!(
        error
            .to_string()
            .contains("(its elements: 1 quadrilaterals)"),
        "{error}"
    );
}

/// A mesh as text, every element with its nodes in another of the 24 right-handed orders.
fn shuffled(mesh: &Mesh, surface: Option<(&str, &str)>) -> String {
    let name = surface.map_or("none", |s| s.1);
    let mut text = format!(
        "{HEAD}$PhysicalNames\n1\n2 3 \"{name}\"\n$EndPhysicalNames\n\
         $Entities\n0 0 1 1\n4 0 0 0 1 1 1 1 3 0\n1 0 0 0 1 1 1 0 0\n$EndEntities\n"
    );
    let n = mesh.nodes.len();
    text += &format!("$Nodes\n1 {n} 1 {n}\n3 1 0 {n}\n");
    (1..=n).for_each(|i| text += &format!("{i}\n"));
    for x in &mesh.nodes {
        text += &format!("{} {} {}\n", x.x, x.y, x.z);
    }
    let faces = surface.map_or(&[][..], |s| mesh.face_set(s.0).unwrap());
    let (e, f) = (mesh.elements(), faces.len());
    text += &format!("$EndNodes\n$Elements\n2 {0} 1 {0}\n2 4 3 {f}\n", e + f);
    for (i, &face) in faces.iter().enumerate() {
        let q = mesh.face_corners(face).map(|n| n + 1);
        text += &format!("{} {} {} {} {}\n", e + i + 1, q[0], q[1], q[3], q[2]);
    }
    text += &format!("3 1 5 {e}\n");
    for i in 0..e {
        let nodes = mesh.element(i);
        // Cyclic exchanges of the axes and half turns, from the element's number.
        let turn = i * 7 % 12;
        let order = [0usize, 1, 3, 2, 4, 5, 7, 6].map(|a| {
            let bits = [a & 1, a >> 1 & 1, a >> 2 & 1];
            let flip = [[0, 0, 0], [1, 1, 0], [0, 1, 1], [1, 0, 1]][turn / 3];
            (0..3)
                .map(|d| (bits[(d + turn) % 3] ^ flip[d]) << d)
                .sum::<usize>()
        });
        let tags: Vec<String> = order.iter().map(|&a| (nodes[a] + 1).to_string()).collect();
        text += &format!("{} {}\n", i + 1, tags.join(" "));
    }
    text + "$EndElements\n"
}

/// Thickness vectors of the elements.
fn thickness(mesh: &Mesh) -> Vec<Vec3> {
    (0..mesh.elements())
        .map(|e| {
            let x = mesh.element_positions(e);
            x[4] - x[0]
        })
        .collect()
}

fn plate_of(size: [f64; 2], thickness: f64) -> Mesh {
    let plate = covact::scene::Plate {
        size,
        thickness,
        elements: [4, 3],
        layers: 3,
        origin: [0.0; 3],
        spacing: Default::default(),
    };
    covact::mesh::plate(&plate, ElementKind::H8).unwrap()
}

/// The thickness found must not depend on how each element is numbered.
#[test]
fn shuffled_elements_get_one_thickness() {
    let read = |text: String| {
        let (mesh, report) = read_gmsh(text.as_bytes(), Path::new("s.msh"), 1.0).unwrap();
        mesh.check().unwrap();
        (mesh, report)
    };
    // Thin layers: by the shortest way, the sense the same everywhere.
    let (mesh, report) = read(shuffled(&plate_of([4.0, 3.0], 0.3), None));
    let t = thickness(&mesh);
    assert_eq!(report.thickness, ThicknessRule::ShortestWay);
    assert!(
        t.iter()
            .all(|v| (v - t[0]).norm() < 1e-14 && v.z.abs() > 0.09),
        "{t:?}"
    );
    // Elements that are shorter in the plane than the one layer is thick.
    let strip = covact::scene::Plate {
        size: [4.0, 3.0],
        thickness: 0.3,
        elements: [40, 30],
        layers: 1,
        origin: [0.0; 3],
        spacing: Default::default(),
    };
    let strip = covact::mesh::plate(&strip, ElementKind::H8).unwrap();
    let (mesh, report) = read(shuffled(&strip, None));
    assert_eq!(report.thickness, ThicknessRule::ShortestWay);
    let t = thickness(&mesh);
    assert!(
        t.iter()
            .all(|v| (v - t[0]).norm() < 1e-13 && v.z.abs() > 0.29)
    );
    // Cubes: by the surface, through three layers.
    for (set, name) in [("top", "top"), ("bottom", "bottom")] {
        let (mesh, report) = read(shuffled(&plate_of([4.0, 3.0], 3.0), Some((set, name))));
        assert_eq!(report.thickness, ThicknessRule::Surface);
        assert!(
            thickness(&mesh)
                .iter()
                .all(|v| (v - Vec3::z()).norm() < 1e-14)
        );
        assert_eq!(mesh.opposite_nodes().iter().flatten().count(), 40);
        assert!(report.notes.is_empty(), "{:?}", report.notes);
    }
    // A surface on the side turns the columns along y, against the shortest way.
    let (mesh, _) = read(shuffled(&plate_of([4.0, 3.0], 0.3), Some(("y_max", "top"))));
    assert!(
        thickness(&mesh)
            .iter()
            .all(|v| (v - Vec3::y()).norm() < 1e-14)
    );
    // The top of some elements only: the others follow their neighbours where these have a shortest way.
    let mut part = plate_of([4.0, 3.0], 0.3);
    part.face_sets.get_mut("bottom").unwrap().truncate(2);
    let (mesh, report) = read(shuffled(&part, Some(("bottom", "top"))));
    assert_eq!(report.thickness, ThicknessRule::ShortestWay);
    assert!(
        thickness(&mesh)
            .iter()
            .all(|v| (v + Vec3::z() * 0.1).norm() < 1e-14)
    );
    // Cubes without a surface: nothing to go by, and that is told.
    let (_, report) = read(shuffled(&plate_of([4.0, 3.0], 3.0), None));
    assert_eq!(report.thickness, ThicknessRule::FileOrder);
    assert!(
        report.notes.iter().any(|n| n.contains("36 of 36 elements")),
        "{:?}",
        report.notes
    );
}
