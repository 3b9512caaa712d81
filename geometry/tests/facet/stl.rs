//! STL files: both kinds told apart, connected, damaged; their facets as a surface with an inside.

use covact_geometry::io::{Stl, StlError, read_stl};
use covact_geometry::{PatchSet, Vec3};

/// Vertices and outward triangles of a box.
fn cuboid(size: [f64; 3]) -> Vec<[Vec3; 3]> {
    let x = |k: usize| {
        Vec3::new(
            if k & 1 == 1 { size[0] } else { 0.0 },
            if k & 2 == 2 { size[1] } else { 0.0 },
            if k & 4 == 4 { size[2] } else { 0.0 },
        )
    };
    let quads = [
        [0, 2, 1, 3],
        [4, 5, 6, 7],
        [0, 1, 4, 5],
        [2, 6, 3, 7],
        [0, 4, 2, 6],
        [1, 3, 5, 7],
    ];
    (quads.iter())
        .flat_map(|&[a, b, c, d]| [[a, b, d], [a, d, c]])
        .map(|t| t.map(x))
        .collect()
}

fn ascii(triangles: &[[Vec3; 3]]) -> String {
    let mut out = "solid box made by hand\n".to_owned();
    for t in triangles {
        out += "  facet normal 0 0 0\n    outer loop\n";
        for x in t {
            out += &format!("      vertex {:e} {:e} {}\n", x.x, x.y, x.z);
        }
        out += "    endloop\n  endfacet\n";
    }
    out + "endsolid box made by hand\n"
}

fn read(bytes: &[u8]) -> Stl {
    read_stl(bytes, "test", None).unwrap()
}

/// Signed distance from the box [0, size].
fn truth(q: &Vec3, size: [f64; 3]) -> f64 {
    let d: [f64; 3] = std::array::from_fn(|k| (-q[k]).max(q[k] - size[k]));
    let outside = Vec3::from_fn(|k, _| d[k].max(0.0)).norm();
    outside + d.iter().copied().fold(f64::NEG_INFINITY, f64::max).min(0.0)
}

/// A box, ASCII: 36 vertices become 8 nodes; signed distances are exact inside and outside, to rounding.
#[test]
fn signed_distances_of_a_box() {
    let size = [1.0, 2.0, 3.5];
    let stl = read(ascii(&cuboid(size)).as_bytes());
    let report = &stl.report;
    assert!(!report.binary && stl.nodes.len() == 8 && report.merged == 28);
    assert_eq!(
        (
            report.triangles,
            report.free,
            report.flipped,
            report.branching
        ),
        (12, 0, 0, 0)
    );
    let mesh = stl.facets();
    // Euler: 8 + 18 middles + 12 centroids.
    assert_eq!((mesh.facets.len(), mesh.nodes.len()), (36, 38));
    let set = PatchSet::new(mesh.surfaces().unwrap(), None).unwrap();
    let edges = set.edges();
    assert!(edges.free.is_empty() && edges.poles.is_empty() && edges.partial.is_empty());
    // 12 edges of the box, each cut in two.
    assert_eq!((edges.sharp, edges.smooth), (24, 48));
    let (mut inside, mut worst) = (0, 0.0f64);
    for k in 0..1000 {
        let one = |a: f64| (0.5 + a * f64::from(k)).fract() * 1.6 - 0.3;
        let q = Vec3::new(
            one(0.819_172_513_396) * size[0],
            one(0.671_043_606_704) * size[1],
            one(0.549_700_477_901) * size[2],
        );
        let foot = set.project(&q, None, f64::INFINITY).unwrap();
        inside += usize::from(truth(&q, size) < 0.0);
        worst = worst.max((foot.signed_distance - truth(&q, size)).abs());
    }
    println!("{inside} inside, worst {worst:e}");
    assert!(
        inside > 150 && inside < 700 && worst < 1e-13,
        "{inside} {worst:e}"
    );
}

/// A tetrahedron, binary, with a header that begins with "solid": distances to its planes inside, to its corners outside.
#[test]
fn a_tetrahedron() {
    let x = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::from);
    let made = Stl {
        nodes: x.to_vec(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        numbers: vec![0, 1, 2, 3],
        report: read(ascii(&cuboid([1.0; 3])).as_bytes()).report,
    };
    let mut bytes = made.to_binary();
    assert_eq!(bytes.len(), 84 + 4 * 50);
    bytes[..11].copy_from_slice(b"solid tetra");
    let stl = read(&bytes);
    assert!(stl.report.binary && stl.report.normals_against == 0);
    assert_eq!(
        (stl.nodes.len(), stl.triangles.len(), stl.report.free),
        (4, 4, 0)
    );
    let set = PatchSet::new(stl.facets().surfaces().unwrap(), None).unwrap();
    let distance = |x, y, z| {
        let q = Vec3::new(x, y, z);
        set.project(&q, None, f64::INFINITY)
            .unwrap()
            .signed_distance
    };
    let slanted = |s: f64| (s - 1.0) / 3f64.sqrt();
    for (found, expected) in [
        (distance(0.3, 0.3, 0.3), slanted(0.9)),
        (distance(0.1, 0.2, 0.3), -0.1),
        (distance(0.6, 0.6, 0.6), slanted(1.8)),
        (distance(-1.0, -2.0, -2.0), 3.0),
        (distance(3.0, 0.0, 0.0), 2.0),
        (distance(0.5, -1.0, -1.0), 2f64.sqrt()),
        (distance(0.2, 0.2, -0.5), 0.5),
    ] {
        assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    }
}

/// Written and read again: the same triangles (these coordinates are exact in single precision).
#[test]
fn binary_and_ascii_are_the_same() {
    let text = read(ascii(&cuboid([1.0, 2.0, 3.5])).as_bytes());
    let again = read(&text.to_binary());
    assert_eq!(
        (&again.nodes, &again.triangles),
        (&text.nodes, &text.triangles)
    );
    // Bytes appended by careless writers do not make it a text.
    let mut longer = text.to_binary();
    longer[..5].copy_from_slice(b"solid");
    longer.extend(b"tail");
    assert_eq!(read(&longer).triangles, text.triangles);
    // Two solids in one file, and a byte order mark.
    let twice = format!("\u{feff}{0}{0}", ascii(&cuboid([1.0; 3])));
    assert_eq!(read(twice.as_bytes()).report.triangles, 24);
}

/// Nearly equal vertices are merged at the tolerance, across the borders of the boxes of the search too; what is left
/// without an area is dropped by number, turned and free triangles are counted.
#[test]
fn the_account() {
    let mut triangles = cuboid([1.0; 3]);
    for (k, t) in triangles.iter_mut().enumerate() {
        for (i, x) in t.iter_mut().enumerate() {
            *x += Vec3::from_element(1e-6 * ((3 * k + i) % 5) as f64 - 2e-6);
        }
    }
    let loose = read_stl(ascii(&triangles).as_bytes(), "test", Some(1e-9)).unwrap();
    assert!(loose.nodes.len() > 8 && loose.report.free > 0);
    let tight = read_stl(ascii(&triangles).as_bytes(), "test", Some(1e-5)).unwrap();
    assert_eq!((tight.nodes.len(), tight.report.free), (8, 0));

    let mut triangles = cuboid([1.0; 3]);
    triangles[3].swap(0, 1);
    let x = triangles[0];
    triangles.insert(2, [x[0], x[1], x[0]]);
    triangles.insert(5, [x[0], (x[0] + x[1]) * 0.5, x[1]]);
    triangles.pop();
    let stl = read(ascii(&triangles).as_bytes());
    assert_eq!(stl.report.degenerate, [2, 5]);
    assert_eq!((stl.report.flipped, stl.report.free), (3, 3));
    assert_eq!(stl.numbers, [0, 1, 3, 4, 6, 7, 8, 9, 10, 11, 12]);
}

/// Damage is named with its line or byte, and a count in a header allocates nothing.
#[test]
fn damaged_files() {
    let whole = ascii(&cuboid([1.0; 3]));
    let line = |text: &str| match read_stl(text.as_bytes(), "f", None) {
        Err(StlError::Line { line, expected, .. }) => (line, expected),
        other => panic!("{other:?}"),
    };
    assert_eq!(
        line(&whole.replacen("vertex 0e0 0e0 0\n", "vertex 0e0 x 0\n", 1)),
        (4, "a number")
    );
    assert_eq!(
        line(&whole.replacen("vertex 0e0 0e0 0\n", "vertex 0e0 inf 0\n", 1)),
        (4, "a number")
    );
    assert_eq!(
        line(&whole.replacen("endloop", "vertex 1 2 3\n endloop", 1)).0,
        7
    );
    assert_eq!(
        line(&whole[..whole.len() / 2]).1,
        "\"facet\" or \"endsolid\""
    );
    assert_eq!(line("solid\nfoo"), (2, "\"facet\" or \"endsolid\""));
    assert!(matches!(
        read_stl(b"solid\nendsolid\n", "f", None),
        Err(StlError::Empty { .. })
    ));
    assert!(matches!(
        read_stl(b"solid\n", "f", Some(-1.0)),
        Err(StlError::Tolerance(_))
    ));
    let bytes = read(whole.as_bytes()).to_binary();
    let byte = |bytes: &[u8]| match read_stl(bytes, "f", None) {
        Err(StlError::Byte { byte, .. }) => byte,
        other => panic!("{other:?}"),
    };
    assert_eq!(byte(&bytes[..bytes.len() - 1]), bytes.len() - 1);
    assert_eq!(byte(&bytes[..70]), 70);
    assert_eq!(byte(b""), 0);
    let mut large = bytes.clone();
    large[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(byte(&large), bytes.len());
    let mut nan = bytes.clone();
    let place = 84 + 50 * 3 + 12;
    nan[place..place + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(byte(&nan), place);
    // Every prefix and many single damaged bytes: an answer or an error, no panic.
    for whole in [whole.as_bytes(), &bytes] {
        for end in 0..whole.len() {
            let _ = read_stl(&whole[..end], "f", None);
            let mut damaged = whole.to_vec();
            damaged[end] ^= 0x55;
            if let Ok(stl) = read_stl(&damaged, "f", None) {
                assert!(stl.triangles.len() <= 12 && stl.facets().surfaces().is_ok());
            }
        }
    }
}
