//! The two kernels for second-order jets: that of any processor and that with AVX2 and FMA do the same; both agree with
//! codes written in another way where it is hardest.

use crate::common::{Knots, ORDER, Random, derivatives, oracle, patch, samples, worst};
use covact_geometry::{Jet, NurbsPatch, Vec3};
use monstertruck_geometry::prelude as monster;

const KINDS: [[Knots; 2]; 3] = [
    [Knots::Clamped, Knots::Unclamped],
    [Knots::Repeated, Knots::Clamped],
    [Knots::Unclamped, Knots::Repeated],
];

fn list(jet: &Jet) -> [Vec3; 6] {
    let Jet { rho, rho_i, rho_ij } = jet;
    [*rho, rho_i[0], rho_i[1], rho_ij[0], rho_ij[1], rho_ij[2]]
}

fn padded(list: [Vec3; 6]) -> [Vec3; 10] {
    std::array::from_fn(|k| list.get(k).copied().unwrap_or_default())
}

/// Both kernels of a patch; the same twice on a processor without AVX2.
fn kernels(patch: &NurbsPatch) -> [NurbsPatch; 2] {
    let portable = patch.clone().with_portable_kernel();
    assert!(portable.has_portable_kernel());
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        assert_eq!(
            patch.has_portable_kernel(),
            patch.degree().iter().any(|&p| p > 5)
        );
    }
    [patch.clone(), portable]
}

/// All pairs of degrees for which there are kernels, and some above. What remains is rounding: 1e-13 of the largest
/// derivative of each order, weights over an order of magnitude.
#[test]
fn kernels_agree() {
    let mut largest = [0f64; 3];
    for p in 1..=6 {
        for q in 1..=6 {
            for (k, kind) in KINDS.into_iter().enumerate() {
                for spread in [0.0, 1.0] {
                    let patch = patch([p, q], kind, spread, (100 * p + 10 * q + k) as u64);
                    let [fast, portable] = kernels(&patch);
                    let both = |xi| {
                        let [a, b] = [&fast, &portable].map(|patch| list(&patch.jet(xi)));
                        (padded(a), padded(b))
                    };
                    let pairs: Vec<_> = samples(&patch, 10, 3).into_iter().map(both).collect();
                    let error = worst(&pairs);
                    for (largest, error) in largest.iter_mut().zip(error) {
                        *largest = largest.max(error);
                    }
                }
            }
        }
    }
    println!("AVX2 against portable, by order: {largest:?}");
    assert!(largest.iter().all(|&e| e < 1e-13), "{largest:?}");
}

/// Far outside of the span its polynomial goes on, in both kernels, as in the recursion of the third-order jet.
#[test]
fn polynomials_continue() {
    for (p, q) in [(1, 2), (3, 3), (5, 4)] {
        let patch = patch([p, q], KINDS[2], 0.0, 3);
        for kernel in kernels(&patch) {
            for xi in samples(&patch, 20, 8) {
                let jet = list(&kernel.jet_in_span([1, 0], xi));
                let reference = patch.jet3_in_span([1, 0], xi).jet;
                for (a, b) in jet.iter().zip(list(&reference)) {
                    assert!((a - b).norm() <= 1e-10 * b.norm().max(1.0));
                }
            }
        }
    }
}

/// Spans whose lengths differ by a factor of a million, weights over six orders of magnitude, degrees 1 to 5. In the scale
/// of each derivative on its span: differences of the m-th derivative are relative to the larger of the largest
/// derivative seen on the span and size / length^m, size being that of the surface.
#[test]
fn short_spans_and_extreme_weights() {
    let mut largest = [0f64; 3];
    let mut random = Random(77);
    for p in 1..=5 {
        for spread in [0.0, 6.0] {
            let q = p % 5 + 1;
            let graded = |p: usize| {
                let mut knots = vec![0.0; p + 1];
                for length in [0.7, 1e-6, 1e-3, 0.5, 1e-6, 1e-6, 1.0] {
                    knots.push(knots[knots.len() - 1] + length);
                }
                let end = knots[knots.len() - 1];
                knots.extend(vec![end; p]);
                knots
            };
            let knots = [graded(p), graded(q)];
            let counts = [knots[0].len() - p - 1, knots[1].len() - q - 1];
            let points: Vec<Vec3> = (0..counts[0] * counts[1])
                .map(|k| {
                    let (i, j) = (k % counts[0], k / counts[0]);
                    Vec3::new(i as f64, j as f64, random.next())
                })
                .collect();
            let weights: Vec<f64> = points
                .iter()
                .map(|_| 10f64.powf(spread * (random.next() - 0.5)))
                .collect();
            let weights = (spread > 0.0).then_some(weights.as_slice());
            let patch = NurbsPatch::new([p, q], knots, counts, &points, weights).unwrap();
            let (spans1, spans2) = (patch.spans(0), patch.spans(1));
            assert!(spans1.iter().any(|[a, b]| b - a < 1.1e-6));
            for &r1 in &spans1 {
                for &r2 in &spans2 {
                    let mut pairs = [Vec::new(), Vec::new()];
                    for _ in 0..4 {
                        let xi = [r1, r2].map(|[a, b]| a + (b - a) * random.next());
                        let exact = derivatives(|x| oracle(&patch, x), xi);
                        for (kernel, pairs) in kernels(&patch).iter().zip(&mut pairs) {
                            pairs.push((list(&kernel.jet(xi)), exact));
                        }
                    }
                    let length = (r1[1] - r1[0]).min(r2[1] - r2[0]).min(1.0);
                    for pairs in &pairs {
                        let mut scale = [0f64; 3];
                        for (_, exact) in pairs {
                            for k in 0..6 {
                                scale[ORDER[k]] = scale[ORDER[k]].max(exact[k].norm());
                            }
                        }
                        let size = scale[0];
                        for (ours, exact) in pairs {
                            for k in 0..6 {
                                let m = ORDER[k];
                                let unit = scale[m].max(size / length.powi(m as i32));
                                let error = (ours[k] - exact[k]).norm() / unit;
                                assert!(error.is_finite());
                                largest[m] = largest[m].max(error);
                            }
                        }
                    }
                }
            }
        }
    }
    println!("graded spans, by order: {largest:?}");
    assert!(largest.iter().all(|&e| e < 1e-11), "{largest:?}");
}

type MonsterSurface = monster::NurbsSurface<monster::Vector4>;

fn to_monster(patch: &NurbsPatch) -> MonsterSurface {
    let [columns, rows] = patch.counts();
    let point = |i: usize, j: usize| monster::Vector4::from(patch.homogeneous()[i + columns * j]);
    let net = (0..columns).map(|i| (0..rows).map(|j| point(i, j)).collect());
    let knots = |dir| monster::KnotVector::from(patch.knots(dir).to_vec());
    let knots = (knots(0), knots(1));
    MonsterSurface::new(monster::BsplineSurface::new(knots, net.collect()))
}

/// monstertruck-geometry 0.4, written by others: degrees 1 to 5, plain, rational, and weights over six orders of
/// magnitude; 1e-11 of the largest derivative of each order.
#[test]
fn monstertruck_agrees() {
    use monster::ParametricSurface;
    let mut largest = [0f64; 3];
    for p in 1..=5 {
        for (k, kind) in KINDS.into_iter().enumerate() {
            for spread in [0.0, 1.0, 6.0] {
                let q = (p + k) % 5 + 1;
                let patch = patch([p, q], kind, spread, (200 + 10 * p + k) as u64);
                let surface = to_monster(&patch);
                for kernel in kernels(&patch) {
                    let both = |xi: [f64; 2]| {
                        let [u, v] = xi;
                        let x = surface.evaluate(u, v);
                        let vector = |x: monster::Vector3| Vec3::new(x.x, x.y, x.z);
                        let reference = [
                            Vec3::new(x.x, x.y, x.z),
                            vector(surface.derivative_u(u, v)),
                            vector(surface.derivative_v(u, v)),
                            vector(surface.derivative_uu(u, v)),
                            vector(surface.derivative_uv(u, v)),
                            vector(surface.derivative_vv(u, v)),
                        ];
                        (padded(list(&kernel.jet(xi))), padded(reference))
                    };
                    let pairs: Vec<_> = samples(&patch, 20, 9).into_iter().map(both).collect();
                    for (largest, error) in largest.iter_mut().zip(worst(&pairs)) {
                        *largest = largest.max(error);
                    }
                }
            }
        }
    }
    println!("monstertruck, by order: {largest:?}");
    assert!(largest.iter().all(|&e| e < 1e-11), "{largest:?}");
}
