//! Patches as data: checks, spans, creases, parts, reversal, Bezier pieces.

use crate::common::{Knots, list, patch, samples, worst};
use covact_geometry::basis::KnotError;
use covact_geometry::{NurbsPatch, PatchError, Vec3, bezier_pieces};
use nalgebra::{Isometry3, Vector3};

const KINDS: [[Knots; 2]; 3] = [
    [Knots::Clamped, Knots::Unclamped],
    [Knots::Repeated, Knots::Clamped],
    [Knots::Unclamped, Knots::Repeated],
];

/// Bilinear in xi2; `knots` of degree `degree` in xi1.
fn strip(degree: usize, knots: Vec<f64>, count: usize) -> Result<NurbsPatch, PatchError> {
    let points: Vec<Vec3> = (0..2 * count)
        .map(|k| Vec3::new((k % count) as f64, (k / count) as f64, 0.0))
        .collect();
    NurbsPatch::new(
        [degree, 1],
        [knots, vec![0.0, 0.0, 1.0, 1.0]],
        [count, 2],
        &points,
        None,
    )
}

fn reason(result: Result<NurbsPatch, PatchError>) -> KnotError {
    match result {
        Err(PatchError::Knots {
            direction: 0,
            reason,
        }) => reason,
        other => panic!("{other:?}"),
    }
}

#[test]
fn bad_knots_are_named() {
    let degree = |degree| KnotError::Degree { degree };
    assert_eq!(reason(strip(0, vec![0.0, 1.0, 2.0], 2)), degree(0));
    assert_eq!(reason(strip(16, vec![0.0; 40], 23)), degree(16));
    assert_eq!(
        reason(strip(3, vec![0.0; 7], 3)),
        KnotError::Count {
            count: 3,
            degree: 3
        }
    );
    assert_eq!(
        reason(strip(2, vec![0.0, 0.0, 0.0, 1.0, 1.0], 3)),
        KnotError::Length {
            expected: 6,
            found: 5
        }
    );
    assert_eq!(
        reason(strip(1, vec![0.0, 0.0, f64::NAN, 1.0], 2)),
        KnotError::NotFinite { index: 2 }
    );
    assert_eq!(
        reason(strip(1, vec![0.0, 0.0, 2.0, 1.0, 3.0], 3)),
        KnotError::Decreasing { index: 3 }
    );
    assert_eq!(
        reason(strip(1, vec![0.0, 1.0, 1.0, 2.0], 2)),
        KnotError::EmptyDomain {
            degree: 1,
            count: 2
        }
    );
    let torn = vec![0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0];
    let multiplicity = KnotError::Multiplicity {
        index: 3,
        value: 0.5,
        multiplicity: 3,
        degree: 2,
    };
    assert_eq!(reason(strip(2, torn, 6)), multiplicity);
    assert_eq!(
        reason(strip(1, vec![0.0, 0.0, 1e-310, 1.0, 1.0], 3)),
        KnotError::TooClose { index: 1 }
    );
    let message = strip(2, vec![0.0; 5], 3).unwrap_err().to_string();
    assert_eq!(
        message,
        "direction 0: 5 knots where count + degree + 1 = 6 are needed"
    );
}

#[test]
fn bad_control_points_are_named() {
    let knots = || [vec![0.0, 0.0, 1.0, 2.0, 2.0], vec![0.0, 0.0, 1.0, 1.0]];
    let good = vec![Vec3::zeros(); 6];
    let new = |points: &[Vec3], weights: Option<&[f64]>| {
        NurbsPatch::new([1, 1], knots(), [3, 2], points, weights).unwrap_err()
    };
    assert_eq!(
        new(&good[1..], None),
        PatchError::PointCount {
            expected: 6,
            found: 5
        }
    );
    assert_eq!(
        new(&good, Some(&[1.0; 7])),
        PatchError::WeightCount {
            expected: 6,
            found: 7
        }
    );
    let mut points = good.clone();
    points[5].y = f64::INFINITY;
    assert_eq!(new(&points, None), PatchError::Point { index: [2, 1] });
    for bad in [0.0, -1.0, f64::INFINITY] {
        let mut weights = [1.0; 6];
        weights[4] = bad;
        assert_eq!(
            new(&good, Some(&weights)),
            PatchError::Weight {
                index: [1, 1],
                value: bad
            }
        );
    }
}

/// xi1 runs fastest through the control points.
#[test]
fn order_of_control_points() {
    let patch = strip(1, vec![0.0, 0.0, 1.0, 2.0, 2.0], 3).unwrap();
    assert_eq!(patch.point([2.0, 0.0]), Vec3::new(2.0, 0.0, 0.0));
    assert_eq!(patch.point([0.0, 1.0]), Vec3::new(0.0, 1.0, 0.0));
    assert_eq!(patch.point([1.5, 0.25]), Vec3::new(1.5, 0.25, 0.0));
}

/// Every span is found from every point of it, on graded knots too, where a table of equal pieces is of little help.
#[test]
fn spans_are_found() {
    let mut knots = vec![0.0; 4];
    knots.extend((0..60).map(|k| 1.3f64.powi(k - 50)));
    let end = knots[63];
    knots.extend([end; 3]);
    let count = knots.len() - 4;
    let patch = strip(3, knots, count).unwrap();
    let spans = patch.spans(0);
    assert_eq!(spans.len(), 60);
    for (k, &[a, b]) in spans.iter().enumerate() {
        for s in [0.0, 1e-15, 0.3, 0.999_999] {
            let t = a + s * (b - a);
            assert_eq!(patch.find_span([t, 0.5])[0], k, "at {t}");
        }
        assert_eq!(patch.find_span_left([b, 0.5])[0], k);
        assert_eq!(patch.find_span([b, 0.5])[0], (k + 1).min(59));
    }
    assert_eq!(patch.find_span([-3.0, 0.5])[0], 0);
    assert_eq!(patch.find_span([9.0, 0.5])[0], 59);
    assert_eq!(patch.find_span_left([0.0, 0.0]), [0, 0]);
    assert!(patch.find_span([f64::NAN, f64::INFINITY])[0] < 60);
    assert!(patch.jet([f64::NAN, 0.5]).rho.x.is_nan());
    // A span number past the end is the last span.
    let xi = [0.9 * end, 0.5];
    assert_eq!(
        patch.jet_in_span([1000, 7], xi),
        patch.jet_in_span([59, 0], xi)
    );
}

/// A roof: the tangents jump at the ridge, and each side keeps its own.
#[test]
fn crease_has_two_sides() {
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0];
    let mut points = Vec::new();
    for y in [0.0, 1.0] {
        for x in [0.0, 0.5, 1.0, 1.5, 2.0] {
            points.push(Vec3::new(x, y, 1.0 - f64::abs(x - 1.0)));
        }
    }
    let flat = vec![0.0, 0.0, 1.0, 1.0];
    let patch = NurbsPatch::new([2, 1], [knots, flat], [5, 2], &points, None).unwrap();
    assert_eq!(patch.crease_knots(0), [1.0]);
    assert_eq!(patch.sharp_knots(0, 1.57), [1.0]);
    assert!(
        patch.sharp_knots(0, 1.58).is_empty(),
        "the roof turns by pi/2"
    );
    assert!(patch.crease_knots(1).is_empty());
    let xi = [1.0, 0.5];
    let (left, right) = (patch.jet_left(xi), patch.jet(xi));
    assert!((left.rho - right.rho).norm() < 1e-15);
    assert!((left.rho_i[0] - Vec3::new(1.0, 0.0, 1.0)).norm() < 1e-14);
    assert!((right.rho_i[0] - Vec3::new(1.0, 0.0, -1.0)).norm() < 1e-14);
}

/// Closed quadratic with uniform knots: value and tangent agree at both ends of the domain.
#[test]
fn periodic_patch_closes() {
    let n = 8;
    let (columns, rows) = (n + 2, 2);
    let knots = (0..columns + 3).map(|k| k as f64).collect();
    let mut points = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let angle = std::f64::consts::TAU * (i % n) as f64 / n as f64;
            points.push(Vec3::new(angle.cos(), angle.sin(), j as f64));
        }
    }
    let flat = vec![0.0, 0.0, 1.0, 1.0];
    let patch = NurbsPatch::new([2, 1], [knots, flat], [columns, rows], &points, None).unwrap();
    let [[a, b], _] = patch.domain();
    assert_eq!([a, b], [2.0, 10.0]);
    let (start, end) = (patch.jet([a, 0.3]), patch.jet([b, 0.3]));
    assert!(start.rho_i[0].norm() > 0.1);
    assert!((start.rho - end.rho).norm() < 1e-15);
    assert!((start.rho_i[0] - end.rho_i[0]).norm() < 1e-14);
}

/// Rounding outside of the domain is moved onto it; farther out the polynomial goes on.
#[test]
fn outside_of_the_domain() {
    let patch = patch([3, 2], KINDS[0], 1.0, 8);
    let [[a, b], [c, _]] = patch.domain();
    let slightly = 1e-14 * (b - a);
    assert_eq!(patch.jet([b + slightly, c]), patch.jet([b, c]));
    assert_eq!(patch.jet([a - slightly, c]), patch.jet([a, c]));
    let (inside, h) = (patch.jet([b, c]), 1e-3 * (b - a));
    let outside = patch.jet([b + h, c]);
    assert_ne!(outside.rho, inside.rho);
    let taylor = inside.rho + inside.rho_i[0] * h + inside.rho_ij[0] * (0.5 * h * h);
    assert!((outside.rho - taylor).norm() < 0.1 * (inside.rho_ij[0] * (0.5 * h * h)).norm());
}

#[test]
fn part_of_the_domain() {
    let whole = patch([3, 4], KINDS[0], 1.0, 31);
    let [[a, b], [c, d]] = whole.domain();
    let part = [
        [a + 0.3 * (b - a), a + 0.8 * (b - a)],
        [c, d - 0.1 * (d - c)],
    ];
    let cut = whole.with_domain(part).unwrap();
    assert_eq!(cut.domain(), part);
    for xi in samples(&cut, 30, 2) {
        assert_eq!(cut.jet(xi), whole.jet(xi));
    }
    let spans = cut.spans(0);
    assert_eq!(
        (spans[0][0], spans[spans.len() - 1][1]),
        (part[0][0], part[0][1])
    );
    assert!(spans.len() < whole.spans(0).len());
    assert_eq!(cut.with_domain(whole.domain()).unwrap(), whole);
    // An end that sticks out by rounding is moved; more is refused, as is an empty or undefined range.
    let almost = whole.with_domain([[a, b * (1.0 + 1e-12)], [c, d]]).unwrap();
    assert_eq!(almost.domain()[0], [a, b]);
    for bad in [[a, b + 0.01], [b, a], [a, a], [f64::NAN, b]] {
        let error = whole.with_domain([[a, b], bad]).unwrap_err();
        assert!(matches!(
            error,
            PatchError::Knots {
                direction: 1,
                reason: KnotError::Domain { .. }
            }
        ));
    }
}

/// Each Bezier piece, evaluated with Bernstein polynomials, is the patch on its rectangle; 1e-12 of the size.
#[test]
fn bezier_pieces_reproduce_the_patch() {
    let mut largest = 0f64;
    for degree in [[1, 2], [3, 3], [5, 2], [9, 4], [15, 1]] {
        for (k, kind) in KINDS.into_iter().enumerate() {
            for narrowed in [false, true] {
                let mut patch = patch(degree, kind, 2.0, 50 + k as u64);
                if narrowed {
                    let part = patch
                        .domain()
                        .map(|[a, b]| [a + 0.2 * (b - a), b - 0.3 * (b - a)]);
                    patch = patch.with_domain(part).unwrap();
                }
                let pieces = bezier_pieces(&patch);
                let spans = [patch.spans(0), patch.spans(1)];
                assert_eq!(pieces.len(), spans[0].len() * spans[1].len());
                let [low, high] = patch.bounds();
                let size = (high - low).norm();
                for piece in &pieces {
                    assert_eq!(piece.domain, [0, 1].map(|d| spans[d][piece.span[d]]));
                    assert!(piece.points.iter().all(|p| p[3] > 0.0));
                    for s in [[0.0, 0.0], [1.0, 1.0], [0.37, 0.81], [0.5, 0.12]] {
                        let xi = [0, 1].map(|d| {
                            let [a, b] = piece.domain[d];
                            a + (b - a) * s[d]
                        });
                        let jet = patch.jet_in_span(piece.span, xi);
                        let error = (bernstein(piece.degree, &piece.points, s) - jet.rho).norm();
                        largest = largest.max(error / size);
                        assert!(
                            error < 1e-12 * size,
                            "{degree:?} {kind:?}: {error:e} of {size}"
                        );
                    }
                }
            }
        }
    }
    println!("largest difference / size: {largest:e}");
}

fn bernstein(degree: [usize; 2], points: &[[f64; 4]], s: [f64; 2]) -> Vec3 {
    let b = |d: usize, k: usize| {
        let choose = (0..k).fold(1.0, |c, m| c * (degree[d] - m) as f64 / (m + 1) as f64);
        choose * s[d].powi(k as i32) * (1.0 - s[d]).powi((degree[d] - k) as i32)
    };
    let mut sum = [0.0; 4];
    for (k, point) in points.iter().enumerate() {
        let f = b(0, k % (degree[0] + 1)) * b(1, k / (degree[0] + 1));
        for c in 0..4 {
            sum[c] += f * point[c];
        }
    }
    Vec3::new(sum[0], sum[1], sum[2]) / sum[3]
}

/// Reversal and exchange of directions: the same surface at mirrored or exchanged parameters, with the signs and places
/// of the derivatives changed; done twice, the patch itself.
#[test]
fn reversal_and_exchange() {
    for (k, kind) in KINDS.into_iter().enumerate() {
        let whole = patch([3, 2], kind, 1.0, 60 + k as u64);
        let part = whole.domain().map(|[a, b]| [a + 0.25 * (b - a), b]);
        for patch in [whole.clone(), whole.with_domain(part).unwrap()] {
            let swapped = patch.swapped().unwrap();
            assert_eq!(swapped.swapped().unwrap(), patch);
            let place = [0, 2, 1, 5, 4, 3, 9, 8, 7, 6];
            for xi in samples(&patch, 20, 3) {
                let (ours, other) = (list(&patch.jet3(xi)), list(&swapped.jet3([xi[1], xi[0]])));
                let error = worst(&[(place.map(|k| other[k]), ours)]);
                assert!(error.iter().all(|&e| e < 1e-12), "{error:?}");
            }
            for dir in 0..2 {
                let reversed = patch.reversed(dir).unwrap();
                assert_eq!(reversed.domain(), patch.domain());
                assert_ne!(reversed, patch);
                // Number of derivatives with respect to xi1 and xi2 in each place.
                let times = [
                    [0, 0],
                    [1, 0],
                    [0, 1],
                    [2, 0],
                    [1, 1],
                    [0, 2],
                    [3, 0],
                    [2, 1],
                    [1, 2],
                    [0, 3],
                ];
                let [a, b] = patch.domain()[dir];
                for xi in samples(&patch, 20, 3) {
                    let mut mirrored = xi;
                    mirrored[dir] = a + b - xi[dir];
                    let other = list(&reversed.jet3(mirrored));
                    let signed = std::array::from_fn(|k| other[k] * (-1f64).powi(times[k][dir]));
                    let error = worst(&[(signed, list(&patch.jet3(xi)))]);
                    assert!(error.iter().all(|&e| e < 1e-11), "{error:?}");
                }
                let twice = reversed.reversed(dir).unwrap();
                for xi in samples(&patch, 5, 6) {
                    assert!((twice.point(xi) - patch.point(xi)).norm() < 1e-12);
                }
            }
        }
    }
}

#[test]
fn moved_and_transformed() {
    let patch = patch([2, 3], KINDS[1], 2.0, 71);
    let motion = Isometry3::new(Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.3, 0.2, -0.9));
    let moved = patch.moved(&motion, 25.4).unwrap();
    for xi in samples(&patch, 20, 9) {
        let (x, y) = (patch.jet(xi), moved.jet(xi));
        let expected = motion * nalgebra::Point3::from(x.rho * 25.4);
        assert!((y.rho - expected.coords).norm() < 1e-12 * y.rho.norm());
        let expected = motion.rotation * x.rho_ij[1] * 25.4;
        assert!((y.rho_ij[1] - expected).norm() < 1e-10 * (1.0 + expected.norm()));
    }
    assert!(patch.transformed(&|x| x / 0.0).is_err());
}

/// All points of the patch lie in its box; a narrowed patch whose outer points do not act on it has a smaller one.
#[test]
fn bounds_hold_the_patch() {
    for kind in KINDS {
        let whole = patch([3, 2], kind, 2.0, 81);
        let part = whole
            .domain()
            .map(|[a, b]| [a + 0.01 * (b - a), a + 0.2 * (b - a)]);
        let narrow = whole.with_domain(part).unwrap();
        for patch in [&whole, &narrow] {
            let [low, high] = patch.bounds();
            for xi in samples(patch, 50, 4) {
                let x = patch.point(xi);
                assert!((0..3).all(|c| low[c] <= x[c] && x[c] <= high[c]));
            }
        }
        let size = |p: &NurbsPatch| (p.bounds()[1] - p.bounds()[0]).norm();
        assert!(size(&narrow) < 0.9 * size(&whole));
    }
}

/// Edges that are one point, also where the knots are not clamped and no control point lies on the edge.
#[test]
fn collapsed_edges() {
    let mut points = Vec::new();
    for j in 0..4 {
        for i in 0..4 {
            // A fan: the first column, or the mean of two neighbours of it, is the origin.
            let r = i as f64 - 0.5;
            points.push(Vec3::new(r, r * j as f64, 0.0));
        }
    }
    let uniform: Vec<f64> = (0..7).map(|k| k as f64).collect();
    let knots = [uniform, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]];
    let fan = NurbsPatch::new([2, 3], knots, [4, 4], &points, None).unwrap();
    assert_eq!(fan.degenerate_edges(1e-12), [true, false, false, false]);
    assert_eq!(
        fan.swapped().unwrap().degenerate_edges(1e-12),
        [false, false, true, false]
    );
    assert_eq!(
        fan.reversed(0).unwrap().degenerate_edges(1e-12),
        [false, true, false, false]
    );
    assert_eq!(fan.degenerate_edges(100.0), [true; 4]);
}
