//! Closest points against surfaces with closed forms, queries built from their foot, and exhaustive search.

use crate::common::sets::{self, QuerySet, above};
use crate::common::*;
use covact_geometry::primitives::{cylinder, plane, sphere, torus};
use covact_geometry::{EdgeKind, Foot, Hint, Location, NurbsPatch, PatchSet, Status, Vec3};

fn set(patches: Vec<NurbsPatch>) -> PatchSet {
    PatchSet::new(patches, None).unwrap()
}

fn cold(set: &PatchSet, q: Vec3) -> Foot {
    set.project(&q, None, f64::INFINITY).unwrap()
}

fn none_wrong(queries: &sets::QuerySet) {
    assert_eq!(count_wrong(queries.name, &queries.set, &queries.truths), 0);
}

#[test]
fn near_bicubic() {
    for (degree, count, rational) in [
        (3, 20, false),
        (3, 12, true),
        (2, 15, true),
        (5, 9, false),
        (1, 12, false),
    ] {
        none_wrong(&sets::near(queries(1000), degree, count, rational));
    }
}

#[test]
fn near_focal_surface() {
    none_wrong(&sets::focal(queries(600), false));
    none_wrong(&sets::focal(queries(600), true));
}

#[test]
fn far_away() {
    none_wrong(&sets::far(queries(400)));
}

#[test]
fn beyond_edges_and_corners() {
    let QuerySet { set, truths, .. } = sets::edge_and_corner(queries(1000));
    assert_eq!(count_wrong("edge and corner", &set, &truths), 0);
    // Most of them are held by the free edges.
    let locations = truths.iter().map(|(q, _)| cold(&set, *q).location);
    let mut found = [0; 2];
    for location in locations {
        match location {
            Location::Edge {
                kind: EdgeKind::Free,
                ..
            } => found[0] += 1,
            Location::Corner {
                kind: EdgeKind::Free,
                ..
            } => found[1] += 1,
            _ => {}
        }
    }
    let count = truths.len();
    assert!(
        10 * (found[0] + found[1]) > 9 * count && 5 * found[1] > count,
        "{found:?}"
    );
}

#[test]
fn spheres() {
    for six in [false, true] {
        let near = sets::sphere_near(queries(1000), six);
        none_wrong(&near);
        none_wrong(&sets::sphere_pole(queries(300), six));
        let centre = sets::sphere_centre(queries(200), six);
        none_wrong(&centre);
        assert_eq!(
            cold(&centre.set, centre.truths[0].0).status,
            Status::NonUnique
        );
        assert_eq!(cold(&near.set, near.truths[0].0).status, Status::Unique);
    }
}

#[test]
fn torus_cylinder_plane() {
    let mut random = Random(41);
    let ring = set(vec![torus(3.0, 1.0, Vec3::zeros(), Vec3::z()).unwrap()]);
    let tube = set(vec![cylinder(1.5, 4.0, Vec3::zeros(), Vec3::z()).unwrap()]);
    let sheet = set(vec![plane(Vec3::zeros(), Vec3::z(), [4.0, 2.0]).unwrap()]);
    let (mut on_ring, mut on_tube, mut on_sheet) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..queries(500) {
        let q = random.direction() * random.between(0.0, 6.0);
        let r = q.xy().norm();
        on_ring.push((q, ((r - 3.0).hypot(q.z) - 1.0).abs()));
        on_tube.push((q, (r - 1.5).hypot((q.z.abs() - 2.0).max(0.0))));
        let [x, y] = [(q.x.abs() - 2.0).max(0.0), (q.y.abs() - 1.0).max(0.0)];
        on_sheet.push((q, x.hypot(y).hypot(q.z)));
    }
    assert_eq!(count_wrong("torus", &ring, &on_ring), 0);
    assert_eq!(count_wrong("cylinder", &tube, &on_tube), 0);
    assert_eq!(count_wrong("plane", &sheet, &on_sheet), 0);
}

#[test]
fn crease() {
    let QuerySet { set, truths, .. } = sets::crease(queries(400));
    assert_eq!(count_wrong("crease", &set, &truths), 0);
    let on_crease = truths
        .iter()
        .filter(|(q, _)| cold(&set, *q).location == (Location::Crease { dir: 0 }))
        .count();
    assert!(on_crease > truths.len() / 5, "{on_crease}");
}

#[test]
fn many_patches() {
    none_wrong(&sets::patchwork(queries(500), 10));
}

/// Surface of a `.surf` file: degrees and counts, knots of both directions, then x y z w per control point, xi2
/// fastest.
fn read_surface(text: &str) -> NurbsPatch {
    let mut numbers = text.split_whitespace().map(|s| s.parse::<f64>().unwrap());
    let mut next = || numbers.next().unwrap();
    let degree = [next() as usize, next() as usize];
    let counts = [next() as usize, next() as usize];
    let mut knots = [0, 1].map(|k| vec![0.0; counts[k] + degree[k] + 1]);
    knots.iter_mut().flatten().for_each(|k| *k = next());
    let mut points = vec![Vec3::zeros(); counts[0] * counts[1]];
    let mut weights = vec![0.0; points.len()];
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            let k = i + counts[0] * j;
            points[k] = Vec3::new(next(), next(), next());
            weights[k] = next();
        }
    }
    NurbsPatch::new(degree, knots, counts, &points, Some(&weights)).unwrap()
}

#[test]
fn query_sets_of_other_codes() {
    // Surfaces and points that other closest-point codes were compared on; where they lie is told by a variable.
    let Some(folder) = std::env::var_os("COVACT_QUERY_SETS") else {
        eprintln!("skipped: COVACT_QUERY_SETS does not name a folder of .surf and .q files");
        return;
    };
    let folder = std::path::Path::new(&folder);
    let mut read = 0;
    for name in ["A3near", "A3edge", "CRcrease", "SPHnear"] {
        let file = |end: &str| std::fs::read_to_string(folder.join(format!("{name}.{end}")));
        let (Ok(surface), Ok(points)) = (file("surf"), file("q")) else {
            eprintln!("skipped: no {name}");
            continue;
        };
        read += 1;
        let set = set(vec![read_surface(&surface)]);
        let truths: Vec<(Vec3, f64)> = points
            .lines()
            .take(queries(200))
            .map(|line| {
                let x: Vec<f64> = line
                    .split_whitespace()
                    .map(|s| s.parse().unwrap())
                    .collect();
                let q = Vec3::new(x[0], x[1], x[2]);
                let truth = match name {
                    "SPHnear" => (q.norm() - 1.0).abs(),
                    _ => exhaustive(set.patches(), &q, 3, 12),
                };
                (q, truth)
            })
            .collect();
        assert_eq!(count_wrong(name, &set, &truths), 0);
    }
    assert!(read > 0, "no query sets in {}", folder.display());
}

#[test]
fn several_patches() {
    // A bumpy sheet cut in four along knots, and a sphere that cuts through it.
    let whole = bumpy(3, 20, false, 7);
    let mut patches = Vec::new();
    let cut = 8.0 / 17.0;
    for [a, b] in [[0.0, cut], [cut, 1.0]] {
        for [c, d] in [[0.0, cut], [cut, 1.0]] {
            patches.push(whole.with_domain([[a, b], [c, d]]).unwrap());
        }
    }
    let alone = PatchSet::new(vec![whole], None).unwrap();
    let four = set(patches.clone());
    assert_eq!((four.edges().smooth, four.edges().free.len()), (4, 8));
    let truths: Vec<(Vec3, f64)> = above(&alone, queries(300), 0.5, 3)
        .into_iter()
        .map(|(q, d)| (q, cold(&alone, q).distance.min(d)))
        .collect();
    assert_eq!(count_wrong("four patches", &four, &truths), 0);
    // Near the joints the cut sheet gives the same feet, on faces.
    let mut random = Random(9);
    for _ in 0..100 {
        let xi = [cut + random.between(-1e-7, 1e-7), random.next()];
        let q = alone.patches()[0].point(xi) + Vec3::z() * 0.1;
        let (one, other) = (cold(&alone, q), cold(&four, q));
        assert!((one.jet.rho - other.jet.rho).norm() < 1e-13);
        assert_eq!(one.location, other.location);
    }
    patches.push(sphere(1.0, Vec3::new(4.7, 4.7, 0.0), Vec3::z()).unwrap());
    let five = set(patches);
    assert_eq!(five.components().len(), 2);
    let truths: Vec<(Vec3, f64)> = (0..queries(300))
        .map(|_| {
            let q = Vec3::new(
                random.between(0.0, 10.0),
                random.between(0.0, 10.0),
                random.between(-3.0, 3.0),
            );
            let ball = ((q - Vec3::new(4.7, 4.7, 0.0)).norm() - 1.0).abs();
            (q, exhaustive(alone.patches(), &q, 2, 8).min(ball))
        })
        .collect();
    assert_eq!(count_wrong("sheet and sphere", &five, &truths), 0);
}

#[test]
fn warm_and_cold_agree_to_rounding() {
    let set = set(vec![bumpy(3, 20, true, 7)]);
    let mut random = Random(77);
    let mut moved = 0.0f64;
    for (q, _) in above(&set, 200, 0.3, 5) {
        let foot = cold(&set, q);
        // A step nearby, projected with the old foot as the hint.
        let near = q + random.direction() * 0.005;
        let (warm, fresh) = (
            set.project(&near, Some(foot.hint()), f64::INFINITY)
                .unwrap(),
            cold(&set, near),
        );
        assert_eq!(warm.location, fresh.location);
        for k in 0..2 {
            assert!(
                (warm.xi[k] - fresh.xi[k]).abs() < 1e-13,
                "{warm:?} {fresh:?}"
            );
        }
        moved = moved.max((warm.xi[0] - foot.xi[0]).abs());
    }
    assert!(moved > 1e-5);
}

#[test]
fn hints_do_not_change_the_distance() {
    // Far points are held by edges and corners, hints anywhere send the iteration to other ones first.
    let set = set(vec![bumpy(3, 20, false, 7)]);
    let mut random = Random(29);
    let mut different = 0;
    for k in 0..4000 {
        let q = random.direction() * (10f64.powf(random.between(0.0, 3.0)) * set.size());
        let hint = Hint {
            patch: 0,
            xi: [random.next(), random.next()],
        };
        let (one, other) = (
            cold(&set, q),
            set.project(&q, Some(hint), f64::INFINITY).unwrap(),
        );
        assert!(
            (one.distance - other.distance).abs() <= 1e-9 * set.size(),
            "{k}: {q:?} {hint:?} {one:?} {other:?}"
        );
        different += usize::from((one.xi[0] - hint.xi[0]).abs() > 0.1);
    }
    assert!(different > 2000);
}

#[test]
fn batches_do_not_depend_on_the_number_of_threads() {
    let QuerySet { set, truths, .. } = sets::near(1000, 3, 12, true);
    let points: Vec<Vec3> = truths.iter().map(|t| t.0).collect();
    let singly: Vec<Option<Foot>> = points.iter().map(|q| Some(cold(&set, *q))).collect();
    let hints: Vec<Option<Hint>> = singly.iter().map(|f| f.map(|f| f.hint())).collect();
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let mut out = vec![None; points.len()];
        let all = f64::INFINITY;
        pool.install(|| set.project_batch(&points, &[], all, &mut out))
            .unwrap();
        assert_eq!(out, singly);
        out.fill(None);
        pool.install(|| set.project_batch(&points, &hints, all, &mut out))
            .unwrap();
        for (k, (foot, q)) in out.iter().zip(&points).enumerate() {
            assert_eq!(*foot, set.project(q, hints[k], all));
        }
        // Out of reach is no answer.
        pool.install(|| set.project_batch(&points, &[], 1e-6, &mut out))
            .unwrap();
        assert!(out.iter().filter(|f| f.is_none()).count() > 900);
    }
    let mut short = vec![None; 3];
    assert!(set.project_batch(&points, &[], 1.0, &mut short).is_err());
    assert!(
        set.project_batch(&points[..3], &hints[..2], 1.0, &mut short)
            .is_err()
    );
}

/// A closed box from `-half` to `half`, the axes of one corner turned askew.
fn askew_box(half: Vec3) -> (PatchSet, [Vec3; 3]) {
    let a = Vec3::new(0.8, 0.36, 0.48);
    let b = Vec3::new(-0.6, 0.48, 0.64);
    let axes = [a, b, a.cross(&b)];
    let faces = (0..6).map(|k| {
        let (dir, sign) = (k / 2, if k % 2 == 0 { 1.0 } else { -1.0 });
        let n = axes[dir] * sign;
        let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(|[s, t]| {
            let (i, j) = ((dir + 1) % 3, (dir + 2) % 3);
            n * half[dir] + axes[i] * (sign * s * half[i]) + axes[j] * (t * half[j])
        });
        let knots = || vec![0.0, 0.0, 1.0, 1.0];
        NurbsPatch::new([1, 1], [knots(), knots()], [2, 2], &corners, None).unwrap()
    });
    (set(faces.collect()), axes)
}

#[test]
fn rims_are_borders_and_convex_edges_in_pieces() {
    let half = Vec3::new(1.0, 1.3, 1.7);
    let (solid, axes) = askew_box(half);
    // Every edge once, in pieces as long as asked for at most, whose middles lie on it.
    let rims = solid.rims(0.5, 0.4);
    assert_eq!(rims.len(), 12);
    let mut length = 0.0;
    for rim in &rims {
        assert!(!rim.free && rim.piece <= 0.4);
        length += rim.piece * rim.points.len() as f64;
        for point in &rim.points {
            let (x, along) = (&point.x, &point.along);
            let at: [f64; 3] = std::array::from_fn(|k| axes[k].dot(x) / half[k]);
            let on = at.iter().filter(|a| (a.abs() - 1.0).abs() < 1e-12).count();
            assert_eq!(on, 2, "{at:?}");
            let free = (0..3)
                .find(|k| at[*k].abs() < 1.0 - 1e-9)
                .expect("on an edge");
            assert!(axes[free].cross(along).norm() < 1e-12 * along.norm());
            // Those of the two faces.
            for k in (0..3).filter(|k| *k != free) {
                let is = |n: &Vec3| (n - axes[k] * at[k].signum()).norm() < 1e-12;
                assert!(point.normals.iter().any(is), "{point:?}");
            }
        }
    }
    assert!((length - 8.0 * (1.0 + 1.3 + 1.7)).abs() < 1e-12, "{length}");
    assert!(solid.rims(2.0, 0.4).is_empty());
    // Seen from inside the edges are hollow.
    let mut hollow = solid;
    hollow.set_sides_outward(true).unwrap();
    assert!(hollow.rims(0.5, 0.4).is_empty());
    // Of a cylinder the circles at its ends: its seam is none.
    let tube = set(vec![cylinder(1.0, 3.0, Vec3::zeros(), Vec3::z()).unwrap()]);
    let rims = tube.rims(0.5, 0.25);
    assert_eq!(rims.len(), 2);
    for rim in &rims {
        let length = rim.piece * rim.points.len() as f64;
        assert!(
            rim.free && (length / std::f64::consts::TAU - 1.0).abs() < 0.02,
            "{length}"
        );
        for point in &rim.points {
            let (x, along) = (&point.x, &point.along);
            assert_eq!(point.normals[0], point.normals[1]);
            assert!((x.xy().norm() - 1.0).abs() < 1e-12 && (x.z.abs() - 1.5).abs() < 1e-12);
            assert!(along.dot(x).abs() < 1e-12 * along.norm());
        }
        // Evenly along it.
        for pair in rim.points.windows(2) {
            let apart = (pair[1].x - pair[0].x).norm();
            assert!(
                (apart / rim.piece - 1.0).abs() < 0.05,
                "{apart} {}",
                rim.piece
            );
        }
    }
}

#[test]
fn feet_as_near_as_each_other_are_not_unique() {
    let mut random = Random(71);
    let check = |set: &PatchSet, tie: Vec3, off: Vec3, what: &str| {
        let foot = cold(set, tie);
        assert_eq!(foot.status, Status::NonUnique, "{what}: {tie:?} {foot:?}");
        let hint = Some(foot.hint());
        let warm = set.project(&tie, hint, f64::INFINITY).unwrap();
        assert_eq!(
            warm.status,
            Status::NonUnique,
            "{what}, warm: {tie:?} {warm:?}"
        );
        // Well above rounding the two feet can be told from each other.
        for away in [1e-7, 1e-3] {
            let q = tie + off * (away * set.size());
            let foot = cold(set, q);
            assert_eq!(foot.status, Status::Unique, "{what}, off: {q:?} {foot:?}");
        }
    };
    // The medial axis of a hollow parabola.
    let points: Vec<Vec3> = (0..6)
        .map(|k| {
            Vec3::new(
                f64::from(k % 3) - 1.0,
                f64::from(k / 3),
                f64::from((k % 3 + 1) % 2),
            )
        })
        .map(|p| Vec3::new(p.x, p.y, 2.0 * p.z - 1.0))
        .collect();
    let knots = [vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let parabola = NurbsPatch::new([2, 1], knots, [3, 2], &points, None).unwrap();
    let parabola = set(vec![parabola]);
    for _ in 0..100 {
        // z = x^2; the focus is at 1 / 4, the centre of curvature of the bottom at 1 / 2.
        let q = Vec3::new(0.0, random.between(0.1, 0.9), random.between(0.6, 1.2));
        check(&parabola, q, Vec3::x(), "parabola");
    }
    // Inside of a box: as far from two faces, and from three.
    let (solid, axes) = askew_box(Vec3::new(1.0, 1.3, 1.7));
    let place = |x: [f64; 3]| axes[0] * x[0] + axes[1] * x[1] + axes[2] * x[2];
    for _ in 0..100 {
        let d = random.between(0.05, 0.9);
        let c = random.between(-0.1, 0.1);
        let two = place([1.0 - d, 1.3 - d, c]);
        check(&solid, two, axes[0], "box");
        let three = place([1.0 - d, d - 1.3, 1.7 - d]);
        check(&solid, three, axes[2] - axes[0], "box, corner");
    }
    // Between two sheets: flat ones, and bumpy ones that mirror each other.
    let flat = [-0.5, 0.5].map(|z| plane(Vec3::z() * z, Vec3::z(), [4.0, 2.0]).unwrap());
    let flat = set(flat.to_vec());
    let sheet = bumpy(3, 12, true, 5);
    let mirrored = sheet
        .transformed(&|p: Vec3| Vec3::new(p.x, p.y, 4.0 - p.z))
        .unwrap();
    let bumps = set(vec![sheet, mirrored]);
    for _ in 0..100 {
        let q = Vec3::new(random.between(-1.4, 1.4), random.between(-0.4, 0.4), 0.0);
        check(&flat, q, Vec3::z(), "two planes");
        let q = Vec3::new(random.between(2.0, 8.0), random.between(2.0, 8.0), 2.0);
        check(&bumps, q, Vec3::z(), "two sheets");
    }
    // A circle of feet.
    let ring = set(vec![torus(3.0, 1.0, Vec3::zeros(), Vec3::z()).unwrap()]);
    for _ in 0..20 {
        let q = Vec3::z() * random.between(-4.0, 4.0);
        assert_eq!(cold(&ring, q).status, Status::NonUnique, "{q:?}");
        let q = q + Vec3::x() * 1e-3;
        assert_eq!(cold(&ring, q).status, Status::Unique, "{q:?}");
    }
}

#[test]
fn points_of_sharp_edges_and_corners_lie_on_them() {
    let half = Vec3::new(1.0, 1.3, 1.7);
    let (solid, axes) = askew_box(half);
    let at = |x: [f64; 3]| (0..3).map(|k| axes[k] * (x[k] * half[k])).sum::<Vec3>();
    let mut random = Random(72);
    for k in 0..120 {
        let sign = |bit: usize| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let corner = [sign(0), sign(1), sign(2)];
        let foot = cold(&solid, at(corner));
        let kind = EdgeKind::Sharp;
        let on_corner = matches!(foot.location, Location::Corner { kind: k, .. } if k == kind);
        assert!(on_corner && foot.status == Status::Unique, "{foot:?}");
        let n: Vec3 = (0..3).map(|k| axes[k] * corner[k]).sum();
        assert!((foot.normal - n.normalize()).norm() < 1e-12, "{foot:?}");
        let mut edge = corner;
        edge[k % 3] = random.between(-0.9, 0.9);
        let foot = cold(&solid, at(edge));
        let on_edge = matches!(foot.location, Location::Edge { kind: k, .. } if k == kind);
        assert!(on_edge && foot.status == Status::Unique, "{foot:?}");
        let n = n - axes[k % 3] * corner[k % 3];
        assert!((foot.normal - n.normalize()).norm() < 1e-12, "{foot:?}");
        assert!(foot.distance < 1e-14 && foot.signed_distance.abs() < 1e-14);
        // On a face a little beside the edge.
        edge[(k + 1) % 3] *= 1.0 - 1e-6;
        assert_eq!(cold(&solid, at(edge)).location, Location::Face);
    }
    // A crease, and a free border, which belongs to its face.
    let roof = set(vec![creased()]);
    for _ in 0..50 {
        let t = random.between(0.05, 0.95);
        let foot = cold(&roof, roof.patches()[0].point([0.5, t]));
        assert_eq!(foot.location, Location::Crease { dir: 0 }, "{foot:?}");
        assert!(foot.normal.x.abs() < 1e-9, "{foot:?}");
        let foot = cold(&roof, roof.patches()[0].point([0.0, t]));
        assert_eq!(foot.location, Location::Face, "{foot:?}");
    }
}
