//! Closest points against surfaces with closed forms, queries built from their foot, and exhaustive search.

mod projection_common;

use covact_geometry::primitives::{cylinder, plane, sphere, sphere_without_poles, torus};
use covact_geometry::{EdgeKind, Foot, Hint, Location, NurbsPatch, PatchSet, Status, Vec3};
use projection_common::*;

fn set(patches: Vec<NurbsPatch>) -> PatchSet {
    PatchSet::new(patches, None).unwrap()
}

fn cold(set: &PatchSet, q: Vec3) -> Foot {
    set.project(&q, None, f64::INFINITY).unwrap()
}

/// Points at a distance along the normal, nearer than both the curvature radius and a small length: the foot is known
/// to be this near at most, and mostly is.
fn above(set: &PatchSet, count: usize, most: f64, seed: u64) -> Vec<(Vec3, f64)> {
    let mut random = Random(seed);
    let mut out = Vec::new();
    while out.len() < count {
        let patch = &set.patches()[(random.next() * set.patches().len() as f64) as usize];
        let xi = random.xi(patch);
        let (Some(n), Some(kappa)) = (normal(patch, xi), curvature(patch, xi)) else {
            continue;
        };
        let d = random.between(-1.0, 1.0) * most.min(0.9 / kappa.abs());
        out.push((patch.point(xi) + n * d, d.abs()));
    }
    out
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
        let set = set(vec![bumpy(degree, count, rational, 7)]);
        let truths = above(&set, queries(300), 0.5, 11);
        assert_eq!(
            count_wrong(&format!("near, degree {degree}"), &set, &truths),
            0
        );
    }
}

#[test]
fn near_focal_surface() {
    // Within 2 % of the centre of curvature; farther ones may be nearer to something else, so the distance along the
    // normal is an upper bound only and a sample is searched exhaustively.
    for (rational, count) in [(false, 20), (true, 12)] {
        let patch = bumpy(3, count, rational, 3);
        let set = set(vec![patch]);
        let mut random = Random(5);
        let mut truths = Vec::new();
        while truths.len() < queries(300) {
            let patch = &set.patches()[0];
            let xi = random.xi(patch);
            let (Some(n), Some(kappa)) = (normal(patch, xi), curvature(patch, xi)) else {
                continue;
            };
            let d = random.between(0.98, 1.0) / kappa;
            if d.abs() < 5.0 {
                let q = patch.point(xi) + n * d;
                let mut truth = d.abs();
                if truths.len() % 10 == 0 && truths.len() < 2000 {
                    truth = truth.min(exhaustive(set.patches(), &q, 4, 20));
                }
                truths.push((q, truth));
            }
        }
        assert_eq!(count_wrong("near the focal surface", &set, &truths), 0);
    }
}

#[test]
fn far_away() {
    let set = set(vec![bumpy(3, 20, false, 7)]);
    let mut random = Random(23);
    let truths: Vec<(Vec3, f64)> = (0..queries(300))
        .map(|k| {
            let q = random.direction() * (1000.0 * set.size());
            let truth = if k % 3 == 0 {
                exhaustive(set.patches(), &q, 4, 30)
            } else {
                f64::INFINITY
            };
            // Elsewhere a dense cloud of points gives an upper bound.
            let truth = if truth.is_finite() {
                truth
            } else {
                exhaustive(set.patches(), &q, 2, 6)
            };
            (q, truth)
        })
        .collect();
    assert_eq!(count_wrong("far", &set, &truths), 0);
}

#[test]
fn beyond_edges_and_corners() {
    let set = set(vec![bumpy(3, 20, false, 7)]);
    let patch = &set.patches()[0];
    let mut random = Random(31);
    let mut truths = Vec::new();
    let mut corners = 0;
    for k in 0..queries(400) {
        // A point of an edge, moved within the cone of directions that it is the nearest point for.
        let edge = k % 4;
        let (dir, end) = (edge / 2, edge % 2);
        let along = 1 - dir;
        let mut xi = random.xi(patch);
        xi[dir] = end as f64;
        let corner = random.next() < 0.3;
        if corner {
            corners += 1;
            xi[along] = if random.next() < 0.5 { 0.0 } else { 1.0 };
        }
        let jet = patch.jet(xi);
        let n = normal(patch, xi).unwrap();
        let out = |k: usize| jet.rho_i[k].normalize() * if xi[k] == 0.0 { -1.0 } else { 1.0 };
        let mut conormal = out(dir);
        if corner {
            conormal = conormal * random.next() + out(along) * random.next();
        } else {
            let t = jet.rho_i[along].normalize();
            conormal -= t * conormal.dot(&t);
        }
        let d = (conormal.normalize() + n * random.between(-1.0, 1.0)).normalize()
            * random.between(0.01, 0.5);
        let q = jet.rho + d;
        truths.push((
            q,
            exhaustive_if(k % 10 == 0 && k < 2000, &set, &q).min(d.norm()),
        ));
    }
    assert!(corners > 50);
    assert_eq!(count_wrong("edges and corners", &set, &truths), 0);
    // Most of them are held by the free edges.
    let free = truths
        .iter()
        .filter(|(q, _)| {
            matches!(
                cold(&set, *q).location,
                Location::Edge {
                    kind: EdgeKind::Free,
                    ..
                } | Location::Corner {
                    kind: EdgeKind::Free,
                    ..
                }
            )
        })
        .count();
    assert!(10 * free > 9 * truths.len(), "{free} of {}", truths.len());
}

fn exhaustive_if(wanted: bool, set: &PatchSet, q: &Vec3) -> f64 {
    if wanted {
        exhaustive(set.patches(), q, 4, 20)
    } else {
        f64::INFINITY
    }
}

#[test]
fn spheres() {
    let centre = Vec3::new(0.3, -0.2, 0.5);
    let one = sphere(2.0, centre, Vec3::new(0.2, 0.3, 0.9)).unwrap();
    let six = sphere_without_poles(2.0, centre, Vec3::new(0.2, 0.3, 0.9)).unwrap();
    let axis = Vec3::new(0.2, 0.3, 0.9).normalize();
    for (name, patches) in [("one patch", vec![one]), ("six patches", six.to_vec())] {
        let set = set(patches);
        let mut random = Random(17);
        let mut near = Vec::new();
        let mut pole = Vec::new();
        for k in 0..queries(500) {
            let r = random.between(0.1, 4.0);
            near.push((centre + random.direction() * r, (r - 2.0f64).abs()));
            let tilt = random.direction() * 10f64.powf(random.between(-12.0, -1.0));
            let end = if k % 2 == 0 { axis } else { -axis };
            let tilt = if k % 10 == 0 { Vec3::zeros() } else { tilt };
            let offset = (end + tilt) * random.between(1.0, 3.0);
            pole.push((centre + offset, (offset.norm() - 2.0).abs()));
        }
        assert_eq!(
            count_wrong(&format!("sphere of {name}, near"), &set, &near),
            0
        );
        assert_eq!(
            count_wrong(&format!("sphere of {name}, pole"), &set, &pole),
            0
        );
        let centres: Vec<(Vec3, f64)> = (0..queries(100))
            .map(|k| {
                let off = random.direction()
                    * if k == 0 {
                        0.0
                    } else {
                        10f64.powf(random.between(-16.0, -3.0))
                    };
                (centre + off, 2.0 - off.norm())
            })
            .collect();
        assert_eq!(
            count_wrong(&format!("sphere of {name}, centre"), &set, &centres),
            0
        );
        assert_eq!(cold(&set, centre).status, Status::NonUnique);
        assert_eq!(cold(&set, near[0].0).status, Status::Unique);
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
    let set = set(vec![creased()]);
    let mut random = Random(43);
    let truths: Vec<(Vec3, f64)> = (0..queries(200).min(2000))
        .map(|_| {
            let q = Vec3::new(
                random.between(4.5, 5.5),
                random.between(0.0, 10.0),
                random.between(0.5, 3.0),
            );
            (q, exhaustive(set.patches(), &q, 4, 16))
        })
        .collect();
    assert_eq!(count_wrong("crease", &set, &truths), 0);
    let on_crease = truths
        .iter()
        .filter(|(q, _)| cold(&set, *q).location == (Location::Crease { dir: 0 }))
        .count();
    assert!(on_crease > truths.len() / 5, "{on_crease}");
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
    let truths: Vec<(Vec3, f64)> = (0..queries(300).min(2000))
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
