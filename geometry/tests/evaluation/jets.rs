//! Jets of general patches against an evaluator written in another way.

use crate::common::{Knots, Random, derivatives, list, oracle, patch, samples, worst};
use covact_geometry::{Jet3, NurbsPatch, PatchShape, Vec3};
use num_dual::{Dual64, HyperHyperDual64};

const KINDS: [[Knots; 2]; 3] = [
    [Knots::Clamped, Knots::Unclamped],
    [Knots::Repeated, Knots::Clamped],
    [Knots::Unclamped, Knots::Repeated],
];

fn compare(patch: &NurbsPatch, count: usize) -> [f64; 4] {
    let pairs: Vec<_> = samples(patch, count, 7)
        .into_iter()
        .map(|xi| (list(&patch.jet3(xi)), derivatives(|x| oracle(patch, x), xi)))
        .collect();
    worst(&pairs)
}

/// Non-rational and rational, clamped, repeated and unclamped knots, every degree with itself and with another one.
/// The tolerance is the accuracy asked of jets; rounding grows with the degree and with the order of the derivative.
#[test]
fn all_degrees_agree_with_corner_cutting() {
    let mut largest = [0f64; 4];
    for p in 1..=9 {
        for q in [p, (p + 3) % 9 + 1] {
            for (k, kind) in KINDS.into_iter().enumerate() {
                for spread in [0.0, 0.6] {
                    let patch = patch([p, q], kind, spread, (100 * p + 10 * q + k) as u64);
                    assert_eq!(patch.is_rational(), spread > 0.0);
                    let error = compare(&patch, 12);
                    for m in 0..4 {
                        largest[m] = largest[m].max(error[m]);
                        assert!(
                            error[m] <= 1e-11,
                            "degrees {p}, {q}, {kind:?}, weights {spread}: order {m} off by {:e}",
                            error[m]
                        );
                    }
                }
            }
        }
    }
    println!("largest relative differences by order: {largest:?}");
}

/// Degrees above those of usual CAD files, to the highest one.
#[test]
fn high_degrees_agree_with_corner_cutting() {
    for degree in [[10, 10], [12, 2], [3, 13], [15, 15]] {
        for spread in [0.0, 0.6] {
            let error = compare(&patch(degree, KINDS[1], spread, 5), 8);
            println!("{degree:?}, weights {spread}: {error:?}");
            assert!(error.iter().all(|&e| e <= 1e-11), "{degree:?}: {error:?}");
        }
    }
}

/// Weights spread over six orders of magnitude: the quotient rule must not lose the derivatives.
#[test]
fn weights_over_six_orders() {
    for degree in [[2, 2], [3, 3], [5, 4]] {
        for (k, kind) in KINDS.into_iter().enumerate() {
            let patch = patch(degree, kind, 6.0, 40 + k as u64);
            let weights = patch.weights();
            let largest = weights.iter().copied().fold(0.0, f64::max);
            let smallest = weights.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(largest / smallest > 1e5);
            let error = compare(&patch, 40);
            println!("{degree:?} {kind:?}: {error:?}");
            assert!(
                error.iter().all(|&e| e <= 1e-11),
                "{degree:?} {kind:?}: {error:?}"
            );
        }
    }
}

/// The jet without third derivatives and the point are those of the longer evaluation.
#[test]
fn shorter_evaluations_agree() {
    for degree in [[3, 2], [7, 3]] {
        for spread in [0.0, 1.0] {
            let patch = patch(degree, KINDS[0], spread, 3);
            for xi in samples(&patch, 20, 2) {
                let [rho, others @ ..] = list(&patch.jet3(xi));
                let jet = patch.jet(xi);
                let ours = [
                    jet.rho_i[0],
                    jet.rho_i[1],
                    jet.rho_ij[0],
                    jet.rho_ij[1],
                    jet.rho_ij[2],
                ];
                assert!((jet.rho - rho).norm() <= 1e-14 * rho.norm());
                assert!((patch.point(xi) - rho).norm() <= 1e-14 * rho.norm());
                for (ours, reference) in ours.iter().zip(&others) {
                    assert!((ours - reference).norm() <= 1e-12 * (1.0 + reference.norm()));
                }
            }
        }
    }
}

/// Equal weights of any size are no weights.
#[test]
fn equal_weights_cancel() {
    for degree in [[2, 3], [7, 2]] {
        let plain = patch(degree, KINDS[2], 0.0, 13);
        let points = plain.points();
        let knots = [plain.knots(0).to_vec(), plain.knots(1).to_vec()];
        let weights = vec![3.7; points.len()];
        let heavy =
            NurbsPatch::new(degree, knots, plain.counts(), &points, Some(&weights)).unwrap();
        assert!(!heavy.is_rational());
        for xi in samples(&plain, 20, 8) {
            let error = worst(&[(list(&heavy.jet3(xi)), list(&plain.jet3(xi)))]);
            assert!(error.iter().all(|&e| e < 1e-12), "{error:?}");
            let (a, b) = (heavy.jet(xi), plain.jet(xi));
            assert!((a.rho - b.rho).norm() < 1e-14 * b.rho.norm());
            assert!((a.rho_ij[1] - b.rho_ij[1]).norm() < 1e-12 * (1.0 + b.rho_ij[1].norm()));
        }
    }
}

/// Shape functions: partition of unity, derivatives that sum to zero, and the jet as their sum with the points.
#[test]
fn shape_functions_reproduce_the_jet() {
    let mut shape = PatchShape::default();
    for (degree, spread) in [([1, 1], 0.0), ([2, 3], 1.0), ([3, 3], 3.0), ([9, 4], 1.0)] {
        let patch = patch(degree, KINDS[2], spread, 11);
        let points = patch.points();
        for xi in samples(&patch, 20, 1) {
            patch.shape(xi, &mut shape);
            assert_eq!(shape.indices.len(), (degree[0] + 1) * (degree[1] + 1));
            assert!((shape.n.iter().sum::<f64>() - 1.0).abs() < 1e-13);
            for d in 0..2 {
                let (sum, size) = sums(shape.n_i.iter().map(|n| n[d]));
                assert!(size > 0.0 && sum.abs() < 1e-13 * size);
            }
            for d in 0..3 {
                let (sum, size) = sums(shape.n_ij.iter().map(|n| n[d]));
                assert!(sum.abs() <= 1e-12 * size, "{sum:e} of {size:e}");
            }
            let (ours, jet) = (shape.interpolate(&points).unwrap(), patch.jet(xi));
            assert!((ours.rho - jet.rho).norm() < 1e-12 * jet.rho.norm());
            for (a, b) in ours.rho_i.iter().zip(&jet.rho_i) {
                assert!((a - b).norm() < 1e-12 * b.norm().max(1.0));
            }
            for (a, b) in ours.rho_ij.iter().zip(&jet.rho_ij) {
                assert!((a - b).norm() < 1e-11 * b.norm().max(1.0));
            }
        }
    }
    assert!(shape.interpolate(&[]).is_none());
}

fn sums(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((0.0, 0.0), |(sum, size), x| (sum + x, size + x.abs()))
}

/// The generic jet with real numbers is the jet; with dual parameters its dual part is the next derivative; with dual
/// control points it is the jet of their velocities.
#[test]
fn generic_jet() {
    for (degree, spread) in [([3, 2], 0.0), ([2, 4], 1.0)] {
        let patch = patch(degree, KINDS[0], spread, 21);
        let points = patch.points();
        let mut random = Random(9);
        let velocity: Vec<Vec3> = points
            .iter()
            .map(|_| Vec3::from_fn(|_, _| random.next() - 0.5))
            .collect();
        let moving: Vec<Vec3<Dual64>> = points
            .iter()
            .zip(&velocity)
            .map(|(x, v)| x.zip_map(v, Dual64::new))
            .collect();
        let still: Vec<Vec3<Dual64>> = points.iter().map(|x| x.map(Dual64::from)).collect();
        let weights = patch.weights();
        let knots = [patch.knots(0).to_vec(), patch.knots(1).to_vec()];
        let rate =
            NurbsPatch::new(degree, knots, patch.counts(), &velocity, Some(&weights)).unwrap();
        for xi in samples(&patch, 10, 4) {
            let reference = list(&patch.jet3(xi));
            let real: Jet3 = patch.jet_generic(&points, xi, None).unwrap();
            assert!(
                worst(&[(list(&real), reference)])
                    .iter()
                    .all(|&e| e < 1e-12)
            );
            let velocities = dual(
                &patch
                    .jet_generic(&moving, xi.map(Dual64::from), None)
                    .unwrap(),
            );
            assert!(
                worst(&[(velocities, list(&rate.jet3(xi)))])
                    .iter()
                    .all(|&e| e < 1e-12)
            );
            for dir in 0..2 {
                let mut x = xi.map(Dual64::from);
                x[dir].eps = 1.0;
                let next = dual(&patch.jet_generic(&still, x, None).unwrap());
                let place: [usize; 6] = if dir == 0 {
                    [1, 3, 4, 6, 7, 8]
                } else {
                    [2, 4, 5, 7, 8, 9]
                };
                for (k, place) in place.into_iter().enumerate() {
                    let scale = reference[place].norm().max(reference[k].norm());
                    assert!(scale > 0.0);
                    assert!((next[k] - reference[place]).norm() <= 1e-11 * scale);
                }
            }
        }
        assert!(patch.jet_generic(&points[1..], [0.5, 0.5], None).is_err());
    }
}

fn dual(jet: &Jet3<Dual64>) -> [Vec3; 10] {
    let j = &jet.jet;
    let r = &jet.rho_ijk;
    [
        j.rho,
        j.rho_i[0],
        j.rho_i[1],
        j.rho_ij[0],
        j.rho_ij[1],
        j.rho_ij[2],
        r[0],
        r[1],
        r[2],
        r[3],
    ]
    .map(|v| v.map(|x| x.eps))
}

/// The oracle itself against a polynomial written out: rho = (u, v, u^3 v^2) as one Bezier piece.
#[test]
fn oracle_knows_a_polynomial() {
    let knots = [
        vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0],
        vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
    ];
    let mut points = Vec::new();
    for j in 0..3 {
        for i in 0..4 {
            let z = if i == 3 && j == 2 { 1.0 } else { 0.0 };
            points.push(Vec3::new(i as f64 / 3.0, j as f64 / 2.0, z));
        }
    }
    let patch = NurbsPatch::new([3, 2], knots, [4, 3], &points, None).unwrap();
    let polynomial = |[u, v]: [HyperHyperDual64; 2]| [u, v, u * u * u * v * v];
    for xi in samples(&patch, 10, 3) {
        let exact = derivatives(polynomial, xi);
        assert!(exact[9].norm() == 0.0 && exact[8].norm() > 0.0);
        let by_cutting = derivatives(|x| oracle(&patch, x), xi);
        assert!(worst(&[(by_cutting, exact)]).iter().all(|&e| e < 1e-14));
        assert!(
            worst(&[(list(&patch.jet3(xi)), exact)])
                .iter()
                .all(|&e| e < 1e-14)
        );
    }
}
