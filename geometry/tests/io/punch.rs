//! `assets/punch.igs` against the closed forms of its planes, quarter cylinders and torus pieces.
//!
//! ```text
//!   half widths 20 x 15, corner radius R = 8      |  | wall 10
//!   .----------.                                   '.    r = 5
//!   |          |  corner: torus 3 + 5 cos           '------ bottom
//! ```

use crate::support::{area, assets};
use covact_geometry::io::{CadPatch, read_path};
use covact_geometry::{NurbsPatch, Vec3};
use std::f64::consts::PI;

fn punch() -> Vec<CadPatch> {
    let file = read_path(&assets().join("punch.igs")).unwrap();
    assert_eq!(file.unit.name, "mm");
    assert!(
        file.skipped.is_empty() && file.notes.is_empty(),
        "{:?}",
        file.notes
    );
    file.patches
}

#[test]
fn areas_are_those_of_the_closed_forms() {
    let sum = |label: &str| -> f64 {
        let of = punch()
            .into_iter()
            .filter(|p| p.name.as_deref() == Some(label));
        of.map(|p| area(&p.patch)).sum()
    };
    let straight = 2.0 * 24.0 + 2.0 * 14.0;
    let expected = [
        ("bottom", 30.0 * 20.0 - (4.0 - PI) * 9.0),
        ("fillet", straight * 5.0 * PI / 2.0),
        // Torus of radii 3 and 5: integral of (3 + 5 cos p) 5 over p from -90 to 0 degrees, and over a full turn.
        ("corner", 2.0 * PI * (3.0 * 5.0 * PI / 2.0 + 25.0)),
        ("wall", 10.0 * (straight + 2.0 * PI * 8.0)),
    ];
    for (label, reference) in expected {
        let found = sum(label);
        // The quadrature is exact to rounding here; the file has 16 digits.
        assert!(
            (found / reference - 1.0).abs() < 1e-12,
            "{label}: {found} for {reference}"
        );
    }
}

#[test]
fn box_is_that_of_the_drawing() {
    let corner = |pick: fn(f64, f64) -> f64, which: usize| {
        punch()
            .iter()
            .map(|p| p.patch.bounds()[which])
            .reduce(|a, b| a.zip_map(&b, pick))
            .unwrap()
    };
    assert!((corner(f64::min, 0) - Vec3::new(-20.0, -15.0, 0.0)).norm() < 1e-12);
    assert!((corner(f64::max, 1) - Vec3::new(20.0, 15.0, 15.0)).norm() < 1e-12);
}

struct Edge {
    patch: usize,
    points: [Vec3; 5],
    normals: [Vec3; 5],
}

fn edges(patches: &[CadPatch]) -> Vec<Edge> {
    let edge = |patch: &NurbsPatch, dir: usize, end: usize| {
        let domain = patch.domain();
        std::array::from_fn::<_, 5, _>(|k| {
            let mut xi = [0.0; 2];
            xi[dir] = domain[dir][end];
            let [a, b] = domain[1 - dir];
            xi[1 - dir] = a + (b - a) * k as f64 / 4.0;
            let jet = patch.jet(xi);
            let normal = jet.rho_i[0].cross(&jet.rho_i[1]);
            assert!(normal.norm() > 1e-3, "degenerate at {:?}", jet.rho);
            (jet.rho, normal.normalize())
        })
    };
    let mut edges = Vec::new();
    for (index, p) in patches.iter().enumerate() {
        for (dir, end) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let samples = edge(&p.patch, dir, end);
            edges.push(Edge {
                patch: index,
                points: samples.map(|s| s.0),
                normals: samples.map(|s| s.1),
            });
        }
    }
    edges
}

#[test]
fn edges_are_shared_whole_and_smoothly() {
    let patches = punch();
    assert_eq!(patches.len(), 45);
    let edges = edges(&patches);
    let mut rim = 0;
    for edge in &edges {
        let mut partners = 0;
        for other in edges.iter().filter(|o| o.patch != edge.patch) {
            for back in [false, true] {
                let at = |k: usize| if back { 4 - k } else { k };
                if (0..5).all(|k| (edge.points[k] - other.points[at(k)]).norm() < 1e-9) {
                    partners += 1;
                    for k in 0..5 {
                        let turn = (edge.normals[k] - other.normals[at(k)]).norm();
                        assert!(
                            turn < 1e-12,
                            "normals differ by {turn} at {:?}",
                            edge.points[k]
                        );
                    }
                }
            }
        }
        let on_rim = edge.points.iter().all(|x| (x.z - 15.0).abs() < 1e-12);
        rim += usize::from(on_rim);
        assert_eq!(
            partners,
            usize::from(!on_rim),
            "edge at {:?}",
            edge.points[2]
        );
    }
    // Four straight walls and two pieces in each of four corners.
    assert_eq!(rim, 12);
}

#[test]
fn normals_point_out_of_the_punch() {
    for p in punch() {
        let [[a, b], [c, d]] = p.patch.domain();
        let jet = p.patch.jet([0.5 * (a + b), 0.5 * (c + d)]);
        let normal = jet.rho_i[0].cross(&jet.rho_i[1]).normalize();
        // The punch is convex and contains (0, 0, 10).
        let out = normal.dot(&(jet.rho - Vec3::new(0.0, 0.0, 10.0)));
        assert!(out > 1.0, "{:?} at {:?}", normal, jet.rho);
    }
}
