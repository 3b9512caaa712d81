//! The smooth surface over a mesh: continuity, planes, order of convergence, shape functions.

use std::f64::consts::TAU;

use crate::common::*;
use covact_geometry::moving::MAX;
use covact_geometry::{MovingError, MovingFacets, ShapeRows, Vec3};

fn normal(set: &MovingFacets, facet: u32, xi: [f64; 2]) -> Vec3 {
    let jet = set.jet(facet, xi);
    jet.rho_i[0].cross(&jet.rho_i[1]).normalize()
}

/// Largest gap and largest angle between normals over all common edges of facets of a mesh of quadrilaterals, at nine points
/// of each; and the number of edges.
fn jumps(mesh: &Mesh, set: &MovingFacets) -> (f64, f64, usize) {
    let ends = [[0, 2], [1, 3], [0, 1], [2, 3]];
    let place = |edge: usize, s: f64| match edge {
        0 => [-1.0, s],
        1 => [1.0, s],
        2 => [s, -1.0],
        _ => [s, 1.0],
    };
    let mut first = std::collections::HashMap::new();
    let (mut gap, mut angle, mut count) = (0.0f64, 0.0f64, 0);
    for (facet, nodes) in mesh.facets.iter().enumerate() {
        for (edge, [a, b]) in ends.iter().enumerate() {
            let (a, b) = (nodes[*a], nodes[*b]);
            let Some((other, other_edge, start)) =
                first.insert((a.min(b), a.max(b)), (facet, edge, a))
            else {
                continue;
            };
            count += 1;
            for k in 0..9 {
                let s = k as f64 / 4.0 - 1.0;
                let t = if start == a { s } else { -s };
                let (x, y) = (place(edge, s), place(other_edge, t));
                let (p, q) = (set.jet(facet as u32, x).rho, set.jet(other as u32, y).rho);
                gap = gap.max((p - q).norm());
                let (n, m) = (normal(set, facet as u32, x), normal(set, other as u32, y));
                angle = angle.max(n.cross(&m).norm().atan2(n.dot(&m)));
            }
        }
    }
    (gap, angle, count)
}

/// On a structured mesh, uneven and curved, and after any motion of its nodes, the surface is continuous with its tangent
/// planes to rounding.
#[test]
fn structured_meshes_have_continuous_normals() {
    let uneven = |t: f64| t + 0.08 * (TAU * t).sin();
    let sheet = Mesh::grid([7, 5], 1, [false; 2], |u, v| {
        let (u, v) = (u.powf(1.3), uneven(v));
        Vec3::new(
            3.0 * u + 0.2 * v,
            2.0 * v,
            0.5 * (4.0 * u).sin() * (3.0 * v).cos(),
        )
    });
    for (name, mesh) in [("sheet", sheet), ("torus", torus([12, 10], 1))] {
        let mut set = mesh.smooth();
        for moved in [mesh.nodes.clone(), mesh.deformed(0.2, 0.03, 5)] {
            set.update(|k| moved[k as usize]);
            let (gap, angle, count) = jumps(&mesh, &set);
            assert!(count >= 58, "{count}");
            assert!(gap < 1e-14 && angle < 2e-13, "{name}: {gap:e} {angle:e}");
            for (facet, nodes) in mesh.facets.iter().enumerate() {
                for (c, &node) in nodes.iter().enumerate() {
                    let xi = [c & 1, c >> 1].map(|k| 2.0 * k as f64 - 1.0);
                    let off = set.jet(facet as u32, xi).rho - moved[node as usize];
                    assert!(off.norm() < 1e-14);
                }
            }
        }
    }
}

/// Where three facets meet (the corners of a cube blown up to a sphere) normals differ a little away from the nodes, not at
/// them, and less on finer meshes.
#[test]
fn irregular_meshes_have_small_jumps() {
    let mut last = f64::INFINITY;
    for n in [4, 8, 16] {
        let mesh = ball(n);
        let mut set = mesh.smooth();
        set.update(|k| mesh.nodes[k as usize]);
        let (gap, angle, count) = jumps(&mesh, &set);
        eprintln!(
            "ball {n}: {count} edges, normals turn by {:.3} degrees at most",
            angle.to_degrees()
        );
        assert_eq!(count, 12 * n * n);
        assert!(gap < 1e-14);
        assert!(angle < 0.6 * last, "{n}: {angle}");
        last = angle;
    }
}

/// A cube blown up to the unit sphere, its edges no creases.
fn ball(n: usize) -> Mesh {
    let mut mesh = cube(n);
    for x in &mut mesh.nodes {
        let p = *x * 2.0 - Vec3::repeat(1.0);
        // Even angles.
        *x = p
            .map(|t| (t * std::f64::consts::FRAC_PI_4).tan())
            .normalize();
    }
    mesh
}

/// Nodes in a plane make the plane, whatever the mesh.
#[test]
fn planes_are_planes() {
    let mut random = Random(3);
    let sheet = sheet([5, 4], 1);
    let meshes = [sheet, ball(3), cube(2)];
    for mesh in meshes {
        let mut set = mesh.smooth();
        let flat: Vec<Vec3> = (mesh.nodes.iter())
            .map(|x| {
                Vec3::new(
                    x.x + 0.1 * random.next(),
                    x.y - 0.3 * x.z,
                    2.0 * x.x - x.y + 0.6 * x.z,
                )
            })
            .map(|x| Vec3::new(x.x, x.y, 2.0 * x.x - x.y))
            .collect();
        set.update(|k| flat[k as usize]);
        for facet in 0..set.len() as u32 {
            for xi in [[0.1, 0.7], [-0.9, 0.3], [1.0, 0.5]] {
                let p = set.jet(facet, xi).rho;
                assert!((p.z - 2.0 * p.x + p.y).abs() < 1e-13);
            }
        }
    }
}

/// Largest distance of a surface from the one it stands for.
fn error(set: &MovingFacets, distance: impl Fn(&Vec3) -> f64) -> f64 {
    let mut worst = 0.0f64;
    for facet in 0..set.len() as u32 {
        for k in 0..25 {
            let xi = [k % 5, k / 5].map(|k| k as f64 / 2.0 - 1.0);
            worst = worst.max(distance(&set.jet(facet, xi).rho).abs());
        }
    }
    worst
}

/// Rates of the distance from cylinder, sphere and torus under refinement: 4 where a circle is sampled evenly; 3 on a sphere
/// whose mesh has nodes of three facets and lines with kinks, which is approached from below (2.6, 2.8, 2.9 with 8, 16, 32, 64
/// facets along an edge of the cube).
#[test]
fn curved_surfaces_converge() {
    let cylinder = |n: usize| {
        Mesh::grid([2 * n, n], 1, [true, false], |u, v| {
            Vec3::new((TAU * u).cos(), (TAU * u).sin(), 2.0 * v)
        })
    };
    // A quarter, with borders along the circle's ends.
    let quarter = |n: usize| {
        Mesh::grid([n, n], 1, [false; 2], |u, v| {
            let a = 0.25 * TAU * u;
            Vec3::new(a.cos(), a.sin(), v)
        })
    };
    let radial = |p: &Vec3| p.x.hypot(p.y) - 1.0;
    let round = |p: &Vec3| p.norm() - 1.0;
    let ring = |p: &Vec3| (p.x.hypot(p.y) - 2.0).hypot(p.z) - 0.7;
    type Case<'a> = (
        &'a str,
        &'a dyn Fn(usize) -> Mesh,
        &'a dyn Fn(&Vec3) -> f64,
        f64,
    );
    let cases: [Case; 4] = [
        ("cylinder", &cylinder, &radial, 3.9),
        ("quarter of a cylinder", &quarter, &radial, 3.9),
        ("torus", &|n| torus([2 * n, n], 1), &ring, 3.8),
        ("sphere", &ball, &round, 2.7),
    ];
    for (name, mesh, distance, least) in cases {
        let errors = [8, 16, 32].map(|n| {
            let mesh = mesh(n);
            let mut set = mesh.smooth();
            set.update(|k| mesh.nodes[k as usize]);
            error(&set, distance)
        });
        let rates = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        eprintln!("{name}: errors {errors:?} rates {rates:.2?}");
        assert!(
            errors[2] > 1e-9 && rates[1] >= least,
            "{name}: {errors:?} {rates:?}"
        );
    }
}

/// Sharp edges of the reference stay sharp: the faces of a cube stay plane, and move apart only as their nodes do.
#[test]
fn sharp_edges_stay() {
    let mesh = cube(3);
    let mut set = mesh.smooth();
    set.update(|k| mesh.nodes[k as usize]);
    let (gap, angle, _) = jumps(&mesh, &set);
    assert!(gap < 1e-14 && (angle - 0.25 * TAU).abs() < 1e-12);
    for facet in 0..set.len() as u32 {
        let n = normal(&set, facet, [0.3, -0.4]);
        assert!((n.amax() - 1.0).abs() < 1e-12, "{n}");
    }
    // With a larger angle the cube is rounded off.
    let mut round =
        MovingFacets::smooth_with(&mesh.list(), |k| mesh.nodes[k as usize], 2.0).unwrap();
    round.update(|k| mesh.nodes[k as usize]);
    let angle = jumps(&mesh, &round).1;
    assert!(angle < 0.6, "{angle}");
}

/// Shape functions: they sum to one, their combination of the nodes is the point, and they do not change.
#[test]
fn shape_functions() {
    let mut rows = ShapeRows::default();
    for mesh in [sheet([4, 3], 1), ball(3), torus([6, 5], 1)] {
        let mut set = mesh.smooth();
        let moved = mesh.deformed(0.3, 0.02, 8);
        set.update(|k| moved[k as usize]);
        for facet in 0..set.len() as u32 {
            assert!(set.nodes(facet).len() <= MAX);
            assert_eq!(set.nodes(facet)[..4], mesh.facets[facet as usize][..]);
            for xi in [[0.2, -0.6], [1.0, -1.0], [-0.3, 0.9]] {
                set.shape(facet, xi, &mut rows);
                check_shape(&set, facet, xi, &rows, |k| moved[k as usize]);
            }
        }
    }
    // Regular facets share one operator, so all have the same shape functions.
    let mesh = sheet([6, 6], 1);
    let set = Mesh {
        nodes: mesh
            .nodes
            .iter()
            .map(|x| Vec3::new(x.x, x.y, 0.0))
            .collect(),
        ..mesh
    }
    .smooth();
    let mut other = ShapeRows::default();
    set.shape(14, [0.3, 0.4], &mut rows);
    set.shape(21, [0.3, 0.4], &mut other);
    assert_eq!(rows.count, 16);
    assert_eq!(rows, other);
}

/// Facets with middle nodes are cut there.
#[test]
fn middle_nodes_cut_facets() {
    let mesh = sheet([3, 2], 2);
    let mut set = mesh.smooth();
    assert_eq!(set.len(), 24);
    assert_eq!(
        (set.source(3), set.source(4), set.source(23), set.source(24)),
        (0, 1, 5, u32::MAX)
    );
    set.update(|k| mesh.nodes[k as usize]);
    // The same surface as that over the mesh of all nodes: the same facets, numbered otherwise.
    let fine = sheet([6, 4], 1);
    let mut other = fine.smooth();
    other.update(|k| fine.nodes[k as usize]);
    for (source, quarter, facet) in [(0, 3, 7), (4, 1, 15)] {
        let (a, b) = (
            set.jet(4 * source + quarter, [0.2, 0.3]),
            other.jet(facet, [0.2, 0.3]),
        );
        assert!((a.rho - b.rho).norm() < 1e-14 && (a.rho_i[0] - b.rho_i[0]).norm() < 1e-13);
    }
}

/// Poles are allowed where the stencil is small enough, and named where it is not.
#[test]
fn poles() {
    let cap = |n: u32| {
        let facets: Vec<Vec<u32>> = (0..n).map(|k| vec![0, 0, 1 + k, 1 + (k + 1) % n]).collect();
        let position = move |k: u32| match k {
            0 => Vec3::new(0.0, 0.0, 0.3),
            k => {
                let a = TAU * f64::from(k - 1) / f64::from(n);
                Vec3::new(a.cos(), -a.sin(), 0.0)
            }
        };
        let list: Vec<(&[u32], [u8; 2])> = facets.iter().map(|f| (&f[..], [2, 2])).collect();
        MovingFacets::smooth(&list, position).map(|mut set| {
            set.update(position);
            set
        })
    };
    let set = cap(6).unwrap();
    let foot = set
        .project(&Vec3::new(0.1, 0.05, 1.0), None, f64::INFINITY, |_| true)
        .unwrap();
    assert!(
        foot.distance < 0.75 && foot.signed_distance > 0.0,
        "{foot:?}"
    );
    assert!(
        matches!(cap(40).err(), Some(MovingError::Stencil { count: 41, .. })),
        "{:?}",
        cap(40).err()
    );
}

#[test]
fn positions_must_be_finite() {
    let mesh = sheet([2, 2], 1);
    let bad = MovingFacets::smooth(&mesh.list(), |k| {
        if k == 3 {
            Vec3::repeat(f64::NAN)
        } else {
            mesh.nodes[k as usize]
        }
    });
    assert_eq!(bad.err(), Some(MovingError::Position(3)));
}
