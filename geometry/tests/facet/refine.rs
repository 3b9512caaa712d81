//! Facets of smooth surfaces: distance, normals, areas, shared nodes.

use covact_geometry::facet::{
    FacetError, Faceted, Refinement, bilinear_facets, biquadratic_facets, facet_patch,
};
use covact_geometry::primitives::{cylinder, plane, sphere, sphere_without_poles, torus};
use covact_geometry::{Frame, Location, NurbsPatch, PatchSet, Surface, Vec3};
use std::collections::HashMap;

const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// Largest value of `f` at `n` by `n` points inside of every facet.
fn largest<S: Surface>(facets: &[S], n: usize, f: impl Fn(&covact_geometry::Jet) -> f64) -> f64 {
    let mut out = 0.0f64;
    for facet in facets {
        for k in 0..n * n {
            let xi = [k % n, k / n].map(|i| (2 * i + 1) as f64 / n as f64 - 1.0);
            out = out.max(f(&facet.jet(xi)));
        }
    }
    out
}

fn area<S: Surface>(facets: &[S]) -> f64 {
    let mut sum = 0.0;
    for facet in facets {
        for (s, v) in GAUSS {
            for (r, w) in GAUSS {
                let [a, b] = facet.jet([r, s]).rho_i;
                sum += v * w * a.cross(&b).norm();
            }
        }
    }
    sum
}

/// Distance from a torus about the z axis, and its normal there.
fn from_torus(x: &Vec3, major: f64, minor: f64) -> (f64, Vec3) {
    let ring = Vec3::new(x.x, x.y, 0.0).normalize() * major;
    let out = x - ring;
    ((out.norm() - minor).abs(), out.normalize())
}

/// `[distance, angle of normals, area error, curvature error]` for `n` facets per span.
fn torus_errors<S: Surface>(facets: &[S], h: impl Fn(&covact_geometry::Jet) -> f64) -> [f64; 4] {
    let exact = 4.0 * std::f64::consts::PI.powi(2) * 3.0;
    [
        largest(facets, 4, |j| from_torus(&j.rho, 3.0, 1.0).0),
        largest(facets, 4, |j| {
            let n = Frame::new(j, 1.0).unwrap().n;
            let m = from_torus(&j.rho, 3.0, 1.0).1;
            n.cross(&m).norm().atan2(n.dot(&m))
        }),
        (area(facets) - exact).abs() / exact,
        largest(facets, 4, h),
    ]
}

fn rates(errors: &[[f64; 4]]) -> Vec<[f64; 4]> {
    errors
        .windows(2)
        .map(|w| std::array::from_fn(|k| (w[0][k] / w[1][k]).log2()))
        .collect()
}

/// A torus of radii 3 and 1, exact distance, normal and area (4 pi^2 3). Interpolation of degree p gives: distance p + 1,
/// normals p, curvature (of degree 2) p - 1; areas 2 p, as the part of the error that is odd within a facet cancels. All rates must be within 0.15 of theory at the finest step. The
/// lines of a torus are lines of curvature, so its bilinear facets are plane: no curvature at all.
#[test]
fn rates_on_a_torus() {
    let set = facet_patch(torus(3.0, 1.0, Vec3::zeros(), Vec3::z()).unwrap()).unwrap();
    let (mut four, mut nine) = (Vec::new(), Vec::new());
    for n in [2, 4, 8, 16] {
        let facets = bilinear_facets(&set, Refinement::PerSpan(n)).unwrap();
        let facets = facets.mesh.surfaces().unwrap();
        four.push(torus_errors(&facets, |j| {
            let f = Frame::new(j, 1.0).unwrap();
            assert!(f.h[0] == 0.0 && f.h[2] == 0.0);
            f.h[1].abs() / (f.a[0] * f.a[2]).sqrt()
        }));
        let facets = biquadratic_facets(&set, Refinement::PerSpan(n)).unwrap();
        let facets = facets.mesh.surfaces().unwrap();
        nine.push(torus_errors(&facets, |j| {
            let f = Frame::new(j, 1.0).unwrap();
            (f.principal_curvatures()[0] + 1.0).abs()
        }));
    }
    println!("bilinear {four:?}\n{:?}", rates(&four));
    println!("biquadratic {nine:?}\n{:?}", rates(&nine));
    assert!(four.iter().all(|e| e[3] < 1e-12));
    let check = |found: [f64; 4], theory: &[f64]| {
        for (found, theory) in found.iter().zip(theory) {
            assert!((found - theory).abs() < 0.15, "{found} {theory}");
        }
    };
    check(rates(&four)[2], &[2.0, 1.0, 2.0]);
    check(rates(&nine)[2], &[3.0, 2.0, 4.0, 1.0]);
}

/// Where the middle node is the middle of a circular arc, the odd term of the interpolation error runs along the arc and the
/// distance has order 4: for the half angle a it is a^4 / 8 (1 - t^2) t^2 R to leading order, a^4 / 32 at t^2 = 1/2.
#[test]
fn arcs_have_order_four() {
    let mut errors = Vec::new();
    for n in [4, 8, 16] {
        let half = std::f64::consts::PI / f64::from(n);
        let x = std::array::from_fn(|k| {
            let angle = half * ((k % 3) as f64 - 1.0);
            Vec3::new(angle.cos(), angle.sin(), (k / 3) as f64)
        });
        let facet = [covact_geometry::Biquadratic::new(x).unwrap()];
        let error = largest(&facet, 41, |j| (j.rho.xy().norm() - 1.0).abs());
        errors.push(error / (half.powi(4) / 32.0));
    }
    println!("{errors:?}");
    assert!((errors[2] - 1.0).abs() < 0.02, "{errors:?}");
}

/// Graph of degree 3 with rounded weights, over about [0, 4]^2.
fn bumpy() -> NurbsPatch {
    let n = 7;
    let mut knots = vec![0.0; 3];
    knots.extend((0..=4).map(f64::from));
    knots.extend([4.0; 3]);
    let points: Vec<Vec3> = (0..n * n)
        .map(|k| {
            let (x, y) = ((k % n) as f64 * 4.0 / 6.0, (k / n) as f64 * 4.0 / 6.0);
            Vec3::new(
                x + 0.1 * y,
                y - 0.05 * x,
                (1.1 * x + 0.3).sin() * (0.9 * y).cos() + 0.2 * x * y,
            )
        })
        .collect();
    let weights: Vec<f64> = (0..n * n)
        .map(|k| 1.0 + 0.1 * ((k * 5) % 7) as f64)
        .collect();
    NurbsPatch::new(
        [3; 2],
        [knots.clone(), knots],
        [n; 2],
        &points,
        Some(&weights),
    )
    .unwrap()
}

/// `h_12` of bilinear facets, in the parameters of the patch, converges to that of the patch at the middles (rate 2); `h_11`
/// is zero whatever that of the patch.
#[test]
fn bilinear_facets_have_h12_only() {
    let patch = bumpy().with_domain([[1.0, 2.0], [2.0, 3.0]]).unwrap();
    let set = facet_patch(patch.clone()).unwrap();
    let mut errors = Vec::new();
    for n in [12, 24, 48] {
        let facets = bilinear_facets(&set, Refinement::PerSpan(n)).unwrap();
        let (mut error, mut size) = (0.0f64, 0.0f64);
        for (facet, origin) in facets.mesh.surfaces().unwrap().iter().zip(&facets.origin) {
            let [[a, b], [c, d]] = origin.domain;
            let exact = Frame::new(&patch.jet([0.5 * (a + b), 0.5 * (c + d)]), 1.0).unwrap();
            let found = Frame::new(&facet.jet([0.0; 2]), 1.0).unwrap();
            assert!(found.h[0] == 0.0 && found.h[2] == 0.0);
            error = error.max((found.h[1] * 4.0 / ((b - a) * (d - c)) - exact.h[1]).abs());
            size = size.max(exact.h[0].abs()).max(exact.h[1].abs());
        }
        assert!(size > 0.1);
        errors.push(error / size);
    }
    println!("{errors:?}");
    let rate = (errors[1] / errors[2]).log2();
    assert!(rate > 1.8 && errors[2] < 0.01, "{errors:?}");
}

/// How many facets have each edge, by its end nodes; edges that are a point are left out.
fn edges<const N: usize>(facets: &Faceted<N>) -> HashMap<[u32; 2], usize> {
    let p = if N == 4 { 1 } else { 2 };
    let mut out = HashMap::new();
    for f in &facets.mesh.facets {
        let [a, b, c, d] = [f[0], f[p], f[N - 1 - p], f[N - 1]];
        for [a, b] in [[a, b], [b, d], [d, c], [c, a]] {
            if a != b {
                *out.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
            }
        }
    }
    out
}

/// Every edge twice, and the Euler characteristic of the surface, from the corners of the facets.
fn closed<const N: usize>(facets: &Faceted<N>, euler: i64) {
    assert!(facets.cracks.is_empty() && facets.dropped == 0);
    let edges = edges(facets);
    assert!(edges.values().all(|&n| n == 2));
    let mut corners: Vec<u32> = edges.keys().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    let found = corners.len() as i64 - edges.len() as i64 + facets.mesh.facets.len() as i64;
    assert_eq!(found, euler);
}

/// The tolerance is kept, at more points than the refinement looks at, and not left unused.
fn chord<S: Surface, const N: usize>(
    facets: &[S],
    made: &Faceted<N>,
    tolerance: f64,
    distance: impl Fn(&Vec3) -> f64,
) {
    let found = largest(facets, 9, |j| distance(&j.rho));
    println!("{} facets, {found:e} of {tolerance:e}", facets.len());
    assert!(
        made.deviation <= tolerance && found <= tolerance,
        "{found:e}"
    );
    assert!(found >= tolerance / 3.0, "{found:e}");
}

/// Six-patch sphere and one-patch sphere with poles: tight, and within the chord tolerance.
#[test]
fn chord_tolerance_on_spheres() {
    let from_ball = |x: &Vec3| (x.norm() - 1.0).abs();
    let six = sphere_without_poles(1.0, Vec3::zeros(), Vec3::z()).unwrap();
    let six = PatchSet::new(six.to_vec(), None).unwrap();
    let one = facet_patch(sphere(1.0, Vec3::zeros(), Vec3::z()).unwrap()).unwrap();
    let tolerance = 1e-2;
    let made = bilinear_facets(&six, Refinement::Chord(tolerance)).unwrap();
    chord(&made.mesh.surfaces().unwrap(), &made, tolerance, from_ball);
    closed(&made, 2);
    let made = bilinear_facets(&one, Refinement::Chord(tolerance)).unwrap();
    chord(&made.mesh.surfaces().unwrap(), &made, tolerance, from_ball);
    closed(&made, 2);
    let tolerance = 1e-4;
    let made = biquadratic_facets(&six, Refinement::Chord(tolerance)).unwrap();
    chord(&made.mesh.surfaces().unwrap(), &made, tolerance, from_ball);
    closed(&made, 2);
    let made = biquadratic_facets(&one, Refinement::Chord(tolerance)).unwrap();
    chord(&made.mesh.surfaces().unwrap(), &made, tolerance, from_ball);
    closed(&made, 2);
}

/// The same on a torus, which has two seams.
#[test]
fn chord_tolerance_on_a_torus() {
    let ring = facet_patch(torus(3.0, 1.0, Vec3::zeros(), Vec3::z()).unwrap()).unwrap();
    let from_ring = |x: &Vec3| from_torus(x, 3.0, 1.0).0;
    let made = bilinear_facets(&ring, Refinement::Chord(0.02)).unwrap();
    chord(&made.mesh.surfaces().unwrap(), &made, 0.02, from_ring);
    closed(&made, 0);
    let made = biquadratic_facets(&ring, Refinement::Chord(1e-4)).unwrap();
    chord(&made.mesh.surfaces().unwrap(), &made, 1e-4, from_ring);
    closed(&made, 0);
}

/// A free-form patch, its distance measured by projection; one facet along the straight direction of a cylinder.
#[test]
fn chord_tolerance_on_open_surfaces() {
    let set = facet_patch(bumpy()).unwrap();
    let distance = |x: &Vec3| set.project(x, None, f64::INFINITY).unwrap().distance;
    let made = bilinear_facets(&set, Refinement::Chord(0.02)).unwrap();
    chord(&made.mesh.surfaces().unwrap(), &made, 0.02, distance);
    let made = biquadratic_facets(&set, Refinement::Chord(2e-3)).unwrap();
    chord(&made.mesh.surfaces().unwrap(), &made, 2e-3, distance);
    let set = facet_patch(cylinder(1.0, 5.0, Vec3::zeros(), Vec3::z()).unwrap()).unwrap();
    let made = bilinear_facets(&set, Refinement::Chord(1e-3)).unwrap();
    let distance = |x: &Vec3| (x.xy().norm() - 1.0).abs();
    chord(&made.mesh.surfaces().unwrap(), &made, 1e-3, distance);
    // Every facet is as long as the cylinder.
    assert_eq!(made.mesh.nodes.len(), 2 * made.mesh.facets.len());
}

/// A flat patch with a curved border: the chord tolerance holds for the border too. Ring of radii 1 and 2.
#[test]
fn borders_are_followed() {
    let ring = cylinder(1.0, 1.0, Vec3::zeros(), Vec3::z()).unwrap();
    let points: Vec<Vec3> = (ring.points().iter())
        .map(|x| Vec3::new(x.x * (1.5 + x.z), x.y * (1.5 + x.z), 0.0))
        .collect();
    let knots = [ring.knots(0).to_vec(), ring.knots(1).to_vec()];
    let ring = NurbsPatch::new([2, 1], knots, [9, 2], &points, Some(&ring.weights())).unwrap();
    let made = bilinear_facets(&facet_patch(ring).unwrap(), Refinement::Chord(1e-3)).unwrap();
    let area = area(&made.mesh.surfaces().unwrap());
    // A chord that is s off encloses 2/3 s per length less (outside) or more (inside).
    let exact = 3.0 * std::f64::consts::PI;
    assert!(
        (exact - area) / exact < 2e-3 && made.deviation > 3e-4,
        "{area} {exact}"
    );
}

/// Two squares whose common edge has different parameters on both sides.
#[test]
fn different_parameters_share_nodes() {
    let left = plane(Vec3::new(0.5, 0.5, 0.0), Vec3::z(), [1.0, 1.0]).unwrap();
    let knots = || vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let points: Vec<Vec3> = (0..9)
        .map(|k| Vec3::new(1.0 + [0.0, 0.3, 1.0][k % 3], [1.0, 0.7, 0.0][k / 3], 0.0))
        .collect();
    let right = NurbsPatch::new([2; 2], [knots(), knots()], [3; 2], &points, None).unwrap();
    let set = PatchSet::new(vec![left, right], None).unwrap();
    for n in [1, 3, 8] {
        let made = bilinear_facets(&set, Refinement::PerSpan(n)).unwrap();
        assert!(made.cracks.is_empty(), "{:?}", made.cracks);
        let counts = edges(&made);
        let free: f64 = (counts.iter().filter(|(_, n)| **n == 1))
            .map(|(&[a, b], _)| (made.mesh.nodes[a as usize] - made.mesh.nodes[b as usize]).norm())
            .sum();
        assert!(
            (free - 6.0).abs() < 1e-12 && counts.values().all(|&n| n < 3),
            "{free}"
        );
        assert!(made.deviation < 1e-12, "{}", made.deviation);
        // The second patch looks down; its facets are turned.
        for facet in made.mesh.surfaces().unwrap() {
            assert!(Frame::new(&facet.jet([0.1, 0.2]), 1.0).unwrap().n.z > 0.999);
        }
    }
}

/// A long edge against two short ones is no joint: the crack has a name.
#[test]
fn t_joints_are_cracks() {
    let square =
        |x: f64, y: f64, size: [f64; 2]| plane(Vec3::new(x, y, 0.0), Vec3::z(), size).unwrap();
    let set = PatchSet::new(
        vec![
            square(0.5, 1.0, [1.0, 2.0]),
            square(1.5, 0.4, [1.0, 0.8]),
            square(1.5, 1.4, [1.0, 1.2]),
        ],
        None,
    )
    .unwrap();
    let made = bilinear_facets(&set, Refinement::PerSpan(3)).unwrap();
    assert!(
        made.cracks
            .iter()
            .any(|c| c.edges[0] == (0, 1) && c.facets == [3, 3]),
        "{:?}",
        made.cracks
    );
}

/// Closest points of facets against those of the surface: the distance differs by the deviation at most, and the
/// topology of the facets of a sphere is closed. Queries at all distances, near the poles too.
#[test]
fn closest_points_of_facets() {
    fn check<S: Surface, const N: usize>(exact: &PatchSet, made: &Faceted<N>, facets: Vec<S>) {
        let set = PatchSet::new(facets, None).unwrap();
        let report = set.edges();
        assert!(report.free.is_empty() && report.branching.is_empty() && report.partial.is_empty());
        assert_eq!(set.components().len(), 1);
        let (mut worst, mut unsure) = (0.0f64, 0);
        for k in 0..400 {
            let one = |a: f64| (0.5 + a * f64::from(k)).fract() - 0.5;
            let d = Vec3::new(
                one(0.819_172_513_396),
                one(0.671_043_606_704),
                one(0.549_700_477_901),
            );
            let near_pole = Vec3::new(0.01 * d.x, 0.01 * d.y, 1.0).normalize();
            let d = if k % 8 == 0 { near_pole } else { d.normalize() };
            let q = d * (0.6 + 0.8 * (one(0.31) + 0.5));
            let truth = exact
                .project(&q, None, f64::INFINITY)
                .unwrap()
                .signed_distance;
            let foot = set.project(&q, None, f64::INFINITY).unwrap();
            worst = worst.max((foot.signed_distance - truth).abs());
            unsure += usize::from(foot.status == covact_geometry::Status::NotConverged);
        }
        println!(
            "{} facets: {worst:e} of {:e}, {unsure} unsure",
            set.patches().len(),
            made.deviation
        );
        assert!(unsure == 0 && worst > 0.1 * made.deviation);
        assert!(
            worst <= 1.01 * made.deviation,
            "{worst:e} {:e}",
            made.deviation
        );
    }
    let six = sphere_without_poles(1.0, Vec3::zeros(), Vec3::z()).unwrap();
    let one = sphere(1.0, Vec3::zeros(), Vec3::z()).unwrap();
    for exact in [
        PatchSet::new(six.to_vec(), None).unwrap(),
        facet_patch(one).unwrap(),
    ] {
        let made = bilinear_facets(&exact, Refinement::Chord(0.03)).unwrap();
        check(&exact, &made, made.mesh.surfaces().unwrap());
        let made = biquadratic_facets(&exact, Refinement::Chord(1e-3)).unwrap();
        check(&exact, &made, made.mesh.surfaces().unwrap());
    }
}

/// A query above an edge between two facets of a folded strip, and above a node.
#[test]
fn folds_are_sharp() {
    let x =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [2.0, 0.0, 0.0]].map(|p| Vec3::from_column_slice(&p));
    let nodes: Vec<Vec3> = x
        .iter()
        .copied()
        .chain(x.iter().map(|x| x + Vec3::y()))
        .collect();
    let mesh = covact_geometry::FacetMesh {
        nodes,
        facets: vec![[0, 1, 3, 4], [1, 2, 4, 5]],
    };
    let set = PatchSet::new(mesh.surfaces().unwrap(), None).unwrap();
    assert_eq!((set.edges().sharp, set.edges().free.len()), (1, 6));
    let foot = set.project(&Vec3::new(1.0, 0.5, 3.0), None, 10.0).unwrap();
    assert!(
        matches!(foot.location, Location::Edge { .. })
            && (foot.signed_distance - 2.0).abs() < 1e-14
    );
    assert!((foot.normal - Vec3::z()).norm() < 1e-12);
}

#[test]
fn useless_requests() {
    let set = facet_patch(plane(Vec3::zeros(), Vec3::z(), [1.0, 1.0]).unwrap()).unwrap();
    let ask = |r| bilinear_facets(&set, r).unwrap_err();
    assert_eq!(ask(Refinement::PerSpan(0)), FacetError::Count);
    assert_eq!(ask(Refinement::Chord(-1.0)), FacetError::Tolerance(-1.0));
    assert!(matches!(
        ask(Refinement::PerSpan(u32::MAX)),
        FacetError::TooMany { .. }
    ));
    let round = facet_patch(sphere(1.0, Vec3::zeros(), Vec3::z()).unwrap()).unwrap();
    let fine = bilinear_facets(&round, Refinement::Chord(1e-300));
    // Too many facets, or finer than the rounding in which the two sides of the seam differ.
    assert!(matches!(
        fine,
        Err(FacetError::TooMany { .. } | FacetError::Gap { .. })
    ));
    let square = |x: f64| plane(Vec3::new(x, 0.0, 0.0), Vec3::z(), [1.0, 1.0]).unwrap();
    let open = PatchSet::new(vec![square(0.0), square(1.001)], Some(0.01)).unwrap();
    let gap = bilinear_facets(&open, Refinement::Chord(1e-3)).unwrap_err();
    assert!(matches!(gap, FacetError::Gap { gap, .. } if (gap - 1e-3).abs() < 1e-12));
    assert!(bilinear_facets(&open, Refinement::Chord(3e-3)).is_ok());
    let mesh = covact_geometry::FacetMesh {
        nodes: vec![Vec3::zeros(); 3],
        facets: vec![[0, 1, 2, 3]],
    };
    assert!(matches!(
        mesh.surfaces(),
        Err(FacetError::NoNode {
            facet: 0,
            node: 3,
            count: 3
        })
    ));
}
