//! Exchange with truck-geometry, and its one error that matters here.

use crate::common::{Knots, derivatives, oracle, patch, samples};
use covact_geometry::{NurbsPatch, Vec3};

const KINDS: [[Knots; 2]; 3] = [
    [Knots::Clamped, Knots::Unclamped],
    [Knots::Repeated, Knots::Clamped],
    [Knots::Unclamped, Knots::Repeated],
];

/// There and back is the identity, and truck's point and first derivatives are ours.
#[test]
fn exchange_with_truck() {
    for (k, kind) in KINDS.into_iter().enumerate() {
        let patch = patch([3, 2], kind, 1.0, 90 + k as u64);
        let surface = patch.to_truck();
        assert_eq!(surface.degrees(), (3, 2));
        assert_eq!(NurbsPatch::from_truck(&surface).unwrap(), patch);
        for xi in samples(&patch, 20, 12) {
            let x = surface.subs(xi[0], xi[1]);
            assert!((Vec3::new(x.x, x.y, x.z) - patch.point(xi)).norm() < 1e-12);
            let x = surface.uder(xi[0], xi[1]);
            let ours = patch.jet(xi).rho_i[0];
            assert!((Vec3::new(x.x, x.y, x.z) - ours).norm() < 1e-11 * ours.norm().max(1.0));
        }
    }
}

/// truck's knot insertion and degree elevation leave the surface where it was.
#[test]
fn knots_and_degrees_changed_by_truck() {
    let patch = patch([2, 3], [Knots::Clamped; 2], 1.0, 95);
    let mut surface = patch.to_truck();
    let inner = patch.spans(0)[1];
    surface.add_uknot(0.5 * (inner[0] + inner[1]));
    // Elevation leaves one knot too many at every inner knot, with coinciding points; `optimize` takes it out.
    surface.elevate_vdegree();
    assert!(NurbsPatch::from_truck(&surface).is_err());
    surface.optimize();
    let changed = NurbsPatch::from_truck(&surface).unwrap();
    assert_eq!(changed.degree(), [2, 4]);
    assert_eq!(changed.spans(1).len(), patch.spans(1).len());
    for xi in samples(&patch, 20, 13) {
        assert!((changed.point(xi) - patch.point(xi)).norm() < 1e-11);
    }
}

/// truck-geometry 0.5.0 leaves a factor out of pure second derivatives: the true uuder and vvder are p - 1 times what it
/// returns, so from degree 3 on they are wrong; uvder is right. When this test fails truck has been mended, and its
/// second derivatives may be used.
#[test]
fn truck_second_derivatives_lack_a_factor() {
    for p in 2..=5 {
        let patch = patch([p, p], [Knots::Clamped; 2], 0.0, 99);
        let surface = patch.to_truck();
        for xi in samples(&patch, 10, 14) {
            // Neither evaluator under test is the reference.
            let exact = derivatives(|x| oracle(&patch, x), xi);
            let [u, v] = xi;
            let found = [
                surface.uuder(u, v),
                surface.uvder(u, v),
                surface.vvder(u, v),
            ]
            .map(|x| Vec3::new(x.x, x.y, x.z));
            let factor = [(p - 1) as f64, 1.0, (p - 1) as f64];
            for k in 0..3 {
                let expected = found[k] * factor[k];
                assert!(expected.norm() > 1e-6);
                assert!(
                    (exact[3 + k] - expected).norm() < 1e-10 * exact[3 + k].norm().max(1.0),
                    "degree {p}: truck's second derivative {k} is no longer off by {}",
                    factor[k]
                );
            }
        }
    }
}

/// truck's knot insertion is right on unclamped knots and for weights over six orders of magnitude; its degree elevation
/// is wrong on unclamped knots, where it leaves control points of weight zero. That is why we have our own.
#[test]
fn truck_elevates_clamped_knots_only() {
    for (kind, clamped) in [([Knots::Clamped; 2], true), ([Knots::Unclamped; 2], false)] {
        let patch = patch([3, 3], kind, 6.0, 95);
        let spans = patch.spans(0);
        let mut finer = patch.to_truck();
        finer.add_uknot(0.5 * (spans[1][0] + spans[1][1]));
        let mut higher = patch.to_truck();
        higher.elevate_vdegree();
        higher.optimize();
        let higher = NurbsPatch::from_truck(&higher);
        assert_eq!(higher.is_ok(), clamped);
        for changed in [NurbsPatch::from_truck(&finer), higher]
            .into_iter()
            .flatten()
        {
            for xi in samples(&patch, 20, 13) {
                assert!((changed.point(xi) - patch.point(xi)).norm() < 1e-12);
            }
        }
    }
}
