//! Meshes of 18-node elements: generators, mesh files, checks.
use covact::mesh::{
    ElementKind, Face, Mesh, MeshError, ThicknessColumns, ThicknessRule, block, build,
    cylinder_panel, plate, read_gmsh, read_inp, sphere_panel,
};
use covact::scene::{Block, CylinderPanel, MeshFile, MeshSource, Plate, Spacing, SpherePanel};
use covact_geometry::Vec3;
use std::path::Path;

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} is not {b}");
}

fn a_cylinder(n: u32) -> CylinderPanel {
    CylinderPanel {
        radius: 10.0,
        thickness: 1.0,
        angles: [-20.0, 50.0],
        y: [-3.0, 4.0],
        elements: [n, 2],
        layers: 2,
        origin: [1.0, 0.0, 2.0],
    }
}

fn a_sphere(n: u32) -> SpherePanel {
    SpherePanel {
        radius: 10.0,
        thickness: 1.0,
        longitude: [0.0, 90.0],
        latitude: [-30.0, 45.0],
        elements: [n, n],
        layers: 1,
        origin: [0.0; 3],
    }
}

/// Volume enclosed by the outer faces, `1/3 int x . n dA` with five Gauss points a direction: exact for biquadratic
/// faces, and another way to it than the elements' Jacobians.
fn enclosed(mesh: &Mesh) -> f64 {
    let rule = covact::fem::gauss(5).unwrap();
    let mut volume = 0.0;
    for face in mesh.outer_faces() {
        let quad = mesh.quad(face).unwrap();
        for (v, wv) in rule.iter() {
            for (u, wu) in rule.iter() {
                volume += wu * wv * quad.point(u, v).dot(&quad.area_vector(u, v)) / 3.0;
            }
        }
    }
    volume
}

/// A plate has the corner nodes and sets of the linear one, nodes midway between them, and columns from bottom to top
/// through all layers at every node.
#[test]
fn plate_with_spacing() {
    let p = Plate {
        size: [4.0, 3.0],
        thickness: 0.2,
        elements: [4, 3],
        layers: 2,
        origin: [1.0, 2.0, 3.0],
        spacing: [Spacing::Geometric { ratio: 1.5 }, Spacing::Uniform],
    };
    let (linear, mesh) = (
        plate(&p, ElementKind::H8).unwrap(),
        plate(&p, ElementKind::Q18).unwrap(),
    );
    mesh.check().unwrap();
    assert_eq!((mesh.elements(), mesh.nodes.len()), (24, 9 * 7 * 3));
    close(mesh.volume(), 2.4, 1e-14);
    close(enclosed(&mesh), 2.4, 1e-13);
    let at = |mesh: &Mesh, i: usize| mesh.nodes[i].x;
    for i in 0..4 {
        close(at(&mesh, 2 * i), at(&linear, i), 1e-15);
        let middle = 0.5 * (at(&linear, i) + at(&linear, i + 1));
        close(at(&mesh, 2 * i + 1), middle, 1e-15);
    }
    let names = |mesh: &Mesh| mesh.face_sets.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&mesh), names(&linear));
    assert_eq!(mesh.face_sets, linear.face_sets);
    assert_eq!(mesh.node_set("top").unwrap().len(), 63);
    assert_eq!(mesh.node_set("x_min").unwrap().len(), 21);
    let columns = ThicknessColumns::new(&mesh);
    for &top in mesh.node_set("top").unwrap() {
        let [bottom, end] = columns.ends(top).unwrap();
        assert_eq!(end, top);
        let along = mesh.nodes[top as usize] - mesh.nodes[bottom as usize];
        assert!((along - Vec3::new(0.0, 0.0, 0.2)).norm() < 1e-14);
    }
    let b = Block {
        min: [0.0; 3],
        max: [1.0, 2.0, 3.0],
        elements: [2, 3, 4],
        spacing: Default::default(),
    };
    let mesh = block(&b, ElementKind::Q18).unwrap();
    mesh.check().unwrap();
    assert_eq!(mesh.nodes.len(), 5 * 7 * 5);
    close(mesh.volume(), 6.0, 1e-14);
}

/// All nodes of a surface lie on the exact cylinder or sphere. A biquadratic arc of angle 2h over three nodes encloses
/// its area with an error of order h^4: the volume converges at rate 4, where facets give 2.
#[test]
fn curved_panels_are_on_their_surfaces() {
    let mut errors = Vec::new();
    for n in [2, 4, 8] {
        let mesh = cylinder_panel(&a_cylinder(n), ElementKind::Q18).unwrap();
        mesh.check().unwrap();
        for (set, radius) in [("outer", 10.5), ("inner", 9.5)] {
            for &node in mesh.node_set(set).unwrap() {
                let x = mesh.nodes[node as usize] - Vec3::new(1.0, 0.0, 2.0);
                close(x.x.hypot(x.z), radius, 1e-14);
            }
        }
        let exact = 70f64.to_radians() / 2.0 * (10.5f64.powi(2) - 9.5f64.powi(2)) * 7.0;
        close(enclosed(&mesh), mesh.volume(), 1e-13);
        let cylinder = (mesh.volume() / exact - 1.0).abs();
        let mesh = sphere_panel(&a_sphere(n), ElementKind::Q18).unwrap();
        mesh.check().unwrap();
        for &node in mesh.node_set("outer").unwrap() {
            close(mesh.nodes[node as usize].norm(), 10.5, 1e-14);
        }
        let zone = (45f64.to_radians().sin() + 0.5) * 90f64.to_radians();
        let exact = zone * (10.5f64.powi(3) - 9.5f64.powi(3)) / 3.0;
        close(enclosed(&mesh), mesh.volume(), 1e-13);
        errors.push([cylinder, (mesh.volume() / exact - 1.0).abs()]);
    }
    for pair in errors.windows(2) {
        for (coarse, fine) in pair[0].iter().zip(&pair[1]) {
            let rate = (coarse / fine).log2();
            assert!((rate - 4.0).abs() < 0.2, "rate {rate} of {errors:?}");
        }
    }
    // A full turn shares the nodes of its seam.
    let tube = CylinderPanel {
        angles: [0.0, 360.0],
        ..a_cylinder(6)
    };
    let tube = cylinder_panel(&tube, ElementKind::Q18).unwrap();
    tube.check().unwrap();
    assert_eq!(tube.nodes.len(), 12 * 5 * 3);
    assert!(!tube.face_sets.contains_key("phi_min"));
    close(enclosed(&tube), tube.volume(), 1e-13);
}

fn asset(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/mesh");
    std::fs::read(folder.join(name)).unwrap()
}

/// gmsh's own second-order plate (2 x 4 x 3 elements, .1 thick along x, 2 x 1 in y and z): same elements, sets and
/// thickness as its linear one, the nodes midway through the layers left out and said so.
#[test]
fn gmsh_writes_quadratic_plates() {
    let read = |name: &str| read_gmsh(&asset(name), Path::new(name), 1.0).unwrap();
    let (linear, _) = read("plate.msh");
    let (mesh, report) = read("plate_quadratic.msh");
    assert_eq!(mesh.kind, ElementKind::Q18);
    assert_eq!(mesh.elements(), linear.elements());
    mesh.check().unwrap();
    close(mesh.volume(), linear.volume(), 1e-12);
    close(enclosed(&mesh), linear.volume(), 1e-12);
    assert_eq!(report.node_tags.len(), mesh.nodes.len());
    let told = report.notes.iter().any(|n| {
        n.contains("18-node solid-shells")
            && n.contains("midway through the thickness were left out")
    });
    assert!(told, "{:?}", report.notes);
    assert_eq!(
        mesh.face_sets.keys().collect::<Vec<_>>(),
        linear.face_sets.keys().collect::<Vec<_>>()
    );
    let normal = |mesh: &Mesh, face: Face| mesh.face_area_normal(face).1;
    for (name, faces) in &mesh.face_sets {
        let other = linear.face_set(name).unwrap();
        assert_eq!(faces.len(), other.len(), "{name}");
        let (a, b) = (normal(&mesh, faces[0]), normal(&linear, other[0]));
        assert!((a - b).norm() < 1e-12, "{name}");
        // The set of the file holds all nodes of its faces.
        assert_eq!(mesh.node_set(name).unwrap(), mesh.nodes_of(faces));
    }
    // Straight elements: every node sits where its parameters say, so the file's order was understood.
    for e in 0..mesh.elements() {
        let x: Vec<Vec3> = (mesh.element(e).iter())
            .map(|&n| mesh.nodes[n as usize])
            .collect();
        for a in 0..18 {
            let (i, j, k) = (a % 3, a / 3 % 3, a / 9);
            let at = |f: [f64; 2], bit: usize| f[bit];
            let (r, s) = (i as f64 / 2.0, j as f64 / 2.0);
            let mut expected = Vec3::zeros();
            for (c, corner) in [0, 2, 6, 8].into_iter().enumerate() {
                let w = at([1.0 - r, r], c & 1) * at([1.0 - s, s], c >> 1);
                expected += x[corner + 9 * k] * w;
            }
            assert!((expected - x[a]).norm() < 1e-12);
        }
    }
}

/// A body says which element it wants; a file of other elements is refused with both ways out.
#[test]
fn files_of_other_elements_are_refused() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/mesh");
    let source = |name: &str| {
        MeshSource::File(MeshFile {
            path: name.into(),
            scale: 1.0,
            ..MeshFile::new("")
        })
    };
    for (name, kind, parts) in [
        (
            "plate.msh",
            ElementKind::Q18,
            ["hexahedra of 8 nodes", "ElementOrder = 2", "\"h8\""],
        ),
        (
            "plate_quadratic.msh",
            ElementKind::H8,
            ["hexahedra of 27 nodes", "ElementOrder = 1", "\"q18\""],
        ),
    ] {
        let error = build(&source(name), kind, &folder).unwrap_err();
        assert!(matches!(error, MeshError::OtherElements { .. }));
        for part in parts.iter().chain(&[name]) {
            assert!(error.to_string().contains(part), "{error}: {part}");
        }
    }
    let (mesh, _) = build(&source("plate_quadratic.msh"), ElementKind::Q18, &folder).unwrap();
    assert_eq!(mesh.kind, ElementKind::Q18);
}

/// One element of 27 nodes on a grid of 3 x 3 x 3 points, node number 1 + i + 3 j + 9 k, thickness along z.
const BRICK_27: [usize; 27] = [
    1, 3, 9, 7, 19, 21, 27, 25, 2, 6, 8, 4, 20, 24, 26, 22, 10, 12, 18, 16, 14, 5, 23, 11, 15, 17,
    13,
];

fn inp(nodes: &[usize], kind: &str, at: impl Fn(usize, usize, usize) -> Vec3) -> String {
    let mut text = "*NODE, NSET=ALL\n".to_string();
    for n in 0..27 {
        let x = at(n % 3, n / 3 % 3, n / 9);
        text += &format!("{}, {}, {}, {}\n", n + 1, x.x, x.y, x.z);
    }
    text += &format!("*ELEMENT, TYPE={kind}, ELSET=BODY\n7");
    for (i, n) in nodes.iter().enumerate() {
        // Lines go on after a comma.
        text += &format!(",{}{n}", if i % 12 == 10 { "\n" } else { " " });
    }
    text + "\n*SURFACE, TYPE=ELEMENT, NAME=top\nBODY, S2\n"
}

fn curved(i: usize, j: usize, k: usize) -> Vec3 {
    let (a, r) = (0.4 * i as f64, 10.0 + 0.05 * k as f64);
    Vec3::new(r * a.sin(), 3.0 * j as f64, r * a.cos())
}

/// C3D27 of a curved shell whose sagitta is larger than its thickness: the inner nodes are found by their places, in
/// whatever order the file has them; the thickness follows the surface `top`.
#[test]
fn abaqus_bricks_of_27_nodes() {
    let read = |text: &str| read_inp(text.as_bytes(), Path::new("a.inp"), 1.0);
    let mut shuffled = BRICK_27;
    shuffled[20..].rotate_left(3);
    shuffled.swap(20, 22);
    let mut meshes = Vec::new();
    for nodes in [BRICK_27, shuffled] {
        let (mesh, report) = read(&inp(&nodes, "C3D27", curved)).unwrap();
        assert_eq!((mesh.kind, mesh.nodes.len()), (ElementKind::Q18, 18));
        assert_eq!(report.thickness, ThicknessRule::Surface);
        assert_eq!(
            mesh.face_set("top").unwrap(),
            [Face {
                element: 0,
                face: 5
            }]
        );
        for &n in mesh.node_set("top").unwrap() {
            let x = mesh.nodes[n as usize];
            close(x.x.hypot(x.z), 10.1, 1e-14);
        }
        close(enclosed(&mesh), mesh.volume(), 1e-12);
        meshes.push(mesh);
    }
    assert_eq!(meshes[0].connectivity, meshes[1].connectivity);
    let message =
        |kind: &str, nodes: &[usize]| read(&inp(nodes, kind, curved)).unwrap_err().to_string();
    let mut twice = BRICK_27;
    twice[26] = twice[20];
    assert!(message("C3D27", &twice).contains("element 7"));
    let both =
        inp(&BRICK_27, "C3D27", curved) + "*ELEMENT, TYPE=C3D8\n8, 1, 3, 9, 7, 19, 21, 27, 25\n";
    let text = read(&both).unwrap_err().to_string();
    assert!(text.contains("not both"), "{text}");
}

/// A thickness whose middle nodes are far off the straight line is told of, with a number.
#[test]
fn crooked_thickness_lines_are_measured() {
    let at = |i: usize, j: usize, k: usize| {
        let x = Vec3::new(2.0 * i as f64, 2.0 * j as f64, 0.5 * k as f64);
        x + Vec3::new(0.0, 0.0, if k == 1 { 0.05 } else { 0.0 })
    };
    let text = inp(&BRICK_27, "C3D27", at);
    let (_, report) = read_inp(text.as_bytes(), Path::new("a.inp"), 1.0).unwrap();
    assert!(
        report
            .notes
            .iter()
            .any(|n| n.contains("9 node(s)") && n.contains("5.00 %")),
        "{:?}",
        report.notes
    );
}

/// gmsh's 20-node hexahedra have no nodes in the middle of faces: they are made, and shared by neighbours.
#[test]
fn gmsh_serendipity_bricks() {
    // Places i + 3 j + 9 k in gmsh's order.
    let order = [
        0, 2, 8, 6, 18, 20, 26, 24, 1, 3, 9, 5, 11, 7, 17, 15, 19, 21, 23, 25,
    ];
    let mut points = Vec::new();
    let mut text = String::new();
    for layer in 0..2 {
        text += &format!("{}", layer + 1);
        for place in order {
            let x = [place % 3, place / 3 % 3, place / 9 + 2 * layer];
            let known = points.iter().position(|p| *p == x).unwrap_or(points.len());
            if known == points.len() {
                points.push(x);
            }
            text += &format!(" {}", known + 1);
        }
        text += "\n";
    }
    let n = points.len();
    assert_eq!(n, 32);
    let mut file =
        format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 {n} 1 {n}\n3 1 0 {n}\n");
    file += &(1..=n).map(|n| format!("{n}\n")).collect::<String>();
    for [i, j, k] in points {
        file += &format!("{i} {j} {}\n", 0.1 * k as f64);
    }
    file += &format!("$EndNodes\n$Elements\n1 2 1 2\n3 1 17 2\n{text}$EndElements\n");
    let (mesh, report) = read_gmsh(file.as_bytes(), Path::new("s.msh"), 1.0).unwrap();
    assert_eq!((mesh.kind, mesh.elements()), (ElementKind::Q18, 2));
    assert_eq!((mesh.nodes.len(), report.components), (27, 1));
    close(mesh.volume(), 2.0 * 2.0 * 0.4, 1e-13);
}

fn two_elements() -> Mesh {
    let p = Plate {
        size: [2.0, 1.0],
        thickness: 0.5,
        elements: [2, 1],
        layers: 1,
        origin: [0.0; 3],
        spacing: Default::default(),
    };
    plate(&p, ElementKind::Q18).unwrap()
}

/// A middle node past the quarter of its edge folds the parametrisation at the corner, though all corners stand well;
/// named with the element. Two elements that share the corners of a face only are named too.
#[test]
fn distorted_meshes_are_refused_by_name() {
    let mut mesh = two_elements();
    mesh.check().unwrap();
    // Middle of the edge along x at the bottom of element 1: from x = 1.5 to 1.2, past the quarter point 1.25.
    let node = mesh.element(1)[1] as usize;
    assert_eq!(mesh.nodes[node].x, 1.5);
    mesh.nodes[node].x = 1.3;
    mesh.check().unwrap();
    mesh.nodes[node].x = 1.2;
    let error = mesh.check().unwrap_err();
    assert!(
        matches!(
            error,
            MeshError::Inverted {
                element: 1,
                count: 1,
                ..
            }
        ),
        "{error}"
    );
    // Degenerate: the middle node on a corner.
    mesh.nodes[node].x = 1.0;
    assert!(matches!(
        mesh.check(),
        Err(MeshError::Inverted { element: 1, .. })
    ));

    let mut mesh = two_elements();
    // Element 1 has nodes of its own in the middles of the face that both share: its side r = -1.
    for a in [3, 12] {
        let own = mesh.nodes[mesh.element(1)[a] as usize] + Vec3::new(0.1, 0.0, 0.0);
        mesh.connectivity[18 + a] = mesh.nodes.len() as u32;
        mesh.nodes.push(own);
    }
    let error = mesh.check().unwrap_err();
    assert!(
        matches!(
            error,
            MeshError::UnlikeFaces {
                elements: [0, 1],
                ..
            }
        ),
        "{error}"
    );
}
