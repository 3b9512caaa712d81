//! Closest points on facets that move, against exhaustive searches.

use crate::common::*;
use covact_geometry::{
    CurvedRows, EdgeKind, MovingError, MovingFacets, MovingPlace, ShapeRows, Status, Vec3,
};
use num_dual::Dual64;

/// Sets of degree 1, 2, 3 with their meshes.
fn samples() -> Vec<(&'static str, Mesh, MovingFacets)> {
    let one = sheet([5, 4], 1);
    let closed = torus([8, 6], 1);
    let two = sheet([3, 3], 2);
    let three = sheet([5, 4], 1);
    let ring = torus([9, 7], 1);
    vec![
        ("bilinear sheet", one.faceted(), one),
        ("bilinear torus", closed.faceted(), closed),
        ("biquadratic sheet", two.faceted(), two),
        ("smooth sheet", three.smooth(), three),
        ("smooth torus", ring.smooth(), ring),
    ]
    .into_iter()
    .map(|(name, set, mesh)| (name, mesh, set))
    .collect()
}

/// A query near the facets: off a random point by up to `far`.
fn query(set: &MovingFacets, random: &mut Random, far: f64) -> Vec3 {
    let facet = (random.next() * set.len() as f64) as u32;
    let xi = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
    set.jet(facet, xi).rho + random.vector(far)
}

/// Ten random motions of every sample, queries near and far: no point is nearer than the foot.
#[test]
fn nothing_is_nearer() {
    let mut total = 0;
    for (name, mesh, mut set) in samples() {
        let mut random = Random(17);
        let mut unsure = 0;
        for motion in 0..10 {
            let moved = mesh.deformed(0.15, 0.06, motion);
            set.update(|k| moved[k as usize]);
            for k in 0..12 {
                let q = query(&set, &mut random, [0.02, 0.3, 2.0][k % 3]);
                let foot = set.project(&q, None, f64::INFINITY, |_| true).unwrap();
                check_foot(&set, &q, &foot);
                let truth = exhaustive(&set, &q, |_| true);
                assert!(
                    foot.distance <= truth + 1e-9 * set.size(),
                    "{name}, motion {motion}: {q:?} {} {truth}",
                    foot.distance
                );
                unsure += usize::from(foot.status == Status::NotConverged);
                total += 1;
            }
        }
        assert_eq!(unsure, 0, "{name}");
    }
    assert_eq!(total, 600);
}

/// The foot does not depend on the hint, be it near, far, wrong or no use; nor on a reach that it is within.
#[test]
fn hints_do_not_matter() {
    for (name, mesh, mut set) in samples() {
        let mut random = Random(4);
        let moved = mesh.deformed(0.2, 0.03, 2);
        set.update(|k| moved[k as usize]);
        for _ in 0..30 {
            let q = query(&set, &mut random, 0.3);
            let cold = set.project(&q, None, f64::INFINITY, |_| true).unwrap();
            let anywhere = (random.next() * set.len() as f64) as u32;
            let hints = [
                Some(cold.hint()),
                hint(anywhere, [random.between(-1.0, 1.0), 0.3]),
                hint(u32::MAX, [0.0; 2]),
                hint(0, [f64::NAN, 0.0]),
                hint(0, [5.0, -7.0]),
            ];
            for hint in hints {
                for reach in [f64::INFINITY, cold.distance * 1.0001] {
                    let foot = set.project(&q, hint, reach, |_| true).unwrap();
                    let off = (foot.jet.rho - cold.jet.rho).norm();
                    assert!(
                        off <= 1e-9 * set.size(),
                        "{name}: {hint:?} {off:e} {foot:?} {cold:?}"
                    );
                    assert!(
                        (foot.signed_distance - cold.signed_distance).abs() <= 1e-12 * set.size()
                    );
                }
            }
            assert!(
                set.project(&q, None, cold.distance * 0.999, |_| true)
                    .is_none()
            );
        }
    }
}

/// Facets that are refused do not exist: the nearest of the others is found, and edges to them are borders.
#[test]
fn refused_facets_do_not_exist() {
    let mut borders = 0;
    for (name, mesh, mut set) in samples() {
        let mut random = Random(9);
        let moved = mesh.deformed(0.15, 0.03, 7);
        set.update(|k| moved[k as usize]);
        for _ in 0..12 {
            let q = query(&set, &mut random, 0.2);
            let first = set.project(&q, None, f64::INFINITY, |_| true).unwrap();
            let near = set.neighbours(first.facet);
            assert!(!near.is_empty() && !near.contains(&first.facet));
            let accept = |f: u32| f != first.facet && !near.contains(&f);
            let hints = [None, Some(first.hint())];
            let feet = hints.map(|h| set.project(&q, h, f64::INFINITY, accept));
            for foot in feet.into_iter().flatten() {
                assert!(accept(foot.facet));
                let truth = exhaustive(&set, &q, accept);
                assert!(foot.distance <= truth + 1e-9 * set.size(), "{name}");
                borders += usize::from(matches!(
                    foot.place,
                    MovingPlace::Edge {
                        kind: EdgeKind::Free,
                        ..
                    } | MovingPlace::Corner {
                        kind: EdgeKind::Free
                    }
                ));
            }
        }
        assert!(
            set.project(&Vec3::zeros(), None, f64::INFINITY, |_| false)
                .is_none()
        );
    }
    assert!(borders > 50, "{borders}");
}

/// Winding number of a closed set of facets about a point: the sum of the solid angles of triangles (A. Van Oosterom and J.
/// Strackee, IEEE Trans. Biomed. Eng. 30, 1983) over four pi.
fn winding(set: &MovingFacets, q: &Vec3, steps: usize) -> f64 {
    let mut sum = 0.0;
    for facet in 0..set.len() as u32 {
        for k in 0..steps * steps {
            let at = |i: usize, j: usize| {
                let xi =
                    [k % steps + i, k / steps + j].map(|k| 2.0 * k as f64 / steps as f64 - 1.0);
                set.jet(facet, xi).rho - q
            };
            let x = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            for [a, b, c] in [[x[0], x[1], x[3]], [x[0], x[3], x[2]]] {
                let (l, m, n) = (a.norm(), b.norm(), c.norm());
                let below = l * m * n + a.dot(&b) * n + b.dot(&c) * l + c.dot(&a) * m;
                sum += 2.0 * a.dot(&b.cross(&c)).atan2(below);
            }
        }
    }
    sum / (4.0 * std::f64::consts::PI)
}

/// On closed sets the sign is that of the winding number, at edges and corners too.
#[test]
fn signs_are_right() {
    let mut seen = [0; 3];
    let box_mesh = cube(2);
    let ring = torus([9, 7], 1);
    let two = torus([5, 4], 2);
    let sets = [
        (box_mesh.faceted(), &box_mesh),
        (box_mesh.smooth(), &box_mesh),
        (ring.faceted(), &ring),
        (ring.smooth(), &ring),
        (two.faceted(), &two),
    ];
    for (mut set, mesh) in sets {
        let mut random = Random(21);
        let moved = mesh.deformed(0.08, 0.03, 3);
        set.update(|k| moved[k as usize]);
        let mut insides = 0;
        for _ in 0..120 {
            let q = query(&set, &mut random, 0.5);
            let foot = set.project(&q, None, f64::INFINITY, |_| true).unwrap();
            check_foot(&set, &q, &foot);
            // Chords of the triangles are off the surface.
            if foot.distance < 0.05 {
                continue;
            }
            let inside = winding(&set, &q, 5) > 0.5;
            assert_eq!(foot.signed_distance < 0.0, inside, "{q:?} {foot:?}");
            insides += usize::from(inside);
            match foot.place {
                MovingPlace::Face => seen[0] += 1,
                MovingPlace::Edge { kind, direction } => {
                    seen[1] += 1;
                    assert_eq!(kind, EdgeKind::Sharp);
                    let along = foot.jet.rho_i[0] * direction[0] + foot.jet.rho_i[1] * direction[1];
                    assert!(along.dot(&(q - foot.jet.rho)).abs() < 1e-10 * along.norm());
                }
                MovingPlace::Corner { kind } => {
                    seen[2] += 1;
                    assert_eq!(kind, EdgeKind::Sharp);
                }
            }
        }
        assert!(insides > 15, "{insides}");
    }
    assert!(seen.iter().all(|&n| n > 10), "{seen:?}");
}

/// Faces, edges and corners of a box by construction.
#[test]
fn places_of_a_box() {
    let mesh = cube(2);
    let mut set = mesh.faceted();
    set.update(|k| mesh.nodes[k as usize]);
    let sharp = EdgeKind::Sharp;
    let corner = Vec3::repeat(1.0 / 3f64.sqrt());
    let edge = Vec3::new(1.0, 0.0, 1.0) / 2f64.sqrt();
    for (q, place, normal, distance) in [
        ([0.3, 0.2, 1.5], MovingPlace::Face, Vec3::z(), 0.5),
        // On the edge and the node in the middle of a side, where the surface runs on.
        ([0.5, 0.2, 1.5], MovingPlace::Face, Vec3::z(), 0.5),
        ([0.5, 0.5, 1.5], MovingPlace::Face, Vec3::z(), 0.5),
        ([0.4, 0.45, 0.8], MovingPlace::Face, Vec3::z(), -0.2),
        (
            [1.3, 0.3, 1.4],
            MovingPlace::Edge {
                direction: [0.0, 1.0],
                kind: sharp,
            },
            edge,
            0.5,
        ),
        (
            [1.2, 1.6, 1.3],
            MovingPlace::Corner { kind: sharp },
            corner,
            0.7,
        ),
    ] {
        let foot = set
            .project(&q.into(), None, f64::INFINITY, |_| true)
            .unwrap();
        match (foot.place, place) {
            (MovingPlace::Edge { kind: a, .. }, MovingPlace::Edge { kind: b, .. }) => {
                assert_eq!(a, b)
            }
            (a, b) => assert_eq!(a, b, "{q:?}"),
        }
        assert!(
            (foot.normal - normal).norm() < 1e-12,
            "{q:?} {}",
            foot.normal
        );
        assert!((foot.signed_distance - distance).abs() < 1e-12, "{q:?}");
        assert_eq!(foot.status, Status::Unique);
    }
    // Without the far side its border is free.
    let top = |f: u32| {
        (0..4).all(|c| {
            let xi = [c & 1, c >> 1].map(|k| 2.0 * f64::from(k) - 1.0);
            set.jet(f, xi).rho.z == 1.0
        })
    };
    let foot = set
        .project(&Vec3::new(1.3, 0.3, 1.4), None, f64::INFINITY, top)
        .unwrap();
    assert!(matches!(
        foot.place,
        MovingPlace::Edge {
            kind: EdgeKind::Free,
            ..
        }
    ));
    assert_eq!(foot.normal, Vec3::z());
    assert!((foot.signed_distance - 0.5).abs() < 1e-12);
}

/// After a large motion a set that was refitted gives what a new one gives.
#[test]
fn refitting_is_as_good_as_building() {
    for (name, mesh, mut set) in samples() {
        set.update(|k| mesh.nodes[k as usize]);
        let mut random = Random(31);
        // Turned inside out and scaled.
        let moved: Vec<Vec3> = (mesh.deformed(0.3, 0.02, 1).iter())
            .map(|x| Vec3::new(-x.y, 2.0 * x.z, x.x) + Vec3::new(100.0, 0.0, -50.0))
            .collect();
        set.update(|k| moved[k as usize]);
        let mut fresh = match name.starts_with("smooth") {
            true => mesh.smooth(),
            false => mesh.faceted(),
        };
        fresh.update(|k| moved[k as usize]);
        for _ in 0..20 {
            let q = query(&set, &mut random, 0.5);
            let feet =
                [&set, &fresh].map(|s| s.project(&q, None, f64::INFINITY, |_| true).unwrap());
            let off = (feet[0].jet.rho - feet[1].jet.rho).norm();
            assert!(off <= 1e-10 * set.size(), "{name}");
            assert!((feet[0].distance - feet[1].distance).abs() <= 1e-12 * set.size());
            check_foot(&set, &q, &feet[0]);
        }
    }
}

/// Shape functions of facets as given: they sum to one, make the jet, and are those of the finite elements.
#[test]
fn shape_functions_of_facets() {
    let (mut rows, mut curved) = (ShapeRows::default(), CurvedRows::default());
    let mut most = 0.0f64;
    for (_, mesh, mut set) in samples() {
        let moved = mesh.deformed(0.2, 0.05, 3);
        set.update(|k| moved[k as usize]);
        for facet in [0, set.len() as u32 - 1] {
            for xi in [[0.3, -0.8], [-1.0, 1.0], [0.0, 0.45]] {
                set.shape(facet, xi, &mut rows);
                check_shape(&set, facet, xi, &rows, |k| moved[k as usize]);
                set.curved_shape(facet, xi, &mut curved);
                assert_eq!(curved.rows, rows);
                let second = [&curved.n_11, &curved.n_12, &curved.n_22];
                for (n, rho) in second.iter().zip(set.jet(facet, xi).rho_ij) {
                    let sum = (set.nodes(facet).iter().zip(n.iter()))
                        .fold(Vec3::zeros(), |s, (k, n)| s + moved[*k as usize] * *n);
                    let largest = n.iter().fold(0.0f64, |m, n| m.max(n.abs()));
                    assert!(n[..rows.count].iter().sum::<f64>().abs() < 1e-13);
                    assert!((sum - rho).norm() < 1e-12 * set.size(), "{facet} {xi:?}");
                    most = most.max(largest);
                }
            }
        }
    }
    assert!(most > 0.1);
    // Nine, six and four nodes in one set, against Lagrange polynomials with dual numbers.
    let lagrange = |count: u8, x: Dual64| -> Vec<Dual64> {
        let (half, one) = (Dual64::from(0.5), Dual64::from(1.0));
        match count {
            2 => vec![(one - x) * half, (one + x) * half],
            _ => vec![x * (x - 1.0) * half, one - x * x, x * (x + 1.0) * half],
        }
    };
    let lists: [(&[u32], [u8; 2]); 4] = [
        (&[0, 1, 2, 3, 4, 5, 6, 7, 8], [3, 3]),
        (&[10, 11, 12, 13, 14, 15], [3, 2]),
        (&[20, 21, 22, 23, 24, 25], [2, 3]),
        (&[30, 31, 32, 33], [2, 2]),
    ];
    let set = MovingFacets::new(&lists).unwrap();
    assert_eq!(set.degree(), 2);
    let xi = [0.37, -0.61];
    for (facet, (nodes, count)) in lists.iter().enumerate() {
        assert_eq!(set.nodes(facet as u32), *nodes);
        set.shape(facet as u32, xi, &mut rows);
        for (dir, found) in [&rows.n_1, &rows.n_2].into_iter().enumerate() {
            let seed = |k: usize| Dual64::new(xi[k], f64::from(u8::from(k == dir)));
            let (a, b) = (lagrange(count[0], seed(0)), lagrange(count[1], seed(1)));
            for k in 0..nodes.len() {
                let exact = a[k % a.len()] * b[k / a.len()];
                assert!(exact.re != 0.0 && exact.eps != 0.0);
                assert!((rows.n[k] - exact.re).abs() < 1e-14);
                assert!((found[k] - exact.eps).abs() < 1e-14);
            }
        }
    }
}

/// Degenerate facets, facets that are not finite, and numbers past the end do no harm.
#[test]
fn odd_facets() {
    // A triangle fan about node 0, a facet that is a line, one that is a point.
    let facets: [(&[u32], [u8; 2]); 5] = [
        (&[0, 0, 1, 2], [2, 2]),
        (&[0, 0, 2, 3], [2, 2]),
        (&[0, 0, 3, 4], [2, 2]),
        (&[5, 6, 5, 6], [2, 2]),
        (&[7, 7, 7, 7], [2, 2]),
    ];
    let position = |k: u32| match k {
        0 => Vec3::new(0.0, 0.0, 0.4),
        1..=4 => {
            let a = -2.0 * f64::from(k);
            Vec3::new(a.cos(), a.sin(), 0.0)
        }
        _ => Vec3::new(f64::from(k), 3.0, 0.0),
    };
    for mut set in [
        MovingFacets::new(&facets).unwrap(),
        MovingFacets::smooth(&facets, position).unwrap(),
    ] {
        assert!(
            set.project(&Vec3::zeros(), None, f64::INFINITY, |_| true)
                .is_none()
        );
        set.update(position);
        let mut random = Random(6);
        for k in 0..60 {
            let q = random.vector([1.0, 8.0][k % 2]);
            let foot = set.project(&q, None, f64::INFINITY, |_| true).unwrap();
            let truth = exhaustive(&set, &q, |_| true);
            assert!(foot.distance <= truth + 1e-7, "{q:?} {foot:?} {truth}");
        }
        let tip = set
            .project(&Vec3::new(0.0, 0.0, 2.0), None, f64::INFINITY, |f| f < 3)
            .unwrap();
        assert!(
            (tip.distance - 1.6).abs() < 1e-9 && tip.signed_distance > 0.0,
            "{tip:?}"
        );
        assert_eq!(
            set.project(&Vec3::repeat(f64::NAN), None, 1.0, |_| true),
            None
        );
        // One node lost: the facets without it are still there.
        set.update(|k| {
            if k == 4 {
                Vec3::repeat(f64::INFINITY)
            } else {
                position(k)
            }
        });
        let foot = set.project(&Vec3::new(5.2, 3.1, 0.0), hint(2, [0.0; 2]), 9.0, |_| true);
        assert!((foot.unwrap().distance - 0.1).abs() < 1e-12);
        assert_eq!(set.nodes(99), &[] as &[u32]);
        assert_eq!(set.neighbours(99), &[] as &[u32]);
        assert_eq!(set.jet(99, [0.0; 2]).rho, Vec3::zeros());
        let mut rows = ShapeRows::default();
        set.shape(99, [0.0; 2], &mut rows);
        assert_eq!(rows.count, 0);
    }
}

#[test]
fn bad_input_is_named() {
    let bad = |facets: &[(&[u32], [u8; 2])]| MovingFacets::new(facets).err().unwrap();
    assert_eq!(bad(&[]), MovingError::Empty);
    assert_eq!(
        bad(&[(&[0, 1, 2, 3], [2, 2]), (&[0, 1, 2, 3], [4, 1])]),
        MovingError::Count {
            facet: 1,
            count: [4, 1]
        }
    );
    assert_eq!(
        bad(&[(&[0, 1, 2, 3], [3, 2])]),
        MovingError::Nodes {
            facet: 0,
            count: [3, 2],
            found: 4
        }
    );
    // The second facet is numbered the other way round.
    assert_eq!(
        bad(&[(&[0, 1, 2, 3], [2, 2]), (&[4, 1, 5, 3], [2, 2])]),
        MovingError::Flipped(0, 1)
    );
    assert!(MovingFacets::new(&[(&[0, 1, 2, 3], [2, 2]), (&[1, 4, 3, 5], [2, 2])]).is_ok());
}
