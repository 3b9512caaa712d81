//! Operations that must not move the surface: what they are given and what they return is compared by jets at the same
//! parameters.

use crate::common::{Knots, ORDER, Random, list, patch, samples};
use covact_geometry::basis::KnotError;
use covact_geometry::{
    NurbsCurve, NurbsPatch, PatchError, Trim, TrimCurve, TrimLoop, Vec3, bezier_pieces,
};
use nalgebra::Vector2;

const KINDS: [[Knots; 2]; 3] = [
    [Knots::Clamped, Knots::Unclamped],
    [Knots::Repeated, Knots::Clamped],
    [Knots::Unclamped, Knots::Repeated],
];

/// What is asked of every operation, for points, first and second derivatives.
const TOLERANCE: f64 = 1e-12;

/// Patches of degrees 1 to 5 with every kind of knots, plain and rational, whole and narrowed.
fn patches() -> Vec<NurbsPatch> {
    let mut patches = Vec::new();
    for p in 1..=5 {
        for (k, kind) in KINDS.into_iter().enumerate() {
            let q = (p + k) % 5 + 1;
            for spread in [0.0, 1.0, 6.0] {
                let whole = patch([p, q], kind, spread, (10 * p + k) as u64);
                let part = whole
                    .domain()
                    .map(|[a, b]| [a + 0.2 * (b - a), b - 0.3 * (b - a)]);
                patches.push(whole.with_domain(part).unwrap());
                patches.push(whole);
            }
        }
    }
    patches
}

/// Largest differences of points, first and second derivatives between a patch and its parts at the same parameters, in
/// units of the size of such a derivative: the largest one on the patch, or what rounding of control points of that size
/// makes of it on the shortest span of the part, size / length^order.
fn difference<'a>(whole: &'a NurbsPatch, parts: impl IntoIterator<Item = &'a NurbsPatch>) -> f64 {
    let (mut errors, mut largest) = (Vec::new(), [0f64; 3]);
    for part in parts {
        let spans = [0, 1].map(|dir| part.spans(dir)).concat();
        let length = spans.iter().map(|[a, b]| b - a).fold(1.0, f64::min);
        for xi in samples(part, 20, 5) {
            let (ours, reference) = (list(&part.jet3(xi)), list(&whole.jet3(xi)));
            for k in 0..6 {
                largest[ORDER[k]] = largest[ORDER[k]].max(reference[k].norm());
                errors.push((ORDER[k], (ours[k] - reference[k]).norm(), length));
            }
        }
    }
    let size = largest[0];
    let share = |(m, error, length): (usize, f64, f64)| {
        error / largest[m].max(size / length.powi(m as i32))
    };
    assert!(size > 1.0 && errors.iter().all(|e| e.1.is_finite()));
    errors.into_iter().map(share).fold(0.0, f64::max)
}

/// Parameters strictly inside the knots' own domain: new ones, and inner knots that may be repeated once more.
fn more_knots(patch: &NurbsPatch, dir: usize, seed: u64) -> Vec<f64> {
    let (basis, mut random) = (patch.basis(dir), Random(seed));
    let (p, knots) = (basis.degree(), basis.knots());
    let [a, b] = [knots[p], knots[basis.count()]];
    let mut more: Vec<f64> = (0..3).map(|_| a + (b - a) * random.next()).collect();
    if p > 1 {
        more.push(more[0]);
    }
    let single = |&&t: &&f64| t > a && t < b && knots.iter().filter(|&&k| k == t).count() < p;
    more.extend(knots.iter().find(single));
    more
}

#[test]
fn insertion_and_removal() {
    let mut largest = [0f64; 2];
    for (k, patch) in patches().iter().enumerate() {
        for dir in 0..2 {
            let more = more_knots(patch, dir, k as u64);
            let fine = patch.insert_knots(dir, &more).unwrap();
            assert_eq!(fine.counts()[dir], patch.counts()[dir] + more.len());
            assert_eq!(fine.domain(), patch.domain());
            assert_eq!(fine.is_rational(), patch.is_rational());
            largest[0] = largest[0].max(difference(patch, [&fine]));

            let again = fine.remove_knots(dir, &more, 1e-12).unwrap();
            assert_eq!(again.basis(dir), patch.basis(dir));
            let size = patch.homogeneous().iter().flatten();
            let size = size.fold(0f64, |m, x| m.max(x.abs()));
            for (x, y) in again.homogeneous().iter().zip(patch.homogeneous()) {
                for c in 0..4 {
                    largest[1] = largest[1].max((x[c] - y[c]).abs() / size);
                }
            }
        }
    }
    println!("insertion {:e}, removal {:e}", largest[0], largest[1]);
    assert!(largest.iter().all(|&e| e <= TOLERANCE), "{largest:?}");
}

#[test]
fn knots_that_cannot_be_inserted_or_removed() {
    let patch = patch([3, 2], KINDS[1], 1.0, 4);
    let [[a, b], _] = patch.domain();
    for t in [a, b, a - 1.0, f64::NAN] {
        let error = patch.insert_knots(0, &[t]).unwrap_err();
        let direction = 0;
        assert!(
            matches!(error, PatchError::Knots { direction: d, reason: KnotError::Domain { .. } } if d == direction)
        );
        let error = patch.remove_knots(0, &[t], 1e-9).unwrap_err();
        assert!(matches!(
            error,
            PatchError::Knots {
                reason: KnotError::Absent { .. },
                ..
            }
        ));
    }
    let t = 0.5 * (a + b);
    let error = patch.insert_knots(0, &[t; 4]).unwrap_err();
    assert!(matches!(
        error,
        PatchError::Knots {
            reason: KnotError::Multiplicity { .. },
            ..
        }
    ));
    // A knot that carries a jump of the third derivative.
    let inner = patch.spans(0)[0][1];
    let error = patch.remove_knots(0, &[inner], 1e-9).unwrap_err();
    assert!(matches!(error, PatchError::KnotNeeded { change, .. } if change > 1e-6));
}

#[test]
fn degree_elevation() {
    let mut largest = 0f64;
    for patch in patches() {
        for (dir, times) in [(0, 1), (1, 2)] {
            let high = patch.elevated(dir, times).unwrap();
            assert_eq!(high.degree()[dir], patch.degree()[dir] + times);
            assert_eq!(high.domain(), patch.domain());
            assert_eq!(high.spans(dir), patch.spans(dir));
            assert_eq!(high.crease_knots(dir), patch.crease_knots(dir));
            largest = largest.max(difference(&patch, [&high]));
        }
    }
    println!("elevation {largest:e}");
    assert!(largest <= TOLERANCE, "{largest:e}");
    assert!(patches()[0].elevated(0, 15).is_err());
}

/// A straight line raised to degree 3 has its control points at thirds.
#[test]
fn elevated_line() {
    let flat = vec![0.0, 0.0, 1.0, 1.0];
    let points =
        [[0.0, 0.0], [3.0, 0.0], [0.0, 1.0], [3.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let plane = NurbsPatch::new([1, 1], [flat.clone(), flat], [2, 2], &points, None).unwrap();
    let high = plane.elevated(0, 2).unwrap();
    assert_eq!(high.knots(0), [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
    for (k, x) in high.points().iter().take(4).enumerate() {
        assert!((x - Vec3::new(k as f64, 0.0, 0.0)).norm() < 1e-15);
    }
}

#[test]
fn splitting_and_clamping() {
    let mut largest = 0f64;
    for (k, patch) in patches().iter().enumerate() {
        for dir in 0..2 {
            let [a, b] = patch.domain()[dir];
            let spans = patch.spans(dir);
            // Between knots and, where there is one, at an inner knot.
            let t = [
                a + (b - a) * Random(k as u64).next(),
                spans[spans.len() / 2][0],
            ];
            for t in t.into_iter().filter(|&t| t > a) {
                let parts = patch.split(dir, t).unwrap();
                assert_eq!(parts[0].domain()[dir], [a, t]);
                assert_eq!(parts[1].domain()[dir], [t, b]);
                for part in &parts {
                    assert_eq!(part.domain()[1 - dir], patch.domain()[1 - dir]);
                }
                largest = largest.max(difference(patch, &parts));
            }
            let clamped = patch.clamped(dir).unwrap();
            let (p, knots) = (patch.degree()[dir], clamped.knots(dir));
            assert!(knots[..=p].iter().all(|&t| t == knots[0]));
            assert_eq!(clamped.domain(), patch.domain());
            largest = largest.max(difference(patch, [&clamped]));
        }
    }
    println!("splitting and clamping {largest:e}");
    assert!(largest <= TOLERANCE, "{largest:e}");
    let patch = &patches()[0];
    let [a, b] = patch.domain()[0];
    for t in [a, b, f64::NAN] {
        assert!(patch.split(0, t).is_err());
    }
}

#[test]
fn bezier_patches() {
    let mut largest = 0f64;
    for patch in patches() {
        let pieces = bezier_pieces(&patch);
        let parts: Vec<_> = pieces.iter().map(|piece| piece.patch().unwrap()).collect();
        for (part, piece) in parts.iter().zip(&pieces) {
            assert_eq!(part.domain(), piece.domain);
        }
        largest = largest.max(difference(&patch, &parts));
    }
    println!("Bezier pieces {largest:e}");
    assert!(largest <= TOLERANCE, "{largest:e}");
}

/// A triangle of lines in the parameter plane, one with its curve in space.
fn trimmed() -> NurbsPatch {
    let patch = patch([3, 2], KINDS[0], 1.0, 17);
    let [[a, b], [c, d]] = patch.domain();
    let at = |s: f64, t: f64| Vector2::new(a + s * (b - a), c + t * (d - c));
    let corners = [at(0.1, 0.2), at(0.8, 0.3), at(0.4, 0.9)];
    let curve = |k: usize| {
        let ends = [corners[k], corners[(k + 1) % 3]];
        let [x, y] = ends.map(|xi| patch.point([xi.x, xi.y]));
        TrimCurve {
            parameter: NurbsCurve::line(ends[0], ends[1]).unwrap(),
            space: (k == 1).then(|| NurbsCurve::line(x, y).unwrap()),
            entity: 7 + k as u32,
        }
    };
    let one = TrimLoop {
        curves: (0..3).map(curve).collect(),
    };
    let trim = Trim::new(vec![one], patch.domain(), 1e-9).unwrap();
    patch.with_trim(Some(trim))
}

/// Points of the trim curves, found through the parameter curves, and the ends of those in space stay where they were
/// (mapped where the patch is).
#[test]
fn trims_follow() {
    let patch = trimmed();
    let at = |patch: &NurbsPatch, k: usize, t: f64| {
        let curve = &patch.trim().expect("still trimmed").loops()[0].curves[k];
        assert_eq!(curve.entity, 7 + k as u32);
        let xi = curve.parameter.point(t);
        let ends = curve.space.as_ref().map(NurbsCurve::ends);
        assert_eq!(ends.is_some(), k == 1);
        (patch.point([xi.x, xi.y]), ends)
    };
    let part = patch.domain().map(|[a, b]| [a, b - 0.05 * (b - a)]);
    let kept = [
        patch.with_domain(part).unwrap(),
        patch.insert_knots(0, &more_knots(&patch, 0, 3)).unwrap(),
        patch.elevated(1, 1).unwrap(),
        patch.clamped(1).unwrap(),
        patch.reversed(0).unwrap(),
        patch.reversed(1).unwrap(),
        patch.swapped().unwrap(),
        patch.swapped().unwrap().reversed(0).unwrap(),
    ];
    let map = |x: Vec3| Vec3::new(x.y - 2.0, 3.0 * x.x, x.z + x.x);
    let mapped = patch.transformed(&map).unwrap();
    for k in 0..3 {
        for t in [0.0, 0.3, 1.0] {
            let (x, ends) = at(&patch, k, t);
            for other in &kept {
                let (y, other_ends) = at(other, k, t);
                assert!((x - y).norm() < 1e-12 * x.norm().max(1.0));
                assert_eq!(ends, other_ends);
            }
            let (y, mapped_ends) = at(&mapped, k, t);
            assert!((map(x) - y).norm() < 1e-12 * y.norm().max(1.0));
            for (x, y) in ends.iter().flatten().zip(mapped_ends.iter().flatten()) {
                assert!((map(*x) - y).norm() < 1e-12 * y.norm().max(1.0));
            }
        }
    }
    let t = 0.5 * (part[0][0] + part[0][1]);
    assert_eq!(patch.split(0, t), Err(PatchError::SplitTrimmed));
}
