//! The same surface in every format is the same body, bit by bit.
use crate::support::{Surface, file, grid, load};
use covact::mesh::{ElementKind, Mesh};
use covact_geometry::Vec3;
use covact_geometry::io::write_stl;
use std::fmt::Write;

/// A bent sheet; its coordinates have few digits, so that single precision holds them.
fn sheet() -> Surface {
    grid(4, 2, |u, v| [4.0 * u, 2.0 * v, (2.0 * (u - 0.5)).powi(2)])
}

fn nodes(facet: &[usize], first: usize, by: &str) -> String {
    let numbers: Vec<String> = facet.iter().map(|n| (n + first).to_string()).collect();
    numbers.join(by)
}

fn gmsh_type(facet: &[usize]) -> usize {
    if facet.len() == 4 { 3 } else { 2 }
}

fn msh_4(s: &Surface) -> String {
    let (n, e) = (s.points.len(), s.facets.len());
    let mut text = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"sheet\"\n$EndPhysicalNames\n\
         $Entities\n0 0 1 0\n1 0 0 0 4 2 1 1 1 0\n$EndEntities\n$Nodes\n1 {n} 1 {n}\n2 1 0 {n}\n"
    );
    (1..=n).for_each(|k| writeln!(text, "{k}").unwrap());
    s.points
        .iter()
        .for_each(|[x, y, z]| writeln!(text, "{x} {y} {z}").unwrap());
    let kind = gmsh_type(&s.facets[0]);
    write!(text, "$EndNodes\n$Elements\n1 {e} 1 {e}\n2 1 {kind} {e}\n").unwrap();
    for (k, f) in s.facets.iter().enumerate() {
        writeln!(text, "{} {}", k + 1, nodes(f, 1, " ")).unwrap();
    }
    text + "$EndElements\n"
}

fn msh_4_binary(s: &Surface) -> Vec<u8> {
    let (n, e) = (s.points.len() as u64, s.facets.len() as u64);
    let mut out = b"$MeshFormat\n4.1 1 8\n".to_vec();
    out.extend(1i32.to_le_bytes());
    out.extend(b"\n$EndMeshFormat\n$Nodes\n");
    [1, n, 1, n]
        .iter()
        .for_each(|v: &u64| out.extend(v.to_le_bytes()));
    [2i32, 1, 0]
        .iter()
        .for_each(|v| out.extend(v.to_le_bytes()));
    out.extend(n.to_le_bytes());
    (1..=n).for_each(|k| out.extend(k.to_le_bytes()));
    s.points
        .iter()
        .flatten()
        .for_each(|x| out.extend(x.to_le_bytes()));
    out.extend(b"\n$EndNodes\n$Elements\n");
    [1, e, 1, e]
        .iter()
        .for_each(|v: &u64| out.extend(v.to_le_bytes()));
    [2, 1, gmsh_type(&s.facets[0]) as i32]
        .iter()
        .for_each(|v| out.extend(v.to_le_bytes()));
    out.extend(e.to_le_bytes());
    for (k, f) in s.facets.iter().enumerate() {
        out.extend((k as u64 + 1).to_le_bytes());
        f.iter()
            .for_each(|n| out.extend((*n as u64 + 1).to_le_bytes()));
    }
    out.extend(b"\n$EndElements\n");
    out
}

fn msh_2(s: &Surface) -> String {
    let mut text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"sheet\"\n$EndPhysicalNames\n$Nodes\n{}\n",
        s.points.len()
    );
    for (k, [x, y, z]) in s.points.iter().enumerate() {
        writeln!(text, "{} {x} {y} {z}", k + 1).unwrap();
    }
    write!(text, "$EndNodes\n$Elements\n{}\n", s.facets.len()).unwrap();
    for (k, f) in s.facets.iter().enumerate() {
        writeln!(
            text,
            "{} {} 2 1 1 {}",
            k + 1,
            gmsh_type(f),
            nodes(f, 1, " ")
        )
        .unwrap();
    }
    text + "$EndElements\n"
}

fn msh_2_binary(s: &Surface) -> Vec<u8> {
    let mut out = b"$MeshFormat\n2.2 1 8\n".to_vec();
    let int = |out: &mut Vec<u8>, v: usize| out.extend((v as i32).to_le_bytes());
    int(&mut out, 1);
    out.extend(format!("\n$EndMeshFormat\n$Nodes\n{}\n", s.points.len()).bytes());
    for (k, x) in s.points.iter().enumerate() {
        int(&mut out, k + 1);
        x.iter().for_each(|x| out.extend(x.to_le_bytes()));
    }
    out.extend(format!("\n$EndNodes\n$Elements\n{}\n", s.facets.len()).bytes());
    // One head for all elements.
    [gmsh_type(&s.facets[0]), s.facets.len(), 2]
        .iter()
        .for_each(|v| int(&mut out, *v));
    for (k, f) in s.facets.iter().enumerate() {
        [k + 1, 1, 1].iter().for_each(|v| int(&mut out, *v));
        f.iter().for_each(|n| int(&mut out, n + 1));
    }
    out.extend(b"\n$EndElements\n");
    out
}

/// Small, large and free fields.
fn bdf(s: &Surface, form: usize) -> String {
    let mut text = "SOL 101\nCEND\nBEGIN BULK\n".to_string();
    let card = |text: &mut String, name: &str, fields: &[String]| match form {
        0 => {
            write!(text, "{name:<8}").unwrap();
            fields.iter().for_each(|f| write!(text, "{f:<8}").unwrap());
            text.push('\n');
        }
        1 => {
            write!(text, "{:<8}", format!("{name}*")).unwrap();
            for (k, f) in fields.iter().enumerate() {
                if k == 4 {
                    text.push_str("\n*       ");
                }
                write!(text, "{f:<16}").unwrap();
            }
            text.push('\n');
        }
        _ => writeln!(text, "{name},{}", fields.join(",")).unwrap(),
    };
    // Elements first: cards stand in any order.
    for (k, f) in s.facets.iter().enumerate() {
        let name = if f.len() == 4 { "CQUAD4" } else { "CTRIA3" };
        let mut fields = vec![(k + 1).to_string(), "1".to_string()];
        fields.extend(f.iter().map(|n| (n + 1).to_string()));
        card(&mut text, name, &fields);
    }
    for (k, x) in s.points.iter().enumerate() {
        let mut fields = vec![(k + 1).to_string(), String::new()];
        fields.extend(x.iter().map(|x| format!("{x:.4}")));
        card(&mut text, "GRID", &fields);
    }
    text + "ENDDATA\n"
}

fn vtk_type(facet: &[usize]) -> usize {
    if facet.len() == 4 { 9 } else { 5 }
}

/// Versions 4 and 5 of the legacy format, text and big-endian.
fn vtk(s: &Surface, five: bool, binary: bool) -> Vec<u8> {
    let mut out = format!(
        "# vtk DataFile Version {}\na sheet\n{}\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n",
        if five { "5.1" } else { "4.2" },
        if binary { "BINARY" } else { "ASCII" },
        s.points.len()
    )
    .into_bytes();
    let ints = |out: &mut Vec<u8>, values: &[usize], wide: bool| {
        for v in values {
            match (binary, wide) {
                (true, true) => out.extend((*v as i64).to_be_bytes()),
                (true, false) => out.extend((*v as i32).to_be_bytes()),
                _ => out.extend(format!("{v} ").bytes()),
            }
        }
        out.push(b'\n');
    };
    for x in s.points.iter().flatten() {
        match binary {
            true => out.extend(x.to_be_bytes()),
            false => out.extend(format!("{x} ").bytes()),
        }
    }
    let size: usize = s.facets.iter().map(Vec::len).sum();
    let count = s.facets.len();
    if five {
        out.extend(format!("\nCELLS {} {size}\nOFFSETS vtktypeint64\n", count + 1).bytes());
        let mut ends = vec![0];
        s.facets
            .iter()
            .for_each(|f| ends.push(ends[ends.len() - 1] + f.len()));
        ints(&mut out, &ends, true);
        out.extend(b"CONNECTIVITY vtktypeint64\n");
        ints(&mut out, &s.facets.concat(), true);
    } else {
        out.extend(format!("\nCELLS {count} {}\n", size + count).bytes());
        let all: Vec<usize> = (s.facets.iter())
            .flat_map(|f| std::iter::once(f.len()).chain(f.iter().copied()))
            .collect();
        ints(&mut out, &all, false);
    }
    out.extend(format!("CELL_TYPES {count}\n").bytes());
    let types: Vec<usize> = s.facets.iter().map(|f| vtk_type(f)).collect();
    ints(&mut out, &types, false);
    out.extend(format!("CELL_DATA {count}\nSCALARS part int 1\nLOOKUP_TABLE default\n").bytes());
    ints(&mut out, &vec![3; count], false);
    out.extend(format!("FIELD FieldData 1\nstress 2 {count} double\n").bytes());
    for _ in 0..2 * count {
        match binary {
            true => out.extend(f64::NAN.to_be_bytes()),
            false => out.extend(b"nan "),
        }
    }
    out.push(b'\n');
    out
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::new();
    for chunk in bytes.chunks(3) {
        let byte = |k: usize| u32::from(chunk.get(k).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for k in 0..4 {
            match k <= chunk.len() {
                true => out.push(LETTERS[(bits >> (18 - 6 * k) & 63) as usize] as char),
                false => out.push('='),
            }
        }
    }
    out
}

/// Bytes as a zlib stream of stored blocks.
fn stored(bytes: &[u8]) -> Vec<u8> {
    let mut out = vec![0x78, 0x01, 1];
    out.extend((bytes.len() as u16).to_le_bytes());
    out.extend((!(bytes.len() as u16)).to_le_bytes());
    out.extend(bytes);
    let (mut a, mut b) = (1u32, 0u32);
    for x in bytes {
        a = (a + u32::from(*x)) % 65521;
        b = (b + a) % 65521;
    }
    out.extend((b << 16 | a).to_be_bytes());
    out
}

/// How arrays of an XML file are written.
#[derive(Clone, Copy, PartialEq)]
enum Xml {
    Text,
    Base64,
    Zlib,
    Appended,
}

fn vtu(s: &Surface, how: Xml) -> Vec<u8> {
    let mut appended = Vec::new();
    let mut array = |name: &str, kind: &str, components: usize, text: String, bytes: Vec<u8>| {
        let head = format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\""
        );
        let length = (bytes.len() as u32).to_le_bytes();
        match how {
            Xml::Text => format!("{head} format=\"ascii\">\n{text}\n</DataArray>\n"),
            Xml::Base64 => {
                let data = base64(&[&length[..], &bytes].concat());
                format!("{head} format=\"binary\">\n{data}\n</DataArray>\n")
            }
            Xml::Zlib => {
                // Two blocks, the second one shorter.
                let size = bytes.len().div_ceil(2).max(1);
                let blocks: Vec<Vec<u8>> = bytes.chunks(size).map(stored).collect();
                let last = bytes.len() % size;
                let mut head_: Vec<u8> = Vec::new();
                [blocks.len(), size, last]
                    .iter()
                    .for_each(|n| head_.extend((*n as u32).to_le_bytes()));
                blocks
                    .iter()
                    .for_each(|b| head_.extend((b.len() as u32).to_le_bytes()));
                let data = base64(&head_) + &base64(&blocks.concat());
                format!("{head} format=\"binary\">{data}</DataArray>\n")
            }
            Xml::Appended => {
                let offset = appended.len();
                appended.extend(length);
                appended.extend(bytes);
                format!("{head} format=\"appended\" offset=\"{offset}\"/>\n")
            }
        }
    };
    let numbers = |values: &[usize]| {
        let text: Vec<String> = values.iter().map(usize::to_string).collect();
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|v| (*v as i64).to_le_bytes())
            .collect();
        (text.join(" "), bytes)
    };
    let flat: Vec<f64> = s.points.iter().flatten().copied().collect();
    let text: Vec<String> = flat.iter().map(f64::to_string).collect();
    let bytes = flat.iter().flat_map(|x| x.to_le_bytes()).collect();
    let points = array("Points", "Float64", 3, text.join("\n"), bytes);
    let mut end = 0;
    let ends: Vec<usize> = (s.facets.iter())
        .map(|f| {
            end += f.len();
            end
        })
        .collect();
    let types: Vec<usize> = s.facets.iter().map(|f| vtk_type(f)).collect();
    let mut cells = String::new();
    for (name, values) in [
        ("connectivity", s.facets.concat()),
        ("offsets", ends),
        ("types", types),
    ] {
        let (text, bytes) = numbers(&values);
        cells += &array(name, "Int64", 1, text, bytes);
    }
    let (text, bytes) = numbers(&vec![3; s.facets.len()]);
    let part = array("part", "Int64", 1, text, bytes);
    let compressor = if how == Xml::Zlib {
        " compressor=\"vtkZLibDataCompressor\""
    } else {
        ""
    };
    let mut out = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"{compressor}>\n\
         <UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n{points}</Points>\n<Cells>\n{cells}\
         </Cells>\n<CellData>\n{part}</CellData>\n</Piece>\n</UnstructuredGrid>\n",
        s.points.len(),
        s.facets.len()
    )
    .into_bytes();
    if how == Xml::Appended {
        out.extend(b"<AppendedData encoding=\"raw\">\n_");
        out.extend(appended);
        out.extend(b"\n</AppendedData>\n");
    }
    out.extend(b"</VTKFile>\n");
    out
}

/// All forms of all formats, with the set that stands for the whole sheet.
fn written(s: &Surface) -> Vec<(&'static str, &'static str, Vec<u8>, Option<&'static str>)> {
    vec![
        ("4.1", "msh", msh_4(s).into(), Some("sheet")),
        ("4.1 binary", "msh", msh_4_binary(s), None),
        ("2.2", "msh", msh_2(s).into(), Some("sheet")),
        ("2.2 binary", "msh", msh_2_binary(s), Some("surface_1")),
        ("inp", "inp", s.inp().into(), Some("ALL")),
        ("small fields", "bdf", bdf(s, 0).into(), Some("property_1")),
        ("large fields", "bdf", bdf(s, 1).into(), Some("property_1")),
        ("free fields", "nas", bdf(s, 2).into(), Some("property_1")),
        ("legacy 4", "vtk", vtk(s, false, false), Some("part_3")),
        (
            "legacy 4 binary",
            "vtk",
            vtk(s, false, true),
            Some("part_3"),
        ),
        ("legacy 5", "vtk", vtk(s, true, false), Some("part_3")),
        ("legacy 5 binary", "vtk", vtk(s, true, true), Some("part_3")),
        ("XML text", "vtu", vtu(s, Xml::Text), Some("part_3")),
        ("XML base64", "vtu", vtu(s, Xml::Base64), Some("part_3")),
        ("XML zlib", "vtu", vtu(s, Xml::Zlib), Some("part_3")),
        ("XML appended", "vtu", vtu(s, Xml::Appended), Some("part_3")),
    ]
}

/// Generated sets and bits of two meshes.
fn same(name: &str, mesh: &Mesh, expected: &Mesh) {
    let bits = |mesh: &Mesh| -> Vec<[u64; 3]> {
        mesh.nodes
            .iter()
            .map(|x| [x.x, x.y, x.z].map(f64::to_bits))
            .collect()
    };
    assert_eq!(mesh.connectivity, expected.connectivity, "{name}");
    assert_eq!(bits(mesh), bits(expected), "{name}");
    for set in [
        "top", "bottom", "border", "x_min", "x_max", "y_min", "y_max", "z_max",
    ] {
        assert_eq!(
            mesh.face_set(set).unwrap(),
            expected.face_set(set).unwrap(),
            "{name} {set}"
        );
        assert_eq!(
            mesh.node_set(set).unwrap(),
            expected.node_set(set).unwrap(),
            "{name} {set}"
        );
    }
}

#[test]
fn every_format_gives_the_same_body() {
    for (surface, elements) in [(sheet(), 8), (sheet().triangles(), 48)] {
        let all = written(&surface);
        let load = |bytes: &[u8], extension| {
            load(bytes, extension, &file(0.25), ElementKind::H8).unwrap_or_else(|e| panic!("{e}"))
        };
        let (expected, _) = load(&all[0].2, "msh");
        assert_eq!(expected.elements(), elements);
        for (name, extension, bytes, set) in all {
            let (mesh, report) = load(&bytes, extension);
            same(name, &mesh, &expected);
            if let Some(set) = set {
                let top = mesh.face_set(&format!("{set}_top"));
                assert_eq!(
                    top.unwrap_or_else(|e| panic!("{name}: {e}")).len(),
                    elements,
                    "{name}"
                );
            }
            assert_eq!(report.element_tags.len(), elements);
        }
    }
}

/// Triangles of STL come without connections: equal points are one node, in the order in which they appear.
#[test]
fn stl_gives_the_same_body() {
    let mut surface = sheet().triangles();
    // In the order in which triangles name them.
    let mut order: Vec<usize> = Vec::new();
    for n in surface.facets.iter().flatten() {
        if !order.contains(n) {
            order.push(*n);
        }
    }
    let place = |n: &usize| order.iter().position(|m| m == n).unwrap();
    surface.facets = surface
        .facets
        .iter()
        .map(|f| f.iter().map(place).collect())
        .collect();
    surface.points = order.iter().map(|&n| surface.points[n]).collect();
    let load = |bytes: &[u8], extension| {
        load(bytes, extension, &file(0.25), ElementKind::H8)
            .unwrap()
            .0
    };
    let expected = load(surface.inp().as_bytes(), "inp");
    let points: Vec<Vec3> = surface.points.iter().map(|x| Vec3::from(*x)).collect();
    let triangles: Vec<[u32; 3]> = (surface.facets.iter())
        .map(|f| [0, 1, 2].map(|k| f[k] as u32))
        .collect();
    same(
        "binary",
        &load(&write_stl(&points, &triangles), "stl"),
        &expected,
    );
    let mut text = "solid sheet\n".to_string();
    for triangle in &triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for n in triangle {
            let x = points[*n as usize];
            writeln!(text, "vertex {} {} {}", x.x, x.y, x.z).unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    same(
        "text",
        &load((text + "endsolid\n").as_bytes(), "stl"),
        &expected,
    );
}

/// Files cut short and single wrong bytes: an error or a mesh, never a panic.
#[test]
fn damaged_files_do_not_panic() {
    let (mut refused, mut read) = (0, 0);
    for (_, extension, bytes, _) in written(&grid(2, 1, |u, v| [u, v, 0.0])) {
        let mut attempt = |bytes: &[u8]| match load(bytes, extension, &file(0.1), ElementKind::H8) {
            Ok((mesh, _)) => {
                mesh.check().unwrap();
                read += 1;
            }
            Err(e) => {
                assert!(e.to_string().len() < 1000, "{e}");
                refused += 1;
            }
        };
        for cut in (0..bytes.len()).step_by(2) {
            attempt(&bytes[..cut]);
        }
        for at in (0..bytes.len()).step_by(3) {
            let mut damaged = bytes.clone();
            for value in [0, b'-', b'9', b'<', 0xff] {
                damaged[at] = value;
                attempt(&damaged);
            }
        }
    }
    assert!(refused > 5_000 && read > 100, "{refused} {read}");
}
