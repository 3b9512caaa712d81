//! Evaluation allocates nothing.

use crate::calls;
use std::hint::black_box;

use covact_geometry::{Frame, NurbsPatch, PatchShape, Vec3, primitives};

/// Keeps a result from being optimised away.
fn discard<T>(x: T) {
    black_box(x);
}

fn patches() -> Vec<NurbsPatch> {
    let mut patches = vec![primitives::torus(3.0, 1.0, Vec3::zeros(), Vec3::z()).unwrap()];
    for degree in [[1, 1], [3, 3], [5, 2], [9, 4], [15, 15]] {
        let knots = degree.map(|p| (0..2 * p + 6).map(|k| k as f64).collect::<Vec<_>>());
        let counts = degree.map(|p| p + 5);
        let points: Vec<Vec3> = (0..counts[0] * counts[1])
            .map(|k| {
                Vec3::new(
                    (k % counts[0]) as f64,
                    (k / counts[0]) as f64,
                    (k % 3) as f64,
                )
            })
            .collect();
        patches.push(NurbsPatch::new(degree, knots, counts, &points, None).unwrap());
    }
    patches
}

#[test]
fn evaluation_allocates_nothing() {
    // The counter counts.
    assert!(calls(|| drop(black_box(vec![1.0; 100]))) > 0);
    // Both kernels, where the processor has two.
    let portable = patches().into_iter().map(NurbsPatch::with_portable_kernel);
    for patch in patches().into_iter().chain(portable) {
        let [[a, b], [c, d]] = patch.domain();
        let xi = |k: usize| [a + (b - a) * k as f64 / 50.0, c + (d - c) * k as f64 / 50.0];
        let mut shape = PatchShape::default();
        patch.shape(xi(0), &mut shape);
        let degree = patch.degree();
        for k in 0..=50 {
            let xi = xi(k);
            assert_eq!(calls(|| discard(patch.jet(xi))), 0, "{degree:?}");
            assert_eq!(calls(|| discard(patch.jet3(xi))), 0, "{degree:?}");
            assert_eq!(calls(|| discard(patch.jet_left(xi))), 0, "{degree:?}");
            assert_eq!(calls(|| discard(patch.point(xi))), 0, "{degree:?}");
            assert_eq!(calls(|| patch.shape(xi, &mut shape)), 0, "{degree:?}");
            let generic = patch.jet3(xi).jet;
            let frame = || {
                if let Some(frame) = Frame::new(&generic, 1.0) {
                    black_box((
                        frame.christoffel(),
                        frame.h_inv(),
                        frame.principal_curvatures(),
                    ));
                }
            };
            assert_eq!(calls(frame), 0);
        }
    }
}
