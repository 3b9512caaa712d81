//! A mid-surface mesh of the size of a real part: 10,000 quadrilaterals with folds and a hole.
use crate::support::{Surface, close, file, h8, load};
use std::time::{Duration, Instant};

/// A hat profile 60 long: a crown with a square hole of 12 by 12 in its middle, two webs and two feet, all in squares.
fn hat(size: f64) -> Surface {
    // Corners of the section, and the way along it to each.
    let section: [[f64; 2]; 6] = [
        [-23.0, 0.0],
        [-15.0, 0.0],
        [-15.0, 12.0],
        [15.0, 12.0],
        [15.0, 0.0],
        [23.0, 0.0],
    ];
    let mut line = vec![section[0]];
    for ends in section.windows(2) {
        let [a, b] = [ends[0], ends[1]];
        let n = ((b[0] - a[0]).hypot(b[1] - a[1]) / size).round();
        let at = |k: f64, c: usize| a[c] + (b[c] - a[c]) * k / n;
        line.extend((1..=n as usize).map(|k| [at(k as f64, 0), at(k as f64, 1)]));
    }
    let rows = (60.0 / size).round() as usize;
    let mut surface = Surface::default();
    for j in 0..=rows {
        let y = 60.0 * j as f64 / rows as f64 - 30.0;
        surface.points.extend(line.iter().map(|[x, z]| [*x, y, *z]));
    }
    for j in 0..rows {
        for i in 0..line.len() - 1 {
            let a = i + line.len() * j;
            let facet = vec![a, a + 1, a + line.len() + 1, a + line.len()];
            let middle = |c: usize| facet.iter().map(|n| surface.points[*n][c]).sum::<f64>() / 4.0;
            let hole = middle(2) > 11.999 && middle(0).abs() < 6.0 && middle(1).abs() < 6.0;
            if !hole {
                surface.facets.push(facet);
            }
        }
    }
    // Nodes inside of the hole belong to nothing.
    let mut number = vec![usize::MAX; surface.points.len()];
    let mut points = Vec::new();
    for node in surface.facets.iter_mut().flatten() {
        if number[*node] == usize::MAX {
            number[*node] = points.len();
            points.push(surface.points[*node]);
        }
        *node = number[*node];
    }
    surface.points = points;
    surface
}

/// Folds keep the volume, mitred as they are: thickness times the area of the mid-surface. The time is three times what an
/// unoptimised build takes on a slow machine; an optimised one takes a twentieth of it.
#[test]
fn ten_thousand_quadrilaterals() {
    let surface = hat(0.64);
    assert!(surface.facets.len() > 10_000, "{}", surface.facets.len());
    let text = surface.inp();
    let begin = Instant::now();
    let (mesh, report) = h8(&text, &file(0.4)).unwrap();
    let took = begin.elapsed();
    assert_eq!(mesh.elements(), surface.facets.len());
    assert_eq!(mesh.nodes.len(), 2 * surface.points.len());
    assert_eq!(report.element_tags.len(), mesh.elements());
    let area: f64 = (surface.facets.iter())
        .map(|f| {
            let x = |k: usize| covact_geometry::Vec3::from(surface.points[f[k]]);
            0.5 * (x(2) - x(0)).cross(&(x(3) - x(1))).norm()
        })
        .sum();
    close(area, 60.0 * 70.0 - 144.0, 0.03);
    let corner = |e: usize, a: usize| mesh.nodes[mesh.element(e)[a] as usize];
    let volume: f64 = (0..mesh.elements())
        .map(|e| {
            let [r, s, t] = [1, 2, 4].map(|bit| {
                let along = |a: usize| corner(e, a | bit) - corner(e, a);
                (0..8)
                    .filter(|a| a & bit == 0)
                    .map(along)
                    .sum::<covact_geometry::Vec3>()
                    / 4.0
            });
            r.cross(&s).dot(&t)
        })
        .sum();
    close(volume, 0.4 * area, 1e-9);
    assert!(took < Duration::from_secs(10), "{took:?}");
}

/// A bracket that a CAD kernel wrote and gmsh read and meshed (assets/mesh/make_bracket.py): its sets have the areas of the part, its
/// straight lengths and bends of radius 4 by 60 less the holes, as far as chords of bends and holes have them, and the volume is that
/// by the thickness.
#[test]
fn a_part_from_a_file_of_a_cad_kernel() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/mesh/bracket.msh");
    let bytes = std::fs::read(path).unwrap();
    let (mesh, _) = load(&bytes, "msh", &file(1.0), covact::mesh::ElementKind::H8).unwrap();
    let area = |set: &str| -> f64 {
        let middle = |f: &covact::mesh::Face, k: usize| {
            let nodes = mesh.element(f.element as usize);
            0.5 * (mesh.nodes[nodes[k] as usize] + mesh.nodes[nodes[k + 4] as usize])
        };
        let faces = &mesh.face_sets[set];
        // Corners 0, 1, 2, 3 of the lower face are its nodes 0, 1, 3, 2.
        faces
            .iter()
            .map(|f| {
                let [a, b, d, c] = [0, 1, 2, 3].map(|k| middle(f, k));
                0.5 * (c - a).cross(&(d - b)).norm()
            })
            .sum()
    };
    let circle = |r: f64| std::f64::consts::PI * r * r;
    for (set, expected) in [
        ("foot_top", 26.0 * 60.0 - 2.0 * circle(3.5)),
        ("web_top", 17.0 * 60.0 - circle(5.0)),
        (
            "flange_top",
            37.0 * 60.0 - circle(6.0) - 14.0 * 7.0 - circle(3.5),
        ),
        ("lip_top", 3.0 * 60.0),
    ] {
        let found = area(set);
        assert!(
            (found / expected - 1.0).abs() < 0.015,
            "{set}: {found} {expected}"
        );
    }
    // Two or three chords of each bend.
    let bends = area("bends_top") / (3.0 * 60.0 * 2.0 * std::f64::consts::PI);
    let chords =
        |n: f64| (std::f64::consts::PI / (4.0 * n)).sin() / (std::f64::consts::PI / (4.0 * n));
    assert!(bends > chords(2.0) - 1e-6 && bends < chords(3.0), "{bends}");
    assert_eq!(mesh.face_sets["bolts"].len() % 2, 0);
    assert!(mesh.face_sets["bolts"].len() >= 16);
}
