//! Bilinear and biquadratic facets as surfaces.

use covact_geometry::facet::FacetError;
use covact_geometry::{Bilinear, Biquadratic, Jet, NurbsPatch, Surface, Vec3};
use num_dual::{Dual2_64, Dual64, HyperDual64};

struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = (self.0.wrapping_mul(6_364_136_223_846_793_005))
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}

/// Nodes of a warped facet of degree `p`, counter-clockwise about z.
fn nodes<const N: usize>(p: usize, seed: u64) -> [Vec3; N] {
    let mut random = Random(seed);
    std::array::from_fn(|k| {
        let (i, j) = ((k % (p + 1)) as f64, (k / (p + 1)) as f64);
        let off = Vec3::from_fn(|_, _| 0.4 * random.next());
        Vec3::new(2.0 * i / p as f64, 3.0 * j / p as f64, 0.0) + off
    })
}

const PARAMETERS: [[f64; 2]; 5] = [
    [-1.0, -1.0],
    [0.3, -0.7],
    [1.0, 0.2],
    [-0.45, 0.9],
    [0.0, 0.0],
];

/// Derivatives of the point alone by dual numbers: 1, 2, 11, 12, 22.
fn by_duals<const N: usize>(
    x: &[Vec3; N],
    [r, s]: [f64; 2],
    jet1: impl Fn(&[Vec3<Dual64>; N], [Dual64; 2]) -> Vec3<Dual64>,
    jet2: impl Fn(&[Vec3<Dual2_64>; N], [Dual2_64; 2]) -> Vec3<Dual2_64>,
    mixed: impl Fn(&[Vec3<HyperDual64>; N], [HyperDual64; 2]) -> Vec3<HyperDual64>,
) -> [Vec3; 5] {
    let still = x.map(|x| x.map(Dual64::from));
    let one = [
        jet1(&still, [Dual64::new(r, 1.0), s.into()]),
        jet1(&still, [r.into(), Dual64::new(s, 1.0)]),
    ]
    .map(|v| v.map(|d| d.eps));
    let still = x.map(|x| x.map(Dual2_64::from));
    let two = [
        jet2(&still, [Dual2_64::new(r, 1.0, 0.0), s.into()]),
        jet2(&still, [r.into(), Dual2_64::new(s, 1.0, 0.0)]),
    ]
    .map(|v| v.map(|d| d.v2));
    let still = x.map(|x| x.map(HyperDual64::from));
    let both = mixed(
        &still,
        [
            HyperDual64::new(r, 1.0, 0.0, 0.0),
            HyperDual64::new(s, 0.0, 1.0, 0.0),
        ],
    )
    .map(|d| d.eps1eps2);
    [one[0], one[1], two[0], both, two[1]]
}

fn compare(jet: &Jet, expected: &[Vec3; 5], zero: &[usize]) {
    let found = [
        jet.rho_i[0],
        jet.rho_i[1],
        jet.rho_ij[0],
        jet.rho_ij[1],
        jet.rho_ij[2],
    ];
    for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_eq!(expected.norm() == 0.0, zero.contains(&k), "{k}: {expected}");
        assert!((found - expected).norm() < 1e-14, "{k}: {found} {expected}");
    }
}

/// The point is the sum of the nodes with their shape functions, and the derivatives are those of the point (all
/// that are compared are not zero, but for `rho_11` and `rho_22` of bilinear facets, which are).
#[test]
fn jets_are_the_derivatives_of_the_point() {
    let (x4, x9) = (nodes::<4>(1, 3), nodes::<9>(2, 4));
    let (four, nine) = (Bilinear::new(x4).unwrap(), Biquadratic::new(x9).unwrap());
    for xi in PARAMETERS {
        let exact = by_duals(
            &x4,
            xi,
            |x, xi| Bilinear::jet_of(x, xi).rho,
            |x, xi| Bilinear::jet_of(x, xi).rho,
            |x, xi| Bilinear::jet_of(x, xi).rho,
        );
        compare(&four.jet(xi), &exact, &[2, 4]);
        let shape = Bilinear::shape(xi);
        let sum = |n: &[f64; 4]| (0..4).fold(Vec3::zeros(), |s, k| s + x4[k] * n[k]);
        let jet = four.jet(xi);
        for (n, v) in shape
            .iter()
            .zip([jet.rho, jet.rho_i[0], jet.rho_i[1], jet.rho_ij[1]])
        {
            assert!((sum(n) - v).norm() < 1e-14);
        }

        let exact = by_duals(
            &x9,
            xi,
            |x, xi| Biquadratic::jet_of(x, xi).rho,
            |x, xi| Biquadratic::jet_of(x, xi).rho,
            |x, xi| Biquadratic::jet_of(x, xi).rho,
        );
        compare(&nine.jet(xi), &exact, &[]);
        let sum = |n: &[f64; 9]| (0..9).fold(Vec3::zeros(), |s, k| s + x9[k] * n[k]);
        let jet = nine.jet(xi);
        let all = [
            jet.rho,
            jet.rho_i[0],
            jet.rho_i[1],
            jet.rho_ij[0],
            jet.rho_ij[1],
            jet.rho_ij[2],
        ];
        for (n, v) in Biquadratic::shape(xi).iter().zip(all) {
            assert!((sum(n) - v).norm() < 1e-14);
        }
    }
}

/// Facets pass through their nodes.
#[test]
fn facets_interpolate_their_nodes() {
    let (x4, x9) = (nodes::<4>(1, 5), nodes::<9>(2, 6));
    for (k, x) in x4.iter().enumerate() {
        let xi = [k % 2, k / 2].map(|i| 2.0 * i as f64 - 1.0);
        assert_eq!(Bilinear::new(x4).unwrap().point(xi), *x);
    }
    for (k, x) in x9.iter().enumerate() {
        let xi = [k % 3, k / 3].map(|i| i as f64 - 1.0);
        let found = Biquadratic::new(x9).unwrap().point(xi);
        assert!((found - x).norm() < 4e-15, "{k}");
    }
}

/// The Bezier piece, evaluated as a NURBS patch over the same parameters, has the jets of the facet.
#[test]
fn bezier_pieces_are_the_facet() {
    fn check<S: Surface>(facet: &S) {
        let [piece] = &facet.bezier_pieces()[..] else {
            panic!("one piece")
        };
        assert_eq!(piece.domain, facet.domain());
        let knots = piece.degree.map(|p| {
            let mut knots = vec![-1.0; p + 1];
            knots.extend(vec![1.0; p + 1]);
            knots
        });
        let points: Vec<Vec3> = (piece.points.iter())
            .map(|p| Vec3::new(p[0], p[1], p[2]) / p[3])
            .collect();
        let counts = piece.degree.map(|p| p + 1);
        let patch = NurbsPatch::new(piece.degree, knots, counts, &points, None).unwrap();
        for xi in PARAMETERS {
            let (a, b) = (facet.jet(xi), patch.jet(xi));
            assert!((a.rho - b.rho).norm() < 1e-14);
            for (a, b) in a.rho_i.iter().zip(&b.rho_i) {
                assert!(b.norm() > 0.1 && (a - b).norm() < 1e-14);
            }
            for (a, b) in a.rho_ij.iter().zip(&b.rho_ij) {
                assert!((a - b).norm() < 1e-13);
            }
        }
    }
    check(&Bilinear::new(nodes::<4>(1, 7)).unwrap());
    check(&Biquadratic::new(nodes::<9>(2, 8)).unwrap());
}

#[test]
fn nodes_must_be_finite() {
    let mut x = nodes::<4>(1, 9);
    x[2].y = f64::NAN;
    assert_eq!(Bilinear::new(x), Err(FacetError::Node(2)));
    let mut x = nodes::<9>(2, 9);
    x[8].z = f64::INFINITY;
    assert_eq!(Biquadratic::new(x), Err(FacetError::Node(8)));
}
